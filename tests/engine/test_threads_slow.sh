#!/usr/bin/env bash
# The engine gives the same bits with 1, 2, 3 and 8 threads, in 20 scenes and three profiles, and the
# thread sanitizer finds no race.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$SOURCE"
# shellcheck source=tests/support/build_driver.sh
source tests/support/build_driver.sh

reference=
for level in -O2 '-O1 -g -fsanitize=thread'; do
    build gcc "$level" wide
    for threads in 1 2 3 8; do
        hashes=$("$folder/driver" "$threads")
        if [[ -z $reference ]]; then
            reference=$hashes
            echo "$hashes"
        elif [[ $hashes != "$reference" ]]; then
            echo "$threads threads, gcc $level differ from one:" >&2
            diff <(echo "$reference") <(echo "$hashes") >&2 || true
            exit 1
        fi
    done
done
