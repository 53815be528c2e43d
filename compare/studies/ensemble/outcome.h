/* From the results and trajectories of an ensemble's runs to what they say. */
#ifndef PLUMB_ENSEMBLE_OUTCOME_H
#define PLUMB_ENSEMBLE_OUTCOME_H

#include "members.h"

typedef struct pl_ensemble_outcome {
    json_t *json;    /* plumb.ensemble/1 */
    char *summary;   /* Markdown */
    int comparisons; /* how many could be made */
} pl_ensemble_outcome;

/* `results` is an array of plumb.result/1 with those of the plan's runs among others; `folder` has
 * their trajectories, and where they are gone `before` (NULL allowed), an earlier outcome, is asked
 * for the horizon. The caller frees *outcome by pl_ensemble_outcome_free, in any case. */
pl_status pl_ensemble_conclude(const pl_plan *plan, const pl_ensembles *ensembles,
                               const json_t *results, const char *folder, const json_t *before,
                               pl_ensemble_outcome *outcome, pl_error *error);
void pl_ensemble_outcome_free(pl_ensemble_outcome *outcome);

/* Removes the trajectories of the plan's runs, and the folder where it is empty then. */
void pl_ensemble_clear(const pl_plan *plan, const pl_ensembles *ensembles, const char *folder);

#endif
