#include "budget_search.h"

#include <math.h>

static const double small_change = 0.01, near_enough = 1.1;

pl_budget_search pl_budget_begin(long least, long most, double floor)
{
    return (pl_budget_search){
        .least = least, .most = most, .floor = floor, .converged = (double)NAN};
}

long pl_budget_next(const pl_budget_search *s)
{
    return s->bisects ? (long)pl_bisection_next(&s->bisection) : s->least << s->doublings;
}

static bool changed_little(const pl_budget_search *s, int k)
{
    const double before = s->errors[k - 1], after = s->errors[k];
    return isfinite(before) && isfinite(after) &&
           fabs(after - before) <= small_change * before + s->floor;
}

static bool is_settled(const pl_budget_search *s)
{
    const int last = s->doublings - 1;
    return last >= 2 && changed_little(s, last) && changed_little(s, last - 1);
}

static bool is_near(const pl_budget_search *s, double error)
{
    return error <= near_enough * s->converged + s->floor;
}

/* Takes the budget where the bisection has found it. */
static void look_for_budget(pl_budget_search *s)
{
    if (s->bisection.state == PL_BISECTION_FOUND) {
        s->state = PL_BUDGET_FOUND;
        s->budget = (long)s->bisection.high;
    }
}

/* Bisects between a doubling that is not near and the next one, which is. */
static void begin_bisection(pl_budget_search *s)
{
    int k = 0;
    s->converged = s->errors[s->doublings - 1];
    while (k < s->doublings - 1 && !(is_near(s, s->errors[k]) && is_near(s, s->errors[k + 1]))) {
        ++k;
    }
    const long near = s->least << k;
    s->bisects = true;
    s->bisection = pl_bisection_least(k == 0 ? near - 1 : near / 2, near);
    look_for_budget(s);
}

static void end_doubling(pl_budget_search *s)
{
    bool any = false;
    for (int k = 0; k < s->doublings; ++k) {
        any = any || isfinite(s->errors[k]);
    }
    if (isfinite(s->errors[s->doublings - 1])) {
        begin_bisection(s);
    } else {
        s->state = any ? PL_BUDGET_LARGEST_FAILED : PL_BUDGET_ALL_FAILED;
    }
}

void pl_budget_take(pl_budget_search *s, double error)
{
    const long budget = pl_budget_next(s);
    ++s->trials;
    s->largest = s->bisects ? s->largest : budget;
    if (isnan(error)) {
        s->state = PL_BUDGET_STOPPED;
    } else if (s->bisects) {
        pl_bisection_take(&s->bisection, is_near(s, error));
        look_for_budget(s);
    } else {
        s->errors[s->doublings++] = error;
        if (budget > s->most / 2 || is_settled(s)) {
            end_doubling(s);
        }
    }
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
