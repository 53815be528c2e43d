#include "shape.h"

#include "memory.h"

pe_vec3 pe_shape_inertia(const pe_shape *shape, double mass)
{
    if (shape->kind == PE_SHAPE_SPHERE) {
        double i = 0.4 * mass * shape->radius * shape->radius;
        return pe_v3(i, i, i);
    }
    pe_vec3 q = pe_mul(shape->half_extents, shape->half_extents);
    return pe_scale(mass / 3, pe_v3(q.y + q.z, q.z + q.x, q.x + q.y));
}

double pe_shape_bounding_radius(const pe_shape *shape)
{
    switch (shape->kind) {
    case PE_SHAPE_SPHERE:
        return shape->radius;
    case PE_SHAPE_BOX:
        return pe_length(shape->half_extents);
    case PE_SHAPE_PLANE:
        break;
    }
    return 0;
}

double pe_shape_size(const pe_shape *shape)
{
    pe_vec3 e = shape->half_extents;
    switch (shape->kind) {
    case PE_SHAPE_SPHERE:
        return shape->radius;
    case PE_SHAPE_BOX:
        return pe_min(e.x, pe_min(e.y, e.z));
    case PE_SHAPE_PLANE:
        break;
    }
    return 0;
}

pe_vec3 pe_shape_half_extents(const pe_shape *shape, const pe_mat3 *rotation)
{
    if (shape->kind == PE_SHAPE_SPHERE) {
        return pe_v3(shape->radius, shape->radius, shape->radius);
    }
    pe_vec3 e = shape->half_extents;
    const pe_mat3 *r = rotation;
    return pe_v3(fabs(r->r0.x) * e.x + fabs(r->r0.y) * e.y + fabs(r->r0.z) * e.z,
                 fabs(r->r1.x) * e.x + fabs(r->r1.y) * e.y + fabs(r->r1.z) * e.z,
                 fabs(r->r2.x) * e.x + fabs(r->r2.y) * e.y + fabs(r->r2.z) * e.z);
}

static bool is_length(double x)
{
    return isfinite(x) && x > 0;
}

pe_status pe_shape_check(const pe_shape *shape, pe_error *error)
{
    pe_vec3 e = shape->half_extents;
    switch (shape->kind) {
    case PE_SHAPE_PLANE:
        if (!(fabs(pe_length(shape->normal) - 1) <= 1e-9) || !isfinite(shape->offset)) {
            return pe_fail(error, PE_BAD_ARGUMENT,
                           "plane: expected a unit normal and a finite offset, found a normal of "
                           "length %.17g, offset %g",
                           pe_length(shape->normal), shape->offset);
        }
        return PE_OK;
    case PE_SHAPE_SPHERE:
        if (!is_length(shape->radius)) {
            return pe_fail(error, PE_BAD_ARGUMENT, "sphere: expected a radius above 0, found %g",
                           shape->radius);
        }
        return PE_OK;
    case PE_SHAPE_BOX:
        if (!is_length(e.x) || !is_length(e.y) || !is_length(e.z)) {
            return pe_fail(error, PE_BAD_ARGUMENT,
                           "box: expected half extents above 0, found (%g, %g, %g)", e.x, e.y, e.z);
        }
        return PE_OK;
    }
    return pe_fail(error, PE_BAD_ARGUMENT, "unknown shape kind %d", (int)shape->kind);
}
