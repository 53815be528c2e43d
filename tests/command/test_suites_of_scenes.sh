#!/usr/bin/env bash
# The scenes of the suites `reported` and `field` have right answers: an accurate engine has a verdict "accurate" on
# every one. An engine in which nothing touches, which has spheres and planes, has it on none of theirs.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

verdicts() {
    "$PLUMB" compare --suite "$1" --engine "$2" --no-reference --timeout 60 --out "$1-runs" >out 2>err ||
        note_failure "compare --suite $1 --engine $2: $(cat err)"
    python3 - "$1-runs" <<'END'
import json, sys
for line in open(sys.argv[1] + "/results.jsonl"):
    run = json.loads(line)
    print(run["verdict"] or run["outcome"], run["scenario"], run["params"], run["verdict_reason"] or "")
END
}

for suite in reported field; do
    verdicts $suite plumb:accurate >right.txt
    count=$("$PLUMB" list suites --json | python3 -c '
import json, sys
print({suite["name"]: len(suite["scenarios"]) for suite in json.load(sys.stdin)}[sys.argv[1]])' $suite)
    [[ $(grep -c '^accurate ' right.txt) == "$count" ]] ||
        note_failure "plumb:accurate, of $count scenes of $suite: $(grep -v '^accurate ' right.txt)"
    rm -r $suite-runs
done

verdicts reported "$BUILD/faulty_engine.so:good" >falling.txt
for scenario in drop-coefficients elastic-bounces late-bounces fast-marble pool-ball long-roll; do
    grep -q "^inaccurate $scenario " falling.txt || note_failure "an engine of free fall: $(grep " $scenario " falling.txt)"
done
exit $failed
