#!/usr/bin/env bash
# The engine gives the same bits with 1, 2, 3 and 8 threads, in 20 scenes and three profiles, and the
# thread sanitizer finds no race.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$SOURCE"
# shellcheck source=tests/support/build_driver.sh
source tests/support/build_driver.sh

build gcc '-O1 -g -fsanitize=thread' wide
reference=$("$BUILD/determinism_driver" 1)
echo "$reference"
for driver in "$BUILD/determinism_driver" "$folder/driver"; do
    for threads in 1 2 3 8; do
        hashes=$("$driver" "$threads") || {
            echo "$driver $threads: exit code $?" >&2
            exit 1
        }
        if [[ $hashes != "$reference" ]]; then
            echo "$driver $threads differs from one thread:" >&2
            diff <(echo "$reference") <(echo "$hashes") >&2 || true
            exit 1
        fi
    done
done
