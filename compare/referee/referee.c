/* Hands each frame to those who measure one thing.
 *
 * Drift and creep need the pose at settle_time, which is known only half a second later. So two
 * measurements run: one begins anew with every quiet, and holds once the quiet has lasted; the
 * other begins at 1 s (or half the duration) and counts only when the scene never settles.
 *
 * Which integrator an engine has is known only when something has accelerated. So what depends on
 * it is measured for each, and the one that fits is chosen at the end. */
#include "referee.h"

#include "referee/metrics/validity.h"
#include "referee_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

pl_status pl_referee_create(const pl_scene *scene, pl_referee **referee, pl_error *error)
{
    *referee = NULL;
    pl_referee *r = calloc(1, sizeof *r);
    if (r == NULL) {
        goto out_of_memory;
    }
    r->scene = scene;
    r->scale = pl_scale_of(scene);
    r->asked = pl_scene_steps(scene);
    r->fixed_step = lround(fmin(1, scene->duration / 2) / scene->dt);
    r->settle = pl_settle_start(scene);
    r->nearby = pl_candidate_pairs_create(scene);
    r->penetration = pl_penetration_create(scene);
    r->mechanics = pl_mechanics_create(scene);
    r->force = pl_contact_force_create(scene);
    r->islands = pl_islands_create(scene);
    r->path = pl_path_create(scene);
    r->values = pl_values_create(scene);
    r->spread = pl_spread_create(scene);
    r->since_quiet = pl_drift_create(scene);
    r->since_fixed = pl_drift_create(scene);
    r->last = calloc((size_t)scene->body_count + 1, sizeof *r->last);
    if (r->nearby == NULL || r->penetration == NULL || r->mechanics == NULL || r->force == NULL ||
        r->islands == NULL || r->path == NULL || r->values == NULL || r->spread == NULL ||
        r->since_quiet == NULL || r->since_fixed == NULL || r->last == NULL) {
        goto out_of_memory;
    }
    for (int i = 0; i < SERIES_COUNT; ++i) {
        if (!pl_series_init(&r->series[i])) {
            goto out_of_memory;
        }
    }
    *referee = r;
    return PL_OK;

out_of_memory:
    pl_referee_destroy(r);
    return pl_fail(error, PL_NO_MEMORY, "no memory to referee a scene of %d bodies",
                   scene->body_count);
}

void pl_referee_destroy(pl_referee *r)
{
    if (r == NULL) {
        return;
    }
    for (int i = 0; i < SERIES_COUNT; ++i) {
        pl_series_free(&r->series[i]);
    }
    pl_candidate_pairs_destroy(r->nearby);
    pl_penetration_destroy(r->penetration);
    pl_mechanics_destroy(r->mechanics);
    pl_contact_force_destroy(r->force);
    pl_islands_destroy(r->islands);
    pl_path_destroy(r->path);
    pl_values_destroy(r->values);
    pl_spread_destroy(r->spread);
    pl_drift_destroy(r->since_quiet);
    pl_drift_destroy(r->since_fixed);
    free(r->last);
    free(r);
}

/* Ends the run when `verdict` is not OK; `*error` (NULL allowed) gets the reason. */
static pl_verdict conclude(pl_referee *r, pl_verdict verdict, pl_error *error)
{
    r->ended = verdict;
    if (verdict != PL_VERDICT_OK && error != NULL) {
        *error = r->reason;
    }
    return verdict;
}

static void see_pair(void *context, const pl_near_pair *pair)
{
    pl_referee *r = context;
    pl_penetration_see(r->penetration, pair);
    if (pair->meets) {
        pl_islands_join(r->islands, pair->a, pair->b);
    }
}

/* Who touches whom. */
static void see_pairs(pl_referee *r, const pl_body_state *bodies)
{
    pl_penetration_begin(r->penetration, r->done);
    pl_islands_begin(r->islands);
    pl_candidate_pairs_each(r->nearby, bodies, see_pair, r);
    pl_penetration_end(r->penetration);
}

/* What is measured of the poses alone, at the start and after each step. */
static void see_poses(pl_referee *r, const pl_body_state *bodies)
{
    long step = r->done;
    double time = (double)step * r->scene->dt;
    if (pl_settle_see(&r->settle, step, bodies)) {
        pl_drift_begin(r->since_quiet, time, bodies);
    } else if (r->settle.quiet_since >= 0) {
        pl_drift_add(r->since_quiet, time, bodies);
    }
    if (step == r->fixed_step) {
        pl_drift_begin(r->since_fixed, time, bodies);
    } else if (step > r->fixed_step) {
        pl_drift_add(r->since_fixed, time, bodies);
    }
    pl_values_see(r->values, step, bodies);
    memcpy(r->last, bodies, (size_t)r->scene->body_count * sizeof *bodies);
}

