# Sourced: the runs that our own gate judges.
#
#   baseline_runs PLUMB DIRECTORY    makes them; results in DIRECTORY/still and DIRECTORY/swept
#
# Towers, walls, slopes and shapes at rest are solved directly; what collapses is swept, and is here on
# `fast` alone, whose numbers do not depend on the order of elimination that a build has.
baseline_runs() {
    local plumb=$1 directory=$2
    "$plumb" compare tower slope-stick slope-slide slide-to-stop wall bounce top torque-free \
        oblique-impact ladder rest-shape linked-rings roll-slope reaction-split \
        --set n=10 --set rows=5 --set columns=5 --engine plumb:accurate --engine plumb \
        --engine plumb:fast --out "$directory/still" >"$directory/log" 2>&1 || return
    "$plumb" compare wall-collapse --set rows=5 --set columns=5 --duration 2 --engine plumb:fast \
        --out "$directory/swept" >"$directory/log" 2>&1
}
