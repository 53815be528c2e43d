#include "session.h"

#include "base/diagnostic.h"
#include "base/heap.h"
#include "base/statistics.h"
#include "plumb/scenario.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Before a run ---- */

/* A check in progress. */
typedef struct check {
    pl_session *session;
    const pl_scene *scene;
    double tolerance;  /* relative */
    unsigned compared; /* bits 1 << pl_read_back */
} check;

/* A number as messages name it: "mass of A, kg" or "friction between A and B". The texts of bodies are "". */
typedef struct naming {
    const char *what, *body, *joint, *other, *unit;
} naming;

/* PL_UNSUPPORTED unless |found - asked| <= tolerance scale. A NaN is not compared: the engine does not say. */
static pl_status check_number(check *c, pl_read_back kind, naming name, double found, double asked,
                              double scale, pl_error *error)
{
    if (isnan(found)) {
        return PL_OK;
    }
    c->compared |= 1u << kind;
    return fabs(found - asked) <= c->tolerance * fabs(scale)
               ? PL_OK
               : pl_fail(error, PL_UNSUPPORTED, "%s%s%s%s%s: the scene has %.17g, the engine %.17g",
                         name.what, name.body, name.joint, name.other, name.unit, asked, found);
}

static pl_status check_body(check *c, const pl_body *body, double mass, const double inertia[3],
                            pl_error *error)
{
    if (body->is_static) {
        return PL_OK;
    }
    double asked[3];
    double found[3];
    memcpy(asked, body->inertia, sizeof asked);
    memcpy(found, inertia, sizeof found);
    pl_sort_numbers(asked, 3);
    pl_sort_numbers(found, 3);
    pl_status status =
        check_number(c, PL_READ_BACK_MASS, (naming){"mass of ", body->name, "", "", ", kg"}, mass,
                     body->mass, body->mass, error);
    for (int i = 0; i < 3 && status == PL_OK; ++i) {
        const naming name = {"principal inertia of ", body->name, "", "", ", kg m^2"};
        status = check_number(c, PL_READ_BACK_INERTIA, name, found[i], asked[i], asked[i], error);
    }
    return status;
}

static pl_status check_pair(check *c, int body_a, int body_b, pl_error *error)
{
    const pl_body *a = &c->scene->bodies[body_a];
    const pl_body *b = &c->scene->bodies[body_b];
    double friction, restitution;
    pl_scene_pair(c->scene, a->material, b->material, &friction, &restitution);
    const pl_pair_coefficients pair = pl_session_read_pair(c->session, body_a, body_b);
    const pl_status status = check_number(
        c, PL_READ_BACK_FRICTION, (naming){"friction between ", a->name, " and ", b->name, ""},
        pair.friction, friction, friction, error);
    return status != PL_OK
               ? status
               : check_number(c, PL_READ_BACK_RESTITUTION,
                              (naming){"restitution between ", a->name, " and ", b->name, ""},
                              pair.restitution, restitution, restitution, error);
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

/* The numbers that are no body's. */
static pl_status check_world(check *c, const pl_engine_settings *found, pl_error *error)
{
    const double dt = c->scene->dt, *g = c->scene->gravity;
    const double size = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    const struct {
        pl_read_back kind;
        const char *name;
        double found, asked, scale;
    } numbers[] = {
        {PL_READ_BACK_STEP, "step, s", found->dt, dt, dt},
        {PL_READ_BACK_GRAVITY, "gravity x, m/s^2", found->gravity[0], g[0], size},
        {PL_READ_BACK_GRAVITY, "gravity y, m/s^2", found->gravity[1], g[1], size},
        {PL_READ_BACK_GRAVITY, "gravity z, m/s^2", found->gravity[2], g[2], size},
        {PL_READ_BACK_DAMPING, "linear damping, 1/s", found->linear_damping, 0, 0},
        {PL_READ_BACK_DAMPING, "angular damping, 1/s", found->angular_damping, 0, 0},
    };
    pl_status status = PL_OK;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers && status == PL_OK; ++i) {
        status = check_number(c, numbers[i].kind, (naming){numbers[i].name, "", "", "", ""},
                              numbers[i].found, numbers[i].asked, numbers[i].scale, error);
    }
    return status;
}

