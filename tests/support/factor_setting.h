/* Contact problems with their sparse factor, and the same as dense matrices made from the
 * definition of J. Every failure fails the test. */
#ifndef PLUMB_TEST_FACTOR_SETTING_H
#define PLUMB_TEST_FACTOR_SETTING_H

#include "contact_problem_for_tests.h"
#include "dense_problem.h"
#include "sparse/factor.h"

typedef pe_status (*pattern_finder)(const pe_problem *problem, const bool *counted,
                                    pe_workspace work, pe_pattern *pattern, pe_error *error);

/* That of the engine, and the breadth-first one. */
enum { PATTERN_FINDER_COUNT = 2, MOST_PAIRS = 600 };
extern const pattern_finder PATTERN_FINDERS[PATTERN_FINDER_COUNT];

typedef struct pair_list {
    int list[MOST_PAIRS][2];
    int count;
} pair_list;

void pair_up(pair_list *to, int a, int b);

/* Random pairs, either order; some on the ground, on either side of it; some twice. */
pe_contact_problem *problem_of_random_pairs(uint64_t seed);

/* Each on the one before, the first on the ground. */
pe_contact_problem *problem_of_chain(int bodies);

/* A wall of `rows` x `columns`, its lowest row on the ground. */
pe_contact_problem *problem_of_grid(int rows, int columns);

/* A problem, its factor and its dense matrix. */
typedef struct factor_setting {
    test_memory memory;
    pe_workspace work;
    pe_contact_problem *source;
    pe_problem problem;
    bool *counted;
    pe_gain *gain;
    pe_pattern pattern;
    pe_factor factor;
    double *h; /* (n x n) */
    int n;
} factor_setting;

/* `counted` NULL: all manifolds. Gains up to about `size`. Takes `source`; setting_end frees it. */
void setting_begin(factor_setting *s, pe_contact_problem *source, const bool *counted,
                   pattern_finder find_pattern, uint64_t seed, double size);
void setting_end(factor_setting *s);

typedef void (*factor_law)(factor_setting *s, const char *name);

/* Checks a law on problems of every kind, in both orders of elimination, on all manifolds and on
 * some. */
void hold_everywhere(factor_law holds, double size);

/* n numbers in [-1, 1), and room for 6 more; the caller frees it. */
double *draw_vector(uint64_t seed, int n);

#endif
