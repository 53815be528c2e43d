#include "budget_search.h"

#include <math.h>

static const double small_change = 0.01, near_enough = 1.1;

enum { MOST_DOUBLINGS = 64 };

typedef struct search {
    const pl_budget_search_def *def;
    pl_budget_found *found;
    double errors[MOST_DOUBLINGS]; /* of least 2^k; INFINITY where it fell */
    int count;
} search;

static pl_status try_budget(search *s, long budget, pl_budget_trial *trial, double *error,
                            pl_error *fault)
{
    double given = (double)INFINITY;
    s->found->trials += 1;
    pl_status status = s->def->try_budget(s->def->user, budget, trial, &given, fault);
    *error = *trial == PL_BUDGET_SUCCEEDED ? given : (double)INFINITY;
    return status;
}

static bool changed_little(const search *s, int k)
{
    double before = s->errors[k - 1], after = s->errors[k];
    return isfinite(before) && isfinite(after) &&
           fabs(after - before) <= small_change * before + s->def->floor;
}

static bool is_settled(const search *s)
{
    const int last = s->count - 1;
    return last >= 2 && changed_little(s, last) && changed_little(s, last - 1);
}

static pl_status double_up(search *s, pl_error *fault)
{
    pl_budget_found *found = s->found;
    bool any = false;
    for (long budget = s->def->least; !is_settled(s); budget *= 2) {
        pl_budget_trial trial = PL_BUDGET_FAILED;
        double *error = &s->errors[s->count];
        pl_status status = try_budget(s, budget, &trial, error, fault);
        if (status != PL_OK) {
            return status;
        }
        found->largest = budget;
        if (trial == PL_BUDGET_END_SEARCH) {
            found->state = PL_BUDGET_STOPPED;
            return PL_OK;
        }
        s->count += 1;
        any = any || trial == PL_BUDGET_SUCCEEDED;
        if (budget > s->def->most / 2) {
            break;
        }
    }
    found->state = PL_BUDGET_FOUND;
    if (isinf(s->errors[s->count - 1])) {
        found->state = any ? PL_BUDGET_LARGEST_FAILED : PL_BUDGET_ALL_FAILED;
    }
    return PL_OK;
}

static bool is_near(const search *s, double error)
{
    return error <= near_enough * s->found->converged + s->def->floor;
}

/* Between a doubling that is not near and the next, which is: that next one is the doubling above
 * all of them. */
static pl_status bisect(search *s, long far, long near, pl_error *fault)
{
    while (near - far > 1) {
        const long middle = far + (near - far) / 2;
        pl_budget_trial trial = PL_BUDGET_FAILED;
        double error = (double)INFINITY;
        pl_status status = try_budget(s, middle, &trial, &error, fault);
        if (status != PL_OK) {
            return status;
        }
        if (trial == PL_BUDGET_END_SEARCH) {
            s->found->state = PL_BUDGET_STOPPED;
            return PL_OK;
        }
        *(is_near(s, error) ? &near : &far) = middle;
    }
    s->found->budget = near;
    return PL_OK;
}

pl_status pl_budget_search(const pl_budget_search_def *def, pl_budget_found *found, pl_error *fault)
{
    *found = (pl_budget_found){.converged = (double)NAN};
    search s = {.def = def, .found = found};
    pl_status status = double_up(&s, fault);
    if (status != PL_OK || found->state != PL_BUDGET_FOUND) {
        return status;
    }
    found->converged = s.errors[s.count - 1];
    int k = 0;
    while (k < s.count - 1 && !(is_near(&s, s.errors[k]) && is_near(&s, s.errors[k + 1]))) {
        ++k;
    }
    const long near = def->least << k;
    return bisect(&s, k == 0 ? near - 1 : near / 2, near, fault);
}

int pl_budget_most_trials(long least, long most)
{
    long last = least;
    int trials = 1;
    while (last <= most / 2) {
        last *= 2;
        trials += 1;
    }
    for (long gap = last == least ? 1 : last / 2; gap > 1; gap -= gap / 2) {
        trials += 1;
    }
    return trials;
}
