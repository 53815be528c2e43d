/* Bisection for the value of a parameter at which a scene stops holding. */
#ifndef PLUMB_BISECTION_H
#define PLUMB_BISECTION_H

#include <stdbool.h>

/* Whether a bisection goes on, and how it ended. */
typedef enum pl_bisection_state {
    PL_BISECTION_SEARCHING,
    PL_BISECTION_FOUND,
    PL_BISECTION_NEVER_HOLDS,  /* at neither end of the bracket */
    PL_BISECTION_ALWAYS_HOLDS, /* at both ends */
    PL_BISECTION_REVERSED      /* only at the end where it should fail */
} pl_bisection_state;

/* A bisection. It begins with the members up to `either_side`, and all others zero. */
typedef struct pl_bisection {
    double low, high; /* the bracket so far */
    double tolerance; /* of the bracket's width, > 0; 1 of whole numbers */
    bool is_whole;    /* only whole numbers are tried; the ends are whole */
    bool holds_below; /* the scene should hold at `low` and fail at `high`; else the reverse */
    bool either_side; /* both are right: the two ends set holds_below */
    int trials;
    bool low_holds; /* defined once trials > 0 */
    pl_bisection_state state;
} pl_bisection;

/* Begins a search for the least whole number above `fails` that holds, up to `holds`; neither end is tried. */
pl_bisection pl_bisection_least(long fails, long holds);

/* The value to try next: both ends first, then the midpoint of the bracket. Call it only while the
 * state is PL_BISECTION_SEARCHING. */
double pl_bisection_next(const pl_bisection *bisection);

/* Records whether the scene holds at the value that pl_bisection_next returned. */
void pl_bisection_take(pl_bisection *bisection, bool holds);

/* The midpoint of the bracket, a whole number where only those are tried. */
double pl_bisection_midpoint(const pl_bisection *bisection);

/* The most trials that a whole search takes. */
int pl_bisection_most_trials(const pl_bisection *bisection);

#endif
