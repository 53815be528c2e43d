# Sourced: the runs that our own gate judges.
#
#   baseline_runs PLUMB DIRECTORY    makes them; results in DIRECTORY/*
#   baseline_gate PLUMB DIRECTORY BASELINE OPTION...
#
# Towers, walls, slopes and shapes at rest are solved directly; a collapse and a pile are swept. A build
# without SuiteSparse's AMD has another order of elimination, and so other last bits, which a collapse
# makes larger. The swept runs end before that: the pile of default and accurate has the same bits in
# both builds, that of fast agrees to 3e-7, and the collapse agrees but for the metrics and to the
# tolerances of baseline_gate.
baseline_runs() {
    local plumb=$1 directory=$2
    "$plumb" compare tower slope-stick slope-slide slide-to-stop wall bounce top torque-free \
        oblique-impact ladder rest-shape linked-rings roll-slope reaction-split \
        --set n=10 --set rows=5 --set columns=5 --engine plumb:accurate --engine plumb \
        --engine plumb:fast --out "$directory/still" >"$directory/log" 2>&1 || return
    "$plumb" compare wall-collapse --set rows=5 --set columns=5 --duration 0.6 \
        --engine plumb:accurate --engine plumb --out "$directory/collapse" >"$directory/log" 2>&1 || return
    "$plumb" compare pile --set n=20 --duration 0.45 --engine plumb:accurate --engine plumb \
        --out "$directory/pile" >"$directory/log" 2>&1 || return
    "$plumb" compare pile --set n=20 --duration 2 --engine plumb:fast --out "$directory/soft" \
        >"$directory/log" 2>&1
}

baseline_gate() {
    local plumb=$1 directory=$2 baseline=$3
    shift 3
    "$plumb" gate "$directory"/{still,collapse,pile,soft} --baseline "$baseline" \
        --tolerance cone_violation=1e-4,1e-6 --tolerance residual_max=1e-5,1e-9 \
        --tolerance residual_rms=1e-5,1e-9 --tolerance iterations_mean=1e-3 "$@"
}
