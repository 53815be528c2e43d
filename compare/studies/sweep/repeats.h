/* Which runs are worth repeating: repeats tell the noise of short runs; the median over the steps
 * of a long one hardly moves. */
#ifndef PLUMB_SWEEP_REPEATS_H
#define PLUMB_SWEEP_REPEATS_H

#include "runner/plan.h"

typedef struct pl_repeats {
    double limit;   /* s of the engine's CPU time: what takes longer is not repeated */
    json_t *points; /* run hash -> point, of all runs; first runs of a point in `first` too */
    json_t *first;
    json_t *spared; /* points, as keys */
} pl_repeats;

/* Numbers the points of a plan. PL_NO_MEMORY. The caller frees in any case. */
pl_status pl_repeats_begin(pl_repeats *repeats, const pl_plan *plan, double limit, pl_error *error);
void pl_repeats_free(pl_repeats *repeats);

/* Takes note of a result. */
void pl_repeats_see(pl_repeats *repeats, const json_t *result);

/* Whether the run is a repeat of what is too long to be repeated. */
bool pl_repeats_spare(const pl_repeats *repeats, const char *run);

#endif
