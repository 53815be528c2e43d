#!/usr/bin/env bash
# After a scene file was edited, or an engine was built again, a command with --resume says what it says of the new
# scene or engine alone, and how many old results it leaves out.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
# shellcheck source=tests/support/small_engine.sh
source "$SOURCE/tests/support/small_engine.sh"

# A ball in free fall that should stay where it is: how far it falls depends on gravity g, on its velocity at the
# start (0, then 0.02 m/s) and on the drift of the engine.
cat >old.json <<'END'
{ "plumb_scene": 1, "name": "ball", "dt": 0.016666666666666666, "duration": 0.1,
  "parameters": { "g": { "value": 1, "low": 0.1, "high": 100 } },
  "gravity": [0, 0, "-g"],
  "materials": { "m": { "friction": 0, "restitution": 0 } },
  "bodies": [ { "name": "ball", "material": "m", "mass": 1, "shape": { "type": "sphere", "radius": 0.1 },
                "position": [0, 0, 1], "velocity": [0, 0, 0] } ],
  "expect": { "rest": [ { "body": "ball", "position": [0, 0, 1] } ], "collapse_distance": 0.01, "acceptance": 0.02 } }
END
sed 's/"velocity": \[0, 0, 0\]/"velocity": [0, 0, 0.02]/' old.json >new.json
small_engine old.so -DDRIFT=1e-3
small_engine new.so

# What a command found, without what depends on times.
cat >found.py <<'END'
import json, re, sys
TIMES = ("seconds", "started", "command", "host", "plumb")

def strip(value):
    if isinstance(value, dict):
        if value.get("deterministic") is False:
            return None
        return {key: strip(item) for key, item in value.items() if key not in TIMES}
    return [strip(item) for item in value] if isinstance(value, list) else value

def page(path):
    text = open(path).read()
    data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S)[1])
    measured = {metric["name"] for metric in data["metrics"] if metric["measured"]}
    for case in data["cases"]:
        for cell in case["cells"]:
            cell["metrics"] = {name: item for name, item in cell["metrics"].items() if name not in measured}
    return [data["runs"], data["engines"], data["cases"], data["document"]]

def sweep(path):
    data = json.load(open(path))
    keys = ("label", "dt", "state", "outcome", "reason", "repeats", "changes", "error_as_found", "scene")
    points = [{key: point.get(key) for key in keys} for point in data["points"]]
    return [data["runs"], data["several_builds"], [engine["name"] for engine in data["engines"]],
            [scene["name"] for scene in data["scenes"]], points]

READERS = {"page": page, "sweep": sweep, "json": lambda path: json.load(open(path)),
           "tune": lambda path: [[row["metrics"], row["outcome"]] for row in json.load(open(path))["on"]]}
print(json.dumps(strip(READERS[sys.argv[1]](sys.argv[2])), indent=1, sort_keys=True))
END

# changed NAME KIB KIND OUTPUT ARGUMENT...: `plumb ARGUMENT...` is made for the old scene, goes on for the new one, and
# finds what a new study finds; the same for the old and the new engine. Where KIB is not 0 the first part breaks off
# where its file has reached that size.
changed() {
    local name=$1 kib=$2 kind=$3 output=$4 what actual
    shift 4
    for what in json so; do
        mkdir "$name.$what" "$name.$what.new"
        for folder in "$name.$what" "$name.$what.new"; do
            cp new.json "$folder/ball.json"
            cp new.so "$folder/small.so"
        done
        cp "old.$what" "$name.$what/$([[ $what == so ]] && echo small.so || echo ball.json)"
        (cd "$name.$what.new" && "$PLUMB" "$@" >out 2>err </dev/null) || note_failure "$name: $(cat "$name.$what.new/err")"
        cd "$name.$what"
        actual=0
        (if [[ $kib != 0 ]]; then ulimit -f "$kib"; fi; exec "$PLUMB" "$@" >out 2>err </dev/null) || actual=$?
        [[ $kib == 0 || $actual == 3 ]] || note_failure "$name, $what: the first part did not break off: $actual"
        python3 ../found.py "$kind" "$output" >old.found 2>/dev/null || true
        cp ../new.json ball.json
        cp ../new.so other.so && mv other.so small.so
        actual=0
        "$PLUMB" "$@" --resume >out 2>err </dev/null || actual=$?
        [[ $actual == 0 ]] || note_failure "$name, $what: --resume: $actual: $(cat err)"
        python3 ../found.py "$kind" "$output" >found
        cd ..
        (cd "$name.$what.new" && python3 ../found.py "$kind" "$output" >found)
        cmp -s "$name.$what/found" "$name.$what.new/found" || note_failure "$name: after another $what it finds
$(diff "$name.$what/found" "$name.$what.new/found" | head -n 20)"
        ! cmp -s "$name.$what/old.found" "$name.$what.new/found" || note_failure "$name: old and new $what find the same"
    done
}

# left_out NAME COUNT COUNT: the continued command says how many results of old scenes and of old builds it leaves out.
left_out() {
    grep -qE "^$2 results? (is|are) left out: .* scene .* edited" "$1.json/err" ||
        note_failure "$1: it does not say that $2 results are of the old scene: $(cat "$1.json/err")"
    grep -qE "^$3 results? (is|are) left out: .* engine .* rebuilt" "$1.so/err" ||
        note_failure "$1: it does not say that $3 results are of the old engine: $(cat "$1.so/err")"
}

changed compare 0 page report/index.html compare ball.json --engine ./small.so --no-recordings --no-reference
left_out compare 1 1
changed sweep 0 sweep sweep/sweep.json sweep ball.json --engine ./small.so --vary dt=1/60,1/120 --vary iterations=1,2 \
    --changes 1
left_out sweep 8 8
changed ensemble 0 json ensemble/ensemble.json ensemble ball.json --engine ./small.so:one --engine ./small.so:two \
    --members 8 --jobs 1
changed threshold 0 json t.json threshold ball.json --vary g=0.1..100 --engine ./small.so --json t.json
changed metamorphic 4 json m.json metamorphic ball.json --engine ./small.so --check rotate --check shift --json m.json

# The gate, of what compare left.
for what in json so; do
    for folder in "compare.$what" "compare.$what.new"; do
        "$PLUMB" gate "$folder/report" --baseline "$folder/b.json" --update-baseline 2>"$folder/err"
        python3 found.py json "$folder/b.json" >"$folder/found"
    done
    cmp -s "compare.$what/found" "compare.$what.new/found" || note_failure "gate: after another $what it finds
$(diff "compare.$what/found" "compare.$what.new/found")"
done
left_out compare 1 1

changed tune 0 tune tune/tune.json tune ball.json --engine ./small.so --target 'rest_position_error<=0.1' --budget 1 \
    --fix dt=1/60
exit $failed
