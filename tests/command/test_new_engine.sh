#!/usr/bin/env bash
# plumb new-engine: what it writes builds outside of the tree without a warning, and is a right engine; what it
# cannot write, it leaves alone.
set -eu
command -v make >/dev/null || exit 77
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
command=new-engine

# ---- Where it cannot be written ----

expect 2 'expected one folder to make, found 0'
expect 2 'expected one folder to make, found 2' one two
expect 2 'takes up to 63 letters.*found "a b"' one --name 'a b'
expect 2 'takes up to 63 letters' one --name ''
expect 2 'takes up to 63 letters.*found "-x"' one --name=-x
expect 2 'expected the name of a new folder, found ".."' ..
mkdir full linked
touch full/kept file
ln -s linked link
expect 2 'full exists, and is not empty' full/
expect 2 'file exists, and is not a folder' file
expect 2 'link exists, and is not a folder' link
expect 2 'ode is the name of a built-in engine' ode
expect 3 'cannot make missing/engine: No such file' missing/engine
[[ $(ls full) == kept ]] || note_failure "a folder that was not empty was changed: $(ls full)"
# A disk that is full in the middle: no file may be longer than 8 blocks.
(
    trap '' XFSZ
    ulimit -f 8
    exec "$PLUMB" new-engine half
) >out 2>err && note_failure "it wrote beyond the limit"
grep -q 'half.*: File too large' err || note_failure "no reason was given: $(cat err)"
rm -rf full linked file link out err
[[ -z $(ls -A) ]] || note_failure "these were left behind: $(ls -A)"

# ---- What is written ----

mkdir 'its folder'
expect 0 "cd 'its folder' && make" 'its folder/' --name rolling
expect 0 'check-engine \./_my_engine_1\.so' './-my engine+1'
[[ -e './-my engine+1/Makefile' ]] || note_failure "the folder has another name: $(ls)"
expect 0 'cd new-one && make' new-one
for header in {compare,scenarios}/include/plumb/{engine_abi,adapter_helpers,scene_data,status}.h; do
    if [[ -e $SOURCE/$header ]]; then
        cmp "$SOURCE/$header" "new-one/include/plumb/${header##*/}" || note_failure "$header differs"
    fi
done
grep -q my_engine -r new-one && note_failure "the name is not everywhere: $(grep -n my_engine -r new-one)"

# make_with FOLDER ARGUMENT...: builds it without a warning, anew.
make_with() {
    local folder=$1
    shift
    make -B -C "$folder" CPPFLAGS='-Wall -Wextra -Wpedantic -Werror' "$@" >out 2>&1 ||
        note_failure "make $*: $(cat out)"
}
for compiler in gcc clang; do
    command -v $compiler >/dev/null || continue
    make_with new-one CC=$compiler
done
for compiler in g++ clang++; do
    command -v $compiler >/dev/null || continue
    $compiler -x c++ -std=c++20 -Wall -Wextra -Wpedantic -Werror -I new-one/include -fPIC -shared \
        -o $compiler.so new-one/{engine,sphere_world}.c 2>out || note_failure "$compiler: $(cat out)"
done
# The toy is a library like any other.
grep -niE 'plumb/|pl_' new-one/sphere_world.* && note_failure 'sphere_world knows of plumb'
make_with 'its folder' PLUMB_INCLUDE="$SOURCE/compare/include $SOURCE/scenarios/include"

# ---- The engine ----

command=
expect 0 'rolling:default' list engines './its folder/rolling.so'
expect 0 'conformance passed' check-engine new-one/new-one.so
expect 0 'conformance passed' check-engine ./g++.so
expect 0 'iterations_max +1 ' run bowling --engine new-one/new-one.so,iterations=1
expect 3 'new-one lacks box' run tower --engine new-one/new-one.so
"$PLUMB" scene roll-slope >equal.json
python3 - <<'END'
import json
scene = json.load(open("equal.json"))
scene["bodies"][-1]["inertia"] = [0.3, 0.4, 0.5]
json.dump(scene, open("unequal.json", "w"))
END
expect 0 '' run equal.json --engine new-one/new-one.so
expect 3 'only planes, and spheres with equal moments of inertia' run unequal.json --engine new-one/new-one.so
scenarios=(roll-slope bowling free-fall projectile oblique-impact collision-train cradle sphere-pyramid bounce)
"$PLUMB" compare "${scenarios[@]}" --engine new-one/new-one.so --engine plumb --out results >out 2>&1 ||
    note_failure "compare: $(cat out)"
# It is exact but for what a first-order integrator cannot be, conserves energy and momentum, and reports the
# impulses that moved the bodies.
expect 0 '' gate results --fail-if 'discrete_error>1e-9' --fail-if 'reference_error>0.03' \
    --fail-if 'energy_gain>1e-9' --fail-if 'momentum_error>1e-6' --fail-if 'cone_violation>1e-8' \
    --fail-if 'force_balance>1e-10'
for scenario in "${scenarios[@]}"; do
    grep -qE "\"outcome\": ?\"ok\".*\"scenario\": ?\"$scenario\"" <(grep new-one results/results.jsonl) ||
        note_failure "$scenario is not ok"
done
exit $failed
