#include "converged_reference.h"

#include "adapters/built_in.h"
#include "base/heap.h"
#include "plumb/jitter.h"
#include "runner/positions.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const double pl_reference_share = 0.01, pl_reference_least_bound = 1e-3, pl_reference_safety = 3;

/* Every engine runs at this many steps, by which one is chosen to confirm the reference. */
enum { LEAST_LEVELS = 3 };

/* A scene that takes more steps times bodies at the asked step gets no reference, and after dt / 4 no smaller step is
 * tried at which a run would. */
static const double most_work = 2e5;
/* No error is estimated smaller than this share of the smallest body's size. */
static const double floor_share = 1e-6;
/* The halvings end where the estimated error is at most this share of each body's bound. */
static const double aim = 0.1;

/* The engines that may confirm a reference. */
static const struct {
    const char *spec;
    int most_bodies; /* dynamic ones: a step of a dense solver costs their number cubed */
} candidates[PL_REFERENCE_CANDIDATES] = {
    {"ode:dantzig", 30}, {"mujoco:recommended", 30}, {"bullet:recommended", INT_MAX}};

bool pl_reference_applies(const pl_case *test_case)
{
    const pl_scene *scene = &test_case->scene;
    return test_case->descriptor->file != NULL && scene->rest_count + scene->travel_count == 0 &&
           scene->value_count + scene->statistic_count == 0 && pl_positions_bodies(scene) > 0;
}

/* The bound of a body from its size, m. */
static double bound_of(const pl_body *body)
{
    pl_body copy = *body;
    const pl_scene alone = {.bodies = &copy, .body_count = 1};
    return fmax(pl_reference_share * pl_scene_least_size(&alone), pl_reference_least_bound);
}

/* ---- Runs ---- */

pl_plan pl_reference_plan(const pl_reference_work *work)
{
    return (pl_plan){.repeats = 1, .seed = work->execution.plan->seed};
}

const json_t *pl_reference_result(const pl_reference_work *work, const char *run)
{
    pl_store *store = work->execution.store;
    return store == NULL ? NULL : pl_store_find(store, run);
}

void pl_reference_hash(const pl_plan *plan, const pl_case *test_case,
                       const pl_configuration *configuration, char run[17])
{
    const pl_planned_run planned = {.test_case = test_case, .configuration = configuration};
    pl_planned_run_hash(plan, &planned, run);
}

/* Whether a run is known to leave no path to its end. */
static bool is_hopeless(void *user, const char *run)
{
    const pl_outcome outcome =
        pl_outcome_named(pl_json_get_text(pl_reference_result(user, run), "outcome"));
    return outcome == PL_OUTCOME_CRASHED || outcome == PL_OUTCOME_TIMEOUT ||
           outcome == PL_OUTCOME_UNSUPPORTED;
}

bool pl_reference_goes_on(const pl_reference_work *work)
{
    return work->status == PL_OK && work->signal_number == 0;
}

bool pl_reference_run(pl_reference_work *work, const pl_plan *plan, long stride)
{
    pl_execution_def execution = work->execution;
    execution.plan = plan;
    execution.needs_positions = true;
    execution.positions_stride = stride;
    execution.user = work;
    execution.skip = is_hopeless;
    if (execution.bar != NULL) {
        execution.bar->total += pl_execution_due(&execution, NULL);
    }
    if (pl_reference_goes_on(work)) {
        work->status = pl_execute(&execution, &work->signal_number, work->error);
    }
    return pl_reference_goes_on(work);
}

/* A reference in the making. */
typedef struct making {
    pl_reference_work *work;
    pl_reference *reference;
    pl_plan plan; /* a case a level; the engines are the configurations */
} making;

static double largest_distance(const pl_body_paths *a, const pl_body_paths *b)
{
    double largest = 0;
    for (long i = 0; i < a->samples && i < b->samples; ++i) {
        for (int body = 0; body < a->bodies; ++body) {
            largest = fmax(largest, pl_body_paths_distance(a, b, body, i));
        }
    }
    return largest;
}

