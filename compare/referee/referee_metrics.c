/* Gathers what was found of a run into the metrics. */
#include "referee.h"
#include "referee/metrics/final_state.h"
#include "referee_state.h"

#include <stdarg.h>
#include <stdio.h>

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
