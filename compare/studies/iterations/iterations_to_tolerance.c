#include "iterations_to_tolerance.h"

#include "base/heap.h"
#include "budget_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PL_MOST_ITERATIONS = 1024 };

/* As in the report: errors that differ by less than 1e-9, in m or relative, are equal. */
static const double error_floor = 1e-9;

/* The search of one case on one configuration. */
typedef struct search {
    int test_case, configuration; /* indices in the plan */
    int option;                   /* index of `iterations` */
    pl_budget_search budgets;
    int most;         /* trials that it can take */
    char run[17];     /* hash of the trial in progress; empty: none */
    char outcome[32]; /* of the last trial that failed, with `failed` iterations */
    long failed;
    pl_metric metric;
} search;

typedef struct searches {
    const pl_execution_def *how;
    search *items; /* (count) */
    int count;
    pl_progress bar;
} searches;

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
static void add_search(searches *all, int test_case, int configuration)
{
    const pl_plan *plan = all->how->plan;
    const pl_planned_run pair = {&plan->cases[test_case], &plan->configurations[configuration], 0};
    const pl_engine_info *engine = pair.configuration->choice.engine;
    const int option = pl_engine_option_index(engine, "iterations");
    if (option < 0 || pair.test_case->scene.primary_error[0] == '\0') {
        return;
    }
    const long least = (long)fmax(1, ceil(engine->options[option].min)),
               most = (long)fmin(PL_MOST_ITERATIONS, floor(engine->options[option].max));
    if (least <= most && is_due(all->how, &pair)) {
        const search added = {.test_case = test_case,
                              .configuration = configuration,
                              .option = option,
                              .budgets = pl_budget_begin(least, most, error_floor),
                              .most = pl_budget_most_trials(least, most)};
        pl_push(&all->items, &all->count, &added, sizeof added);
    }
}

/* Sets the metric of a search that has ended. */
static void conclude(search *s)
{
    const pl_budget_search *found = &s->budgets;
    pl_metric *metric = &s->metric;
    if (found->state == PL_BUDGET_FOUND) {
        *metric = (pl_metric){.state = PL_METRIC_VALUE, .value = (double)found->budget};
        return;
    }
    if (strcmp(s->outcome, "unsupported") == 0) {
        return;
    }
    metric->state = PL_METRIC_FAILED;
    if (found->state == PL_BUDGET_ALL_FAILED) {
        snprintf(metric->reason, sizeof metric->reason,
                 "the run is not ok with up to %ld iterations: %s", found->largest, s->outcome);
    } else {
        snprintf(metric->reason, sizeof metric->reason,
                 "no converged error: %s with %ld iterations", s->outcome, s->failed);
    }
}

static void judge(search *s, const json_t *result)
{
    const char *outcome = pl_json_get_text(result, "outcome");
    const double value = pl_result_metric(result, pl_metric_table[PL_METRIC_REFERENCE_ERROR].name);
    const bool ok = strcmp(outcome, "ok") == 0;
    const bool ends_search = strcmp(outcome, "timeout") == 0 || strcmp(outcome, "unsupported") == 0;
    if (ok && !isnan(value)) {
        pl_budget_take(&s->budgets, PL_BUDGET_SUCCEEDED, value);
        return;
    }
    snprintf(s->outcome, sizeof s->outcome, "%s", ok ? "no error" : outcome);
    s->failed = pl_budget_next(&s->budgets);
    pl_budget_take(&s->budgets, ends_search ? PL_BUDGET_END_SEARCH : PL_BUDGET_FAILED, 0);
}

/* A trial may belong to several searches: two labels of one engine. */
static pl_status take(void *user, json_t *result, pl_error *error)
{
    searches *all = user;
    (void)error;
    for (int i = 0; i < all->count; ++i) {
        search *s = &all->items[i];
        if (strcmp(s->run, pl_json_get_text(result, "run")) == 0) {
            s->run[0] = '\0';
            judge(s, result);
            if (s->budgets.state != PL_BUDGET_SEARCHING) {
                conclude(s);
                all->bar.total -= s->most - s->budgets.trials;
            }
        }
    }
    return PL_OK;
}

