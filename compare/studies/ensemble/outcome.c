#include "outcome.h"

#include "ensemble_json.h"
#include "runner/execute.h"
#include "summary.h"

#include <stdlib.h>
#include <unistd.h>

static pl_status look(const pl_plan *plan, const pl_ensemble *ensemble, int members,
                      const json_t *by_run, const char *folder, const json_t *before,
                      pl_ensemble_view *view, pl_error *error)
{
    view->ensemble = ensemble;
    pl_status status =
        pl_observations_gather(plan, ensemble, members, by_run, &view->observed, error);
    if (status == PL_OK) {
        status = pl_horizon_find(plan, ensemble, members, folder, &view->horizon, error);
    }
    if (status == PL_OK && !view->horizon.known) {
        pl_horizon_recall(before, plan, ensemble, members, &view->horizon);
    }
    return status;
}

pl_status pl_ensemble_conclude(const pl_plan *plan, const pl_ensembles *ensembles,
                               const json_t *results, const char *folder, const json_t *before,
                               pl_ensemble_outcome *outcome, pl_error *error)
{
    pl_verdicts verdicts = {.count = 0};
    json_t *by_run = pl_results_by_run(results);
    pl_ensemble_view *views = calloc((size_t)ensembles->count + 1, sizeof *views);
    pl_status status = by_run == NULL || views == NULL
                           ? pl_fail(error, PL_NO_MEMORY, "out of memory for the outcome")
                           : PL_OK;
    *outcome = (pl_ensemble_outcome){.json = NULL};
    for (int i = 0; i < ensembles->count && status == PL_OK; ++i) {
        status = look(plan, &ensembles->items[i], ensembles->members, by_run, folder, before,
                      &views[i], error);
    }
    if (status == PL_OK) {
        status = pl_verdicts_reach(views, ensembles->count, &verdicts, error);
    }
    if (status == PL_OK) {
        outcome->comparisons = verdicts.count;
        outcome->json = pl_ensemble_to_json(plan, ensembles, views, &verdicts);
        outcome->summary = pl_ensemble_summary(plan, ensembles, views, &verdicts);
        if (outcome->json == NULL || outcome->summary == NULL) {
            status = pl_fail(error, PL_NO_MEMORY, "out of memory for the outcome");
        }
    }
    for (int i = 0; i < ensembles->count && views != NULL; ++i) {
        pl_observations_free(&views[i].observed);
    }
    pl_verdicts_free(&verdicts);
    free(views);
    json_decref(by_run);
    return status;
}

void pl_ensemble_outcome_free(pl_ensemble_outcome *outcome)
{
    json_decref(outcome->json);
    free(outcome->summary);
    *outcome = (pl_ensemble_outcome){.json = NULL};
}

void pl_ensemble_clear(const pl_plan *plan, const pl_ensembles *ensembles, const char *folder)
{
    for (int i = 0; i < ensembles->count; ++i) {
        for (int k = 0; k < ensembles->members; ++k) {
            char run[17];
            pl_member_run(plan, &ensembles->items[i], k, run);
            char *path = pl_positions_path(folder, run);
            if (path != NULL) {
                unlink(path);
            }
            free(path);
        }
    }
    rmdir(folder);
}
