/* The tables of a sweep, the same on a terminal and on a page, the sentences above them, and the
 * plots. The caller frees every table with pl_table_free. */
#ifndef PLUMB_REPORT_SWEEP_TABLES_H
#define PLUMB_REPORT_SWEEP_TABLES_H

#include "base/table.h"
#include "studies/sweep/analysis.h"

enum { PL_SWEEP_TEXT_SIZE = 256 };

/* Writes "×2.50 (2.31 to 2.74)"; "–" where there is no ratio. */
void pl_sweep_ratio_text(const pl_sweep_ratio *ratio, char text[PL_SWEEP_TEXT_SIZE]);

/* Writes an error with its unit; at the floor "≤ 1e-9 m". */
void pl_sweep_error_text(double error, const char *unit, char text[PL_SWEEP_TEXT_SIZE]);

/* Adds how many comparisons the home engine loses, or without one how many there were, in plain text. */
void pl_sweep_statement(const pl_sweep_analysis *analysis, pl_text_buffer *out);

/* Adds what a reader must be warned of, in plain text; nothing where there is nothing. */
void pl_sweep_warning(const pl_sweep_analysis *analysis, pl_text_buffer *out);

/* Adds which engines' adapters conformance checks have not verified; nothing where all have. */
void pl_sweep_unverified(const pl_sweep_analysis *analysis, pl_text_buffer *out);

/* A row a loss, in the order of the analysis. */
pl_table pl_sweep_losses_table(const pl_sweep_analysis *analysis);

/* A row a pair of engines, of whole ones two, as shipped and each at its best: the mean ratio of
 * speeds at a level of error, and who reached it. */
pl_table pl_sweep_means_table(const pl_sweep_analysis *analysis, pl_sweep_kind kind, int level);

/* A row a pair of whole engines and level that one of them reached: the ratio of speeds as shipped
 * and with each one's best setting, and these settings. Of one scene and level (indices; -1: all). */
pl_table pl_sweep_factors_table(const pl_sweep_analysis *analysis, int scene, int level);

/* A row an engine that was run on the scene: the cost of each level, and failed points. */
pl_table pl_sweep_costs_table(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene,
                              pl_sweep_kind kind);

/* A row a series of time steps: of all scenes, or of one (an index; -1: all). */
pl_table pl_sweep_orders_table(const pl_sweep_analysis *analysis, int scene);

/* A row an engine: the share of scenes solved within factors of the fastest. */
pl_table pl_sweep_shares_table(const pl_sweep_analysis *analysis, const pl_sweep_profile *profile);

/* A row a series of points without numbers that have one outcome: of all scenes, or of one (an
 * index; -1: all). */
pl_table pl_sweep_failed_table(const pl_sweep_analysis *analysis, int scene);

#endif
