/* Results gathered for a report: a block for each problem (scenario, parameters, seed), a column
 * for each engine, and where they meet a cell with what all repeats of that run say together. */
#ifndef PLUMB_CELLS_H
#define PLUMB_CELLS_H

#include "plumb/base.h"
#include "plumb/scenario.h"
#include "referee/metrics.h"

#include <jansson.h>

/* A metric over the repeats of one run. Texts are borrowed from the results. */
typedef struct pl_measure {
    pl_metric_state state; /* VALUE when any repeat has a number */
    double value;          /* the median of the repeats that have a number */
    double min, max, mad;  /* mad: median of |x - median| */
    int count;             /* repeats that have a number */
    const char *text;      /* state TEXT */
    const char *reason;    /* state FAILED */
    const char *unit;      /* the result's own, or the table's */
    bool disagrees;        /* said to be deterministic, yet repeats differ */
    bool has_percentiles;
    double p50, p95, p99, worst_step; /* medians over repeats */
} pl_measure;

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

typedef struct pl_cells {
    const json_t *results; /* all rows, borrowed */
    pl_block *blocks;      /* in the catalogue's order, then by name */
    int block_count;
    pl_column *columns; /* ours first, then by label */
    int column_count;
    int run_count;
    bool disagrees;     /* some cell has repeats that should agree and do not */
    bool several_hosts; /* rows come from different processors */
} pl_cells;

/* `results` must outlive *cells. Rows that are equal in every key are counted once. PL_BAD_INPUT
 * names the row (from 0) and the key that is missing or of the wrong type. The caller frees, also
 * on failure. */
pl_status pl_cells_build(const json_t *results, pl_cells *cells, pl_error *error);
void pl_cells_free(pl_cells *cells);

/* A text of a row, or of an object in it; "" when it is absent or no text. */
const char *pl_row_text(const json_t *row, const char *key);
const char *pl_row_text_in(const json_t *row, const char *object, const char *key);

/* The metric's value as in a table ("–" when there is none), without any mark. */
void pl_measure_text(const pl_measure *measure, char *text, int size);

/* What a tooltip says: the reason, or spread and percentiles; "" when there is nothing to say. */
void pl_measure_note(const pl_measure *measure, char *text, int size);

/* The block's primary error is this metric: reference_error says the same. */
bool pl_block_primary_is(const pl_block *block, int metric);

/* The smallest value of a metric over cells whose outcome is ok; INFINITY when there is none. */
double pl_block_least(const pl_block *block, int column_count, int metric);

/* The cell has repeats that should agree and do not. */
bool pl_cell_disagrees(const pl_cell *cell);

#endif
