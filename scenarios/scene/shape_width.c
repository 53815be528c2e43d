#include "shape_width.h"

#include "plumb/vec.h"

#include <math.h>

static double half_width_of_polyhedron(const pl_polyhedron *p)
{
    const pl_axes axes = pl_axes_of(p->axes);
    double half = (double)INFINITY;
    for (int k = 0; k < 3; k++) {
        double low = (double)INFINITY, high = -low;
        for (int i = 0; i < p->vertex_count; i++) {
            const pl_vec arm = pl_vec_sub(pl_vec_of(p->vertices[i]), pl_vec_of(p->centre));
            const double x = pl_vec_dot(arm, axes.axis[k]);
            low = fmin(low, x);
            high = fmax(high, x);
        }
        half = fmin(half, (high - low) / 2);
    }
    return half;
}

double pl_shape_half_width(const pl_shape *shape)
{
    switch (shape->kind) {
    case PL_SHAPE_SPHERE:
    case PL_SHAPE_CAPSULE:
        return shape->radius;
    case PL_SHAPE_BOX:
        return fmin(shape->half_extents[0], fmin(shape->half_extents[1], shape->half_extents[2]));
    case PL_SHAPE_CYLINDER:
        return fmin(shape->radius, shape->half_height);
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        return half_width_of_polyhedron(shape->polyhedron);
    case PL_SHAPE_PLANE:
        break;
    }
    return (double)INFINITY;
}