/* Adds the scene of a search with its next number of iterations to the round. */
static void add_trial(pl_plan *round, const pl_plan *plan, search *s)
{
    pl_configuration trial = plan->configurations[s->configuration];
    trial.choice.values[s->option] = (double)pl_budget_next(&s->budgets);
    pl_engine_choice_label(&trial.choice, trial.label);
    const pl_planned_run planned = {&round->cases[s->test_case], &trial, 0};
    pl_planned_run_hash(round, &planned, s->run);
    pl_push(&round->configurations, &round->configuration_count, &trial, sizeof trial);
    pl_plan_add_pairing(round, s->test_case, round->configuration_count - 1);
}

/* One trial of every search that is not over. `cases` are those of the plan, with the study. */
static pl_status run_round(searches *all, pl_case *cases, int *signal_number, pl_error *error)
{
    const pl_plan *plan = all->how->plan;
    pl_plan round = {
        .cases = cases, .case_count = plan->case_count, .repeats = 1, .seed = plan->seed};
    pl_execution_def execution = *all->how;
    for (int i = 0; i < all->count; ++i) {
        if (all->items[i].budgets.state == PL_BUDGET_SEARCHING) {
            add_trial(&round, plan, &all->items[i]);
        }
    }
    execution.plan = &round;
    execution.recordings = NULL;
    execution.bar = &all->bar;
    execution.user = all;
    execution.take = take;
    const pl_status status = pl_execute(&execution, signal_number, error);
    free(round.configurations);
    free(round.pairings);
    return status;
}

static bool is_over(const searches *all)
{
    bool over = true;
    for (int i = 0; i < all->count; ++i) {
        over = over && all->items[i].budgets.state != PL_BUDGET_SEARCHING;
    }
    return over;
}

static pl_status run_searches(searches *all, int *signal_number, pl_error *error)
{
    const pl_plan *plan = all->how->plan;
    pl_case *cases = pl_heap_new((size_t)plan->case_count + 1, sizeof *cases);
    json_t *study = json_pack("{s:s}", "name", "iterations");
    pl_status status = PL_OK;
    for (int i = 0; i < plan->case_count; ++i) {
        cases[i] = plan->cases[i];
        cases[i].study = study;
    }
    while (status == PL_OK && *signal_number == 0 && !is_over(all)) {
        status = run_round(all, cases, signal_number, error);
    }
    json_decref(study);
    free(cases);
    return status;
}

/* Whether the result is of the search's case and configuration. */
static bool is_of(const pl_plan *plan, const search *s, const json_t *result)
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
    const searches *all = user;
    for (int i = 0; i < all->count; ++i) {
        const search *s = &all->items[i];
        if (s->metric.state != PL_METRIC_ABSENT && is_of(all->how->plan, s, result)) {
            /* A result with this metric only gives it the form of all others. */
            pl_run_result only = {.outcome = PL_OUTCOME_OK};
            only.metrics.item[PL_METRIC_ITERATIONS_TO_TOLERANCE] = s->metric;
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
    searches all = {.how = how};
    long runs = pl_execution_due(how);
    for (int i = 0; i < plan->case_count * plan->configuration_count; ++i) {
        add_search(&all, i / plan->configuration_count, i % plan->configuration_count);
    }
    for (int i = 0; i < all.count; ++i) {
        runs += all.items[i].most;
    }
    pl_execution_def execution = *how;
    all.bar = pl_progress_begin(how->progress, runs, pl_monotonic_seconds());
    execution.bar = &all.bar;
    execution.user = &all;
    execution.amend = amend;
    pl_status status = run_searches(&all, signal_number, error);
    if (status == PL_OK && *signal_number == 0) {
        status = pl_execute(&execution, signal_number, error);
    }
    pl_progress_end(&all.bar);
    free(all.items);
    return status;
}
