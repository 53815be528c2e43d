#!/usr/bin/env bash
# Every page, opened in Chromium without a window. Skipped where Chromium or npm is absent.
set -eu
source "$SOURCE/tests/support/command.sh"
chromium=${CHROMIUM:-$(command -v chromium || true)}
if [[ -z $chromium ]] || ! command -v npm >/dev/null; then
    echo "Chromium or npm is absent: the pages are not tested" >&2
    exit 77
fi
modules=$BUILD/browser
if [[ ! -e $modules/installed || $SOURCE/tests/browser/package-lock.json -nt $modules/installed ]]; then
    mkdir -p "$modules"
    cp "$SOURCE"/tests/browser/package{,-lock}.json "$modules"
    (cd "$modules" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error) >&2 || exit 77
    touch "$modules/installed"
fi

quietly() {
    "$PLUMB" "$@" >made.txt 2>&1 || { cat made.txt >&2; exit 1; }
}
quietly compare --engine plumb --engine plumb:fast --engine ode:quick --engine bullet:si --out canonical
quietly compare tower slope-slide --engine plumb --engine "$BUILD/frozen_engine.so" --out frozen
quietly sweep tower --engine plumb --engine ode:quick --vary dt=1/240..1/60 --out sweep
quietly threshold card-house --engine plumb --engine ode:quick --json threshold.json
quietly metamorphic tower --engine plumb --engine ode:quick
quietly ensemble wall-collapse --set rows=3 --set columns=3 --engine plumb --engine bullet:si \
    --members 7 --out ensemble
quietly report threshold.json --out studies
quietly report metamorphic/metamorphic.json --out studies
quietly list scenarios --page studies/catalogue.html
cp sweep/sweep.html ensemble/ensemble.html studies

# Results with names that no page may take for markup, and two thousand runs.
python3 - <<'END'
import copy, json, os
row = json.loads(open("canonical/results.jsonl").readline())
names = ['</script><script>alert(1)</script>', '"\'`<img src=x onerror=alert(2)>', 'x' * 10000, 'ab\u001b[2J\u202ec',
         '${alert(3)}{{4}}', '<!--', ']]>', '__proto__']
os.makedirs("hostile"), os.makedirs("many")
with open("hostile/results.jsonl", "w") as out:
    for i, name in enumerate(names):
        bad = copy.deepcopy(row)
        bad.update(scenario=name, label=name[:200], engine_version=name[:200], output=name, reason=name, verdict="failed",
                   verdict_reason=name, outcome="crashed", run=f"{i:016x}", primary_error=name[:40])
        out.write(json.dumps(bad) + "\n")
with open("many/results.jsonl", "w") as out:
    for i in range(2000):
        more = copy.deepcopy(row)
        more.update(seed=i // 10, label=f"engine{i % 10}:p", engine=f"engine{i % 10}", run=f"{i:016x}")
        out.write(json.dumps(more) + "\n")
END
quietly report hostile --out hostile-page
quietly report many --out many-page
# Recordings that are cut short, and a scene in which nothing can move.
mkdir -p damaged/recordings
cp frozen/results.jsonl damaged
for file in frozen/recordings/*.json; do
    head -c 700 "$file" >"damaged/recordings/${file##*/}"
done
quietly report damaged --out damaged-page
"$PLUMB" scene tower --set n=1 | python3 -c '
import json, sys
scene = json.load(sys.stdin)
scene["bodies"] = [body for body in scene["bodies"] if body.get("static")]
scene.pop("expect", None)
json.dump(scene, open("still.json", "w"))'
quietly compare ./still.json --engine plumb --engine ode --out still
for format in svg png pdf; do
    quietly report canonical --figure tower:t=1 --format $format --out figures
done
[[ $(head -c 4 figures/tower-t-1.svg) == "<svg" ]] || note_failure "the SVG is none"
[[ $(head -c 4 figures/tower-t-1.png | tail -c 3) == PNG ]] || note_failure "the PNG is none"
[[ $(head -c 4 figures/tower-t-1.pdf) == %PDF ]] || note_failure "the PDF is none"
expect 2 'no scenario "nothing"' report canonical --figure nothing --out figures
expect 2 'time in seconds, found "x"' report canonical --figure tower:t=x --out figures
expect 2 'expected html, md, csv' report canonical --format cvs --out figures
expect 2 'are for --figure' report canonical --format svg --out figures
CHROMIUM=/nonexistent expect 3 'no program "/nonexistent"' report canonical --figure tower --out figures
rm -f /tmp/plumb-browser-$$
CHROMIUM=$chromium NODE_PATH=$modules/node_modules MODULES=$modules/node_modules \
    node --test "$SOURCE/tests/browser/pages.mjs" >told.txt 2>&1 || { cat told.txt >&2; failed=1; }
exit $failed
