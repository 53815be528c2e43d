#!/usr/bin/env bash
# The engine gives the committed bits without optimisation and wide kernels, and under gcc and clang with all
# that the machine has: the whole way from scenario to poses is compiled by each. No compiler fuses a
# multiplication and an addition; gcc, which would, does not in the referee either. test_golden_hashes checks
# the usual builds.
set -euo pipefail
# shellcheck source=tests/support/golden_hashes.sh
source "$SOURCE/tests/support/golden_hashes.sh"

# fused NAME: how many fused instructions the objects of $folder/NAME have.
fused() {
    find "$folder/$1" -name '*.o' -exec objdump -d --no-show-raw-insn {} + | grep -cE '\svfn?m(add|sub)' || true
}

# A processor of another name has no wide kernels.
driver=$(build_driver plain gcc -O0 -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=scalar)
expect_golden "gcc -O0, scalar kernels" "$driver"
for compiler in gcc clang; do
    command -v "$compiler" >/dev/null || {
        echo "$compiler is not installed: only the other one is tried" >&2
        continue
    }
    driver=$(build_driver "$compiler" "$compiler" "-O3 -march=native")
    expect_golden "$compiler -O3 -march=native" "$driver"
    [[ $compiler == clang ]] || cmake --build "$folder/$compiler" --target plumb_referee >/dev/null
    [[ $(fused "$compiler") == 0 ]] || {
        echo "$compiler -O3 -march=native: fused instructions" >&2
        exit 1
    }
done
