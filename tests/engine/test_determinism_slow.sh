#!/usr/bin/env bash
# The engine gives the committed bits under gcc and clang, without optimisation and with all that the machine
# has, with and without wide kernels: the whole way from scenario to poses is compiled by each. No compiler
# fuses a multiplication and an addition, in the referee either. test_golden_hashes checks the usual builds.
set -euo pipefail
# shellcheck source=tests/support/golden_hashes.sh
source "$SOURCE/tests/support/golden_hashes.sh"

# A processor of another name has no wide kernels.
scalar=(-DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=scalar)
for compiler in gcc clang; do
    command -v "$compiler" >/dev/null || {
        echo "$compiler is not installed: only the other one is tried" >&2
        continue
    }
    driver=$(build_driver "$compiler-O0" "$compiler" -O0 "${scalar[@]}")
    expect_golden "$compiler -O0, scalar kernels" "$driver"
    driver=$(build_driver "$compiler-native" "$compiler" "-O3 -march=native")
    expect_golden "$compiler -O3 -march=native" "$driver"
    [[ $(uname -m) == x86_64 ]] || continue
    cmake --build "$folder/$compiler-native" --target plumb_referee >/dev/null
    fused=$(find "$folder/$compiler-native" -name '*.o' -exec objdump -d --no-show-raw-insn {} + |
        grep -cE '\svfn?m(add|sub)' || true)
    [[ $fused == 0 ]] || {
        echo "$compiler -O3 -march=native: $fused fused instructions" >&2
        exit 1
    }
done
