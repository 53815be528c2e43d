/* The scene: defaults, growth, and what follows from its numbers.
 *
 * Arrays double whenever they are full, and carry no capacity of their own: an array of `count`
 * items has room for the next power of two, and for FIRST_CAPACITY at least, so it is full when
 * `count` is such a number. Appending is amortised constant time. */
#include "polyhedron.h"
#include "scene_array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_CAPACITY = 8 };

pl_scene pl_scene_default(void)
{
    return (pl_scene){.gravity = {0, 0, -9.81},
                      .dt = 1.0 / 60,
                      .duration = 5,
                      .collapse_distance = (double)INFINITY};
}

pl_body pl_body_default(void)
{
    return (pl_body){.mass = 1, .orientation = {1, 0, 0, 0}};
}

pl_expect_value pl_expect_value_default(const pl_scene *scene)
{
    return (pl_expect_value){.direction = {0, 0, 1},
                             .until = (double)pl_scene_steps(scene) * scene->dt,
                             .discrete = (double)NAN,
                             .scale = 1};
}

void pl_scene_free(pl_scene *scene)
{
    if (scene == NULL) {
        return;
    }
    free(scene->materials);
    free(scene->pairs);
    for (int i = 0; i < scene->polyhedron_count; i++) {
        pl_polyhedron_free(scene->polyhedra[i]);
    }
    free(scene->polyhedra);
    free(scene->bodies);
    free(scene->forces);
    free(scene->rests);
    free(scene->travels);
    free(scene->values);
    *scene = pl_scene_default();
}

/* Appends a copy of `item` to an array of `*count` items; returns the array, which may have moved,
 * or NULL when out of memory, the old one then being as it was. */
static void *append(void *items, int *count, const void *item, size_t size, pl_error *error)
{
    size_t used = (size_t)*count;
    bool full = used == 0 || (used >= FIRST_CAPACITY && (used & (used - 1)) == 0);
    if (full) {
        size_t capacity = used == 0 ? FIRST_CAPACITY : 2 * used;
        void *grown = used > INT32_MAX / 4 ? NULL : realloc(items, capacity * size);
        if (grown == NULL) {
            pl_fail(error, PL_NO_MEMORY, "out of memory for %zu scene items of %zu bytes", capacity,
                    size);
            return NULL;
        }
        items = grown;
    }
    memcpy((char *)items + used * size, item, size);
    *count += 1;
    return items;
}

pl_status pl_scene_add_material(pl_scene *scene, const pl_material *item, int *index,
                                pl_error *error)
{
    if (scene->material_count >= PL_MAX_MATERIALS) {
        return pl_fail(error, PL_BAD_INPUT, "material %.*s: expected at most %d materials",
                       PL_NAME_SIZE - 1, item->name, PL_MAX_MATERIALS);
    }
    pl_material *grown =
        append(scene->materials, &scene->material_count, item, sizeof *item, error);
    if (grown == NULL) {
        return PL_NO_MEMORY;
    }
    scene->materials = grown;
    if (index != NULL) {
        *index = scene->material_count - 1;
    }
    return PL_OK;
}

pl_status pl_scene_add_pair(pl_scene *scene, const pl_material_pair *item, pl_error *error)
{
    pl_material_pair *grown = append(scene->pairs, &scene->pair_count, item, sizeof *item, error);
    if (grown == NULL) {
        return PL_NO_MEMORY;
    }
    scene->pairs = grown;
    return PL_OK;
}

pl_status pl_scene_add_polyhedron(pl_scene *scene, pl_polyhedron *polyhedron, pl_error *error)
{
    pl_polyhedron **grown = append(scene->polyhedra, &scene->polyhedron_count, &polyhedron,
                                   sizeof(pl_polyhedron *), error);
    if (grown == NULL) {
        return PL_NO_MEMORY;
    }
    scene->polyhedra = grown;
    return PL_OK;
}

/* The body with every field that has no meaning for it zeroed, and its inertia filled in. */
static pl_body normal_form(const pl_body *item)
{
    pl_body body = *item;
    if (body.is_static) {
        body.mass = 0;
        memset(body.inertia, 0, sizeof body.inertia);
    } else if (body.inertia[0] == 0 && body.inertia[1] == 0 && body.inertia[2] == 0) {
        pl_shape_inertia(&body.shape, body.mass, body.inertia);
    }
    if (body.shape.kind == PL_SHAPE_PLANE) {
        const pl_body unplaced = pl_body_default();
        memcpy(body.position, unplaced.position, sizeof body.position);
        memcpy(body.orientation, unplaced.orientation, sizeof body.orientation);
    }
    return body;
}

pl_status pl_scene_add_body(pl_scene *scene, const pl_body *item, int *index, pl_error *error)
{
    const pl_body body = normal_form(item);
    pl_body *grown = append(scene->bodies, &scene->body_count, &body, sizeof body, error);
    if (grown == NULL) {
        return PL_NO_MEMORY;
    }
    scene->bodies = grown;
    if (index != NULL) {
        *index = scene->body_count - 1;
    }
    return PL_OK;
}

pl_status pl_scene_add_force(pl_scene *scene, const pl_force *item, pl_error *error)
{
    pl_force *grown = append(scene->forces, &scene->force_count, item, sizeof *item, error);
    if (grown == NULL) {
        return PL_NO_MEMORY;
    }
    scene->forces = grown;
    return PL_OK;
}

pl_status pl_scene_add_rest(pl_scene *scene, const pl_expect_rest *item, pl_error *error)
{
    pl_expect_rest *grown = append(scene->rests, &scene->rest_count, item, sizeof *item, error);
    if (grown == NULL) {
        return PL_NO_MEMORY;
    }
    scene->rests = grown;
    return PL_OK;
}

pl_status pl_scene_add_travel(pl_scene *scene, const pl_expect_travel *item, pl_error *error)
{
    pl_expect_travel *grown =
        append(scene->travels, &scene->travel_count, item, sizeof *item, error);
    if (grown == NULL) {
        return PL_NO_MEMORY;
    }
    scene->travels = grown;
    return PL_OK;
}

pl_status pl_scene_add_value(pl_scene *scene, const pl_expect_value *item, pl_error *error)
{
    pl_expect_value *grown = append(scene->values, &scene->value_count, item, sizeof *item, error);
    if (grown == NULL) {
        return PL_NO_MEMORY;
    }
    scene->values = grown;
    return PL_OK;
}

void pl_scene_pair(const pl_scene *scene, int material_a, int material_b, double *friction,
                   double *restitution)
{
    for (int i = 0; i < scene->pair_count; i++) {
        const pl_material_pair *pair = &scene->pairs[i];
        if ((pair->material_a == material_a && pair->material_b == material_b) ||
            (pair->material_a == material_b && pair->material_b == material_a)) {
            *friction = pair->friction;
            *restitution = pair->restitution;
            return;
        }
    }
    const pl_material *a = &scene->materials[material_a];
    const pl_material *b = &scene->materials[material_b];
    /* The root of a square may be off by rounding; a material against itself has its own value. */
    *friction = a->friction == b->friction ? a->friction : sqrt(a->friction) * sqrt(b->friction);
    *restitution = fmax(a->restitution, b->restitution);
}

long pl_scene_steps(const pl_scene *scene)
{
    return lround(scene->duration / scene->dt);
}
