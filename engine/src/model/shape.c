/* Inertia, bounds and checks of the shapes, by kind. */
#include "shape.h"

#include "ranges.h"

/* The principal inertia of a cylinder of unit mass. */
static pe_vec3 cylinder_inertia(double r, double half)
{
    double across = r * r / 4 + half * half / 3;
    return pe_v3(across, across, r * r / 2);
}

/* That of a capsule of unit mass: a cylinder and two half balls, whose centres of mass lie 3/8 r
 * beyond its ends. */
static pe_vec3 capsule_inertia(double r, double half)
{
    double tube = 2 * half / (2 * half + 4 * r / 3), balls = 1 - tube; /* shares of the mass */
    double shift = half + 0.375 * r, own = (0.4 - 0.375 * 0.375) * r * r;
    pe_vec3 i = cylinder_inertia(r, half);
    double across = tube * i.x + balls * (own + shift * shift);
    return pe_v3(across, across, tube * i.z + balls * 0.4 * r * r);
}

pe_vec3 pe_shape_inertia(const pe_shape *shape, const pe_geometry *geometry, double mass)
{
    double r = shape->radius, half = shape->half_height;
    pe_vec3 q = pe_mul(shape->half_extents, shape->half_extents);
    switch (shape->kind) {
    case PE_SHAPE_SPHERE:
        return pe_scale(0.4 * mass * r * r, pe_v3(1, 1, 1));
    case PE_SHAPE_BOX:
        return pe_scale(mass / 3, pe_v3(q.y + q.z, q.z + q.x, q.x + q.y));
    case PE_SHAPE_CAPSULE:
        return pe_scale(mass, capsule_inertia(r, half));
    case PE_SHAPE_CYLINDER:
        return pe_scale(mass, cylinder_inertia(r, half));
    case PE_SHAPE_HULL:
    case PE_SHAPE_MESH:
        return pe_scale(mass, geometry->frame.inertia);
    case PE_SHAPE_PLANE:
    case PE_SHAPE_COUNT:
        break;
    }
    return pe_v3(0, 0, 0);
}

double pe_shape_bounding_radius(const pe_shape *shape, const pe_geometry *geometry)
{
    switch (shape->kind) {
    case PE_SHAPE_SPHERE:
        return shape->radius;
    case PE_SHAPE_BOX:
        return pe_length(shape->half_extents);
    case PE_SHAPE_CAPSULE:
        return shape->half_height + shape->radius;
    case PE_SHAPE_CYLINDER:
        return sqrt(shape->half_height * shape->half_height + shape->radius * shape->radius);
    case PE_SHAPE_HULL:
    case PE_SHAPE_MESH:
        return geometry->bounding_radius;
    case PE_SHAPE_PLANE:
    case PE_SHAPE_COUNT:
        break;
    }
    return 0;
}

double pe_shape_size(const pe_shape *shape, const pe_geometry *geometry)
{
    pe_vec3 e = shape->half_extents;
    switch (shape->kind) {
    case PE_SHAPE_SPHERE:
    case PE_SHAPE_CAPSULE:
        return shape->radius;
    case PE_SHAPE_BOX:
        return pe_min(e.x, pe_min(e.y, e.z));
    case PE_SHAPE_CYLINDER:
        return pe_min(shape->radius, shape->half_height);
    case PE_SHAPE_HULL:
    case PE_SHAPE_MESH:
        return geometry->size;
    case PE_SHAPE_PLANE:
    case PE_SHAPE_COUNT:
        break;
    }
    return 0;
}

/* The half extents of the AABB of a turned box of half extents e. */
static pe_vec3 turned_box(pe_vec3 e, const pe_mat3 *r)
{
    return pe_v3(fabs(r->r0.x) * e.x + fabs(r->r0.y) * e.y + fabs(r->r0.z) * e.z,
                 fabs(r->r1.x) * e.x + fabs(r->r1.y) * e.y + fabs(r->r1.z) * e.z,
                 fabs(r->r2.x) * e.x + fabs(r->r2.y) * e.y + fabs(r->r2.z) * e.z);
}

