/* Decides from results which runs of a sweep need not be made. */
#include "pruning.h"

#include "base/heap.h"
#include "base/text_buffer.h"
#include "results/result.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A text that a case has in common with its changes, and the configuration. */
static char *name_point(const pl_plan *plan, const pl_planned_run *run)
{
    const pl_case *test_case = run->test_case;
    pl_text_buffer text = {0};
    pl_text_format(&text, "%td %s %a", run->configuration - plan->configurations, test_case->name,
                   test_case->scene.dt);
    for (int i = 0; i < test_case->descriptor->param_count; ++i) {
        pl_text_format(&text, " %a", test_case->params[i]);
    }
    return pl_text_take(&text);
}

/* Notes the run, with the hash by which its result will be known. */
static void note_run(pl_repeats *repeats, const pl_plan *plan, const pl_planned_run *run)
{
    char *name = name_point(plan, run);
    char hash[17];
    pl_planned_run_hash(plan, run, hash);
    json_object_set_new(repeats->points, hash, json_string(name));
    if (run->test_case->variation.change != NULL) {
        json_object_set_new(repeats->changed, hash, json_true());
    } else if (run->repeat == 0) {
        json_object_set_new(repeats->first, hash, json_true());
    }
    free(name);
}

void pl_repeats_begin(pl_repeats *repeats, const pl_plan *plan, double limit)
{
    *repeats = (pl_repeats){.limit = limit,
                            .points = json_object(),
                            .first = json_object(),
                            .changed = json_object(),
                            .spared = json_object(),
                            .failed = json_object()};
    for (long i = 0; i < pl_plan_size(plan); ++i) {
        const pl_planned_run run = pl_plan_run(plan, i);
        note_run(repeats, plan, &run);
    }
}

void pl_repeats_free(pl_repeats *repeats)
{
    json_decref(repeats->points);
    json_decref(repeats->first);
    json_decref(repeats->changed);
    json_decref(repeats->spared);
    json_decref(repeats->failed);
    *repeats = (pl_repeats){0};
}

static const char *point_of(const pl_repeats *repeats, const char *run)
{
    return json_string_value(json_object_get(repeats->points, run));
}

/* The CPU time of the engine's steps, s. */
static double cost_of(const json_t *result)
{
    const json_t *done = json_object_get(json_object_get(result, "steps"), "done");
    return pl_result_metric(result, "time_per_step") * json_number_value(done);
}

void pl_repeats_see(pl_repeats *repeats, const json_t *result)
{
    const char *run = pl_json_get_text(result, "run");
    const char *point = point_of(repeats, run);
    const char *outcome = pl_json_get_text(result, "outcome");
    if (point == NULL || json_object_get(repeats->changed, run) != NULL) {
        return;
    }
    if (strcmp(outcome, "timeout") == 0 || cost_of(result) > repeats->limit) {
        json_object_set_new(repeats->spared, point, json_true());
    }
    if (strcmp(outcome, "ok") != 0 || pl_verdict_of(result) == PL_VERDICT_FAILED) {
        json_object_set_new(repeats->failed, point, json_true());
    }
}

bool pl_repeats_spare(const pl_repeats *repeats, const char *run)
{
    const char *point = point_of(repeats, run);
    if (point == NULL || json_object_get(repeats->first, run) != NULL) {
        return false;
    }
    const bool is_changed = json_object_get(repeats->changed, run) != NULL;
    return json_object_get(is_changed ? repeats->failed : repeats->spared, point) != NULL;
}

static double step_of(const json_t *run)
{
    return json_number_value(json_object_get(json_object_get(run, "settings"), "dt"));
}

static bool has_equal_params_but_dt(const json_t *run, const json_t *other)
{
    json_t *a = json_deep_copy(json_object_get(run, "params"));
    json_t *b = json_deep_copy(json_object_get(other, "params"));
    json_object_del(a, "dt");
    json_object_del(b, "dt");
    const bool equal = json_equal(a, b);
    json_decref(a);
    json_decref(b);
    return equal;
}

static bool is_same_text(const json_t *run, const json_t *other, const char *key)
{
    return strcmp(pl_json_get_text(run, key), pl_json_get_text(other, key)) == 0;
}

static bool is_finer(const json_t *run, const json_t *than)
{
    return step_of(run) < step_of(than) && is_same_text(run, than, "scenario") &&
           is_same_text(run, than, "label") && is_same_text(run, than, "change") &&
           has_equal_params_but_dt(run, than);
}

/* The result of a run that was not made. */
static json_t *result_of(json_t *identity, const json_t *timed_out, json_t *provenance)
{
    const json_t *asked = json_object_get(json_object_get(timed_out, "steps"), "asked");
    const double duration = json_number_value(asked) * step_of(timed_out);
    char *reason = pl_heap_format("not run: at a time step of 1/%g s, %s", 1 / step_of(timed_out),
                                  pl_json_get_text(timed_out, "reason"));
    json_t *result = pl_result_unmade(identity, PL_OUTCOME_TIMEOUT,
                                      lround(duration / step_of(identity)), reason, provenance);
    free(reason);
    return result;
}

pl_status pl_prune_timeouts(const pl_plan *plan, const json_t *result, json_t *provenance,
                            void *user,
                            pl_status (*keep)(void *user, json_t *result, pl_error *error),
                            pl_error *error)
{
    pl_status status = PL_OK;
    if (strcmp(pl_json_get_text(result, "outcome"), "timeout") != 0) {
        return PL_OK;
    }
    for (long i = 0; i < pl_plan_size(plan) && status == PL_OK; ++i) {
        const pl_planned_run run = pl_plan_run(plan, i);
        if (run.repeat > 0 || run.test_case->scene.dt >= step_of(result) ||
            strcmp(run.configuration->label, pl_json_get_text(result, "label")) != 0) {
            continue;
        }
        json_t *identity = pl_planned_run_identity(plan, &run);
        if (is_finer(identity, result)) {
            json_t *unmade = result_of(identity, result, provenance);
            status = keep(user, unmade, error);
            json_decref(unmade);
        }
        json_decref(identity);
    }
    return status;
}
