/* The runs of an ensemble: members x cases x engines. Members of the same number have the same
 * jitter on every engine. */
#ifndef PLUMB_MEMBERS_H
#define PLUMB_MEMBERS_H

#include "runner/plan.h"

/* A reference run has the time step divided by PL_FINER_STEPS, and PL_MORE_ITERATIONS times the
 * engine's iterations, where it has such an option. */
enum { PL_FINER_STEPS = 16, PL_MORE_ITERATIONS = 8 };

/* The members of one case on one engine. */
typedef struct pl_ensemble {
    int test_case;     /* of those asked for, from 0 */
    int setting;       /* 0: as asked; k: with the k-th other setting */
    bool reference;    /* with the finer time step */
    int configuration; /* index into the plan's */
    int first;         /* index into the plan's cases of its member 0 */
} pl_ensemble;

/* The ensembles of a study, which all have the same number of members. */
typedef struct pl_ensembles {
    pl_ensemble *items; /* (count) */
    int count;
    int members;
    int case_count; /* of those asked for: the plan has them together for each member */
} pl_ensembles;

/* What pl_members_plan makes ensembles of. */
typedef struct pl_members_def {
    int members;       /* >= 2 */
    int setting_count; /* other settings */
    bool references;
    void *user;
    /* Adds the cases to the plan: setting 0 as asked, k with the k-th other setting. */
    pl_status (*add)(void *user, int setting, pl_plan *plan, pl_error *error);
} pl_members_def;

/* Adds the cases and the runs to a plan that has its engines and no cases. Members of other settings have
 * numbers of their own, so that no jitter is used twice on an engine. PL_BAD_INPUT: a scene in
 * which nothing can move. The caller frees ensembles->items in any case. */
pl_status pl_members_plan(const pl_members_def *def, pl_plan *plan, pl_ensembles *ensembles,
                          pl_error *error);

/* The index into the plan's cases of a member of an ensemble. */
int pl_member_case(const pl_ensembles *ensembles, const pl_ensemble *ensemble, int member);

/* The hashes by which results know the members' runs, an array of texts. */
json_t *pl_member_runs(const pl_plan *plan, const pl_ensembles *ensembles,
                       const pl_ensemble *ensemble);

#endif
