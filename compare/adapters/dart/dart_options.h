/* The profiles and options of the adapter of DART, whose values a setup has. */
#ifndef PLUMB_DART_OPTIONS_H
#define PLUMB_DART_OPTIONS_H

#include "plumb/engine_abi.h"

/* Indices of pl_engine.profiles. */
enum {
    PROFILE_DEFAULT,
    PROFILE_PGS,
    PROFILE_ODE_COLLISION,
    PROFILE_DART_COLLISION,
    PROFILE_RECOMMENDED,
    PROFILE_COUNT
};

/* Indices of pl_engine.options. */
enum {
    OPTION_ITERATIONS,
    OPTION_DELTA_X,
    OPTION_RELATIVE_DELTA_X,
    OPTION_RANDOM_ORDER,
    OPTION_MAX_CONTACTS,
    OPTION_CFM,
    OPTION_ERP,
    OPTION_ERROR_ALLOWANCE,
    OPTION_MAX_ERV,
    OPTION_FCL_PRIMITIVES,
    OPTION_COUNT
};

extern const pl_engine_profile pl_dart_profiles[PROFILE_COUNT];
extern const pl_engine_option pl_dart_options[OPTION_COUNT];
extern const pl_engine_source pl_dart_sources[]; /* why `recommended` has its values */
extern const int pl_dart_source_count;

/* As profile_defaults of pl_engine: DART's own values, also of a library that was built with others. They
 * are asked once, before any world changes the global ones. */
void pl_dart_profile_defaults(int profile, double *values);

#endif
