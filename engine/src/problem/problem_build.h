/* The contact problem of an island, assembled from the world. */
#ifndef PE_PROBLEM_BUILD_H
#define PE_PROBLEM_BUILD_H

#include "model/integrate.h"
#include "model/island.h"
#include "problem.h"

typedef struct pe_island_problem {
    pe_problem problem;
    const int *slot;             /* (body_count): the world's slot of each body */
    const int *point_of;         /* (point_count): the contact point of each point */
    const double *normal_change; /* (point_count): m/s, what turning changes of u_n in half a step,
                            or 0 where the point was not carried to the middle */
} pe_island_problem;

/* Island k's problem in the step's arena, with the impulses that its contact points carry and the
 * velocities in step with them. `free` (slots) is the motion without contacts; NULL: none,
 * bodies are at rest. `dt` is the step. */
pe_status pe_problem_build(pe_world *world, const pe_islands *islands, int k,
                           const pe_free_motion *free, double dt, pe_island_problem *built,
                           pe_error *error);

/* Stores the impulses in the contact points, as world vectors on body b. */
void pe_problem_store_impulses(pe_world *world, const pe_island_problem *built);

#endif
