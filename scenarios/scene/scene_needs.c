/* What a scene needs of an engine, from the scene alone. */
#include "plumb/scenario.h"

#include <string.h>

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
    for (int i = 0; i < scene->body_count; i++) {
        const pl_body *body = &scene->bodies[i];
        unsigned char *count = body->is_static ? use->fixed : use->moving;
        if (count[body->material] < 2) {
            count[body->material]++;
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
    for (int a = 0; a < scene->material_count; a++) {
        for (int b = 0; b <= a; b++) {
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
    for (int i = 0; i < scene->body_count; i++) {
        const pl_body *body = &scene->bodies[i];
        needs |= (uint32_t)PL_NEEDS_PLANE << body->shape.kind;
        needs |= may_turn(body, has_friction, scene->body_count > 1) ? PL_NEEDS_ROTATION : 0u;
    }
    for (int i = 0; i < scene->force_count; i++) {
        needs |= PL_NEEDS_FORCES;
        needs |= is_zero(scene->forces[i].at) ? 0u : PL_NEEDS_ROTATION;
    }
    return needs;
}

const char *pl_needs_name(uint32_t bit)
{
    switch (bit) {
    case PL_NEEDS_FRICTION:
        return "friction";
    case PL_NEEDS_RESTITUTION:
        return "restitution";
    case PL_NEEDS_ROTATION:
        return "rotation";
    case PL_NEEDS_FORCES:
        return "forces";
    case PL_NEEDS_PLANE:
        return "plane";
    case PL_NEEDS_SPHERE:
        return "sphere";
    case PL_NEEDS_BOX:
        return "box";
    case PL_NEEDS_CAPSULE:
        return "capsule";
    case PL_NEEDS_CYLINDER:
        return "cylinder";
    case PL_NEEDS_HULL:
        return "hull";
    case PL_NEEDS_MESH:
        return "mesh";
    default:
        return NULL;
    }
}
