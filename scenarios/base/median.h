/* The order of numbers, and their median. */
#ifndef PLUMB_RESULTS_MEDIAN_H
#define PLUMB_RESULTS_MEDIAN_H

/* Sorts `values`; NAN for none. */
double pl_median(double *values, int count);

/* Ascending. */
void pl_sort_numbers(double *values, int count);

#endif
