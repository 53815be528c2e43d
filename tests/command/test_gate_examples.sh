#!/usr/bin/env bash
# The CI jobs of compare/examples work when copied: their steps run as they stand, with an engine of plumb new-engine,
# first to make a baseline, then against it, then with a fault in the engine.
set -eu
python3 -c 'import yaml' 2>/dev/null || exit 77
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"

# What installs packages does nothing here; plumb is that of the build.
mkdir programs
ln -s "$PLUMB" programs/plumb
for name in apt-get curl; do
    printf '#!/bin/sh\n' >"programs/$name"
    chmod +x "programs/$name"
done
export PATH=$directory/programs:$PATH PLUMB_PACKAGES=https://example.org/plumb.deb

# steps FILE: writes the shell steps of a job to steps/1, steps/2 and so on.
steps() {
    rm -rf steps
    mkdir steps
    python3 - "$1" <<'END'
import sys, yaml
with open(sys.argv[1], encoding="utf-8") as file:
    page = yaml.safe_load(file)
if "jobs" in page:
    found = [step["run"] for step in page["jobs"]["gate"]["steps"] if "run" in step]
else:
    found = page["plumb-gate"]["before_script"] + page["plumb-gate"]["script"]
for number, step in enumerate(found, 1):
    with open(f"steps/{number}", "w", encoding="utf-8") as file:
        file.write(step.strip() + "\n")
END
}

# run_steps FIRST...: these steps, each as GitHub and GitLab run it; the exit code is that of the first that fails.
run_steps() {
    for step; do
        bash --noprofile --norc -eo pipefail "$step" >>log 2>&1 || return
    done
}

for job in github/plumb-gate.yml gitlab/.gitlab-ci.yml; do
    mkdir repository
    cd repository
    export GITHUB_STEP_SUMMARY=$PWD/page.md
    plumb new-engine my-engine >/dev/null
    steps "$SOURCE/compare/examples/$job"
    mapfile -t all < <(printf '%s\n' steps/* | sort -V)
    gate=$(grep -l '^plumb gate' steps/*)
    actual=0
    run_steps "${all[@]}" || actual=$?
    [[ $actual != 0 ]] || note_failure "$job: passed without a baseline"
    sed '$s/$/ --update-baseline/' "$gate" >update
    run_steps update || note_failure "$job: no baseline: $(cat log)"
    : >log
    run_steps "${all[@]}" || note_failure "$job: $(cat log)"
    grep -q 'gate passed' log || note_failure "$job: no verdict: $(cat log)"
    grep -q 'conformance passed' log || note_failure "$job: the engine is not checked: $(cat log)"
    ! grep -q '^\[1/' log || note_failure "$job: runs were made again: $(cat log)"
    [[ $job != github/* ]] || grep -q '# Plumb report' page.md || note_failure "$job: no summary"
    # Bounces up to a step too early: no check of an adapter sees that.
    : >log
    sed -i 's|path / 2|path|' my-engine/sphere_world.c
    actual=0
    run_steps "${all[@]}" || actual=$?
    [[ $actual == 1 ]] && grep -q 'value_error: .* -> ' log || note_failure "$job: a fault is not seen: exit code $actual: $(cat log)"
    [[ $job != gitlab/* ]] || grep -q 'failures="[1-9]' plumb-gate.xml || note_failure "$job: no failure in the report"
    cd ..
    rm -rf repository
done
exit $failed
