/* The gap of any pair: by closed form where there is one, by libccd otherwise. */
#include "referee/gap.h"

pl_status pl_gap(const pl_placed_shape *a, const pl_placed_shape *b, double *gap)
{
    pl_status status = pl_gap_closed_form(a, b, gap);
    return status == PL_UNSUPPORTED ? pl_gap_convex(a, b, gap) : status;
}
