#!/usr/bin/env bash
# The engine gives the committed bits in 20 scenes and three profiles. Where a change is meant to alter
# results, renew them:
#
#     build/release/determinism_driver >tests/engine/golden_hashes.txt
set -euo pipefail
# shellcheck source=tests/support/golden_hashes.sh
source "$SOURCE/tests/support/golden_hashes.sh"
expect_golden "this build" "$BUILD/determinism_driver"
