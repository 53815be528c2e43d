#include "parameter_check.h"

#include "base/statistics.h"
#include "plumb/scenario.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* |found - asked| <= 1e-12 scale; a NaN differs. */
static bool agrees(double found, double asked, double scale)
{
    return fabs(found - asked) <= 1e-12 * fabs(scale);
}

static pl_status differs(const char *what, double found, double asked, pl_error *error)
{
    return pl_fail(error, PL_UNSUPPORTED, "%s: the scene has %.17g, the engine %.17g", what, asked,
                   found);
}

static pl_status check_body(const pl_body *body, double mass, const double inertia[3],
                            pl_error *error)
{
    char what[PL_NAME_SIZE + 32];
    if (body->is_static) {
        return PL_OK;
    }
    if (!agrees(mass, body->mass, body->mass)) {
        snprintf(what, sizeof what, "mass of %s, kg", body->name);
        return differs(what, mass, body->mass, error);
    }
    double asked[3];
    double found[3];
    memcpy(asked, body->inertia, sizeof asked);
    memcpy(found, inertia, sizeof found);
    pl_sort_numbers(asked, 3);
    pl_sort_numbers(found, 3);
    for (int i = 0; i < 3; ++i) {
        if (!agrees(found[i], asked[i], asked[i])) {
            snprintf(what, sizeof what, "principal inertia of %s, kg m^2", body->name);
            return differs(what, found[i], asked[i], error);
        }
    }
    return PL_OK;
}

static pl_status check_gravity(const pl_scene *scene, const pl_engine_settings *settings,
                               pl_error *error)
{
    const double *g = scene->gravity;
    double size = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    for (int i = 0; i < 3; ++i) {
        if (!agrees(settings->gravity[i], g[i], size)) {
            static const char *const names[3] = {"gravity x, m/s^2", "gravity y, m/s^2",
                                                 "gravity z, m/s^2"};
            return differs(names[i], settings->gravity[i], g[i], error);
        }
    }
    return PL_OK;
}

static pl_status check_pair(const pl_scene *scene, const pl_engine *engine,
                            const pl_engine_instance *instance, int body_a, int body_b,
                            pl_error *error)
{
    const pl_body *a = &scene->bodies[body_a];
    const pl_body *b = &scene->bodies[body_b];
    double asked[2];
    double found[2] = {NAN, NAN};
    pl_scene_pair(scene, a->material, b->material, &asked[0], &asked[1]);
    engine->read_pair(instance, body_a, body_b, &found[0], &found[1]);
    for (int i = 0; i < 2; ++i) {
        if (!agrees(found[i], asked[i], asked[i])) {
            char what[2 * PL_NAME_SIZE + 32];
            snprintf(what, sizeof what, "%s between %s and %s", i == 0 ? "friction" : "restitution",
                     a->name, b->name);
            return differs(what, found[i], asked[i], error);
        }
    }
    return PL_OK;
}

/* The first bodies of each material, which stand for all of it. -1: none. */
typedef struct representatives {
    int first_dynamic, second_dynamic, first_static;
} representatives;

static void find_representatives(const pl_scene *scene, representatives *of)
{
    for (int m = 0; m < scene->material_count; ++m) {
        of[m] = (representatives){-1, -1, -1};
    }
    for (int i = 0; i < scene->body_count; ++i) {
        representatives *r = &of[scene->bodies[i].material];
        if (scene->bodies[i].is_static) {
            r->first_static = r->first_static < 0 ? i : r->first_static;
        } else if (r->first_dynamic < 0) {
            r->first_dynamic = i;
        } else if (r->second_dynamic < 0) {
            r->second_dynamic = i;
        }
    }
}

/* Dynamic against dynamic and dynamic against static, where the scene has them. */
static pl_status check_pairs(const pl_scene *scene, const pl_engine *engine,
                             const pl_engine_instance *instance, pl_error *error)
{
    representatives *of = calloc((size_t)scene->material_count + 1, sizeof *of);
    if (of == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    find_representatives(scene, of);
    pl_status status = PL_OK;
    for (int m = 0; m < scene->material_count; ++m) {
        for (int n = m; n < scene->material_count; ++n) {
            const int pairs[3][2] = {
                {of[m].first_dynamic, m == n ? of[n].second_dynamic : of[n].first_dynamic},
                {of[m].first_dynamic, of[n].first_static},
                {of[n].first_dynamic, of[m].first_static},
            };
            for (int k = 0; k < 3 && status == PL_OK; ++k) {
                if (pairs[k][0] >= 0 && pairs[k][1] >= 0) {
                    status = check_pair(scene, engine, instance, pairs[k][0], pairs[k][1], error);
                }
            }
        }
    }
    free(of);
    return status;
}

pl_status pl_parameter_check(const pl_scene *scene, const pl_engine *engine,
                             const pl_engine_instance *instance, pl_error *error)
{
    size_t count = (size_t)scene->body_count;
    pl_engine_settings settings = {.dt = NAN, .body_count = scene->body_count};
    pl_status status = PL_OK;
    settings.mass = calloc(count + 1, sizeof *settings.mass);
    settings.inertia = calloc(count + 1, sizeof *settings.inertia);
    if (settings.mass == NULL || settings.inertia == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory");
        goto cleanup;
    }
    engine->read_settings(instance, scene->dt, &settings);
    if (!agrees(settings.dt, scene->dt, scene->dt)) {
        status = differs("step, s", settings.dt, scene->dt, error);
        goto cleanup;
    }
    status = check_gravity(scene, &settings, error);
    for (int i = 0; i < scene->body_count && status == PL_OK; ++i) {
        status = check_body(&scene->bodies[i], settings.mass[i], settings.inertia[i], error);
    }
    if (status == PL_OK) {
        status = check_pairs(scene, engine, instance, error);
    }

cleanup:
    free(settings.mass);
    free(settings.inertia);
    return status;
}

pl_status pl_needs_check(const pl_scene *scene, const pl_engine *engine, pl_error *error)
{
    uint32_t missing = pl_scene_needs(scene) & ~engine->capabilities;
    char names[256] = "";
    for (uint32_t bit = 1; bit != 0; bit <<= 1) {
        if ((missing & bit) != 0) {
            const char *name = pl_needs_name(bit);
            size_t used = strlen(names);
            snprintf(names + used, sizeof names - used, "%s%s", used == 0 ? "" : ", ",
                     name == NULL ? "something unknown" : name);
        }
    }
    return missing == 0 ? PL_OK
                        : pl_fail(error, PL_UNSUPPORTED, "%s lacks %s", engine->name, names);
}
