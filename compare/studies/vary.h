/* One --vary of a study: what is varied, and the values that it takes. */
#ifndef PLUMB_VARY_H
#define PLUMB_VARY_H

#include "plumb/scene.h"

/* The key of a profile; a user may also write "solver". */
#define PL_VARY_PROFILE "profile"

enum { PL_VARY_MOST_VALUES = 100000 };

/* What stands after the key. */
typedef enum pl_vary_form {
    PL_VARY_VALUES,      /* --vary KEY=VALUES */
    PL_VARY_RANGE,       /* --vary KEY=LOW..HIGH */
    PL_VARY_KNOWN_RANGE, /* --vary KEY or KEY=LOW..HIGH */
    PL_VARY_FIX          /* --fix KEY=VALUE */
} pl_vary_form;

/* A key of a profile, an option or a parameter, and the values that it takes. */
typedef struct pl_vary {
    char owner[PL_NAME_SIZE]; /* the engine or scenario that it is restricted to; empty: none */
    char key[PL_NAME_SIZE];
    char **names;     /* (count) of PL_VARY_PROFILE; NULL for other keys */
    double *numbers;  /* (count) of other keys, in the unit of the key */
    int count;        /* >= 1 of values, 1 of --fix; 0 of ranges */
    double low, high; /* low < high of a range, in the unit of the key; NAN: none was given */
} pl_vary;

/* Parses "[OWNER.]KEY=..." of that form. VALUES are names, or numbers and ranges, separated by commas;
 * repeated values are left out. Such ranges are A..B, in steps of 1; A..B:+S, in steps of S > 0; and
 * A..B:xF, each F > 1 times the last, with A > 0. B belongs to the range when a step ends on it. A,
 * B, S and F are decimals or fractions. Values of ranges without fractions are rounded to 15
 * digits, so that 0..1:+0.1 has 0.3 and not 0.30000000000000004.
 *
 * PL_BAD_INPUT: anything else, a range that is empty or endless, or more than PL_VARY_MOST_VALUES;
 * *vary is then empty. */
pl_status pl_vary_parse(const char *text, pl_vary_form form, pl_vary *vary, pl_error *error);

/* Whether the key may be one of what has this name. */
bool pl_vary_is_of(const pl_vary *vary, const char *name);

/* Frees what parsing allocated. */
void pl_vary_free(pl_vary *vary);

#endif
