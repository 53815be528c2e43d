#!/usr/bin/env bash
# Scene files with parameters take the way of scenarios: run, compare, sweep, threshold and tune set and
# vary them, results record them, and --resume tells them apart.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

# A block on a ramp: gravity is tilted, and the block holds where mu > tan(tilt) = 0.25.
cat >ramp.json <<'END'
{ "plumb_scene": 1, "name": "ramp", "duration": 1,
  "parameters": { "mu": { "value": 0.5, "low": 0.1, "high": 1, "description": "friction" }, "slope": 0.25 },
  "gravity": ["9.81*slope/sqrt(1+slope*slope)", 0, "-9.81/sqrt(1+slope*slope)"],
  "materials": { "m": { "friction": "mu", "restitution": 0 } },
  "bodies": [
    { "name": "floor", "material": "m", "shape": { "type": "plane", "normal": [0, 0, 1], "offset": 0 } },
    { "name": "block", "material": "m", "mass": 1, "shape": { "type": "box", "half_extents": [0.2, 0.2, 0.05] },
      "position": [0, 0, 0.05] } ],
  "expect": { "rest": [ { "body": "block", "position": [0, 0, 0.05] } ], "collapse_distance": 0.01,
              "acceptance": 0.01 } }
END
# The same without parameters.
sed -e '/"parameters"/d' -e 's/"9.81\*slope[^"]*"/2.379275/; s/"-9.81[^"]*"/-9.517100/; s/"mu"/0.4/' ramp.json >plain.json

# scene: the printed scene has the numbers, and no parameters.
"$PLUMB" scene ramp.json --set mu=0.3 >printed.json
grep -q '"friction": 0.3' printed.json || note_failure "the printed scene has not the value set"
! grep -q 'parameters' printed.json || note_failure "the printed scene has parameters"

# Values and names that are refused.
expect 2 'ramp.json: mu: expected 0.1 to 1 \(1\), found 2' run ramp.json --engine plumb --set mu=2
expect 2 'no chosen scenario has the parameter mi; did you mean mu' run ramp.json --engine plumb --set mi=2
expect 2 'no chosen scenario has the parameter mu' run plain.json --engine plumb --set mu=0.3
sed 's/"slope": 0.25 }/"slope": 0.25, "other": 1 }/' ramp.json >unused.json
expect 2 'unused.json:2:[0-9]+: parameters.other: expected a field that uses the parameter' run unused.json --engine plumb
sed 's/"friction": "mu"/"friction": "2*nu"/' ramp.json >unknown.json
expect 2 'unknown.json:4:[0-9]+: materials.m.friction: expected a number or a parameter, found "nu" at character 3' \
    run unknown.json --engine plumb
[[ ! -e report ]] || note_failure "a refused run left a report"

# Results record the parameters, and the hash of the substituted scene; so does a file from standard input.
"$PLUMB" compare ramp.json --set mu=0.4 --engine plumb --out one >/dev/null 2>&1
"$PLUMB" compare - --set mu=0.4 --engine plumb --out two <ramp.json >/dev/null 2>&1
"$PLUMB" scene ramp.json --set mu=0.4 >four.json
"$PLUMB" compare four.json --engine plumb --out three >/dev/null 2>&1
python3 - <<'END' || note_failure "the results of a scene file do not record its parameters"
import json
rows = [json.loads(open(f"{folder}/results.jsonl").readline()) for folder in ("one", "two", "three")]
assert rows[0]["params"] == {"mu": 0.4, "slope": 0.25}, rows[0]["params"]
assert rows[1]["params"] == rows[0]["params"]
assert rows[2]["params"] == {}
assert len({row["scene_hash"] for row in rows}) == 1
assert len({row["run"] for row in rows}) == 3
END
grep -q 'ramp.json mu=0.4 slope=0.25' one/summary.md || note_failure "the summary does not name the parameters"
! grep -q 'is not the one that was run' one/index.html || note_failure "the report did not build the scene again"
grep -q -- '--set mu=0.4' one/index.html || note_failure "the page does not say how the run is made again"

# --resume: another value is another run.
"$PLUMB" compare ramp.json --set mu=0.4 --engine plumb --out one --resume >resumed 2>&1
[[ $(wc -l <one/results.jsonl) == 1 ]] || note_failure "the same value ran again"
"$PLUMB" compare ramp.json --set mu=0.45 --engine plumb --out one --resume >resumed 2>&1
[[ $(wc -l <one/results.jsonl) == 2 ]] || note_failure "another value was not run"

# sweep: with --vary, and from standard input.
"$PLUMB" sweep - --vary mu=0.2,0.3,0.4 --vary dt=1/60,1/120 --engine plumb --plan - <ramp.json >plan
[[ $(grep -o '"mu": *[0-9.]*' plan | sort -u | wc -l) == 3 && $(wc -l <plan) == 6 ]] ||
    note_failure "the sweep has not 3 values at 2 steps: $(cat plan)"
expect 2 '--vary: ramp.json: mu: expected 0.1 to 1' sweep ramp.json --vary mu=0.05,0.2 --engine plumb
expect 2 'did you mean mu' sweep ramp.json --vary mi=0.2 --engine plumb
"$PLUMB" sweep ramp.json --vary mu=0.2,0.4 --engine plumb --out sweep >/dev/null 2>&1
grep -q 'ramp.json mu=0.2 slope=0.25' sweep/sweep.json || note_failure "the sweep does not name its scenes"

# threshold: what is missing is said, and the answer is tan(tilt).
expect 2 'which parameter\? --vary NAME=LOW..HIGH; the file has mu, slope' threshold ramp.json --engine plumb
expect 2 'plain.json has no parameters' threshold plain.json --engine plumb
expect 2 'slope has no range there: write --vary slope=LOW..HIGH, or give it "low" and "high"' \
    threshold ramp.json --vary slope --engine plumb
expect 2 'expected mu from 0.1 to 1' threshold ramp.json --vary mu=0..1 --engine plumb
expect 2 'no chosen scenario has the parameter mi; did you mean mu' threshold ramp.json --vary mi --engine plumb
expect 2 'mu is what is searched for' threshold ramp.json --vary mu --set mu=0.3 --engine plumb
expect 2 'expected a rest' threshold <(sed 's/"expect": .*/"expect": {} }/; /"acceptance"/d' ramp.json) --vary mu --engine plumb
expect 0 'holds above it' threshold ramp.json --vary mu --engine plumb --json found.json --out found
expect 0 'holds below it' threshold ramp.json --vary slope=0..1 --tolerance 1e-3 --engine plumb --json slope.json --out slope
expect 2 'n from 1 to .*whole number' threshold tower --vary n=1..20 --engine plumb
python3 - <<'END' || note_failure "the threshold of a scene file is not tan(tilt)"
import json
for path, param, truth, above, tolerance in (("found.json", "mu", 0.25, True, 1e-5 * 0.9),
                                             ("slope.json", "slope", 0.5, False, 1e-3)):
    row, = json.load(open(path))
    # A block that has moved by less than 1 cm in 1 s still counts as held: a < 0.02 m/s^2, 0.0021 g.
    assert row["param"] == param and abs(row["value"] - truth) < 0.004, row
    assert row["holds_below"] == (not above) and row["bracket"][1] - row["bracket"][0] <= tolerance, row
    assert param not in row["params"], row
END

# completion.
"$PLUMB" __complete run ramp.json --set '' >offered
grep -q '^mu=' offered && grep -q '^slope=' offered || note_failure "completion does not offer the parameters"
exit $failed
