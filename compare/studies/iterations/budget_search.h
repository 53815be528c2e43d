/* The least iteration budget whose error is as good as the converged one. What an error is, and how
 * it is found, is the caller's. */
#ifndef PLUMB_BUDGET_SEARCH_H
#define PLUMB_BUDGET_SEARCH_H

#include "plumb/base.h"

/* What came of a budget. */
typedef enum pl_budget_trial {
    PL_BUDGET_SUCCEEDED, /* it has an error */
    PL_BUDGET_FAILED,    /* it has none that counts; a larger budget may */
    PL_BUDGET_END_SEARCH /* and the search is over */
} pl_budget_trial;

typedef struct pl_budget_search_def {
    long least, most; /* 1 <= least <= most: the budgets tried, least 2^k up to most, and between */
    double floor;     /* >= 0: errors that differ by no more are equal */
    void *user;
    /* *error gets the budget's error, finite and >= 0, where it held. No budget is tried twice.
     * Anything but PL_OK ends the search with that. */
    pl_status (*try_budget)(void *user, long budget, pl_budget_trial *trial, double *error,
                            pl_error *fault);
} pl_budget_search_def;

typedef enum pl_budget_state {
    PL_BUDGET_FOUND,
    PL_BUDGET_ALL_FAILED,     /* of those tried */
    PL_BUDGET_LARGEST_FAILED, /* so that there is no converged error, though smaller ones held */
    PL_BUDGET_STOPPED         /* by PL_BUDGET_END_SEARCH */
} pl_budget_state;

typedef struct pl_budget_found {
    pl_budget_state state;
    long budget;      /* the answer; 0 unless found */
    long largest;     /* the last doubling */
    double converged; /* the error there; NAN where it has none */
    int trials;
} pl_budget_found;

/* Doubles the budget until two doublings in a row changed the error by at most 1 %, or up to
 * `most`; the error there counts as converged. Then bisects for the least budget with an error of
 * at most 1.1 times that, of which the next doubling above it, where that was tried, has one too.
 */
pl_status pl_budget_search(const pl_budget_search_def *def, pl_budget_found *found,
                           pl_error *fault);

/* Trials that a search takes, at most. */
int pl_budget_most_trials(long least, long most);

#endif
