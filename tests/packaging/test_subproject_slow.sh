#!/usr/bin/env bash
# Another project builds the engine, or all of Plumb, by add_subdirectory, and without Bullet no C++ compiler is
# asked for. The interface of the shared library is compatible with that of the last release, which engine/libplumb.abi
# describes; RENEW=yes writes it for the next one.
set -eu
source "$SOURCE/tests/support/command.sh"
source "$SOURCE/tests/support/steps.sh"
unset CC CXX

# ---- The engine ----

cp -r "$SOURCE/engine/examples" .
quietly cmake -S examples -B engine -G Ninja -DPLUMB_SOURCE="$SOURCE" -DCMAKE_BUILD_TYPE=None -DCMAKE_C_FLAGS=-g
quietly cmake --build engine
gives '^z = 0.500000000 m$' engine/drop
gives '^60 bodies: ' engine/heap 60

# Of types, only what the public headers declare is part of the interface.
describe_interface() {
    abidw --exported-interfaces-only --headers-dir "$SOURCE/engine/include" --drop-private-types --drop-undefined-syms \
        --no-corpus-path --no-show-locs --no-comp-dir-path "$1" | sed "s|path='$SOURCE/|path='|"
}
if command -v abidw >/dev/null; then
    describe_interface engine/plumb/libplumb.so >now.abi
    [[ -z ${RENEW:-} ]] || cp now.abi "$SOURCE/engine/libplumb.abi"
    abidiff --no-added-syms "$SOURCE/engine/libplumb.abi" now.abi ||
        note_failure "programs built against the last release would break: the soname must change"
fi

# ---- All of Plumb ----

# The modules that pkg-config finds here are those without which there is no Plumb.
mkdir modules outer
for module in jansson qhull_r ccd zlib nlopt libutf8proc; do
    cp "$(pkg-config --variable=pcfiledir "$module")/$module.pc" modules
done
cat >outer/CMakeLists.txt <<END_CMAKE
cmake_minimum_required(VERSION 3.25)
project(outer LANGUAGES C)
add_subdirectory($SOURCE plumb EXCLUDE_FROM_ALL)
add_library(my_engine MODULE $SOURCE/compare/template/engine.c $SOURCE/compare/template/sphere_world.c)
target_link_libraries(my_engine PRIVATE plumb::engine_abi m)
END_CMAKE
PKG_CONFIG_LIBDIR=$directory/modules quietly cmake -S outer -B all -G Ninja -DPLUMB_ADAPTER_MODULES=OFF -DNPM=OFF
! grep -q '^CMAKE_CXX_COMPILER' all/CMakeCache.txt || note_failure "a C++ compiler was asked for"
! grep -q 'CMAKE_BUILD_TYPE:[A-Z]*=Release' all/CMakeCache.txt || note_failure "the outer project's build type was set"
quietly cmake --build all
[[ -e all/libmy_engine.so ]] || note_failure "the adapter was not built"
exit $failed
