#!/usr/bin/env bash
# The engines that are linked by default conform to the engine ABI, each profile of the default comparison.
set -eu
source "$SOURCE/tests/support/command.sh"

source "$SOURCE/compare/packages.sh"
readarray -t specs < <("$PLUMB" list engines --json | python3 -c '
import json, sys
for engine in json.load(sys.stdin):
    if engine["name"] not in sys.argv[1:]:
        continue
    for profile in engine.get("profiles", []):
        if profile["in_default_comparison"]:
            print(engine["name"] + ":" + profile["name"])' $(engines linked))
[[ ${#specs[@]} -ge 3 ]] || note_failure "plumb alone has three profiles in the default comparison: ${specs[*]}"

actual=0
"$PLUMB" check-engine "${specs[@]}" >out 2>err || actual=$?
[[ $actual == 0 ]] || note_failure "check-engine ${specs[*]}: exit code $actual: $(grep -A3 FAIL out; cat err)"
for spec in "${specs[@]}"; do
    grep -q "^$spec: conformance passed" out || note_failure "$spec has not passed: $(grep "^$spec: " out)"
done

exit $failed
