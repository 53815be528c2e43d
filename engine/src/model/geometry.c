/* Geometries: made from the caller's triangles, and owned by the world. */
#include "geometry.h"

#include "geometry_build.h"
#include "ranges.h"
#include "world.h"

/* Room for indices of corners: three a triangle. */
enum { MOST_TRIANGLES = 1 << 28 };

static pe_status check_def(const pe_geometry_def *def, pe_error *error)
{
    if (def->vertex_count < 4 || def->triangle_count < 4 || def->triangle_count > MOST_TRIANGLES) {
        return pe_fail(error, PE_BAD_ARGUMENT,
                       "geometry: expected 4 vertices and 4 triangles at least, found %d and %d",
                       def->vertex_count, def->triangle_count);
    }
    for (int i = 0; i < def->vertex_count; ++i) {
        const pe_vec3 v = def->vertices[i];
        if (!pe_is_within(v, PE_MOST_LENGTH)) {
            return pe_fail(error, PE_BAD_ARGUMENT,
                           "geometry: vertex %d: expected finite numbers of at most %g, found "
                           "(%g, %g, %g)",
                           i, PE_MOST_LENGTH, v.x, v.y, v.z);
        }
    }
    for (int i = 0; i < def->triangle_count; ++i) {
        const uint32_t *t = def->triangles[i], n = (uint32_t)def->vertex_count;
        if (t[0] >= n || t[1] >= n || t[2] >= n || t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
            return pe_fail(error, PE_BAD_ARGUMENT,
                           "geometry: triangle %d: expected three vertices of %u, found %u, %u, %u",
                           i, n, t[0], t[1], t[2]);
        }
    }
    return PE_OK;
}

/* Copies the triangles, and the vertices in the body's axes. */
static pe_status copy_def(pe_geometry *g, const pe_geometry_def *def, const pe_allocator *allocator,
                          pe_error *error)
{
    size_t vertices = (size_t)def->vertex_count, triangles = (size_t)def->triangle_count;
    g->vertices = pe_arena_take(&g->arena, allocator, vertices, sizeof *g->vertices);
    g->triangles = pe_arena_take(&g->arena, allocator, triangles, sizeof *g->triangles);
    if (g->vertices == NULL || g->triangles == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for a geometry of %d triangles",
                       def->triangle_count);
    }
    g->vertex_count = def->vertex_count;
    g->triangle_count = def->triangle_count;
    for (int i = 0; i < def->triangle_count; ++i) {
        for (int k = 0; k < 3; ++k) {
            g->triangles[i][k] = (int)def->triangles[i][k];
        }
    }
    pe_vec3 low = pe_v3(HUGE_VAL, HUGE_VAL, HUGE_VAL), high = pe_scale(-1, low);
    for (int i = 0; i < def->vertex_count; ++i) {
        pe_vec3 v = pe_unrotate(&g->rotation, pe_sub(def->vertices[i], g->frame.centre));
        g->vertices[i] = v;
        g->bounding_radius = pe_max(g->bounding_radius, pe_length(v));
        low = pe_v3(pe_min(low.x, v.x), pe_min(low.y, v.y), pe_min(low.z, v.z));
        high = pe_v3(pe_max(high.x, v.x), pe_max(high.y, v.y), pe_max(high.z, v.z));
    }
    g->box_centre = pe_scale(0.5, pe_add(low, high));
    g->box_half = pe_scale(0.5, pe_sub(high, low));
    g->size = pe_min(g->box_half.x, pe_min(g->box_half.y, g->box_half.z));
    return PE_OK;
}

/* Fills *g, which is zero; on an error its arena may hold memory. */
static pe_status make(pe_geometry *g, const pe_geometry_def *def, const pe_allocator *allocator,
                      pe_workspace work, pe_error *error)
{
    g->frame = pe_geometry_mass(def);
    const double least = PE_LEAST_LENGTH * PE_LEAST_LENGTH * PE_LEAST_LENGTH;
    if (!(g->frame.volume >= least)) {
        return pe_fail(error, PE_BAD_ARGUMENT,
                       "geometry: expected triangles counter-clockwise seen from outside, around a "
                       "volume of at least %g m^3 that is more than the rounding of their corners; "
                       "they hold a volume of %g",
                       least, g->frame.volume);
    }
    g->rotation = pe_matrix_of(g->frame.orientation);
    pe_status status = copy_def(g, def, allocator, error);
    if (status == PE_OK) {
        status = pe_geometry_find_surface(g, def->convex, allocator, work, error);
    }
    return status == PE_OK ? pe_geometry_make_tree(g, allocator, work, error) : status;
}

pe_status pe_geometry_make(const pe_geometry_def *def, const pe_allocator *allocator,
                           pe_geometry **geometry, pe_error *error)
{
    *geometry = NULL;
    pe_status status = check_def(def, error);
    if (status != PE_OK) {
        return status;
    }
    pe_geometry *made = allocator->allocate(allocator->context, sizeof *made);
    if (made == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for a geometry");
    }
    *made = (pe_geometry){0};
    pe_arena scratch = {0};
    status = make(made, def, allocator, (pe_workspace){&scratch, allocator, NULL}, error);
    pe_arena_free(&scratch, allocator);
    if (status != PE_OK) {
        pe_geometry_free(made, allocator);
        return status;
    }
    *geometry = made;
    return PE_OK;
}

void pe_geometry_free(pe_geometry *geometry, const pe_allocator *allocator)
{
    if (geometry != NULL) {
        pe_arena_free(&geometry->arena, allocator);
        allocator->release(allocator->context, geometry);
    }
}

const pe_geometry *pe_geometry_of(const struct pe_world *world, pe_geometry_id id)
{
    bool known = id.index > 0 && id.index <= (uint32_t)world->geometry_count;
    return known ? ((pe_geometry **)world->geometry_array.items)[id.index - 1] : NULL;
}

pe_status pe_geometry_create(pe_world *world, const pe_geometry_def *def, pe_geometry_id *geometry,
                             pe_error *error)
{
    *geometry = (pe_geometry_id){0};
    size_t count = (size_t)world->geometry_count;
    pe_status status = pe_array_reserve(&world->geometry_array, &world->allocator,
                                        sizeof(pe_geometry *), count + 1, count, error);
    pe_geometry *made = NULL;
    if (status == PE_OK) {
        status = pe_geometry_make(def, &world->allocator, &made, error);
    }
    if (status == PE_OK) {
        ((pe_geometry **)world->geometry_array.items)[count] = made;
        world->geometry_count += 1;
        *geometry = (pe_geometry_id){(uint32_t)world->geometry_count};
    }
    return status;
}

pe_status pe_geometry_get_frame(const pe_world *world, pe_geometry_id geometry,
                                pe_geometry_frame *frame, pe_error *error)
{
    const pe_geometry *g = pe_geometry_of(world, geometry);
    if (g == NULL) {
        return pe_fail(error, PE_BAD_ARGUMENT, "no geometry %u in this world", geometry.index);
    }
    *frame = g->frame;
    return PE_OK;
}
