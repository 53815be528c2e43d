#include "parameter_check.h"

#include "base/heap.h"
#include "base/statistics.h"
#include "plumb/scenario.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A check in progress. */
typedef struct check {
    pl_session *session;
    const pl_scene *scene;
    double tolerance;  /* relative */
    unsigned compared; /* bits 1 << pl_read_back */
} check;

/* |found - asked| <= tolerance scale. A NaN is not compared: the engine does not say. */
static bool agrees(check *c, pl_read_back what, double found, double asked, double scale)
{
    if (isnan(found)) {
        return true;
    }
    c->compared |= 1u << what;
    return fabs(found - asked) <= c->tolerance * fabs(scale);
}

static pl_status differs(const char *what, double found, double asked, pl_error *error)
{
    return pl_fail(error, PL_UNSUPPORTED, "%s: the scene has %.17g, the engine %.17g", what, asked,
                   found);
}

static pl_status check_body(check *c, const pl_body *body, double mass, const double inertia[3],
                            pl_error *error)
{
    char what[PL_NAME_SIZE + 32];
    if (body->is_static) {
        return PL_OK;
    }
    if (!agrees(c, PL_READ_BACK_MASS, mass, body->mass, body->mass)) {
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
        if (!agrees(c, PL_READ_BACK_INERTIA, found[i], asked[i], asked[i])) {
            snprintf(what, sizeof what, "principal inertia of %s, kg m^2", body->name);
            return differs(what, found[i], asked[i], error);
        }
    }
    return PL_OK;
}

static pl_status check_gravity(check *c, const pl_engine_settings *settings, pl_error *error)
{
    const double *g = c->scene->gravity;
    double size = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    for (int i = 0; i < 3; ++i) {
        if (!agrees(c, PL_READ_BACK_GRAVITY, settings->gravity[i], g[i], size)) {
            static const char *const names[3] = {"gravity x, m/s^2", "gravity y, m/s^2",
                                                 "gravity z, m/s^2"};
            return differs(names[i], settings->gravity[i], g[i], error);
        }
    }
    return PL_OK;
}

static pl_status check_pair(check *c, int body_a, int body_b, pl_error *error)
{
    const pl_body *a = &c->scene->bodies[body_a];
    const pl_body *b = &c->scene->bodies[body_b];
    double asked[2];
    pl_scene_pair(c->scene, a->material, b->material, &asked[0], &asked[1]);
    const pl_pair_coefficients pair = pl_session_read_pair(c->session, body_a, body_b);
    const double found[2] = {pair.friction, pair.restitution};
    for (int i = 0; i < 2; ++i) {
        const pl_read_back what = i == 0 ? PL_READ_BACK_FRICTION : PL_READ_BACK_RESTITUTION;
        if (!agrees(c, what, found[i], asked[i], asked[i])) {
            char text[2 * PL_NAME_SIZE + 32];
            snprintf(text, sizeof text, "%s between %s and %s", pl_read_back_name(what), a->name,
                     b->name);
            return differs(text, found[i], asked[i], error);
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
static pl_status check_pairs(check *c, pl_error *error)
{
    const pl_scene *scene = c->scene;
    representatives *of = pl_heap_new((size_t)scene->material_count, sizeof *of);
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
                    status = check_pair(c, pairs[k][0], pairs[k][1], error);
                }
            }
        }
    }
    free(of);
    return status;
}

static pl_status check_damping(check *c, const pl_engine_settings *settings, pl_error *error)
{
    const double damping[2] = {settings->linear_damping, settings->angular_damping};
    static const char *const names[2] = {"linear damping, 1/s", "angular damping, 1/s"};
    for (int i = 0; i < 2; ++i) {
        if (!agrees(c, PL_READ_BACK_DAMPING, damping[i], 0, 0)) {
            return differs(names[i], damping[i], 0, error);
        }
    }
    return PL_OK;
}

static pl_status check_settings(check *c, const pl_engine_settings *settings, pl_error *error)
{
    const double dt = c->scene->dt;
    if (!agrees(c, PL_READ_BACK_STEP, settings->dt, dt, dt)) {
        return differs("step, s", settings->dt, dt, error);
    }
    if (settings->substeps < 1) {
        return pl_fail(error, PL_UNSUPPORTED, "sub-steps: expected 1 or more, the engine says %d",
                       settings->substeps);
    }
    pl_status status = check_gravity(c, settings, error);
    for (int i = 0; i < c->scene->body_count && status == PL_OK; ++i) {
        status =
            check_body(c, &c->scene->bodies[i], settings->mass[i], settings->inertia[i], error);
    }
    return status == PL_OK ? check_damping(c, settings, error) : status;
}

pl_status pl_parameter_check(pl_session *session, const pl_scene *scene, unsigned *compared,
                             int *substeps, pl_error *error)
{
    const bool single = session->loaded.table.precision == PL_PRECISION_FLOAT;
    check c = {
        .session = session, .scene = scene, .tolerance = single ? 16 * (double)FLT_EPSILON : 1e-12};
    size_t count = (size_t)scene->body_count;
    pl_engine_settings settings = {.body_count = scene->body_count};
    settings.mass = pl_heap_new(count, sizeof *settings.mass);
    settings.inertia = pl_heap_new(count, sizeof *settings.inertia);
    pl_session_read_settings(session, &settings);
    pl_status status = check_settings(&c, &settings, error);
    if (status == PL_OK) {
        status = check_pairs(&c, error);
    }
    *compared = c.compared;
    *substeps = settings.substeps;
    free(settings.mass);
    free(settings.inertia);
    return status;
}
