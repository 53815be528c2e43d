/* The grid of a sweep, as a plan: cases (time steps and scenario parameters) x engine
 * configurations (engines with their options).
 *
 * Problems come in the order in which they were asked for, the last key varying fastest. The
 * configurations alternate among the engines, those of one engine in the same order. Equal points
 * appear once. Changed scenes come after all others, and are not repeated. */
#ifndef PLUMB_SWEEP_GRID_H
#define PLUMB_SWEEP_GRID_H

#include "runner/plan.h"
#include "shard.h"
#include "studies/tunable.h"
#include "studies/vary.h"

enum {
    PL_GRID_MOST_RUNS = 100000,
    PL_SWEEP_DEFAULT_REPEATS = 3,
    PL_SWEEP_DEFAULT_CPU_LIMIT = 3, /* s */
    PL_SWEEP_DEFAULT_SETTINGS = 20, /* of each engine */
    PL_SWEEP_DEFAULT_CHANGES = 2    /* of each scene */
};

/* The time steps of the usual sweep. Coarse ones first: what takes too long there need not be tried
 * at the others. */
#define PL_SWEEP_STEPS "dt=1/60,1/120,1/240,1/480,1/960"

/* ---- Drawn settings ---- */

/* The engines, steps and number of settings to draw. */
typedef struct pl_draw_def {
    const pl_plan *plan; /* its configurations name the engines */
    const double *steps; /* (step_count): s, those that a setting may have */
    int step_count;
    int settings; /* of each engine */
    /* Each engine with all the profiles that it has, and not only those of the plan. */
    bool all_profiles;
} pl_draw_def;

/* Draws the settings that the usual sweep tries of each engine, which take turns: spread over its profiles, its tunable
 * options and the time step by pl_design_place. Of 2^k settings each has a stratum of its own, a 2^k-th, of every
 * range. They are the same on every machine: values are rounded to three digits, and an option
 * moves through its range in an order of its own, which other options and engines do not change. A
 * configuration with a label is an engine for itself. Options without a tune range, and those that
 * the user set, keep their values. Sets *count, and returns the array, which the caller frees; NULL: there are none. */
pl_setting *pl_draw_settings(const pl_draw_def *def, int *count);

/* The configuration of a plan that a drawn setting is of: the first of its engine, or that of its label. */
const pl_configuration *pl_drawn_from(const pl_plan *plan, const pl_setting *setting);

/* ---- The grid ---- */

/* The grid of a sweep: cases and engines, times all combinations of the varied keys. */
typedef struct pl_grid_def {
    const pl_plan *base; /* the cases and engines as asked for, unvaried; repeats; seed */
    const pl_vary *varied;
    int varied_count;
    const pl_setting *drawn; /* (drawn_count) that are run besides, each at its own time step */
    int drawn_count;
    int changes; /* of each scene, at most (pl_variants_swept): on each, every point is run once */
    pl_shard shard;
} pl_grid_def;

/* Fills an empty plan with the shard's part of the grid, which may have no runs. A key applies to
 * every case or engine that has it; a key restricted to one engine or scenario takes precedence
 * there. The scenes are deferred.
 *
 * PL_BAD_INPUT: a key that nothing has (the message suggests the nearest), that is given twice, or
 * that both a scenario and an engine have; a value out of its range, anywhere in the grid; more
 * than PL_GRID_MOST_RUNS runs in the whole grid; two configurations with the same label. The caller
 * frees the plan in any case. */
pl_status pl_grid_plan(const pl_grid_def *def, pl_plan *plan, pl_error *error);

/* Writes the plan's runs to `path` ("-" is standard output), one line of JSON each, plumb.plan/1
 * (results/SCHEMA.md), in the order in which one process makes them. PL_IO. */
pl_status pl_grid_list(const pl_plan *plan, const char *path, pl_error *error);

#endif
