#!/usr/bin/env bash
# Each mutation of mutations.json still fits the code: its line is there, and only once.
set -eu
command -v python3 >/dev/null || exit 77
exec python3 "$SOURCE/tests/mutation/mutate.py" check
