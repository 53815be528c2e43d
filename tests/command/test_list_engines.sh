#!/usr/bin/env bash
# plumb list engines shows every setting of every configuration.
set -eu
source "$SOURCE/tests/support/command.sh"
unset PLUMB_PROFILES

"$PLUMB" list engines >listed.txt
"$PLUMB" list engines --json >listed.json
python3 - "$SOURCE" >wrong.txt <<'END'
import glob, json, sys

source = sys.argv[1]
listed = open("listed.txt").read()
engines = json.load(open("listed.json"))
described = {e["name"]: e for e in map(json.load, map(open, glob.glob(source + "/compare/adapters/*/engine.json")))}

def wrong(text):
    print(text)

if [e["name"] for e in engines] != sorted(described, key=lambda name: described[name]["place"]):
    wrong("the engines are not those that are described, in their order")
engines = [e for e in engines if e["present"]]

for engine in engines:
    name = engine["name"]
    options = {o["name"]: o for o in engine["options"]}
    text = listed[listed.index("\n" + name + " ") if "\n" + name + " " in listed else 0:]
    for option in options:
        if "\n    " + option + " " not in text:
            wrong(f"{name}: the text does not name option {option}")
    for profile in engine["profiles"]:
        if f"  {name}:{profile['name']} " not in listed:
            wrong(f"{name}: the text does not name profile {profile['name']}")
        cited = {s["option"] for s in profile["sources"] if s["option"] is not None}
        if profile["sources"] and cited != set(profile["changed"]):
            wrong(f"{name}:{profile['name']}: cites {cited}, changes {set(profile['changed'])}")
        for option, value in profile["changed"].items():
            if not options[option]["min"] <= value <= options[option]["max"]:
                wrong(f"{name}:{profile['name']}: {option}={value} is not allowed")
            if f"      {option}={value:.6g}" not in listed:
                wrong(f"{name}:{profile['name']}: the text does not show {option}={value:.6g}")
    for tuned in engine["tuned"]:
        if tuned["from"] != "plumb" or "command" not in tuned or "budget" not in tuned:
            wrong(f"{name}:{tuned['name']}: does not say how it was made")
        if set(tuned["options"]) != set(options):
            wrong(f"{name}:{tuned['name']}: is not of the engine's options")
    if engine["words"] != described[name]["words"]:
        wrong(f"{name}: not the words of its description")
long_lines = [l for l in listed.splitlines() if len(l.encode()) > 120]
if long_lines:
    wrong(f"lines of more than 120 bytes: {long_lines}")
END
[[ ! -s wrong.txt ]] || note_failure "$(cat wrong.txt)"

# The profile that comes with Plumb runs; the user's file of the same name comes first.
expect 0 'slop' list engines plumb
expect 0 'ok' run slope-stick --duration 0.1 --engine plumb:tuned
cat >mine.json <<'END'
{"schema": "plumb.profile/1", "name": "tuned", "engine": "plumb", "profile": "fast", "options": {"slop": 0.003}}
END
PLUMB_PROFILES=mine.json expect 0 'from mine.json' list engines plumb
PLUMB_PROFILES=mine.json expect 0 'plumb:fast,slop=0.003' run slope-stick --duration 0.1 --engine plumb:tuned
PLUMB_PROFILES=nowhere.json expect 3 'nowhere.json' list engines plumb

exit $failed
