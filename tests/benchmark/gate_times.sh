#!/usr/bin/env bash
# How well plumb gate tells a fifth more work in every step of our own engine from the noise of this
# machine: gate_times.sh BUILD [UNCHANGED [SLOWER]] gates so many runs of each (20 and 4) against a
# baseline made first, and prints what failed. Where a step takes microseconds, reading the clock for it
# is more than a fifth. Nothing else in the tree depends on what this finds.
set -eu
BUILD=$(cd "${1:?usage: gate_times.sh BUILD [UNCHANGED [SLOWER]]}" && pwd)
SOURCE=$(cd "$(dirname "$0")/../.." && pwd)
unchanged=${2:-20} slower=${3:-4}
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
# shellcheck source=tests/support/faulty_plumb.sh
source "$SOURCE/tests/support/faulty_plumb.sh"

faulty slow engine/src/step/world_step.c 's/^pe_status pe_world_step(/static pe_status swift_step(/
$a\
static double spent(void)\
{\
    struct timespec t;\
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);\
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;\
}\
pe_status pe_world_step(pe_world *world, double dt, pe_step_stats *stats, pe_error *error)\
{\
    const double began = spent();\
    pe_status status = swift_step(world, dt, stats, error);\
    for (double ended = spent(); spent() < ended + 0.2 * (ended - began);) {\
    }\
    return status;\
}'

# run PLUMB: the results that are gated.
run() {
    rm -rf "$directory/results"
    "$1" compare tower wall slope-stick --set n=25 --set rows=10 --set columns=10 --engine plumb \
        --engine plumb:fast --engine bullet:si --repeat 9 --out "$directory/results" >/dev/null 2>&1
}

# count PLUMB TIMES: gates so many runs, prints failures, and leaves in $failures how many failed.
count() {
    failures=0
    for ((i = 0; i < $2; ++i)); do
        run "$1"
        "$BUILD/plumb" gate "$directory/results" --baseline "$directory/baseline.json" \
            >"$directory/said" || failures=$((failures + 1))
        grep '^FAIL' "$directory/said" || true
    done
}

run "$BUILD/plumb"
"$BUILD/plumb" gate "$directory/results" --baseline "$directory/baseline.json" --update-baseline \
    --reference bullet:si 2>/dev/null
count "$BUILD/plumb" "$unchanged"
echo "unchanged: $failures of $unchanged failed"
count "$directory/slow" "$slower"
echo "a fifth more work a step: $failures of $slower failed"
