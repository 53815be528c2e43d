/* Rows: the repeats of one run summarised together, as a baseline keeps them. */
#ifndef PLUMB_GATE_ROWS_H
#define PLUMB_GATE_ROWS_H

#include "results/result_table.h"

/* A cell of a table, or a row of a baseline. */
typedef struct pl_gate_row {
    json_t *json; /* owned; its object in a baseline file, which holds the texts and metrics */
    char *key;    /* owned; pl_case_key, then the engine */
    char name[PL_CASE_NAME_SIZE]; /* pl_case_name */
    const char *scenario, *label, *outcome;
    pl_verdict verdict;
    const json_t *metrics; /* name -> number, text, or null where it applies and has no value */
    const pl_result_cell *cell; /* NULL: of a baseline */
    const char *reason;         /* why the outcome is not ok; "" when it is, and of a baseline */
    const char
        *verdict_reason; /* why the verdict is not accurate; "" when it is, and of a baseline */
} pl_gate_row;

/* A list of rows. */
typedef struct pl_gate_rows {
    pl_gate_row *items; /* sorted by key */
    int count;
    const pl_result_table *results; /* whose cells they are; NULL: of a baseline */
} pl_gate_rows;

/* Adds a row of an object, which it takes, and whose members must be there and of the right types. */
void pl_gate_rows_add(pl_gate_rows *rows, json_t *json, const pl_result_cell *cell);

/* Sorts by key. */
void pl_gate_rows_sort(pl_gate_rows *rows);

/* Adds dt and duration to names that several rows share. Both lists are looked at, so that a row has the same name
 * in both. */
void pl_gate_rows_disambiguate(pl_gate_rows *rows, pl_gate_rows *other);

/* Returns the row of that key; NULL when there is none. */
const pl_gate_row *pl_gate_rows_find(const pl_gate_rows *rows, const char *key);

/* Whether the outcome of all repeats is ok. */
bool pl_gate_row_is_ok(const pl_gate_row *row);

/* Summarises a metric over the repeats of a row of results. It has no value as soon as one repeat has none. */
pl_metric_summary pl_gate_row_metric(const pl_gate_row *row, const char *metric);

/* Frees all rows. */
void pl_gate_rows_free(pl_gate_rows *rows);

#endif
