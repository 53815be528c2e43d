#include "searches.h"

#include <string.h>

/* A trial may belong to several searches: two labels of one engine. */
static pl_status take(void *user, json_t *result, pl_error *error)
{
    pl_searches *all = user;
    (void)error;
    for (int i = 0; i < all->count; ++i) {
        pl_search *s = &all->items[i];
        if (strcmp(s->run, pl_json_get_text(result, "run")) == 0) {
            s->run[0] = '\0';
            s->trials += 1;
            s->is_over = all->take(all->user, i, result);
            if (s->is_over && all->bar != NULL) {
                all->bar->total -= s->most - s->trials;
            }
        }
    }
    return PL_OK;
}

/* Adds the next trial of a search to the round. */
static pl_status add_trial(pl_searches *all, int search, pl_plan *round, pl_error *error)
{
    pl_search *s = &all->items[search];
    const pl_case *test_case = &all->how->plan->cases[s->test_case];
    const pl_scenario *scenario = test_case->descriptor;
    pl_configuration trial = all->how->plan->configurations[s->configuration];
    const double value = all->next(all->user, search);
    double values[PL_MAX_PARAMS];
    int index = -1;
    memcpy(values, test_case->params, sizeof values);
    if (s->param >= 0) {
        values[s->param] = value;
    } else {
        trial.choice.values[s->option] = value;
        pl_engine_choice_label(&trial.choice, trial.label);
    }
    round->study = s->study;
    const pl_status status = pl_plan_add_values(round, scenario, values, &index, error);
    if (status != PL_OK) {
        return status;
    }
    if (index < 0) {
        return pl_fail(error, PL_FAILED, "%s: %s=%.17g gives the scene of another value",
                       scenario->name, scenario->params[s->param].name, value);
    }
    const int configuration = pl_plan_add_choice(round, &trial.choice, trial.label);
    const pl_planned_run planned = {.test_case = &round->cases[index],
                                    .configuration = &round->configurations[configuration]};
    pl_planned_run_hash(round, &planned, s->run);
    pl_plan_add_pairing(round, index, configuration);
    return PL_OK;
}

/* One trial of every search that is not over; *any is false when there was none. */
static pl_status run_round(pl_searches *all, bool *any, int *signal_number, pl_error *error)
{
    pl_plan round = {.repeats = 1, .seed = all->how->plan->seed};
    pl_status status = PL_OK;
    for (int i = 0; i < all->count && status == PL_OK; ++i) {
        if (!all->items[i].is_over) {
            status = add_trial(all, i, &round, error);
        }
    }
    *any = round.pairing_count > 0;
    if (status == PL_OK && *any) {
        pl_execution_def execution = *all->how;
        execution.plan = &round;
        execution.recordings = NULL;
        execution.progress = NULL;
        execution.bar = all->bar;
        execution.user = all;
        execution.take = take;
        status = pl_execute(&execution, signal_number, error);
    }
    pl_plan_free(&round);
    return status;
}

pl_status pl_searches_run(pl_searches *searches, int *signal_number, pl_error *error)
{
    bool any = true;
    pl_status status = PL_OK;
    while (status == PL_OK && any && *signal_number == 0) {
        status = run_round(searches, &any, signal_number, error);
    }
    return status;
}
