# Sourced by the tests that compile tests/engine/determinism_driver.c with all that it needs, in the root
# of the sources and with objects in $folder. Defines build.
sources="engine/src/*/*.c engine/src/*/*/*.c scenarios/base/*.c scenarios/scene/*.c
         scenarios/catalogue/*.c compare/adapters/adapter_plumb.c tests/engine/determinism_driver.c"
includes="-Iengine/include -Iengine/src -Iscenarios/include -Iscenarios
          -Icompare -Icompare/include"
amd=
if [[ -e /usr/include/suitesparse/amd.h ]]; then
    includes="$includes -DPLUMB_HAVE_AMD"
    amd=-lamd
fi
# build COMPILER LEVEL MACHINE: the wide kernels have their own flags, as in engine/CMakeLists.txt. Where
# the machine makes no difference, the objects of an earlier build of that compiler and level are used.
build() {
    local file flags object objects=() commands=() wide=
    local made=$folder/${1}${2// /}
    [[ $3 == wide ]] && wide="-DPE_KERNELS_X86"
    mkdir -p "$made"
    for file in $sources; do
        flags=
        case $file in
        *kernels_4.c) flags=-mavx2 ;;
        *kernels_8.c) flags=-mavx512f ;;
        esac
        [[ -n $flags && -z $wide ]] && continue
        object=$made/$(tr / _ <<<"$file").o
        objects+=("$object")
        [[ -e $object ]] && ! grep -q PE_KERNELS_X86 "$file" && continue
        commands+=("$1 -std=c17 $2 -ffp-contract=off -D_GNU_SOURCE -DPLUMB_VERSION='\"test\"' -w \
            ${includes//$'\n'/ } $wide $flags $(pkg-config --cflags jansson) -c -o '$object' '$file'")
    done
    printf '%s\0' "${commands[@]}" | xargs -0 -P "$(nproc)" -I '{}' bash -c '{}'
    # shellcheck disable=SC2046
    $1 $2 -o "$folder/driver" "${objects[@]}" $(pkg-config --libs jansson) $amd -lqhull_r -lm -pthread
}
