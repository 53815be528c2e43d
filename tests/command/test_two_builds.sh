#!/usr/bin/env bash
# Two builds of one engine compare under labels, everywhere; a rebuilt engine is another engine, so that
# --resume runs it again, and no report or gate mixes the two.
set -eu
command=compare
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
# shellcheck source=tests/support/small_engine.sh
source "$SOURCE/tests/support/small_engine.sh"

small_engine old.so -DDRIFT=1e-3
small_engine new.so
both=(--engine ./old.so,label=old --engine ./new.so,label=new)
fall=(free-fall --duration 0.1)

# ---- Side by side
expect 0 '' "${fall[@]}" "${both[@]}" --out two --json two.json
python3 - <<'END' || failed=1
import csv, json, re
rows = {row["label"]: row for row in json.load(open("two.json"))}
assert sorted(rows) == ["new", "old"], sorted(rows)
old, new = rows["old"], rows["new"]
assert old["engine"] == new["engine"] == "small"
assert old["engine_binary"] != new["engine_binary"] and old["run"] != new["run"]
assert all(re.fullmatch("[0-9a-f]{16}", row["engine_binary"]) for row in rows.values())
error = [row["metrics"]["value_error"]["value"] for row in (old, new)]
assert error[0] != error[1], error
table = list(csv.DictReader(open("two/results.csv", newline="")))
for label, row in rows.items():
    assert any(line["label"] == label and line["engine_binary"] == row["engine_binary"] for line in table)
page, summary = open("two/index.html").read(), open("two/summary.md").read()
assert all(f'"{label}"' in page and f" {label} " in summary for label in rows)
END
expect 2 'are both called same: give one of them label=NAME' \
    "${fall[@]}" --engine ./old.so,label=same --engine ./new.so,label=same --out none
expect 2 'are both called small:one: give one of them label=NAME' \
    "${fall[@]}" --engine ./old.so --engine ./new.so --out none
expect 2 'both called same' "${fall[@]}" --engine ./new.so,label=same --engine ./new.so:two,label=same --out none
expect 0 '^1 result ' "${fall[@]}" --engine ./new.so --engine ./new.so --out once
expect 0 '^2 results ' "${fall[@]}" --engine ./new.so,label=A --engine ./new.so,label=B --out same
python3 - <<'END' || failed=1
import json
rows = [json.loads(line) for line in open("same/results.jsonl")]
assert rows[0]["engine_binary"] == rows[1]["engine_binary"] and rows[0]["run"] != rows[1]["run"]
assert rows[0]["metrics"]["state_hash"] == rows[1]["metrics"]["state_hash"]
END

# ---- Other commands keep the labels apart
command=
expect 0 '' gate two --baseline baseline.json --update-baseline
expect 0 '' gate two --baseline baseline.json
expect 0 '' sweep free-fall --duration 0.1 --vary iterations=1,2 --vary dt=1/60,1/120 "${both[@]}" --out swept --json swept.json
expect 0 '' ensemble falling-cubes --set n=2 --duration 0.1 --members 7 "${both[@]}" --converged --json ensemble.json
expect 0 '^new +again ' metamorphic free-fall --duration 0.1 --check again "${both[@]}" --json metamorphic.json
expect 0 'old' threshold slope-threshold --duration 0.1 "${both[@]}" --json threshold.json
expect 0 '' compare "${fall[@]}" "${both[@]}" --iterations-to-tolerance --out tolerance
expect 0 '' report swept --out swept_report
cp old.so changing.so
changing=(sweep free-fall --duration 0.1 --vary dt=1/60,1/120 --engine ./changing.so --out mixed)
expect 0 '' "${changing[@]}"
cp new.so changing.tmp
mv changing.tmp changing.so
expect 0 '' "${changing[@]}" --resume
python3 - <<'END' || failed=1
import json
swept = json.load(open("swept.json"))
labels = sorted({row["label"] for row in swept})
assert labels == ["new", "new,iterations=2", "old", "old,iterations=2"], labels
assert len(swept) == 8 and all(row["outcome"] == "ok" for row in swept)
curves = {engine["name"] for engine in json.load(open("swept/sweep.json"))["engines"]}
assert curves == {"old", "new"}, curves
assert json.load(open("swept/sweep.json"))["several_builds"] is False
mixed = json.load(open("mixed/sweep.json"))
assert mixed["several_builds"] is False and len(mixed["points"]) == 2, mixed
text = open("ensemble.json").read() + open("metamorphic.json").read()
assert all(f'"{label}"' in text for label in ("old", "new", "old@converged", "new@converged")), text[:2000]
assert sorted(row["label"] for row in json.load(open("threshold.json"))) == ["new", "old"]
rows = [json.loads(line) for line in open("tolerance/results.jsonl")]
found = [row["metrics"]["iterations_to_tolerance"]["value"] for row in rows if "study" not in row]
assert len(found) == 2
END

