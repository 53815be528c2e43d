#!/usr/bin/env bash
# Every folder uses only what stands below it. The table has one line a folder: what the folder may use
# besides itself. Includes are checked in the sources, calls by the symbols of the object files (nm).
set -eu
shopt -s extglob
cd "$SOURCE"
failed=0

fail() {
    echo "$1" >&2
    failed=1
}

# FOLDER: what it may use, which are folders of earlier lines (by their last part where that is clear) or a
# group. Some headers have lines of their own: scenarios/base and the engine ABI may use no others.
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
engine/tools:                engine/include
scenarios/include/plumb/status.h:
scenarios/include/plumb/base.h: status.h
scenarios/include/plumb/scene_data.h: status.h
scenarios/include/plumb/vec.h: base.h
scenarios/base:              status.h base.h vec.h
scenarios/include:           status.h base.h vec.h scene_data.h
scenarios/solids:            SCENE
scenarios/scene:             SCENE solids
scenarios/catalogue:         SCENE scenarios/scene
scenarios:                   SCENE scenarios/scene
compare/base:                status.h base.h scenarios/base
compare/include:             status.h scene_data.h
compare/template:            status.h scene_data.h compare/include
compare/adapters:            SCENE compare/include engine/include
compare/engines:             HARNESS adapters
compare/referee/geometry:    HARNESS
compare/referee/metrics:     HARNESS geometry
compare/referee:             HARNESS geometry metrics
compare/results:             HARNESS engines metrics
compare/runner:              HARNESS adapters engines geometry metrics referee results
compare/conformance:         HARNESS adapters engines geometry results runner
compare/studies:             HARNESS adapters engines metrics results runner
compare/studies/sweep:       HARNESS adapters engines metrics results runner compare/studies
compare/studies/tune:        HARNESS adapters engines metrics results runner compare/studies
compare/studies/threshold:   HARNESS engines results runner compare/studies
compare/studies/ensemble:    HARNESS engines geometry metrics results runner compare/studies
compare/studies/reference:   HARNESS adapters engines metrics results runner ensemble
compare/studies/metamorphic: HARNESS engines geometry results runner compare/studies
compare/studies/iterations:  HARNESS adapters engines metrics results runner compare/studies
compare/gate:                HARNESS metrics results
compare/report:              HARNESS metrics results
compare/command:             HARNESS engine/include adapters engines metrics results runner STUDIES conformance gate report
compare:                     command compare/base
'
group() {
    case $1 in
    SCENE) echo status.h base.h vec.h scene_data.h scenarios/include scenarios/base ;;
    HARNESS) echo $(group SCENE) compare/base compare/include ;;
    STUDIES) echo compare/studies sweep tune threshold ensemble reference metamorphic iterations ;;
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

# layer PATH: sets REPLY to the table's folder that a file belongs to, the longest that fits.
layer() {
    REPLY=$1
    until [[ -v allowed[$REPLY] ]]; do
        [[ $REPLY == */* ]] || { REPLY=; return; }
        REPLY=${REPLY%/*}
    done
}

# Headers by base name, which is unique.
declare -A header=()
while read -r file; do
    [[ -v header[${file##*/}] ]] && fail "${file##*/} stands in ${header[${file##*/}]} and in $file"
    header[${file##*/}]=$file
done < <(find engine scenarios compare -name '*.h' -o -name '*.def')

includes=0
while IFS=: read -r file included; do
    layer "$file" && own=$REPLY
    [[ -z $own ]] && { fail "$file: its folder has no line in the table of layers"; continue; }
    target=${header[${included##*/}]-}
    [[ -z $target ]] && { fail "$file includes \"$included\", which no folder has"; continue; }
    layer "$target" && used=$REPLY
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
while IFS=: read -r file pattern; do
    only "$pattern" "${file%/engine.json}"
done < <(grep -HoP '^ "headers": "\K[^"]+' compare/adapters/*/engine.json)
only 'ccd/' compare/referee/geometry/gap_convex.c
only 'nlopt' compare/studies/tune/tune_search.c
only 'utf8proc' compare/base/folding.c
only 'argp' compare/command

# These build files list their sources: a file that none of them names would never be compiled.
mapfile -t built < <(find engine scenarios -name CMakeLists.txt)
while read -r file; do
    grep -qF -e "${file#*/}" -e "/${file##*/}" -e " ${file##*/}" "${built[@]}" ||
        fail "$file is in no CMakeLists.txt"
done < <(find engine scenarios -name '*.c')

# Calls: from each object to the object that defines what it takes. They obey the table, and no files call
# each other in a ring (tsort finds rings).
edges=$BUILD/layers_edges.txt
while read -r object; do
    source=${object#"$BUILD"/}
    source=${source/CMakeFiles\/*([^\/]).dir\//}
    [[ -e ${source%.o} ]] && echo "$object" # not the object of a file that is gone
done < <(find "$BUILD/engine" "$BUILD/scenarios" "$BUILD/compare" -name '*.o' | sort) |
    xargs nm -gA | sed -E "s#^$BUILD/##; s#CMakeFiles/[^/]+\.dir/##; s#\.o:# #" |
    awk '$2 == "U" { user[NR] = $1; symbol[NR] = $3; next }
         NF == 4 && $3 ~ /[TDRB]/ { owner[$4] = $1 }
         END { for (i in user) if (symbol[i] in owner && owner[symbol[i]] != user[i])
                   print user[i], owner[symbol[i]], symbol[i] }' | sort -u >"$edges"
[[ $(wc -l <"$edges") -ge 500 ]] || fail "only $(wc -l <"$edges") calls were seen: the check is blind"
while read -r user owner symbol; do
    layer "$user" && own=$REPLY
    layer "$owner" && used=$REPLY
    # A public function is used through its header, wherever it is defined.
    case $used in
    engine/src/*) [[ $own == engine/src/* ]] || used=engine/include ;;
    scenarios/solids | scenarios/scene | scenarios/catalogue) [[ $own == scenarios/* ]] || used=scenarios/include ;;
    esac
    [[ ${allowed[$own]} == *" $used "* ]] || fail "$user calls $symbol of $owner: $own may not use $used"
done <"$edges"
if ! ring=$(cut -d' ' -f1,2 "$edges" | sort -u | tsort 2>&1 >/dev/null) || [[ -n $ring ]]; then
    fail "files that call each other in a ring:
$ring"
fi
exit $failed
