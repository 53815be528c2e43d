/* Tests which ensembles differ, and in which observable: of every pair of engines as asked, and of
 * every engine as asked and in another setting.
 *
 * Members of the same number start alike on every engine. After the horizon they are independent.
 * Where they are not yet, two engines look more alike than the test expects, so that it errs on the
 * safe side. */
#ifndef PLUMB_VERDICT_H
#define PLUMB_VERDICT_H

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
    json_t *horizon;
} pl_ensemble_view;

/* The comparisons that these ensembles are planned for: of all observables of all pairs that are
 * compared. After the runs there may be fewer, where no member has a value or all are equal. */
int pl_verdicts_planned(const pl_ensembles *ensembles);

/* PL_BAD_INPUT where an ensemble has so few members that none of the planned comparisons could come
 * out significant, whatever the members do; the error says how many are needed. */
pl_status pl_verdicts_possible(const pl_ensembles *ensembles, pl_error *error);

/* Compares all pairs in every observable that has two values or more on both sides, not all equal, and corrects over all
 * of them (Holm): a new array, as "comparisons" of plumb.ensemble/1. */
json_t *pl_verdicts_reach(const pl_ensemble_view *views, int count);

#endif
