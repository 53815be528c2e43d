/* What is tuned of an engine: a table of its options with sensible ranges, narrowed and added to by
 * the user. */
#ifndef PLUMB_TUNE_SPACE_H
#define PLUMB_TUNE_SPACE_H

#include "adapters/registry.h"
#include "tune_search.h"

typedef struct pl_tune_space {
    pl_engine_choice base; /* the values of all options that are not tuned */
    double dt;             /* s: of every run where "dt" is not tuned; NAN: it is tuned, or, with
                              keeps_dt, each scenario's own */
    bool keeps_dt;
    pl_tune_parameter parameters[PL_TUNE_MAX_PARAMETERS];
    int parameter_count;
} pl_tune_space;

/* The space for an engine as chosen: options that its SPEC sets to other than the profile ships are
 * not tuned. `varied` are KEY=LOW..HIGH and `fixed` KEY=VALUE, of an option or "dt", whose numbers
 * may be fractions; what is varied begins at `dt` (s), or else at what the engine ships.
 * PL_BAD_INPUT: an unknown key (with the nearest one), a value out of the option's range, an empty
 * range, a key given twice. */
pl_status pl_tune_space_make(const pl_engine_choice *engine, double dt, const char *const *varied,
                             int varied_count, const char *const *fixed, int fixed_count,
                             pl_tune_space *space, pl_error *error);

/* The engine with a point's values; and its time step, s: NAN each scenario's own. */
pl_engine_choice pl_tune_choice(const pl_tune_space *space, const double *values, double *dt);

/* A parameter's value as a user writes it: "37", or of "dt" "1/240". */
void pl_tune_value_text(const pl_tune_parameter *parameter, double value, char text[32]);

#endif
