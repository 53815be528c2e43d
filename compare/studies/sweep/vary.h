/* One --vary KEY=VALUES: what is varied, and the values that it takes. */
#ifndef PLUMB_SWEEP_VARY_H
#define PLUMB_SWEEP_VARY_H

#include "runner/plan.h"

/* The key of a profile; a user may also write "solver". */
#define PL_VARY_PROFILE "profile"

enum {
    PL_VARY_MOST_VALUES = 100000,
    PL_SWEEP_DEFAULT_REPEATS = 3,
    PL_SWEEP_DEFAULT_CPU_LIMIT = 3, /* s */
    PL_SWEEP_DEFAULT_SETTINGS = 20, /* of each engine */
    PL_SWEEP_DEFAULT_CHANGES = 2    /* of each scene */
};

/* The time steps of the usual sweep. Coarse ones first: what takes too long there need not be tried
 * at the others. */
#define PL_SWEEP_STEPS "dt=1/60,1/120,1/240,1/480,1/960"

/* A key of a profile, an option or a parameter, and the values that it takes. */
typedef struct pl_vary {
    char owner[PL_NAME_SIZE]; /* the engine or scenario that it is restricted to; empty: none */
    char key[PL_NAME_SIZE];
    char **names;    /* (count) of PL_VARY_PROFILE; NULL for other keys */
    double *numbers; /* (count) of other keys, in the unit of the key */
    int count;       /* >= 1 */
} pl_vary;

/* Parses "[OWNER.]KEY=VALUES". VALUES are names, or numbers and ranges, separated by commas;
 * repeated values are left out. Ranges are A..B, in steps of 1; A..B:+S, in steps of S > 0; and
 * A..B:xF, each F > 1 times the last, with A > 0. B belongs to the range when a step ends on it. A,
 * B, S and F are decimals or fractions. Values of ranges without fractions are rounded to 15
 * digits, so that 0..1:+0.1 has 0.3 and not 0.30000000000000004.
 *
 * PL_BAD_INPUT: anything else, a range that is empty or endless, or more than PL_VARY_MOST_VALUES;
 * *vary is then empty. */
pl_status pl_vary_parse(const char *text, pl_vary *vary, pl_error *error);

/* Frees what parsing allocated. */
void pl_vary_free(pl_vary *vary);

#endif
