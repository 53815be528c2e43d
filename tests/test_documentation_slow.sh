#!/usr/bin/env bash
# Every command that a page of the documentation prints runs as printed; commands that take minutes are reduced.
set -eu
cd "$SOURCE"
command -v python3 >/dev/null || exit 77
mapfile -t pages < <(find . -path ./build -prune -o -path './.*' -prune -o -name '*.md' -printf '%P\n' | grep -v CHANGELOG | sort)
python3 tests/support/run_documentation.py "$PLUMB" "$SOURCE" "$BUILD" "${pages[@]}"
