/* Hands each frame to the modules that measure, and collects their metrics at the end. */
#include "referee.h"

#include "base/heap.h"
#include "referee/metrics/modules.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const pl_module *const modules[] = {
    &pl_step_stats_module, &pl_mechanics_module, &pl_contact_force_module,
    &pl_touching_module,   &pl_motion_module,    &pl_unexplained_motion_module,
};
enum { MODULE_COUNT = sizeof modules / sizeof(const pl_module *) };

/* A copy of the last step. */
typedef struct kept_step {
    bool stood;             /* no state changed in it */
    pl_contact *contacts;   /* (count of capacity) */
    pl_contact_time *times; /* (count of time_capacity) */
    int count, capacity, time_capacity;
    bool has_times;
} kept_step;

struct pl_referee {
    pl_arena arena; /* all memory of what stands below */
    pl_run_view view;
    void *state[MODULE_COUNT];
    int threads;      /* that share the work on a frame */
    long asked, done; /* steps */
    pl_ending ended;  /* what ended the run early, with its reason */
    pl_error reason;
    pl_candidate_pairs *pairs;
    kept_step kept;
    long no_contacts_step; /* first step whose contacts the engine did not report; 0: none */
    bool has_points_alone; /* in some step the engine reported contacts without impulses */
    pl_body_state *last;   /* (body_count): the last valid frame */
};

static bool is_used(const pl_referee *r, const pl_module *module)
{
    return r->view.scale.dynamic_count > 0 || module->needs_no_motion;
}

