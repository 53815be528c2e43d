/* The search for the least budget whose error is as good as the converged one: by doubling, then by bisection.
 *
 *     pl_budget_search s = pl_budget_begin(1, 1024, 1e-9);
 *     while (s.state == PL_BUDGET_SEARCHING) {
 *         pl_budget_take(&s, error_with(pl_budget_next(&s)));
 *     }
 */
#ifndef PLUMB_BUDGET_SEARCH_H
#define PLUMB_BUDGET_SEARCH_H

#include "studies/bisection.h"

/* Whether a budget search goes on, and how it ended. */
typedef enum pl_budget_state {
    PL_BUDGET_SEARCHING,
    PL_BUDGET_FOUND,
    PL_BUDGET_ALL_FAILED,     /* all budgets that were tried */
    PL_BUDGET_LARGEST_FAILED, /* there is no converged error, though smaller budgets succeeded */
    PL_BUDGET_STOPPED         /* by a trial that ends the search */
} pl_budget_state;

enum { PL_BUDGET_MOST_DOUBLINGS = 64 };

/* A search. */
typedef struct pl_budget_search {
    long least, most; /* budgets are least 2^k up to most, and those between */
    double floor;     /* >= 0: errors that differ by no more are equal */
    double errors[PL_BUDGET_MOST_DOUBLINGS]; /* (doublings) of least 2^k; INFINITY: it failed */
    int doublings;
    bool bisects;
    pl_bisection bisection;
    pl_budget_state state;
    long budget;      /* the least budget; 0 unless found */
    long largest;     /* the last doubling */
    double converged; /* its error; NAN: none */
    int trials;
} pl_budget_search;

/* Begins a search from `least` to `most`, 1 <= least <= most. It doubles the budget until two doublings in a row
 * changed the error by at most 1 %, or up to `most`; the last error counts as converged. Then it bisects for the least
 * budget with an error of at most 1.1 times that, where the next doubling above it, if tried, also has such an error. */
pl_budget_search pl_budget_begin(long least, long most, double floor);

/* The budget to try next: none is tried twice. Call it only while the state is PL_BUDGET_SEARCHING. */
long pl_budget_next(const pl_budget_search *search);

/* Records the error of the trial with that budget, >= 0. INFINITY: it has no valid error, but a larger budget may have
 * one; NAN: it has none, and the search ends. */
void pl_budget_take(pl_budget_search *search, double error);

/* The most trials that a search takes. */
int pl_budget_most_trials(long least, long most);

#endif
