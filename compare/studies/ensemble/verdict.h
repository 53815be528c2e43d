/* Tests which ensembles differ, and in which observable: of every pair of engines as asked, and of
 * every engine as asked and in another setting.
 *
 * Members of the same number start alike on every engine. After the horizon they are independent.
 * Where they are not yet, two engines look more alike than the test expects, so that it errs on the
 * safe side. */
#ifndef PLUMB_VERDICT_H
#define PLUMB_VERDICT_H

#include "horizon.h"
#include "members.h"
#include "sample.h"

/* Two ensembles differ where chance makes the difference as large in less than this share of all
 * cases, corrected for all tests. */
extern const double pl_significance;

/* All that is known of one ensemble. */
typedef struct pl_ensemble_view {
    pl_ensemble ensemble;
    char name[256];  /* the engine's label, and the other setting in brackets */
    const char *key; /* what tells it from others; borrowed */
    int place;       /* in the order of the command */
    json_t *results; /* (members that have one): by number */
    json_t *runs;    /* their hashes, as many */
    pl_observations observed;
    pl_horizon horizon;
} pl_ensemble_view;

/* The comparison of two ensembles in one observable. */
typedef struct pl_sample_test {
    int a, b;          /* indices of the views */
    int observable;    /* the pl_metric_id */
    double energy, ks; /* energy distance in the observable's unit; Kolmogorov-Smirnov, 1 */
    double energy_floor, ks_floor; /* the larger of the two ensembles' own noise; NAN: too few */
    double p, corrected;           /* permutation p of the energy distance; after Holm */
    bool apart;
} pl_sample_test;

/* The comparisons of all pairs of ensembles. */
typedef struct pl_verdicts {
    pl_sample_test *items; /* (count): with two values or more on both sides, not all equal */
    int count;
} pl_verdicts;

/* The comparisons that these ensembles are planned for: of all observables of all pairs that are
 * compared. After the runs there may be fewer, where no member has a value or all are equal. */
int pl_verdicts_planned(const pl_ensembles *ensembles);

/* PL_BAD_INPUT where an ensemble has so few members that none of the planned comparisons could come
 * out significant, whatever the members do; the error says how many are needed. */
pl_status pl_verdicts_possible(const pl_ensembles *ensembles, pl_error *error);

/* Compares all pairs, and corrects over all of them. The caller frees the verdicts. */
pl_verdicts pl_verdicts_reach(const pl_ensemble_view *views, int count);

/* Frees the comparisons. */
void pl_verdicts_free(pl_verdicts *verdicts);

/* The comparison as a sentence: "bullet:si spreads 12 % farther in x than ode:quick (...)". */
void pl_sample_test_sentence(const pl_ensemble_view *views, const pl_sample_test *comparison,
                             char *text, size_t size);

#endif
