#include "bisection.h"

#include <math.h>

pl_bisection pl_bisection_least(long fails, long holds)
{
    const bool is_narrow = holds - fails <= 1;
    return (pl_bisection){.low = (double)fails,
                          .high = (double)holds,
                          .tolerance = 1,
                          .is_whole = true,
                          .trials = 2,
                          .state = is_narrow ? PL_BISECTION_FOUND : PL_BISECTION_SEARCHING};
}

double pl_bisection_midpoint(const pl_bisection *b)
{
    const double midpoint = b->low + (b->high - b->low) / 2;
    return b->is_whole ? floor(midpoint) : midpoint;
}

double pl_bisection_next(const pl_bisection *b)
{
    return b->trials == 0 ? b->low : b->trials == 1 ? b->high : pl_bisection_midpoint(b);
}

/* A bracket of two neighbouring numbers has no midpoint. */
static bool is_narrow(const pl_bisection *b)
{
    const double midpoint = pl_bisection_midpoint(b);
    return b->high - b->low <= b->tolerance || midpoint <= b->low || midpoint >= b->high;
}

static void judge_ends(pl_bisection *b, bool high_holds)
{
    if (b->low_holds == high_holds) {
        b->state = high_holds ? PL_BISECTION_ALWAYS_HOLDS : PL_BISECTION_NEVER_HOLDS;
    } else if (b->either_side) {
        b->holds_below = b->low_holds;
    } else if (b->low_holds != b->holds_below) {
        b->state = PL_BISECTION_REVERSED;
    }
}

void pl_bisection_take(pl_bisection *b, bool holds)
{
    if (b->trials == 0) {
        b->low_holds = holds;
    } else if (b->trials == 1) {
        judge_ends(b, holds);
    } else {
        *(holds == b->holds_below ? &b->low : &b->high) = pl_bisection_midpoint(b);
    }
    ++b->trials;
    if (b->trials >= 2 && b->state == PL_BISECTION_SEARCHING && is_narrow(b)) {
        b->state = PL_BISECTION_FOUND;
    }
}

int pl_bisection_most_trials(const pl_bisection *bisection)
{
    int trials = 2;
    for (double width = bisection->high - bisection->low;
         width > bisection->tolerance && trials < 1100; width /= 2) {
        ++trials;
    }
    return trials;
}
