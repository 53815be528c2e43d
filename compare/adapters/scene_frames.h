/* The scene in the frames that engines use: poses of principal frames, and forces in the world.
 *
 * The principal frame of a body is at its centre of mass, along its principal axes. Engines put the
 * centre of mass at a body's own origin, while the scene's poses are those of the shape's frame.
 * The two frames differ for hulls and meshes only; for every other shape the numbers pass
 * unchanged. */
#ifndef PLUMB_SCENE_FRAMES_H
#define PLUMB_SCENE_FRAMES_H

#include "plumb/engine_abi.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Converts, in place, the pose of the shape's frame to that of the principal frame: the position of
 * the origin (m) and a unit quaternion (w, x, y, z), in the world. */
void pl_to_principal_pose(const pl_shape *shape, double position[3], double orientation[4]);

/* The inverse of pl_to_principal_pose. */
void pl_to_shape_pose(const pl_shape *shape, double position[3], double orientation[4]);

/* A vertex of a hull or a mesh in the principal frame, m. */
void pl_vertex_in_principal(const pl_polyhedron *solid, int vertex, double out[3]);

/* Whether `force` acts (pl_force_acts); if it does, the force in the world frame (N), and its point of application as an offset
 * from the centre of mass in the world frame (m). `orientation` is the body's (w, x, y, z) at that
 * time: a force in the body frame turns with the body. */
bool pl_force_at(const pl_force *force, double time, double dt, const double orientation[4],
                 double world_force[3], double world_offset[3]);

#ifdef __cplusplus
}
#endif
#endif
