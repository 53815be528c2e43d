/* Metamorphic checks: for each scene and engine a plain run, and for each check the run of a
 * transformed scene that must agree with it. */
#ifndef PLUMB_METAMORPHIC_H
#define PLUMB_METAMORPHIC_H

#include "check_list.h"
#include "runner/execute.h"
#include "studies/study.h"

/* Makes the plain run of each case of how->plan on each configuration, and the checks of it that are chosen[] of
 * pl_checks. A check is made once the plain run has come to its end; one that does
 * not apply to the scene gets the outcome `unsupported` without a run. What the frames say is added to each result as
 * the object `agreement` (results/SCHEMA.md). A signal ends it as in pl_execute. PL_FAILED: a plain run that is made
 * again, because its frames are needed, does not come to its end as it did before. */
pl_status pl_metamorphic_run(const bool *chosen, const pl_execution_def *how, int *signal_number,
                             pl_error *error);

/* The study: its conclusion is an array of plumb.metamorphic/1 (results/SCHEMA.md). */
extern const pl_study pl_metamorphic_study;

#endif
