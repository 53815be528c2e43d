/* The scenarios of this folder, and what their tables share. */
#ifndef PLUMB_CATALOGUE_H
#define PLUMB_CATALOGUE_H

#include "plumb/scenario.h"

extern const pl_scenario pl_scenario_tower;
extern const pl_scenario pl_scenario_mass_ratio;
extern const pl_scenario pl_scenario_slope_stick;
extern const pl_scenario pl_scenario_slope_slide;
extern const pl_scenario pl_scenario_slope_threshold;
extern const pl_scenario pl_scenario_slope_tip;
extern const pl_scenario pl_scenario_ladder;
extern const pl_scenario pl_scenario_multi_tower;
extern const pl_scenario pl_scenario_pyramid;
extern const pl_scenario pl_scenario_overhang;
extern const pl_scenario pl_scenario_cylinder_pyramid;
extern const pl_scenario pl_scenario_sphere_pyramid;
extern const pl_scenario pl_scenario_large_step;
extern const pl_scenario pl_scenario_far_from_origin;
extern const pl_scenario pl_scenario_initial_overlap;
extern const pl_scenario pl_scenario_thin_rod;
extern const pl_scenario pl_scenario_arch;
extern const pl_scenario pl_scenario_card_house;
extern const pl_scenario pl_scenario_painleve;
extern const pl_scenario pl_scenario_needle_in_gap;
extern const pl_scenario pl_scenario_slide_to_stop;
extern const pl_scenario pl_scenario_wall;
extern const pl_scenario pl_scenario_wall_collapse;
extern const pl_scenario pl_scenario_pile;
extern const pl_scenario pl_scenario_rest_shape;
extern const pl_scenario pl_scenario_linked_rings;
extern const pl_scenario pl_scenario_roll_slope;
extern const pl_scenario pl_scenario_blocks;
extern const pl_scenario pl_scenario_thin_wall;
extern const pl_scenario pl_scenario_rocket;
extern const pl_scenario pl_scenario_free_fall;
extern const pl_scenario pl_scenario_projectile;
extern const pl_scenario pl_scenario_bowling;
extern const pl_scenario pl_scenario_torque_free;
extern const pl_scenario pl_scenario_bounce;
extern const pl_scenario pl_scenario_oblique_impact;
extern const pl_scenario pl_scenario_collision_train;
extern const pl_scenario pl_scenario_rocking_block;
extern const pl_scenario pl_scenario_isotropy;
extern const pl_scenario pl_scenario_carried_balls;
extern const pl_scenario pl_scenario_reaction_split;
extern const pl_scenario pl_scenario_spin_stop;
extern const pl_scenario pl_scenario_cradle;
extern const pl_scenario pl_scenario_dominoes;
extern const pl_scenario pl_scenario_falling_cubes;
extern const pl_scenario pl_scenario_domino_into_pile;
extern const pl_scenario pl_scenario_top;
extern const pl_scenario pl_scenario_slide_and_spin;

/* The paper that the project grew from, whose tables are the suites paper and paper-blocks. */
#define PL_SOURCE_PAPER "\"3D Rigid Body Simulation with Contacts using the LCP Formulation\""

/* Parameters that scenarios share: dt and duration, which all have, and the friction of stacks.
 * Initialisers, since a table cannot copy another's row. */
#define PL_PARAM_DT                                                                                \
    {                                                                                              \
        .name = "dt", .value = 1.0 / 60, .min = 1e-6, .max = 1, .unit = "s", .help = "time step"   \
    }
#define PL_PARAM_DURATION(seconds)                                                                 \
    {                                                                                              \
        .name = "duration", .value = seconds, .min = 1e-6, .max = 1e6, .unit = "s",                \
        .help = "simulated time"                                                                   \
    }
#define PL_PARAM_FRICTION                                                                          \
    {                                                                                              \
        .name = "friction", .value = 0.5, .min = 0, .max = 10, .unit = "1",                        \
        .help = "Coulomb coefficient of all contacts"                                              \
    }
#define PL_PARAM_RESTITUTION(coefficient)                                                          \
    {                                                                                              \
        .name = "restitution", .value = coefficient, .min = 0, .max = 1, .unit = "1",              \
        .help = "Newton's coefficient"                                                             \
    }
#define PL_PARAM_CUBES                                                                             \
    {                                                                                              \
        .name = "n", .value = 10, .min = 1, .max = 2000, .integer = true, .unit = "1",             \
        .help = "number of cubes"                                                                  \
    }

#endif
