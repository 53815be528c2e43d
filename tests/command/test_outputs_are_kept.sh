#!/usr/bin/env bash
# No command replaces a file or results that exist, unless --force says so.
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

# refused FILE ARGUMENT...: with something in FILE, `plumb ARGUMENT...` exits with 2, names FILE and --force,
# and leaves FILE as it is; with --force it is replaced.
refused() {
    local file=$1 actual=0
    shift
    mkdir -p "$(dirname "$file")"
    echo mine >"$file"
    "$PLUMB" "$@" >out 2>err </dev/null || actual=$?
    [[ $actual == 2 ]] || note_failure "$*: exit code $actual, expected 2: $(cat err)"
    grep -qF -- "${file#./}" err && grep -qF -- --force err || note_failure "$*: the message is $(cat err)"
    [[ $(cat "$file") == mine ]] || note_failure "$*: $file was replaced"
    actual=0
    "$PLUMB" "$@" --force >out 2>err </dev/null || actual=$?
    [[ $actual == "${forced:-0}" ]] || note_failure "$* --force: exit code $actual: $(cat err)"
    [[ -s $file && $(cat "$file") != mine ]] || note_failure "$* --force: $file stays"
}

short=(--set n=2 --duration 0.05 --engine plumb)
refused run.json run free-fall "${short[@]:2}" --json run.json
refused frames.csv run free-fall "${short[@]:2}" --trajectory frames.csv
refused problem1.json run tower "${short[@]}" --capture '2:problem{}.json'
refused problem.json run tower "${short[@]}" --capture 2:problem.json

refused all.json compare free-fall "${short[@]:2}" --out a --json all.json
refused page/index.html compare free-fall "${short[@]:2}" --out page
refused b/results.jsonl compare free-fall "${short[@]:2}" --out b
[[ ! -e b/results.jsonl.replaced ]] || note_failure "what was replaced is left"
grep -q '"run"' b/results.jsonl || note_failure "compare --force: no results"
# What a killed --force has left is two files: the old results, and the new ones so far.
mv b/results.jsonl b/results.jsonl.replaced
expect 2 'has results: --resume keeps them .*--force replaces them' compare free-fall "${short[@]:2}" --out b
refused s/results.jsonl sweep free-fall --vary dt=1/60 "${short[@]:2}" --out s
refused s.json sweep free-fall --vary dt=1/60 "${short[@]:2}" --out s2 --json s.json
refused plan.jsonl sweep free-fall --vary dt=1/60 "${short[@]:2}" --plan plan.jsonl
refused t/shard-1-of-2/results.jsonl sweep free-fall --vary dt=1/60 "${short[@]:2}" --out t --shard 1/2
expect 2 'or a shard next to it, has results: --resume .*--force' sweep free-fall --vary dt=1/60 \
    "${short[@]:2}" --out t
refused e/results.jsonl ensemble falling-cubes "${short[@]}" --members 6 --out e
refused e.json ensemble falling-cubes "${short[@]}" --members 6 --out e2 --json e.json
refused t.json threshold slope-threshold --engine plumb --json t.json
refused m.json metamorphic free-fall "${short[@]:2}" --check again --json m.json --out m
refused c.json check-engine plumb --check gravity --json c.json
refused gate.xml gate a --fail-if 'free-fall: outcome!=ok' --format junit --out gate.xml
refused list.html list scenarios --page list.html
tune=(tune free-fall --duration 0.1 --engine plumb:fast --target 'value_error<=10' --budget 2 --fix dt=1/60)
refused tuned/plumb.profile.json "${tune[@]}" --out tuned
refused tuned.json "${tune[@]}" --out tuned2 --json tuned.json

# A report replaces that of the same results; those that it would not have are kept.
expect 0 'the report are in c/' report a --out c
expect 0 'the report are in c/' report a --out c
expect 2 'has 1 results that the report would not have.*--force' report e --out c
expect 0 'the report are in c/' report e --out c --force
refused d/index.html report a --out d
refused d/runs.csv report a --out d --format csv
"$PLUMB" threshold slope-threshold --engine plumb --json study.json --out once >out 2>&1
refused d/threshold.html report study.json --out d

mkdir new
echo mine >new/file
expect 2 'new exists, and is not empty' new-engine new
expect 2 'give one' compare free-fall "${short[@]:2}" --out a --resume --force

# With --resume, results of another time step, seed, option or scene are others: all are made, none is reused.
runs() { sed 's/.*"run":"\([0-9a-f]*\)".*/\1/' r/results.jsonl; }
count=0
resumed() {
    count=$((count + 1))
    "$PLUMB" compare "$@" --resume --out r >out 2>err || note_failure "$*: $(cat err)"
    [[ $(runs | sort -u | wc -l) == "$count" && $(runs | wc -l) == "$count" ]] ||
        note_failure "$*: $(runs | wc -l) results, expected $count"
}
resumed tower "${short[@]}"
resumed tower "${short[@]}" --dt 1/240
resumed tower "${short[@]}" --seed 1
resumed tower --set n=3 --duration 0.05 --engine plumb
resumed tower "${short[@]}" --duration 0.06
resumed tower --set n=2 --duration 0.05 --engine plumb:fast
resumed tower --set n=2 --duration 0.05 --engine plumb,iterations=7
"$PLUMB" scene tower --set n=2 >scene.json
resumed ./scene.json --duration 0.05 --engine plumb
"$PLUMB" scene tower --set n=3 >scene.json
resumed ./scene.json --duration 0.05 --engine plumb
exit $failed
