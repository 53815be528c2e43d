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

schema = json.load(open(sys.argv[1]))
said = [json.loads(line) for line in open("said.jsonl")]
pairs = list(zip(said[::2], said[1::2]))

def faults(message, name):
    part = {"$schema": schema["$schema"], "$defs": schema["$defs"], "$ref": "#/$defs/" + name}
    return [f"{name} {list(f.absolute_path)}: {f.message[:200]}" for f in jsonschema.Draft202012Validator(part).iter_errors(message)]

wrong = []
for request, answer in pairs:
    wrong += faults(request, "request") + faults(answer, request["request"] + "_answer")
    wrong += [f"{answer} is an error"] if not faults(answer, "error_answer") else []

REQUIRED = {"hello": {"id", "protocol", "name", "version"}, "create": {"id"}, "frame": {"id", "frame"},
            "step": {"id", "cpu", "frame"}, "pair": {"id", "friction", "restitution"}, "destroy": {"id"}}
for name, keys in REQUIRED.items():
    request, answer = next((pair for pair in pairs if pair[0]["request"] == name), (None, None))
    if request is None:
        wrong.append(f"no request {name} was made")
        continue
    for key in answer:
        without = {k: v for k, v in answer.items() if k != key}
        if bool(faults(without, name + "_answer")) != (key in keys):
            wrong.append(f"{name}: the key {key} is " + ("not required" if key in keys else "required"))
        if key in keys and not faults(dict(answer, **{key: True}), name + "_answer"):
            wrong.append(f"{name}: true passes as {key}")
    for key in request:
        if not faults({k: v for k, v in request.items() if k != key}, "request"):
            wrong.append(f"{name}: the request passes without {key}")
if not faults({"id": 1}, "error_answer") or faults({"id": 1, "error": "full", "unsupported": True}, "error_answer"):
    wrong.append("an error is not as it should be")
sys.exit("\n".join(wrong[:5]) or 0)
END
exit $failed
