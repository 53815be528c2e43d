#!/usr/bin/env bash
# A sweep by mpirun, a rank of which is killed, so that all end, and resumed, has the rows of one process.
# shellcheck source=tests/support/sweep_shards.sh
source "$SOURCE/tests/support/sweep_shards.sh"
command -v mpirun >/dev/null || { echo "mpirun is not installed"; exit 77; }
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1

run_ranks() {
    # shellcheck disable=SC2016
    mpirun --oversubscribe --bind-to none -n 3 \
        sh -c 'echo $$ >pid.$OMPI_COMM_WORLD_RANK; exec "$@"' sh \
        "$PLUMB" "${sweep[@]}" --out shards "$@" >ranks.log 2>&1 </dev/null
}

# Where mpirun cannot start a process at all, nothing is to be tested.
if ! mpirun --oversubscribe --bind-to none -n 1 true >probe.log 2>&1 </dev/null; then
    cat probe.log
    exit 77
fi
run_whole
run_ranks &
ranks=$!
kill_in_mid_run shards/shard-2-of-3/results.jsonl pid.1
wait "$ranks" && note_failure "mpirun did not say that a rank was killed"
note_unfinished shards/shard-2-of-3/results.jsonl
run_ranks --resume || note_failure "a resumed rank failed: $(tail ranks.log)"
check_same_rows
exit $failed
