#!/usr/bin/env bash
# Data and messages keep their order where both go to one file, and every line is whole.
set -eu
source "$SOURCE/tests/support/command.sh"
scenes="free-fall projectile bounce slope-stick slope-slide slide-to-stop spin-stop torque-free"

# Numbers and spaces depend on times.
plain() {
    sed -E 's/[0-9.]+([eE][-+]?[0-9]+)?/N/g; s/ +/ /g; s/(N) [nµm]?s\b/\1 s/g' "$@"
}

# in_order LAST ARGUMENT...: `plumb ARGUMENT...` writes messages, data, and LAST as the last message, each in a line of
# its own.
in_order() {
    local last=$1 line
    shift
    "$PLUMB" "$@" >out 2>err || true
    [[ -s out && -s err ]] || note_failure "$*: no data or no messages"
    "$PLUMB" "$@" >both 2>&1 || true
    [[ $(tail -n 1 both) == "$last" ]] || note_failure "$*: expected \"$last\" last, found: $(tail -n 1 both)"
    plain both >lines
    while read -r line; do
        grep -qxF -e "$line" lines || note_failure "$*: no line \"$line\" in: $(cat both)"
    done < <(plain err)
}

in_order "16 results and the report are in report/" compare $scenes --engine plumb --engine ode --force
[[ $(wc -c <out) -gt 4096 ]] || note_failure "the tables fit one buffer: the test is blind"
in_order "6 results are in sweep/results.jsonl; plumb report sweep --out DIR makes a report" \
    sweep free-fall projectile --engine plumb --vary dt=1/60,1/120,1/240 --force
in_order "6 results of 1 file and the report are in merged/" report sweep --out merged --force

in_order "6 results are in metamorphic/results.jsonl; the page is metamorphic/metamorphic.html" \
    metamorphic free-fall projectile --engine plumb --check again --check rotate-z90 --force
exit $failed
