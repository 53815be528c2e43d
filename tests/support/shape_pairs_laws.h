/* The laws that the contacts of every pair of shapes obey. */
#ifndef PLUMB_TEST_SHAPE_PAIRS_LAWS_H
#define PLUMB_TEST_SHAPE_PAIRS_LAWS_H

#include "shape_pairs_trial.h"

/* Of convex shapes: the least separation is the signed distance, and so is the separation along the
 * normal that is reported. */
bool equals_the_truth(trial *t);

/* With a mesh: apart, the least separation is the distance; overlapping, it is not above 0. */
bool equals_brute_force(trial *t);

/* All points are on both surfaces, or in both solids, as far apart as they say. */
bool has_sound_points(trial *t);

/* The shapes swapped have the opposite normal and the same separation. */
bool is_symmetric(trial *t);

/* Number of poses of each pair of kinds; 0: none. */
typedef struct law_budget {
    int truth_poses, mesh_truth_poses; /* of laws that search for the reference distance */
    int poses, mesh_poses;             /* of laws that the result proves by itself */
} law_budget;

/* The laws as tests of one group, each over all pairs of kinds; returns what cmocka does. */
int run_pair_laws(const char *group, law_budget budget);

#endif
