/* Rows: the repeats of one run summarised together, as a baseline keeps them. */
#ifndef PLUMB_GATE_ROWS_H
#define PLUMB_GATE_ROWS_H

#include "plumb/base.h"
#include "results/run_verdict.h"

#include <jansson.h>
#include <stddef.h>

/* One result that went into a row. */
typedef struct pl_gate_sample {
    int file; /* index of the file of results it came from */
    json_int_t repeat;
    const json_t *metrics; /* borrowed from the results */
} pl_gate_sample;

/* The repeats of one run. */
typedef struct pl_gate_row {
    json_t *json; /* owned; its object in a baseline file, which holds the texts and metrics */
    char *key;    /* the case, then the engine; malloc'd */
    size_t case_length; /* bytes of the key that all rows of one case share */
    char name[192];     /* the scenario, with the parameters that are off their defaults */
    const char *scenario, *label, *outcome;
    pl_verdict verdict;
    const json_t *metrics; /* name -> number, text, or null where it applies and has no value */

    /* Only rows that come from results have these; else they are NULL and 0. */
    const char *reason;         /* why the outcome is not ok; "" when it is */
    const char *verdict_reason; /* why the verdict is not accurate; "" when it is */
    json_t *reasons;            /* owned; metric -> why it has no value */
    json_t *spread;             /* owned; [least, largest] of metrics whose repeats differ */
    json_t *measured;           /* owned; medians of metrics that differ from run to run */
    pl_gate_sample *samples;    /* (sample_count), owned */
    int sample_count;
} pl_gate_row;

/* A list of rows. */
typedef struct pl_gate_rows {
    pl_gate_row *items; /* sorted by key */
    int count;
} pl_gate_rows;

/* Fills key, name and texts from row->json, whose members must be there and of the right types.
 * False: out of memory. */
bool pl_gate_row_identify(pl_gate_row *row);

/* Sorts by key. */
void pl_gate_rows_sort(pl_gate_rows *rows);

/* Adds dt, duration and seed to names that several rows share. Both lists are looked at, so that a
 * row has the same name in both; `other` may be NULL. */
void pl_gate_rows_disambiguate(pl_gate_rows *rows, pl_gate_rows *other);

/* Returns the row of that key; NULL when there is none. */
const pl_gate_row *pl_gate_rows_find(const pl_gate_rows *rows, const char *key);

/* Returns the row of the engine called `label` on the case of `row`; NULL when there is none. */
const pl_gate_row *pl_gate_rows_same_case(const pl_gate_rows *rows, const pl_gate_row *row,
                                          const char *label);

/* Whether the outcome of all repeats is ok. */
bool pl_gate_row_is_ok(const pl_gate_row *row);

/* Frees what the row owns. */
void pl_gate_row_free(pl_gate_row *row);

/* Frees all rows. */
void pl_gate_rows_free(pl_gate_rows *rows);

#endif
