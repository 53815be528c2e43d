#!/usr/bin/env bash
# A study concludes from its results alone: plumb report says the same, and of an edited scene the new edition counts.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

# scene HEIGHT: two balls, one above the other, that fall from there onto a floor.
scene() {
    cat >scene.json <<END2
{ "plumb_scene": 1, "name": "balls", "dt": 0.0125, "duration": 0.5, "gravity": [0, 0, -9.81],
  "materials": { "wood": { "friction": 0.5, "restitution": 0.25 } },
  "bodies": [
    { "name": "floor", "static": true, "material": "wood",
      "shape": { "type": "plane", "normal": [0, 0, 1], "offset": 0 } },
    { "name": "low", "mass": 1, "material": "wood", "shape": { "type": "sphere", "radius": 0.25 },
      "position": [0.01, 0, $1] },
    { "name": "high", "mass": 1, "material": "wood", "shape": { "type": "sphere", "radius": 0.25 },
      "position": [0, 0.01, $(python3 -c "print($1 + 0.75)")] } ] }
END2
}

# same FOLDER NAME: plumb report concludes from FOLDER what the study NAME did.
same() {
    "$PLUMB" report "$1" --out "$1.report" >report.txt 2>&1 || note_failure "report $1: $(cat report.txt)"
    for suffix in json md html; do
        cmp "$1/$2.$suffix" "$1.report/$2.$suffix" || note_failure "plumb report of $1 makes another $2.$suffix"
    done
}

# study NAME ARGUMENT...: its conclusion is the same from one job and from two, and from results alone; one more call
# makes nothing; and after an edit it is that of the new scene alone.
study() {
    local name=$1
    shift
    scene 0.5
    expect 0 'the page is' "$name" scene.json "$@" --jobs 1 --out "$name-one"
    expect 0 'the page is' "$name" scene.json "$@" --jobs 2 --out "$name"
    cmp "$name-one/$name.json" "$name/$name.json" || note_failure "$name: two jobs find something else"
    same "$name" "$name"
    cp "$name/results.jsonl" before.jsonl
    cp "$name/$name.json" before.json
    expect 0 'the page is' "$name" scene.json "$@" --out "$name" --resume
    ! grep '^\[' err && cmp "$name/results.jsonl" before.jsonl || note_failure "$name: a finished study makes runs"
    cmp "$name/$name.json" before.json || note_failure "$name: a finished study concludes otherwise"
    scene 0.75
    expect 0 'the page is' "$name" scene.json "$@" --out "$name" --resume
    expect 0 'the page is' "$name" scene.json "$@" --out "$name-new"
    cmp "$name/$name.json" "$name-new/$name.json" || note_failure "$name: the old scene counts after an edit"
    same "$name" "$name"
}

faulty=$BUILD/faulty_engine.so
study metamorphic --engine plumb --engine "$faulty:good" --engine "$faulty:abort"
study ensemble --members 7 --engine plumb --engine "$faulty:good" --engine "$faulty:abort" --against itself

# Where no trajectory is left, the horizon is that of the conclusion before.
grep -q 'horizon.*not passed' before.json || grep -q '"last_spread"' before.json || note_failure "no horizon is known: $(cat before.json)"

# Checks that are added need the frames of the plain run, which is made again and has one result.
scene 0.5
expect 0 'the page is' metamorphic scene.json --engine plumb --check again --check mirror --out added
expect 0 'the page is' metamorphic scene.json --engine plumb --check restart --out added --resume
expect 0 'the page is' metamorphic scene.json --engine plumb --check again --check mirror --check restart --out whole
cmp added/metamorphic.json whole/metamorphic.json || note_failure "checks that are added find something else"
[[ $(wc -l <added/results.jsonl) == 4 ]] || note_failure "a plain run has two results: $(cut -c 1-200 added/results.jsonl)"

# The JSON of a study alone has a page, too.
"$PLUMB" report whole/metamorphic.json --out page >out 2>&1
cmp page/metamorphic.html whole/metamorphic.html || note_failure "the JSON has another page: $(cat out)"
exit $failed
