/* Shapes: volume and inertia of the solid of uniform density.
 *
 * Sphere: V = 4/3 pi r^3, I = 2/5 m r^2. Box with half extents (a, b, c): V = 8 a b c,
 * I_x = m (b^2 + c^2) / 3 and its permutations. Any textbook, such as Goldstein, Classical
 * Mechanics. */
#include "plumb/scene.h"

pl_shape pl_shape_plane(double nx, double ny, double nz, double offset)
{
    return (pl_shape){.kind = PL_SHAPE_PLANE, .normal = {nx, ny, nz}, .offset = offset};
}

pl_shape pl_shape_sphere(double radius)
{
    return (pl_shape){.kind = PL_SHAPE_SPHERE, .radius = radius};
}

pl_shape pl_shape_box(double half_x, double half_y, double half_z)
{
    return (pl_shape){.kind = PL_SHAPE_BOX, .half_extents = {half_x, half_y, half_z}};
}

double pl_shape_volume(const pl_shape *shape)
{
    const double pi = 3.14159265358979323846;
    switch (shape->kind) {
    case PL_SHAPE_SPHERE:
        return 4.0 / 3 * pi * shape->radius * shape->radius * shape->radius;
    case PL_SHAPE_BOX:
        return 8 * shape->half_extents[0] * shape->half_extents[1] * shape->half_extents[2];
    case PL_SHAPE_PLANE:
        break;
    }
    return 0;
}

void pl_shape_inertia(const pl_shape *shape, double mass, double inertia[3])
{
    double squares[3] = {0, 0,
                         0}; /* mean squares of x, y, z over the solid: I_x = m (<y^2> + <z^2>) */
    switch (shape->kind) {
    case PL_SHAPE_SPHERE:
        squares[0] = squares[1] = squares[2] = shape->radius * shape->radius / 5;
        break;
    case PL_SHAPE_BOX:
        for (int k = 0; k < 3; k++) {
            squares[k] = shape->half_extents[k] * shape->half_extents[k] / 3;
        }
        break;
    case PL_SHAPE_PLANE:
        break;
    }
    for (int k = 0; k < 3; k++) {
        inertia[k] = mass * (squares[(k + 1) % 3] + squares[(k + 2) % 3]);
    }
}
