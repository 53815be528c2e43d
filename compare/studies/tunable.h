/* The settings of engines that studies try: the options that are worth tuning, where in their ranges experiments lie,
 * and settings written as a SPEC and in the engine's own API, as its descriptor has them. */
#ifndef PLUMB_TUNABLE_H
#define PLUMB_TUNABLE_H

#include "engines/registry.h"

#include <jansson.h>

/* The range in which an option is tuned. */
typedef struct pl_tunable {
    double low, high;
    bool logarithmic;
} pl_tunable;

/* Whether an option is tuned in a profile without being asked for, and its range. For an engine
 * that names no option, that is `iterations`, from 1 to 300. */
bool pl_tunable_find(const pl_engine_info *engine, int profile, int option, pl_tunable *tunable);

/* The same profile with default settings. */
pl_engine_choice pl_tune_defaults(const pl_engine_choice *choice);

/* "name:profile,option=value...", with each option that differs from the profile's default; the
 * name is the path of a loaded engine. Cut to the size: pl_tune_spec_fits. */
void pl_tune_spec(const pl_engine_choice *choice, char spec[PL_SPEC_SIZE]);

/* Whether pl_tune_spec has room for any values of these options (engine->option_count) besides those in
 * which the choice differs from its defaults. */
bool pl_tune_spec_fits(const pl_engine_choice *choice, const bool *varied);

/* The settings as a program that uses the engine writes them, an array of lines: one for every option that
 * differs from its default and has `code`; then the step, dt in s. A new reference. */
json_t *pl_tune_api(const pl_engine_choice *choice, double dt);

/* An engine with its options, and the time step. */
typedef struct pl_setting {
    pl_engine_choice choice;
    double dt; /* s; NAN: each scenario's own */
} pl_setting;

/* The place of a point, 0 <= point, along one dimension: between 0 and 1, the same on every machine. The points of a
 * dimension are a van der Corput sequence whose digits are scrambled by the seed (Owen 1995, "Randomly permuted
 * (t,m,s)-nets and (t,s)-sequences"): of the first 2^k points, and of each 2^k after them, one lies in each 2^k-th of
 * the range, in an order that the seed gives. So the first 2^k points of several dimensions, each with a seed of its
 * own, are a Latin hypercube, and how many points there will be need not be known. */
double pl_design_place(uint64_t seed, int point);

#endif
