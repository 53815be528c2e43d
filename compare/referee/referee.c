/* Hands each frame to those who measure one thing, and gathers what they found into the metrics.
 *
 * Drift and creep need the pose at settle_time, which is known only half a second later. So two
 * measurements run: one begins anew with every quiet, and holds once the quiet has lasted; the
 * other begins at 1 s (or half the duration) and counts only when the scene never settles.
 *
 * Which integrator an engine has is known only when something has accelerated. So what depends on
 * it is measured for each, and the one that fits is chosen at the end. */
#include "referee/referee.h"

#include "referee/contact_force.h"
#include "referee/drift.h"
#include "referee/final_state.h"
#include "referee/islands.h"
#include "referee/mechanics.h"
#include "referee/nearby.h"
#include "referee/path.h"
#include "referee/penetration.h"
#include "referee/sanity.h"
#include "referee/scale.h"
#include "referee/series.h"
#include "referee/settle.h"
#include "referee/spread.h"
#include "referee/value.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The first three have one for each integrator. */
typedef enum series_id {
    OF_ENERGY,
    OF_STEP_GAIN = OF_ENERGY + PL_INTEGRATOR_COUNT,
    OF_MOMENTUM = OF_STEP_GAIN + PL_INTEGRATOR_COUNT,
    OF_LIFT = OF_MOMENTUM + PL_INTEGRATOR_COUNT,
    OF_DEVIATION,
    OF_ITERATIONS,
    OF_RESIDUAL,
    OF_CONTACTS,
    OF_TIME,
    SERIES_COUNT
} series_id;

struct pl_referee {
    const pl_scene *scene;
    pl_scale scale;
    long asked, done; /* steps */
    pl_verdict ended; /* what ended the run early, with its reason */
    pl_error reason;
    pl_nearby *nearby;
    pl_penetration *penetration;
    pl_mechanics *mechanics;
    pl_contact_force *force;
    pl_islands *islands;
    pl_path *path;
    pl_values *values;
    pl_spread *spread;
    pl_settle settle;
    pl_drift *since_quiet, *since_fixed;
    long fixed_step; /* where since_fixed begins */
    pl_series series[SERIES_COUNT];
    long no_contacts_step;     /* first step whose contacts the engine did not report; 0: none */
    long foreign_contact_step; /* first step with a contact of no body of the scene; 0: none */
    pl_body_state *last;       /* (body_count): the last good frame */
};

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
    r->nearby = pl_nearby_create(scene);
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
    pl_nearby_destroy(r->nearby);
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
    pl_nearby_each(r->nearby, bodies, see_pair, r);
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

#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
static pl_metric
failed(const char *format, ...)
{
    pl_metric metric = {.state = PL_METRIC_FAILED};
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(metric.reason, sizeof metric.reason, format, arguments);
    va_end(arguments);
    return metric;
}

static bool ended_early(const pl_referee *r)
{
    return r->ended != PL_VERDICT_OK || r->done < r->asked;
}

/* A metric of the final state: FAILED after an early end, where it applies at all. */
static pl_metric final_metric(const pl_referee *r, pl_metric metric)
{
    if (metric.state != PL_METRIC_ABSENT && ended_early(r)) {
        return failed("the run ended at step %ld of %ld", r->done, r->asked);
    }
    return metric;
}

/* A maximum over steps: of those seen, if any. */
static pl_metric maximum_metric(const pl_referee *r, pl_metric metric)
{
    return r->done > 0 ? metric : final_metric(r, metric);
}

/* A statistic of what the engine reports about its steps. */
static pl_metric reported_metric(const pl_referee *r, series_id id, double value)
{
    if (r->series[id].count == 0) {
        return maximum_metric(r, failed("the engine reports none"));
    }
    return pl_series_metric(&r->series[id], value);
}

/* Of travels and values together; absent where either has no answer. */
static pl_metric discrete_error_of(const pl_referee *r, pl_integrator integrator)
{
    const pl_scene *scene = r->scene;
    pl_metric of_travels = pl_discrete_error(scene, r->last, integrator);
    pl_metric of_values = pl_values_discrete_error(r->values, integrator);
    if ((scene->travel_count > 0 && of_travels.state == PL_METRIC_ABSENT) ||
        (scene->value_count > 0 && of_values.state == PL_METRIC_ABSENT)) {
        return (pl_metric){0};
    }
    bool larger = of_values.state == PL_METRIC_VALUE && of_values.value >= of_travels.value;
    return larger ? of_values : of_travels;
}

/* Where the integrator is not told, the answer counts that is the same by either. */
static pl_metric discrete_error(const pl_referee *r)
{
    const pl_integrator_votes *votes = pl_mechanics_votes(r->mechanics);
    pl_metric error = discrete_error_of(r, pl_integrator_of(votes));
    for (int k = 0; k < PL_INTEGRATOR_COUNT; ++k) {
        pl_metric other = discrete_error_of(r, (pl_integrator)k);
        bool same = other.state == error.state && other.value == error.value;
        if (pl_integrator_certain(votes) != PL_INTEGRATOR_TOLD && !same) {
            return (pl_metric){0};
        }
    }
    return error;
}

