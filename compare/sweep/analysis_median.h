/* Medians and quantiles of a few numbers. */
#ifndef PLUMB_SWEEP_ANALYSIS_MEDIAN_H
#define PLUMB_SWEEP_ANALYSIS_MEDIAN_H

/* Sorts `values`; NAN for none. */
double pl_sweep_median(double *values, int count);

/* Ascending. */
void pl_sweep_sort(double *values, int count);

#endif
