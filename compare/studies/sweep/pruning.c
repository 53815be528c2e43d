/* Decides from results which runs of a sweep need not be made. */
#include "pruning.h"

#include "base/heap.h"
#include "base/text_buffer.h"
#include "results/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void pl_pruning_begin(pl_pruning *pruning, const pl_plan *plan, double limit)
{
    *pruning = (pl_pruning){.plan = plan,
                            .limit = limit,
                            .runs = json_object(),
                            .spared = json_object(),
                            .failed = json_object()};
    for (long i = 0; i < pl_plan_size(plan); ++i) {
        const pl_planned_run run = pl_plan_run(plan, i);
        char hash[17];
        pl_planned_run_hash(plan, &run, hash);
        json_object_set_new(pruning->runs, hash, json_integer(i));
    }
}

void pl_pruning_free(pl_pruning *pruning)
{
    json_decref(pruning->runs);
    json_decref(pruning->spared);
    json_decref(pruning->failed);
    *pruning = (pl_pruning){0};
}

/* The run of that hash; without a case: the plan has none. */
static pl_planned_run find_run(const pl_pruning *pruning, const char *hash)
{
    const json_t *index = json_object_get(pruning->runs, hash);
    return index == NULL ? (pl_planned_run){.test_case = NULL}
                         : pl_plan_run(pruning->plan, (long)json_integer_value(index));
}

/* A text that a case has in common with its changes, and the configuration; `dt` (s) is in place of the time step. */
static char *name_point(const pl_plan *plan, const pl_planned_run *run, double dt)
{
    const pl_case *test_case = run->test_case;
    const int step = pl_scenario_param(test_case->descriptor, "dt");
    pl_text_buffer text = {0};
    pl_text_format(&text, "%td %s %a", run->configuration - plan->configurations, test_case->name,
                   dt);
    for (int i = 0; i < test_case->descriptor->param_count; ++i) {
        pl_text_format(&text, " %a", i == step ? dt : test_case->params[i]);
    }
    return pl_text_take(&text);
}

static bool has_point(const pl_pruning *pruning, const json_t *points, const pl_planned_run *run)
{
    char *point = name_point(pruning->plan, run, run->test_case->scene.dt);
    const bool found = json_object_get(points, point) != NULL;
    free(point);
    return found;
}

/* The CPU time of the engine's steps, s. */
static double cost_of(const json_t *result)
{
    const json_t *done = json_object_get(json_object_get(result, "steps"), "done");
    return pl_result_metric(result, "time_per_step") * json_number_value(done);
}

void pl_pruning_see(pl_pruning *pruning, const json_t *result)
{
    const pl_planned_run run = find_run(pruning, pl_json_get_text(result, "run"));
    const char *outcome = pl_json_get_text(result, "outcome");
    if (run.test_case == NULL || run.test_case->variation.change != NULL) {
        return;
    }
    char *point = name_point(pruning->plan, &run, run.test_case->scene.dt);
    if (strcmp(outcome, "timeout") == 0 || cost_of(result) > pruning->limit) {
        json_object_set_new(pruning->spared, point, json_true());
    }
    if (strcmp(outcome, "ok") != 0 || pl_verdict_of(result) == PL_VERDICT_FAILED) {
        json_object_set_new(pruning->failed, point, json_true());
    }
    free(point);
}

bool pl_pruning_spares(const pl_pruning *pruning, const char *hash)
{
    const pl_planned_run run = find_run(pruning, hash);
    if (run.test_case == NULL) {
        return false;
    }
    return run.test_case->variation.change != NULL
               ? has_point(pruning, pruning->failed, &run)
               : run.repeat > 0 && has_point(pruning, pruning->spared, &run);
}

/* The result of a run that was not made, because another one, at a time step of `dt`, timed out. */
static json_t *unmade(const pl_pruning *pruning, const pl_planned_run *run, const json_t *timed_out,
                      double dt, json_t *provenance)
{
    const json_t *asked = json_object_get(json_object_get(timed_out, "steps"), "asked");
    const double duration = json_number_value(asked) * dt;
    char *reason = pl_heap_format("not run: at a time step of 1/%g s, %s", 1 / dt,
                                  pl_json_get_text(timed_out, "reason"));
    json_t *identity = pl_planned_run_identity(pruning->plan, run);
    json_t *result =
        pl_result_unmade(identity, PL_OUTCOME_TIMEOUT, lround(duration / run->test_case->scene.dt),
                         reason, provenance);
    json_decref(identity);
    free(reason);
    return result;
}

pl_status pl_prune_timeouts(const pl_pruning *pruning, const json_t *result, json_t *provenance,
                            void *user,
                            pl_status (*keep)(void *user, json_t *result, pl_error *error),
                            pl_error *error)
{
    const pl_plan *plan = pruning->plan;
    const pl_planned_run ended = find_run(pruning, pl_json_get_text(result, "run"));
    pl_status status = PL_OK;
    if (strcmp(pl_json_get_text(result, "outcome"), "timeout") != 0 || ended.test_case == NULL) {
        return PL_OK;
    }
    char *series = name_point(plan, &ended, 0);
    for (long i = 0; i < pl_plan_size(plan) && status == PL_OK; ++i) {
        const pl_planned_run run = pl_plan_run(plan, i);
        char *other = name_point(plan, &run, 0);
        if (run.repeat == 0 && run.test_case->scene.dt < ended.test_case->scene.dt &&
            run.test_case->variation.change == ended.test_case->variation.change &&
            strcmp(other, series) == 0) {
            json_t *kept = unmade(pruning, &run, result, ended.test_case->scene.dt, provenance);
            status = keep(user, kept, error);
            json_decref(kept);
        }
        free(other);
    }
    free(series);
    return status;
}
