/* Evaluates the results and trajectories of an ensemble's runs, and reports them. */
#ifndef PLUMB_ENSEMBLE_REPORT_H
#define PLUMB_ENSEMBLE_REPORT_H

#include "members.h"

/* The evaluation of an ensemble study. The caller frees it by pl_ensemble_outcome_free. */
typedef struct pl_ensemble_outcome {
    json_t *json;    /* plumb.ensemble/1 */
    char *summary;   /* Markdown */
    char *text;      /* the summary for a terminal */
    int comparisons; /* how many were possible */
} pl_ensemble_outcome;

/* `results` is an array of plumb.result/1 that includes those of the plan's runs. `folder` has
 * their trajectories; where they are missing, the horizon is taken from `before`, an earlier
 * outcome (NULL allowed). `width` >= 1 is that of the terminal's lines. The caller frees *outcome in
 * any case. */
pl_status pl_ensemble_conclude(const pl_plan *plan, const pl_ensembles *ensembles,
                               const json_t *results, const char *folder, const json_t *before,
                               int width, pl_ensemble_outcome *outcome, pl_error *error);

/* Frees the JSON and the texts. */
void pl_ensemble_outcome_free(pl_ensemble_outcome *outcome);

/* Removes the trajectories of the plan's runs, and the folder if that leaves it empty. */
void pl_ensemble_clear(const pl_plan *plan, const pl_ensembles *ensembles, const char *folder);

#endif
