#!/usr/bin/env bash
# Makes the pictures of the documentation from real pages: tests/benchmark/page_pictures.sh [PLUMB]. Needs Chromium
# (the environment variable CHROMIUM, else chromium); takes two minutes.
set -eu
here=$(cd "$(dirname "$0")/../../compare/report" && pwd)
plumb=$(realpath "${1:-$here/../../build/compare/plumb}")
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
cd "$directory"

# picture PAGE#HASH FILE WIDTH HEIGHT
picture() {
    "${CHROMIUM:-chromium}" --headless=new --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader \
        --hide-scrollbars --virtual-time-budget=20000 --window-size="$3,$4" --screenshot="$2" \
        "file://$directory/$1" 2>/dev/null
}

"$plumb" compare --engine plumb --engine plumb:fast --engine ode:quick --engine ode:recommended --engine bullet:si \
    --engine bullet:recommended --engine mujoco --out report >/dev/null
"$plumb" sweep tower slope-slide --engine plumb --engine ode --engine bullet --vary dt=1/480..1/60:x2 --repeat 3 \
    --out sweep >/dev/null
picture report/index.html "$here/example.png" 1400 900
picture 'report/index.html#only=case-4' "$here/scenario_example.png" 1400 900
picture 'sweep/sweep.html#only=tower-least-cpu-time-for-a-simulated-second-by-rest-position-3' "$here/sweep_example.png" 1200 760
# That of the state of the engines, where compare/state has measured it.
if [[ -e $here/../../state/runs/index.html ]]; then
    cp "$here/../../state/runs/index.html" state.html
    picture state.html "$here/state.png" 1400 900
fi
