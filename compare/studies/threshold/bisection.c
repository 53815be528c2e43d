#include "bisection.h"

pl_bisection pl_bisection_begin(double low, double high, bool holds_below, double tolerance)
{
    return (pl_bisection){
        .low = low, .high = high, .tolerance = tolerance, .holds_below = holds_below};
}

static double middle_of(const pl_bisection *b)
{
    return b->low + (b->high - b->low) / 2;
}

double pl_bisection_next(const pl_bisection *b)
{
    return b->trials == 0 ? b->low : b->trials == 1 ? b->high : middle_of(b);
}

/* A bracket of two neighbouring numbers has no middle. */
static bool is_narrow(const pl_bisection *b)
{
    double middle = middle_of(b);
    return b->high - b->low <= b->tolerance || middle <= b->low || middle >= b->high;
}

static void judge_ends(pl_bisection *b, bool high_holds)
{
    if (b->low_holds == high_holds) {
        b->state = high_holds ? PL_BISECTION_ALWAYS_HOLDS : PL_BISECTION_NEVER_HOLDS;
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
        *(holds == b->holds_below ? &b->low : &b->high) = middle_of(b);
    }
    b->trials++;
    if (b->trials >= 2 && b->state == PL_BISECTION_SEARCHING && is_narrow(b)) {
        b->state = PL_BISECTION_FOUND;
    }
}

int pl_bisection_most_trials(const pl_bisection *bisection)
{
    int trials = 2;
    for (double width = bisection->high - bisection->low;
         width > bisection->tolerance && trials < 1100; width /= 2) {
        trials++;
    }
    return trials;
}
