#!/usr/bin/env bash
# Data goes one way. Two checks: which folder's headers a file includes, and, from the symbols that each
# object file takes from the others, that no files call each other in a ring.
set -eu
cd "$SOURCE"
failed=0

complain() {
    echo "$1" >&2
    failed=1
}

# allow FOLDER REGEX: quoted includes of FOLDER's files must match REGEX or be a file of the folder itself.
allow() {
    local folder=$1 allowed=$2 file included
    while IFS=: read -r file included; do
        [[ -e "$(dirname "$file")/$included" ]] && continue
        [[ $included =~ ^($allowed)$ ]] && continue
        complain "$file includes \"$included\", which $folder may not know"
    done < <(grep -rHoE '^#include "[^"]+"' "$folder" --include=*.c --include=*.h --include=*.cpp |
             sed -E 's/#include "([^"]+)"/\1/')
}

scene='plumb/(base|jitter|scene|scenario|vec)\.h'
abi='plumb/engine_abi\.h'
allow engine/include 'plumb/engine\.h'
allow engine/src 'plumb/(engine|contact_problem)\.h|((broad_phase|collide|contact|geometry|impact|soft|solve)/)?[a-z0-9_]+\.h'
allow scenarios "$scene|scene_[a-z_]+\.h|random\.h|number\.h|name_index\.h|complaint\.h|json_(field|text)\.h"
allow compare/referee "$scene|$abi|referee/.*"
allow compare/results "$scene|$abi|referee/metrics\.h|results/.*"
allow compare/report "$scene|referee/metrics\.h|results/.*|report/.*|sweep/analysis[a-z_]*\.h"
allow compare/sweep "$scene|$abi|random\.h|adapters/registry\.h|referee/metrics\.h|results/.*|runner/.*|sweep/.*"
allow compare/gate "$scene|json_(field|text)\.h|referee/metrics\.h|results/.*|report/sheet\.h|gate/.*"
allow compare/runner "$scene|$abi|(adapters/registry|adapters/[a-z_]*|referee/.*|results/.*|runner/.*)(\.h)?"
allow compare/threshold "$scene|$abi|(results/result|runner/.*|threshold/.*)(\.h)?"
allow compare/iterations "$scene|$abi|referee/metrics\.h|(runner/.*|iterations/.*)(\.h)?"
allow compare/tune "$scene|$abi|random\.h|adapters/registry\.h|referee/metrics\.h|results/.*|runner/.*|tune/.*"
allow compare/adapters "$scene|$abi|adapters/.*|plumb/(engine|contact_problem)\.h"
allow compare/solve "$scene|$abi|plumb/contact_problem\.h|json_(field|text)\.h|(adapters/registry|results/.*|runner/process|solve/.*)(\.h)?"
allow compare/ensemble "$scene|$abi|random\.h|referee/(metrics|solid)\.h|results/.*|runner/.*|ensemble/.*"
allow compare/metamorphic "$scene|$abi|referee/solid\.h|results/.*|runner/.*|metamorphic/.*"

# An engine's headers are known to its adapter alone. only PATTERN OWNER: a file, or a folder's files.
only() {
    local pattern=$1 owner=$2 file
    while read -r file; do
        [[ $file == "$owner" || $file == "$owner"/* ]] || complain "$file includes headers that only $owner may"
    done < <(grep -rlE "^#include [<\"]($pattern)" engine scenarios compare || true)
}
only 'ode/' compare/adapters/ode
only 'bt[A-Z]|Bullet' compare/adapters/bullet_c.cpp
only 'ccd/' compare/referee/gap_convex.c
only 'nlopt' compare/tune/model.c
only 'plumb/engine\.h' 'compare/adapters/adapter_plumb.c' 2>&1 |
    grep -v '^engine/' >"$BUILD/layers.txt" || true
if [[ -s $BUILD/layers.txt ]]; then
    complain "$(cat "$BUILD/layers.txt")"
fi

# Rings: an edge from each object to the object that defines what it takes; tsort finds cycles.
list=$BUILD/layers_symbols.txt
find "$BUILD/engine" "$BUILD/scenarios" "$BUILD/compare" -name '*.o' | sort | while read -r object; do
    nm -g "$object" | awk -v file="${object#"$BUILD"/}" '
        $1 == "U" { print "use", $2, file; next }
        NF == 3 && $2 ~ /[TDRB]/ { print "def", $3, file }'
done >"$list"
edges=$BUILD/layers_edges.txt
awk '$1 == "def" { owner[$2] = $3; next }
     { user[NR] = $3; symbol[NR] = $2 }
     END { for (i in user) if (symbol[i] in owner && owner[symbol[i]] != user[i])
               print user[i], owner[symbol[i]] }' "$list" | sort -u >"$edges"
if [[ $(wc -l <"$edges") -lt 40 ]]; then
    complain "only $(wc -l <"$edges") calls between files were seen: the check is blind"
fi
if ! ring=$(tsort "$edges" 2>&1 >/dev/null) || [[ -n $ring ]]; then
    complain "files that call each other in a ring:
$ring"
fi
exit $failed