static pl_status check_settings(check *c, const pl_engine_settings *settings, pl_error *error)
{
    if (settings->substeps < 1) {
        return pl_fail(error, PL_UNSUPPORTED, "sub-steps: expected 1 or more, the engine says %d",
                       settings->substeps);
    }
    pl_status status = check_world(c, settings, error);
    for (int i = 0; i < c->scene->body_count && status == PL_OK; ++i) {
        status =
            check_body(c, &c->scene->bodies[i], settings->mass[i], settings->inertia[i], error);
    }
    return status;
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

/* ---- In each step ---- */

/* A normal in single precision is a unit vector to 1e-7; beyond this one it is none at all. */
static const double UNIT = 1e-3;

/* No engine counts further in a step. */
static const double MOST_COUNTED = 1e12;

pl_status pl_check_stats(const pl_step_stats *stats, long step, pl_error *error)
{
    const struct {
        const char *name;
        double value, most;
    } numbers[] = {{"iterations", stats->iterations, MOST_COUNTED},
                   {"as residual", stats->residual, DBL_MAX},
                   {"contacts", stats->contacts, MOST_COUNTED},
                   {"islands", stats->islands, MOST_COUNTED},
                   {"s as time_collide", stats->time_collide, DBL_MAX},
                   {"s as time_solve", stats->time_solve, DBL_MAX},
                   {"s as time_other", stats->time_other, DBL_MAX}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; ++i) {
        const double value = numbers[i].value;
        if (!isnan(value) && !(value >= 0 && value <= numbers[i].most)) {
            return pl_fail(error, PL_FAILED, "the engine reports %g %s at step %ld", value,
                           numbers[i].name, step);
        }
    }
    return PL_OK;
}

static bool is_finite(const double v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* The name of the first number of a contact that is not finite, or NULL. */
static const char *infinite_part(const pl_contact *c, uint32_t reported)
{
    if (!is_finite(c->point)) {
        return "point";
    }
    if (!is_finite(c->normal)) {
        return "normal";
    }
    if (!isfinite(c->separation)) {
        return "separation";
    }
    if ((reported & PL_CONTACTS_IMPULSES) != 0 && !is_finite(c->impulse)) {
        return "impulse";
    }
    return (reported & PL_CONTACTS_TORQUES) != 0 && !is_finite(c->torque) ? "torque" : NULL;
}

static pl_status check_contact(const pl_contact *c, uint32_t reported, int body_count, long step,
                               pl_error *error)
{
    const int bodies[] = {c->body_a, c->body_b};
    for (int i = 0; i < 2; ++i) {
        if (bodies[i] < 0 || bodies[i] >= body_count) {
            return pl_fail(error, PL_FAILED,
                           "the engine reports a contact of body %d at step %ld, and the scene has "
                           "bodies 0 to %d",
                           bodies[i], step, body_count - 1);
        }
    }
    if (c->body_a == c->body_b) {
        return pl_fail(error, PL_FAILED,
                       "the engine reports a contact of body %d with itself at step %ld", c->body_a,
                       step);
    }
    const char *invalid = infinite_part(c, reported);
    if (invalid != NULL) {
        return pl_fail(error, PL_FAILED,
                       "the engine reports a contact of bodies %d and %d at step %ld whose %s is "
                       "not finite",
                       c->body_a, c->body_b, step, invalid);
    }
    const double *n = c->normal, length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(fabs(length - 1) <= UNIT)) {
        return pl_fail(error, PL_FAILED,
                       "the engine reports a contact of bodies %d and %d at step %ld whose normal "
                       "has the length %g",
                       c->body_a, c->body_b, step, length);
    }
    return PL_OK;
}

pl_status pl_check_contacts(const pl_contact *contacts, int count, uint32_t reported,
                            int body_count, long step, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < count && status == PL_OK; ++i) {
        status = check_contact(&contacts[i], reported, body_count, step, error);
    }
    return status;
}

static bool is_place(const pl_contact_place *place)
{
    const double *n = place->normal, length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    return is_finite(place->arm_a) && is_finite(place->arm_b) && fabs(length - 1) <= UNIT;
}

pl_status pl_check_contact_times(const pl_contact_time *times, int count, double dt, long step,
                                 pl_error *error)
{
    for (int i = 0; i < count; ++i) {
        const pl_contact_time *t = &times[i];
        if (!(t->begin >= 0 && t->begin <= t->end && t->end <= dt * (1 + UNIT))) {
            return pl_fail(error, PL_FAILED,
                           "the engine reports at step %ld, of %g s, that a contact acted from %g "
                           "to %g s",
                           step, dt, t->begin, t->end);
        }
        if (!is_place(&t->acts) || !is_place(&t->holds)) {
            return pl_fail(
                error, PL_FAILED,
                "the engine reports at step %ld a contact whose place has an arm that is "
                "not finite or a normal that is no unit vector",
                step);
        }
    }
    return PL_OK;
}
