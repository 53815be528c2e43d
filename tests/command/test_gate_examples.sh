#!/usr/bin/env bash
# The CI jobs of compare/gate/examples work when copied: their own commands are run as they stand, first to
# make a baseline, then against it, then with a fault in the results.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

# What the jobs find after clone and build.
mkdir -p plumb/build/compare
ln -s "$PLUMB" plumb/build/compare/plumb
ln -s "$BUILD/faulty_engine.so" mine.so
export GITHUB_STEP_SUMMARY=$directory/page.md

# commands FILE: the calls of plumb in a job, a line each.
commands() {
    python3 - "$1" <<'END'
import re, sys
calls, call = [], None
for line in open(sys.argv[1]):
    text = line.strip()
    if text.startswith("./plumb/build/compare/plumb "):
        call = []
        calls.append(call)
    elif not text.startswith("--"):
        call = None
    if call is not None:
        call.append(re.sub(r" *\\$", "", text))
print("\n".join(" ".join(call) for call in calls))
END
}

for job in github gitlab; do
    example=$SOURCE/compare/gate/examples/$job.yml
    commands "$example" >calls
    [[ $(wc -l <calls) == 2 ]] || note_failure "$job: expected two calls of plumb: $(cat calls)"
    run=$(sed -n 1p calls) gate=$(sed -n 2p calls)
    # The engine of the tests has spheres alone, which fall: it is unsupported in these scenes.
    bash -c "${run/tower/free-fall tower}" >log 2>&1 || note_failure "$job: $run: $(cat log)"
    rm -f plumb-baseline.json page.md
    bash -c "$gate" >log 2>&1 && note_failure "$job: passed without a baseline"
    bash -c "$gate --update-baseline" >log 2>&1 || note_failure "$job: no baseline: $(cat log)"
    bash -c "$gate" >log 2>&1 || note_failure "$job: $gate: $(cat log)"
    grep -q 'gate passed' log || note_failure "$job: no summary: $(cat log)"
    sed -i '/"faulty:good".*"free-fall"/s/"outcome":"[a-z]*"/"outcome":"crashed"/' plumb-gate/results.jsonl
    actual=0
    bash -c "$gate" >log 2>&1 || actual=$?
    [[ $actual == 1 ]] || note_failure "$job: a crash is not seen: exit code $actual: $(cat log)"
done
grep -q 'failures="1"' plumb-gate.xml || note_failure "gitlab: no failure in the report"
exit $failed
