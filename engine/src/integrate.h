/* Velocities by forces, and poses by velocities. */
#ifndef PE_INTEGRATE_H
#define PE_INTEGRATE_H

#include "world.h"

/* The velocities at the end of the step if there were no contacts, v* = v + h M^-1 f, into
 * predicted (slots); the gyroscopic term by the implicit midpoint rule in the body's axes, which
 * keeps kinetic energy and the length of the angular momentum (Hairer, Lubich, Wanner 2006, IV.2).
 */
void pe_predict_velocities(const pe_world *world, double dt, pe_motion *predicted);

/* Moves every dynamic body by its velocity over dt. */
void pe_integrate_poses(pe_world *world, double dt);

/* Moves one body by a displacement and a rotation vector, world axes. */
void pe_pose_move(pe_pose *pose, pe_vec3 displacement, pe_vec3 rotation);

#endif
