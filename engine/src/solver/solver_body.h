/* What the solver keeps of a body.
 *
 * A line is 64 bytes, one visit of the cache: linear part, inverse mass, angular part. Angular
 * velocity is held as w' = sqrt(I) R^T w with R frozen at the step's start, in which the inertia is
 * the unit matrix: the row that measures a contact's velocity is then also the row by which its
 * impulse acts. Displacements are lines as well, with the rotation vector in the place of w.
 *
 * Line 0 stands for every static body and for lanes that have nothing to do: all zero, and written
 * with zeros. */
#ifndef PE_SOFT_LINE_H
#define PE_SOFT_LINE_H

#include "model/island.h"

typedef struct pe_solver_body {
    double linear[3];
    double inverse_mass;
    double angular[3];
    double unused; /* 0 */
} pe_solver_body;

/* What turns a world vector into a row: turn = diag(1/sqrt(I)) R^T, row-major; 0 when static. */
typedef struct pe_solver_body_frame {
    double turn[9];
    double position[3];
    double unused[4]; /* 0: two visits of the cache */
} pe_solver_body_frame;

typedef struct pe_solver_bodies {
    int count;                /* line 0 included */
    int *index_of;            /* (slots): 0 for a static body and for one that does not take part */
    int *slot_of;             /* (count) */
    pe_solver_body *velocity; /* (count) */
    pe_solver_body *previous; /* (count): velocities a substep ago */
    pe_solver_body *displacement; /* (count): since the step's start */
    pe_solver_body_frame *frame;  /* (count) */
} pe_solver_bodies;

/* Numbers the bodies of the chosen islands, in the islands' order, and takes the memory for their
 * lines. */
pe_status pe_solver_bodies_take(pe_world *world, const pe_islands *islands, const bool *chosen,
                                pe_solver_bodies *lines, pe_error *error);

/* Fills the lines from the bodies. The gyroscopic change of the whole step is in the velocities: it
 * does no work, and so can be made at once. The previous velocities are v - h M^-1 f, so that to go
 * on as before is what the loads do in a substep of length h. */
void pe_solver_bodies_fill(const pe_world *world, double dt, double h,
                           const pe_solver_bodies *lines);

/* Moves the bodies by their displacements and gives them their velocities. */
void pe_solver_bodies_apply(pe_world *world, const pe_solver_bodies *lines);

#endif