static pl_metric integrator_metric(const pl_referee *r)
{
    pl_metric metric = {0};
    const char *name = pl_integrator_name(pl_mechanics_votes(r->mechanics));
    if (name != NULL) {
        metric.state = PL_METRIC_TEXT;
        (void)snprintf(metric.text, sizeof metric.text, "%s", name);
    }
    return metric;
}

static void final_metrics(const pl_referee *r, pl_metric *item)
{
    const pl_scene *scene = r->scene;
    item[PL_METRIC_REST_POSITION_ERROR] = final_metric(r, pl_rest_position_error(scene, r->last));
    item[PL_METRIC_REST_ROTATION_ERROR] = final_metric(r, pl_rest_rotation_error(scene, r->last));
    item[PL_METRIC_TRAVEL_ERROR] = final_metric(r, pl_travel_error(scene, r->last));
    item[PL_METRIC_VALUE_ERROR] = final_metric(r, pl_values_error(r->values));
    item[PL_METRIC_DISCRETE_ERROR] = final_metric(r, discrete_error(r));
    item[PL_METRIC_INTEGRATOR] = integrator_metric(r);
    item[PL_METRIC_STATE_HASH] = final_metric(r, pl_state_hash(scene, r->last));
}

static pl_metric settle_metric(const pl_referee *r)
{
    if (r->scene->travel_count > 0 || r->scene->value_count > 0) {
        return (pl_metric){0};
    }
    if (r->settle.settled) {
        return (pl_metric){.state = PL_METRIC_VALUE,
                           .value = (double)r->settle.quiet_since * r->scene->dt};
    }
    return final_metric(r, failed("never below 1 mm/s and 1 mrad/s for 0.5 s in %.6g s",
                                  (double)r->done * r->scene->dt));
}

static void drift_metrics(const pl_referee *r, pl_metric *item)
{
    const pl_drift *drift = r->settle.settled ? r->since_quiet : r->since_fixed;
    if (!pl_drift_applies(drift)) {
        return;
    }
    if (pl_drift_samples(drift) < 2) {
        item[PL_METRIC_DRIFT] = item[PL_METRIC_CREEP] =
            failed("the run has no frame after step %ld", r->fixed_step);
        return;
    }
    item[PL_METRIC_DRIFT] = (pl_metric){.state = PL_METRIC_VALUE, .value = pl_drift_largest(drift)};
    item[PL_METRIC_CREEP] =
        final_metric(r, (pl_metric){.state = PL_METRIC_VALUE, .value = pl_drift_slope(drift)});
}

static pl_metric foreign_contact(const pl_referee *r)
{
    return failed("a contact reported at step %ld is between no bodies of the scene",
                  r->foreign_contact_step);
}

/* What is found of reported contacts has no meaning once one of them was nonsense. */
static void contact_force_metrics(const pl_referee *r, pl_metric *item)
{
    pl_contact_force_metrics(r->force, pl_mechanics_integrator(r->mechanics), item);
    const pl_metric_id of_force[] = {PL_METRIC_FORCE_BALANCE, PL_METRIC_CONE_VIOLATION,
                                     PL_METRIC_FRICTION_EFFECTIVE, PL_METRIC_SIGNORINI,
                                     PL_METRIC_NATURAL_MAP};
    for (size_t i = 0; r->foreign_contact_step > 0 && i < sizeof of_force / sizeof *of_force; ++i) {
        pl_metric *metric = &item[of_force[i]];
        *metric = metric->state != PL_METRIC_ABSENT ? foreign_contact(r) : *metric;
    }
}

static pl_metric momentum_metric(const pl_referee *r)
{
    if (r->foreign_contact_step > 0) {
        return foreign_contact(r);
    }
    if (r->no_contacts_step > 0 && pl_penetration_touched_static(r->penetration)) {
        return failed("static bodies are touched, and the engine reports no contacts (step %ld)",
                      r->no_contacts_step);
    }
    const pl_series *momentum = &r->series[OF_MOMENTUM + pl_mechanics_integrator(r->mechanics)];
    return pl_series_metric(momentum, momentum->max);
}

/* What a collapse leaves. */
static void spread_metrics(const pl_referee *r, pl_metric *item)
{
    static const pl_metric_id of_the_end[] = {PL_METRIC_SPREAD_X, PL_METRIC_SPREAD_Y,
                                              PL_METRIC_MASS_HEIGHT, PL_METRIC_RUN_OUT_P95};
    const pl_integrator integrator = pl_mechanics_integrator(r->mechanics);
    pl_spread_measure(r->spread, r->last, item);
    for (size_t i = 0; i < sizeof of_the_end / sizeof of_the_end[0]; ++i) {
        item[of_the_end[i]] = final_metric(r, item[of_the_end[i]]);
    }
    double gain = pl_mechanics_energy_gain(r->mechanics, &r->scale, integrator);
    item[PL_METRIC_ENERGY_LOST] =
        final_metric(r, (pl_metric){.state = PL_METRIC_VALUE, .value = -gain * r->scale.energy});
}

