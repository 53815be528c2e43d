/* A body as the iterative solvers keep it: 64 bytes, one line of the cache.
 *
 * Soft contact holds angular velocity as w' = sqrt(I) R^T w with the rotation R of the step's
 * start. In these axes the inertia is the unit matrix: the row that measures a contact's velocity
 * is then also the row by which its impulse acts. Displacements have the same layout, with a
 * rotation vector in the place of w. Gauss-Seidel sweeps hold the angular velocity in world axes.
 *
 * Body 0 of soft contact stands for every static body and for lanes without work. All its numbers
 * are zero, and only zeros are written to it. */
#ifndef PE_SOLVER_BODY_H
#define PE_SOLVER_BODY_H

#include "model/island.h"

/* A body: its inverse mass (1/kg), and its velocity (m/s; rad/s, or scaled) or displacement. */
typedef struct pe_solver_body {
    double linear[3];
    double inverse_mass;
    double angular[3];
    double unused; /* 0 */
} pe_solver_body;

/* Two lines of the cache. All zero for static bodies. */
typedef struct pe_solver_body_frame {
    double to_scaled[9]; /* diag(1/sqrt(I)) R^T, row-major: takes a world vector to a scaled row */
    double position[3];
    double unused[4]; /* 0 */
} pe_solver_body_frame;

/* The bodies that take part in a solve, numbered from 1. Body 0 stands for all others. */
typedef struct pe_solver_bodies {
    int count;                /* body 0 included */
    int *index_of;            /* (slots): 0 for a static body and for one that does not take part */
    int *slot_of;             /* (count) */
    pe_solver_body *velocity; /* (count) */
    pe_solver_body *previous; /* (count): velocities a sub-step ago */
    pe_solver_body *displacement; /* (count): since the step's start */
    pe_solver_body_frame *frame;  /* (count) */
} pe_solver_bodies;

/* Islands, and which of them take part. */
typedef struct pe_chosen_islands {
    const pe_islands *islands;
    const bool *chosen; /* (islands->count) */
} pe_chosen_islands;

/* Numbers the bodies of the chosen islands in the islands' order and takes memory for them from the
 * step's arena. */
pe_status pe_solver_bodies_take(pe_world *world, const pe_chosen_islands *islands,
                                pe_solver_bodies *bodies, pe_error *error);

/* Fills the solver bodies from the world. The gyroscopic change of the whole step is made at once,
 * which it may be because it does no work. The previous velocities are v - h M^-1 f: to repeat the
 * last change is what the forces do in a sub-step of h seconds. */
void pe_solver_bodies_fill(pe_world *world, double dt, double h, const pe_solver_bodies *bodies);

/* Moves the world's bodies by their displacements and gives them their velocities. */
void pe_solver_bodies_apply(pe_world *world, const pe_solver_bodies *bodies);

#endif
