/* The engines of a grid. */
#ifndef PLUMB_SWEEP_GRID_CONTENDERS_H
#define PLUMB_SWEEP_GRID_CONTENDERS_H

#include "grid.h"

/* How many, equal ones not yet taken as one. */
double pl_grid_contender_count(const pl_grid_def *def);

/* Adds all of them to the plan. PL_BAD_INPUT: a value out of its option's range, or two that would
 * have the same label. */
pl_status pl_grid_add_contenders(const pl_grid_def *def, pl_plan *plan, pl_error *error);

#endif
