/* Hands each frame to the modules that measure, and collects their metrics at the end. */
#include "referee.h"

#include "base/heap.h"
#include "referee/geometry/candidate_pairs.h"
#include "referee/metrics/chaotic.h"
#include "referee/metrics/expectations.h"
#include "referee/metrics/modules.h"
#include "referee/metrics/reference_error.h"
#include "referee/metrics/repeats.h"
#include "referee/metrics/series.h"
#include "referee/metrics/standing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const pl_module *const modules[] = {
#define MODULE(name) &pl_##name##_module,
    PL_MODULES(MODULE)
#undef MODULE
};
enum { MODULE_COUNT = sizeof modules / sizeof(const pl_module *) };

struct pl_referee {
    pl_arena arena; /* all memory of what stands below */
    pl_run_view view;
    void *state[MODULE_COUNT];
    long asked, done; /* steps */
    pl_ending ended;  /* what ended the run early, with its reason */
    pl_error reason;
    pl_candidate_pairs *pairs;
    pl_thread_pool *pool; /* the caller's; NULL: none */
    pl_values *values;
    pl_standing *standing;
    pl_repeated_steps *repeats;
    long no_contacts_step;     /* first step whose contacts the engine did not report; 0: none */
    bool has_points_alone;     /* in some step the engine reported contacts without impulses */
    long foreign_contact_step; /* first step with a contact of no body of the scene; 0: none */
    pl_body_state *last;       /* (body_count): the last valid frame */
};

pl_referee *pl_referee_create(const pl_scene *scene)
{
    pl_referee *r = pl_heap_new(1, sizeof *r);
    pl_arena *arena = &r->arena;
    r->view.scene = scene;
    r->view.scale = pl_scale_of(scene);
    r->asked = pl_scene_steps(scene);
    r->pairs = pl_candidate_pairs_create(scene, arena);
    r->view.touching = pl_touching_create(scene, arena);
    r->view.mechanics = pl_mechanics_create(scene, arena);
    r->values = pl_values_create(scene, arena);
    r->standing = pl_standing_create(scene, arena);
    r->repeats = pl_repeated_steps_create(scene, arena);
    r->view.last = r->last = pl_arena_take(arena, (size_t)scene->body_count, sizeof *r->last);
    for (int i = 0; i < MODULE_COUNT; ++i) {
        r->state[i] = modules[i]->create != NULL ? modules[i]->create(scene, arena) : NULL;
    }
    return r;
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
    pl_touching_begin(r->view.touching, r->done);
    pl_candidate_pairs_each(r->pairs, bodies, r->pool, pl_touching_see, r->view.touching);
    pl_touching_end(r->view.touching);
}

/* Hands the modules the frame of r->view.step. */
static void see_frame(pl_referee *r)
{
    const pl_step *step = &r->view.step;
    for (int i = 0; i < MODULE_COUNT; ++i) {
        if (modules[i]->see != NULL) {
            modules[i]->see(r->state[i], &r->view);
        }
    }
    pl_values_see(r->values, step->number, step->after);
    memcpy(r->last, step->after, (size_t)r->view.scene->body_count * sizeof *r->last);
}

void pl_referee_set_engine(pl_referee *referee, const pl_referee_engine *engine)
{
    pl_mechanics_set_engine(referee->view.mechanics, engine);
    pl_values_set_engine(referee->values, engine);
}

void pl_referee_set_threads(pl_referee *referee, pl_thread_pool *pool)
{
    referee->pool = pool;
}

