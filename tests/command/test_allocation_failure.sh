#!/usr/bin/env bash
# Wherever the harness's memory ends, a run is made or refused with a message, and its file is whole or not there.
set -eu
source "$SOURCE/tests/support/command.sh"
if grep -q __asan_init "$PLUMB"; then
    exit 77 # it has an allocator of its own
fi
cp "$BUILD/faulty_engine.so" engine.so
run=("$PLUMB" run free-fall --set duration=0.1 --engine ./engine.so)
COUNT_TO=count LD_PRELOAD="$BUILD/failing_malloc.so" "${run[@]}" >/dev/null
count=$(<count)
[[ $count -gt 500 ]] || note_failure "only $count allocations"

checked=0
for where in program forked; do
    for ((at = 1; at <= count; at += 67)); do
        code=0
        FAIL_AT=$at FAIL_IN=$where LD_PRELOAD="$BUILD/failing_malloc.so" "${run[@]}" --json "$where-$at.json" >out 2>err || code=$?
        checked=$((checked + 1))
        case $code in
        0) [[ -s $where-$at.json ]] || note_failure "$where $at: no result" ;;
        3) [[ -s out || -s err ]] || note_failure "$where $at: no message" ;;
        *) note_failure "$where $at: exit code $code: $(cat out err)" ;;
        esac
    done
done
python3 -c 'import json, sys; [json.load(open(path)) for path in sys.argv[1:]]' ./*.json || note_failure 'half a result'
echo "$checked allocations of $count"
exit $failed
