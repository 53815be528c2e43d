#!/usr/bin/env bash
# A study that does not come to its end keeps what it found, goes on with --resume, and ends as one that nothing
# disturbed. A limit on the size of files breaks it off at the same place each time, as a full disk would.
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

# What must be the same: all but times, and what depends on them.
cat >same.py <<'END'
import json, sys
COSTS = ("seconds", "started", "command", "repeats", "host", "cost", "iterations_per_second")
def strip(value):
    if isinstance(value, dict):
        if value.get("deterministic") is False:
            return None
        return {key: strip(item) for key, item in value.items() if key not in COSTS}
    return [strip(item) for item in value] if isinstance(value, list) else value
def read(path):
    text = open(path).read()
    try:
        return strip(json.loads(text))
    except json.JSONDecodeError:
        return [strip(json.loads(line)) for line in text.splitlines()]
sys.exit(read(sys.argv[1]) != read(sys.argv[2]))
END

# breaks_off NAME KIB KIB OUTPUT ARGUMENT...: `plumb ARGUMENT...` breaks off where its results reach the first number of KiB, and
# once more; then OUTPUT, which it writes, is the same as that of one that was not disturbed.
breaks_off() {
    local name=$1 first=$2 second=$3 output=$4 actual=0 results
    shift 4
    mkdir "$name" "$name.whole"
    (cd "$name.whole" && "$PLUMB" "$@" >out 2>err </dev/null) || actual=$?
    local code=$actual
    cd "$name"
    actual=0
    (ulimit -f "$first"; exec "$PLUMB" "$@" >out 2>err </dev/null) || actual=$?
    [[ $actual == 3 ]] && grep -q 'the same command with --resume goes on' err ||
        note_failure "$name: exit code $actual, expected 3: $(cat err)"
    results=$(ls */results.jsonl 2>/dev/null | head -n 1)
    [[ -s $results && -z $(tail -c 1 "$results") ]] || note_failure "$name: no results, or a cut line"
    cp "$results" ../before.jsonl
    [[ ! -e $output ]] || note_failure "$name: $output is there, though the study did not end"
    actual=0
    "$PLUMB" "$@" >out 2>err </dev/null || actual=$?
    [[ $actual == 2 ]] && grep -q -- '--resume .*--force' err || note_failure "$name: again: $actual: $(cat err)"
    cmp -s "$results" ../before.jsonl || note_failure "$name: a refused call changed the results"
    actual=0
    (ulimit -f "$second"; exec "$PLUMB" "$@" --resume >out 2>err </dev/null) || actual=$?
    [[ $actual == 3 ]] || note_failure "$name: the second part: exit code $actual: $(cat err)"
    head -c "$(stat -c %s ../before.jsonl)" "$results" | cmp -s - ../before.jsonl ||
        note_failure "$name: what was found before is lost or was made again"
    [[ $(wc -l <"$results") -gt $(wc -l <../before.jsonl) ]] || note_failure "$name: the second part found nothing"
    [[ -z $(grep -oE '"run":"[^"]*","s[a-z]*":' "$results" | sort | uniq -d) ]] ||
        note_failure "$name: something was made twice"
    actual=0
    "$PLUMB" "$@" --resume >out 2>err </dev/null || actual=$?
    [[ $actual == "$code" ]] || note_failure "$name: the last part: exit code $actual, not $code: $(cat err)"
    [[ $output == - ]] || python3 ../same.py "$output" "../$name.whole/$output" ||
        note_failure "$name: $output is not that of a whole study"
    cd ..
}

breaks_off threshold 20 60 threshold/threshold.json threshold slope-threshold --engine plumb
breaks_off metamorphic 20 50 metamorphic/metamorphic.json metamorphic tower --set n=2 --duration 0.1 --engine plumb:fast --check rotate \
    --check mirror --check scale --check again --check restart --check order --check shift
breaks_off iterations 12 40 i.json compare tower --set n=3 --duration 0.2 --engine plumb:fast \
    --iterations-to-tolerance --no-recordings --out iterations --json i.json
breaks_off tune 40 80 - tune free-fall --duration 0.1 --engine plumb:fast --target 'value_error<=10' \
    --budget 4 --fix dt=1/60
# A search that is continued takes the same way: each trial has the same values in all its runs.
python3 - <<'END' || note_failure "tune: the continued search took another way"
import json
trials = {}
for row in map(json.loads, open("tune/tune/results.jsonl")):
    if row["study"]["values"] is not None and row["study"]["phase"] != "sensitivity":
        trials.setdefault(row["study"]["trial"], set()).add(tuple(row["study"]["values"]))
assert sorted(trials) == list(range(4)) and all(len(values) == 1 for values in trials.values()), trials
END
exit $failed
