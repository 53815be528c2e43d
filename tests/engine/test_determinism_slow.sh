#!/usr/bin/env bash
# The engine gives the same bits under gcc and clang, -O0 and -O2, with and without wide instructions, and
# at a second run: the whole way from scenario to poses is compiled by each and the hashes of all frames
# compared.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$SOURCE"
sources="engine/src/*/*.c engine/src/*/*/*.c scenarios/base/*.c scenarios/scene/*.c
         scenarios/catalogue/*.c compare/adapters/adapter_plumb.c tests/engine/determinism_driver.c"
includes="-Iengine/include -Iengine/src -Iscenarios/include -Iscenarios
          -Icompare -Icompare/include"
amd=
if [[ -e /usr/include/suitesparse/amd.h ]]; then
    includes="$includes -DPLUMB_HAVE_AMD"
    amd=-lamd
fi
compilers=gcc
if command -v clang >/dev/null; then
    compilers="gcc clang"
else
    echo "clang is not installed: only gcc's levels are compared" >&2
fi

# build COMPILER LEVEL WIDE: the wide kernels have their own flags, as in engine/CMakeLists.txt.
build() {
    local file flags object objects=() commands=() wide=
    [[ $3 == wide ]] && wide="-DPE_SOFT_X86 -DPE_SWEEP_X86"
    for file in $sources; do
        flags=
        case $file in
        *kernels_4.c) flags=-mavx2 ;;
        *kernels_8.c) flags=-mavx512f ;;
        esac
        [[ -n $flags && -z $wide ]] && continue
        object=$folder/$(tr / _ <<<"$file").o
        objects+=("$object")
        commands+=("$1 -std=c17 $2 -ffp-contract=off -D_GNU_SOURCE -DPLUMB_VERSION='\"test\"' -w \
            ${includes//$'\n'/ } $wide $flags $(pkg-config --cflags jansson) -c -o '$object' '$file'")
    done
    printf '%s\0' "${commands[@]}" | xargs -0 -P "$(nproc)" -I '{}' bash -c '{}'
    # shellcheck disable=SC2046
    $1 -o "$folder/driver" "${objects[@]}" $(pkg-config --libs jansson) $amd -lqhull_r -lm
}

machines=scalar
[[ $(uname -m) == x86_64 ]] && machines="wide scalar"
reference=
for compiler in $compilers; do
    for level in -O0 -O2; do
        for machine in $machines; do
            [[ $machine == scalar && $level == -O0 && $machines != scalar ]] && continue
            build "$compiler" "$level" "$machine"
            for run in 1 2; do
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
