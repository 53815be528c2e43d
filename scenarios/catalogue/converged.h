/* The end statistics on which converged engines agree, for scenes whose motion is chaotic. */
#ifndef PLUMB_CONVERGED_H
#define PLUMB_CONVERGED_H

#include "scene_builder.h"

/* Adds the statistics that are known for these parameter values to the scene. There are none for
 * other values than the defaults (any dt will do), and in a scenario that draws random
 * numbers none for a seed other than 0. */
void pl_build_statistics(pl_builder *builder, const pl_scenario *scenario, const double *values,
                         uint64_t seed);

#endif