pl_verdict pl_referee_start(pl_referee *r, const pl_frame *frame)
{
    pl_verdict verdict = pl_check_finite(r->scene, frame->bodies, 0, &r->reason);
    if (verdict == PL_VERDICT_OK) {
        pl_mechanics_start(r->mechanics, frame->bodies);
        pl_contact_force_start(r->force, frame->bodies);
        pl_spread_start(r->spread, frame->bodies);
        see_pairs(r, frame->bodies);
        see_poses(r, frame->bodies);
    }
    return conclude(r, verdict, NULL);
}

static bool contacts_belong(const pl_scene *scene, const pl_contact *contacts, int count)
{
    for (int i = 0; i < count; ++i) {
        if (contacts[i].body_a < 0 || contacts[i].body_a >= scene->body_count ||
            contacts[i].body_b < 0 || contacts[i].body_b >= scene->body_count) {
            return false;
        }
    }
    return true;
}

/* A NaN must not pass for "not reported" in what the referee works out itself. */
static double or_infinity(double value)
{
    return isnan(value) ? HUGE_VAL : value;
}

static void see_mechanics(pl_referee *r, const pl_body_state *bodies, const pl_contact *contacts,
                          int contact_count)
{
    if (contact_count < 0 && r->no_contacts_step == 0) {
        r->no_contacts_step = r->done;
    }
    if (!contacts_belong(r->scene, contacts, contact_count)) {
        r->foreign_contact_step = r->foreign_contact_step == 0 ? r->done : r->foreign_contact_step;
        contact_count = 0;
    }
    pl_mechanics_step(r->mechanics, r->done, bodies, contacts, contact_count);
    pl_contact_force_step(r->force, r->done, bodies, contacts, contact_count);
    for (pl_integrator k = 0; k < PL_INTEGRATOR_COUNT; ++k) {
        double gain = pl_mechanics_energy_gain(r->mechanics, &r->scale, k);
        double error = pl_mechanics_momentum_error(r->mechanics, &r->scale, k);
        double growth = pl_islands_largest(r->islands, pl_mechanics_growth(r->mechanics, k));
        pl_series_add(&r->series[OF_ENERGY + k], fmax(or_infinity(gain), 0), r->done);
        pl_series_add(&r->series[OF_MOMENTUM + k], or_infinity(error), r->done);
        pl_series_add(&r->series[OF_STEP_GAIN + k], fmax(growth / r->scale.energy, 0), r->done);
    }
}

static void see_path(pl_referee *r, const pl_body_state *bodies)
{
    pl_series_add(&r->series[OF_LIFT], pl_path_lift(r->path, bodies), r->done);
    pl_series_add(&r->series[OF_DEVIATION], pl_path_deviation(r->path, bodies), r->done);
}

/* The smaller of the integrators', since a divergence shows in both. */
static double energy_gain(const pl_referee *r)
{
    double least = HUGE_VAL;
    for (pl_integrator k = 0; k < PL_INTEGRATOR_COUNT; ++k) {
        least = fmin(least, or_infinity(pl_mechanics_energy_gain(r->mechanics, &r->scale, k)));
    }
    return least;
}

static void see_stats(pl_referee *r, const pl_step_stats *stats, double cpu_time)
{
    pl_series_add(&r->series[OF_TIME], cpu_time, r->done);
    if (stats != NULL) {
        pl_series_add(&r->series[OF_ITERATIONS], stats->iterations, r->done);
        pl_series_add(&r->series[OF_RESIDUAL], stats->residual, r->done);
        pl_series_add(&r->series[OF_CONTACTS], stats->contacts, r->done);
    }
}

pl_verdict pl_referee_step(pl_referee *r, const pl_frame *frame, const pl_step_stats *stats,
                           const pl_contact *contacts, int contact_count, double cpu_time,
                           pl_error *error)
{
    if (r->ended != PL_VERDICT_OK) {
        return conclude(r, r->ended, error);
    }
    long step = r->done + 1;
    pl_verdict verdict = pl_check_finite(r->scene, frame->bodies, step, &r->reason);
    if (verdict == PL_VERDICT_OK) {
        r->done = step;
        see_stats(r, stats, cpu_time);
        see_pairs(r, frame->bodies);
        see_mechanics(r, frame->bodies, contacts, contact_count);
        see_path(r, frame->bodies);
        see_poses(r, frame->bodies);
        verdict =
            pl_check_bounds(r->scene, &r->scale, frame->bodies, energy_gain(r), step, &r->reason);
    }
    return conclude(r, verdict, error);
}
