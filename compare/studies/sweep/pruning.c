/* Decides from results which runs of a sweep need not be made. */
#include "pruning.h"

#include "results/run_verdict.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static void name_point(const pl_plan *plan, const pl_planned_run *run, char name[48])
{
    snprintf(name, 48, "%td.%td", run->test_case - plan->cases,
             run->configuration - plan->configurations);
}

pl_status pl_repeats_begin(pl_repeats *repeats, const pl_plan *plan, double limit, pl_error *error)
{
    *repeats = (pl_repeats){
        .limit = limit, .points = json_object(), .first = json_object(), .spared = json_object()};
    bool made = repeats->points != NULL && repeats->first != NULL && repeats->spared != NULL;
    for (long i = 0; made && i < pl_plan_size(plan); ++i) {
        char name[48];
        const pl_planned_run run = pl_plan_run(plan, i);
        json_t *identity = pl_planned_run_identity(plan, &run);
        const char *hash = identity != NULL ? pl_json_get_text(identity, "run") : "";
        name_point(plan, &run, name);
        made =
            identity != NULL && json_object_set_new(repeats->points, hash, json_string(name)) == 0;
        if (made && run.repeat == 0) {
            made = json_object_set_new(repeats->first, hash, json_true()) == 0;
        }
        json_decref(identity);
    }
    return made ? PL_OK : pl_fail(error, PL_NO_MEMORY, "out of memory for the plan");
}

void pl_repeats_free(pl_repeats *repeats)
{
    json_decref(repeats->points);
    json_decref(repeats->first);
    json_decref(repeats->spared);
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
    const char *point = point_of(repeats, pl_json_get_text(result, "run"));
    bool ended = strcmp(pl_json_get_text(result, "outcome"), "timeout") != 0;
    if (point != NULL && (!ended || cost_of(result) > repeats->limit)) {
        json_object_set_new(repeats->spared, point, json_true());
    }
}

bool pl_repeats_spare(const pl_repeats *repeats, const char *run)
{
    const char *point = point_of(repeats, run);
    return point != NULL && json_object_get(repeats->first, run) == NULL &&
           json_object_get(repeats->spared, point) != NULL;
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
           is_same_text(run, than, "label") && has_equal_params_but_dt(run, than);
}

/* The result of a run that was not made. */
static json_t *outcome_of(const json_t *timed_out, double dt)
{
    const json_t *asked = json_object_get(json_object_get(timed_out, "steps"), "asked");
    const double duration = json_number_value(asked) * step_of(timed_out);
    pl_run_result outcome = {.outcome = PL_OUTCOME_TIMEOUT, .steps_asked = lround(duration / dt)};
    snprintf(outcome.reason, sizeof outcome.reason, "not run: at a time step of 1/%g s, %s",
             1 / step_of(timed_out), pl_json_get_text(timed_out, "reason"));
    return pl_run_result_to_json(&outcome);
}

static json_t *result_of(json_t *identity, const json_t *timed_out, json_t *provenance)
{
    char now[32];
    json_t *outcome = outcome_of(timed_out, step_of(identity));
    pl_timestamp(now);
    json_t *result =
        outcome == NULL ? NULL : pl_result_compose(identity, outcome, provenance, "", 0, now);
    json_decref(outcome);
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
        if (run.repeat > 0) {
            continue;
        }
        json_t *identity = pl_planned_run_identity(plan, &run);
        const bool is_due = identity == NULL || is_finer(identity, result);
        json_t *unmade =
            is_due && identity != NULL ? result_of(identity, result, provenance) : NULL;
        if (unmade != NULL) {
            status = keep(user, unmade, error);
        } else if (is_due) {
            status = pl_fail(error, PL_NO_MEMORY, "out of memory for a result");
        }
        json_decref(unmade);
        json_decref(identity);
    }
    return status;
}
