#!/usr/bin/env bash
# plumb sweep and plumb report as a user meets them: the plan, shards, what is resumed, and what a report
# of several files has.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
export PLUMB
unset "${!SLURM_@}" "${!OMPI_@}" "${!PMIX_@}" "${!PMI_@}"

# runs FILE...: the run hashes in their order.
runs() {
    cat "$@" | grep -o '"run":"[0-9a-f]*"'
}

expect 2 'name a scenario, a scene file or a --suite' sweep
expect 2 'did you mean iterations' sweep free-fall --vary itertions=1
expect 2 'is empty: a range goes up' sweep free-fall --vary dt=1/60..1/240
expect 2 'is endless' sweep free-fall --vary dt=1/240..1/60:x1
expect 2 'at most 100000' sweep free-fall --vary dt=0.001..1:+0.00002 --engine plumb --repeat 9
expect 2 '--shard takes I/N, from 1/N to N/N' sweep free-fall --shard 0/4
expect 2 'did you mean --vary' sweep free-fall --vry dt=1
[[ ! -e sweep ]] || note_failure "a sweep that was refused left a folder"

expect 2 '--settings belongs to the sweep without --vary' sweep free-fall --vary dt=1/60 --settings 3

# The usual sweep: each profile and the tuned one at five steps, two settings of each engine besides, and changed scenes, which
# are not repeated.
"$PLUMB" sweep free-fall --engine plumb --engine plumb:fast --settings 2 --changes 1 --repeat 2 --plan - >usual.jsonl
python3 - <<'END' || note_failure "the usual sweep is not as described"
import json
plan = [json.loads(line) for line in open("usual.jsonl")]
points = {(run["label"], run["settings"]["dt"]) for run in plan}
assert len(points) == 3 * 5 + 2, points
assert len({run["run"] for run in plan}) == len(plan) == 3 * len(points)
for point in points:
    kinds = sorted((run["repeat"], run.get("change", "")) for run in plan
                   if (run["label"], run["settings"]["dt"]) == point)
    assert kinds == [(0, ""), (0, "parameters within 1 %, draw 1"), (1, "")], kinds
assert {run["label"] for run in plan if run["as_shipped"]} == {"plumb:default"}
END
"$PLUMB" sweep free-fall --engine plumb --settings 0 --changes 0 --repeat 1 --plan - >usual.jsonl
[[ $(wc -l <usual.jsonl) == 10 ]] || note_failure "settings or changes that were turned off are run"

sweep=(sweep free-fall uniform.json --engine plumb --engine plumb:fast --vary dt=1/60,1/30
    --vary iterations=1,2 --duration 0.5 --repeat 2)
python3 - <<'END'
import json, subprocess, os
scene = json.loads(subprocess.run([os.environ["PLUMB"], "scene", "free-fall"], capture_output=True,
                                  check=True, text=True).stdout)
scene.pop("expect", None)
scene["duration"] = 0.5
with open("uniform.json", "w") as file:
    print(json.dumps(scene), file=file)
END

# The plan is what one process makes, in its order; nothing is run for it.
"$PLUMB" "${sweep[@]}" --plan plan.jsonl --out whole || note_failure "--plan failed"
[[ ! -e whole ]] || note_failure "--plan made a folder"
expect 0 '32 results are in whole/results.jsonl' "${sweep[@]}" --out whole
[[ $(runs plan.jsonl) == "$(runs whole/results.jsonl)" ]] || note_failure "the plan is not what was run"
[[ $(runs plan.jsonl | sort -u | wc -l) == 32 ]] || note_failure "a run is planned twice"
"$PLUMB" "${sweep[@]}" --plan - | cmp - plan.jsonl || note_failure "--plan - differs from --plan FILE"
python3 - <<'END' || note_failure "the plan's lines are wrong"
import json
plan = [json.loads(line) for line in open("plan.jsonl")]
rows = [json.loads(line) for line in open("whole/results.jsonl")]
for index, (line, row) in enumerate(zip(plan, rows)):
    assert line.pop("schema") == "plumb.plan/1" and line.pop("index") == index
    assert all(row[key] == value for key, value in line.items()), (line, row)
assert [line["repeat"] for line in plan] == [0] * 16 + [1] * 16
END

# Instructions are counted in all runs that came to their end, or, where the kernel or the machine does not
# count them, in none.
python3 - <<'END' || note_failure "instructions_per_step is wrong"
import json
rows = [json.loads(line) for line in open("whole/results.jsonl")]
found = [row["metrics"].get("instructions_per_step") for row in rows if row["outcome"] == "ok"]
assert found and (all(found) or not any(found))
for metric in found:
    if metric is not None:
        assert metric["value"] > 100 and metric["unit"] == "1" and metric["direction"] == "lower"
        assert metric["deterministic"] is False
