#!/usr/bin/env bash
# The scene of compare/examples expects what its formulas give: an exact engine agrees to rounding, for any time step.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

scene=$SOURCE/compare/examples/scene/wedge.json
for dt in 1/60 1/250; do
    "$PLUMB" run "$scene" --engine plumb --dt "$dt" --json result.jsonl --force >/dev/null
    python3 - <<'END' || note_failure "dt $dt: $(cat result.jsonl)"
import json, math
with open("result.jsonl", encoding="utf-8") as file:
    result = json.load(file)
assert result["verdict"] == "accurate"
for name in "travel_error", "rest_position_error":
    assert result["metrics"][name]["value"] < 1e-9, name
distance = 5 / 14 * 9.81 * math.sin(math.atan2(5, 12))
ball = result["final_poses"][3]
assert abs(math.dist(ball[:3], (0.4076923076923077, 0.2, 0.9384615384615385)) - distance) < 1e-9
END
done

exit $failed
