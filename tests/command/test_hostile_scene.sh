#!/usr/bin/env bash
# Scenes from strangers: which files they may name, in every command that reads scenes, and what of them
# reaches the terminal.
set -eu
command=
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

body='"name": "b", "mass": 1'
scene_with() { # scene_with FILE: a scene whose mesh is in FILE
    printf '{ "plumb_scene": 1, "duration": 0.02, "bodies": [ { %s, "shape": { "type": "mesh", "file": "%s" } } ] }\n' "$body" "$1"
}
mkdir scenes meshes
cp "$SOURCE/tests/scenarios/obj/tetrahedron.obj" scenes/inside.obj
cp "$SOURCE/tests/scenarios/obj/tetrahedron.obj" meshes/outside.obj
echo "secret: words" >scenes/secret.obj
mkfifo scenes/fifo.obj
scene_with inside.obj >scenes/inside.json
scene_with ../meshes/outside.obj >scenes/outside.json
scene_with fifo.obj >scenes/fifo.json
scene_with secret.obj >scenes/secret.json

expect 0 '"vertices"' scene scenes/inside.json
if grep -q '"file"' out; then note_failure "a written scene names a file"; fi
expect 2 'outside.json:1:[0-9]*: bodies\[0\].shape.file: .*below the scene.s folder, found one elsewhere; --allow-files DIR' scene scenes/outside.json
expect 2 'found a FIFO' scene scenes/fifo.json
expect 2 'secret.obj:1: expected v, f or another word' scene scenes/secret.json
if grep -q 'words\|secret:' err; then note_failure "a refused file is shown: $(cat err)"; fi
expect 2 '--allow-files takes a folder' scene scenes/outside.json --allow-files nowhere
for name in compare run scene sweep threshold tune ensemble metamorphic report; do
    "$PLUMB" $name --help | grep -q -- --allow-files || note_failure "plumb $name has no --allow-files"
done
expect 0 '"vertices"' scene scenes/outside.json --allow-files meshes
expect 0 'ok, ' run scenes/outside.json --engine plumb --allow-files "$PWD/meshes"
# From a pipe the folder is the working directory.
cd scenes
expect 0 '"vertices"' scene - <inside.json
cd ..
expect 0 '"plumb_scene"' scene <(printf '\xef\xbb\xbf{ "plumb_scene": 1, "bodies": [ { %s, "shape": { "type": "sphere", "radius": 1 } } ] }' "$body")

# No control character of a name reaches the terminal, in messages and in tables.
bad=$'\e[2J\xc2\x9b1m\u202e\u2028\xff\n'
is_plain() { # is_plain WHAT: out and err have no such character but newlines
    if cat out err | LC_ALL=C grep -qP '[\x00-\x09\x0b-\x1f\x7f]|\xc2[\x80-\x9f]|\xe2\x80[\x8e\x8f\xa8-\xae]|\xff'; then
        note_failure "$1: $(cat -v out err)"
    fi
}
expect 2 'expected a scene file, found none' run "./$bad.json" --engine plumb
[[ $(wc -l <err) == 1 ]] || note_failure "a message has more than its line: $(cat -v err)"
is_plain "the name of a file that is not there"
scene_with 'a\u001b[2J\u009b\u202e\u2028.obj' >scenes/named.json
expect 2 'found none to read' scene scenes/named.json
is_plain "the name of a mesh's file"
expect 2 'there is no command' "$bad"
is_plain "the name of a command"
cp scenes/inside.json "scenes/$bad.json"
expect 0 'ok, ' run "scenes/$bad.json" --engine plumb
is_plain "the name of a scene file in a table"

# Every format of results holds the name as one value.
name=$'a,"b;\n=1+1<&>]]>|`*'$bad
"$PLUMB" scene scenes/inside.json >"$name.json"
expect 0 'the report are in o/' compare "./$name.json" --engine plumb --out o
is_plain "the name of a scene in the summary of compare"
if grep -q '^=1[+]1<' out err; then note_failure "a name goes over two lines: $(cat -v out err)"; fi
expect 0 '1 row written' gate o --baseline b.json --update-baseline
for format in junit json; do
    expect 1 'gate failed' gate o --baseline b.json --fail-if 'time_per_step<1e9' --format $format --out gate.$format
done
command -v python3 >/dev/null || exit $failed
python3 - <<'END' || note_failure "a format does not hold the name"
import csv, json
import xml.etree.ElementTree as xml

name = './a,"b;\n=1+1<&>]]>|`*'
for line in open("o/results.jsonl", encoding="utf-8"):
    assert json.loads(line)["scenario"].startswith(name)
for file in "o/results.csv", "o/runs.csv":
    with open(file, newline="", encoding="utf-8") as text:
        rows = list(csv.reader(text))
    assert len({len(row) for row in rows}) == 1 and all(row[1].startswith(name) for row in rows[1:]), file
cases = list(xml.parse("gate.junit").iter("testcase"))
assert len(cases) == 1 and cases[0].get("classname").startswith("plumb." + name.replace("\n", " ")), cases[0].attrib
assert json.load(open("gate.json", encoding="utf-8"))["failures"][0]["scenario"].startswith(name)
END
exit $failed