END

# Resumed, nothing finished is made again, also what another shard or the whole sweep made.
cp whole/results.jsonl before.jsonl
expect 0 '32 results are in' "${sweep[@]}" --out whole --resume
cmp -s whole/results.jsonl before.jsonl || note_failure "--resume made a finished run again"
head -n 9 before.jsonl >whole/results.jsonl
head -n 10 before.jsonl | tail -n 1 | head -c 100 >>whole/results.jsonl
expect 0 '32 results are in' "${sweep[@]}" --out whole --resume
[[ $(runs whole/results.jsonl) == "$(runs plan.jsonl)" ]] || note_failure "--resume lost or doubled a run"
[[ $(head -n 9 whole/results.jsonl) == "$(head -n 9 before.jsonl)" ]] ||
    note_failure "--resume changed what was there"

# Shards, by option and by environment; the last by another number of shards, with nothing left.
expect 0 '8 results are in shards/shard-1-of-4/results.jsonl' "${sweep[@]}" --out shards --shard 1/4
SLURM_ARRAY_TASK_ID=6 SLURM_ARRAY_TASK_MIN=5 SLURM_ARRAY_TASK_COUNT=4 \
    expect 0 '8 results are in shards/shard-2-of-4/' "${sweep[@]}" --out shards
OMPI_COMM_WORLD_RANK=2 OMPI_COMM_WORLD_SIZE=4 \
    expect 0 '8 results are in shards/shard-3-of-4/' "${sweep[@]}" --out shards
PMIX_RANK=3 PMIX_SIZE=4 expect 0 '8 results are in shards/shard-4-of-4/' "${sweep[@]}" --out shards
expect 0 '0 results are in shards/shard-2-of-3/' "${sweep[@]}" --out shards --shard 2/3 --resume
[[ $(runs shards/*/results.jsonl | sort) == "$(runs plan.jsonl | sort)" ]] ||
    note_failure "the shards are not the sweep"
"$PLUMB" "${sweep[@]}" --shard 2/4 --plan - >shard.jsonl
[[ $(runs shard.jsonl) == "$(runs shards/shard-2-of-4/results.jsonl)" ]] ||
    note_failure "the plan of a shard is not what it makes"

# A report of files and folders; doubles are dropped and, where they differ, said.
expect 0 '32 results of 5 files and the report are in merged/' report shards --out merged
for file in index.html summary.md results.csv results.jsonl; do
    [[ -s merged/$file ]] || note_failure "the report has no $file"
done
[[ $(runs merged/results.jsonl | sort) == "$(runs plan.jsonl | sort)" ]] ||
    note_failure "the report's results are not those of the shards"
expect 0 '32 duplicates were dropped' report whole/results.jsonl shards --out merged
expect 0 '32 results of 1 file' report merged --out merged
cat err | grep -q 'double' && note_failure "doubles in: $(cat err)"
sed 's/"outcome":"ok"/"outcome":"timeout"/' whole/results.jsonl >other.jsonl
expect 0 'warning: 32 of them differ' report whole other.jsonl --out merged
[[ $(grep -c 'was made twice and differs: outcome ok, then timeout' err) == 10 ]] ||
    note_failure "not ten differences are said: $(cat err)"
grep -q timeout merged/results.jsonl && note_failure "what was read first is not kept"

# What a report would lose stays.
cp merged/results.jsonl kept.jsonl
head -n 3 whole/results.jsonl >some.jsonl
expect 2 'has 29 results that the report would not have' report some.jsonl --out merged
cmp -s merged/results.jsonl kept.jsonl || note_failure "a report took results away"

# The example of a job array makes a shard as it stands.
mkdir bin
printf '#!/bin/sh\nshift\nexec "$PLUMB" "$@" --plan -\n' >bin/srun
chmod +x bin/srun
SLURM_ARRAY_TASK_ID=16 SLURM_ARRAY_TASK_MIN=1 SLURM_ARRAY_TASK_COUNT=16 PATH=$PWD/bin:$PATH \
    bash "$SOURCE/compare/studies/sweep/example.slurm" >shard.jsonl 2>err ||
    note_failure "example.slurm failed: $(cat err)"
[[ $(wc -l <shard.jsonl) -gt 0 ]] || note_failure "example.slurm has no runs"

expect 2 'name a file or folder of results' report
expect 2 'has neither a results.jsonl' report .
expect 3 'missing' report missing
expect 2 'uniform.json:1' report uniform.json --out no
: >empty.jsonl
expect 4 'there are no results' report empty.jsonl --out no
exit $failed
