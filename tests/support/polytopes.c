/* Hulls of forms, and random shapes. */
#include "polytopes.h"

placed_shape hull_of_form(const form *f)
{
    pe_allocator allocator = pe_allocator_default();
    pe_geometry_def def = {.vertices = f->vertices,
                           .triangles = f->triangles,
                           .vertex_count = f->vertex_count,
                           .triangle_count = f->triangle_count,
                           .convex = true};
    placed_shape b = {.shape = {.kind = PE_SHAPE_HULL}};
    pe_error error = {0};
    if (pe_geometry_make(&def, &allocator, &b.geometry, &error) != PE_OK) {
        fail_msg("%s", error.message);
    }
    place(&b, b.geometry->frame.centre, b.geometry->frame.orientation);
    return b;
}

void release_hull(placed_shape *b)
{
    pe_allocator allocator = pe_allocator_default();
    pe_geometry_free(b->geometry, &allocator);
    b->geometry = NULL;
}

placed_shape hull_prism(int n, double radius, double half, double shear)
{
    form f = form_frustum(n, 1, shear / radius);
    form_scale(&f, pe_v3(radius, radius, half));
    return hull_of_form(&f);
}

placed_shape box_of(double x, double y, double z)
{
    return (placed_shape){.shape = {.kind = PE_SHAPE_BOX, .half_extents = {x, y, z}}};
}

placed_shape capsule_of(double radius, double half)
{
    return (placed_shape){
        .shape = {.kind = PE_SHAPE_CAPSULE, .radius = radius, .half_height = half}};
}

placed_shape hull_box(double x, double y, double z)
{
    form f = form_cube();
    form_scale(&f, pe_v3(x, y, z));
    return hull_of_form(&f);
}

static placed_shape random_hull(check_random *random)
{
    int count = 4 + (int)check_uniform(random, 0, 14);
    pe_vec3 stretch = random_vector_in(random, 0.3, 1.5), points[18];
    for (int i = 0; i < count; ++i) {
        pe_vec3 v = random_vector_in(random, -1, 1);
        points[i] = pe_mul(stretch, pe_scale(1 / pe_length(v), v));
    }
    form f = form_hull(points, count);
    return hull_of_form(&f);
}

/* Numbers are drawn one after another, for C does not define the order of arguments. */
placed_shape random_solid(check_random *random, int kind)
{
    pe_vec3 x = random_vector_in(random, 0, 1);
    int sides = 3 + (int)check_uniform(random, 0, 6);
    switch (kind) {
    case SOLID_SPHERE:
        return (placed_shape){.shape = {.kind = PE_SHAPE_SPHERE, .radius = 0.2 + 0.6 * x.x}};
    case SOLID_CAPSULE:
        return capsule_of(0.1 + 0.7 * x.x, 0.1 + 1.4 * x.y);
    case SOLID_BOX:
        return box_of(0.1 + 1.1 * x.x, 0.1 + 1.1 * x.y, 0.1 + 1.1 * x.z);
    case SOLID_PRISM:
        return hull_prism(sides, 0.3 + 0.7 * x.x, 0.1 + 0.9 * x.y, 0.5 * x.z);
    default:
        return random_hull(random);
    }
}

void place_at_random(placed_shape *b, check_random *random)
{
    pe_vec3 x = random_vector_in(random, -1, 1);
    place(b, x, random_turn(random));
}
