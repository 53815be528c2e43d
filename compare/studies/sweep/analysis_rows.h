/* Rows of results with their keys, sorted so that those of one point are neighbours. */
#ifndef PLUMB_SWEEP_ANALYSIS_ROWS_H
#define PLUMB_SWEEP_ANALYSIS_ROWS_H

#include "plumb/base.h"

#include <jansson.h>
#include <stdbool.h>

/* A row with its keys. */
typedef struct pl_keyed_row {
    const json_t *row;
    char *scene, *series; /* owned; a changed scene has the keys of the unchanged one */
    const char *change;   /* "": none; borrowed */
    double dt;            /* s */
    size_t index;
} pl_keyed_row;

/* Checks row number `index` and makes its keys. PL_BAD_INPUT names the row and the key that is
 * missing or of the wrong type. The caller frees *keyed in any case. */
pl_status pl_keyed_row_make(const json_t *row, size_t index, pl_keyed_row *keyed, pl_error *error);

/* Frees the keys. */
void pl_keyed_row_free(pl_keyed_row *keyed);

/* Sorts by scene (in the catalogue's order, then by name), engine (ours first, then by name),
 * profile, series and falling dt; in each point rows of the unchanged scene come first, then those of
 * each change, by repeat. Whatever the order before, that after is the same. */
void pl_keyed_rows_sort(pl_keyed_row *rows, size_t count);

/* Whether both are runs of one engine with the same settings on the same scene, or changes of it. */
bool pl_keyed_row_is_same_point(const pl_keyed_row *a, const pl_keyed_row *b);

/* Whether an engine of this name in results is plumb itself. */
bool pl_engine_is_ours(const char *engine);

#endif