/* The half extent of a disc along a world axis, where c is the cosine of the angle to the disc's
 * axis. */
static double rim(double radius, double c)
{
    return radius * sqrt(pe_max(0, 1 - c * c));
}

pe_extent pe_shape_extent(const pe_shape *shape, const pe_geometry *geometry,
                          const pe_mat3 *rotation)
{
    pe_extent extent = {.half = pe_v3(0, 0, 0)};
    double r = shape->radius, half = shape->half_height;
    pe_vec3 axis = pe_axis(rotation, 2);
    pe_vec3 along = pe_v3(half * fabs(axis.x), half * fabs(axis.y), half * fabs(axis.z));
    switch (shape->kind) {
    case PE_SHAPE_SPHERE:
        extent.half = pe_v3(r, r, r);
        break;
    case PE_SHAPE_BOX:
        extent.half = turned_box(shape->half_extents, rotation);
        break;
    case PE_SHAPE_CAPSULE:
        extent.half = pe_add(along, pe_v3(r, r, r));
        break;
    case PE_SHAPE_CYLINDER:
        extent.half = pe_add(along, pe_v3(rim(r, axis.x), rim(r, axis.y), rim(r, axis.z)));
        break;
    case PE_SHAPE_HULL:
    case PE_SHAPE_MESH:
        extent.centre = pe_rotate(rotation, geometry->box_centre);
        extent.half = turned_box(geometry->box_half, rotation);
        break;
    case PE_SHAPE_PLANE:
    case PE_SHAPE_COUNT:
        break;
    }
    return extent;
}

static bool is_length(double x)
{
    return x >= PE_LEAST_LENGTH && x <= PE_MOST_LENGTH;
}

pe_status pe_shape_check(const pe_shape *shape, pe_error *error)
{
    pe_vec3 e = shape->half_extents;
    double length = pe_length(shape->normal), r = shape->radius, half = shape->half_height;
    switch (shape->kind) {
    case PE_SHAPE_PLANE:
        return fabs(length - 1) <= 1e-9 && fabs(shape->offset) <= PE_MOST_LENGTH
                   ? PE_OK
                   : pe_fail(error, PE_BAD_ARGUMENT,
                             "plane: expected a unit normal and an offset of at most %g, found a "
                             "normal of length %.17g, offset %g",
                             PE_MOST_LENGTH, length, shape->offset);
    case PE_SHAPE_SPHERE:
        return is_length(r) ? PE_OK
                            : pe_fail(error, PE_BAD_ARGUMENT,
                                      "sphere: expected a radius above 0, found %g; the range is "
                                      "%g .. %g m",
                                      r, PE_LEAST_LENGTH, PE_MOST_LENGTH);
    case PE_SHAPE_CAPSULE:
    case PE_SHAPE_CYLINDER:
        return is_length(r) && is_length(half)
                   ? PE_OK
                   : pe_fail(error, PE_BAD_ARGUMENT,
                             "%s: expected a radius and a half height above 0, found %g, %g; the "
                             "range is %g .. %g m",
                             shape->kind == PE_SHAPE_CAPSULE ? "capsule" : "cylinder", r, half,
                             PE_LEAST_LENGTH, PE_MOST_LENGTH);
    case PE_SHAPE_BOX:
        return is_length(e.x) && is_length(e.y) && is_length(e.z)
                   ? PE_OK
                   : pe_fail(error, PE_BAD_ARGUMENT,
                             "box: expected half extents above 0, found (%g, %g, %g); the range is "
                             "%g .. %g m",
                             e.x, e.y, e.z, PE_LEAST_LENGTH, PE_MOST_LENGTH);
    case PE_SHAPE_HULL:
    case PE_SHAPE_MESH:
        return PE_OK; /* checked when it was made */
    case PE_SHAPE_COUNT:
        break;
    }
    return pe_fail(error, PE_BAD_ARGUMENT, "unknown shape kind %d", (int)shape->kind);
}
