/* Scenes of scene files, for pl_scenario_build. */
#ifndef PLUMB_SCENE_FAMILY_H
#define PLUMB_SCENE_FAMILY_H

#include "plumb/scenario.h"

/* Reads the scene of a scenario that has a file, as pl_scenario_build does. */
pl_status pl_scene_family_build(const pl_scenario *scenario, const double *values, pl_scene *scene,
                                pl_error *error);

#endif
