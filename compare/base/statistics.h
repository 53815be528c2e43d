/* Order statistics of samples of numbers. */
#ifndef PLUMB_STATISTICS_H
#define PLUMB_STATISTICS_H

/* A comparator for qsort of doubles, ascending; NAN equals every number, so leave it out. Records
 * that begin with the double that they are ordered by can be sorted with it too. */
int pl_compare_numbers(const void *left, const void *right);

/* Sorts `values` ascending. */
void pl_sort_numbers(double *values, int count);

/* The median, which for an even count is the mean of the middle two. Sorts `values`. NAN for no
 * values. */
double pl_median(double *values, int count);

/* The value at the share `share`, 0 to 1, of sorted values, linearly between the two order
 * statistics next to the position share * (count - 1): type 7 of Hyndman and Fan 1996. NAN for no
 * values. */
double pl_quantile(const double *sorted, int count, double share);

#endif
