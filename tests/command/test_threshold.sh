#!/usr/bin/env bash
# plumb threshold as a user meets it: the value, rows of engines that fail, exit codes, JSON lines.
set -eu
command=threshold
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

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
expect 0 'closed form: 45 = atan\(friction\)' slope-threshold --set friction=1 \
    --engine plumb:accurate

# Held at both ends, within a time too short to fall, and at neither, by an engine of free fall.
faulty=$BUILD/faulty_engine.so
expect 0 'always holds \(2 runs\)' slope-threshold --engine plumb --duration 0.05
expect 0 'never holds \(2 runs\)' sphere-pyramid --engine "$faulty:good"
expect 0 'no closed form' sphere-pyramid --engine "$faulty:good" --set floor_friction=0.01

# Other outcomes are rows, with their reason; nothing but unsupported ones is nothing compared.
expect 0 'crashed: SIGABRT in step 3.*\(1 run\)' sphere-pyramid --engine "$faulty:abort"
expect 0 'nonfinite: ' sphere-pyramid --engine "$faulty:nan"
expect 0 'timeout: ' sphere-pyramid --engine "$faulty:hang" --timeout 1
expect 4 'unsupported: ' sphere-pyramid --engine "$faulty:refuse"
expect 0 'unsupported: faulty lacks box' slope-threshold --engine "$faulty:good" --engine plumb

# JSON lines: one a row, whatever came of it, the same from one job and from two.
"$PLUMB" threshold sphere-pyramid --engine plumb --engine "$faulty:abort" --engine plumb:fast \
    --json rows.jsonl --jobs 2 >table 2>/dev/null
"$PLUMB" threshold sphere-pyramid --engine plumb --engine "$faulty:abort" --engine plumb:fast \
    --json - 2>/dev/null >again.jsonl
[[ $(wc -l <rows.jsonl) == 3 ]] || note_failure "expected 3 lines: $(cat rows.jsonl)"
grep -q 'closed form' table || note_failure "the table is missing next to --json FILE"
python3 - <<'END' || note_failure "the JSON lines are wrong"
import json
first = [json.loads(line) for line in open("rows.jsonl")]
again = [json.loads(line) for line in open("again.jsonl")]
for row in first + again:
    assert row.pop("command") and row.pop("started")
assert first == again
assert [row["finding"] for row in first] == ["found", "crashed", "found"]
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
