#!/usr/bin/env bash
# Our engine has the critical value of every scenario with a closed form, at 1/60 and 1/240 s: to
# 1e-4 of it, or 1e-3 where many bodies hold each other; and it holds what is hard.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

# expect TOLERANCE ARGUMENT...: what is found is the closed form to that, relative.
expect() {
    local tolerance=$1 dt
    shift
    for dt in 1/60 1/240; do
        "$PLUMB" threshold "$@" --engine plumb:accurate --dt "$dt" --json row.json --force >out 2>&1 ||
            note_failure "threshold $* --dt $dt: $(tail -1 out)"
        python3 - "$tolerance" <<'END' || note_failure "threshold $* --dt $dt: $(cat row.json)"
import json, sys
row, = json.load(open("row.json"))
sys.exit(not (row["finding"] == "found" and abs(row["relative_error"]) <= float(sys.argv[1])))
END
    done
}

expect 1e-4 slope-threshold
expect 1e-4 slope-threshold --set friction=1.5
expect 1e-4 slope-tip
expect 1e-4 slope-tip --set friction=0.3
expect 1e-4 ladder
expect 1e-4 ladder --set friction=1.5
expect 1e-3 overhang
expect 1e-3 cylinder-pyramid
expect 1e-3 cylinder-pyramid --set floor_friction=0.1
expect 1e-3 sphere-pyramid
expect 1e-3 sphere-pyramid --set floor_friction=0.1

# The arch takes long to judge, so only both sides of its closed form, 1e-3 off, are tried.
closed_form=0.107347744
for dt in 1/60 1/240; do
    for factor in 0.999 1.001; do
        thickness=$(python3 -c "print($closed_form * $factor)")
        outcome=$("$PLUMB" run arch --set "thickness=$thickness" --dt "$dt" \
                      --engine plumb:accurate | sed -nE '1s/.*: ([a-z]+),.*/\1/p')
        expected=$([[ $factor == 1.001 ]] && echo ok || echo collapsed)
        [[ $outcome == "$expected" ]] ||
            note_failure "arch of thickness $thickness at $dt: $outcome, expected $expected"
    done
done

# What else is hard, and cheap.
for name in 'tower --set n=100' 'mass-ratio --set k=6' card-house overhang cylinder-pyramid \
            sphere-pyramid painleve thin-rod far-from-origin 'large-step --dt 0.1' \
            initial-overlap needle-in-gap multi-tower pyramid; do
    for dt in 1/60 1/240; do
        # Word splitting is meant; a later --dt wins.
        # shellcheck disable=SC2086
        "$PLUMB" run --dt "$dt" $name --engine plumb:accurate >out 2>&1 ||
            note_failure "$name at $dt: $(head -2 out)"
    done
done
exit $failed
