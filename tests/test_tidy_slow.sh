#!/usr/bin/env bash
# clang-tidy finds nothing in the engine, the scenarios and compare, by the checks of .clang-tidy.
set -eu
command -v clang-tidy >/dev/null || exit 77
cd "$SOURCE"
# Of a file that the build does not have, clang-tidy would guess how to compile it.
sed -n "s#^ *\"file\": \"$SOURCE/\(.*\.c\)\".*#\1#p" "$BUILD/compile_commands.json" | grep -E '^(engine|scenarios|compare)/' | sort -u |
    xargs -P "$(nproc)" -n 4 clang-tidy -p "$BUILD" --quiet 2>/dev/null | sed "s#$SOURCE/##" >"$BUILD/tidy.txt" || true
if grep -q 'error:' "$BUILD/tidy.txt"; then
    grep 'error:' "$BUILD/tidy.txt" | sort -u >&2
    exit 1
fi
# Without a compilation database clang-tidy would see nothing.
[[ -s $BUILD/compile_commands.json ]]
