/* With the centre c and the axes A in the shape's frame, and the pose (p, R) of that frame: the
 * principal frame is at p + R c with the orientation R A. */
#include "scene_frames.h"

#include "plumb/vec.h"

#include <string.h>

/* q = q by, Hamilton's product: `by` is a rotation in the frame that q rotates. */
static void rotate(double q[4], const double by[4])
{
    pl_vec vq = pl_vec_of(q + 1), vb = pl_vec_of(by + 1);
    double w = q[0] * by[0] - pl_vec_dot(vq, vb);
    pl_vec v = pl_vec_mad(pl_vec_cross(vq, vb), q[0], vb);
    pl_vec_store(pl_vec_mad(v, by[0], vq), q + 1);
    q[0] = w;
}

/* position += sign R(orientation) offset */
static void move(double position[3], const double orientation[4], const double offset[3],
                 double sign)
{
    const pl_axes axes = pl_axes_of(orientation);
    pl_vec turned = pl_to_world(&axes, pl_vec_of(offset));
    pl_vec_store(pl_vec_mad(pl_vec_of(position), sign, turned), position);
}

void pl_to_principal_pose(const pl_shape *shape, double position[3], double orientation[4])
{
    const pl_polyhedron *solid = shape->polyhedron;
    if (solid != NULL) {
        move(position, orientation, solid->centre, 1);
        rotate(orientation, solid->axes);
    }
}

void pl_to_shape_pose(const pl_shape *shape, double position[3], double orientation[4])
{
    const pl_polyhedron *solid = shape->polyhedron;
    if (solid != NULL) {
        const double *a = solid->axes, back[4] = {a[0], -a[1], -a[2], -a[3]};
        rotate(orientation, back);
        move(position, orientation, solid->centre, -1);
    }
}

void pl_vertex_in_principal(const pl_polyhedron *solid, int vertex, double out[3])
{
    const pl_axes axes = pl_axes_of(solid->axes);
    pl_vec from_centre = pl_vec_sub(pl_vec_of(solid->vertices[vertex]), pl_vec_of(solid->centre));
    pl_vec_store(pl_to_local(&axes, from_centre), out);
}

bool pl_force_at(const pl_force *force, double time, double dt, const double orientation[4],
                 double world_force[3], double world_offset[3])
{
    if (!pl_force_acts(force, time, dt)) {
        return false;
    }
    if (force->frame == PL_FRAME_BODY) {
        const pl_axes axes = pl_axes_of(orientation);
        pl_vec_store(pl_to_world(&axes, pl_vec_of(force->force)), world_force);
        pl_vec_store(pl_to_world(&axes, pl_vec_of(force->at)), world_offset);
    } else {
        memcpy(world_force, force->force, sizeof force->force);
        memcpy(world_offset, force->at, sizeof force->at);
    }
    return true;
}
