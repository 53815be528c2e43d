/* Results gathered for a report: a row for each case (scenario with its parameters and seed), a
 * column for each engine configuration, and in each cell a summary of all repeats of that run. */
#ifndef PLUMB_RESULT_MATRIX_H
#define PLUMB_RESULT_MATRIX_H

#include "base/text_buffer.h"
#include "metric_summary.h"
#include "plumb/base.h"
#include "plumb/scenario.h"
#include "results/run_verdict.h"

/* The runs of an engine configuration on a case. */
typedef struct pl_cell {
    const json_t *result; /* the first of the worst repeats; NULL: not run */
    int repeats, ok_repeats;
    const char *outcome, *reason; /* of `result`; "" when there is none */
    pl_verdict verdict;           /* of `result`, and so the worst; PL_VERDICT_UNJUDGED: none */
    bool ok;                      /* the outcome of all repeats is */
    bool outcomes_differ;
    bool mixed_hosts; /* repeats come from different processors */
    pl_metric_summary metrics[PL_METRIC_COUNT];
} pl_cell;

/* An engine configuration, by label, version, build of the harness and binary of the engine. */
typedef struct pl_column {
    const char *label, *engine, *version, *git, *binary;
    char name[256]; /* the label, with what distinguishes it where labels alone are not unique */
    const char *runtime; /* what runs the engine's code; NULL: it is native */
    int threads;         /* that its runs ask for */
    bool ours;
} pl_column;

/* A scenario with its parameters and seed. */
typedef struct pl_case {
    const json_t *result;         /* that of its first cell that was run */
    const pl_scenario *catalogue; /* NULL: a scene file, or unknown here */
    const char *scenario, *scene_hash, *primary_error;
    const json_t *params;
    json_int_t seed;
    char name[256]; /* the scenario, with the parameters that are off their defaults */
    pl_cell *cells; /* (column_count) */
} pl_case;

/* The cases, the engine configurations, and their cells. */
typedef struct pl_result_matrix {
    const json_t *results; /* all results, borrowed */
    pl_case *cases;        /* in the catalogue's order, then by name */
    int case_count;
    pl_column *columns; /* ours first, then by label */
    int column_count;
    int run_count;
    bool disagrees;     /* some cell has repeats that should agree and do not */
    bool several_hosts; /* results come from different processors */
} pl_result_matrix;

/* Gathers results, which must outlive *matrix. Results that are equal in every key count once.
 * PL_BAD_INPUT names the result (from 0) and the key that is missing or of the wrong type. The
 * caller frees, also on failure. */
pl_status pl_result_matrix_build(const json_t *results, pl_result_matrix *matrix, pl_error *error);

/* Frees the matrix. */
void pl_result_matrix_free(pl_result_matrix *matrix);

/* Returns the text `key` of the object `object` of a result; "" when it is absent or not a text. */
const char *pl_result_text(const json_t *result, const char *object, const char *key);

/* Whether the metric is the case's primary error, so that reference_error is the same. */
bool pl_case_primary_is(const pl_case *test_case, int metric);

/* Whether the case is that of a suite's entry: its scenario and parameters, with any time step and
 * duration, which publications leave open. */
bool pl_case_is_entry(const pl_case *test_case, const pl_suite_entry *entry);

enum { PL_CELL_TIME_SIZE = 2 * PL_METRIC_TEXT_SIZE + 8 };

/* Writes the time of a step by `write`, pl_metric_text or pl_metric_spread_text; of a column that
 * asks for several threads the elapsed time too: "12.3 ms, wall 6.8 ms". */
void pl_cell_time_text(const pl_column *column, const pl_cell *cell,
                       void (*write)(const pl_metric_summary *summary,
                                     char text[PL_METRIC_TEXT_SIZE]),
                       char text[PL_CELL_TIME_SIZE]);

/* Returns the least time of a step over native engines whose outcome is ok; INFINITY without any. */
double pl_case_least_time(const pl_result_matrix *matrix, const pl_case *test_case);

/* Whether the cell has repeats that should agree and do not. */
bool pl_cell_disagrees(const pl_cell *cell);

/* Moves *row and *column, row by row, to the next cell that was run, from there on, and for which
 * `holds` is true. False when there is none. */
bool pl_result_matrix_next(const pl_result_matrix *matrix,
                           bool (*holds)(const pl_case *test_case, const pl_cell *cell), int *row,
                           int *column);

/* Adds the names of the columns of plumb (`ours`), or of the others, separated by commas. */
void pl_result_matrix_engines(const pl_result_matrix *matrix, bool ours, pl_text_buffer *out);

/* Adds the settings of a column's engine, as "name = value", in plain text: those of its first run.
 * The time step and the duration, which belong to the case, are left out. */
void pl_result_matrix_settings(const pl_result_matrix *matrix, int column, pl_text_buffer *out);

#endif
