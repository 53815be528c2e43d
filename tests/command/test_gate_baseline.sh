#!/usr/bin/env bash
# Our own engine against its own baseline, tests/baseline/plumb.json: numbers, not times. Where a number
# is meant to have moved, tests/baseline/update renews it.
set -eu
# shellcheck source=tests/support/needs_amd.sh
source "$SOURCE/tests/support/needs_amd.sh"
# shellcheck source=tests/baseline/runs.sh
source "$SOURCE/tests/baseline/runs.sh"
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT

baseline_runs "$PLUMB" "$directory" || { cat "$directory/log" >&2; exit 1; }
baseline_gate "$PLUMB" "$directory" "$SOURCE/tests/baseline/plumb.json" \
    --fail-if '*/plumb: outcome!=ok' --fail-if 'tower/plumb:accurate: rest_position_error>1e-9'
