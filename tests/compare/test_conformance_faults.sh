#!/usr/bin/env bash
# Engines with one fault each (tests/compare/broken): the check of that fault fails and says what it is.
# Unusual engines that declare what they are pass every check.
set -eu
# shellcheck source=tests/support/command.sh
source "$SOURCE/tests/support/command.sh"
export PLUMB_CACHE=$directory
# A crash is the signal that it is, not a report of the address sanitizer.
export ASAN_OPTIONS=handle_segv=0:handle_abort=0:detect_leaks=0

# SHARED_OBJECT FAULT CHECK WORD: the check must fail, with WORD (a regular expression) in what it prints.
faults='
setup mass_half               mass                  2 times .* likely the mass
setup mass_double             mass                  half likely the mass
setup inertia_double          inertia-axes          half likely the inertia
setup inertia_permuted        inertia-axes          axis is that of the next one
setup friction_low            friction              0\.99 times
setup friction_ignored        friction-holds        contacts have none
setup friction_product        friction              the product of the two materials
setup restitution_low         restitution           0\.98 times
setup restitution_ignored     restitution           the coefficient does not reach the engine
setup gravity_high            gravity               1\.01 times
setup gravity_vertical        gravity-direction     the x component of pl_scene.gravity is not used
setup quaternion_mixed        turned-box            quaternion is x, y, z, w
setup spin_body_write         initial-spin          create takes the angular velocity as one in the body
setup spin_body_both          angular-velocity      the frame of the angular velocity
setup spin_degrees_both       angular-velocity      degrees
setup spin_ignored            initial-spin          nothing likely create or read_frame: the angular velocity
setup velocity_ignored        initial-velocity      does not set the velocity
setup static_moved            static-bodies         \(2, -2, 5\)
setup hull_centre             hull-centre           another point than its centre of mass
setup random_process          reload                after the engine is loaded again
setup random_instance         repeats               when it is created again
setup cylinders_absent        cylinder-rests        this shape is claimed, and its contacts are missing
setup meshes_absent           mesh-rests            this shape is claimed, and its contacts are missing
setup box_half_size           box-rests             the size of the shape
setup capsule_short           capsule-stands        includes the caps
setup plane_offset            plane                 its offset
setup force_offset            inertia-axes          pl_force.at is ignored
setup force_frame             body-force            PL_FRAME_BODY is taken as one in the world
setup force_time              force-times           pl_force.from or .until
step  step_short              step-length           0\.9 times .* step must advance by exactly dt
step  step_fixed              step-length           steps of the same length
step  substeps_hidden         contact-before-step   sub-step|within
step  float_hidden            integrator            0\.49999
step  damping_linear          linear-damping        damping of 0\.01
step  damping_angular         angular-damping       damping of 0\.01
step  restitution_threshold   restitution-threshold a threshold of restitution
step  sleeping                sleeping              sleeping
step  gyroscopic_none         gyroscopic-torque     gyroscopic torque is left out
step  leak_instance           scene-leaks           1e\+05 more .* a leak
step  leak_step               step-leaks            1e\+05 more .* a leak
step  rounding_step           floating-point-modes  step changed the rounding mode
step  rounding_create         floating-point-modes  create changed the rounding mode
step  flags_read              exception-flags       fetestexcept
step  statistics_negative     statistics            iterations: 0 or more
step  exit                    repeats               exit\(0\) during the check
step  crash                   repeats               SIGSEGV during the check
step  hang                    repeats               no end within
read  quaternion_order        quaternion-order      components is x, y, z, w
read  quaternion_inverse      quaternion-order      conjugated
read  quaternion_length       unit-quaternion       1\.001 .* normalise
read  spin_body_read          initial-spin          gives the angular velocity in the body
read  spin_degrees            initial-spin          degrees in place of radians
read  hull_centre_read        hull-centre           the position is that of the centre of mass
read  hull_velocity_read      hull-centre           the velocity is that of the frame
read  static_drifts           static-bodies         after 10 steps
read  frame_late              frame-of-step         before the step
read  time_unfilled           frame-time            does not fill pl_frame.time
read  time_steps              frame-time            the number of steps times dt
read  normal_reversed         contact-normal        points from B to A
read  normal_length           contact-normal        found 3, .* unit vector
read  impulse_newtons         impulse-weight        a force in N
read  impulse_half            impulse-weight        half the impulse
read  impulse_on_a            impulse-weight        the opposite sign .* impulses act on B
read  impulse_normal          impulse-friction      the impulse of friction is left out
read  separation_sign         contact-separation    a penetration is negative
read  contact_wrong_body      contact-bodies        which alone touch
read  contact_self            contact-bodies        a contact of bodies 1 and 1
read  contact_index           contact-bodies        indices of the scene
read  contact_count_negative  contact-count         negative
read  contact_lost            impulse-box           not all that acts
read  contact_points_local    contact-point         relative to a body
read  contacts_after          contact-before-step   before the step|after the step
read  settings_mass           read-back             mass of body 0
read  settings_friction       read-pair             0\.99 times
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
