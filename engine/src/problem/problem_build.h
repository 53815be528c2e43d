/* The contact problem of an island, assembled from the world. */
#ifndef PE_PROBLEM_BUILD_H
#define PE_PROBLEM_BUILD_H

#include "model/integrate.h"
#include "model/island.h"
#include "problem.h"

typedef struct pe_island_problem {
    pe_problem problem;
    const int *slot;       /* (body_count): the world's slot of each body */
    const int *source;     /* (manifold_count): the world's manifold of each manifold */
    int *point_of;         /* (point_count): the world's manifold point of each point */
    double *normal_change; /* (point_count): m/s, by how much the rotation in half a step changes
                              u_n; 0 where the point was not transported to the midpoint */
} pe_island_problem;

/* Island k's problem in the step's arena, with the impulses of its manifold points and the
 * velocities in step with them. `free` (slots) is the motion without contacts; NULL: bodies are at
 * rest. `dt` (s) is the step. */
pe_status pe_problem_build(pe_world *world, const pe_islands *islands, int k,
                           const pe_free_motion *free, double dt, pe_island_problem *built,
                           pe_error *error);

/* Stores the impulses in the world's manifold points, as world vectors on body b. */
void pe_problem_store_impulses(pe_world *world, const pe_island_problem *built);

#endif
