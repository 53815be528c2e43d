#!/usr/bin/env bash
# The checks split, tessellate and late: engines with one fault each are caught, and the others agree.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

# A body slides at 2 m/s over a slab, without friction; the seam and the meshes' vertices are in its way.
cat >slide.json <<'END'
{ "plumb_scene": 1, "name": "slide", "duration": 1.5, "parameters": { "weight": 0 },
  "gravity": [0, 0, "-weight"],
  "materials": { "ice": { "friction": 0, "restitution": 0 } },
  "bodies": [
    { "name": "slab", "static": true, "material": "ice",
      "shape": { "type": "box", "half_extents": [8, 1, 0.5] }, "position": [0, 0, -0.5] },
    { "name": "ball", "mass": 1, "material": "ice",
      "shape": { "type": "sphere", "radius": 0.25 }, "position": [-2.1, 0.3, 0.25], "velocity": [2, 0, 0] } ] }
END

# verdicts ENGINE CHECK ARGUMENT...: one line for each check, with its verdict at the end of the run.
verdicts() {
    "$PLUMB" metamorphic slide.json --engine "$1" --check "$2" --json - --force "${@:3}" 2>err |
        python3 -c 'import json, sys
for check in json.load(sys.stdin)[0]["checks"]: print(check["check"], check["verdict"], check["reason"] or "")'
}

# all PATTERN ENGINE CHECK ARGUMENT...: every check of that family has a verdict like PATTERN.
all() {
    local found
    found=$(verdicts "${@:2}")
    [[ -n $found ]] && ! grep -qvE "^[a-z0-9.-]+ ($1)" <<<"$found" || note_failure "$2, $3: expected $1: $found"
}

# Faulty engines. The ball does not meet the slab without weight, so that the good one agrees.
seam=$BUILD/seam_engine.so
all 'bitwise' "$seam:good" split
all 'bitwise' "$seam:good" tessellate
all 'exact' "$seam:good" late --set weight=1e-9
all 'differs' "$seam:seam" split-x
all 'bitwise' "$seam:seam" split-y
all 'differs' "$seam:edge" tessellate-8
all 'bitwise' "$seam:edge" split
all 'differs' "$seam:grid" late --set weight=1e-9

# Where a check does not apply, it says why.
all 'inapplicable the motion over a fraction of a step is not known' "$seam:good" late
if "$PLUMB" run slide.json --engine mujoco:default >out 2>&1; then
    all 'inapplicable .* lacks mesh' mujoco:default tessellate --set weight=9.81
fi
"$PLUMB" metamorphic free-fall --check split --engine plumb --force 2>err | grep -q 'there is no static box' ||
    note_failure "a scene without static boxes was split"

# Engines: spheres pass seams and inner edges, and free flight and uniform motion know no phase of the step.
for engine in plumb plumb:accurate; do
    all 'bitwise|exact|close' "$engine" split --set weight=9.81
    all 'bitwise|exact' "$engine" tessellate --set weight=9.81
    all 'bitwise|exact' "$engine" late --set weight=9.81
done
"$PLUMB" metamorphic projectile --check late --json free.json --force >out 2>err
python3 - <<'END' || note_failure "free flight depends on the phase of the step"
import json
for trial in json.load(open("free.json")):
    if trial["outcome"] == "ok":
        for check in trial["checks"]:
            assert check["verdict"] in ("bitwise", "exact"), (trial["label"], check)
END
exit $failed
