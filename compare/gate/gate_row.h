/* Rows: what all repeats of one run say together, as a baseline keeps it. */
#ifndef PLUMB_GATE_ROW_H
#define PLUMB_GATE_ROW_H

#include "plumb/base.h"

#include <jansson.h>
#include <stddef.h>

/* One result that went into a row. */
typedef struct pl_gate_sample {
    int file; /* which file of results, from 0 */
    json_int_t repeat;
    const json_t *metrics; /* borrowed from the results */
} pl_gate_sample;

typedef struct pl_gate_row {
    json_t *json; /* owned; its object in a baseline file: the texts and metrics are of it */
    char *key;    /* the problem, then the engine; malloc'd */
    size_t problem_length; /* bytes of the key that rows of one problem share */
    char name[192];        /* the scenario, with the parameters that are off their defaults */
    const char *scenario, *label, *outcome;
    const json_t *metrics; /* name -> number, text, or null where it applies and has no value */

    /* These of rows that come from results, else NULL and 0. */
    const char *reason;      /* why the outcome is not ok; "" when it is */
    json_t *reasons;         /* owned; metric -> why it has no value */
    json_t *spread;          /* owned; [least, largest] of metrics whose repeats differ */
    json_t *measured;        /* owned; medians of metrics that no two runs share */
    pl_gate_sample *samples; /* (sample_count), owned */
    int sample_count;
} pl_gate_row;

typedef struct pl_gate_rows {
    pl_gate_row *items; /* by key */
    int count;
} pl_gate_rows;

/* Fills key, name and texts from row->json, whose members must be there and of the right types.
 * False: out of memory. */
bool pl_gate_row_identify(pl_gate_row *row);

/* Sorts by key. */
void pl_gate_rows_sort(pl_gate_rows *rows);

/* Names that several rows share get dt, duration and seed. Of two lists at once, so that a row is
 * called the same in both; `other` may be NULL. */
void pl_gate_rows_tell_apart(pl_gate_rows *rows, pl_gate_rows *other);

/* The row of that key; NULL when there is none. */
const pl_gate_row *pl_gate_rows_find(const pl_gate_rows *rows, const char *key);

/* The row of the engine called `label` on the problem of `row`; NULL when there is none. */
const pl_gate_row *pl_gate_rows_beside(const pl_gate_rows *rows, const pl_gate_row *row,
                                       const char *label);

bool pl_gate_row_is_ok(const pl_gate_row *row);

void pl_gate_row_free(pl_gate_row *row);
void pl_gate_rows_free(pl_gate_rows *rows);

#endif
