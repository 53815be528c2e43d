/* The verdict on scene files that expect nothing: a converged reference for each, which engine
 * configuration differs from it, and ensembles after the horizon; as plumb.reference/1 (SCHEMA.md). */
#ifndef PLUMB_REFERENCE_STUDY_H
#define PLUMB_REFERENCE_STUDY_H

#include "runner/execute.h"

/* What to judge. The pointers are borrowed. */
typedef struct pl_reference_study_def {
    /* The plan, jobs, limits, provenance, store and progress are used. `positions` is an existing folder for
     * the paths. The plan's first repeats are run again for theirs, so that the file of a path is open
     * in no run whose result counts. */
    pl_execution_def execution;
    const json_t
        *results; /* of the plan: what crashed, timed out or was refused is not run again */
    const json_t
        *before; /* an earlier outcome, whose cases are kept where nothing changed; or NULL */
} pl_reference_study_def;

/* How many cases of the plan get a reference. */
int pl_reference_study_cases(const pl_plan *plan);

/* How many of them `before` (NULL allowed) does not have with the same runs. */
int pl_reference_study_due(const pl_plan *plan, const json_t *before);

/* Judges all those cases; *outcome is a new reference, NULL after a failure and at a signal. An
 * engine that fails, disagrees or has no reference is a sentence of the outcome and no failure. */
pl_status pl_reference_study(const pl_reference_study_def *def, json_t **outcome,
                             int *signal_number, pl_error *error);

/* Writes the sentences of an outcome as text, under the name of each case. */
void pl_reference_study_print(FILE *out, const json_t *outcome);

#endif
