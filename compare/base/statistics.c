#include "statistics.h"

#include <math.h>
#include <stdlib.h>

int pl_compare_numbers(const void *left, const void *right)
{
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

void pl_sort_numbers(double *values, int count)
{
    if (count > 0) {
        qsort(values, (size_t)count, sizeof *values, pl_compare_numbers);
    }
}

double pl_median(double *values, int count)
{
    if (count == 0) {
        return (double)NAN;
    }
    pl_sort_numbers(values, count);
    int half = count / 2;
    return count % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double pl_quantile(const double *sorted, int count, double share)
{
    if (count == 0) {
        return (double)NAN;
    }
    double place = share * (count - 1);
    int below = (int)place;
    int above = below + 1 < count ? below + 1 : below;
    return sorted[below] + (place - below) * (sorted[above] - sorted[below]);
}
