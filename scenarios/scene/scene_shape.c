/* Shapes: making them, their width, and volume and inertia of the solid of uniform density, from
 * the mean squares of its coordinates: I_x = m (<y^2> + <z^2>) and its permutations.
 *
 * Sphere: V = 4/3 pi r^3, <x^2> = r^2 / 5. Box with half extents (a, b, c): V = 8 a b c,
 * <x^2> = a^2 / 3. Cylinder: V = 2 pi r^2 h, <x^2> = <y^2> = r^2 / 4, <z^2> = h^2 / 3. Any
 * textbook, such as Goldstein, Classical Mechanics. A capsule is a cylinder and two half balls,
 * whose <z> from their flat side is 3 r / 8. A polyhedron has its own integrals. */
#include "plumb/vec.h"
#include "scene_internal.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

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

pl_shape pl_shape_capsule(double radius, double half_height)
{
    return (pl_shape){.kind = PL_SHAPE_CAPSULE, .radius = radius, .half_height = half_height};
}

pl_shape pl_shape_cylinder(double radius, double half_height)
{
    return (pl_shape){.kind = PL_SHAPE_CYLINDER, .radius = radius, .half_height = half_height};
}

pl_shape pl_shape_of(const pl_polyhedron *polyhedron)
{
    return (pl_shape){.kind = polyhedron->convex ? PL_SHAPE_HULL : PL_SHAPE_MESH,
                      .polyhedron = polyhedron};
}

double pl_shape_volume(const pl_shape *shape)
{
    const double r = shape->radius, h = shape->half_height;
    switch (shape->kind) {
    case PL_SHAPE_SPHERE:
        return 4.0 / 3 * pi * r * r * r;
    case PL_SHAPE_BOX:
        return 8 * shape->half_extents[0] * shape->half_extents[1] * shape->half_extents[2];
    case PL_SHAPE_CAPSULE:
        return 2 * pi * r * r * h + 4.0 / 3 * pi * r * r * r;
    case PL_SHAPE_CYLINDER:
        return 2 * pi * r * r * h;
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        return shape->polyhedron->volume;
    case PL_SHAPE_PLANE:
        break;
    }
    return 0;
}

static void capsule_squares(double r, double h, double squares[3])
{
    const double straight = h / (h + r * 2 / 3), round = 1 - straight; /* shares of the volume */
    squares[0] = squares[1] = straight * r * r / 4 + round * r * r / 5;
    squares[2] = straight * h * h / 3 + round * (h * h + h * r * 3 / 4 + r * r / 5);
}

void pl_shape_inertia(const pl_shape *shape, double mass, double inertia[3])
{
    const double r = shape->radius, h = shape->half_height;
    double squares[3] = {0, 0, 0}; /* <x^2>, <y^2>, <z^2> */
    switch (shape->kind) {
    case PL_SHAPE_SPHERE:
        squares[0] = squares[1] = squares[2] = r * r / 5;
        break;
    case PL_SHAPE_BOX:
        for (int k = 0; k < 3; ++k) {
            squares[k] = shape->half_extents[k] * shape->half_extents[k] / 3;
        }
        break;
    case PL_SHAPE_CAPSULE:
        capsule_squares(r, h, squares);
        break;
    case PL_SHAPE_CYLINDER:
        squares[0] = squares[1] = r * r / 4;
        squares[2] = h * h / 3;
        break;
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        for (int k = 0; k < 3; ++k) {
            inertia[k] = mass * shape->polyhedron->inertia[k];
        }
        return;
    case PL_SHAPE_PLANE:
        break;
    }
    for (int k = 0; k < 3; ++k) {
        inertia[k] = mass * (squares[(k + 1) % 3] + squares[(k + 2) % 3]);
    }
}

static double half_width_of_polyhedron(const pl_polyhedron *p)
{
    const pl_axes axes = pl_axes_of(p->axes);
    double half = (double)INFINITY;
    for (int k = 0; k < 3; ++k) {
        double low = (double)INFINITY, high = -low;
        for (int i = 0; i < p->vertex_count; ++i) {
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
