/* The metric iterations_to_tolerance of every scenario on every engine of a plan: the least budget
 * of solver iterations whose error is as good as the converged one. It is searched by isolated runs
 * with other values of the engine's option `iterations`. All searches run side by side, one trial of
 * each in a round. */
#ifndef PLUMB_ITERATIONS_TO_TOLERANCE_H
#define PLUMB_ITERATIONS_TO_TOLERANCE_H

#include "runner/execute.h"

/* Makes the trials of all searches, which belong to the study "iterations", and then the runs of the plan as
 * pl_execute does, whose results get the metric before the store has them. `how` has no callbacks and no bar. The
 * metric is absent where the engine has no option `iterations` or its profile refuses it, where the scene has no
 * primary error, and where the store has all runs of the pair. */
pl_status pl_tolerance_execute(const pl_execution_def *how, int *signal_number, pl_error *error);

#endif
