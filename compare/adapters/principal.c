/* With c the centre and A the axes in the shape's frame, and (p, R) its pose: the principal frame
 * is at p + R c and turned by R A. */
#include "principal.h"

#include "plumb/vec.h"

/* q = q by, Hamilton's product: `by` is a rotation in the frame that q turns. */
static void turn(double q[4], const double by[4])
{
    pl_vec vq = pl_vec_of(q + 1), vb = pl_vec_of(by + 1);
    double w = q[0] * by[0] - pl_vec_dot(vq, vb);
    pl_vec v = pl_vec_mad(pl_vec_cross(vq, vb), q[0], vb);
    pl_vec_store(pl_vec_mad(v, by[0], vq), q + 1);
    q[0] = w;
}

/* position += sign R(orientation) offset */
static void shift(double position[3], const double orientation[4], const double offset[3],
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
        shift(position, orientation, solid->centre, 1);
        turn(orientation, solid->axes);
    }
}

void pl_to_shape_pose(const pl_shape *shape, double position[3], double orientation[4])
{
    const pl_polyhedron *solid = shape->polyhedron;
    if (solid != NULL) {
        const double *a = solid->axes, back[4] = {a[0], -a[1], -a[2], -a[3]};
        turn(orientation, back);
        shift(position, orientation, solid->centre, -1);
    }
}

void pl_vertex_in_principal(const pl_polyhedron *solid, int vertex, double out[3])
{
    const pl_axes axes = pl_axes_of(solid->axes);
    pl_vec from_centre = pl_vec_sub(pl_vec_of(solid->vertices[vertex]), pl_vec_of(solid->centre));
    pl_vec_store(pl_to_local(&axes, from_centre), out);
}
