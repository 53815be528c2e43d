/* Velocities by forces, and poses by velocities. */
#ifndef PE_INTEGRATE_H
#define PE_INTEGRATE_H

#include "world.h"

/* What a step would be without contacts. */
typedef struct pe_free_motion {
    pe_twist end;   /* v* = v + h M^-1 f, world */
    pe_twist mean;  /* whose displacement and rotation vector, h times it, are those of the step */
    pe_vec3 torque; /* h times it is the angular impulse of the loads, N m, world */
} pe_free_motion;

/* Of every slot, into motions (slots). The free rotation keeps the angular momentum in the world
 * frame to rounding and is second order: I w' = exp(-h m) I w in the body's axes, m = (w + w')/2
 * the mean angular velocity by which the body then turns (a midpoint rule on the rotation group, of
 * the kind of Moser and Veselov 1991); torques act in two halves about it. Forces given in the
 * body's axes turn with it. */
void pe_predict_motion(const pe_world *world, double dt, pe_free_motion *motions);

/* Of one dynamic body. */
pe_free_motion pe_predict_body(const pe_world *world, int slot, double dt);

/* Angular velocities of a body, in the world frame. */
typedef struct pe_rotation_step {
    pe_vec3 end;  /* at the end of a step */
    pe_vec3 mean; /* by which the body rotates in it */
} pe_rotation_step;

/* The rotation of a body over dt, in s, which gets the angular impulses `early`, in N m s, world,
 * at the step's start and `late` at its end, and rotates freely between. The order is the second
 * when they are the same. */
pe_rotation_step pe_rotate_freely(const pe_world *world, int slot, double dt, pe_vec3 early,
                                  pe_vec3 late);

/* Moves one body by a displacement and a rotation vector, world axes. */
void pe_pose_move(pe_pose *pose, pe_vec3 displacement, pe_vec3 rotation);

#endif
