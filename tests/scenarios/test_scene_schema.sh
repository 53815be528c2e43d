#!/usr/bin/env bash
# The JSON Schema of scenes is what the table of fields yields.
set -eu
if ! "$BUILD/scene_schema" | diff - "$SOURCE/scenarios/scene.schema.json"; then
    echo "scenarios/scene.schema.json: expected the output of $BUILD/scene_schema" >&2
    exit 1
fi