/* Reads an engine's run at a level. A run that did not end well ends the engine's levels. */
static void take_run(making *m, int engine, int level)
{
    pl_reference_runs *runs = &m->reference->engines[engine];
    const pl_case *test_case = &m->plan.cases[level];
    pl_body_paths *paths = &runs->levels[level];
    char run[17];
    pl_reference_hash(&m->plan, test_case, &m->plan.configurations[engine], run);
    *paths = pl_body_paths_read(m->work->execution.positions, run, &test_case->scene,
                                m->reference->stride << level);
    const json_t *result = pl_reference_result(m->work, run);
    if (paths->completed && runs->count == level) {
        runs->count += 1;
        runs->change[level] =
            level == 0 ? (double)NAN : largest_distance(paths, &runs->levels[level - 1]);
    } else if (result != NULL) {
        const char *reason = pl_json_get_text(result, "reason");
        snprintf(runs->reason, sizeof runs->reason, "%.20s at a step of %.3g s%s%.180s",
                 pl_json_get_text(result, "outcome"), test_case->scene.dt,
                 reason[0] == '\0' ? "" : ": ", reason);
    }
}

/* Whether an engine takes part in a level: it ran all before, and is the reference's own or chosen,
 * or the choice is still to be made. */
static bool takes_part(const pl_reference *reference, int engine, int level)
{
    return reference->engines[engine].count == level &&
           (level < LEAST_LEVELS || engine == 0 || engine == reference->second);
}

/* Runs the engines that take part in a level, and reads their paths. */
static void run_level(making *m, int level)
{
    const pl_case *original = m->work->original;
    json_t *study = json_pack("{s:s}", "name", "reference");
    m->plan.variation = (pl_variation){.refinement = 1 << level};
    m->plan.study = study;
    m->plan.pairing_count = 0;
    for (int i = 0; i < m->reference->engine_count; ++i) {
        if (takes_part(m->reference, i, level)) {
            pl_plan_add_pairing(&m->plan, level, i);
        }
    }
    m->work->status =
        pl_plan_add_values(&m->plan, original->descriptor, original->params, NULL, m->work->error);
    json_decref(study);
    const bool are_made = pl_reference_run(m->work, &m->plan, m->reference->stride << level);
    for (int k = 0; k < m->plan.pairing_count && are_made; ++k) {
        take_run(m, m->plan.pairings[k].configuration, level);
    }
}

/* The candidate nearest to the reference's own engine at the third step: where they have one limit,
 * the one that converges best. */
static void choose_second(pl_reference *reference)
{
    const int level = LEAST_LEVELS - 1;
    reference->second = 0;
    for (int i = 1; i < reference->engine_count; ++i) {
        pl_reference_runs *runs = &reference->engines[i];
        const pl_reference_runs *best = &reference->engines[reference->second];
        runs->apart = (double)NAN;
        if (runs->count > level) {
            runs->apart =
                largest_distance(&runs->levels[level], &reference->engines[0].levels[level]);
            if (reference->second == 0 || runs->apart < best->apart) {
                reference->second = i;
            }
        }
    }
}

/* ---- Evaluation ---- */

static double *at(double *values, const pl_reference *reference, long sample, int body)
{
    return &values[sample * reference->bodies + body];
}

/* The estimate from the halvings, nowhere below the floor. */
static void estimate(pl_reference *reference, int engine, double *error)
{
    const pl_reference_runs *runs = &reference->engines[engine];
    pl_halving_error(runs->levels, runs->count, reference->interval, error);
    for (long i = 0; i < reference->samples * reference->bodies; ++i) {
        error[i] = fmax(error[i], reference->floor);
    }
}

/* From which sample on a body's error stays beyond its bound. */
static long horizon_of(pl_reference *reference, int body)
{
    long horizon = reference->samples;
    while (horizon > 0 &&
           *at(reference->error, reference, horizon - 1, body) > reference->bounds[body]) {
        horizon -= 1;
    }
    return horizon;
}

