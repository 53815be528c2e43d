#!/usr/bin/env bash
# The engine gives the same bits under gcc and clang, -O0 and -O2, with and without wide instructions: the
# whole way from scenario to poses is compiled by each and the hashes of all frames compared. The
# optimised programs also run a second time.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$SOURCE"
# shellcheck source=tests/support/build_driver.sh
source tests/support/build_driver.sh
compilers=gcc
if command -v clang >/dev/null; then
    compilers="gcc clang"
else
    echo "clang is not installed: only gcc's levels are compared" >&2
fi

machines=scalar
[[ $(uname -m) == x86_64 ]] && machines="wide scalar"
reference=
for compiler in $compilers; do
    for level in -O0 -O2; do
        for machine in $machines; do
            [[ $machine == scalar && $level == -O0 && $machines != scalar ]] && continue
            build "$compiler" "$level" "$machine"
            runs=1
            [[ $level == -O2 ]] && runs="1 2"
            for run in $runs; do
                hashes=$("$folder/driver")
                if [[ -z $reference ]]; then
                    reference=$hashes
                    echo "$hashes"
                elif [[ $hashes != "$reference" ]]; then
                    echo "$compiler $level $machine, run $run differs:" >&2
                    diff <(echo "$reference") <(echo "$hashes") >&2 || true
                    exit 1
                fi
            done
        done
    done
done
