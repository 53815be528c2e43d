/* Runs a law over poses of all pairs of kinds, and reports where it fails. */
#ifndef PLUMB_TEST_SHAPE_PAIRS_TRIAL_H
#define PLUMB_TEST_SHAPE_PAIRS_TRIAL_H

#include "shape_pairs.h"

/* One pose, and its failure. */
typedef struct trial {
    const shape_pool *pool;
    pair pair;
    pair_pose pose;
    check_random random;
    double margin;    /* m: the pair's gap is within it */
    double tolerance; /* m: 1e-9 of the size, or 1e-4 where parallel edges meet, and rounding of the
                         lengths that were added */
    const char *what;
    double found, expected;
    int skipped; /* of the trials of the pair of kinds: where the law does not apply */
} trial;

/* Sets the margin and the tolerance of the trial's pair. */
void trial_set(trial *t);

/* Returns whether it holds. */
typedef bool law(trial *t);

/* Results of a law: false, with the value found; whether it is near; true, counted as skipped. */
bool fails(trial *t, const char *what, double found, double expected);
bool is_near(trial *t, const char *what, double found, double expected, double within);
bool skips(trial *t);

typedef enum law_kinds { LAW_CONVEX = 1, LAW_MESH = 2, LAW_ALL = 3 } law_kinds;

/* Poses of each pair of kinds. */
typedef struct law_count {
    int convex, mesh;
} law_count;

/* Over all pairs of kinds, or the one that the environment names, as in PLUMB_TEST_PAIR="box x
 * hull". Prints, of each pair, the first pose of every sort where the law fails, and how many do;
 * where these are more than are known of this law, by its `name` (shape_pairs_known.h), the test
 * fails. Returns the largest share of the poses of a pair that the law skips. */
double run_law(const char *name, law *holds, law_kinds kinds, law_count poses, pair_gap *gap);

/* The manifolds that the engine finds. */
typedef struct manifolds {
    int count;
    pe_pair_manifold item[PE_MAX_MANIFOLDS];
} manifolds;

manifolds collide(const placed *a, const placed *b, double margin);

/* The deepest point, NULL when there is none; *normal is that of its manifold. */
const pe_pair_point *deepest_of(const manifolds *found, pe_vec3 *normal);

/* The tolerance of a trial. */
double tolerance_of(const pair *p);

/* A margin that the pair is always within. */
double wide(const pair *p);

/* The signed distance by the engine, and the true one, of convex shapes. */
double engine_gap(const pair *p, pe_vec3 *normal);
double true_gap(const pair *p, pe_vec3 *normal);

#endif
