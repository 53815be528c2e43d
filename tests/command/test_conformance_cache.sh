#!/usr/bin/env bash
# What check-engine found reaches results and reports, for that binary and profile alone; a record that
# is damaged or cannot be written harms nothing.
set -eu
source "$SOURCE/tests/support/command.sh"
export PLUMB_CACHE=$directory/cache

# field KEY: that key of the one result of the last comparison.
field() {
    python3 -c 'import json, sys; print(json.loads(open("results/results.jsonl").readline())[sys.argv[1]])' "$1"
}

# reported TEXT: a comparison of plumb:fast says TEXT of the engine.
reported() {
    rm -rf results
    "$PLUMB" compare free-fall --engine plumb:fast --out results >table 2>err ||
        note_failure "compare: exit code $?: $(cat err)"
    for file in table results/index.html results/summary.md; do
        grep -q "$1" "$file" || note_failure "$file does not say \"$1\": $(grep -i conform table)"
    done
}

reported 'not verified: run plumb check-engine plumb:fast'
[[ $(field conformance) == None && $(field engine_spec) == plumb:fast ]] || note_failure "a record from nowhere"
before=$(field run)

expect 0 'plumb:fast: conformance passed' check-engine plumb:fast
reported 'conformance passed ([1-9][0-9]* checks, plumb [0-9.]*)'
field conformance | grep -q "'outcome': 'passed'" || note_failure "results have no record: $(field conformance)"
[[ $(field run) == "$before" ]] || note_failure "conformance is no part of a run's identity"
expect 0 'plumb:accurate .*not verified' compare free-fall --engine plumb:accurate --out other

for record in "$PLUMB_CACHE"/conformance-*-plumb-fast.json; do
    truncate -s 100 "$record"
done
reported 'not verified: run plumb check-engine plumb:fast'

# The faulty engine has no contacts: what is dropped on a plane falls through.
expect 1 'faulty:good: conformance failed' check-engine "$BUILD/faulty_engine.so:good"
expect 0 'faulty:good +1 +conformance FAILED: [1-9][0-9]* of [1-9][0-9]* checks' \
    compare free-fall --engine "$BUILD/faulty_engine.so:good" --out faulty

# A check of some options, or one check, says nothing of the profile.
rm -r "$PLUMB_CACHE"
expect 0 'passed' check-engine plumb:fast,slop=1e-3 --check gravity
reported 'not verified'

touch file
PLUMB_CACHE=$directory/file expect 0 'conformance passed' check-engine plumb:fast
grep -q 'warning.*file' err || note_failure "a record that cannot be kept has no warning: $(cat err)"
PLUMB_CACHE=$directory/file expect 0 'not verified' compare free-fall --engine plumb:fast --out no-cache

exit $failed
