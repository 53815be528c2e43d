/* Velocities by forces, and poses by velocities. */
#ifndef PE_INTEGRATE_H
#define PE_INTEGRATE_H

#include "world.h"

/* What a step would be without contacts. */
typedef struct pe_free_motion {
    pe_motion end;  /* v* = v + h M^-1 f, world */
    pe_motion mean; /* whose displacement and rotation vector, h times it, are those of the step */
} pe_free_motion;

/* Of every slot, into motions (slots). The free rotation keeps the angular momentum in the world
 * frame to rounding and is second order: I w' = exp(-h m) I w in the body's axes, m = (w + w')/2
 * the mean angular velocity by which the body then turns (a midpoint rule on the rotation group, of
 * the kind of Moser and Veselov 1991); torques act in two halves about it. Forces given in the
 * body's axes turn with it. */
void pe_predict_motion(const pe_world *world, double dt, pe_free_motion *motions);

/* Moves one body by a displacement and a rotation vector, world axes. */
void pe_pose_move(pe_pose *pose, pe_vec3 displacement, pe_vec3 rotation);

#endif
