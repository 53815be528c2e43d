/* Hands each frame to the modules that measure, and collects their metrics at the end.
 *
 * The engine's integrator is detected only when something has accelerated. So all that depends on
 * it is measured for each integrator, and the detected one is chosen at the end. */
#include "referee.h"

#include "referee/geometry/candidate_pairs.h"
#include "referee/metrics/chaotic.h"
#include "referee/metrics/contact_force.h"
#include "referee/metrics/expectations.h"
#include "referee/metrics/motion.h"
#include "referee/metrics/reference_error.h"
#include "referee/metrics/repeats.h"
#include "referee/metrics/series.h"
#include "referee/metrics/standing.h"
#include "referee/metrics/touching.h"
#include "referee/metrics/unexplained_motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The first three have one series for each integrator. */
typedef enum series_id {
    OF_ENERGY,
    OF_STEP_GAIN = OF_ENERGY + PL_POSITION_RULE_COUNT,
    OF_MOMENTUM = OF_STEP_GAIN + PL_POSITION_RULE_COUNT,
    OF_ITERATIONS = OF_MOMENTUM + PL_POSITION_RULE_COUNT,
    OF_RESIDUAL,
    OF_CONTACTS,
    OF_TIME,
    OF_UNEXPLAINED,
    OF_FREE_FLIGHT,
    SERIES_COUNT
} series_id;

struct pl_referee {
    pl_arena arena; /* all memory of the modules below */
    const pl_scene *scene;
    pl_scale scale;
    long asked, done; /* steps */
    pl_ending ended;  /* what ended the run early, with its reason */
    pl_error reason;
    pl_candidate_pairs *pairs;
    pl_thread_pool *pool; /* the caller's; NULL: none */
    pl_touching *touching;
    pl_mechanics *mechanics;
    pl_contact_force *force;
    pl_motion *motion;
    pl_values *values;
    pl_standing *standing;
    pl_unexplained_motion *unexplained;
    pl_repeats *repeats;
    pl_series series[SERIES_COUNT];
    long no_contacts_step;     /* first step whose contacts the engine did not report; 0: none */
    bool has_points_alone;     /* in some step the engine reported contacts without impulses */
    long foreign_contact_step; /* first step with a contact of no body of the scene; 0: none */
    pl_body_state *last;       /* (body_count): the last valid frame */
};

pl_status pl_referee_create(const pl_scene *scene, pl_referee **referee, pl_error *error)
{
    pl_referee *r = *referee = calloc(1, sizeof *r);
    if (r != NULL) {
        pl_arena *arena = &r->arena;
        r->scene = scene;
        r->scale = pl_scale_of(scene);
        r->asked = pl_scene_steps(scene);
        r->pairs = pl_candidate_pairs_create(scene, arena);
        r->touching = pl_touching_create(scene, arena);
        r->mechanics = pl_mechanics_create(scene, arena);
        r->force = pl_contact_force_create(scene, arena);
        r->motion = pl_motion_create(scene, arena);
        r->values = pl_values_create(scene, arena);
        r->standing = pl_standing_create(scene, arena);
        r->unexplained = pl_unexplained_motion_create(scene, arena);
        r->repeats = pl_repeats_create(scene, arena);
        r->last = pl_arena_take(arena, (size_t)scene->body_count, sizeof *r->last);
        for (int i = 0; i < SERIES_COUNT; ++i) {
            (void)pl_series_init(&r->series[i], arena);
        }
        if (!arena->failed) {
            return PL_OK;
        }
    }
    pl_referee_destroy(r);
    *referee = NULL;
    return pl_fail(error, PL_NO_MEMORY, "no memory to referee a scene of %d bodies",
                   scene->body_count);
}

void pl_referee_destroy(pl_referee *r)
{
    if (r != NULL) {
        pl_arena_free(&r->arena);
        free(r);
    }
}

/* ---- Frames ---- */

/* Ends the run when `ending` is not PL_ENDING_OK; `*error` (NULL allowed) gets the reason. */
static pl_ending conclude(pl_referee *r, pl_ending ending, pl_error *error)
{
    r->ended = ending;
    if (ending != PL_ENDING_OK && error != NULL) {
        *error = r->reason;
    }
    return ending;
}

static void see_pairs(pl_referee *r, const pl_body_state *bodies)
{
    pl_touching_begin(r->touching, r->done);
    pl_candidate_pairs_each(r->pairs, bodies, r->pool, pl_touching_see, r->touching);
    pl_touching_end(r->touching);
}

