/* What every part of an analysis asks. */
#include "analysis.h"

const double pl_sweep_levels[PL_SWEEP_LEVELS] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
const double pl_sweep_times[PL_SWEEP_TIMES] = {1e-6, 2e-6, 5e-6, 1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4,
                                               1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 0.1,  0.2,  0.5,
                                               1,    2,    5,    10,   20,   50,   100};
/* The one that losses of a report are judged by. */
const double pl_sweep_error_floor = 1e-9;

bool pl_sweep_point_is_of(const pl_sweep_point *point, int engine)
{
    return point->engines[0] == engine || point->engines[1] == engine;
}

bool pl_sweep_curve_was_run(const pl_sweep_curve *curve)
{
    return curve->ok + curve->failed + curve->unmeasured > 0;
}
