#!/usr/bin/env bash
# Want of descriptors, of space and of permissions: what is written stays whole, the exit code is 3, and --resume
# makes what is missing.
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

compare=(compare free-fall bounce --duration 0.05 --engine plumb --engine plumb:fast)

# whole FOLDER: every line of its results ends, and no run is there twice.
whole() {
    [[ -z $(tail -c 1 "$1/results.jsonl") ]] || note_failure "$1: a cut line"
    [[ -z $(grep -o '"run":"[0-9a-f]*"' "$1/results.jsonl" | sort | uniq -d) ]] || note_failure "$1: a run twice"
}

# Few descriptors: with as many as one run at a time needs, any number of jobs makes all runs.
with_descriptors() { # with_descriptors COUNT JOBS
    rm -rf few
    (ulimit -n "$1"; exec "$PLUMB" "${compare[@]}" --repeat 3 --jobs "$2" --no-recordings --out few) >out 2>err
}
least=8
until with_descriptors $least 1; do
    least=$((least + 1))
    [[ $least -lt 64 ]] || break
done
with_descriptors $least 30 || note_failure "$least descriptors: $(cat err)"
whole few
[[ $(wc -l <few/results.jsonl) == 12 ]] || note_failure "$least descriptors: $(wc -l <few/results.jsonl) results"

# Files that may grow no more.
actual=0
(ulimit -f 10; exec "$PLUMB" "${compare[@]}" --no-recordings --out limited) >out 2>err || actual=$?
[[ $actual == 3 ]] && grep -q 'limited/results.jsonl: File too large' err ||
    note_failure "large files: exit code $actual: $(cat err)"
whole limited
[[ $(wc -l <limited/results.jsonl) == 2 ]] || note_failure "large files: $(wc -l <limited/results.jsonl) results"
"$PLUMB" "${compare[@]}" --no-recordings --out limited --resume >out 2>err || note_failure "$(cat err)"
[[ $(wc -l <limited/results.jsonl) == 4 ]] || note_failure "large files: not resumed"
for call in "run free-fall --engine plumb --trajectory limited.csv" "list scenarios --page limited.html"; do
    actual=0
    # shellcheck disable=SC2086
    (ulimit -f 4; exec "$PLUMB" $call) >out 2>err || actual=$?
    [[ $actual == 3 ]] && grep -q 'File too large' err || note_failure "$call: exit code $actual: $(cat err)"
done
compgen -G 'limited.*' >left && note_failure "what was not complete is left: $(cat left)"

# A disk that is full, as in the middle of a comparison.
mkdir disk
if mount -t tmpfs -o size=48k tmpfs disk 2>/dev/null; then
    trap 'umount "$directory/disk"; rm -rf "$directory"' EXIT
    actual=0
    "$PLUMB" "${compare[@]}" --repeat 4 --no-recordings --out disk/full >out 2>err || actual=$?
    [[ $actual == 3 ]] && grep -q 'disk/full/results.jsonl: No space left' err ||
        note_failure "a full disk: exit code $actual: $(cat err)"
    whole disk/full
    before=$(wc -l <disk/full/results.jsonl)
    [[ $before -ge 4 ]] || note_failure "a full disk: $before results"
    mount -o remount,size=8m disk
    "$PLUMB" "${compare[@]}" --repeat 4 --no-recordings --out disk/full --resume >out 2>err ||
        note_failure "a full disk: $(cat err)"
    whole disk/full
    [[ $(wc -l <disk/full/results.jsonl) == 16 ]] || note_failure "a full disk: not resumed"
    mount -o remount,ro disk
    expect 3 'Read-only file system' "${compare[@]}" --out disk/other
    expect 3 'Read-only file system' run free-fall --duration 0.05 --engine plumb --json disk/run.json
    expect 3 'Read-only file system' threshold slope-threshold --engine plumb --out disk/threshold
else
    echo "no file system can be mounted here"
fi

# Another process that makes the same study.
python3 - "$PLUMB" <<'END' || note_failure "a second process was not refused"
import fcntl, subprocess, sys
with open("few/results.jsonl", "r+") as file:
    fcntl.lockf(file, fcntl.LOCK_EX)
    for way in ([], ["--resume"], ["--force"]):
        done = subprocess.run([sys.argv[1], "compare", "free-fall", "--engine", "plumb", "--out", "few", *way],
                              capture_output=True, text=True)
        assert done.returncode == 3 and "another plumb is writing it" in done.stderr, (way, done)
END
whole few
[[ $(wc -l <few/results.jsonl) == 12 ]] || note_failure "a second process changed the results"
exit $failed
