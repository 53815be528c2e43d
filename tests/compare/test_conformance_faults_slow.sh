#!/usr/bin/env bash
# Every fault of the engines in tests/compare/broken fails some check of a full run.
set -eu
command=check-engine
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
export PLUMB_CACHE=$directory

# One of the faults in broken_step hangs in almost every check.
for part in setup:10 step:1 read:10; do
    expect 1 'conformance failed' "$BUILD/broken_${part%:*}.so" --all-profiles --quiet --timeout "${part#*:}"
    grep 'conformance passed' out | grep -v ':good:' >unseen || continue
    note_failure "no check sees: $(cat unseen)"
done
exit $failed
