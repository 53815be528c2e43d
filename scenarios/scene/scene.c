/* The scene: defaults, growth, mixing of materials, and the features that it needs of an engine. */
#include "base/array.h"
#include "plumb/scenario.h"
#include "scene_fields.h"
#include "scene_internal.h"
#include "solids/polyhedron.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

pl_scene pl_scene_default(void)
{
    return *(const pl_scene *)pl_objects[PL_OBJECT_SCENE].defaults;
}

pl_body pl_body_default(void)
{
    return *(const pl_body *)pl_objects[PL_OBJECT_BODY].defaults;
}

pl_expect_value pl_expect_value_default(const pl_scene *scene)
{
    pl_expect_value value = *(const pl_expect_value *)pl_objects[PL_OBJECT_VALUE].defaults;
    value.until = (double)pl_scene_steps(scene) * scene->dt;
    return value;
}

void pl_scene_free(pl_scene *scene)
{
    if (scene == NULL) {
        return;
    }
    free(scene->materials);
    free(scene->pairs);
    for (int i = 0; i < scene->polyhedron_count; ++i) {
        pl_polyhedron_free(scene->polyhedra[i]);
    }
    free(scene->polyhedra);
    free(scene->bodies);
    free(scene->forces);
    free(scene->rests);
    free(scene->travels);
    free(scene->values);
    free(scene->statistics);
    *scene = pl_scene_default();
}

pl_status pl_scene_add_material(pl_scene *scene, const pl_material *item, int *index,
                                pl_error *error)
{
    if (scene->material_count >= PL_MAX_MATERIALS) {
        return pl_fail(error, PL_BAD_INPUT, "material %.*s: expected at most %d materials",
                       PL_NAME_SIZE - 1, item->name, PL_MAX_MATERIALS);
    }
    const pl_status status =
        pl_array_push(&scene->materials, &scene->material_count, item, sizeof *item, error);
    if (status == PL_OK && index != NULL) {
        *index = scene->material_count - 1;
    }
    return status;
}

int pl_scene_find_material(const pl_scene *scene, const char *name)
{
    for (int i = 0; i < scene->material_count; ++i) {
        if (strcmp(scene->materials[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

pl_status pl_scene_add_pair(pl_scene *scene, const pl_material_pair *item, pl_error *error)
{
    return pl_array_push(&scene->pairs, &scene->pair_count, item, sizeof *item, error);
}

pl_status pl_scene_add_polyhedron(pl_scene *scene, pl_polyhedron *polyhedron, pl_error *error)
{
    return pl_array_push(&scene->polyhedra, &scene->polyhedron_count, &polyhedron,
                         sizeof(pl_polyhedron *), error);
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
    const pl_status status =
        pl_array_push(&scene->bodies, &scene->body_count, &body, sizeof body, error);
    if (status == PL_OK && index != NULL) {
        *index = scene->body_count - 1;
    }
    return status;
}

pl_status pl_scene_add_force(pl_scene *scene, const pl_force *item, pl_error *error)
{
    return pl_array_push(&scene->forces, &scene->force_count, item, sizeof *item, error);
}

pl_status pl_scene_add_rest(pl_scene *scene, const pl_expect_rest *item, pl_error *error)
{
    return pl_array_push(&scene->rests, &scene->rest_count, item, sizeof *item, error);
}

pl_status pl_scene_add_travel(pl_scene *scene, const pl_expect_travel *item, pl_error *error)
{
    return pl_array_push(&scene->travels, &scene->travel_count, item, sizeof *item, error);
}

pl_status pl_scene_add_value(pl_scene *scene, const pl_expect_value *item, pl_error *error)
{
    return pl_array_push(&scene->values, &scene->value_count, item, sizeof *item, error);
}

pl_status pl_scene_add_statistic(pl_scene *scene, const pl_expect_statistic *item, pl_error *error)
{
    return pl_array_push(&scene->statistics, &scene->statistic_count, item, sizeof *item, error);
}

void pl_scene_pair(const pl_scene *scene, int material_a, int material_b, double *friction,
                   double *restitution)
{
    for (int i = 0; i < scene->pair_count; ++i) {
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

/* ---- Needs ---- */

static bool is_zero(const double vector[3])
{
    return vector[0] == 0 && vector[1] == 0 && vector[2] == 0;
}

/* How many moving and how many static bodies each material has, counted to 2: more make no
 * difference. */
typedef struct material_use {
    unsigned char moving[PL_MAX_MATERIALS], fixed[PL_MAX_MATERIALS];
} material_use;

static void count_use(const pl_scene *scene, material_use *use)
{
    memset(use, 0, sizeof *use);
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        unsigned char *count = body->is_static ? use->fixed : use->moving;
        if (count[body->material] < 2) {
            ++count[body->material];
        }
    }
}

/* Whether two bodies of these materials can touch, one of them moving. */
static bool can_touch(const material_use *use, int a, int b)
{
    if (a == b) {
        return use->moving[a] > 0 && use->moving[a] + use->fixed[a] > 1;
    }
    return (use->moving[a] > 0 && use->moving[b] + use->fixed[b] > 0) ||
           (use->fixed[a] > 0 && use->moving[b] > 0);
}

static uint32_t needs_of_pairs(const pl_scene *scene)
{
    material_use use;
    count_use(scene, &use);
    uint32_t needs = 0;
    for (int a = 0; a < scene->material_count; ++a) {
        for (int b = 0; b <= a; ++b) {
            double friction, restitution;
            if (!can_touch(&use, a, b)) {
                continue;
            }
            pl_scene_pair(scene, a, b, &friction, &restitution);
            needs |= friction > 0 ? PL_NEEDS_FRICTION : 0u;
            needs |= restitution > 0 ? PL_NEEDS_RESTITUTION : 0u;
        }
    }
    return needs;
}

/* A moving body turns when anything touches it, a sphere only by friction, since its contact forces
 * else pass through its centre; any when it spins already or a force acts off the centre. */
static bool may_turn(const pl_body *body, bool has_friction, bool has_others)
{
    if (body->is_static) {
        return false;
    }
    bool by_contact = body->shape.kind == PL_SHAPE_SPHERE ? has_friction : has_others;
    return by_contact || !is_zero(body->angular_velocity);
}

uint32_t pl_scene_needs(const pl_scene *scene)
{
    uint32_t needs = needs_of_pairs(scene);
    bool has_friction = (needs & PL_NEEDS_FRICTION) != 0;
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        needs |= (uint32_t)PL_NEEDS_PLANE << body->shape.kind;
        needs |= may_turn(body, has_friction, scene->body_count > 1) ? PL_NEEDS_ROTATION : 0u;
    }
    for (int i = 0; i < scene->force_count; ++i) {
        needs |= PL_NEEDS_FORCES;
        needs |= is_zero(scene->forces[i].at) ? 0u : PL_NEEDS_ROTATION;
    }
    return needs;
}

const char *pl_needs_name(uint32_t bit)
{
    static const char *const names[] = {"friction", "restitution", "rotation", "forces"};
    for (int i = 0; i < 4; ++i) {
        if (bit == 1u << i) {
            return names[i];
        }
    }
    for (int i = 0; i < PL_SHAPE_KIND_COUNT; ++i) {
        if (bit == (uint32_t)PL_NEEDS_PLANE << i) {
            return pl_shape_names[i];
        }
    }
    return NULL;
}
