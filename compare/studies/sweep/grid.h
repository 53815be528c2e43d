/* The grid of a sweep: problems (time step and scenario parameters) x configurations (engines with
 * their options), as a plan.
 *
 * Problems come in the order asked for, the last key varying fastest; the configurations take turns
 * among the engines asked for, each engine's own in the same order. Equal points are one. */
#ifndef PLUMB_SWEEP_GRID_H
#define PLUMB_SWEEP_GRID_H

#include "runner/plan.h"
#include "shard.h"
#include "vary.h"

enum { PL_GRID_MOST_RUNS = 100000 };

typedef struct pl_grid_def {
    const pl_plan *base; /* the problems and engines as asked for, unvaried; repeats; seed */
    const pl_vary *varied;
    int varied_count;
    double dt, duration; /* s: asked for of scene files; NAN: their own */
    pl_shard shard;
} pl_grid_def;

/* Fills an empty plan with the shard's part of the grid, which may have no runs. A key goes to
 * every problem or engine that has it; where an engine or scenario has one restricted to it too,
 * that one counts. Its scenes are deferred.
 *
 * PL_BAD_INPUT: a key that nothing has (with the nearest one), that is given twice, or that both a
 * scenario and an engine have; a value out of its range, of the whole grid; more than
 * PL_GRID_MOST_RUNS runs in the whole grid; two engines whose labels are the same. The caller frees
 * the plan in any case. */
pl_status pl_grid_plan(const pl_grid_def *def, pl_plan *plan, pl_error *error);

/* Writes the plan's runs to `path` ("-" is standard output) in the order in which one process makes
 * them: a line of JSON each, plumb.plan/1 (results/SCHEMA.md). PL_IO, PL_NO_MEMORY. */
pl_status pl_grid_list(const pl_plan *plan, const char *path, pl_error *error);

#endif
