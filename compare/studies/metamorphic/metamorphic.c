/* Makes the plain and the transformed runs, and adds to their results how far they agree. */
#include "metamorphic.h"

#include "agreement.h"
#include "base/heap.h"
#include "results/run_verdict.h"

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

/* A scene on an engine: the plain run, and those of the checks that are missing. */
typedef struct pair {
    const pl_plan *plan;
    const pl_configuration *configuration;
    double size; /* m, of the scene */
    framed_run plain;
    bool is_known; /* the store has the result of the plain run */
    int missing;   /* checks that the store does not have */
    bool is_due;
    json_t *result;     /* of the plain run that was made; NULL: none */
    framed_run *others; /* (other_count) */
    int other_count;
} pair;

typedef struct work {
    const bool *chosen;
    const pl_execution_def *how;
    json_t *made; /* a set of "PLAIN CHECK": what the store has */
    pl_progress bar;
    int *signal_number;
} work;

/* Whether the run finished, as expected or collapsed. */
static bool finished(const json_t *result)
{
    const char *outcome = pl_json_get_text(result, "outcome");
    return strcmp(outcome, "ok") == 0 || strcmp(outcome, "collapsed") == 0;
}

/* How far a run of a transformed scene agrees with the plain run. */
static json_t *agreement_of(pair *p, framed_run *r)
{
    const pl_trajectory_pair comparison = {
        .scene = &p->plain.test_case.scene,
        .transform = &r->transform,
        .size = p->size,
        .plain = &p->plain.trajectory,
        .other = &r->trajectory,
        .other_body_count = r->test_case.scene.body_count,
        .first = r->first,
        .later = r->check->kind == PL_CHECK_LATE ? r->check->amount : 0};
    return pl_agreement_of(&comparison);
}

static framed_run *find_run(pair *p, const char *run)
{
    if (strcmp(p->plain.run, run) == 0) {
        return &p->plain;
    }
    for (int i = 0; i < p->other_count; ++i) {
        if (strcmp(p->others[i].run, run) == 0) {
            return &p->others[i];
        }
    }
    return NULL;
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
    if (finished(result)) {
        json_object_set_new(result, "agreement", agreement_of(p, r));
    }
    pl_trajectory_close(&r->trajectory);
}

/* ---- Runs ---- */

/* Makes runs of a pair; without a store what they give is not kept. */
static pl_status make_runs(work *w, pair *p, const framed_run *runs, int count, pl_store *store,
                           pl_error *error)
{
    pl_case *cases = pl_heap_new((size_t)count, sizeof *cases);
    pl_configuration configuration = *p->configuration;
    for (int i = 0; i < count; ++i) {
        cases[i] = runs[i].test_case;
    }
    const pl_plan plan = {.cases = cases,
                          .case_count = count,
                          .configurations = &configuration,
                          .configuration_count = 1,
                          .repeats = 1,
                          .seed = p->plan->seed};
    pl_execution_def execution = *w->how;
    execution.plan = &plan;
    execution.store = store;
    execution.bar = w->how->progress == NULL ? NULL : &w->bar;
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
    const pl_scene *plain = &p->plain.test_case.scene;
    pl_trajectory *frames = &p->plain.trajectory;
    pl_trajectory_rewind(frames, plain->body_count);
    for (long i = 0; i <= r->first; ++i) {
        if (!pl_trajectory_next(frames)) {
            return pl_fail(error, PL_IO, "the plain run's frames could not be read back");
        }
    }
    return pl_restart_scene(plain, frames->frame.bodies, r->first, scene, error);
}

/* The run of a planned case of a pair. */
static pl_planned_run planned_run(const pair *p, const pl_case *test_case)
{
    return (pl_planned_run){.test_case = test_case, .configuration = p->configuration};
}

/* Adds the result of a check that does not apply to the scene. */
static pl_status add_inapplicable(work *w, const pair *p, const pl_case *test_case,
                                  const char *reason, pl_error *error)
{
    const pl_planned_run planned = planned_run(p, test_case);
    json_t *identity = pl_planned_run_identity(p->plan, &planned);
    json_t *result =
        pl_result_unmade(identity, PL_OUTCOME_UNSUPPORTED, pl_scene_steps(&test_case->scene),
                         reason, w->how->provenance);
    const pl_status status = pl_store_append(w->how->store, result, error);
    w->bar.total -= 1;
    json_decref(result);
    json_decref(identity);
    return status;
}

