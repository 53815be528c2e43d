#!/usr/bin/env bash
# A sweep by GNU parallel, a worker of which is killed and resumed, has the rows of one process.
# shellcheck source=tests/support/sweep_shards.sh
source "$SOURCE/tests/support/sweep_shards.sh"
command -v parallel >/dev/null || { echo "GNU parallel is not installed"; exit 77; }

# run_shards OPTION...: all four, of which the numbers of the processes are in pid.I.
run_shards() {
    # shellcheck disable=SC2016
    parallel --will-cite -j 2 'sh -c "echo \$\$ >pid.{}; exec \"\$@\"" sh' \
        "$PLUMB" "${sweep[@]}" --out shards --shard '{}/4' "$@" ::: 1 2 3 4 2>/dev/null
}

run_whole
run_shards &
shards=$!
kill_in_mid_run shards/shard-2-of-4/results.jsonl pid.2
code=0
wait "$shards" || code=$?
[[ $code == 1 ]] || note_failure "of four workers one was killed, parallel counts $code"
note_unfinished shards/shard-2-of-4/results.jsonl
run_shards --resume || note_failure "a resumed shard failed"
check_same_rows
exit $failed
