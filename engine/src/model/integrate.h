/* The motion of bodies without contacts. */
#ifndef PE_INTEGRATE_H
#define PE_INTEGRATE_H

#include "world.h"

/* A body's step without contacts. */
typedef struct pe_free_motion {
    pe_twist end;   /* v* = v + h M^-1 f, world */
    pe_twist mean;  /* h times it are the displacement and the rotation vector of the step */
    pe_vec3 torque; /* N m, world; h times it is the angular impulse of the applied forces */
} pe_free_motion;

/* Fills `motions` (slots) for a step of dt, in s, of bodies that touch nothing where `place` (slots)
 * is below 0. The free rotation keeps the angular momentum in
 * the world frame to rounding and is second order: I w' = exp(-h m) I w in the body's axes, m = (w
 * + w')/2 the mean angular velocity by which the body then rotates (a midpoint rule on the rotation
 * group, of the kind of Moser and Veselov 1991). Torques act in two halves, before and after the
 * rotation. Forces given in the body's axes rotate with it:
 * impulse and displacement are integrals over the step, by Simpson's rule. */
void pe_predict_motion(const pe_world *world, const int *place, double dt, pe_free_motion *motions);

/* The same of one dynamic body; `flies`: it touches nothing. */
pe_free_motion pe_predict_body(const pe_world *world, int slot, bool flies, double dt);

/* The rotation of a body over dt, in s, which gets the angular impulses `impulses`[0] at the step's
 * start and `impulses`[1] at its end, in N m s, world, and rotates freely between. Writes the
 * angular velocity at the end of the step to *end, and that by which the body rotates in it to
 * *mean, in rad/s, world. The order is the second when the impulses are the same. */
void pe_rotate_freely(const pe_world *world, int slot, double dt, const pe_vec3 impulses[2],
                      pe_vec3 *end, pe_vec3 *mean);

/* Moves a pose by a displacement, in m, and a rotation vector, in rad, world axes. */
void pe_pose_move(pe_pose *pose, pe_vec3 displacement, pe_vec3 rotation);

#endif
