#!/usr/bin/env bash
# The JSON Schema of scenes and the table of fields in scenarios/README.md are what the field table yields.
set -eu
if ! "$BUILD/scene_schema" | diff - "$SOURCE/scenarios/scene.schema.json"; then
    echo "expected scenarios/scene.schema.json to be the output of $BUILD/scene_schema" >&2
    exit 1
fi
if ! "$BUILD/scene_schema" markdown | diff - <(grep -A1000 '^| object | key' "$SOURCE/scenarios/README.md" | sed '/^$/,$d'); then
    echo "expected the table in scenarios/README.md to be the output of $BUILD/scene_schema markdown" >&2
    exit 1
fi