/* Measures poses and velocities alone, at the start and after each step. */
static void see_poses(pl_referee *r, const pl_body_state *bodies)
{
    pl_motion_see(r->motion, r->done, bodies);
    pl_values_see(r->values, r->done, bodies);
    memcpy(r->last, bodies, (size_t)r->scene->body_count * sizeof *bodies);
}

void pl_referee_set_engine(pl_referee *referee, const pl_referee_engine *engine)
{
    pl_mechanics_set_engine(referee->mechanics, engine);
    pl_values_set_engine(referee->values, engine);
}

void pl_referee_set_threads(pl_referee *referee, pl_thread_pool *pool)
{
    referee->pool = pool;
}

pl_ending pl_referee_start(pl_referee *r, const pl_frame *frame)
{
    pl_ending ending = pl_check_finite(r->scene, frame->bodies, 0, &r->reason);
    if (ending == PL_ENDING_OK) {
        pl_mechanics_start(r->mechanics, frame->bodies);
        see_pairs(r, frame->bodies);
        see_poses(r, frame->bodies);
    }
    return conclude(r, ending, NULL);
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

/* A NaN that the referee itself computed counts as infinite; a series would take it for "not
 * reported". */
static double or_infinity(double value)
{
    return isnan(value) ? HUGE_VAL : value;
}

/* Energy, momentum and contact impulses of a step, which starts at r->last. */
static void see_mechanics(pl_referee *r, const pl_step_observation *seen)
{
    pl_step step = {.number = r->done,
                    .before = r->last,
                    .after = seen->frame->bodies,
                    .contacts = seen->contacts,
                    .times = seen->contact_times,
                    .contact_count = seen->contact_count,
                    .pool = r->pool};
    if (step.contact_count < 0 && r->no_contacts_step == 0) {
        r->no_contacts_step = r->done;
    }
    r->has_points_alone = r->has_points_alone || seen->has_points_alone;
    if (!contacts_belong(r->scene, step.contacts, step.contact_count)) {
        r->foreign_contact_step = r->foreign_contact_step == 0 ? r->done : r->foreign_contact_step;
        step.contact_count = 0;
    }
    step.repeats = pl_repeats_step(r->repeats, &step);
    pl_mechanics_step(r->mechanics, &step);
    pl_contact_force_step(r->force, &step);
    pl_series_add(&r->series[OF_UNEXPLAINED],
                  pl_unexplained_motion_of(r->unexplained, r->touching, step.before, step.after),
                  r->done);
    pl_series_add(&r->series[OF_FREE_FLIGHT],
                  pl_free_flight_error_of(r->unexplained, r->touching, step.before, step.after),
                  r->done);
    for (pl_position_rule k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        double gain = pl_mechanics_energy_gain(r->mechanics, &r->scale, k) -
                      pl_mechanics_energy_rounding(r->mechanics) / r->scale.energy;
        double error = pl_mechanics_momentum_error(r->mechanics, &r->scale, k);
        double growth = pl_touching_island_max(r->touching, pl_mechanics_growth(r->mechanics, k));
        pl_series_add(&r->series[OF_ENERGY + k], fmax(or_infinity(gain), 0), r->done);
        pl_series_add(&r->series[OF_MOMENTUM + k], or_infinity(error), r->done);
        pl_series_add(&r->series[OF_STEP_GAIN + k], fmax(growth / r->scale.energy, 0), r->done);
    }
}

/* The smallest over the integrators, because a divergence shows in each. */
static double energy_gain(const pl_referee *r)
{
    double least = HUGE_VAL;
    for (pl_position_rule k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
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

pl_ending pl_referee_step(pl_referee *r, const pl_step_observation *seen, pl_error *error)
{
    if (r->ended != PL_ENDING_OK) {
        return conclude(r, r->ended, error);
    }
    const pl_body_state *bodies = seen->frame->bodies;
    long step = r->done + 1;
    pl_ending ending = pl_check_finite(r->scene, bodies, step, &r->reason);
    if (ending == PL_ENDING_OK) {
        r->done = step;
        see_stats(r, seen->stats, seen->cpu_time);
        see_pairs(r, bodies);
        see_mechanics(r, seen);
        see_poses(r, bodies);
        ending = pl_check_bounds(r->scene, &r->scale, bodies, energy_gain(r), step, &r->reason);
    }
    return conclude(r, ending, error);
}

double pl_referee_penetration(const pl_referee *referee)
{
    return pl_touching_deepest(referee->touching);
}

/* ---- Metrics ---- */

static pl_metric foreign_contact(const pl_referee *r)
{
    return pl_metric_failed("a contact reported at step %ld is between no bodies of the scene",
                            r->foreign_contact_step);
}

static pl_metric points_alone(void)
{
    return pl_metric_failed("the engine reports contact points without impulses");
}

/* Metrics of reported contacts are void once a contact was invalid, or came without its impulse. */
static void contact_force_metrics(const pl_referee *r, pl_position_rule integrator, pl_metric *item)
{
    static const pl_metric_id of_contacts[] = {PL_METRIC_FORCE_BALANCE, PL_METRIC_CONE_VIOLATION,
                                               PL_METRIC_FRICTION_EFFECTIVE, PL_METRIC_SIGNORINI,
                                               PL_METRIC_NATURAL_MAP};
    pl_contact_force_metrics(r->force, integrator, item);
    for (size_t i = 0; i < sizeof of_contacts / sizeof *of_contacts; ++i) {
        pl_metric *metric = &item[of_contacts[i]];
        if (r->has_points_alone) {
            *metric = points_alone();
        } else if (r->foreign_contact_step > 0 && metric->state != PL_METRIC_ABSENT) {
            *metric = foreign_contact(r);
        }
    }
}

/* The maximum over the steps of one series. */
static pl_metric maximum(const pl_referee *r, int series)
{
    return pl_series_metric(&r->series[series], r->series[series].max);
}

static pl_metric momentum_metric(const pl_referee *r, pl_position_rule integrator)
{
    if (r->foreign_contact_step > 0) {
        return foreign_contact(r);
    }
    if (r->has_points_alone && pl_touching_static(r->touching)) {
        return points_alone();
    }
    if (r->no_contacts_step > 0 && pl_touching_static(r->touching)) {
        return pl_metric_failed(
            "static bodies may be touched, and the engine reports no contacts (step %ld)",
            r->no_contacts_step);
    }
    return maximum(r, OF_MOMENTUM + (int)integrator);
}

/* Metrics of a scene with a dynamic body. */
static void dynamic_metrics(const pl_referee *r, pl_metric *item)
{
    const pl_position_rule integrator = pl_integrator_of(pl_mechanics_votes(r->mechanics));
    item[PL_METRIC_ENERGY_GAIN] = maximum(r, OF_ENERGY + (int)integrator);
    item[PL_METRIC_UNEXPLAINED_MOTION] = maximum(r, OF_UNEXPLAINED);
    if (r->series[OF_FREE_FLIGHT].count > 0) {
        item[PL_METRIC_FREE_FLIGHT_ERROR] = maximum(r, OF_FREE_FLIGHT);
    }
    item[PL_METRIC_ENERGY_STEP_GAIN] = maximum(r, OF_STEP_GAIN + (int)integrator);
    item[PL_METRIC_MOMENTUM_ERROR] = momentum_metric(r, integrator);
    contact_force_metrics(r, integrator, item);
    if (r->scene->body_count > 1) {
        pl_touching_metrics(r->touching, item);
    }
    pl_motion_metrics(r->motion, r->done, r->last, item);
    const double gain = pl_mechanics_energy_gain(r->mechanics, &r->scale, integrator);
    item[PL_METRIC_ENERGY_LOST] = pl_metric_value(-gain * r->scale.energy);
}

/* A statistic of what the engine reports of its steps. */
static pl_metric reported(const pl_referee *r, series_id id, double value)
{
    return r->series[id].count > 0 ? pl_series_metric(&r->series[id], value)
                                   : pl_metric_failed("the engine reports none");
}

static void step_metrics(const pl_referee *r, const char *residual_unit, pl_metric *item)
{
    const pl_series *s = r->series;
    item[PL_METRIC_ITERATIONS_MEAN] = reported(r, OF_ITERATIONS, pl_series_mean(&s[OF_ITERATIONS]));
    item[PL_METRIC_ITERATIONS_MAX] = reported(r, OF_ITERATIONS, s[OF_ITERATIONS].max);
    item[PL_METRIC_CONTACTS_MEAN] = reported(r, OF_CONTACTS, pl_series_mean(&s[OF_CONTACTS]));
    item[PL_METRIC_TIME_PER_STEP] = reported(r, OF_TIME, pl_series_mean(&s[OF_TIME]));
    if (residual_unit != NULL) {
        item[PL_METRIC_RESIDUAL_MAX] = reported(r, OF_RESIDUAL, s[OF_RESIDUAL].max);
        item[PL_METRIC_RESIDUAL_RMS] = reported(r, OF_RESIDUAL, pl_series_rms(&s[OF_RESIDUAL]));
        item[PL_METRIC_RESIDUAL_MAX].unit = item[PL_METRIC_RESIDUAL_RMS].unit = residual_unit;
    }
}

static bool ended_early(const pl_referee *r)
{
    return r->ended != PL_ENDING_OK || r->done < r->asked;
}

/* Replaces metrics that apply by the reason of the early end. Units stay. */
static void withdraw(const pl_referee *r, const pl_metric_id *ids, size_t count, pl_metric *item)
{
    for (size_t i = 0; i < count; ++i) {
        pl_metric *metric = &item[ids[i]];
        const char *unit = metric->unit;
        if (metric->state != PL_METRIC_ABSENT) {
            *metric = pl_metric_failed("the run ended at step %ld of %ld", r->done, r->asked);
            metric->unit = unit;
        }
    }
}

/* After an early end, a metric of the final state has no value. A maximum or a mean over the steps
 * has one if there was a step. */
static void withdraw_after_early_end(const pl_referee *r, pl_metric *item)
{
    static const pl_metric_id of_the_end[] = {PL_METRIC_REST_POSITION_ERROR,
                                              PL_METRIC_REST_ROTATION_ERROR,
                                              PL_METRIC_TRAVEL_ERROR,
                                              PL_METRIC_VALUE_ERROR,
                                              PL_METRIC_DISCRETE_ERROR,
                                              PL_METRIC_STATE_HASH,
                                              PL_METRIC_SPREAD_X,
                                              PL_METRIC_SPREAD_Y,
                                              PL_METRIC_MASS_HEIGHT,
                                              PL_METRIC_RUN_OUT_P95,
                                              PL_METRIC_ENERGY_LOST,
                                              PL_METRIC_PENETRATION_REST};
    static const pl_metric_id of_steps[] = {
        PL_METRIC_ENERGY_GAIN,    PL_METRIC_UNEXPLAINED_MOTION, PL_METRIC_ENERGY_STEP_GAIN,
        PL_METRIC_MOMENTUM_ERROR, PL_METRIC_PENETRATION_MAX,    PL_METRIC_LIFT,
        PL_METRIC_PATH_DEVIATION, PL_METRIC_ITERATIONS_MEAN,    PL_METRIC_ITERATIONS_MAX,
        PL_METRIC_CONTACTS_MEAN,  PL_METRIC_TIME_PER_STEP,      PL_METRIC_RESIDUAL_MAX,
        PL_METRIC_RESIDUAL_RMS};
    static const pl_metric_id settle = PL_METRIC_SETTLE_TIME, creep = PL_METRIC_CREEP;
    if (!ended_early(r)) {
        return;
    }
    withdraw(r, of_the_end, sizeof of_the_end / sizeof *of_the_end, item);
    if (r->done == 0) {
        withdraw(r, of_steps, sizeof of_steps / sizeof *of_steps, item);
    }
    /* A settle time that was reached is valid, and so is the reason why there is no creep. */
    withdraw(r, &settle, item[settle].state == PL_METRIC_FAILED, item);
    withdraw(r, &creep, item[creep].state == PL_METRIC_VALUE, item);
}

static pl_metric reference_metric(const pl_referee *r, const pl_metric *item)
{
    const char *name = r->scene->primary_error;
    if (name[0] == '\0') {
        return (pl_metric){0};
    }
    int id = pl_metric_by_name(name);
    if (id < 0 || item[id].state == PL_METRIC_ABSENT) {
        return pl_metric_failed("the scene has no %s", name);
    }
    pl_metric metric = item[id];
    metric.unit = metric.unit != NULL ? metric.unit : pl_metric_table[id].unit;
    return metric;
}

static pl_ending final_ending(const pl_referee *r, pl_note *note, pl_error *error)
{
    if (r->ended != PL_ENDING_OK && error != NULL) {
        *error = r->reason;
    }
    note->text[0] = '\0';
    return ended_early(r) ? r->ended
                          : pl_standing_judge(r->standing, r->pairs, r->last, note, error);
}

pl_ending pl_referee_finish(pl_referee *r, const char *residual_unit, pl_metrics *metrics,
                            pl_note *note, pl_error *error)
{
    *metrics = (pl_metrics){0};
    pl_metric *item = metrics->item;
    pl_reference_metrics(r->values, r->last, pl_mechanics_votes(r->mechanics), item);
    step_metrics(r, residual_unit, item);
    if (r->scale.dynamic_count > 0) {
        dynamic_metrics(r, item);
    }
    withdraw_after_early_end(r, item);
    pl_chaotic_metrics(r->scene, item);
    if (!ended_early(r)) {
        pl_expectations_judge(r->values, r->last, item, &metrics->deviations);
    }
    item[PL_METRIC_REFERENCE_ERROR] = reference_metric(r, item);
    return final_ending(r, note, error);
}
