#!/usr/bin/env bash
# The scenes of the suite `reported` have right answers: an accurate engine has a verdict "accurate" on every one. An
# engine in which nothing touches, which has spheres and planes, has it on none of theirs.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

verdicts() {
    "$PLUMB" compare --suite reported --engine "$1" --no-reference --timeout 60 --out "$2" >out 2>err ||
        note_failure "compare $1: $(cat err)"
    python3 - "$2" <<'END'
import json, sys
for line in open(sys.argv[1] + "/results.jsonl"):
    run = json.loads(line)
    print(run["verdict"] or run["outcome"], run["scenario"], run["params"], run["verdict_reason"] or "")
END
}

verdicts plumb:accurate right >right.txt
count=$("$PLUMB" list suites --json |
    python3 -c 'import json, sys; print({s["name"]: len(s["scenarios"]) for s in json.load(sys.stdin)}["reported"])')
[[ $(grep -c '^accurate ' right.txt) == "$count" ]] ||
    note_failure "plumb:accurate, of $count scenes: $(grep -v '^accurate ' right.txt)"

verdicts "$BUILD/faulty_engine.so:good" falling >falling.txt
for scenario in drop-coefficients elastic-bounces late-bounces fast-marble pool-ball long-roll; do
    grep -q "^inaccurate $scenario " falling.txt || note_failure "an engine of free fall: $(grep " $scenario " falling.txt)"
done
exit $failed
