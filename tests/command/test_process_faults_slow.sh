#!/usr/bin/env bash
# Faults of a process engine become rows, and leave no process.
set -eu
source "$SOURCE/tests/support/command.sh"
timeout=20
faulty=$SOURCE/tests/support/faulty_process_engine.py
"$PLUMB" new-engine --process toy >/dev/null

count=0

# row FAULT OUTCOME REASON [OPTION...]: a run of the engine with that fault ends so, for that reason.
row() {
    local fault=$1 outcome=$2 reason=$3
    shift 3
    count=$((count + 1))
    "$PLUMB" compare cradle --duration 0.1 --engine "exec:python3 $faulty toy $fault" --no-reference --timeout "$timeout" \
        "$@" --out "out-$fault" >/dev/null 2>err || [[ $? == 4 ]] || note_failure "$fault: plumb fails: $(cat err)"
    python3 - "$fault" "$outcome" "$reason" >wrong <<'END' || note_failure "$fault: no row"
import json, re, sys
fault, outcome, reason = sys.argv[1:]
rows = [json.loads(line) for line in open(f"out-{fault}/results.jsonl")]
if len(rows) != 1 or rows[0]["outcome"] != outcome or not re.search(reason, rows[0]["reason"] or ""):
    print(fault, [(r["outcome"], r["reason"]) for r in rows])
END
    [[ ! -s wrong ]] || note_failure "$(cat wrong)"
}

row none ok ''
row before-hello crashed 'called exit\(1\) instead of answering hello; last line: no licence'
row signal crashed 'ended by SIGSEGV instead of answering step 3'
row exit crashed 'called exit\(7\) instead of answering step 3; last line: out of pencils'
timeout=2
row hang-in-hello timeout 'no end within 2 s'
row hang timeout 'no end within 2 s: killed in step 3'
row half-and-hang timeout 'killed in step 3'
timeout=20
row burn timeout 'cpu-limit of 1 s: killed in step 3' --cpu-limit 1
row garbage crashed 'answer to step 3: expected a JSON object on a line, found "Hello world"'
row half-a-line crashed 'called exit\(0\) instead of answering step 3, in the middle of a line'
row flood crashed 'answer to step 3: longer than 256 MiB without an end'
row lines crashed 'answer to step 3: id: expected'
row twice crashed 'more than one line as the answer|answer to step 4: id: expected 7, found 6'
row late crashed 'answer to step 3: id: expected'
row short-frame crashed 'frame: expected 39 numbers, 13 a body, found 38'
row nan crashed 'answer to step 3: expected a JSON object on a line, found .*NaN'
row null nonfinite ''
row text-in-frame crashed 'frame\[2\]: expected a number or null, found "high"'
row beyond-the-file crashed 'frame: expected 39 numbers at byte 1000000 of descriptor 3, found 0'
row contact-of-nobody crashed 'contact'
row odd-contacts crashed 'contacts: expected a multiple of 12 numbers, found 3'
row half-an-offset crashed 'frame: expected whole numbers as offset and count, found 0.5 and 39'
row half-a-count crashed 'frame: expected whole numbers as offset and count, found 0 and 39.5'
row stats-array crashed 'answer to step 3: stats: expected an object, found an array of 2'
row too-much-time crashed 'reports 1e\+03 s of CPU time'
row too-much-time-each crashed 'reports 0.0[0-9]+ s of CPU time for [0-9] steps, and the operating system counted'
row busy-start crashed 'reports 0.0[0-9]+ s of CPU time for [0-9] steps, and the operating system counted'
row negative-time crashed 'cpu: expected at least 0 s, found -1'
row no-time crashed 'cpu'
row memory crashed 'instead of answering step 3; last line: MemoryError' --memory 1
row numbers-memory crashed 'answer to step 3: descriptor 3 holds 300 MiB, more than --memory allows' --memory 0.25
row long-answer crashed 'out of memory for the answer to step 3' --memory 0.25
row detached ok ''
row grandchild crashed 'instead of answering step 3'
row deaf ok ''
row unsupported unsupported 'no spheres on Tuesdays'
row error crashed 'the world is full'
row half-substep-read crashed 'answer to create: settings.substeps: expected an integer, found 2.7'
row error-object crashed 'answer to create: error: expected a text, found an object'
row no-reason crashed 'answer to create: error: expected a text, found nothing'
row unsupported-text crashed 'answer to create: unsupported: expected true or false, found "yes"'

command=run
expect 2 'the program was not found' cradle --engine 'exec:no-such-program'
expect 2 'protocol: expected "plumb.engine/1", found "plumb.engine/9"' cradle --engine "exec:python3 $faulty toy other-protocol"
expect 2 'option iterations: its default -5 is not within' cradle --engine "exec:python3 $faulty toy option-range"
expect 2 'substeps: expected an integer of 1 to 1000000, found 2.7' cradle --engine "exec:python3 $faulty toy half-substep"
expect 2 'capabilities\[3\]: expected one of .*, found "joints"' cradle --engine "exec:python3 $faulty toy unknown-capability"
expect 3 'cannot be run|exit\(' cradle --engine "exec:$SOURCE/README.md"

expect 3 'it has fewer profiles than when it was first started' cradle --duration 0.1 --engine "exec:python3 $faulty toy fewer-profiles:second"

command=check-engine
for leak in step scene; do
    expect 1 'holds no more bytes of memory than the one before' --check "$leak-leaks" "exec:python3 $faulty toy $leak-leak,iterations=5"
    expect 0 'ok +'"$leak-leaks" --check "$leak-leaks" "exec:python3 $faulty toy none,iterations=5"
done

sleep 0.2
pgrep -f "$faulty|sleep 321" && note_failure 'a process of an engine is left'
echo "$count faults of process engines"
exit $failed
