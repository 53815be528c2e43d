#!/usr/bin/env bash
# A plug-in that exits, crashes, hangs, prints or changes its process, at any stage of its life, is one
# row with its reason; the rows of the others are complete, and nothing of it reaches the harness.
set -eu
command=compare
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

cat >scene.json <<'END'
{ "plumb_scene": 1, "dt": 0.01, "duration": 0.1,
  "materials": { "m": { "friction": 0.5, "restitution": 0 } },
  "bodies": [
    { "name": "ground", "static": true, "material": "m",
      "shape": { "type": "plane", "normal": [0, 0, 1], "offset": 0 } },
    { "name": "a", "mass": 1, "material": "m", "position": [0, 0, 5],
      "shape": { "type": "sphere", "radius": 0.5 } },
    { "name": "b", "mass": 2, "material": "m", "position": [3, 0, 5],
      "shape": { "type": "sphere", "radius": 0.5 } } ] }
END
# A sanitizer leaves crashes to the harness, and allows no limit of memory.
export ASAN_OPTIONS=handle_segv=0:handle_abort=0:detect_leaks=0
stages=(load ask defaults extension create settings pair step frame contacts destroy unload)
faults=(exit0 exit7 abort crash print escape chdir standard close write forge limits rounding traps
    signals environment locale)
once=(create-list step-flood step-fork create-silent step-silent contacts-many contacts-negative
    contacts-double step-iterations step-residual step-contacts step-time contacts-self contacts-index
    contacts-normal contacts-point)

engines=()
add() {
    cp "$BUILD/staged_engine.so" "$1.so"
    engines+=(--engine "./$1.so,label=$1")
}
add none-none
for stage in "${stages[@]}"; do
    for fault in "${faults[@]}"; do
        add "$stage-$fault"
    done
done
for name in "${once[@]}"; do
    add "$name"
done
add none-last
# A descriptor of the caller, which no engine may see.
exec 7>mine.txt
code=0
"$PLUMB" compare ./scene.json "${engines[@]}" --jobs 2 --out results --json - >all.json 2>err </dev/null || code=$?
exec 7>&-
[[ $code == 0 ]] || note_failure "exit code $code: $(tail -3 err)"
[[ ! -s mine.txt ]] || note_failure "an engine wrote into a file of the caller"
[[ -s results/results.jsonl && -s results/index.html ]] || note_failure "the results are elsewhere"
if grep -qP '[^\x20-\x7e\n]' <(LC_ALL=C tr -d '\200-\377' <err); then
    note_failure "control characters on standard error"
fi

cat >rows.py <<'END'
import json, sys

stages = {"load": "while it was loaded", "ask": "while it was loaded",
          "defaults": "while it was asked for the defaults of profile default",
          "extension": "while it was asked for an extension", "create": "in create",
          "settings": "while its settings were read back",
          "pair": "while its settings were read back", "step": "in step 3 of 10",
          "frame": "while its state was read, 3 of 10", "contacts": "while its state was read, 3 of 10",
          "destroy": "in destroy, 10 of 10", "unload": "while it was unloaded"}
ends = {"exit0": "it called exit(0) ", "forge": "it called exit(0) ", "exit7": "it called exit(7) ",
        "abort": "SIGABRT ", "crash": "SIGSEGV "}
FOREIGN = ": the engine closed or wrote into a descriptor that is not its own"
reasons = {"silent": "the engine reported a failure, and gave no reason",
           "many": "read_contacts returned 2000000000 for a capacity of ",
           "negative": "the engine reports -3 contacts at step 3",
           "iterations": "the engine reports -3 iterations at step 3",
           "residual": "the engine reports inf as residual at step 3",
           "contacts": "the engine reports -1 contacts at step 3",
           "time": "the engine reports -0.5 s as time_solve at step 3",
           "self": "the engine reports a contact of body 1 with itself at step 3",
           "index": "the engine reports a contact of body 99 at step 3, and the scene has bodies 0 to ",
           "normal": "the engine reports a contact of bodies 0 and 1 at step 3 whose normal has the length 3",
           "point": "the engine reports a contact of bodies 0 and 1 at step 3 whose point is not finite",
           "double": "read_contacts returned "}
failed = []


def check(right, label, what):
    if not right:
        failed.append(f"{label}: {what}")


def same_numbers(row, good):
    for name, metric in good["metrics"].items():
        mine = row["metrics"].get(name, {})
        if metric["deterministic"] and mine.get("value") != metric["value"]:
            return False
    return row["final_poses"] == good["final_poses"]


