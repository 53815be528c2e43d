/* Results gathered for a report: a block for each problem (scenario, parameters, seed), a column
 * for each engine, and where they meet a cell with what all repeats of that run say together. */
#ifndef PLUMB_CELLS_H
#define PLUMB_CELLS_H

#include "base/text_buffer.h"
#include "plumb/base.h"
#include "plumb/scenario.h"
#include "report_measure.h"
#include "report_row.h"

typedef struct pl_cell {
    const json_t
        *row; /* the run that the cell shows: the first that failed, or the first; NULL: not run */
    int repeats, ok_repeats;
    const char *outcome, *reason; /* of `row`; "" when there is none */
    bool ok;                      /* all repeats are */
    bool outcomes_differ;
    bool mixed_hosts; /* repeats come from different processors */
    pl_measure measure[PL_METRIC_COUNT];
} pl_cell;

/* An engine with its settings: label, version and the build of the harness. */
typedef struct pl_column {
    const char *label, *engine, *version, *git;
    char name[256]; /* the label, with version and build where labels alone are not unique */
    bool ours;
} pl_column;

typedef struct pl_block {
    const json_t *row;            /* that of its first cell that was run */
    const pl_scenario *catalogue; /* NULL: a scene file, or unknown here */
    const char *scenario, *scene_hash, *primary_error;
    const json_t *params;
    json_int_t seed;
    char name[256]; /* the scenario, with the parameters that are off their defaults */
    pl_cell *cells; /* (column_count) */
} pl_block;

typedef struct pl_result_matrix {
    const json_t *results; /* all rows, borrowed */
    pl_block *blocks;      /* in the catalogue's order, then by name */
    int block_count;
    pl_column *columns; /* ours first, then by label */
    int column_count;
    int run_count;
    bool disagrees;     /* some cell has repeats that should agree and do not */
    bool several_hosts; /* rows come from different processors */
} pl_result_matrix;

/* `results` must outlive *cells. Rows that are equal in every key are counted once. PL_BAD_INPUT
 * names the row (from 0) and the key that is missing or of the wrong type. The caller frees, also
 * on failure. */
pl_status pl_result_matrix_build(const json_t *results, pl_result_matrix *cells, pl_error *error);
void pl_result_matrix_free(pl_result_matrix *cells);

/* The block's primary error is this metric: reference_error says the same. */
bool pl_block_primary_is(const pl_block *block, int metric);

/* The smallest value of a metric over cells whose outcome is ok; INFINITY when there is none. */
double pl_block_least(const pl_block *block, int column_count, int metric);

/* The cell has repeats that should agree and do not. */
bool pl_cell_disagrees(const pl_cell *cell);

/* Moves *block, *column, block by block, to the next run from there on that is not ok. False when
 * there is none. */
bool pl_result_matrix_next_failure(const pl_result_matrix *cells, int *block, int *column);

/* What a reader of these results must be warned of: the first words, and the rest, plain text. */
typedef struct pl_warning {
    const char *head, *text;
} pl_warning;

/* Returns how many of `warnings` there are. */
enum { PL_WARNINGS_MOST = 2 };
int pl_result_matrix_warnings(const pl_result_matrix *cells, pl_warning warnings[PL_WARNINGS_MOST]);

/* The settings of a column's engine, as "name = value", in plain text: those of its first run. The
 * scene's time step and duration are not the engine's, and left out. */
void pl_result_matrix_settings(const pl_result_matrix *cells, int column, pl_text_buffer *buffer);

#endif
