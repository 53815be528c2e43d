#!/usr/bin/env bash
# Faults put into the adapter of ODE, one at a time: plumb check-engine names them.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
# shellcheck source=tests/support/faulty_plumb.sh
source "$SOURCE/tests/support/faulty_plumb.sh"
export PLUMB_CACHE=$directory
"$PLUMB" list engines ode >listed 2>&1 || exit 77 # not in this build

surface=compare/adapters/ode/ode_contacts.c
faulty friction $surface 's/surface.mu = pair.friction;/surface.mu = 0.99 * pair.friction;/'
faulty threshold $surface 's/surface.bounce = pair.restitution;/& surface.bounce_vel = 0.5;/'
faulty force_unit $surface 's/ \* instance->last_dt;/;/'
for fault in friction:friction threshold:restitution-threshold force_unit:impulse-weight; do
    PLUMB=$directory/${fault%:*} command=check-engine expect 1 "FAIL +${fault#*:} " ode --quiet
done
exit $failed
