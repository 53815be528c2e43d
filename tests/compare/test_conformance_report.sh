#!/usr/bin/env bash
# An engine whose friction is 1 % low: no page of a report calls its adapter right, before and after
# check-engine. One without fault is called not verified, and then verified.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
export PLUMB_CACHE=$directory/cache

# report FOLDER ENGINE: compares the engine where its friction shows.
report() {
    rm -rf "$1"
    "$PLUMB" compare slide-to-stop --engine "$2" --duration 0.3 --out "$1" >"$1.out" 2>&1 ||
        note_failure "compare: $(cat "$1.out")"
    find "$1" -type f -exec cat {} + >"$1.text"
    cat "$1.out" >>"$1.text"
}

# says FOLDER PATTERN, and lacks FOLDER PATTERN: of the pages and the terminal.
says() {
    grep -qE -- "$2" "$1.text" || note_failure "no \"$2\" in the report $1"
}
lacks() {
    if grep -E -- "$2" "$1.text"; then note_failure "\"$2\" in the report $1"; fi
}

low=$BUILD/broken_setup.so:friction_low
good=$BUILD/broken_setup.so:good
report low_unknown "$low"
report good_unknown "$good"
for folder in low_unknown good_unknown; do
    says $folder 'not verified'
    lacks $folder 'not the adapter|conformance passed'
done
"$PLUMB" check-engine "$low" "$good" >checks && note_failure "check-engine passes: $(cat checks)"
report low_known "$low"
says low_known 'conformance FAILED'
lacks low_known 'not the adapter|conformance passed|not verified'
report good_known "$good"
says good_known 'conformance passed'
lacks good_known 'conformance FAILED|not verified'
exit $failed
