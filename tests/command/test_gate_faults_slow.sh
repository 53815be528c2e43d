#!/usr/bin/env bash
# Faults put into our own engine, one at a time: the gate must see each against tests/baseline/plumb.json,
# and say where and by how much.
set -eu
# shellcheck source=tests/baseline/runs.sh
source "$SOURCE/tests/baseline/runs.sh"
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
# shellcheck source=tests/support/faulty_plumb.sh
source "$SOURCE/tests/support/faulty_plumb.sh"

# judge DIRECTORY PATTERN...: the gate fails, and a line matches each pattern.
judge() {
    local code=0 results=$1 pattern
    shift
    baseline_gate "$PLUMB" "$results" "$SOURCE/tests/baseline/plumb.json" >"$directory/said" || code=$?
    ((code == 1)) || { cat "$directory/said" >&2; fail "$results: exit code $code, not 1"; }
    for pattern in "$@"; do
        grep -Eq -- "$pattern" "$directory/said" ||
            { cat "$directory/said" >&2; fail "$results: nothing matches $pattern"; }
    done
}

friction='s/manifold->friction = m->friction;/manifold->friction = FACTOR * m->friction;/'
faulty wider engine/src/problem/problem_build.c "${friction/FACTOR/1.01}"
faulty narrower engine/src/problem/problem_build.c "${friction/FACTOR/0.99}"
faulty cold engine/src/contact/pair_contacts.c \
    's/point->impulse = pe_dot(impulse, normal) > 0 ? impulse/point->impulse = pe_dot(impulse, normal) > 0 \&\& 0 ? impulse/'
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
    '^FAIL +top / plumb:accurate: iterations_mean: .* -> .*, allowed'

# Sound, but for a scenario that is not run any more.
mkdir "$directory/fewer" "$directory/fewer/still"
baseline_runs "$PLUMB" "$directory/fewer"
sed -i '/"scenario":"tower"/d' "$directory/fewer/still/results.jsonl"
judge "$directory/fewer" '^FAIL +tower / plumb:accurate: outcome: ok -> missing, allowed'
