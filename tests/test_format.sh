#!/usr/bin/env bash
# Every source file is as clang-format 14 lays it out.
set -eu
cd "$SOURCE"
find engine scenarios compare tests -name '*.c' -o -name '*.h' -o -name '*.cpp' |
    xargs clang-format --dry-run --Werror
