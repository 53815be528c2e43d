#!/usr/bin/env bash
# The engine gives the committed bits with 1, 2, 3 and 8 threads, in 20 scenes and three profiles, and the
# thread sanitizer finds no race.
set -euo pipefail
# shellcheck source=tests/support/golden_hashes.sh
source "$SOURCE/tests/support/golden_hashes.sh"

sanitized=$(build_driver tsan gcc "-O1 -g -fsanitize=thread" -DCMAKE_CXX_FLAGS=-fsanitize=thread)
for threads in 1 2 3 8; do
    expect_golden "$threads threads" "$BUILD/determinism_driver" "$threads"
done
expect_golden "8 threads under the thread sanitizer" "$sanitized" 8
