/* Searches for the least iteration budget, first by doubling and then by bisection. */
#include "iterations_to_tolerance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PL_MOST_ITERATIONS = 1024 };

static const double small_change = 0.01, near_enough = 1.1;

enum { MOST_DOUBLINGS = 64 };

typedef struct doubling_search {
    const pl_budget_search_def *def;
    pl_budget_found *found;
    double errors[MOST_DOUBLINGS]; /* of least 2^k; INFINITY where it failed */
    int count;
} doubling_search;

static pl_status evaluate_budget(doubling_search *s, long budget, pl_budget_trial *trial,
                                 double *error, pl_error *fault)
{
    double given = (double)INFINITY;
    s->found->trials += 1;
    pl_status status = s->def->try_budget(s->def->user, budget, trial, &given, fault);
    *error = *trial == PL_BUDGET_SUCCEEDED ? given : (double)INFINITY;
    return status;
}

static bool changed_little(const doubling_search *s, int k)
{
    double before = s->errors[k - 1], after = s->errors[k];
    return isfinite(before) && isfinite(after) &&
           fabs(after - before) <= small_change * before + s->def->floor;
}

static bool is_settled(const doubling_search *s)
{
    const int last = s->count - 1;
    return last >= 2 && changed_little(s, last) && changed_little(s, last - 1);
}

static pl_status double_up(doubling_search *s, pl_error *fault)
{
    pl_budget_found *found = s->found;
    bool any = false;
    for (long budget = s->def->least; !is_settled(s); budget *= 2) {
        pl_budget_trial trial = PL_BUDGET_FAILED;
        double *error = &s->errors[s->count];
        pl_status status = evaluate_budget(s, budget, &trial, error, fault);
        if (status != PL_OK) {
            return status;
        }
        found->largest = budget;
        if (trial == PL_BUDGET_END_SEARCH) {
            found->state = PL_BUDGET_STOPPED;
            return PL_OK;
        }
        s->count += 1;
        any = any || trial == PL_BUDGET_SUCCEEDED;
        if (budget > s->def->most / 2) {
            break;
        }
    }
    found->state = PL_BUDGET_FOUND;
    if (isinf(s->errors[s->count - 1])) {
        found->state = any ? PL_BUDGET_LARGEST_FAILED : PL_BUDGET_ALL_FAILED;
    }
    return PL_OK;
}

static bool is_near(const doubling_search *s, double error)
{
    return error <= near_enough * s->found->converged + s->def->floor;
}

/* Bisects between a doubling that is not near and the next one, which is. */
static pl_status bisect(doubling_search *s, long far, long near, pl_error *fault)
{
    while (near - far > 1) {
        const long midpoint = far + (near - far) / 2;
        pl_budget_trial trial = PL_BUDGET_FAILED;
        double error = (double)INFINITY;
        pl_status status = evaluate_budget(s, midpoint, &trial, &error, fault);
        if (status != PL_OK) {
            return status;
        }
        if (trial == PL_BUDGET_END_SEARCH) {
            s->found->state = PL_BUDGET_STOPPED;
            return PL_OK;
        }
        *(is_near(s, error) ? &near : &far) = midpoint;
    }
    s->found->budget = near;
    return PL_OK;
}

pl_status pl_budget_search(const pl_budget_search_def *def, pl_budget_found *found, pl_error *fault)
{
    *found = (pl_budget_found){.converged = (double)NAN};
    doubling_search s = {.def = def, .found = found};
    pl_status status = double_up(&s, fault);
    if (status != PL_OK || found->state != PL_BUDGET_FOUND) {
        return status;
    }
    found->converged = s.errors[s.count - 1];
    int k = 0;
    while (k < s.count - 1 && !(is_near(&s, s.errors[k]) && is_near(&s, s.errors[k + 1]))) {
        ++k;
    }
    const long near = def->least << k;
    return bisect(&s, k == 0 ? near - 1 : near / 2, near, fault);
}

int pl_budget_most_trials(long least, long most)
{
    long last = least;
    int trials = 1;
    while (last <= most / 2) {
        last *= 2;
        trials += 1;
    }
    for (long gap = last == least ? 1 : last / 2; gap > 1; gap -= gap / 2) {
        trials += 1;
    }
    return trials;
}

