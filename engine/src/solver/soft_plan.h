/* In which order the manifolds are solved: greedy colours, and in a colour by number of points, so
 * that as many lanes as there are have the same work. The order does not depend on how many. */
#ifndef PE_SOFT_PLAN_H
#define PE_SOFT_PLAN_H

#include "solver_body.h"

enum { PE_SOFT_POINTS = 4 };

/* Up to four points of a manifold; one of more points is solved as two contacts. */
typedef struct pe_soft_contact {
    int manifold;
    int a, b; /* lines */
    int count;
    int point[PE_SOFT_POINTS]; /* indices into the contacts' points */
} pe_soft_contact;

/* Contacts with the same number of points. They share no body, or, when `serial`, they may and must
 * be solved one after the other. */
typedef struct pe_soft_batch {
    int first, count; /* contacts */
    int points;       /* of each */
    bool hard;        /* against a static body */
    bool rough;       /* with friction */
    bool serial;
} pe_soft_batch;

typedef struct pe_soft_plan {
    int count;
    pe_soft_contact *contacts; /* (count), batch after batch */
    int batch_count;
    pe_soft_batch *batches;
    int colours;
    int points;
    bool bounces; /* some restitution is above 0 */
} pe_soft_plan;

/* Plans the manifolds of the chosen islands, in the step's arena. Each contact gets the lowest
 * colour that neither body has yet; when all are taken, the last one, whose batches are serial. */
pe_status pe_soft_plan_make(pe_world *world, const pe_islands *islands, const bool *chosen,
                            const pe_solver_bodies *lines, pe_soft_plan *plan, pe_error *error);

#endif