rows = {row["label"]: row for row in json.load(open("all.json"))}
good = rows["none-none"]
check(good["outcome"] == "ok" and good["output"] is None, "none-none", good["reason"])
for label, row in rows.items():
    stage, fault = label.split("-")
    reason = row["reason"] or ""
    said = (row["outcome"], reason)
    if fault in ends:
        check(row["outcome"] == "crashed" and reason.startswith(ends[fault] + stages[stage]), label, said)
    elif fault in ("close", "write") and not (stage in ("defaults", "extension") and fault == "write"):
        check(row["outcome"] == "crashed" and FOREIGN in reason, label, said)
    elif fault in reasons:
        check(row["outcome"] == "crashed" and reason.startswith(reasons[fault]), label, said)
    elif fault == "limits":
        check(row["outcome"] in ("ok", "crashed") and (row["outcome"] == "ok") == (reason == ""), label, said)
    else:
        check(row["outcome"] == "ok" and row["steps"] == {"asked": 10, "done": 10}, label, said)
        check(same_numbers(row, good), label, "its numbers differ")
    check(not any(ord(c) < 32 for c in reason), label, "control characters in its reason")
shown = [label for label, row in rows.items() if row["output"] and "from the engine" in row["output"]]
unseen = ("defaults", "extension")  # those are not called in the run itself
check(sorted(shown) == sorted(f"{s}-print" for s in stages if s not in unseen), "print", shown)
check("[31mred" in rows["step-escape"]["output"] and "\033" not in rows["step-escape"]["output"],
      "step-escape", rows["step-escape"]["output"])
check(len(rows["step-flood"]["output"]) == 2000, "step-flood", "the end of the output is kept")
for entry in rows["create-list"]["output"].split():
    number, target = entry.split(":", 1)
    right = {"0": target == "/dev/null", "1": target.startswith("pipe"), "2": target.startswith("pipe"),
             "3": target.startswith("pipe")}
    check(right.get(number, "perf_event" in target), "create-list", entry)
check(len(rows) == int(sys.argv[1]), "all", f"{len(rows)} rows of {sys.argv[1]}")
sys.exit("\n".join(failed) or 0)
END
python3 rows.py $((${#engines[@]} / 2)) || failed=1

# A hang at each stage is a timeout of its own row; all at the same time, because each takes its limit.
for stage in "${stages[@]}"; do
    cp "$BUILD/staged_engine.so" "$stage-hang.so"
    "$PLUMB" compare ./scene.json --engine ./none-none.so,label=before --engine "./$stage-hang.so,label=hang" \
        --engine ./none-none.so,label=after --timeout 2 --out "hang-$stage" >/dev/null 2>&1 &
done
wait
python3 - "${stages[@]}" <<'END' || failed=1
import json, sys
for stage in sys.argv[1:]:
    rows = [json.loads(line) for line in open(f"hang-{stage}/results.jsonl")]
    outcomes = {row["label"]: row["outcome"] for row in rows}
    assert outcomes == {"before": "ok", "hang": "timeout", "after": "ok"}, (stage, outcomes)
    assert "no end within 2 s" in rows[1]["reason"], (stage, rows[1]["reason"])
END

# One run: the exit code says that it was not ok, and why.
command=run
for stage in load defaults step unload; do
    expect 3 "it called exit\(7\)" ./scene.json --engine "./$stage-exit7.so"
    expect 3 'SIGABRT .*last line: \?\[31mit cannot go on' ./scene.json --engine "./$stage-abort.so"
done
if ! grep -q __asan_init "$PLUMB"; then
    cp "$BUILD/staged_engine.so" load-memory.so
    expect 3 'SIGABRT while it was loaded; last line: no more memory' ./scene.json --engine ./load-memory.so --memory 1
fi
expect 0 'ok' ./scene.json --engine ./load-chdir.so --json there.json
[[ -s there.json ]] || note_failure "an engine changed the folder of the harness"

# A file that is replaced after it was asked: another binary is refused, and the same one is not.
cp "$BUILD/faulty_engine.so" replacement.so
cp "$BUILD/staged_engine.so" unload-replace.so
expect 3 'unload-replace.so has changed since it was first loaded' ./scene.json --engine ./unload-replace.so
cp "$BUILD/staged_engine.so" replacement.so
cp "$BUILD/staged_engine.so" unload-replace.so
expect 0 'ok' ./scene.json --engine ./unload-replace.so
[[ ! -e replacement.so ]] || note_failure "nothing was replaced"

# A file that is cut short: where loading it is a crash, it is a row; otherwise it is bad input.
for size in 100 4096 9000 12000; do
    head -c "$size" none-none.so >cut.so
    "$PLUMB" compare ./scene.json --engine ./none-none.so --engine ./cut.so --out cut --force >out 2>&1 && code=0 || code=$?
    if [[ $code == 0 ]]; then
        grep -q 'crashed' out || note_failure "a cut plug-in of $size bytes: $(cat out)"
    else
        [[ $code == 2 ]] && grep -q 'cannot load ./cut.so' out || note_failure "cut at $size: $code: $(cat out)"
    fi
done

exit $failed
