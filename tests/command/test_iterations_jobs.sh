#!/usr/bin/env bash
# Trials of compare --iterations-to-tolerance run side by side with --jobs 2: each waits for another to begin. They find
# what single jobs find.
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
# shellcheck source=tests/support/small_engine.sh
source "$SOURCE/tests/support/small_engine.sh"

command=compare
mkfifo meeting
small_engine meets.so -DMEETS
small_engine alone.so
fall=(free-fall --duration 0.5 --iterations-to-tolerance --no-recordings --timeout 60)
expect 0 ' a ' "${fall[@]}" --engine ./meets.so,label=a --engine ./meets.so,label=b --jobs 2 --out two
expect 0 'small:one' "${fall[@]}" --engine ./alone.so --out one
python3 - <<'END' || note_failure "two jobs find something else"
import json
def found(folder):
    rows = [json.loads(line) for line in open(f"{folder}/results.jsonl")]
    trials = [row for row in rows if row.get("study") == {"name": "iterations"}]
    assert len(trials) > 3 and all(row["outcome"] == "ok" for row in rows), [row["reason"] for row in rows]
    return [row["metrics"]["iterations_to_tolerance"]["value"] for row in rows if "study" not in row], len(trials)
(one,), trials = found("one")
assert found("two") == ([one, one], 2 * trials) and one > 1, (found("one"), found("two"))
END
exit $failed
