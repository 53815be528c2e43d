/* What an ODE world says of itself: poses, velocities and what it was set to. */
#ifndef PLUMB_ODE_READ_H
#define PLUMB_ODE_READ_H

#include "ode_instance.h"

/* The pose of the frame of a moving body's shape. */
void pl_ode_read_pose(const pl_engine_instance *instance, int body, double position[3],
                      double orientation[4]);

/* What the geoms of the shape's polyhedron share; NULL where it has none. */
const ode_solid *pl_ode_solid_of(const pl_engine_instance *instance, const pl_shape *shape);

/* As in pl_engine. */
void pl_ode_read_frame(const pl_engine_instance *instance, pl_frame *frame);
void pl_ode_read_settings(const pl_engine_instance *instance, double dt,
                          pl_engine_settings *settings);
void pl_ode_read_pair(const pl_engine_instance *instance, int body_a, int body_b, double *friction,
                      double *restitution);

#endif
