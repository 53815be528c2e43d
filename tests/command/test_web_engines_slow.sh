#!/usr/bin/env bash
# Engines that are not linked run a reduced suite; absent ones are named.
set -eu
source "$SOURCE/tests/support/command.sh"
source "$SOURCE/compare/packages.sh"
readarray -t engines < <(engines module script)
[[ ${#engines[@]} -ge 8 ]] || note_failure "only ${#engines[@]} engines were found: the test is blind"

"$PLUMB" doctor >doctor || note_failure "doctor: exit code $?"
present=()
for engine in "${engines[@]}"; do
    grep -qE "^$engine +" doctor || note_failure "doctor does not name $engine"
    if grep -qE "^$engine +absent" doctor; then
        command=run expect 3 "engine $engine is absent: ./compare/run --with $engine gets it" tower --engine "$engine"
        command=compare expect 0 "engine $engine is absent" tower --duration 0.1 --engine plumb --with "$engine" --out "without-$engine"
    else
        present+=("$engine")
    fi
done
[[ ${#present[@]} -gt 0 ]] || exit $((failed ? failed : 77))

# What every adapter must get right, whatever its engine does.
for check in initial-position quaternion-order frame-of-step gravity angular-velocity given-inertia hull-rests mesh-rests repeats; do
    checks+=(--check "$check")
done
"$PLUMB" check-engine "${present[@]}" "${checks[@]}" --timeout 60 --quiet >checked 2>&1 || note_failure "$(cat checked)"

with=$(IFS=,; echo "${present[*]}")
"$PLUMB" compare tower slope-slide bounce --duration 1 --engine plumb --with "$with" --no-reference --out reduced >/dev/null 2>err ||
    note_failure "compare: $(cat err)"
python3 - "${present[@]}" >wrong <<'END'
import json, sys
rows = [json.loads(line) for line in open("reduced/results.jsonl")]
for engine in sys.argv[1:]:
    mine = [r for r in rows if r["engine"] == engine]
    profiles = {r["profile"] for r in mine}
    if len(mine) != 3 * len(profiles) or any(r["outcome"] not in ("ok", "unsupported", "collapsed") for r in mine):
        print(engine, [(r["scenario"], r["outcome"], r["reason"]) for r in mine])
END
[[ ! -s wrong ]] || note_failure "$(cat wrong)"

# MuJoCo starts again from the first state where one becomes too large: that ends the run.
if [[ " ${present[*]} " == *" mujoco3 "* ]]; then
    cat >fast.json <<'END'
{"plumb_scene": 1, "name": "fast", "gravity": [0, 0, 0], "dt": 0.01, "duration": 6,
 "bodies": [{"name": "ball", "shape": {"type": "sphere", "radius": 0.5}, "mass": 1, "position": [0, 0, 0], "velocity": [4e9, 0, 0]}]}
END
    command=run expect 3 "MuJoCo gave up its state" fast.json --engine mujoco3
fi

# The programs about an engine need its package alone.
packages=$(dirname "$PLUMB")/lib/plumb/web/node_modules
if [[ -d $packages ]]; then
    ln -s "$packages" node_modules
    cp "$SOURCE"/compare/adapters/*/behaviour/*.mjs .
    for program in *.mjs; do
        [[ $(wc -l <"$program") -le 30 ]] || note_failure "$program has more than 30 lines"
        [[ $program != havok_world.mjs && " ${present[*]} " == *" ${program%%_*} "* ]] || continue
        node "$program" >printed 2>err || note_failure "$program: $(cat err)"
        grep -q "[0-9]" printed || note_failure "$program prints no numbers"
    done
fi
exit $failed