/* Whether all errors have come down to the aim, and the two engines to within the bounds. */
static bool is_enough(pl_reference *reference)
{
    const pl_body_paths *own = pl_reference_paths(reference);
    const pl_reference_runs *second = &reference->engines[reference->second];
    for (int b = 0; b < reference->bodies; ++b) {
        for (long i = 0; i < reference->samples; ++i) {
            if (*at(reference->error, reference, i, b) > aim * reference->bounds[b] ||
                (reference->second > 0 &&
                 pl_body_paths_distance(own, &second->levels[second->count - 1], b, i) >
                     reference->bounds[b])) {
                return false;
            }
        }
    }
    return true;
}

/* What a second engine has still to go, at most: as much as at its last two steps. One that converges
 * slowly has changes that do not shrink from halving to halving. */
static void estimate_second(pl_reference *reference, double *others)
{
    pl_reference_runs *second = &reference->engines[reference->second];
    const size_t count = (size_t)(reference->samples * reference->bodies);
    double *before = pl_heap_new(count, sizeof *before);
    estimate(reference, reference->second, others);
    second->count -= 1;
    estimate(reference, reference->second, before);
    second->count += 1;
    for (size_t i = 0; i < count; ++i) {
        others[i] = fmax(others[i], before[i]);
    }
    free(before);
}

/* Where the second engine converges elsewhere, beyond the bound and beyond what both have still to go,
 * their distance is the allowance. */
static void dispute(pl_reference *reference)
{
    const pl_reference_runs *second = &reference->engines[reference->second];
    const pl_body_paths *other = &second->levels[second->count - 1];
    double *others = pl_heap_new((size_t)(reference->samples * reference->bodies), sizeof *others);
    double farthest = 0;
    estimate_second(reference, others);
    reference->confirmed = 0;
    for (int b = 0; b < reference->bodies; ++b) {
        bool differs = false;
        double apart = 0;
        for (long i = 0; i < reference->horizon[b]; ++i) {
            const double other_left = *at(others, reference, i, b);
            const double left = *at(reference->error, reference, i, b) + other_left;
            apart = pl_body_paths_distance(pl_reference_paths(reference), other, b, i);
            differs = apart > fmax(reference->bounds[b], pl_reference_safety * left) &&
                      other_left <= reference->bounds[b];
            reference->confirmed = fmax(reference->confirmed, apart);
            if (differs) {
                double *allowed = at(reference->allowance, reference, i, b);
                *allowed = fmax(*allowed, apart);
            }
        }
        reference->disputed += differs;
        reference->unconfirmed += !differs && apart > reference->bounds[b];
        if (differs && apart > farthest) {
            farthest = apart;
            reference->most_disputed = b;
        }
    }
    free(others);
}

/* The error of the levels that there are. */
static void evaluate(pl_reference *reference)
{
    const pl_reference_runs *own = &reference->engines[0];
    reference->samples = pl_halving_samples(own->levels, own->count);
    const size_t count = (size_t)(reference->samples * reference->bodies);
    estimate(reference, 0, reference->error);
    for (int b = 0; b < reference->bodies; ++b) {
        reference->horizon[b] = horizon_of(reference, b);
    }
    memcpy(reference->allowance, reference->error, count * sizeof *reference->allowance);
}

/* ---- The whole ---- */

static void prepare(pl_reference *reference, const pl_scene *scene)
{
    reference->dt = scene->dt;
    reference->stride = pl_positions_stride(scene->dt);
    reference->interval = (double)reference->stride * scene->dt;
    reference->floor = floor_share * pl_scene_least_size(scene);
    reference->confirmed = (double)NAN;
    reference->most_disputed = -1;
    reference->samples = pl_scene_steps(scene) / reference->stride + 1;
    const size_t bodies = (size_t)pl_positions_bodies(scene);
    const size_t count = (size_t)reference->samples * bodies;
    reference->body = pl_heap_new(bodies, sizeof *reference->body);
    reference->bounds = pl_heap_new(bodies, sizeof *reference->bounds);
    reference->horizon = pl_heap_new(bodies, sizeof *reference->horizon);
    reference->error = pl_heap_new(count, sizeof *reference->error);
    reference->allowance = pl_heap_new(count, sizeof *reference->allowance);
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static) {
            reference->body[reference->bodies] = i;
            reference->bounds[reference->bodies++] = bound_of(&scene->bodies[i]);
        }
    }
}

