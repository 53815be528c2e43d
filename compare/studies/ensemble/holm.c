#include "holm.h"

#include <math.h>
#include <stdlib.h>

typedef struct ranked {
    double p;
    int index;
} ranked;

static int ascending(const void *a, const void *b)
{
    const ranked *x = a, *y = b;
    return (x->p > y->p) - (x->p < y->p);
}

pl_status pl_holm(const double *p, int count, double *corrected, pl_error *error)
{
    ranked *order = calloc((size_t)count + 1, sizeof *order);
    if (order == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d tests", count);
    }
    for (int i = 0; i < count; ++i) {
        order[i] = (ranked){p[i], i};
    }
    qsort(order, (size_t)count, sizeof *order, ascending);
    double largest = 0;
    for (int k = 0; k < count; ++k) {
        largest = fmax(largest, fmin(1, (count - k) * order[k].p));
        corrected[order[k].index] = largest;
    }
    free(order);
    return PL_OK;
}
