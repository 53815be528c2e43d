/* What holds of the contacts of every pair of shapes. */
#ifndef PLUMB_TEST_SHAPE_PAIRS_LAWS_H
#define PLUMB_TEST_SHAPE_PAIRS_LAWS_H

/* Poses of each pair of kinds. */
typedef struct law_budget {
    int truth_poses; /* where the truth is searched for */
    int poses;       /* where the answer proves itself, the shapes being convex */
    int mesh_poses;  /* with a mesh, which takes longer */
} law_budget;

/* The laws as tests of one group, each over all pairs of kinds; returns what cmocka does. */
int run_pair_laws(const char *group, law_budget budget);

#endif
