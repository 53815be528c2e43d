#!/usr/bin/env bash
# Every fault of the engines in tests/compare/broken fails some check of a full run.
set -eu
command=check-engine
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
export PLUMB_CACHE=$directory

for part in setup step read; do
    expect 1 'conformance failed' "$BUILD/broken_$part.so" --all-profiles --quiet --timeout 5
    if grep -E 'conformance passed' out | grep -v ':good:'; then
        note_failure "faults of $part that no check sees: $(grep 'conformance passed' out)"
    fi
done
exit $failed
