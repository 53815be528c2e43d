#!/usr/bin/env bash
# The engine gives the committed bits under gcc with every optimisation, and under clang with none and without
# wide kernels; both may use all instructions of the machine. The whole way from scenario to poses is compiled
# by each. No compiler fuses a multiplication and an addition; gcc, which would, does not in the referee
# either. test_golden_hashes checks the usual builds.
set -euo pipefail
# shellcheck source=tests/support/golden_hashes.sh
source "$SOURCE/tests/support/golden_hashes.sh"

# fused NAME: how many fused instructions the objects of $folder/NAME have.
fused() {
    find "$folder/$1" -name '*.o' -exec objdump -d --no-show-raw-insn {} + | grep -cE '\svfn?m(add|sub)' || true
}

# A processor of another name has no wide kernels.
scalar="-DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=scalar"
for build in "gcc -O3" "clang -O0 $scalar"; do
    read -r compiler level options <<<"$build"
    command -v "$compiler" >/dev/null || {
        echo "$compiler is not installed: only the other one is tried" >&2
        continue
    }
    # shellcheck disable=SC2086
    driver=$(build_driver "$compiler" "$compiler" "$level -march=native" $options)
    expect_golden "$compiler $level -march=native" "$driver"
    [[ $compiler == clang ]] || cmake --build "$folder/$compiler" --target plumb_referee >/dev/null
    [[ $(fused "$compiler") == 0 ]] || {
        echo "$compiler $level -march=native: fused instructions" >&2
        exit 1
    }
done
