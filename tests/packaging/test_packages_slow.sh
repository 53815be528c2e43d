#!/usr/bin/env bash
# The Debian packages are the same bytes twice, lintian finds nothing, what they install works without the source,
# and the examples build against them outside the tree, by CMake and by make with pkg-config.
set -eu
[[ -f $BUILD/CPackConfig.cmake ]] && command -v dpkg-shlibdeps >/dev/null && command -v cpack >/dev/null || exit 77
source "$SOURCE/tests/support/command.sh"
source "$SOURCE/tests/support/steps.sh"

export SOURCE_DATE_EPOCH=1700000000
for folder in packages again; do
    quietly cpack --config "$BUILD/CPackConfig.cmake" -B "$directory/$folder"
done
for package in packages/*.deb; do
    cmp "$package" "again/${package#*/}" || note_failure "$package differs from another run of cpack"
    dpkg-deb -x "$package" root
done
if command -v lintian >/dev/null; then
    found=$(lintian --allow-root --fail-on none packages/*.deb 2>&1 | grep -v '^N:' || true)
    [[ -z $found ]] || note_failure "lintian: $found"
fi

# ---- The program ----

usr=$directory/root/usr
export PATH=$usr/bin:$PATH
gives 'plumb:default .* accurate' plumb compare tower --engine plumb --out report
[[ -s report/index.html ]] || note_failure "no report/index.html"
for engine in $(ls packages | sed -nE 's/^plumb-(.*)_.*_.*/\1/p'); do
    gives "^$engine  *[0-9]" plumb doctor
done
gives 'absent: .*/plumb/web/get-engines gets it|^jolt ' plumb list engines
[[ $(plumb --version) == "plumb $(sed -n 's/^#define PLUMB_VERSION "\(.*\)".*/\1/p' "$SOURCE/engine/include/plumb/version.h") "* ]] ||
    note_failure "$(plumb --version) is not the version of version.h"
! grep -qaF "$SOURCE" "$usr/bin/plumb" || note_failure "plumb contains the path of its source"

# ---- The library ----

library=$(find "$usr" -name 'libplumb.so.0')
nm -D --defined-only "$library" | awk '$2 == "T" { print $3 }' >exported
grep -ohE '\bpe_[a-z_0-9]+\(' "$usr"/include/plumb/engine.h "$usr"/include/plumb/contact_problem.h | tr -d '(' |
    sort -u | sed 's/$/@@PLUMB_0.2/' >declared
diff declared <(sort exported) || note_failure "libplumb.so exports other functions than its headers declare"

# ---- Examples ----

cp -r "$usr/share/doc/libplumb-dev/examples" .
export CMAKE_PREFIX_PATH=$usr PKG_CONFIG_PATH=${library%/*}/pkgconfig
quietly cmake -S examples/engine -B cmake
quietly cmake --build cmake
gives '^z = 0.500000000 m$' cmake/drop
gives '^60 bodies: ' cmake/heap 60
quietly make -C examples/engine
gives '^z = 0.500000000 m$' env LD_LIBRARY_PATH="${library%/*}" examples/engine/drop
quietly cmake -S examples/adapter -B adapter
quietly cmake --build adapter
gives 'my_engine:default: ok' plumb run bounce --engine adapter/my_engine.so
gives '/include' pkg-config --cflags plumb-engine-abi
exit $failed
