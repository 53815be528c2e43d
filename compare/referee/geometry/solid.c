#include "solid.h"

double pl_bounding_radius(const pl_shape *shape)
{
    switch (shape->kind) {
    case PL_SHAPE_SPHERE:
        return shape->radius;
    case PL_SHAPE_BOX:
        return pl_vec_length(pl_vec_of(shape->half_extents));
    case PL_SHAPE_CAPSULE:
        return shape->radius + shape->half_height;
    case PL_SHAPE_CYLINDER:
        return sqrt(shape->radius * shape->radius + shape->half_height * shape->half_height);
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        return shape->polyhedron->radius;
    case PL_SHAPE_PLANE:
        break;
    }
    return 0;
}

static bool is_polyhedron(const pl_shape *shape)
{
    return shape->kind == PL_SHAPE_HULL || shape->kind == PL_SHAPE_MESH;
}

pl_vec pl_centre_of_mass(const pl_shape *shape, const double position[3],
                         const double orientation[4])
{
    pl_vec centre = pl_vec_of(position);
    if (is_polyhedron(shape)) {
        pl_axes axes = pl_axes_of(orientation);
        centre = pl_vec_add(centre, pl_to_world(&axes, pl_vec_of(shape->polyhedron->centre)));
    }
    return centre;
}

pl_vec pl_state_centre(const pl_body *body, const pl_body_state *state)
{
    return pl_centre_of_mass(&body->shape, state->position, state->orientation);
}

pl_axes pl_principal_axes(const pl_shape *shape, const double orientation[4])
{
    pl_axes axes = pl_axes_of(orientation);
    if (is_polyhedron(shape)) {
        pl_axes principal = pl_axes_of(shape->polyhedron->axes);
        for (int k = 0; k < 3; ++k) {
            principal.axis[k] = pl_to_world(&axes, principal.axis[k]);
        }
        axes = principal;
    }
    return axes;
}

double pl_kinetic_energy(const pl_body *body, const double velocity[3], pl_vec spin)
{
    const pl_vec v = pl_vec_of(velocity);
    return 0.5 * (body->mass * pl_vec_dot(v, v) + body->inertia[0] * spin.x * spin.x +
                  body->inertia[1] * spin.y * spin.y + body->inertia[2] * spin.z * spin.z);
}

double pl_core_radius(const pl_shape *shape)
{
    return shape->kind == PL_SHAPE_SPHERE || shape->kind == PL_SHAPE_CAPSULE ? shape->radius : 0;
}

static pl_vec farthest_vertex(const pl_polyhedron *polyhedron, pl_vec d)
{
    const double(*vertices)[3] = (const double(*)[3])polyhedron->vertices;
    int farthest = 0;
    double most = -HUGE_VAL;
    for (int i = 0; i < polyhedron->vertex_count; ++i) {
        double along = pl_vec_dot(d, pl_vec_of(vertices[i]));
        if (along > most) {
            most = along;
            farthest = i;
        }
    }
    return pl_vec_of(vertices[farthest]);
}

pl_vec pl_core_support(const pl_shape *shape, pl_vec d)
{
    const double *half = shape->half_extents;
    switch (shape->kind) {
    case PL_SHAPE_BOX:
        return (pl_vec){copysign(half[0], d.x), copysign(half[1], d.y), copysign(half[2], d.z)};
    case PL_SHAPE_CAPSULE:
        return (pl_vec){0, 0, copysign(shape->half_height, d.z)};
    case PL_SHAPE_CYLINDER: {
        double across = sqrt(d.x * d.x + d.y * d.y), s = across > 0 ? shape->radius / across : 0;
        return (pl_vec){s * d.x, s * d.y, copysign(shape->half_height, d.z)};
    }
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        return farthest_vertex(shape->polyhedron, d);
    case PL_SHAPE_PLANE:
    case PL_SHAPE_SPHERE:
        break;
    }
    return (pl_vec){0, 0, 0};
}

/* In the half plane through the axis and the point it is the distance of (across, |z|) from a
 * rectangle. */
double pl_cylinder_distance(const pl_shape *cylinder, pl_vec point)
{
    double across = sqrt(point.x * point.x + point.y * point.y);
    double beyond_side = across - cylinder->radius;
    double beyond_end = fabs(point.z) - cylinder->half_height;
    return beyond_side > 0 && beyond_end > 0
               ? sqrt(beyond_side * beyond_side + beyond_end * beyond_end)
               : fmax(beyond_side, beyond_end);
}
