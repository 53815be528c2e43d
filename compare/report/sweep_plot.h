/* Plots of a sweep as inline SVG. Their colours are rules of page/sweep.css. */
#ifndef PLUMB_REPORT_SWEEP_PLOT_H
#define PLUMB_REPORT_SWEEP_PLOT_H

#include "base/text_buffer.h"
#include "studies/sweep/analysis.h"

/* Adds error over cost of a scene, both logarithmic: a front for each whole engine, ours drawn last
 * and thicker; points off the front faint; failed points as crosses along the upper edge. Nothing
 * where the scene has no points. */
void pl_sweep_plot_scene(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                         pl_text_buffer *out);

/* Adds shares of scenes over the factor tau, logarithmic to 100, a line for each engine. Nothing
 * where no engine solved any. */
void pl_sweep_plot_profile(const pl_sweep_analysis *analysis, const pl_sweep_profile *profile,
                           pl_text_buffer *out);

#endif