/* The reference's own engine, and those candidates that this build has. */
static void add_engines(making *m)
{
    pl_status status = pl_plan_add_engine(&m->plan, pl_reference_engine, m->work->error);
    for (int i = 0; i < PL_REFERENCE_CANDIDATES && status == PL_OK; ++i) {
        if (m->reference->bodies <= candidates[i].most_bodies) {
            status = pl_plan_add_engine(&m->plan, candidates[i].spec, m->work->error);
            status = status == PL_UNSUPPORTED ? PL_OK : status;
        }
    }
    m->work->status = status;
    m->reference->engine_count = m->plan.configuration_count;
    for (int i = 0; i < m->reference->engine_count; ++i) {
        memcpy(m->reference->engines[i].label, m->plan.configurations[i].label, PL_LABEL_SIZE);
    }
}

/* How many steps may be tried; 0: the scene is too large, as the reference then says. */
static int most_levels(pl_reference *reference, const pl_scene *scene)
{
    const double work = (double)pl_scene_steps(scene) * reference->bodies;
    int levels = LEAST_LEVELS;
    if (work > most_work) {
        snprintf(reference->reason, sizeof reference->reason,
                 "the scene takes %.3g steps times bodies, more than %.0f", work, most_work);
        return 0;
    }
    while (levels < PL_REFERENCE_LEVELS && work * (1 << levels) <= most_work) {
        levels += 1;
    }
    return levels;
}

/* Halves the step until that is enough, and evaluates the levels that ran. */
static void halve(making *m)
{
    pl_reference *reference = m->reference;
    const pl_reference_runs *own = &reference->engines[0];
    const int most = most_levels(reference, &m->work->original->scene);
    for (int level = 0; level < most && own->count == level; ++level) {
        run_level(m, level);
        if (!pl_reference_goes_on(m->work)) {
            return;
        }
        if (level == LEAST_LEVELS - 1) {
            choose_second(reference);
        }
        if (level >= LEAST_LEVELS - 1 && own->count > level) {
            evaluate(reference);
            if (is_enough(reference)) {
                break;
            }
        }
    }
    reference->known = own->count >= LEAST_LEVELS;
    if (reference->known && reference->second > 0) {
        dispute(reference);
    }
    if (!reference->known && reference->reason[0] == '\0') {
        snprintf(reference->reason, sizeof reference->reason, "%s %s", pl_reference_engine,
                 own->reason);
    }
}

void pl_reference_make(pl_reference_work *work, pl_reference *reference)
{
    *reference = (pl_reference){.known = false};
    making m = {.work = work, .reference = reference, .plan = pl_reference_plan(work)};
    prepare(reference, &work->original->scene);
    add_engines(&m);
    if (pl_reference_goes_on(work)) {
        halve(&m);
    }
    pl_plan_free(&m.plan);
}

const pl_body_paths *pl_reference_paths(const pl_reference *reference)
{
    return &reference->engines[0].levels[reference->engines[0].count - 1];
}

void pl_reference_free(pl_reference *reference)
{
    for (int i = 0; i < reference->engine_count; ++i) {
        for (int k = 0; k < PL_REFERENCE_LEVELS; ++k) {
            pl_body_paths_free(&reference->engines[i].levels[k]);
        }
    }
    free(reference->body);
    free(reference->bounds);
    free(reference->error);
    free(reference->allowance);
    free(reference->horizon);
    *reference = (pl_reference){.known = false};
}
