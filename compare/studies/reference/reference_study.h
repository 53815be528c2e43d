/* The verdict on scene files that expect nothing: a converged reference for each, which engine
 * configuration differs from it, and ensembles after the horizon; as plumb.reference/1 (SCHEMA.md). */
#ifndef PLUMB_REFERENCE_STUDY_H
#define PLUMB_REFERENCE_STUDY_H

#include "runner/execute.h"

/* Judges the cases of the plan that are scene files which expect nothing. Of `how` the plan, jobs, limits, provenance,
 * progress and store are used. The store has the results of the plan: a run that crashed, timed out or was refused is
 * not made again. The plan's first repeats are run again for their paths, so that the file of a path is open in no run
 * whose result counts.
 *
 * Writes the outcome to DIRECTORY/reference.json, or removes that file where there is no such case. With `resumes` a case
 * of that file is kept where nothing changed. *outcome is a new reference; NULL where there is no such case, after a
 * failure and at a signal. An engine that fails, disagrees or has no reference is a sentence of the outcome and no
 * failure. PL_IO. */
pl_status pl_reference_study(const pl_execution_def *how, const char *directory, bool resumes,
                             json_t **outcome, int *signal_number, pl_error *error);

/* Writes the sentences of an outcome as text, under the name of each case. */
void pl_reference_study_print(FILE *out, const json_t *outcome);

#endif