# ---- --resume after a rebuild: of the plug-in, of a library that it loads, of plumb
count_runs() {
    wc -l <"$1/results.jsonl"
}
command=compare
small_engine mine.so -DDRIFT=1e-3
once=("${fall[@]}" --engine ./mine.so --out again --resume)
expect 0 '' "${once[@]}"
expect 0 '' "${once[@]}"
[[ $(count_runs again) == 1 ]] || note_failure "a run was made again: $(count_runs again)"
small_engine mine.so
expect 0 '1 result is left out: the engine was rebuilt since' "${once[@]}"
[[ $(count_runs again) == 2 ]] || note_failure "a rebuilt plug-in was not run again"
expect 0 '' "${once[@]}"
[[ $(count_runs again) == 2 ]] || note_failure "a rebuilt plug-in was run twice"
grep -q '^1 run, 1 case, 1 engine;' again/summary.md ||
    note_failure "the report has the old build too: $(cat again/summary.md)"
mkdir first second
head -n 1 again/results.jsonl >first/results.jsonl
tail -n 1 again/results.jsonl >second/results.jsonl
command=report
expect 0 '2 results of 2 files' first second --out both
[[ $(grep -o 'small:one build [0-9a-f]*' both/summary.md | sort -u | wc -l) == 2 ]] ||
    note_failure "the report of two files does not compare two builds: $(cat both/summary.md)"
command=gate
expect 0 '1 result is left out: the engine was rebuilt since' again --baseline new.json --update-baseline
python3 - <<'END' || failed=1
import json
rows = [json.loads(line) for line in open("again/results.jsonl")]
error = [row["metrics"]["value_error"]["value"] for row in rows]
kept = json.load(open("new.json"))["rows"]
assert len(kept) == 1 and kept[0]["metrics"]["value_error"] == error[1] != error[0], (error, kept)
END

command=compare
depend() {
    echo "double small_engine_drift(void); double small_engine_drift(void) { return $1; }" >drift.c
    "${CC:-cc}" -shared -fPIC -o drift.tmp drift.c
    mv drift.tmp libdrift.so
}
depend 1e-3
small_engine linked.so -DDEPENDENCY -L. -ldrift "-Wl,-rpath,\$ORIGIN"
once=("${fall[@]}" --engine ./linked.so --out linked --resume)
expect 0 '' "${once[@]}"
depend 2e-3
expect 0 '' "${once[@]}"
expect 0 '' "${once[@]}"
[[ $(count_runs linked) == 2 ]] || note_failure "a rebuilt library was not noticed: $(count_runs linked) runs"

original=$PLUMB
cp "$original" plumb
PLUMB=$directory/plumb
once=("${fall[@]}" --engine plumb --engine ./new.so --out own --resume)
expect 0 '' "${once[@]}"
echo >>plumb
expect 0 '' "${once[@]}"
[[ $(count_runs own) == 3 ]] || note_failure "after a rebuild of plumb: $(count_runs own) runs, not 3"
PLUMB=$original

# ---- An engine's symbols are its own, also where plumb links a library that has them
cat >own_symbol.c <<'END'
const char *dGetConfiguration(void);
const char *dGetConfiguration(void) { return "mine"; }
__attribute__((constructor)) static void load(void)
{
    if (dGetConfiguration()[0] != 'm') {
        __builtin_abort();
    }
}
END
small_engine own_symbol.so own_symbol.c
command=run
if ! grep -qE '__(asan|tsan)_init' "$PLUMB"; then # these sanitizers do not allow it
    expect 0 'ok' "${fall[@]}" --engine ./own_symbol.so
fi

exit $failed
