#!/usr/bin/env bash
# plumb threshold as a user meets it: the value, rows of engines that fail, exit codes, JSON.
set -eu
command=threshold
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
further=(--force)

expect 2 'which scenario' --engine plumb
expect 2 'tower has no threshold: choose a parameter by --vary.*these have one: .*slope-threshold' tower
expect 2 'the suite has no threshold' --suite paper
expect 2 'did you mean "slope-threshold"' slope-treshold
expect 2 'angle is what is searched for' slope-threshold --set angle=20
expect 2 'no chosen scenario has the parameter' slope-threshold --set height=20
expect 2 '--jobs takes an integer' slope-threshold --jobs 0
expect 2 'unknown engine|there is no engine' slope-threshold --engine plumg

# A value, with its closed form and the number of runs.
expect 0 '26\.56[0-9]* .* 21$' slope-threshold --set friction=0.5 --engine plumb:accurate
expect 0 'Closed form: 45 = atan\(friction\)' slope-threshold --set friction=1 \
    --engine plumb:accurate

# Held at both ends, within a time too short to fall, and at neither, by an engine of free fall.
faulty=$BUILD/faulty_engine.so
expect 0 'always holds \(2 runs\)' slope-threshold --engine plumb --duration 0.05
expect 0 'never holds \(2 runs\)' sphere-pyramid --engine "$faulty:good"
expect 0 'There is no closed form' sphere-pyramid --engine "$faulty:good" --set floor_friction=0.01

# Other outcomes are rows, with their reason; nothing but unsupported ones is nothing compared.
expect 0 'crashed: SIGABRT in step 3.*\(1 run\)' sphere-pyramid --engine "$faulty:abort"
expect 0 'nonfinite: ' sphere-pyramid --engine "$faulty:nan"
expect 0 'timeout: ' sphere-pyramid --engine "$faulty:hang" --timeout 1
expect 4 'unsupported: ' sphere-pyramid --engine "$faulty:refuse"
expect 0 'unsupported: faulty lacks box' slope-threshold --engine "$faulty:good" --engine plumb

# JSON: an object a row, whatever came of it, the same from one job and from two, and from the results alone.
"$PLUMB" threshold sphere-pyramid --engine plumb --engine "$faulty:abort" --engine plumb:fast \
    --json rows.json --jobs 2 --out two >table 2>/dev/null
"$PLUMB" threshold sphere-pyramid --engine plumb --engine "$faulty:abort" --engine plumb:fast \
    --json - --out one 2>/dev/null >again.json
"$PLUMB" report two --out reported >/dev/null 2>&1
cmp reported/threshold.json rows.json || note_failure "plumb report concludes otherwise"
cmp reported/threshold.html two/threshold.html || note_failure "plumb report writes another page"
grep -q 'Closed form' table || note_failure "the table is missing next to --json FILE"
python3 - <<'END' || note_failure "the JSON is wrong"
import json
order = lambda row: row["label"]
first = sorted(json.load(open("rows.json")), key=order)
again = sorted(json.load(open("again.json")), key=order)
for row in first + again:
    assert row.pop("command") and row.pop("started")
assert first == again
assert [row["finding"] for row in first] == ["crashed", "found", "found"]
for row in first:
    assert row["schema"] == "plumb.threshold/1" and row["param"] == "friction"
    assert "friction" not in row["params"] and row["params"]["floor_friction"] == 1
    if row["finding"] == "found":
        low, high = row["bracket"]
        assert 0 < high - low <= row["tolerance"] and row["value"] == low + (high - low) / 2
        assert row["error"] == row["value"] - row["closed_form"]
        assert abs(row["relative_error"]) < 1e-3 and row["reason"] is None
    else:
        assert row["value"] is None and row["bracket"] == [None, None] and row["reason"]
END
exit $failed
