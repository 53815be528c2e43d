/* One --vary KEY=VALUES: what is varied, and the values that it takes. */
#ifndef PLUMB_SWEEP_VARY_H
#define PLUMB_SWEEP_VARY_H

#include "plumb/base.h"

#include <stdbool.h>

/* The key of a profile; a user may also write "solver". */
#define PL_VARY_PROFILE "profile"

typedef struct pl_vary {
    char owner[PL_NAME_SIZE]; /* the engine or scenario it is restricted to; empty: none */
    char key[PL_NAME_SIZE];
    char **names;    /* (count) of PL_VARY_PROFILE; NULL for other keys */
    double *numbers; /* (count) of other keys, in the unit of the key */
    int count;       /* >= 1 */
} pl_vary;

/* Parses "[OWNER.]KEY=VALUES". VALUES are names, or numbers and ranges (vary_range.h), separated by
 * commas; a value that comes again is left out. PL_BAD_INPUT: anything else; *vary is then empty.
 */
pl_status pl_vary_parse(const char *text, pl_vary *vary, pl_error *error);

/* Frees what parsing allocated. */
void pl_vary_free(pl_vary *vary);

#endif
