/* Helpers for adapters: rotations, the principal frames of hulls and meshes, and forces in the
 * world frame. They are static inline functions on plain arrays, need no symbol of plumb or of the
 * C library, and compile wherever plumb/engine_abi.h does. No adapter has to use them.
 *
 * Quaternions are (w, x, y, z). They need not be exactly unit: rotations divide by the norm, so
 * that an engine's rounding scales nothing. An output may be the same array as an input.
 *
 * The principal frame of a body is at its centre of mass, along its principal axes. Engines put the
 * centre of mass at a body's own origin, while the scene's poses are those of the shape's frame.
 * The two frames differ for hulls and meshes only; for every other shape the numbers pass
 * unchanged. */
#ifndef PLUMB_ADAPTER_HELPERS_H
#define PLUMB_ADAPTER_HELPERS_H

#include "plumb/engine_abi.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Sets m to the rotation matrix of the quaternion q, by rows: world = m body. */
static inline void pl_rotation_matrix(const double q[4], double m[3][3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double s = 2 / (w * w + x * x + y * y + z * z);
    m[0][0] = 1 - s * (y * y + z * z);
    m[1][0] = s * (x * y + w * z);
    m[2][0] = s * (x * z - w * y);
    m[0][1] = s * (x * y - w * z);
    m[1][1] = 1 - s * (x * x + z * z);
    m[2][1] = s * (y * z + w * x);
    m[0][2] = s * (x * z + w * y);
    m[1][2] = s * (y * z - w * x);
    m[2][2] = 1 - s * (x * x + y * y);
}

/* Sets `world` to the vector `body`, which is in body axes, in world axes. `q` is the orientation
 * of the body. An engine that keeps the angular velocity in body axes reads it back by this. */
static inline void pl_rotate_to_world(const double q[4], const double body[3], double world[3])
{
    const double x = body[0], y = body[1], z = body[2];
    double m[3][3];
    pl_rotation_matrix(q, m);
    for (int i = 0; i < 3; ++i) {
        world[i] = x * m[i][0] + y * m[i][1] + z * m[i][2];
    }
}

/* Sets `body` to the vector `world`, which is in world axes, in the axes of a body with the
 * orientation q. */
static inline void pl_rotate_to_body(const double q[4], const double world[3], double body[3])
{
    const double x = world[0], y = world[1], z = world[2];
    double m[3][3];
    pl_rotation_matrix(q, m);
    for (int i = 0; i < 3; ++i) {
        body[i] = m[0][i] * x + m[1][i] * y + m[2][i] * z;
    }
}

/* Sets `product` to Hamilton's product a b: the rotation b, then the rotation a. */
static inline void pl_quaternion_product(const double a[4], const double b[4], double product[4])
{
    const double aw = a[0], ax = a[1], ay = a[2], az = a[3];
    const double bw = b[0], bx = b[1], by = b[2], bz = b[3];
    product[0] = aw * bw - (ax * bx + ay * by + az * bz);
    product[1] = ay * bz - az * by + aw * bx + bw * ax;
    product[2] = az * bx - ax * bz + aw * by + bw * ay;
    product[3] = ax * by - ay * bx + aw * bz + bw * az;
}

/* Converts, in place, the pose of the shape's frame to that of the principal frame: the position of
 * the origin (m) and a unit quaternion, in the world. */
static inline void pl_to_principal_pose(const pl_shape *shape, double position[3],
                                        double orientation[4])
{
    if (shape->polyhedron != NULL) {
        double offset[3];
        pl_rotate_to_world(orientation, shape->polyhedron->centre, offset);
        for (int k = 0; k < 3; ++k) {
            position[k] += offset[k];
        }
        pl_quaternion_product(orientation, shape->polyhedron->axes, orientation);
    }
}

/* The inverse of pl_to_principal_pose. */
static inline void pl_to_shape_pose(const pl_shape *shape, double position[3],
                                    double orientation[4])
{
    if (shape->polyhedron != NULL) {
        const double *axes = shape->polyhedron->axes;
        const double back[4] = {axes[0], -axes[1], -axes[2], -axes[3]};
        double offset[3];
        pl_quaternion_product(orientation, back, orientation);
        pl_rotate_to_world(orientation, shape->polyhedron->centre, offset);
        for (int k = 0; k < 3; ++k) {
            position[k] -= offset[k];
        }
    }
}

/* Sets `out` to a vertex of a hull or a mesh in the principal frame, m. */
static inline void pl_vertex_in_principal(const pl_polyhedron *solid, int vertex, double out[3])
{
    double from_centre[3];
    for (int k = 0; k < 3; ++k) {
        from_centre[k] = solid->vertices[vertex][k] - solid->centre[k];
    }
    pl_rotate_to_body(solid->axes, from_centre, out);
}

/* Whether `force` acts over the step of length dt (s) that starts at `time` (s), as pl_force_acts;
 * if it does, sets the force in world axes (N) and its point of application as an offset from the
 * centre of mass in world axes (m). `orientation` is that of the body's shape at that time: a force
 * in the body frame turns with the body. */
static inline bool pl_force_at(const pl_force *force, double time, double dt,
                               const double orientation[4], double world_force[3],
                               double world_offset[3])
{
    if (!pl_force_acts(force, time, dt)) {
        return false;
    }
    if (force->frame == PL_FRAME_BODY) {
        pl_rotate_to_world(orientation, force->force, world_force);
        pl_rotate_to_world(orientation, force->at, world_offset);
    } else {
        for (int k = 0; k < 3; ++k) {
            world_force[k] = force->force[k];
            world_offset[k] = force->at[k];
        }
    }
    return true;
}

/* Sets `state` to that of a body at the start, in the conventions of read_frame. */
static inline void pl_initial_state(const pl_body *body, pl_body_state *state)
{
    for (int k = 0; k < 3; ++k) {
        state->position[k] = body->position[k];
        state->velocity[k] = body->velocity[k];
        state->angular_velocity[k] = body->angular_velocity[k];
    }
    for (int k = 0; k < 4; ++k) {
        state->orientation[k] = body->orientation[k];
    }
}

#ifdef __cplusplus
}
#endif
#endif
