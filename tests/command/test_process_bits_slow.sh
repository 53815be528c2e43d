#!/usr/bin/env bash
# A built-in engine gives the same bits when it is served by the process protocol, and passes the same checks.
set -eu
source "$SOURCE/tests/support/command.sh"

hash_of() { # hash_of ENGINE SCENARIO OPTION...
    local engine=$1
    shift
    "$PLUMB" run "$@" --engine "$engine" 2>&1 | grep state_hash || true
}

source "$SOURCE/compare/packages.sh"
for engine in $(engines linked); do
    "$PLUMB" list engines "$engine" >/dev/null 2>&1 || continue
    served="exec:$BUILD/process_server $engine"
    for scenario in "tower --duration 0.5" "pile --set n=30 --duration 0.5" "medley --duration 0.3"; do
        [[ $engine$scenario != mujocomedley* ]] || continue # it has no meshes
        hash_of "$engine" $scenario >direct
        hash_of "$served" $scenario >through
        [[ -s direct ]] && cmp -s direct through || note_failure "$engine on $scenario: $(cat direct) and, served, $(cat through)"
    done
    "$PLUMB" check-engine "$served" --quiet >checks || note_failure "served $engine: $(cat checks)"
done
exit $failed
