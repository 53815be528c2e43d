/* The parameters that are tuned: an engine's tunable options, which the user can restrict and
 * extend, and the time step. */
#ifndef PLUMB_TUNE_SPACE_H
#define PLUMB_TUNE_SPACE_H

#include "studies/tunable.h"
#include "tune_search.h"

#include <jansson.h>

/* The parameters of a search, and the values of what is not searched. */
typedef struct pl_tune_space {
    pl_engine_choice base; /* the values of all options that are not tuned */
    double dt;             /* s: the time step where "dt" is not tuned; NAN: it is tuned */
    pl_tune_parameter parameters[PL_TUNE_MAX_PARAMETERS];
    int parameter_count;
} pl_tune_space;

/* What a user asks for. */
typedef struct pl_tune_request {
    const pl_engine_choice *engine; /* options that differ from their defaults are not tuned */
    double dt;                      /* s: where "dt" begins; NAN: 1/60 s */
    const char *const *varied;      /* (varied_count): KEY=LOW..HIGH of an option or "dt" */
    int varied_count;
    const char *const *fixed; /* (fixed_count): KEY=VALUE */
    int fixed_count;
} pl_tune_request;

/* Makes the space. Numbers may be fractions. PL_BAD_INPUT: an unknown key (the message suggests the
 * nearest), a value out of the option's range, an empty range, a key given twice, a command
 * that is too long for a SPEC with all options. */
pl_status pl_tune_space_make(const pl_tune_request *request, pl_tune_space *space, pl_error *error);

/* The values of a point as a user writes them, of "dt" in s: an array. A new reference. */
json_t *pl_tune_values(const pl_tune_space *space, const double *values);

/* The engine and its time step with such values. */
pl_setting pl_tune_setting(const pl_tune_space *space, const json_t *values);

#endif
