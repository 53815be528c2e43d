#!/usr/bin/env bash
# No line of any command is wider than the window, and nothing is cut off.
set -eu
source "$SOURCE/tests/support/command.sh"

# widths NAME CODE ARGUMENT...: each line that the command prints fits 60 and 200 columns; what is printed
# at 60 is left in `out`.
widths() {
    local name=$1 code=$2 width actual
    shift 2
    for width in 200 60; do
        actual=0
        rm -rf made
        COLUMNS=$width "$PLUMB" "$@" >out 2>err </dev/null || actual=$?
        [[ $actual == "$code" ]] || note_failure "$name: exit code $actual, expected $code: $(cat err)"
        [[ -s out ]] || note_failure "$name: nothing was printed"
        python3 - "$width" <<'END' || note_failure "$name: lines are wider than $width columns"
import sys
wide = [line for line in open("out", encoding="utf-8").read().split("\n") if len(line) > int(sys.argv[1])]
print(*wide[:3], sep="\n", file=sys.stderr)
sys.exit(1 if wide else 0)
END
        [[ $(grep -c '…' out) == 0 ]] || note_failure "$name: text is cut off: $(grep '…' out)"
    done
}

engines=(--engine plumb --engine ode:quick,iterations=7,label=a-label-of-a-modest-length)
short=(--set n=2 --duration 0.1 "${engines[@]}")
"$PLUMB" doctor >/dev/null 2>&1 && widths doctor 0 doctor

widths compare 0 compare tower --repeat 2 --out made "${short[@]}"
[[ $(grep -c '^  engine' out) -ge 2 ]] || note_failure "compare: not several groups of columns: $(cat out)"
grep -q ' ± ' out || note_failure "compare: no spread of the times: $(cat out)"
grep -q '^Each number is the median of 2 repeats\.' out || note_failure "compare: ± is not explained: $(cat out)"
widths 'compare of wall' 0 compare wall-collapse slope-stick --out made --duration 0.1 "${engines[@]}"
grep -q ' ± ' out && note_failure "compare: a spread of one repeat: $(cat out)"

widths run 0 run tower --engine plumb --duration 0.1
widths 'list engines' 0 list engines
widths 'list scenarios' 0 list scenarios
widths 'list metrics' 0 list metrics
widths 'list suites' 0 list suites
widths sweep 0 sweep free-fall bounce --vary dt=1/60,1/120,1/240 --out made --duration 0.1 "${engines[@]}"
cp -r made swept
widths report 0 report swept --out made
widths threshold 0 threshold slope-threshold --out made --duration 0.1 "${engines[@]}"
widths ensemble 0 ensemble falling-cubes --members 6 --out made "${short[@]}"
grep -q '^engine\|^Engine' out || note_failure "ensemble: no table of engines: $(cat out)"
grep -qE '^(#|\|)' out && note_failure "ensemble: Markdown on a terminal: $(cat out)"
grep -q '^| Engine' made/ensemble.md || note_failure "ensemble: no Markdown in ensemble.md: $(cat made/ensemble.md)"
widths metamorphic 0 metamorphic free-fall --out made --duration 0.1 "${engines[@]}"
"$PLUMB" compare tower --out results "${short[@]}" >/dev/null 2>&1
widths gate 1 gate results --fail-if 'tower: penetration_max>=0' --fail-if 'tower: time_per_step>1e9'
widths 'check-engine --list' 0 check-engine --list
widths check-engine 0 check-engine ode:quick
for name in compare run threshold list scene ensemble sweep tune report metamorphic gate check-engine new-engine; do
    widths "help $name" 0 help "$name"
done
widths help 0 help
widths tune 0 tune free-fall --engine ode:quick --target 'reference_error<=1' --budget 2 --duration 0.1 --out made
exit $failed
