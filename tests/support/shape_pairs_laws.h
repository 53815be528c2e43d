/* The laws that the contacts of every pair of shapes obey. */
#ifndef PLUMB_TEST_SHAPE_PAIRS_LAWS_H
#define PLUMB_TEST_SHAPE_PAIRS_LAWS_H

/* Number of poses of each pair of kinds; 0: none. */
typedef struct law_budget {
    int truth_poses, mesh_truth_poses; /* of laws that search for the reference distance */
    int poses, mesh_poses;             /* of laws that the result proves by itself */
} law_budget;

/* The laws as tests of one group, each over all pairs of kinds; returns what cmocka does. */
int run_pair_laws(const char *group, law_budget budget);

#endif
