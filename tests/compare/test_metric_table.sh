#!/usr/bin/env bash
# The table of metrics in compare/results/SCHEMA.md is the one in the program. Where it is not, the lines to write
# are those with a "<".
set -eu
command -v python3 >/dev/null || exit 77
"$PLUMB" list metrics --json | python3 -c '
import json, sys
print("| metric | unit | better | properties |\n|---|---|---|---|")
for m in json.load(sys.stdin):
    print("| `%s` | %s | %s | %s |" % (m["name"], m["unit"], m["direction"], ", ".join(m["properties"])))
' | diff - <(sed -n '/^| metric /,/^$/p' "$SOURCE/compare/results/SCHEMA.md" | grep .)
