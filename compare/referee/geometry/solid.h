/* A body as a solid: where its mass is, how far it reaches, and the convex set it fills. */
#ifndef PLUMB_SOLID_H
#define PLUMB_SOLID_H

#include "plumb/scene.h"
#include "plumb/vec.h"

/* Of the smallest sphere about the centre of mass that holds the shape, m; 0 for a plane. */
double pl_bounding_radius(const pl_shape *shape);

/* In the world, m, of a shape whose own frame has this pose. */
pl_vec pl_centre_of_mass(const pl_shape *shape, const double position[3],
                         const double orientation[4]);

/* The principal axes of inertia in the world. */
pl_axes pl_principal_axes(const pl_shape *shape, const double orientation[4]);

/* A bounded shape is its core widened by this radius on all sides, m: a sphere's core is its centre
 * and a capsule's the segment between the centres of its ends; others are their own. */
double pl_core_radius(const pl_shape *shape);

/* The point of the core farthest along d, both in the shape's own frame, m. For a mesh, as for its
 * convex hull. O(vertices). */
pl_vec pl_core_support(const pl_shape *shape, pl_vec d);

/* A point outside or on a body's cylinder: how far, m; inside: minus the distance to its surface.
 * *nearest is the surface's nearest point and *normal points out of it there; both may be NULL. All
 * in the cylinder's own frame. */
double pl_cylinder_distance(const pl_shape *cylinder, pl_vec point, pl_vec *nearest,
                            pl_vec *normal);

#endif
