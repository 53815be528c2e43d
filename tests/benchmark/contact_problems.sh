#!/usr/bin/env bash
# contact_problems.sh PLUMB DIRECTORY: captures the 28 contact problems of the solver benchmark. Stacks at rest are
# captured after they have settled, with the warm start of the step before; piles and collapses while they move.
# Solvers were not tuned on those whose name ends with held-out.
set -euo pipefail
plumb=$1 directory=$2
mkdir -p "$directory"

# capture NAME STEP SCENARIO [OPTION...]
capture() {
    local name=$1 step=$2
    shift 2
    [[ ! -e $directory/$name.json ]] || return 0
    "$plumb" run "$@" --engine plumb:accurate --duration "$step/60" --capture "$step:$directory/$name.json" >"$directory/log"
}

capture tower-10 2 tower --set n=10
capture tower-100 2 tower --set n=100
capture tower-1000 2 tower --set n=1000
capture tower-100-offset 30 tower --set n=100 --set offset=0.05 --seed 1
capture tower-100-offset-held-out 30 tower --set n=100 --set offset=0.05 --seed 101
capture mass-ratio-1e3 2 mass-ratio --set k=3
capture mass-ratio-1e6 2 mass-ratio --set k=6
capture tower-100-top-1000 2 tower --set n=100 --set top_mass=1000
capture tower-100-rising-1000 2 tower --set n=100 --set rising_mass=1000
capture slope-stick-threshold 30 slope-stick --set angle=0.4636
capture slope-slide-threshold 30 slope-slide --set angle=0.4637
for size in 10x10 25x40; do
    bricks=(--set "rows=${size%x*}" --set "columns=${size#*x}")
    capture "wall-$size" 2 wall "${bricks[@]}"
    capture "collapse-$size-impact" 8 wall-collapse "${bricks[@]}"
    capture "collapse-$size" 40 wall-collapse "${bricks[@]}"
done
for size in 100:90 500:110 1000:130; do
    n=${size%:*}
    for shape in spheres:0 boxes:1 both:2; do
        [[ $n-$shape == 1000-both:2 ]] ||
            capture "pile-$n-${shape%:*}" "${size#*:}" pile --set "n=$n" --set "shape=${shape#*:}" --seed 1
    done
done
capture pile-100-both-held-out 80 pile --set n=100 --set shape=2 --seed 101
capture pile-500-both-held-out 100 pile --set n=500 --set shape=2 --seed 102
capture pile-1000-both-held-out 120 pile --set n=1000 --set shape=2 --seed 103
rm -f "$directory/log"
