/* Wrong readings of frames, by themselves or after the scene was misread in the same way. */
#ifndef FRAME_FAULTS_H
#define FRAME_FAULTS_H

#include "fault_variant.h"
#include "plumb/vec.h"

/* Quaternions as (x, y, z, w). */
void frame_quaternion_last_w(const variant_instance *v, pl_frame *frame);

/* Angular velocities in the bodies' axes. */
void frame_spin_of_body(const variant_instance *v, pl_frame *frame);

/* Angular velocities in degrees. */
void frame_spin_in_degrees(const variant_instance *v, pl_frame *frame);

/* Positions of hulls' centres of mass. */
void frame_centre_of_hulls(const variant_instance *v, pl_frame *frame);

/* The centre of mass of a hull or a mesh in `state`, as an offset from its position, m. */
pl_vec frame_arm(const pl_shape *shape, const double orientation[4]);

#endif
