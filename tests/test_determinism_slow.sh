#!/usr/bin/env bash
# The engine gives the same bits under gcc and clang, -O0 and -O2, and at a second run: the whole way from
# scenario to poses is compiled by each and the hashes of all frames compared.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$SOURCE"
sources="engine/src/*.c scenarios/src/*.c scenarios/catalogue/*.c compare/adapters/adapter_plumb.c
         compare/adapters/force.c tests/determinism/driver.c"
includes="-Iengine/include -Iscenarios/include -Iscenarios/src -Iscenarios/catalogue -Icompare
          -Icompare/include"
compilers=gcc
if command -v clang >/dev/null; then
    compilers="gcc clang"
else
    echo "clang is not installed: only gcc's levels are compared" >&2
fi

reference=
for compiler in $compilers; do
    for level in -O0 -O2; do
        # shellcheck disable=SC2086
        $compiler -std=c17 $level -ffp-contract=off -D_GNU_SOURCE -DPLUMB_VERSION='"test"' \
            $includes $(pkg-config --cflags jansson) -o "$folder/driver" $sources \
            $(pkg-config --libs jansson) -lm
        for run in 1 2; do
            hashes=$("$folder/driver")
            if [[ -z $reference ]]; then
                reference=$hashes
                echo "$hashes"
            elif [[ $hashes != "$reference" ]]; then
                echo "$compiler $level, run $run differs:" >&2
                diff <(echo "$reference") <(echo "$hashes") >&2 || true
                exit 1
            fi
        done
    done
done
