# Sourced by the tests of sweeps made by several processes: the sweep, and what they all check.
set -u
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
unset "${!SLURM_@}" "${!OMPI_@}" "${!PMIX_@}" "${!PMI_@}"

# 252 runs, and 108 of ODE where it is there.
sweep=(sweep tower --engine plumb --engine plumb:fast --engine ode:quick
    --engine "$BUILD/faulty_engine.so:good" --vary n=6..11 --vary dt=1/120,1/60
    --vary iterations=5,50,500 --repeat 3 --duration 1)

# The whole sweep in one process, into whole/.
run_whole() {
    "$PLUMB" "${sweep[@]}" --out whole 2>/dev/null || note_failure "the sweep in one process failed"
    [[ $(wc -l <whole/results.jsonl) -ge 200 ]] || note_failure "the sweep has fewer than 200 runs"
}

# kill_in_mid_run RESULTS PID_FILE: kills the process when it has written three results.
kill_in_mid_run() {
    local count=0
    for _ in $(seq 3000); do
        count=$(cat "$1" 2>/dev/null | wc -l)
        [[ $count -ge 3 ]] && break
        sleep 0.01
    done
    [[ $count -ge 3 ]] || note_failure "$1 got no results"
    kill -KILL "$(cat "$2")"
}

# note_unfinished RESULTS: what the shard that was killed has so far.
note_unfinished() {
    killed=$1
    cut_at=$(wc -l <"$1")
}

# The shards' rows, each once, are those of one process but for what costs and where it was made.
check_same_rows() {
    local row_files=(shards/shard-*/results.jsonl)
    [[ $(cat "${row_files[@]}" | wc -l) == "$(wc -l <whole/results.jsonl)" ]] ||
        note_failure "a run was made twice, or not at all"
    [[ $(wc -l <"$killed") -gt $cut_at ]] || note_failure "nothing was left to resume in $killed"
    "$PLUMB" report shards --out merged 2>report.log || note_failure "no report: $(cat report.log)"
    grep -qE 'double|differ' report.log && note_failure "$(cat report.log)"
    python3 - <<'END' || note_failure "the rows of the shards are not those of one process"
import json

def rows(path):
    found = {}
    for line in open(path):
        row = json.loads(line)
        for key in ("command", "started", "host"):
            row.pop(key)
        for name in [name for name, metric in row["metrics"].items() if not metric["deterministic"]]:
            del row["metrics"][name]
        assert row["run"] not in found
        found[row["run"]] = row
    return found

whole, merged = rows("whole/results.jsonl"), rows("merged/results.jsonl")
assert whole.keys() == merged.keys()
for run, row in whole.items():
    assert row == merged[run], (row, merged[run])
END
}
