# Sourced by the tests of determinism. Defines build_driver and expect_golden; removes $folder at the end.
# shellcheck source=tests/support/needs_amd.sh
source "$SOURCE/tests/support/needs_amd.sh"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# build_driver NAME COMPILER FLAGS [OPTION...]: builds determinism_driver in $folder/NAME as a user does who
# has flags of his own, and prints its path.
build_driver() {
    local name=$1 compiler=$2 flags=$3
    shift 3
    cmake -S "$SOURCE" -B "$folder/$name" -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_C_COMPILER="$compiler" \
        -DCMAKE_C_FLAGS="$flags" -DPLUMB_ADAPTER_MODULES=OFF "$@" >"$folder/log" 2>&1 &&
        cmake --build "$folder/$name" --target determinism_driver >"$folder/log" 2>&1 || {
        cat "$folder/log" >&2
        return 1
    }
    echo "$folder/$name/determinism_driver"
}

# expect_golden WHAT COMMAND...: the command prints the golden hashes.
expect_golden() {
    local what=$1
    shift
    "$@" >"$folder/hashes" || {
        echo "$what: exit code $?" >&2
        return 1
    }
    diff "$SOURCE/tests/engine/golden_hashes.txt" "$folder/hashes" >&2 || {
        echo "$what: other bits (lines with >) than tests/engine/golden_hashes.txt" >&2
        return 1
    }
}
