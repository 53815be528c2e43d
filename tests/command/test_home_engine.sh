#!/usr/bin/env bash
# Engines are peers unless --home names one: then compare, report and sweep begin with where that one is worse.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
# shellcheck source=tests/support/small_engine.sh
source "$SOURCE/tests/support/small_engine.sh"

small_engine exact.so
small_engine drifting.so -DDRIFT=1e-6
engines=(--engine ./exact.so,label=exact --engine ./drifting.so,label=drifting)
fall=(free-fall --duration 0.1)
command=

# What is said of the engine that this program has: its name but as the program's own.
silent() {
    ! grep -niE 'where plumb|of plumb |than plumb|plumb is worse|plumb loses|\bours?\b|"home": *true|our own' "$@" ||
        note_failure "a word about the built-in engine, which was not run"
}

# ---- Without a home engine
expect 0 'exact' compare "${fall[@]}" "${engines[@]}" --out peers --no-recordings
cp out peers.txt
silent peers.txt peers/summary.md
expect 0 'exact +drifting|drifting +exact' sweep "${fall[@]}" "${engines[@]}" --vary dt=1/60,1/120 --out swept
cp out swept.txt
silent swept.txt swept/sweep.json
python3 - <<'END' || failed=1
import json, re
sweep = json.load(open("swept/sweep.json"))
names = [engine["name"] for engine in sweep["engines"]]
pairs = {(names[pair["first"]], names[pair["second"]]) for pair in sweep["pairs"]}
assert pairs == {("drifting", "exact")}, pairs
assert sweep["losses"] == [] and "home" not in sweep and not any(engine["home"] for engine in sweep["engines"])
page = open("peers/index.html").read()
data = json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)[1])
assert not any("loses" in section["title"] for section in data["document"]["sections"])
assert [engine["name"] for engine in data["engines"]] == ["drifting", "exact"]
END

# ---- With one: its columns come first, and where it is worse
expect 0 '' report peers --home exact --out home_report
cp home_report/summary.md exact.md
expect 0 '' report peers --home drifting --out home_report --force
grep -q '^## Where drifting loses$' home_report/summary.md || note_failure "the report does not speak for its home engine"
grep -q '^drifting is worse than the best other engine in' home_report/summary.md || note_failure "no count of losses"
grep -q '^| free-fall [^|]*| discrete\\_error | drifting |' home_report/summary.md ||
    note_failure "the loss is not listed: $(cat home_report/summary.md)"
grep -q '^| case (primary error and its bound) | exact | drifting |$' exact.md || note_failure "exact is not first"
grep -q '^## Where exact loses$' exact.md || note_failure "exact is no home engine"
expect 0 '^Where drifting loses$' sweep "${fall[@]}" "${engines[@]}" --vary dt=1/60,1/120 --out swept --resume --home drifting
expect 0 'Where small:one loses' compare "${fall[@]}" --engine ./exact.so --engine ode:quick --home small:one --out spoken
grep -q '"home"' spoken/results.jsonl && note_failure "results remember the home engine"

# ---- One that was not run
expect 2 '.-home exakt: the results have no run of that engine; did you mean exact' report peers --home exakt --out none
exit $failed
