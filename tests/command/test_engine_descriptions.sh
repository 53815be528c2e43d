#!/usr/bin/env bash
# Descriptions of engines are whole; what is made from them is not stale.
set -eu
source "$SOURCE/tests/support/command.sh"
source "$SOURCE/compare/packages.sh"

for engine in $(engines linked module script); do
    missing_wanted=()
    has_module() { false; }
    test() { false; }
    want_engine "$engine"
    echo "$engine $(engine_member "$engine" adapter) $(engine_member "$engine" speed) ${missing_wanted[*]}"
done >read_in_shell
unset -f test
python3 - "$SOURCE/compare" "$BUILD" <<'END_PYTHON' >wrong.txt
import glob, json, os, re, sys

source, build = sys.argv[1:]
MEMBERS = {"name", "title", "place", "language", "adapter", "words", "colour"}
OPTIONAL = {"linked": {"hello", "debian", "libraries", "headers", "family", "makers", "speed", "results",
                       "not_tuned", "reference"},
            "module": {"hello", "debian", "headers", "family", "makers", "speed", "results"},
            "script": {"hello", "script", "npm", "npm_version", "family", "makers"}}
engines = []
for path in glob.glob(source + "/adapters/*/engine.json"):
    with open(path) as file:
        engines.append(json.load(file))
    engine = engines[-1]
    if engine["name"] != os.path.basename(os.path.dirname(path)):
        print(f"{path}: has another name than its folder")
    if not MEMBERS <= engine.keys() <= MEMBERS | OPTIONAL[engine["adapter"]]:
        print(f"{path}: has other members than README.md describes: {MEMBERS ^ engine.keys()}")
    if not re.fullmatch("#[0-9a-f]{6}", engine["colour"]):
        print(f"{path}: colour: {engine['colour']}")
    if list(engine["words"]) != list(engines[0]["words"]) or not all(engine["words"].values()):
        print(f"{path}: words: {list(engine['words'])}")
HELLO = {"": {"description", "runtime", "residual_unit", "capabilities", "contacts", "precision", "integrator", "gyroscopic",
              "substeps", "reads", "profiles", "options", "sources"},
         "profiles": {"name", "help", "in_default_comparison", "step_code", "values"},
         "options": {"name", "value", "min", "max", "integer", "unit", "help", "code", "tune"},
         "sources": {"profile", "option", "text"}}
for engine in engines:
    path, hello = engine["name"], engine.get("hello", {"profiles": []})
    names = {key: [item["name"] for item in hello.get(key, ())] for key in ("profiles", "options")}
    used = {"profiles": [source["profile"] for source in hello.get("sources", ())],
            "options": [source["option"] for source in hello.get("sources", ()) if "option" in source]}
    for profile in hello["profiles"]:
        used["options"] += profile.get("values", ())
    for option in hello.get("options", ()):
        used["profiles"] += option.get("tune", {"profiles": []})["profiles"]
    for key, members in HELLO.items():
        for item in hello.get(key, ()) if key else [hello]:
            if not item.keys() <= members:
                print(f"{path}: {key}: has other members than PROTOCOL.md: {item.keys() - members}")
    for key in used:
        if not set(used[key]) <= set(names[key]):
            print(f"{path}: names {key} that there are not: {set(used[key]) - set(names[key])}")
engines.sort(key=lambda e: e["place"])
if [e["place"] for e in engines] != list(range(1, len(engines) + 1)):
    print("places are not 1, 2, 3, ...")
if len({e["colour"] for e in engines}) != len(engines):
    print("two engines have one colour")
packages = {e["name"]: [p["package"] for p in e.get("debian", ())] for e in engines}
lines = [" ".join([e["name"], e["adapter"], e.get("speed", ""), *packages[e["name"]]]).split() for e in engines]
if [line.split() for line in open("read_in_shell")] != lines:
    print("compare/packages.sh reads something else")
locked = json.load(open(source + "/adapters/web/package-lock.json"))["packages"][""]["dependencies"]
if locked != {e["npm"]: e["npm_version"] for e in engines if "npm" in e}:
    print("web/package-lock.json has other packages or versions")
if json.load(open(build + "/lib/plumb/web/package.json"))["dependencies"] != locked:
    print("package.json of the build has other packages or versions")
END_PYTHON
[[ ! -s wrong.txt ]] || note_failure "$(cat wrong.txt)"
python3 "$SOURCE/compare/adapters/engines_page.py" | diff - "$SOURCE/compare/ENGINES.md" ||
    note_failure "ENGINES.md is stale: python3 compare/adapters/engines_page.py >new && mv new compare/ENGINES.md"
exit $failed
