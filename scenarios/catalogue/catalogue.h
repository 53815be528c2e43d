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

/* Acceptances that scenarios share: one for all bodies at rest, one for all that move. */
#define PL_ACCEPT_AT_REST                                                                          \
    .acceptance = 0.01, .acceptance_reason = "1 % of a body of 1 m: an offset that can be seen"
#define PL_ACCEPT_MOTION                                                                           \
    .acceptance = 0.06, .acceptance_reason = "6 %: speeds that differ by less look the same "      \
                                             "(Snowden and Braddick 1991)"
#define PL_ACCEPT_FRICTION                                                                         \
    .acceptance = 0.06, .acceptance_reason = "6 %: a laboratory that measures friction again "     \
                                             "gets no closer (0.06, ASTM D2534)"

#define PL_ACCEPT_REPORTED                                                                         \
    .acceptance = 0.06,                                                                            \
    .acceptance_reason = "6 % of a motion: speeds that differ by less look the same (Snowden and " \
                         "Braddick 1991), and of a body's size below; 1 % of its size to the "     \
                         "side and above: an offset that can be seen; 0.06 rad of a turn"

/* What all right answers of a chaotic scene have in common, and when a run is accurate. */
#define PL_CHAOTIC_REFERENCE                                                                       \
    "no overlap at any time, no gain of energy, momentum kept, and end statistics as those of "    \
    "converged runs where two engines agree on them"
#define PL_CHAOTIC_SOURCE "impenetrability, conservation of energy and momentum"
#define PL_CHAOTIC_JUDGED                                                                          \
    .primary_error = "chaotic_error", .acceptance = 0.1,                                           \
    .acceptance_reason = "0.1: one contact in a hundred overlaps by a tenth of the thinnest "      \
                         "body, or a body has passed through another, or energy, momentum or the " \
                         "end are off by a tenth"

/* The table of parameters of a scenario. */
#define PL_PARAMS(table) .params = (table), .param_count = sizeof(table) / sizeof(table)[0]

#endif
