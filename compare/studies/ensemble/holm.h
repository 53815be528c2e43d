/* Many tests at once. */
#ifndef PLUMB_HOLM_H
#define PLUMB_HOLM_H

#include "plumb/base.h"

/* Holm's step-down correction (1979): corrected[i] <= a says that test i rejects while the chance
 * of any false rejection among all `count` stays at a. With the p ascending, the k-th (from 0) is
 * the largest of min(1, (count - j) p_j) over j <= k. */
pl_status pl_holm(const double *p, int count, double *corrected, pl_error *error);

#endif
