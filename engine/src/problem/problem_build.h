/* The contact problem of an island, assembled from the world. */
#ifndef PE_PROBLEM_BUILD_H
#define PE_PROBLEM_BUILD_H

#include "model/integrate.h"
#include "model/island.h"
#include "problem.h"

/* One island over an interval of time, which is the whole step or a sub-step. */
typedef struct pe_interval {
    const pe_islands *islands;
    int k;                      /* the island */
    const pe_free_motion *free; /* (slots): without contacts; NULL: at rest, and impulses are 0 */
    double dt;                  /* s */
    bool instant;               /* an impact: nothing moves */
    bool stops;                 /* gaps of touching contacts stay as they are */
    bool solved;                /* the impulses are not of the last step, but fit */
    pe_path path;               /* set to the path on which the island was solved */
    bool substep;               /* its contacts are listed apart */
    double begin;               /* s since the start of the step */
    int order;                  /* of the solves within the step */
} pe_interval;

/* The problem of an island, and its places in the world. */
typedef struct pe_island_problem {
    pe_problem problem;
    const int *slot;       /* (body_count): the world's slot of each body */
    const int *source;     /* (manifold_count): the world's manifold of each manifold */
    int *point_of;         /* (point_count): the world's manifold point of each point */
    double *normal_change; /* (point_count): m/s, by how much the rotation in half a step changes
                              u_n; 0 where the point was not transported to the midpoint */
    pe_contact_place *end; /* (point_count): the contact at the end of the step, of points that were
                              transported; NULL: none was. The normals of others are zero. */
    bool unsettled; /* not at the midpoint because the impulses of the last step do not fit, but
                       those that solve it may (midpoint.h) */
    bool wanders; /* points roll on a rim: where they are at the midpoint follows from impulses that
                       fit there */
} pe_island_problem;

/* Builds the island's problem in the step's arena, with the impulses of its manifold points and the
 * velocities in step with them. */
pe_status pe_problem_build(pe_world *world, const pe_interval *interval, pe_island_problem *built,
                           pe_error *error);

/* Stores the impulses in the world's manifold points, as world vectors on body b. */
void pe_problem_store_impulses(pe_world *world, const pe_island_problem *built);

#endif