/* Prepares the run of a check, or adds the result of one that does not apply. */
static pl_status prepare_check(work *w, pair *p, const pl_check *check, pl_error *error)
{
    const pl_scene *plain = &p->plain.test_case.scene;
    const char *reason = NULL;
    framed_run r = {.check = check,
                    .first = check->kind == PL_CHECK_RESTART ? pl_scene_steps(plain) / 2 : 0,
                    .test_case = p->plain.test_case};
    r.test_case.variation.change = check->name;
    r.test_case.study = json_pack("{s:s, s:s, s:s}", "name", "metamorphic", "check", check->name,
                                  "plain", p->plain.run);
    pl_scene scene = pl_scene_default();
    pl_status status = pl_check_scene(check, plain, &r.transform, &scene, &reason, error);
    if (status == PL_OK && reason != NULL) {
        status = add_inapplicable(w, p, &r.test_case, reason, error);
        json_decref(r.test_case.study);
        return status;
    }
    if (status == PL_OK && check->kind == PL_CHECK_RESTART) {
        status = restart(p, &r, &scene, error);
    }
    r.test_case.scene = scene;
    if (status == PL_OK) {
        status = pl_scene_hash(&r.test_case.scene, r.test_case.scene_hash, error);
    }
    if (status == PL_OK) {
        const pl_planned_run planned = planned_run(p, &r.test_case);
        pl_planned_run_hash(p->plan, &planned, r.run);
    }
    pl_push(&p->others, &p->other_count, &r, sizeof r);
    return status;
}

static bool has_check(const work *w, const pair *p, const pl_check *check)
{
    char key[128];
    snprintf(key, sizeof key, "%s %.100s", p->plain.run, check->name);
    return json_object_get(w->made, key) != NULL;
}

/* Makes the missing checks of a plain run that has ended. */
static pl_status make_checks(work *w, pair *p, pl_error *error)
{
    int count = 0;
    pl_status status = PL_OK;
    const pl_check *checks = pl_checks(&count);
    for (int i = 0; i < count && status == PL_OK; ++i) {
        if (w->chosen[i] && !has_check(w, p, &checks[i])) {
            status = prepare_check(w, p, &checks[i], error);
        }
    }
    return status == PL_OK && p->other_count > 0
               ? make_runs(w, p, p->others, p->other_count, w->how->store, error)
               : status;
}

/* A plain run that is known is made again where its frames are needed. */
static pl_status make_pair(work *w, pair *p, pl_error *error)
{
    pl_status status = make_runs(w, p, &p->plain, 1, p->is_known ? NULL : w->how->store, error);
    if (status != PL_OK || *w->signal_number != 0) {
        return status;
    }
    if (finished(p->result)) {
        return make_checks(w, p, error);
    }
    w->bar.total -= p->missing;
    return p->is_known ? pl_fail(error, PL_FAILED,
                                 "%s on %s: made again for its frames, the plain run is %s: %s",
                                 p->plain.test_case.name, p->configuration->label,
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
        const json_t *study = json_object_get(result, "study");
        char *key = pl_heap_format("%s %s", pl_json_get_text(study, "plain"),
                                   pl_json_get_text(study, "check"));
        json_object_set_new_nocheck(made, key, json_true());
        free(key);
    }
    return made;
}

static void begin_pair(const work *w, const pl_plan *plan, const pl_planned_run *planned, pair *p)
{
    int count = 0;
    const pl_check *checks = pl_checks(&count);
    *p = (pair){.plan = plan,
                .configuration = planned->configuration,
                .size = pl_scene_size(&planned->test_case->scene),
                .plain = {.test_case = *planned->test_case}};
    p->plain.test_case.study = json_pack("{s:s, s:s}", "name", "metamorphic", "check", "plain");
    const pl_planned_run plain = planned_run(p, &p->plain.test_case);
    pl_planned_run_hash(plan, &plain, p->plain.run);
    const json_t *known = pl_store_find(w->how->store, p->plain.run);
    for (int i = 0; i < count; ++i) {
        p->missing += w->chosen[i] && !has_check(w, p, &checks[i]);
    }
    p->is_known = known != NULL;
    p->is_due = known == NULL || (p->missing > 0 && finished(known));
}

static void end_pair(pair *p)
{
    for (int i = 0; i < p->other_count; ++i) {
        pl_trajectory_close(&p->others[i].trajectory);
        pl_scene_free(&p->others[i].test_case.scene);
        json_decref(p->others[i].test_case.study);
    }
    free(p->others);
    pl_trajectory_close(&p->plain.trajectory);
    json_decref(p->plain.test_case.study);
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
    const pl_plan *plan = how->plan;
    const long count = pl_plan_size(plan);
    pair *pairs = pl_heap_new((size_t)count, sizeof *pairs);
    pl_status status = PL_OK;
    long total = 0;
    for (long i = 0; i < count; ++i) {
        const pl_planned_run planned = pl_plan_run(plan, i);
        begin_pair(&w, plan, &planned, &pairs[i]);
        total += pairs[i].is_due ? 1 + pairs[i].missing : 0;
    }
    if (how->progress != NULL) {
        w.bar = pl_progress_begin(how->progress, total, pl_monotonic_seconds());
    }
    for (long i = 0; i < count; ++i) {
        if (pairs[i].is_due && status == PL_OK && *signal_number == 0) {
            status = make_pair(&w, &pairs[i], error);
        }
        end_pair(&pairs[i]);
    }
    if (how->progress != NULL) {
        pl_progress_end(&w.bar);
    }
    json_decref(w.made);
    free(pairs);
    return status;
}
