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

# The step is odd, so that loops of two allocations are met at both.
checked=0
for where in program forked; do
    for ((at = 1; at <= count; at += 17)); do
        rm -f out.json
        code=0
        FAIL_AT=$at FAIL_IN=$where LD_PRELOAD="$BUILD/failing_malloc.so" "${run[@]}" --json out.json >out 2>err || code=$?
        checked=$((checked + 1))
        case $code in
        0) [[ -s out.json ]] || note_failure "$where $at: no result" ;;
        3) grep -q 'out of memory' out err || note_failure "$where $at: exit code 3: $(cat out err)" ;;
        *) note_failure "$where $at: exit code $code: $(cat out err)" ;;
        esac
        [[ ! -e out.json ]] || python3 -m json.tool out.json >/dev/null || note_failure "$where $at: half a result"
    done
done
echo "$checked allocations of $count"
exit $failed
