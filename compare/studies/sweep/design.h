/* The settings that the usual sweep tries of each engine: a Latin hypercube (McKay, Beckman and
 * Conover 1979, "A comparison of three methods for selecting values of input variables in the
 * analysis of output from a computer code", Technometrics 21) over its profiles, its tunable options
 * and the time step. Each of N settings has a stratum of its own, an N-th, of every range. */
#ifndef PLUMB_SWEEP_DESIGN_H
#define PLUMB_SWEEP_DESIGN_H

#include "runner/plan.h"

/* One setting of an engine. */
typedef struct pl_design_setting {
    int base; /* a configuration of the plan that is of the same engine */
    pl_engine_choice choice;
    double dt; /* s */
} pl_design_setting;

/* The settings of all engines, which take turns. */
typedef struct pl_design {
    pl_design_setting *items; /* (count), owned */
    int count;
} pl_design;

/* What a design is made from. */
typedef struct pl_design_def {
    const pl_plan *plan; /* its configurations name the engines */
    const double *steps; /* (step_count): s, those that a setting may have */
    int step_count;
    int settings; /* of each engine */
    /* Each engine with all the profiles that it has, and not only those of the plan. */
    bool all_profiles;
} pl_design_def;

/* Makes the design, the same on every machine: values are rounded to three digits, and an option
 * moves through its range in an order of its own, which other options and engines do not change. A
 * configuration with a label is an engine for itself. Options without a tune range, and those that
 * the user set, keep their values. PL_NO_MEMORY. The caller frees the design in any case. */
pl_status pl_design_make(const pl_design_def *def, pl_design *design, pl_error *error);

/* Frees the settings. */
void pl_design_free(pl_design *design);

#endif
