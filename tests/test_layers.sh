#!/usr/bin/env bash
# Every folder uses only what stands below it. The table has one line a folder: what the folder may use
# besides itself. Includes are checked in the sources, calls by the symbols of the object files (nm).
set -eu
cd "$SOURCE"
failed=0

fail() {
    echo "$1" >&2
    failed=1
}

# FOLDER: FOLDERS. A line may use a name that stands left of an earlier line's colon, or a group below.
table='
engine/include:
engine/src/base:             engine/include
engine/src/model:            engine/include base
engine/src/broad_phase:      engine/include base model
engine/src/narrow_phase:     engine/include base model
engine/src/contact:          engine/include base model broad_phase narrow_phase
engine/src/problem:          engine/include base model
engine/src/sparse:           engine/include base problem
engine/src/solver:           engine/include base model problem sparse
engine/src/step:             engine/include base model broad_phase contact problem sparse solver
scenarios/include:
scenarios/base:              scenarios/include
scenarios/scene:             scenarios/include scenarios/base
scenarios/catalogue:         scenarios/include scenarios/base scenarios/scene
compare/include:             scenarios/include
compare/adapters:            SCENE compare/include engine/include
compare/referee/geometry:    SCENE compare/include
compare/referee/metrics:     SCENE compare/include geometry
compare/referee:             SCENE compare/include geometry metrics
compare/results:             SCENE compare/include metrics
compare/runner:              SCENE compare/include adapters geometry metrics referee results
compare/studies/sweep:       SCENE compare/include adapters metrics results runner
compare/studies/tune:        SCENE compare/include adapters metrics results runner
compare/studies/threshold:   SCENE compare/include results runner
compare/studies/ensemble:    SCENE compare/include geometry metrics results runner
compare/studies/metamorphic: SCENE compare/include geometry results runner
compare/studies/iterations:  SCENE compare/include adapters metrics results runner
compare/studies/solve:       SCENE compare/include engine/include adapters results runner
compare/gate:                SCENE compare/include metrics results
compare/report:              SCENE compare/include metrics results sweep
compare/command:             SCENE compare/include engine/include adapters metrics results runner STUDIES gate report
compare:                     command
'
group() {
    case $1 in
    SCENE) echo scenarios/include scenarios/base ;;
    STUDIES) echo sweep tune threshold ensemble metamorphic iterations solve ;;
    *) echo "$1" ;;
    esac
}

# folders[NAME] and allowed[FOLDER], from the table; a short name is a folder's last part.
declare -A folder_of=() allowed=()
while IFS=: read -r folder uses; do
    [[ -z $folder ]] && continue
    folder_of[$folder]=$folder
    [[ -v folder_of[${folder##*/}] ]] || folder_of[${folder##*/}]=$folder
    allowed[$folder]=" $folder "
    for name in $uses; do
        for member in $(group "$name"); do
            [[ $folder == engine/* && $member == base ]] && member=engine/src/base
            [[ -v folder_of[$member] ]] || { fail "the table's line of $folder: $member is not above it"; continue; }
            allowed[$folder]+="${folder_of[$member]} "
        done
    done
done <<<"$table"

# layer PATH: the table's folder that a file belongs to, the longest that fits.
layer() {
    local path=${1%/*}
    until [[ -v allowed[$path] ]]; do
        [[ $path == */* ]] || { echo ""; return; }
        path=${path%/*}
    done
    echo "$path"
}

# Headers by base name, which is unique.
declare -A header=()
while read -r file; do
    [[ -v header[${file##*/}] ]] && fail "${file##*/} stands in ${header[${file##*/}]} and in $file"
    header[${file##*/}]=$file
done < <(find engine scenarios compare -name '*.h')

includes=0
while IFS=: read -r file included; do
    own=$(layer "$file")
    [[ -z $own ]] && { fail "$file: its folder has no line in the table of layers"; continue; }
    target=${header[${included##*/}]-}
    [[ -z $target ]] && { fail "$file includes \"$included\", which no folder has"; continue; }
    used=$(layer "$target")
    includes=$((includes + 1))
    [[ ${allowed[$own]} == *" $used "* ]] ||
        fail "$file includes \"$included\": $own may not use $used (it may use${allowed[$own]% })"
done < <(grep -rHoE '^# *include "[^"]+"' engine scenarios compare --include=*.c --include=*.h --include=*.cpp |
         sed -E 's/# *include "([^"]+)"/\1/')
[[ $includes -ge 500 ]] || fail "only $includes includes were seen: the check is blind"

# only PATTERN OWNER: headers of other libraries that one file or folder alone may include.
only() {
    local pattern=$1 owner=$2 file
    while read -r file; do
        [[ $file == "$owner" || $file == "$owner"/* ]] || fail "$file includes headers that only $owner may"
    done < <(grep -rlE "^#include [<\"]($pattern)" engine scenarios compare || true)
}
only 'ode/' compare/adapters/ode
only 'bt[A-Z]|Bullet' compare/adapters/bullet_c.cpp
only 'ccd/' compare/referee/geometry/gap_convex.c
only 'nlopt' compare/studies/tune/model.c
only 'argp' compare/command

# Calls: from each object to the object that defines what it takes. They obey the table, and no files call
# each other in a ring (tsort finds rings).
list=$BUILD/layers_symbols.txt
find "$BUILD/engine" "$BUILD/scenarios" "$BUILD/compare" -name '*.o' | sort | while read -r object; do
    path=${object#"$BUILD"/}
    path=$(sed -E 's#CMakeFiles/[^/]+\.dir/##; s#\.o$##' <<<"$path")
    [[ -e $SOURCE/$path ]] || continue # the object of a file that is gone
    nm -g "$object" | awk -v file="$path" '
        $1 == "U" { print "use", $2, file; next }
        NF == 3 && $2 ~ /[TDRB]/ { print "def", $3, file }'
done >"$list"
edges=$BUILD/layers_edges.txt
awk '$1 == "def" { owner[$2] = $3; next }
     { user[NR] = $3; symbol[NR] = $2 }
     END { for (i in user) if (symbol[i] in owner && owner[symbol[i]] != user[i])
               print user[i], owner[symbol[i]], symbol[i] }' "$list" | sort -u >"$edges"
[[ $(wc -l <"$edges") -ge 500 ]] || fail "only $(wc -l <"$edges") calls were seen: the check is blind"
while read -r user owner symbol; do
    own=$(layer "$user")
    used=$(layer "$owner")
    # A public function is used through its header, wherever it is defined.
    case $used in
    engine/src/*) [[ $own == engine/src/* ]] || used=engine/include ;;
    scenarios/scene | scenarios/catalogue) [[ $own == scenarios/* ]] || used=scenarios/include ;;
    esac
    [[ ${allowed[$own]} == *" $used "* ]] || fail "$user calls $symbol of $owner: $own may not use $used"
done <"$edges"
if ! ring=$(cut -d' ' -f1,2 "$edges" | sort -u | tsort 2>&1 >/dev/null) || [[ -n $ring ]]; then
    fail "files that call each other in a ring:
$ring"
fi
exit $failed
