/* The gap of any pair: of a mesh by its surface, of others by closed form where there is one and by
 * GJK and EPA otherwise. */
#include "gap.h"

static bool has(const pl_placed_shape *a, const pl_placed_shape *b, pl_shape_kind kind)
{
    return a->shape->kind == kind || b->shape->kind == kind;
}

pl_status pl_gap(const pl_placed_shape *a, const pl_placed_shape *b, double within, double *gap)
{
    pl_status status = pl_gap_closed_form(a, b, gap);
    if (status != PL_UNSUPPORTED) {
        return status;
    }
    return has(a, b, PL_SHAPE_MESH) && !has(a, b, PL_SHAPE_PLANE)
               ? pl_gap_mesh(a, b, within, gap)
               : pl_gap_convex(a, b, within, gap);
}
