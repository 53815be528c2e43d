#!/usr/bin/env bash
# plumb check-engine as a user meets it: verdicts, exit codes, JSON, records, engines that crash or hang.
set -eu
command=check-engine
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
export PLUMB_CACHE=$directory/cache
broken=$BUILD/broken_setup.so
faulty=$BUILD/faulty_engine.so

expect 2 'which engine\?.*ode:quick.*shared object'
expect 2 'unknown engine "plumg"; did you mean "plumb"' plumg
expect 2 'unknown profile of engine plumb "fats"; did you mean "fast"' plumb:fats
expect 2 'cannot load ./none.so' ./none.so
expect 2 'there is no check "frictoin"; did you mean "?friction' plumb --check frictoin
expect 2 'takes an engine without a profile or options; found "plumb:fast"' plumb:fast --all-profiles
expect 0 '^friction +spheres slide' --list
# Nothing is checked when one of several engines is unknown.
expect 2 'unknown profile' plumb plumb:fats --check friction
[[ ! -s out ]] || note_failure "an engine was checked although another is unknown: $(cat out)"

# Every failure says what was expected, what was found and what is likely, within 80 columns.
expect 0 'plumb:default: conformance passed: 1 passed, 0 failed, 0 skipped' plumb --check quaternion-order
expect 1 'broken_setup:friction_product: conformance failed: 0 passed, 1 failed' \
    "$broken:friction_product" --check friction
grep -q '^ *expected  friction of bodies .*: 0.35' out || note_failure "no expectation in: $(cat out)"
grep -q '^ *found     0.16' out || note_failure "nothing found in: $(cat out)"
tr -s ' \n' ' ' <out | grep -q 'likely the product of the two materials' || note_failure "no cause in: $(cat out)"
COLUMNS=80 expect 1 '' "$broken:friction_low" --quiet
[[ $(wc -L <out) -le 80 ]] || note_failure "a line is longer than 80 columns: $(cat out)"
grep -q '^  ok ' out && note_failure "--quiet prints checks that passed: $(cat out)"

# Every profile of several engines, as text and as JSON.
expect 0 'plumb:fast: conformance passed' plumb --all-profiles --check friction --json all.json
"$PLUMB" check-engine "$broken:good" "$broken:restitution_low" --check restitution --json - >two.json && code=0 || code=$?
[[ $code == 1 ]] || note_failure "--json -: exit code $code, not 1"
python3 - <<'END' || note_failure "the JSON is wrong"
import json
everything = json.load(open("all.json"))
assert everything["schema"] == "plumb.conformance/1"
assert [e["label"] for e in everything["engines"]] == ["plumb:default", "plumb:accurate", "plumb:fast"]
good, low = json.load(open("two.json"))["engines"]
assert good["outcome"] == "passed" and low["outcome"] == "failed" and len(low["engine_binary"]) == 16
assert "expected" not in good["checks"][0]
assert all(low["checks"][0][key] for key in ("check", "title", "expected", "found", "likely"))
END

# An engine that crashes, exits or hangs, when it is loaded or later, has failed; the others are checked.
expect 1 'found     SIGABRT during the check' "$faulty:create" --check friction
expect 1 'found     no end within 1 s: killed during the check' "$faulty:hang" --check friction --timeout 1
expect 1 'plumb:default: conformance passed' "$faulty:exit" plumb --check friction
echo 'void quit(void); __attribute__((constructor)) void quit(void) { __builtin_trap(); }' >trap.c
cc -shared -fPIC -o trap.so trap.c
expect 1 'FAIL  load .*' ./trap.so

# A profile may refuse a shape that its engine claims, except spheres and planes.
cat >picky.py <<'END'
import json, sys
for request in map(json.loads, sys.stdin):
    hello = {"protocol": "plumb.engine/1", "name": "picky", "version": "1", "capabilities": ["rotation", "plane", "sphere", "box"]}
    answer = hello if request["request"] == "hello" else {"error": "none today", "unsupported": True}
    print(json.dumps({"id": request["id"], **answer}), flush=True)
END
expect 0 'skip +box-rests +none today' 'exec:python3 picky.py' --check box-rests
expect 1 'found +none today' 'exec:python3 picky.py' --check sphere-rests

# What was found is kept when all checks were made with the profile's own options.
expect 0 'conformance passed' plumb
expect 0 'conformance passed' plumb:accurate,iterations=50000
expect 0 'conformance passed' plumb:fast --check friction
ls cache | grep -q 'plumb-default.json' || note_failure "nothing was kept: $(ls cache)"
ls cache | grep -qE 'accurate|fast' && note_failure "kept what was not all of it: $(ls cache)"
echo >file
PLUMB_CACHE=$directory/file/none expect 0 'warning: reports will not know of this' plumb
expect 3 'results.json' plumb --check friction --json "$directory/none/results.json"
exit $failed