/* A maximum over steps of what the referee itself measures. */
static pl_metric measured_metric(const pl_referee *r, int series)
{
    return maximum_metric(r, pl_series_metric(&r->series[series], r->series[series].max));
}

/* Metrics of any scene in which something can move. */
static void motion_metrics(const pl_referee *r, pl_metric *item)
{
    const int integrator = (int)pl_mechanics_integrator(r->mechanics);
    item[PL_METRIC_ENERGY_GAIN] = measured_metric(r, OF_ENERGY + integrator);
    item[PL_METRIC_ENERGY_STEP_GAIN] = measured_metric(r, OF_STEP_GAIN + integrator);
    item[PL_METRIC_MOMENTUM_ERROR] = maximum_metric(r, momentum_metric(r));
    contact_force_metrics(r, item);
    item[PL_METRIC_SETTLE_TIME] = settle_metric(r);
    if (r->scene->body_count > 1) {
        item[PL_METRIC_PENETRATION_MAX] = maximum_metric(r, pl_penetration_max(r->penetration));
        item[PL_METRIC_PENETRATION_REST] = final_metric(r, pl_penetration_rest(r->penetration));
    }
    if (pl_path_has_lift(r->path)) {
        item[PL_METRIC_LIFT] = measured_metric(r, OF_LIFT);
    }
    if (pl_path_has_line(r->path)) {
        item[PL_METRIC_PATH_DEVIATION] = measured_metric(r, OF_DEVIATION);
    }
    if (pl_spread_applies(r->spread)) {
        spread_metrics(r, item);
    }
    drift_metrics(r, item);
}

static void step_metrics(const pl_referee *r, const char *residual_unit, pl_metric *item)
{
    const pl_series *s = r->series;
    item[PL_METRIC_ITERATIONS_MEAN] =
        reported_metric(r, OF_ITERATIONS, pl_series_mean(&s[OF_ITERATIONS]));
    item[PL_METRIC_ITERATIONS_MAX] = reported_metric(r, OF_ITERATIONS, s[OF_ITERATIONS].max);
    item[PL_METRIC_CONTACTS_MEAN] =
        reported_metric(r, OF_CONTACTS, pl_series_mean(&s[OF_CONTACTS]));
    item[PL_METRIC_TIME_PER_STEP] = reported_metric(r, OF_TIME, pl_series_mean(&s[OF_TIME]));
    if (residual_unit != NULL) {
        item[PL_METRIC_RESIDUAL_MAX] = reported_metric(r, OF_RESIDUAL, s[OF_RESIDUAL].max);
        item[PL_METRIC_RESIDUAL_RMS] =
            reported_metric(r, OF_RESIDUAL, pl_series_rms(&s[OF_RESIDUAL]));
        item[PL_METRIC_RESIDUAL_MAX].unit = residual_unit;
        item[PL_METRIC_RESIDUAL_RMS].unit = residual_unit;
    }
}

static pl_metric reference_metric(const pl_referee *r, const pl_metric *item)
{
    const char *name = r->scene->primary_error;
    if (name[0] == '\0') {
        return (pl_metric){0};
    }
    int id = pl_metric_by_name(name);
    if (id < 0 || item[id].state == PL_METRIC_ABSENT) {
        return failed("the scene has no %s", name);
    }
    pl_metric metric = item[id];
    metric.unit = metric.unit != NULL ? metric.unit : pl_metric_table[id].unit;
    return metric;
}

static pl_verdict final_verdict(const pl_referee *r, pl_error *error)
{
    if (r->ended != PL_VERDICT_OK && error != NULL) {
        *error = r->reason;
    }
    if (ended_early(r)) {
        return r->ended;
    }
    double distance = 0;
    int farthest = pl_farthest_from_rest(r->scene, r->last, &distance);
    if (farthest < 0 || !(distance > r->scene->collapse_distance)) {
        return PL_VERDICT_OK;
    }
    (void)pl_fail(error, PL_FAILED, "body \"%s\" ended %.3g m from its reference, beyond %.3g m",
                  r->scene->bodies[r->scene->rests[farthest].body].name, distance,
                  r->scene->collapse_distance);
    return PL_VERDICT_COLLAPSED;
}

pl_verdict pl_referee_finish(pl_referee *r, const char *residual_unit, pl_metrics *metrics,
                             pl_error *error)
{
    *metrics = (pl_metrics){0};
    pl_metric *item = metrics->item;
    final_metrics(r, item);
    step_metrics(r, residual_unit, item);
    if (r->scale.dynamic_count > 0) {
        motion_metrics(r, item);
    }
    item[PL_METRIC_REFERENCE_ERROR] = reference_metric(r, item);
    return final_verdict(r, error);
}
