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
export ASAN_OPTIONS=handle_segv=0:handle_sigbus=0:handle_sigfpe=0:handle_abort=0:detect_leaks=0
# STAGES FAULT OUTCOME [REASON]. STAGES: "all", or names with commas between; FAULT: of staged_faults.c; OUTCOME: "same" is ok
# with the numbers of the engine without a fault, "any" is some outcome; REASON: a regular expression, in which @ is the stage.
cat >faults.txt <<'END'
none none same
none last same
all exit0 crashed it called exit\(0\) @
all exit7 crashed it called exit\(7\) @
all abort crashed SIGABRT @.*; last line: \?\[31mit cannot go on
all crash crashed SIGSEGV @
all forge crashed it called exit\(0\) @
all print,escape,chdir,standard,rounding,traps,signals,environment,locale same
all close crashed the engine closed or wrote into a descriptor that is not its own
load,ask,create,settings,pair,step,frame,contacts,destroy,unload write crashed the engine closed or wrote into a descriptor
defaults,extension write same
all limits any
step ill crashed SIGILL @
step fpe crashed SIGFPE @
step trap crashed SIGTRAP @
step sys crashed SIGSYS @
step pipe crashed SIGPIPE @
step term crashed SIGTERM @
step int crashed SIGINT @
step xcpu crashed SIGXCPU @
step realtime crashed SIG.* @
step,create kill crashed SIGKILL \(out of memory\?\) @
step,create killgroup crashed SIGKILL \(out of memory\?\) @
step,create killparent crashed SIGKILL \(out of memory\?\) @
step alarm crashed SIGALRM @
step,load bus crashed SIGBUS @
step,settings constant crashed SIGSEGV @
step,load stack crashed SIGSEGV @
step,destroy free crashed SIGABRT @
step,load quick crashed it called exit\(8\) @
step,load threadabort crashed SIGABRT @
step,load exec crashed it called exit\(0\) @
step,load atexitabort crashed SIGABRT @
step longjmp any
step,load atexit crashed SIGABRT while it was unloaded
step,load flood,errors,line same
step,load folder,x87,cleared,nice,undumpable,thread same
step,frame replaced crashed the engine closed or wrote into a descriptor that is not its own
step descriptors any
create list same
load,create,step,unload fork,setsid,disguise,stopped same
create,step,destroy orphans crashed it called exit\(7\) @
step,load bomb same
step,create,load memory crashed SIGABRT @; last line: no more memory
step,create unchecked crashed SIGSEGV @
step,create hoard any
create,step silent crashed the engine reported a failure, and gave no reason
create,step status crashed the engine reported a failure, and gave no reason
create,step refusal unsupported the engine refused, and gave no reason
create,step endless crashed ^x{500,511}$
create nothing crashed create returned PL_OK, but made no instance
frame frame same
settings arrays same
contacts many crashed read_contacts returned 2000000000 for a capacity of
contacts double crashed read_contacts returned
contacts negative crashed the engine reports -3 contacts at step 3
step position_nan,orientation_nan,velocity_nan,spin_nan nonfinite step 3
step position_inf,orientation_inf,velocity_inf,spin_inf nonfinite step 3
step position_huge,velocity_huge diverged step 3
step orientation_huge,spin_huge diverged|crashed|nonfinite .
step iterations_negative crashed the engine reports -3 iterations at step 3
step iterations_huge crashed the engine reports 1e\+300 iterations at step 3
step residual_negative crashed the engine reports -3 as residual at step 3
step residual_inf crashed the engine reports inf as residual at step 3
step contacts_negative crashed the engine reports -3 contacts at step 3
step contacts_huge crashed the engine reports 1e\+300 contacts at step 3
step islands_negative crashed the engine reports -3 islands at step 3
step islands_huge crashed the engine reports 1e\+300 islands at step 3
step time_negative crashed the engine reports -3 s as time_solve at step 3
step time_inf crashed the engine reports inf s as time_solve at step 3
contacts body_zero crashed the engine reports a contact of body 0 with itself at step 3
contacts body_huge crashed the engine reports a contact of body 99 at step 3, and the scene has bodies 0 to
contacts body_negative crashed the engine reports a contact of body -3 at step 3
contacts normal_three crashed a contact of bodies 0 and 1 at step 3 whose normal has the length 3
contacts normal_huge crashed a contact of bodies 0 and 1 at step 3 whose normal has the length
contacts normal_nan,normal_inf crashed a contact of bodies 0 and 1 at step 3 whose normal is not finite
contacts point_nan,point_inf crashed a contact of bodies 0 and 1 at step 3 whose point is not finite
contacts separation_nan,separation_inf crashed a contact of bodies 0 and 1 at step 3 whose separation is not finite
settings gravity_three,gravity_inf,gravity_huge unsupported gravity x, m/s\^2: the scene has
settings dt_three,dt_negative,dt_inf unsupported step, s: the scene has
settings damping_three unsupported linear damping, 1/s: the scene has
pair friction_negative,friction_inf,friction_huge unsupported friction between
pair restitution_three,restitution_inf unsupported restitution between
END
if grep -q __asan_init "$PLUMB"; then # it ends a process that frees memory twice in a way of its own
    sed -i -E '/^step,(destroy free|create unchecked) /d' faults.txt
fi
cat >rows.py <<'END'
import json, re, sys

STAGES = "load ask defaults extension create settings pair step frame contacts destroy unload".split()
PLACES = {"load": "while it was loaded", "ask": "while it was loaded",
          "defaults": "while it was asked for the defaults of profile default",
          "extension": "while it was asked for an extension", "create": "in create",
          "settings": "while its settings were read back",
          "pair": "while its settings were read back", "step": "in step 3 of 10",
          "frame": "while its state was read, 3 of 10", "contacts": "while its state was read, 3 of 10",
          "destroy": "in destroy, 10 of 10", "unload": "while it was unloaded"}
expected = {}
for line in open("faults.txt"):
    stages, faults, outcome, reason = (line.split(maxsplit=3) + [""])[:4]
    for stage in STAGES if stages == "all" else stages.split(","):
        for fault in faults.split(","):
            expected[f"{stage}-{fault}"] = (outcome, reason.strip().replace("@", PLACES.get(stage, "")))
if len(sys.argv) == 1:
    sys.exit(print("\n".join(expected)))
rows = {row["label"]: row for row in json.load(open(sys.argv[1]))}
good = rows["none-none"]
failed = []


def check(right, label, what):
    if not right:
        failed.append(f"{label}: {what}")


def same_numbers(row):
    for name, metric in good["metrics"].items():
        mine = row["metrics"].get(name, {})
        if metric["deterministic"] and mine.get("value") != metric["value"]:
            return False
    return row["final_poses"] == good["final_poses"] and row["steps"] == {"asked": 10, "done": 10}


for label, (outcome, reason) in expected.items():
    row = rows.pop(label, {"outcome": "no row", "reason": None})
    said = row["reason"] or ""
    if outcome == "same":
        check(row["outcome"] == "ok" and same_numbers(row), label, (row["outcome"], said))
    elif outcome == "any":
        check(row["outcome"] == "ok" or said, label, (row["outcome"], said))
    else:
        check(re.fullmatch(outcome, row["outcome"]) and re.search(reason, said), label, (row["outcome"], said))
    check(not any(ord(c) < 32 for c in said), label, "control characters in its reason")
    # Printing shows where the stage is one of the run itself, and nothing else does.
    stage, fault = label.split("-")
    shown = "from the engine" in (row.get("output") or "")
    check(shown == (fault == "print" and stage not in ("defaults", "extension")), label, "its output")
    if label == "step-escape":
        check("[31mred" in row["output"] and "\033" not in row["output"], label, row["output"])
    if fault in ("flood", "errors", "line") and stage == "step":
        check(len(row["output"]) == 2000, label, "the end of the output is kept")
    for entry in row["output"].split() if label == "create-list" else []:
        number, target = entry.split(":", 1)
        right = {"0": target == "/dev/null", "1": target.startswith("pipe"), "2": target.startswith("pipe"),
                 "3": target.startswith("pipe")}
        check(right.get(number, "perf_event" in target), label, entry)
check(good["outcome"] == "ok" and good["output"] is None, "none-none", good["reason"])
check(not rows, "all", f"rows that nothing was run for: {list(rows)}")
print(f"{len(expected)} faults of plug-ins, {len({label.split('-')[1] for label in expected})} kinds, {len(failed)} wrong")
sys.exit("\n".join(failed) or 0)
END

# A hang is a timeout of its own row, also one that hears no signal or stops what watches it.
hangs=()
for name in {load,ask,defaults,extension,create,settings,pair,step,frame,contacts,destroy,unload}-hang step-{stop,deaf,spin} create-stopparent; do
    cp "$BUILD/staged_engine.so" "$name.so"
    hangs+=(--engine "./$name.so,label=$name")
done
cp "$BUILD/staged_engine.so" none-none.so
"$PLUMB" compare ./scene.json --engine ./none-none.so,label=before "${hangs[@]}" --engine ./none-none.so,label=after \
    --timeout 1 --jobs 30 --out hangs >/dev/null 2>hangs.err &
hanging=$!

engines=()
for name in $(python3 rows.py); do
    cp "$BUILD/staged_engine.so" "$name.so"
    engines+=(--engine "./$name.so,label=$name")
done
memory=(--memory 0.25)
! grep -q __asan_init "$PLUMB" || memory=()
# A descriptor of the caller, which no engine may see.
exec 7>mine.txt
code=0
"$PLUMB" compare ./scene.json "${engines[@]}" "${memory[@]}" --jobs 2 --out results --json - >all.json 2>err </dev/null || code=$?
exec 7>&-
[[ $code == 0 ]] || note_failure "exit code $code: $(tail -3 err)"
[[ ! -s mine.txt ]] || note_failure "an engine wrote into a file of the caller"
[[ -s results/results.jsonl && -s results/index.html ]] || note_failure "the results are elsewhere"
if grep -qP '[^\x20-\x7e\n]' <(LC_ALL=C tr -d '\200-\377' <err); then
    note_failure "control characters on standard error"
fi
python3 rows.py all.json || failed=1
# What engines left of this test: it has this folder, and the name that its fault gave it.
offspring() {
    local cwd
    for cwd in $(find /proc -maxdepth 2 -name cwd -lname "$directory" 2>/dev/null); do
        case $(cat "${cwd%/cwd}/comm" 2>/dev/null) in
        sleep | a\)*) echo "${cwd%/cwd}" ;;
        esac
    done
}
[[ -z $(offspring) ]] || note_failure "an engine's offspring is left"

