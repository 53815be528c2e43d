/* The tables of a sweep, and what is said above them: the same on a terminal and on a page. */
#ifndef PLUMB_REPORT_SWEEP_TABLES_H
#define PLUMB_REPORT_SWEEP_TABLES_H

#include "studies/sweep/analysis.h"
#include "sweep_table.h"

/* How the losses stand, in words, in plain text. */
void pl_sweep_statement(const pl_sweep_analysis *analysis, pl_text_buffer *out);

/* What a reader must be warned of; nothing where there is nothing. Plain text. */
void pl_sweep_warning(const pl_sweep_analysis *analysis, pl_text_buffer *out);

/* A row a loss, in their order. */
void pl_sweep_losses_table(const pl_sweep_analysis *analysis, pl_sweep_table *table);

/* A row a pair: the mean ratio of speeds at an error, and who reached it. */
void pl_sweep_means_table(const pl_sweep_analysis *analysis, bool whole, int level,
                          pl_sweep_table *table);

/* A row an engine that was run on the scene: what each level costs, and what failed. */
void pl_sweep_costs_table(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                          bool whole, pl_sweep_table *table);

/* A row a pair: the ratio of speeds at each error. */
void pl_sweep_speeds_table(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                           bool whole, bool between, pl_sweep_table *table);

/* A row a pair and cost at which either has a point: the ratio of errors. */
void pl_sweep_errors_table(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                           bool whole, pl_sweep_table *table);

/* A row a series of time steps: all, or of one scene (an index; -1: all). */
void pl_sweep_orders_table(const pl_sweep_analysis *analysis, int scene, pl_sweep_table *table);

/* A row an engine: the share of scenes solved within factors of the best. */
void pl_sweep_shares_table(const pl_sweep_analysis *analysis, const pl_sweep_profile *profile,
                           pl_sweep_table *table);

/* A row a series of points without numbers that came to the same end: all, or of one scene (an
 * index; -1: all). */
void pl_sweep_failed_table(const pl_sweep_analysis *analysis, int scene, pl_sweep_table *table);

/* A row a point with numbers of a scene. */
void pl_sweep_points_table(const pl_sweep_analysis *analysis, int scene, pl_sweep_table *table);

#endif
