#!/usr/bin/env bash
# The table of reported symptoms in compare/STATE.md: from staged runs, each scene names the configurations that are
# wrong on one of its settings, those that are right on all, and those that cannot run it.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

mkdir runs
"$PLUMB" list suites --json >suites.json
"$PLUMB" list scenarios --json >scenarios.json
cat >engines.json <<'END'
[{"name": "plumb", "version": "1.0", "present": true}, {"name": "ode", "version": "0.16", "present": true},
 {"name": "bullet", "version": "3.24", "present": true}, {"name": "mujoco", "version": "2.2", "present": true}]
END
printf '# Summary\n\n## Findings\n\n## Verdicts\n' >runs/summary.md
cat >stage.py <<'END'
import json, subprocess, sys
def run(scenario, label, verdict, off=(), **params):
    outcome = "unsupported" if verdict is None else "collapsed" if verdict == "failed" else "ok"
    print(json.dumps({"scenario": scenario, "label": label, "params": params, "verdict": verdict, "outcome": outcome,
                      "off": [{"what": what} for what in off]}))
run("slow-impact", "plumb:fast", "accurate", speed=1)
run("slow-impact", "plumb:fast", "inaccurate", ["position of \"ball\": 1 m, expected 2 m within 0.1 m",
    "velocity of \"ball\": 0 m/s, expected 1 m/s within 0.1 m/s"], speed=0.1, duration=20)
run("slow-impact", "ode:quick", "accurate", speed=1)
run("slow-impact", "ode:quick", "accurate", speed=0.1, duration=20)
run("slow-impact", "mujoco:default", None, speed=1)
run("pool-ball", "ode:quick", "failed")
run("pool-ball", "ode:dantzig", "inaccurate", ["spin of \"ball\": 1 rad/s, expected within 0.1 rad/s"])
run("pool-ball", "bullet:si", "inaccurate", ["spin of \"ball\": 1 rad/s, expected within 0.1 rad/s"])
run("pool-ball", "plumb:fast", "accurate")
run("long-roll", "bullet:si", "accurate")
run("elastic-bounces", "bullet:si", "accurate", height=10, dt=1 / 240, duration=60)
run("tower", "bullet:si", "failed", n=10)
END
python3 stage.py >runs/results.jsonl
python3 - "$SOURCE/compare" >table.md <<'END'
import sys
sys.path.insert(0, sys.argv[1])
sys.argv = ["state.py", "."]
sys.dont_write_bytecode = True
import state
found = state.symptoms(state.State())
print(found["symptoms"], f"\n\n{found['symptoms_missed']} of {found['symptom_scenes']} scenes are missed")
END

# row N PATTERN: the Nth row of the table.
row() {
    sed -n '/^|---/,/^$/p' table.md | sed -n "$(($1 + 1))p" | grep -qF -- "$2" || note_failure "row $1: no $2 in $(cat table.md)"
}
row 1 '| `slow-impact` |'
row 1 '| plumb 1.0 (fast: position, velocity) | ODE 0.16 (quick) | MuJoCo 2 2.2 (default) |'
row 1 '[bullet3#3094](https://github.com/bulletphysics/bullet3/issues/3094), [box2d#89]'
row 2 '| `pool-ball` |'
row 2 '| ODE 0.16 (dantzig: spin; quick: collapsed); Bullet 3.24 (si: spin) | plumb 1.0 (fast) | – |'
grep -q '`tower`' table.md && note_failure "a scene that nobody reported has a row"
[[ $(grep -c '^| `' table.md) == 4 ]] || note_failure "expected 4 rows: $(cat table.md)"
grep -q '2 of 4 scenes are missed' table.md || note_failure "no count in: $(cat table.md)"
exit $failed
