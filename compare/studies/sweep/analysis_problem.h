/* A scene of an analysis, from its rows. */
#ifndef PLUMB_SWEEP_ANALYSIS_PROBLEM_H
#define PLUMB_SWEEP_ANALYSIS_PROBLEM_H

#include "analysis.h"

/* Named, without points; texts are borrowed from the row. */
pl_sweep_scene make_scene_of(const json_t *row, int first);

/* Takes the unit of the primary error from a row that gives it. */
void pl_sweep_take_unit(pl_sweep_scene *scene, const json_t *row);

#endif