wait $hanging || note_failure "hangs: exit code $?: $(cat hangs.err)"
python3 - <<'END' || failed=1
import json
rows = [row for row in map(json.loads, open("hangs/results.jsonl")) if "study" not in row]
outcomes = {row["label"]: row["outcome"] for row in rows}
assert outcomes.pop("before") == outcomes.pop("after") == "ok", outcomes
outcomes.pop("create-stopparent")
assert len(outcomes) == 15 and set(outcomes.values()) == {"timeout"}, outcomes
assert all("no end within 1 s" in row["reason"] for row in rows if row["outcome"] == "timeout"), rows
print(len(outcomes) + 1, "hangs of plug-ins")
END

# The offspring goes also where the harness is killed.
cp "$BUILD/staged_engine.so" step-lost.so
"$PLUMB" run ./scene.json --engine ./step-lost.so >/dev/null 2>&1 &
killed=$!
for ((i = 0; i < 100; ++i)); do
    [[ -z $(offspring) ]] || break
    sleep 0.05
done
((i < 100)) || note_failure 'the offspring did not begin'
kill -9 $killed
wait $killed 2>/dev/null || true
for ((i = 0; i < 100; ++i)); do
    [[ -n $(offspring) ]] || break
    sleep 0.05
done
((i < 100)) || note_failure 'the offspring outlives the harness'

# With few descriptors there are fewer runs at a time.
(for open in /proc/self/fd/*; do # those that ctest has left open count too
    number=${open##*/}
    [[ $number -le 2 || $number == 255 ]] || eval "exec $number>&-"
done
ulimit -n 12 && "$PLUMB" compare ./scene.json --engine ./none-none.so --repeat 6 --jobs 30 --out few >/dev/null 2>err) ||
    note_failure "few descriptors: $(cat err)"
[[ $(grep -vc '"study":' few/results.jsonl) == 6 ]] || note_failure 'few descriptors: runs are missing'

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
