/* What holds of the contacts of every pair of shapes. */
#ifndef PLUMB_TEST_SHAPE_PAIRS_LAWS_H
#define PLUMB_TEST_SHAPE_PAIRS_LAWS_H

/* Poses of each pair of kinds; 0: none is tried. */
typedef struct law_budget {
    int truth_poses, mesh_truth_poses; /* where the truth is searched for */
    int poses, mesh_poses;             /* where the answer proves itself */
} law_budget;

/* The laws as tests of one group, each over all pairs of kinds; returns what cmocka does. */
int run_pair_laws(const char *group, law_budget budget);

#endif
