/* Bisection of a critical value: one trial at a time says whether the scene holds at a value. No
 * engine is known here. */
#ifndef PLUMB_BISECTION_H
#define PLUMB_BISECTION_H

#include <stdbool.h>

typedef enum pl_bisection_state {
    PL_BISECTION_SEARCHING,
    PL_BISECTION_FOUND,
    PL_BISECTION_NEVER_HOLDS,  /* at neither end */
    PL_BISECTION_ALWAYS_HOLDS, /* at both ends */
    PL_BISECTION_REVERSED      /* at the end that should fall, and not at the other */
} pl_bisection_state;

typedef struct pl_bisection {
    double low, high; /* the bracket so far */
    double tolerance; /* of the bracket's width, > 0 */
    bool holds_below;
    int trials;
    bool low_holds; /* once trials > 0 */
    pl_bisection_state state;
} pl_bisection;

/* low < high; the scene should hold at low and not at high (holds_below), or the other way round.
 */
pl_bisection pl_bisection_begin(double low, double high, bool holds_below, double tolerance);

/* The value to be tried next: both ends first, then the middle of the bracket. Only while
 * searching. */
double pl_bisection_next(const pl_bisection *bisection);

/* Takes in whether the scene holds at that value. */
void pl_bisection_take(pl_bisection *bisection, bool holds);

/* Trials that a whole search takes, at most. */
int pl_bisection_most_trials(const pl_bisection *bisection);

#endif