/* As in the report: errors that differ by less than 1e-9, in m or relative, are equal. */
static const double error_floor = 1e-9;

/* One search. */
typedef struct candidate {
    const pl_tolerance_def *def;
    const pl_case *test_case;
    const pl_configuration *configuration;
    int option; /* index of `iterations` */
    int signal_number;
    char outcome[32]; /* of the last run that failed, with `failed` iterations */
    long failed;
} candidate;

static void budgets_of(const pl_engine_info *engine, int option, long *least, long *most)
{
    *least = (long)fmax(1, ceil(engine->options[option].min));
    *most = (long)fmin(PL_MOST_ITERATIONS, floor(engine->options[option].max));
}

/* *due: whether a run of the pair is still to be made. */
static pl_status is_due(const pl_tolerance_def *def, const pl_case *test_case,
                        const pl_configuration *configuration, bool *due, pl_error *error)
{
    *due = def->skip == NULL;
    for (int repeat = 0; repeat < def->plan->repeats && !*due; ++repeat) {
        const pl_planned_run run = {
            .test_case = test_case, .configuration = configuration, .repeat = repeat};
        char hash[17];
        pl_status status = pl_planned_run_hash(def->plan, &run, hash, error);
        if (status != PL_OK) {
            return status;
        }
        *due = !def->skip(def->user, hash);
    }
    return PL_OK;
}

/* *runs is 0 where there is nothing to search. */
static pl_status most_runs_of(const candidate *c, long *runs, pl_error *error)
{
    bool due = false;
    *runs = 0;
    if (c->option < 0 || c->test_case->scene.primary_error[0] == '\0') {
        return PL_OK;
    }
    pl_status status = is_due(c->def, c->test_case, c->configuration, &due, error);
    long least, most;
    budgets_of(c->configuration->choice.engine, c->option, &least, &most);
    if (status == PL_OK && due && least <= most) {
        *runs = pl_budget_most_trials(least, most);
    }
    return status;
}

static candidate candidate_of(const pl_tolerance_def *def, int test_case, int configuration)
{
    const pl_configuration *of = &def->plan->configurations[configuration];
    return (candidate){.def = def,
                       .test_case = &def->plan->cases[test_case],
                       .configuration = of,
                       .option = pl_engine_option_index(of->choice.engine, "iterations")};
}

static void judge(candidate *c, const json_t *result, long budget, pl_budget_trial *trial,
                  double *found)
{
    const char *outcome = pl_json_get_text(result, "outcome");
    const double value = pl_result_metric(result, pl_metric_table[PL_METRIC_REFERENCE_ERROR].name);
    const bool ok = strcmp(outcome, "ok") == 0;
    const bool ends_search = strcmp(outcome, "timeout") == 0 || strcmp(outcome, "unsupported") == 0;
    if (ok && !isnan(value)) {
        *trial = PL_BUDGET_SUCCEEDED;
        *found = value;
        return;
    }
    *trial = ends_search ? PL_BUDGET_END_SEARCH : PL_BUDGET_FAILED;
    snprintf(c->outcome, sizeof c->outcome, "%s", ok ? "no error" : outcome);
    c->failed = budget;
}

/* One run of the scene with that many iterations. */
static pl_status try_budget(void *user, long budget, pl_budget_trial *trial, double *found,
                            pl_error *error)
{
    candidate *c = user;
    pl_configuration configuration = *c->configuration;
    configuration.choice.values[c->option] = (double)budget;
    pl_engine_choice_label(&configuration.choice, configuration.label);
    const pl_execution_def execution = {.plan = c->def->plan,
                                        .limits = c->def->limits,
                                        .provenance = c->def->provenance,
                                        .store = c->def->store,
                                        .bar = c->def->bar};
    json_t *result = NULL;
    pl_case trial_case = *c->test_case;
    trial_case.study = json_pack("{s:s}", "name", "iterations");
    pl_status status =
        pl_execute_one(&execution, &trial_case, &configuration, &result, &c->signal_number, error);
    json_decref(trial_case.study);
    *trial = PL_BUDGET_END_SEARCH;
    if (status == PL_OK && c->signal_number == 0) {
        judge(c, result, budget, trial, found);
    }
    json_decref(result);
    return status;
}

