/* A body as a solid: its centre of mass, its extent, and the convex set that it fills. */
#ifndef PLUMB_SOLID_H
#define PLUMB_SOLID_H

#include "plumb/engine_abi.h"
#include "plumb/scene.h"
#include "plumb/vec.h"

/* Radius of the smallest sphere about the centre of mass around the shape, m; 0 for a plane. */
double pl_bounding_radius(const pl_shape *shape);

/* The centre of mass of a shape whose own frame has this pose: m, world frame. */
pl_vec pl_centre_of_mass(const pl_shape *shape, const double position[3],
                         const double orientation[4]);

/* The centre of mass of a body in a state: m, world frame. */
pl_vec pl_state_centre(const pl_body *body, const pl_body_state *state);

/* The principal axes of inertia of a shape with this orientation, in the world frame. */
pl_axes pl_principal_axes(const pl_shape *shape, const double orientation[4]);

/* The kinetic energy of a body, J. `spin` is its angular velocity along the principal axes, rad/s. */
double pl_kinetic_energy(const pl_body *body, const double velocity[3], pl_vec spin);

/* A bounded shape is its core, enlarged by this radius on all sides, m. The core of a sphere is its
 * centre, that of a capsule the segment between the centres of its ends. Other shapes are their own
 * cores and have the radius 0. */
double pl_core_radius(const pl_shape *shape);

/* The point of the core farthest along d, both in the shape's own frame, m. A mesh counts as its
 * convex hull. O(vertices). */
pl_vec pl_core_support(const pl_shape *shape, pl_vec d);

/* The signed distance of a point from a cylinder's surface, m; negative inside. The point is in the
 * cylinder's own frame. */
double pl_cylinder_distance(const pl_shape *cylinder, pl_vec point);

#endif
