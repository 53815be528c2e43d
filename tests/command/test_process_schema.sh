#!/usr/bin/env bash
# Conversations with process engines are as the protocol's schema says.
set -eu
source "$SOURCE/tests/support/command.sh"
python3 -c 'import jsonschema' 2>/dev/null || exit 77 # Debian package python3-jsonschema

"$PLUMB" new-engine --process toy >/dev/null
record="python3 $SOURCE/tests/support/record_conversation.py said.jsonl"
"$PLUMB" check-engine "exec:$record python3 toy/engine.py" --check gravity --check contact-normal --quiet || note_failure "the toy engine fails"
for scenario in "medley --set n=8" rocket; do
    "$PLUMB" run $scenario --duration 0.05 --engine "exec:$record $BUILD/process_server plumb" >/dev/null || note_failure "$scenario fails"
done
python3 - "$SOURCE/compare/adapters/process/protocol.schema.json" <<'END' || note_failure "the schema does not hold"
import json, sys
import jsonschema
validator = jsonschema.Draft202012Validator(json.load(open(sys.argv[1])))
said = [json.loads(line) for line in open("said.jsonl")]
faults = [error for message in said for error in validator.iter_errors(message)]
assert {m.get("request") for m in said} >= {"hello", "create", "frame", "step", "pair", "destroy"}, "not all requests were made"
wrong = dict(said[-1], frame="high", id="1")
assert list(validator.iter_errors(wrong)), "a wrong message passes"
if faults:
    sys.exit("\n".join(f"{list(fault.absolute_path)}: {fault.message[:200]}" for fault in faults[:5]))
END
exit $failed
