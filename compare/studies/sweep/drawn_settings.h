/* The settings that the usual sweep tries of each engine: spread over its profiles, its tunable options and the time
 * step by pl_design_place. Of 2^k settings each has a stratum of its own, a 2^k-th, of every range. */
#ifndef PLUMB_SWEEP_DRAWN_SETTINGS_H
#define PLUMB_SWEEP_DRAWN_SETTINGS_H

#include "runner/plan.h"
#include "studies/tunable.h"

/* The settings of all engines, which take turns. */
typedef struct pl_drawn_settings {
    pl_setting *items; /* (count), owned */
    int count;
} pl_drawn_settings;

/* The engines, steps and number of settings to draw. */
typedef struct pl_draw_def {
    const pl_plan *plan; /* its configurations name the engines */
    const double *steps; /* (step_count): s, those that a setting may have */
    int step_count;
    int settings; /* of each engine */
    /* Each engine with all the profiles that it has, and not only those of the plan. */
    bool all_profiles;
} pl_draw_def;

/* Draws the settings, the same on every machine: values are rounded to three digits, and an option
 * moves through its range in an order of its own, which other options and engines do not change. A
 * configuration with a label is an engine for itself. Options without a tune range, and those that
 * the user set, keep their values. The caller frees the settings. */
pl_drawn_settings pl_draw_settings(const pl_draw_def *def);

/* The configuration of a plan that a drawn setting is of: the first of its engine, or that of its label. */
const pl_configuration *pl_drawn_from(const pl_plan *plan, const pl_setting *setting);

/* Frees the settings. */
void pl_drawn_settings_free(pl_drawn_settings *drawn);

#endif