static void conclude(const candidate *c, const pl_budget_found *found, pl_metric *metric)
{
    if (found->state == PL_BUDGET_FOUND) {
        *metric = (pl_metric){.state = PL_METRIC_VALUE, .value = (double)found->budget};
        return;
    }
    if (strcmp(c->outcome, "unsupported") == 0) {
        return;
    }
    metric->state = PL_METRIC_FAILED;
    if (found->state == PL_BUDGET_ALL_FAILED) {
        snprintf(metric->reason, sizeof metric->reason,
                 "the run is not ok with up to %ld iterations: %s", found->largest, c->outcome);
    } else {
        snprintf(metric->reason, sizeof metric->reason,
                 "no converged error: %s with %ld iterations", c->outcome, c->failed);
    }
}

static pl_status search(candidate *c, pl_metric *metric, int *signal_number, pl_error *error)
{
    long runs = 0;
    pl_budget_found found;
    pl_budget_search_def def = {.floor = error_floor, .user = c, .try_budget = try_budget};
    pl_status status = most_runs_of(c, &runs, error);
    if (status != PL_OK || runs == 0) {
        return status;
    }
    budgets_of(c->configuration->choice.engine, c->option, &def.least, &def.most);
    status = pl_budget_search(&def, &found, error);
    *signal_number = c->signal_number;
    if (status != PL_OK || *signal_number != 0) {
        return status;
    }
    conclude(c, &found, metric);
    if (c->def->bar != NULL) {
        c->def->bar->total -= runs - found.trials;
    }
    return PL_OK;
}

pl_status pl_tolerance_most_runs(const pl_tolerance_def *def, long *runs, pl_error *error)
{
    const pl_plan *plan = def->plan;
    pl_status status = PL_OK;
    *runs = 0;
    for (int i = 0; i < plan->case_count * plan->configuration_count && status == PL_OK; ++i) {
        const candidate c =
            candidate_of(def, i / plan->configuration_count, i % plan->configuration_count);
        long most = 0;
        status = most_runs_of(&c, &most, error);
        *runs += most;
    }
    return status;
}

pl_status pl_tolerance_search(const pl_tolerance_def *def, pl_metric **metrics, int *signal_number,
                              pl_error *error)
{
    const pl_plan *plan = def->plan;
    const int count = plan->case_count * plan->configuration_count;
    pl_status status = PL_OK;
    *signal_number = 0;
    *metrics = calloc((size_t)count + 1, sizeof **metrics);
    if (*metrics == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d searches", count);
    }
    for (int i = 0; i < count && status == PL_OK && *signal_number == 0; ++i) {
        candidate c =
            candidate_of(def, i / plan->configuration_count, i % plan->configuration_count);
        status = search(&c, &(*metrics)[i], signal_number, error);
    }
    return status;
}

/* The place of the result's case and configuration; -1 when they are not the plan's. */
static int place_of(const pl_plan *plan, const json_t *result)
{
    for (int p = 0; p < plan->case_count; ++p) {
        const pl_case *test_case = &plan->cases[p];
        if (strcmp(test_case->name, pl_json_get_text(result, "scenario")) != 0 ||
            strcmp(test_case->scene_hash, pl_json_get_text(result, "scene_hash")) != 0) {
            continue;
        }
        for (int c = 0; c < plan->configuration_count; ++c) {
            if (strcmp(plan->configurations[c].label, pl_json_get_text(result, "label")) == 0) {
                return p * plan->configuration_count + c;
            }
        }
    }
    return -1;
}

void pl_tolerance_put(const pl_plan *plan, const pl_metric *metrics, json_t *result)
{
    const int place = place_of(plan, result);
    if (place < 0 || metrics[place].state == PL_METRIC_ABSENT) {
        return;
    }
    /* A result with this metric only gives it the form of all others. */
    pl_run_result only = {.outcome = PL_OUTCOME_OK};
    only.metrics.item[PL_METRIC_ITERATIONS_TO_TOLERANCE] = metrics[place];
    json_t *object = pl_run_result_to_json(&only);
    json_object_update(json_object_get(result, "metrics"), json_object_get(object, "metrics"));
    json_decref(object);
}
