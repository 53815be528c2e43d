/* Ensembles: many runs from almost the same start on each engine, whose end states are compared as distributions. */
#ifndef PLUMB_ENSEMBLE_H
#define PLUMB_ENSEMBLE_H

#include "members.h"
#include "runner/execute.h"
#include "studies/study.h"

/* Gives each case of a plan of pl_members_plan the object `study` (results/SCHEMA.md). `against` has the texts of the
 * other settings, by their number from 1. */
void pl_ensemble_mark(const pl_ensembles *ensembles, const char *const *against, pl_plan *plan);

/* Makes the runs of such a plan, how->plan. `how` has a folder of positions, which gets the members'
 * trajectories. What the conclusion needs of a scene is added to each result as the object `ensemble`. A signal ends it
 * as in pl_execute. */
pl_status pl_ensemble_run(const pl_ensembles *ensembles, const pl_execution_def *how,
                          int *signal_number, pl_error *error);

/* As pl_study.conclude. */
pl_status pl_ensemble_conclude(const json_t *results, const char *folder, json_t **outcome,
                               pl_error *error);

/* The study: its conclusion is plumb.ensemble/1 (SCHEMA.md). Horizons follow from the files in FOLDER/trajectories,
 * and where one is missing they are those of FOLDER/ensemble.json of the same runs. */
extern const pl_study pl_ensemble_study;

#endif
