/* Numbers and ranges of numbers as a user writes them. */
#ifndef PLUMB_SWEEP_VARY_RANGE_H
#define PLUMB_SWEEP_VARY_RANGE_H

#include "plumb/base.h"

enum { PL_VARY_MOST_VALUES = 100000 };

typedef struct pl_numbers {
    double *items; /* (count), owned */
    int count;
} pl_numbers;

/* Appends what one text stands for: a number; A..B, in steps of 1; A..B:+S, in steps of S > 0;
 * A..B:xF, each F > 1 times the last, of A > 0. B belongs to the range when a step ends on it. A,
 * B, S and F are decimals or fractions. Numbers without fractions are decimals of 15 digits, so
 * that 0..1:+0.1 has 0.3 and not 0.30000000000000004.
 *
 * PL_BAD_INPUT: no number, a range that is empty or endless, or more than PL_VARY_MOST_VALUES. */
pl_status pl_vary_range(const char *text, pl_numbers *numbers, pl_error *error);

#endif
