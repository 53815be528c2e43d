#!/usr/bin/env bash
# Engines with one fault each (tests/compare/broken): the check of that fault fails and says what it is.
# Unusual engines that declare what they are pass every check.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
export PLUMB_CACHE=$directory

# SHARED_OBJECT FAULT CHECK WORD: the check must fail, with WORD (a regular expression) in what it prints.
faults='
setup friction_low            friction              .
setup friction_product        friction              product
setup restitution_low         restitution           .
setup restitution_ignored     restitution           .
step  restitution_threshold   restitution-threshold threshold
read  quaternion_order        quaternion-order      w, x, y, z
read  normal_reversed         contact-normal        .
read  normal_length           contact-normal        length
read  impulse_newtons         impulse-weight        a force in N
read  impulse_half            impulse-weight        half the impulse
read  impulse_on_a            impulse-weight        impulses act on B
read  impulse_normal          impulse-friction      friction is left out
read  separation_sign         contact-separation    .
read  contact_wrong_body      contact-bodies        .
read  contact_self            contact-bodies        .
read  contact_index           contact-bodies        .
read  contact_count_negative  contact-count         .
read  contact_points_local    contact-point         .
read  contacts_after          contact-before-step   before
read  settings_friction       read-pair             .
'
while read -r object fault check word; do
    [[ -z $object ]] && continue
    command=check-engine expect 1 "FAIL +$check " "$BUILD/broken_$object.so:$fault" --check "$check" --timeout 5
    tr -s ' \n' ' ' <out | grep -qE -- "$word" ||
        note_failure "$fault: $check does not mention \"$word\": $(cat out)"
done <<<"$faults"

for engine in broken_setup.so:good float_engine.so substep_engine.so; do
    command=check-engine expect 0 'conformance passed' "$BUILD/$engine"
done
exit $failed
