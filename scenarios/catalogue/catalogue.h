/* Shared rows of the tables of scenarios. */
#ifndef PLUMB_CATALOGUE_H
#define PLUMB_CATALOGUE_H

#include "scene_builder.h"

/* The paper that the project grew from, whose tables are the suites paper and paper-blocks. */
#define PL_SOURCE_PAPER "\"3D Rigid Body Simulation with Contacts using the LCP Formulation\""

/* Parameters that scenarios share. Initialisers, since a table cannot copy another's row. The value
 * of "friction" is that of material 0, and so is "restitution"; "dt" and "duration" are those of
 * the scene: see pl_scenario_build. */
#define PL_PARAM_STEP(dt)                                                                          \
    {                                                                                              \
        "dt", dt, 1e-6, 1, false, "s", "time step"                                                 \
    }
#define PL_PARAM_DURATION(seconds)                                                                 \
    {                                                                                              \
        "duration", seconds, 1e-6, 1e6, false, "s", "simulated time"                               \
    }
#define PL_PARAM_TIME(seconds) PL_PARAM_STEP(1.0 / 60), PL_PARAM_DURATION(seconds)
#define PL_PARAM_FRICTION                                                                          \
    {                                                                                              \
        "friction", 0.5, 0, 10, false, "1", "Coulomb coefficient of all contacts"                  \
    }
#define PL_PARAM_RESTITUTION(coefficient)                                                          \
    {                                                                                              \
        "restitution", coefficient, 0, 1, false, "1", "Newton's coefficient"                       \
    }

/* The table of parameters of a scenario. */
#define PL_PARAMS(table) .params = (table), .param_count = sizeof(table) / sizeof(table)[0]

#endif