pl_ending pl_referee_start(pl_referee *r, const pl_frame *frame)
{
    pl_ending ending = pl_check_finite(r->view.scene, frame->bodies, 0, &r->reason);
    if (ending == PL_ENDING_OK) {
        pl_mechanics_start(r->view.mechanics, frame->bodies);
        see_pairs(r, frame->bodies);
        r->view.step.after = frame->bodies;
        see_frame(r);
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

/* Takes the contacts of a step, which starts at r->last, and its balance of energy and momentum. */
static void see_step(pl_referee *r, const pl_step_observation *seen)
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
    if (!contacts_belong(r->view.scene, step.contacts, step.contact_count)) {
        r->foreign_contact_step = r->foreign_contact_step == 0 ? r->done : r->foreign_contact_step;
        step.contact_count = 0;
    }
    step.repeats = pl_repeated_steps_see(r->repeats, &step);
    pl_mechanics_step(r->view.mechanics, &step);
    r->view.step = step;
    r->view.stats = seen->stats;
    r->view.cpu_time = seen->cpu_time;
}

/* The smallest over the integrators, because a divergence shows in each. */
static double energy_gain(const pl_referee *r)
{
    double least = HUGE_VAL;
    for (pl_position_rule k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        least = fmin(
            least, pl_or_infinity(pl_mechanics_energy_gain(r->view.mechanics, &r->view.scale, k)));
    }
    return least;
}

pl_ending pl_referee_step(pl_referee *r, const pl_step_observation *seen, pl_error *error)
{
    if (r->ended != PL_ENDING_OK) {
        return conclude(r, r->ended, error);
    }
    const pl_body_state *bodies = seen->frame->bodies;
    long step = r->done + 1;
    pl_ending ending = pl_check_finite(r->view.scene, bodies, step, &r->reason);
    if (ending == PL_ENDING_OK) {
        r->done = step;
        see_pairs(r, bodies);
        see_step(r, seen);
        see_frame(r);
        ending = pl_check_bounds(r->view.scene, &r->view.scale, bodies, energy_gain(r), step,
                                 &r->reason);
    }
    return conclude(r, ending, error);
}

double pl_referee_penetration(const pl_referee *referee)
{
    return pl_touching_deepest(referee->view.touching);
}

/* ---- Metrics ---- */

/* Why the contacts that the engine reported do not bear the metric out, if they do not. */
static void judge_contacts(const pl_referee *r, int id, pl_metric *metric)
{
    const bool touched =
        pl_metric_is(id, PL_TRAIT_STATIC_IMPULSES) && pl_touching_static(r->view.touching);
    if (pl_metric_is(id, PL_TRAIT_STATIC_IMPULSES | PL_TRAIT_IMPULSES) &&
        r->foreign_contact_step > 0 && metric->state != PL_METRIC_ABSENT) {
        *metric =
            pl_metric_failed("a contact reported at step %ld is between no bodies of the scene",
                             r->foreign_contact_step);
    } else if ((pl_metric_is(id, PL_TRAIT_IMPULSES) || touched) && r->has_points_alone) {
        *metric = pl_metric_failed("the engine reports contact points without impulses");
    } else if (touched && r->no_contacts_step > 0) {
        *metric = pl_metric_failed(
            "static bodies may be touched, and the engine reports no contacts (step %ld)",
            r->no_contacts_step);
    }
}

/* Metrics of the modules. */
static void collect(pl_referee *r, const char *residual_unit, pl_metric *item)
{
    const bool moves = r->view.scale.dynamic_count > 0;
    r->view.residual_unit = residual_unit;
    r->view.integrator = pl_integrator_of(pl_mechanics_votes(r->view.mechanics));
    for (int i = 0; i < MODULE_COUNT; ++i) {
        if (moves || modules[i]->needs_no_motion) {
            modules[i]->collect(r->state[i], &r->view, item);
        }
    }
    for (int id = 0; moves && id < PL_METRIC_COUNT; ++id) {
        judge_contacts(r, id, &item[id]);
    }
}

static bool ended_early(const pl_referee *r)
{
    return r->ended != PL_ENDING_OK || r->done < r->asked;
}

/* After an early end, a metric of the final state has no value. A maximum or a mean over the steps
 * has one if there was a step. Units stay. */
static void withdraw_after_early_end(const pl_referee *r, pl_metric *item)
{
    for (int id = 0; ended_early(r) && id < PL_METRIC_COUNT; ++id) {
        pl_metric *metric = &item[id];
        const unsigned of_end =
            metric->state == PL_METRIC_FAILED ? PL_TRAIT_REASON_OF_END : PL_TRAIT_VALUE_OF_END;
        const char *unit = metric->unit;
        if (metric->state != PL_METRIC_ABSENT &&
            (pl_metric_is(id, of_end) || (r->done == 0 && pl_metric_is(id, PL_TRAIT_OVER_STEPS)))) {
            *metric = pl_metric_failed("the run ended at step %ld of %ld", r->done, r->asked);
            metric->unit = unit;
        }
    }
}

static pl_metric reference_metric(const pl_referee *r, const pl_metric *item)
{
    const char *name = r->view.scene->primary_error;
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
    pl_reference_metrics(r->values, r->last, pl_mechanics_votes(r->view.mechanics), item);
    collect(r, residual_unit, item);
    withdraw_after_early_end(r, item);
    pl_chaotic_metrics(r->view.scene, item);
    if (!ended_early(r)) {
        pl_expectations_judge(r->values, r->last, item, &metrics->deviations);
    }
    item[PL_METRIC_REFERENCE_ERROR] = reference_metric(r, item);
    return final_ending(r, note, error);
}
