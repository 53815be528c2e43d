/* Position correction while it runs: what its files share. The problem is stated in
 * position_correction.c. */
#ifndef PE_CORRECTION_H
#define PE_CORRECTION_H

#include "solver/sweep.h"
#include "step.h"

/* What is known of a contact of the world before a round. */
typedef struct pe_correction_contact {
    double separation; /* m, least of the manifold */
    int a, b;          /* slots; -1: a static body */
    bool among;        /* of a body in rules->among */
    bool left_alone;   /* earlier steps could not part the bodies */
} pe_correction_contact;

/* A correction. */
typedef struct pe_correction {
    pe_step *step;
    pe_world *world;
    const pe_correction_rules *rules;
    const pe_islands *islands;       /* of this round */
    pe_correction_contact *contacts; /* (manifolds of the world): of this round */
    bool *moved;                     /* (slots): in this round */
    pe_saved_pose *poses;            /* (slots): of those before it */
    pe_twist *twists;                /* (slots) */
    bool *active;                    /* (slots): bodies all of whose contacts are swept */
    pe_islands near;                 /* one island: the contacts that may be swept */
    int iterations;
    double flops; /* of factorisations so far */
    pe_error *error;
} pe_correction;

/* Whether the contact is deeper than a twentieth of the least extent of its smaller body (overlap.c). */
bool pe_overlaps(const pe_world *world, const pe_manifold *m);

/* Whether the overlap of two bodies is left alone, because earlier steps could not part them. */
bool pe_is_left_alone(const pe_world *world, const pe_manifold *m);

/* Fills c->contacts from the contacts at the present poses (correction_contacts.c). */
pe_status pe_correction_look(pe_correction *c);

/* The deepest penetration of all manifolds in rules->among, in m, those that are left alone included. */
double pe_correction_deepest(const pe_correction *c);

/* Of phi >= -aim over all contacts that count: that are in rules->among and not left alone. */
pe_violation pe_correction_violation(const pe_correction *c);

/* The deepest penetration of the manifolds of island k, in m, that are not left alone and, if `among`,
 * are in rules->among. */
double pe_correction_depth(const pe_correction *c, const pe_islands *islands, int k, bool among);

/* How far a point of the body is moved in a step at most, in m: by a part of its size, and what its
 * speed has moved it may also be taken back. */
double pe_correction_way(const pe_correction *c, int slot);

/* Builds the problem of island k: impulses, velocities and free velocities 0 (correction_sweeps.c). */
pe_status pe_correction_build(const pe_correction *c, const pe_islands *islands, int k,
                              pe_island_problem *built);

/* Whether the displacements found violate J_n d + phi >= -aim by less than none do, at the chosen
 * manifolds (NULL: at all). */
bool pe_correction_is_better(const pe_problem *problem, const bool *chosen);

/* Takes the memory of a round for pe_correction_sweep. */
pe_status pe_correction_begin_sweeps(pe_correction *c);

/* Sweeps the violated part of island k. Leaves the best displacements found in built->problem; *better:
 * whether they are better than none. */
pe_status pe_correction_sweep(pe_correction *c, int k, pe_island_problem *built, bool *better);

#endif
