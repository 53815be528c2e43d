#include "iterations_to_tolerance.h"

#include "base/heap.h"
#include "budget_search.h"
#include "studies/searches.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PL_MOST_ITERATIONS = 1024 };

/* As in the report: errors that differ by less than 1e-9, in m or relative, are equal. */
static const double error_floor = 1e-9;

/* What a search has found so far. */
typedef struct found {
    pl_budget_search budgets;
    char outcome[32]; /* of the last trial that failed, with `failed` iterations */
    long failed;
    pl_metric metric;
} found;

typedef struct work {
    pl_searches searches;
    found *found; /* of each search */
    json_t *study;
    pl_progress bar;
} work;

/* Whether a run of the pair is still to be made. */
static bool is_due(const pl_execution_def *how, const pl_planned_run *pair)
{
    bool due = how->store == NULL;
    for (int repeat = 0; repeat < how->plan->repeats && !due; ++repeat) {
        const pl_planned_run run = {pair->test_case, pair->configuration, repeat};
        char hash[17];
        pl_planned_run_hash(how->plan, &run, hash);
        due = pl_store_find(how->store, hash) == NULL;
    }
    return due;
}

/* Adds the search of a pair, unless there is nothing to search. */
static void add_search(work *w, int test_case, int configuration)
{
    const pl_execution_def *how = w->searches.how;
    const pl_plan *plan = how->plan;
    const pl_planned_run pair = {&plan->cases[test_case], &plan->configurations[configuration], 0};
    const pl_engine_info *engine = pair.configuration->choice.engine;
    const int option = pl_engine_option_index(engine, "iterations");
    if (option < 0 || pair.test_case->scene.primary_error[0] == '\0') {
        return;
    }
    const long least = (long)fmax(1, ceil(engine->options[option].min)),
               most = (long)fmin(PL_MOST_ITERATIONS, floor(engine->options[option].max));
    if (least <= most && is_due(how, &pair)) {
        const pl_search added = {.test_case = test_case,
                                 .configuration = configuration,
                                 .param = -1,
                                 .option = option,
                                 .study = w->study,
                                 .most = pl_budget_most_trials(least, most)};
        w->found[w->searches.count].budgets = pl_budget_begin(least, most, error_floor);
        pl_push(&w->searches.items, &w->searches.count, &added, sizeof added);
    }
}

/* Sets the metric of a search that has ended. */
static void conclude(found *f)
{
    const pl_budget_search *budgets = &f->budgets;
    pl_metric *metric = &f->metric;
    if (budgets->state == PL_BUDGET_FOUND) {
        *metric = (pl_metric){.state = PL_METRIC_VALUE, .value = (double)budgets->budget};
        return;
    }
    if (strcmp(f->outcome, "unsupported") == 0) {
        return;
    }
    metric->state = PL_METRIC_FAILED;
    if (budgets->state == PL_BUDGET_ALL_FAILED) {
        snprintf(metric->reason, sizeof metric->reason,
                 "the run is not ok with up to %ld iterations: %s", budgets->largest, f->outcome);
    } else {
        snprintf(metric->reason, sizeof metric->reason,
                 "no converged error: %s with %ld iterations", f->outcome, f->failed);
    }
}

static double next(void *user, int search)
{
    return (double)pl_budget_next(&((work *)user)->found[search].budgets);
}

static bool take(void *user, int search, const json_t *result)
{
    found *f = &((work *)user)->found[search];
    const char *outcome = pl_json_get_text(result, "outcome");
    const double value = pl_result_metric(result, pl_metric_table[PL_METRIC_REFERENCE_ERROR].name);
    const bool ok = strcmp(outcome, "ok") == 0;
    const bool ends_search = strcmp(outcome, "timeout") == 0 || strcmp(outcome, "unsupported") == 0;
    if (!ok || isnan(value)) {
        snprintf(f->outcome, sizeof f->outcome, "%s", ok ? "no error" : outcome);
        f->failed = pl_budget_next(&f->budgets);
    }
    pl_budget_take(&f->budgets, ok && !isnan(value) ? value
                                : ends_search       ? (double)NAN
                                                    : (double)INFINITY);
    if (f->budgets.state != PL_BUDGET_SEARCHING) {
        conclude(f);
    }
    return f->budgets.state != PL_BUDGET_SEARCHING;
}

/* Whether the result is of the search's case and configuration. */
static bool is_of(const pl_plan *plan, const pl_search *s, const json_t *result)
{
    const pl_case *test_case = &plan->cases[s->test_case];
    return strcmp(test_case->name, pl_json_get_text(result, "scenario")) == 0 &&
           strcmp(test_case->scene_hash, pl_json_get_text(result, "scene_hash")) == 0 &&
           strcmp(plan->configurations[s->configuration].label,
                  pl_json_get_text(result, "label")) == 0;
}

/* Puts the metric into the result of a run of the plan. */
static void amend(void *user, json_t *result)
{
    const work *w = user;
    for (int i = 0; i < w->searches.count; ++i) {
        const pl_metric *metric = &w->found[i].metric;
        if (metric->state != PL_METRIC_ABSENT &&
            is_of(w->searches.how->plan, &w->searches.items[i], result)) {
            /* A result with this metric only gives it the form of all others. */
            pl_run_result only = {.outcome = PL_OUTCOME_OK};
            only.metrics.item[PL_METRIC_ITERATIONS_TO_TOLERANCE] = *metric;
            json_t *object = pl_run_result_to_json(&only);
            json_object_update(json_object_get(result, "metrics"),
                               json_object_get(object, "metrics"));
            json_decref(object);
        }
    }
}

pl_status pl_tolerance_execute(const pl_execution_def *how, int *signal_number, pl_error *error)
{
    const pl_plan *plan = how->plan;
    const int pairs = plan->case_count * plan->configuration_count;
    work w = {.searches = {.how = how, .bar = &w.bar, .next = next, .take = take, .user = &w},
              .found = pl_heap_new((size_t)pairs, sizeof *w.found),
              .study = json_pack("{s:s}", "name", "iterations")};
    long runs = pl_execution_due(how, NULL);
    for (int i = 0; i < pairs; ++i) {
        add_search(&w, i / plan->configuration_count, i % plan->configuration_count);
    }
    for (int i = 0; i < w.searches.count; ++i) {
        runs += w.searches.items[i].most;
    }
    w.bar = pl_progress_begin(how->progress, runs, pl_monotonic_seconds());
    pl_status status = pl_searches_run(&w.searches, signal_number, error);
    if (status == PL_OK && *signal_number == 0) {
        pl_execution_def execution = *how;
        execution.bar = &w.bar;
        execution.user = &w;
        execution.amend = amend;
        status = pl_execute(&execution, signal_number, error);
    }
    pl_progress_end(&w.bar);
    json_decref(w.study);
    free(w.searches.items);
    free(w.found);
    return status;
}