pl_referee *pl_referee_create(const pl_scene *scene, int threads)
{
    pl_referee *r = pl_heap_new(1, sizeof *r);
    pl_arena *arena = &r->arena;
    pl_run_view *view = &r->view;
    r->threads = threads;
    r->asked = pl_scene_steps(scene);
    r->pairs = pl_candidate_pairs_create(scene, arena);
    view->scene = scene;
    view->scale = pl_scale_of(scene);
    pl_make_series(view, arena);
    view->touching = pl_touching_create(scene, view->series[PL_METRIC_PENETRATION_MAX], arena);
    view->mechanics = pl_mechanics_create(scene, arena);
    view->values = pl_values_create(scene, pl_mechanics_votes(view->mechanics), arena);
    view->last = r->last = pl_arena_take(arena, (size_t)scene->body_count, sizeof *r->last);
    for (int i = 0; i < MODULE_COUNT; ++i) {
        if (is_used(r, modules[i]) && modules[i]->create != NULL) {
            r->state[i] = modules[i]->create(view, arena);
        }
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

/* Hands the frame of r->view.step to the modules that need no pairs, or to the others. */
static void see_modules(pl_referee *r, bool needs_no_pairs)
{
    const bool is_start = r->view.step.number == 0;
    for (int i = 0; i < MODULE_COUNT; ++i) {
        const pl_module *module = modules[i];
        if (module->see != NULL && module->needs_no_pairs == needs_no_pairs && is_used(r, module) &&
            (!is_start || module->sees_start)) {
            module->see(r->state[i], &r->view);
        }
    }
}

/* Measures what needs no pairs, while these are found. */
static void see_without_pairs(void *context)
{
    pl_referee *r = context;
    if (r->view.step.number > 0) {
        pl_mechanics_step(r->view.mechanics, &r->view.step);
    }
    see_modules(r, true);
}

/* Takes the frame of r->view.step. */
static void see_frame(pl_referee *r)
{
    const pl_step *step = &r->view.step;
    pl_touching_begin(r->view.touching, step->number);
    pl_candidate_pairs_find(r->pairs, step->after, r->threads, see_without_pairs, r);
    pl_candidate_pairs_each(r->pairs, pl_touching_see, r->view.touching);
    pl_touching_end(r->view.touching);
    see_modules(r, false);
    pl_values_see(r->view.values, step->number, step->after);
    memcpy(r->last, step->after, (size_t)r->view.scene->body_count * sizeof *r->last);
}

pl_ending pl_referee_start(pl_referee *r, const pl_referee_engine *engine, const pl_frame *frame)
{
    pl_ending ending = pl_check_finite(r->view.scene, frame->bodies, 0, &r->reason);
    pl_mechanics_votes(r->view.mechanics)->engine = *engine;
    if (ending == PL_ENDING_OK) {
        pl_mechanics_start(r->view.mechanics, frame->bodies);
        r->view.step.after = frame->bodies;
        see_frame(r);
    }
    return conclude(r, ending, NULL);
}

static bool same_contacts(const kept_step *last, const pl_step *step)
{
    const size_t count = step->contact_count > 0 ? (size_t)step->contact_count : 0;
    return step->contact_count == last->count && (step->times != NULL) == last->has_times &&
           (count == 0 ||
            memcmp(step->contacts, last->contacts, count * sizeof *last->contacts) == 0) &&
           (count == 0 || !last->has_times ||
            memcmp(step->times, last->times, count * sizeof *last->times) == 0);
}

static void keep(kept_step *last, const pl_step *step, pl_arena *arena)
{
    const int count = step->contact_count;
    last->count = count;
    last->has_times = step->times != NULL;
    if (count > 0) {
        pl_arena_reserve(arena, &last->contacts, &last->capacity, count, sizeof *last->contacts);
        memcpy(last->contacts, step->contacts, (size_t)count * sizeof *last->contacts);
    }
    if (count > 0 && last->has_times) {
        pl_arena_reserve(arena, &last->times, &last->time_capacity, count, sizeof *last->times);
        memcpy(last->times, step->times, (size_t)count * sizeof *last->times);
    }
}

/* Whether the states, contacts and times of a step are, bit for bit, those of the step before it. */
static bool repeats_last(pl_referee *r, const pl_step *step)
{
    const size_t size = (size_t)r->view.scene->body_count * sizeof *step->after;
    const bool stood = r->kept.stood;
    r->kept.stood = memcmp(step->before, step->after, size) == 0;
    if (stood && r->kept.stood && same_contacts(&r->kept, step)) {
        return true;
    }
    if (r->kept.stood) {
        keep(&r->kept, step, &r->arena);
    }
    return false;
}

/* Makes r->view of a step, which starts at r->last. */
static void take_step(pl_referee *r, const pl_step *seen)
{
    pl_step *step = &r->view.step;
    *step = *seen;
    step->number = r->done;
    step->before = r->last;
    step->repeats = repeats_last(r, step);
    if (step->contact_count < 0 && r->no_contacts_step == 0) {
        r->no_contacts_step = r->done;
    }
    r->has_points_alone = r->has_points_alone || step->has_points_alone;
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

pl_ending pl_referee_step(pl_referee *r, const pl_step *seen, pl_error *error)
{
    if (r->ended != PL_ENDING_OK) {
        return conclude(r, r->ended, error);
    }
    const pl_body_state *bodies = seen->after;
    long step = r->done + 1;
    pl_ending ending = pl_check_finite(r->view.scene, bodies, step, &r->reason);
    if (ending == PL_ENDING_OK) {
        r->done = step;
        take_step(r, seen);
        see_frame(r);
        ending = pl_check_bounds(r->view.scene, &r->view.scale, bodies, energy_gain(r), step,
                                 &r->reason);
    }
    return conclude(r, ending, error);
}

double pl_referee_penetration(const pl_referee *referee)
{
    return referee->view.touching->deepest;
}

/* ---- Metrics ---- */

/* Why the contacts that the engine reported do not bear the metric out, if they do not. */
static void judge_contacts(const pl_referee *r, int id, pl_metric *metric)
{
    const bool touched = pl_metric_is(id, PL_TRAIT_STATIC_IMPULSES) && r->view.touching->met_static;
    if ((pl_metric_is(id, PL_TRAIT_IMPULSES) || touched) && r->has_points_alone) {
        *metric = pl_metric_failed("the engine reports contact points without impulses");
    } else if (touched && r->no_contacts_step > 0) {
        *metric = pl_metric_failed(
            "static bodies may be touched, and the engine reports no contacts (step %ld)",
            r->no_contacts_step);
    }
}

static void collect(pl_referee *r, const char *residual_unit, pl_metric *item)
{
    pl_run_view *view = &r->view;
    view->residual_unit = residual_unit;
    view->integrator = pl_integrator_of(pl_mechanics_votes(view->mechanics));
    pl_series_metrics(view, r->no_contacts_step == 0, item);
    for (int i = 0; i < MODULE_COUNT; ++i) {
        if (is_used(r, modules[i]) && modules[i]->collect != NULL) {
            modules[i]->collect(r->state[i], view, item);
        }
    }
    for (int id = 0; view->scale.dynamic_count > 0 && id < PL_METRIC_COUNT; ++id) {
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
                          : pl_standing_judge(r->view.scene, r->pairs, r->last, note, error);
}

pl_ending pl_referee_finish(pl_referee *r, const char *residual_unit, pl_metrics *metrics,
                            pl_note *note, pl_error *error)
{
    *metrics = (pl_metrics){0};
    pl_metric *item = metrics->item;
    pl_reference_metrics(r->view.values, r->last, item);
    collect(r, residual_unit, item);
    withdraw_after_early_end(r, item);
    pl_chaotic_metrics(r->view.scene, item);
    if (!ended_early(r)) {
        pl_expectations_judge(r->view.scene, r->view.values, r->last, metrics);
    }
    item[PL_METRIC_REFERENCE_ERROR] = reference_metric(r, item);
    return final_ending(r, note, error);
}
