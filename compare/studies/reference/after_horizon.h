/* What can be said after a reference has lost its meaning: whether the motion is chaotic there, and
 * in which ensembles of runs from almost the same start the engines then differ.
 *
 * The members are those of studies/ensemble. The reference's ensemble runs at a quarter of the step,
 * and is compared with that of each engine configuration at the step that was asked for: for each
 * body without a reference, each coordinate of where it ends, by the permutation test of the energy
 * distance, corrected for all tests (Holm). The motion is chaotic where the reference's members, which
 * start within a ten-thousandth of a body's size, part by more than a hundredth (horizon.h). */
#ifndef PLUMB_AFTER_HORIZON_H
#define PLUMB_AFTER_HORIZON_H

#include "reference_verdict.h"

enum {
    PL_REFERENCE_MEMBERS = 16,
    PL_REFERENCE_MEMBER_REFINEMENT = 4,
    PL_REFERENCE_MOST_TESTS = 60 /* those of the largest differences; the others count as p = 1 */
};

/* Ensembles are made where a run at the asked step takes no more steps times bodies. */
extern const double pl_reference_most_member_work;

/* The comparison of one engine configuration with the reference in the end of one body. */
typedef struct pl_end_test {
    int engine, body; /* of the verdict, of the reference */
    int axis;         /* 0 to 2 */
    double ks;        /* Kolmogorov-Smirnov distance, 1 */
    double p, corrected;
} pl_end_test;

/* What is known after the horizon. Starts as {0}. */
typedef struct pl_after_horizon {
    long from; /* the first sample from which on a body has no reference */
    bool made; /* false: no ensemble was made, and `reason` says why */
    char reason[256];
    bool chaotic;       /* the members of the reference part */
    double parted;      /* s: when they have parted; NAN: they do not, or it is not known */
    pl_end_test *tests; /* (test_count) */
    int test_count;
} pl_after_horizon;

/* Runs and tests the ensembles; `def` has what they run with (execution.plan: the compared
 * configurations and the seed). Nothing is run where every body has a reference to its end. A signal
 * ends it as in pl_execute. The caller frees *after in any case. */
pl_status pl_after_horizon_make(const pl_reference_def *def, const pl_reference_verdict *verdict,
                                pl_after_horizon *after, int *signal_number, pl_error *error);

/* Appends the sentences to an array of strings. */
void pl_after_horizon_sentences(const pl_reference_verdict *verdict, const pl_after_horizon *after,
                                json_t *sentences);

/* Frees the tests. */
void pl_after_horizon_free(pl_after_horizon *after);

#endif
