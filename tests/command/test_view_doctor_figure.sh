#!/usr/bin/env bash
# plumb view and --open call the browser, plumb doctor describes engines, machine and tools, and plumb report --figure takes the
# picture that Chromium draws; programs of the test stand for both.
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

cat >browser <<'END'
#!/bin/sh
echo "$1" >>opened
[ ! -e browser-fails ]
END
# Draws nothing: the document has a picture, and the picture's own file is the option that asked for it.
cat >chromium <<'END'
#!/bin/sh
for option; do
    case $option in
    --screenshot=*|--print-to-pdf=*) echo "${option%%=*}" >"${option#*=}" ;;
    --window-size=*) echo "$option" >>windows ;;
    file://*) echo "$option" >>urls ;;
    esac
done
[ ! -e chromium-fails ] || exit 1
echo '<html><main class="a"><svg id="figure" data-figure="321x123"><path d="M0 0"/></svg></main></html>'
END
chmod +x browser chromium
export BROWSER=$PWD/browser CHROMIUM=$PWD/chromium

short=(free-fall --duration 0.05 --engine plumb)
expect 0 'results|result' compare "${short[@]}" --out a --open
[[ $(cat opened) == a/index.html ]] || note_failure "compare --open: $(cat opened)"
expect 0 '^a/index.html$' view a
expect 0 '^a/index.html$' view a/index.html
[[ $(wc -l <opened) == 3 ]] || note_failure "view: $(cat opened)"
expect 2 'results.jsonl has no page; plumb report .* makes one' view a/results.jsonl
expect 2 'one page at a time' view a b
expect 2 'report has no page' view
touch browser-fails
expect 3 'a/index.html was not opened: .*set BROWSER' view a
rm browser-fails
BROWSER=none expect 3 'was not opened: "none" failed' view a

PLUMB_CACHE=$PWD/cache "$PLUMB" doctor >out 2>err || [[ $? == 3 ]] || note_failure "doctor: $(cat err)"
grep -qE '^plumb +[0-9.]+ +native +not verified: plumb check-engine plumb' out || note_failure "doctor: $(cat out)"
source "$SOURCE/compare/packages.sh"
for engine in $(engines linked module script); do
    grep -qE "^$engine +([0-9.]+ +native|[0-9.]+ +[a-z]+|absent|fault)" out || note_failure "doctor: $engine: $(cat out)"
done
[[ $(head -n 1 out) == P$("$PLUMB" --version | tail -c +2) ]] || note_failure "doctor: no version: $(cat out)"
[[ $(grep -cE '^(processor|CPUs|kernels|frequency|clock of steps|noise|load|memory|chromium|xdg-open|node|npm|parallel) ' out) == 13 ]] ||
    note_failure "doctor: something of the machine or the tools is missing: $(cat out)"
COLUMNS=80 LC_ALL=C.UTF-8 "$PLUMB" doctor | LC_ALL=C.UTF-8 grep -E '^.{81}' >wide || true
[[ ! -s wide ]] || note_failure "doctor: lines are wider than 80 columns: $(cat wide)"

# plumb doctor --json agrees with what the system says; one CPU, a limit, and no tools but one.
mkdir empty
cpu=$(taskset -pc $$ | sed -E 's/.*: ([0-9]+).*/\1/')
limit=4000000 # KiB; a sanitizer allows none
grep -qE '__(asan|msan|tsan)_init' "$PLUMB" && limit=unlimited
(
    ulimit -S -d $limit
    PLUMB_CACHE=$PWD/cache taskset -c "$cpu" env PATH="$PWD/empty" "$PLUMB" doctor --json >machine.json
) || [[ $? == 3 ]] || note_failure 'doctor --json fails'
python3 - $limit <<'END' || note_failure "doctor --json: $(cat machine.json)"
import json
import sys
found = json.load(open("machine.json"))
machine, timer = found["machine"], found["machine"]["timer"]
flags = [line.split() for line in open("/proc/cpuinfo") if line.startswith("flags")]
features = [name for name in ("avx2", "avx512f") if flags and name in flags[0]]
assert machine["features"] == features, features
assert machine["kernel_lanes"] == (8 if "avx512f" in features else 4 if "avx2" in features else 1)
assert found["host"]["cpus"] == 1
assert sys.argv[1] == "unlimited" or machine["memory"]["limit"] <= 1024 * int(sys.argv[1])
assert machine["memory"]["available"] <= machine["memory"]["total"]
assert timer["repeats"] >= 1 and timer["spread"] >= 0 and timer["slow"] >= 1 and timer["step"] > timer["empty"]
assert {tool["name"] for tool in found["tools"] if tool["present"]} == {"chromium", "xdg-open"}
assert found["engines"][0]["name"] == "plumb" and found["engines"][0]["version"]
assert all("version" in e or "fault" in e for e in found["engines"] if e["present"])
assert all(e["get"] for e in found["engines"] if not e["present"])
END

figure() { expect "$1" "$2" report a --figure "${@:3}"; }
figure 0 'the picture is in b/free-fall.svg' free-fall --out b
[[ $(cat b/free-fall.svg) == '<svg id="figure" data-figure="321x123"><path d="M0 0"/></svg>' ]] ||
    note_failure "an svg: $(cat b/free-fall.svg)"
grep -q 'index.html#figure=0;format=svg$' urls || note_failure "the page is not asked for a figure: $(cat urls)"
figure 0 'b/free-fall-t-0.02.png' free-fall:t=0.02 --format png --out b
[[ $(cat b/free-fall-t-0.02.png) == --screenshot ]] || note_failure "a png: $(cat b/free-fall-t-0.02.png)"
grep -q 'format=png;t=0.02' urls || note_failure "the time is not asked for: $(cat urls)"
grep -q -- '--window-size=321,123' windows || note_failure "the window has not the picture's size: $(cat windows)"
figure 0 'b/free-fall.pdf' free-fall --format pdf --out b
[[ $(cat b/free-fall.pdf) == --print-to-pdf ]] || note_failure "a pdf: $(cat b/free-fall.pdf)"
figure 2 'b/free-fall.pdf exists; --force replaces it' free-fall --format pdf --out b
figure 2 'the results have no scenario "bounce"' bounce --out b
figure 2 'expected a time in seconds, found "soon"' free-fall:t=soon --out b
figure 2 'makes svg, png or pdf' free-fall --format csv --out b
expect 2 'are for --figure' report a --format pdf --out b
touch chromium-fails
figure 3 'failed to draw the page' free-fall --out c
rm chromium-fails
printf '#!/bin/sh\necho nothing\n' >chromium
figure 2 'nothing could be drawn' free-fall --out c
figure 2 'nothing could be drawn' free-fall --format png --out c
CHROMIUM=$PWD/none figure 3 'none' free-fall --out c
[[ -z $(ls c 2>/dev/null) ]] || note_failure "a picture that could not be drawn: $(ls c)"
exit $failed
