/* Makes the plain and the transformed runs, and adds to their results how far they agree. */
#include "metamorphic.h"

#include "base/heap.h"
#include "results/result.h"

#include <stdlib.h>
#include <string.h>

/* A run whose frames are needed. */
typedef struct framed_run {
    const pl_check *check; /* NULL: the plain run */
    pl_transform transform;
    long first;        /* the plain run's frame that corresponds to its first */
    pl_case test_case; /* its study and, of a transformed scene, its scene are owned */
    char run[17];
    pl_trajectory trajectory;
} framed_run;

typedef struct work {
    const bool *chosen;
    const pl_execution_def *how;
    json_t *made; /* a set of "PLAIN CHECK": what the store has */
    pl_progress bar;
    int *signal_number;
} work;

/* A scene on an engine. */
typedef struct pair {
    work *work;
    const pl_configuration *configuration;
    double size;      /* m, of the scene */
    framed_run *runs; /* (count): the plain run, then those of the checks that are missing */
    int count;
    bool is_known; /* the store has the result of the plain run */
    int missing;   /* checks that the store does not have */
    bool is_due;
    json_t *result; /* of the plain run that was made; NULL: none */
} pair;

/* How far a run of a transformed scene agrees with the plain run. */
static json_t *agreement_of(pair *p, framed_run *r)
{
    framed_run *plain = &p->runs[0];
    const pl_trajectory_pair comparison = {
        .scene = &plain->test_case.scene,
        .transform = &r->transform,
        .size = p->size,
        .plain = &plain->trajectory,
        .other = &r->trajectory,
        .other_body_count = r->test_case.scene.body_count,
        .first = r->first,
        .later = r->check->kind == PL_CHECK_LATE ? r->check->amount : 0};
    return pl_agreement_of(&comparison);
}

/* The run of the pair with this hash, which there is. */
static framed_run *find_run(pair *p, const char *run)
{
    framed_run *r = p->runs;
    while (strcmp(r->run, run) != 0) {
        ++r;
    }
    return r;
}

static pl_status open_frames(void *user, const char *run, FILE **file, pl_error *error)
{
    framed_run *r = find_run(user, run);
    const pl_status status = pl_trajectory_open(&r->trajectory, error);
    *file = r->trajectory.file;
    return status;
}

static void amend(void *user, json_t *result)
{
    pair *p = user;
    framed_run *r = find_run(p, pl_json_get_text(result, "run"));
    if (r->check == NULL) {
        p->result = json_incref(result);
        json_object_set_new(result, "agreement", json_pack("{s:f}", "size", p->size));
        return;
    }
    if (pl_study_ended(result)) {
        json_object_set_new(result, "agreement", agreement_of(p, r));
    }
    pl_trajectory_close(&r->trajectory);
}

/* ---- Runs ---- */

/* Makes the runs of a pair from `first` on; without a store what they give is not kept. */
static pl_status make_runs(pair *p, int first, pl_store *store, pl_error *error)
{
    work *w = p->work;
    pl_case *cases = pl_heap_new((size_t)p->count, sizeof *cases);
    pl_configuration configuration = *p->configuration;
    for (int i = first; i < p->count; ++i) {
        cases[i - first] = p->runs[i].test_case;
    }
    const pl_plan plan = {.cases = cases,
                          .case_count = p->count - first,
                          .configurations = &configuration,
                          .configuration_count = 1,
                          .repeats = 1,
                          .seed = w->how->plan->seed};
    pl_execution_def execution = *w->how;
    execution.plan = &plan;
    execution.store = store;
    execution.bar = &w->bar;
    execution.user = p;
    execution.frames = open_frames;
    execution.amend = amend;
    const pl_status status = pl_execute(&execution, w->signal_number, error);
    free(cases);
    return status;
}

/* The scene of a restart, which begins at the plain run's frame r->first. */
static pl_status restart(pair *p, const framed_run *r, pl_scene *scene, pl_error *error)
{
    const pl_scene *plain = &p->runs[0].test_case.scene;
    pl_trajectory *frames = &p->runs[0].trajectory;
    pl_trajectory_rewind(frames, plain->body_count);
    for (long i = 0; i <= r->first; ++i) {
        if (!pl_trajectory_next(frames)) {
            return pl_fail(error, PL_IO, "the plain run's frames could not be read back");
        }
    }
    return pl_restart_scene(plain, frames->frame.bodies, r->first, scene, error);
}

/* Adds the result of a check that does not apply to the scene. */
static pl_status add_inapplicable(const pair *p, const pl_case *test_case, const char *reason,
                                  pl_error *error)
{
    work *w = p->work;
    const pl_planned_run planned = {.test_case = test_case, .configuration = p->configuration};
    json_t *identity = pl_planned_run_identity(w->how->plan, &planned);
    json_t *result =
        pl_result_unmade(identity, PL_OUTCOME_UNSUPPORTED, pl_scene_steps(&test_case->scene),
                         reason, w->how->provenance);
    const pl_status status = pl_store_append(w->how->store, result, error);
    w->bar.total -= 1;
    json_decref(result);
    json_decref(identity);
    return status;
}

/* Adds a run to the pair, whose hash follows from its case. */
static void add_run(pair *p, framed_run *r)
{
    const pl_planned_run planned = {.test_case = &r->test_case, .configuration = p->configuration};
    pl_planned_run_hash(p->work->how->plan, &planned, r->run);
    pl_push(&p->runs, &p->count, r, sizeof *r);
}

