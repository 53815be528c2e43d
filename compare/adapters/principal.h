/* The principal frame of a body: at its centre of mass, along its principal axes. Engines put the
 * centre of mass at a body's own origin; the scene's poses are those of the shape's frame. For
 * every shape but a hull and a mesh the two frames are one, and the numbers pass unchanged. */
#ifndef PLUMB_PRINCIPAL_H
#define PLUMB_PRINCIPAL_H

#include "plumb/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Turn the pose of the shape's frame into that of the principal frame, and the other way, in place:
 * position of the origin (m) and unit quaternion (w, x, y, z), in the world. */
void pl_to_principal_pose(const pl_shape *shape, double position[3], double orientation[4]);
void pl_to_shape_pose(const pl_shape *shape, double position[3], double orientation[4]);

/* A vertex of a hull or a mesh in the principal frame, m. */
void pl_vertex_in_principal(const pl_polyhedron *solid, int vertex, double out[3]);

#ifdef __cplusplus
}
#endif
#endif
