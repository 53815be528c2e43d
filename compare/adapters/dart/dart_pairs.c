#include "dart_pairs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void pl_dart_pairs_free(pl_dart_pairs *pairs)
{
    free(pairs->touch);
    free(pairs->stored);
    memset(pairs, 0, sizeof *pairs);
}

/* Which materials can touch: those of two different bodies that are not both static. False: no memory. */
static bool find_touching(const pl_scene *scene, pl_dart_pairs *pairs)
{
    const int count = pairs->material_count;
    int *bodies = calloc(2 * (size_t)count + 1, sizeof *bodies);
    if (bodies == NULL) {
        return false;
    }
    int *moving = bodies + count;
    for (int i = 0; i < scene->body_count; ++i) {
        ++bodies[scene->bodies[i].material];
        moving[scene->bodies[i].material] += scene->bodies[i].is_static ? 0 : 1;
    }
    for (int a = 0; a < count; ++a) {
        for (int b = 0; b < count; ++b) {
            pairs->touch[a * count + b] =
                a == b ? moving[a] > 0 && bodies[a] > 1
                       : (moving[a] > 0 && bodies[b] > 0) || (moving[b] > 0 && bodies[a] > 0);
        }
    }
    free(bodies);
    return true;
}

/* Stores for each material the largest friction of its pairs: if any numbers have these pairs as
 * their minima, those do. Restitution: the root of that of all pairs, when it is the same. */
static bool store_by_material(const pl_engine_setup *setup, pl_dart_pairs *pairs)
{
    const int count = pairs->material_count;
    double restitution = -1;
    for (int a = 0; a < count; ++a) {
        double friction = 0;
        for (int b = 0; b < count; ++b) {
            const pl_pair_coefficients pair = setup->pairs[a * count + b];
            if (pl_dart_can_touch(pairs, a, b)) {
                friction = fmax(friction, pair.friction);
                if (restitution >= 0 && pair.restitution != restitution) {
                    return false;
                }
                restitution = pair.restitution;
            }
        }
        for (int b = 0; b < count; ++b) {
            pairs->stored[a * count + b].friction = friction;
        }
    }
    for (int a = 0; a < count; ++a) {
        for (int b = 0; b < count; ++b) {
            const double lesser =
                fmin(pl_dart_stored(pairs, a, 0).friction, pl_dart_stored(pairs, b, 0).friction);
            if (pl_dart_can_touch(pairs, a, b) && lesser != setup->pairs[a * count + b].friction) {
                return false;
            }
            pairs->stored[a * count + b].restitution = sqrt(fmax(restitution, 0));
        }
    }
    return true;
}

/* Two shapes that are meant for each other: one has the restitution, the other 1. */
static void store_by_partner(const pl_engine_setup *setup, pl_dart_pairs *pairs)
{
    const int count = pairs->material_count;
    for (int a = 0; a < count; ++a) {
        for (int b = 0; b < count; ++b) {
            const pl_pair_coefficients pair = setup->pairs[a * count + b];
            pl_pair_coefficients *stored = &pairs->stored[a * count + b];
            stored->friction = pair.friction;
            stored->restitution = a < b ? pair.restitution : a == b ? sqrt(pair.restitution) : 1;
        }
    }
}

pl_status pl_dart_pairs_of(const pl_engine_setup *setup, pl_dart_pairs *pairs)
{
    const int count = setup->scene->material_count;
    const size_t squared = (size_t)count * (size_t)count;
    memset(pairs, 0, sizeof *pairs);
    pairs->material_count = count;
    pairs->touch = calloc(squared + 1, sizeof *pairs->touch);
    pairs->stored = calloc(squared + 1, sizeof *pairs->stored);
    if (pairs->touch == NULL || pairs->stored == NULL || !find_touching(setup->scene, pairs)) {
        pl_dart_pairs_free(pairs);
        return PL_NO_MEMORY;
    }
    pairs->by_partner = !store_by_material(setup, pairs);
    if (pairs->by_partner) {
        store_by_partner(setup, pairs);
    }
    return PL_OK;
}
