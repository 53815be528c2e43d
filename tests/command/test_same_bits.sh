#!/usr/bin/env bash
# A scene that expects the same bits is run a second time in its process: an engine whose second world differs is
# inaccurate, and the verdict says from which step on.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
# shellcheck source=tests/support/small_engine.sh
source "$SOURCE/tests/support/small_engine.sh"

scene() {
    printf '{ "plumb_scene": 2, "duration": 0.5, "dt": 0.05, "bodies": [ { "name": "ball", "mass": 1,
      "shape": { "type": "sphere", "radius": 0.5 } } ], "expect": { "same_bits": %s } }\n' "$1"
}

# The verdict and its reason.
verdict() {
    "$PLUMB" run "$1" --engine "$2" --json - | python3 -c '
import json, sys
result = json.load(sys.stdin)
print(result["verdict"], result["verdict_reason"])'
}

expect() {
    [[ $2 == "$1" ]] || note_failure "expected '$1', found '$2'"
}

small_engine right.so
small_engine later.so -DLATER_DRIFT=1e-15
scene true >same.json
scene false >free.json
scene 1 >bad.json

expect "accurate None" "$(verdict same.json ./right.so)"
expect "inaccurate bits: a second run differs in 6 steps, from step 5 on, expected none" "$(verdict same.json ./later.so)"
expect "None the scene states no acceptance" "$(verdict free.json ./later.so)"

# The steps of the second run are not counted.
steps=$("$PLUMB" run same.json --engine plumb --json - | python3 -c 'import json, sys; print(json.load(sys.stdin)["steps"]["done"])')
expect 10 "$steps"

"$PLUMB" run bad.json --engine ./right.so >out 2>err && note_failure "a number for same_bits was accepted"
grep -q 'bad.json:2:.*expect.same_bits: expected true or false, found 1' err || note_failure "$(cat err)"
"$PLUMB" scene eight-balls | grep -q '"same_bits": true' || note_failure "eight-balls does not expect the same bits"
exit $failed