/* Prepares the run of a check, or adds the result of one that does not apply. */
static pl_status prepare_check(pair *p, const pl_check *check, pl_error *error)
{
    const framed_run *plain = &p->runs[0];
    const pl_scene *plain_scene = &plain->test_case.scene;
    const char *reason = NULL;
    framed_run r = {.check = check,
                    .first = check->kind == PL_CHECK_RESTART ? pl_scene_steps(plain_scene) / 2 : 0,
                    .test_case = plain->test_case};
    pl_scene scene = pl_scene_default();
    r.test_case.variation.change = check->name;
    r.test_case.study = json_pack("{s:s, s:s, s:s}", "name", "metamorphic", "check", check->name,
                                  "plain", plain->run);
    pl_status status = pl_check_scene(check, plain_scene, &r.transform, &scene, &reason, error);
    if (status == PL_OK && reason != NULL) {
        status = add_inapplicable(p, &r.test_case, reason, error);
        json_decref(r.test_case.study);
        return status;
    }
    if (status == PL_OK && check->kind == PL_CHECK_RESTART) {
        status = restart(p, &r, &scene, error);
    }
    r.test_case.scene = scene;
    if (status == PL_OK) {
        status = pl_scene_hash(&scene, r.test_case.scene_hash, error);
    }
    add_run(p, &r);
    return status;
}

static bool is_missing(const pair *p, int check)
{
    char *key = pl_heap_format("%s %s", p->runs[0].run, pl_checks[check].name);
    const bool is_made = json_object_get(p->work->made, key) != NULL;
    free(key);
    return p->work->chosen[check] && !is_made;
}

/* Makes the missing checks of a plain run that has ended. */
static pl_status make_checks(pair *p, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < PL_CHECK_COUNT && status == PL_OK; ++i) {
        if (is_missing(p, i)) {
            status = prepare_check(p, &pl_checks[i], error);
        }
    }
    return status == PL_OK && p->count > 1 ? make_runs(p, 1, p->work->how->store, error) : status;
}

/* A plain run that is known is made again where its frames are needed. */
static pl_status make_pair(pair *p, pl_error *error)
{
    work *w = p->work;
    pl_status status = make_runs(p, 0, p->is_known ? NULL : w->how->store, error);
    if (status != PL_OK || *w->signal_number != 0) {
        return status;
    }
    if (pl_study_ended(p->result)) {
        return make_checks(p, error);
    }
    w->bar.total -= p->missing;
    return p->is_known ? pl_fail(error, PL_FAILED,
                                 "%s on %s: made again for its frames, the plain run is %s: %s",
                                 p->runs[0].test_case.name, p->configuration->label,
                                 pl_json_get_text(p->result, "outcome"),
                                 pl_json_get_text(p->result, "reason"))
                       : PL_OK;
}

/* ---- All ---- */

/* The set of the checks that have results, each with its plain run. */
static json_t *made_checks(const json_t *results)
{
    json_t *made = json_object();
    size_t index;
    const json_t *result;
    json_array_foreach((json_t *)results, index, result)
    {
        char *key = pl_heap_format("%s %s", pl_study_text(result, "study.plain"),
                                   pl_study_text(result, "study.check"));
        json_object_set_new_nocheck(made, key, json_true());
        free(key);
    }
    return made;
}

static pair begin_pair(work *w, const pl_planned_run *planned)
{
    pair p = {.work = w,
              .configuration = planned->configuration,
              .size = pl_scene_size(&planned->test_case->scene)};
    framed_run plain = {.test_case = *planned->test_case};
    plain.test_case.study = json_pack("{s:s, s:s}", "name", "metamorphic", "check", "plain");
    add_run(&p, &plain);
    const json_t *known = pl_store_find(w->how->store, p.runs[0].run);
    for (int i = 0; i < PL_CHECK_COUNT; ++i) {
        p.missing += is_missing(&p, i);
    }
    p.is_known = known != NULL;
    p.is_due = known == NULL || (p.missing > 0 && pl_study_ended(known));
    return p;
}

static void end_pair(pair *p)
{
    for (int i = 0; i < p->count; ++i) {
        pl_trajectory_close(&p->runs[i].trajectory);
        json_decref(p->runs[i].test_case.study);
        if (i > 0) {
            pl_scene_free(&p->runs[i].test_case.scene);
        }
    }
    free(p->runs);
    json_decref(p->result);
}

pl_status pl_metamorphic_run(const bool *chosen, const pl_execution_def *how,
                             int *signal_number, /* NOLINT(readability-non-const-parameter) */
                             pl_error *error)
{
    work w = {.chosen = chosen,
              .how = how,
              .made = made_checks(pl_store_results(how->store)),
              .signal_number = signal_number};
    const long count = pl_plan_size(how->plan);
    pair *pairs = pl_heap_new((size_t)count, sizeof *pairs);
    pl_status status = PL_OK;
    long total = 0;
    for (long i = 0; i < count; ++i) {
        const pl_planned_run planned = pl_plan_run(how->plan, i);
        pairs[i] = begin_pair(&w, &planned);
        total += pairs[i].is_due ? 1 + pairs[i].missing : 0;
    }
    w.bar = pl_progress_begin(how->progress, total, pl_monotonic_seconds());
    for (long i = 0; i < count; ++i) {
        if (pairs[i].is_due && status == PL_OK && *signal_number == 0) {
            status = make_pair(&pairs[i], error);
        }
        end_pair(&pairs[i]);
    }
    pl_progress_end(&w.bar);
    json_decref(w.made);
    free(pairs);
    return status;
}
