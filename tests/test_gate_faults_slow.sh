#!/usr/bin/env bash
# Faults put into our own engine, one at a time: the gate must see each against tests/baseline/plumb.json,
# and say where and by how much.
set -eu
# shellcheck source=tests/baseline/runs.sh
source "$SOURCE/tests/baseline/runs.sh"
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT

ninja -C "$BUILD" -t commands plumb >"$directory/commands" || exit 77 # another generator

fail() {
    echo "$*" >&2
    exit 1
}

# faulty NAME FILE SED: NAME becomes a plumb whose FILE has the change, compiled and linked as the build
# does, its object before the libraries and so in place of theirs.
faulty() {
    local name=$directory/$1 file=$SOURCE/$2 compile link
    sed "$3" "$file" >"$name.c"
    ! cmp -s "$file" "$name.c" || fail "$2: \"$3\" changes nothing"
    compile=$(grep -F -- "-c $file" "$directory/commands")
    compile=${compile%" -c $file"*}
    compile=$(sed -E 's/ -(o|MF|MT) [^ ]+//g; s/ -MD\b//' <<<"$compile")
    link=$(tail -n 1 "$directory/commands")
    (cd "$BUILD" && eval "$compile -I$(dirname "$file") -c $name.c -o $name.o" &&
        eval "${link/ -o plumb / $name.o -o $name }") || fail "$1 does not build"
}

# judge DIRECTORY PATTERN...: the gate fails, and a line matches each pattern.
judge() {
    local code=0 results=$1 pattern
    shift
    "$PLUMB" gate "$results/still" "$results/swept" --baseline "$SOURCE/tests/baseline/plumb.json" \
        >"$directory/said" || code=$?
    ((code == 1)) || { cat "$directory/said" >&2; fail "$results: exit code $code, not 1"; }
    for pattern in "$@"; do
        grep -Eq -- "$pattern" "$directory/said" ||
            { cat "$directory/said" >&2; fail "$results: nothing matches $pattern"; }
    done
}

friction='s/\.friction = m->friction,/.friction = FACTOR * m->friction,/'
faulty wider engine/src/solve/problem_build.c "${friction/FACTOR/1.01}"
faulty narrower engine/src/solve/problem_build.c "${friction/FACTOR/0.99}"
faulty cold engine/src/contact/contact_match.c \
    's/point->impulse = pushes ? old->impulse/point->impulse = pushes \&\& 0 ? old->impulse/'
for fault in wider narrower cold; do
    mkdir "$directory/$fault-results"
    baseline_runs "$directory/$fault" "$directory/$fault-results"
done
judge "$directory/wider-results" \
    '^FAIL +slide-to-stop / plumb:accurate: friction_effective: 0\.5 -> 0\.505, allowed' \
    '^FAIL +slide-to-stop / plumb:accurate: reference_error: .* -> .*, allowed' \
    '^FAIL +reaction-split / plumb:accurate: cone_violation: .* -> 0\.01, allowed'
judge "$directory/narrower-results" \
    '^FAIL +slide-to-stop / plumb:accurate: friction_effective: 0\.5 -> 0\.495, allowed'
judge "$directory/cold-results" \
    '^FAIL +reaction-split / plumb:accurate: iterations_mean: .* -> .*, allowed'

# Sound, but for a scenario that is not run any more.
mkdir "$directory/fewer" "$directory/fewer/still"
baseline_runs "$PLUMB" "$directory/fewer"
sed -i '/"scenario":"tower"/d' "$directory/fewer/still/results.jsonl"
judge "$directory/fewer" '^FAIL +tower / plumb:accurate: outcome: ok -> missing, allowed'
