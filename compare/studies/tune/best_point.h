/* What the search found, measured again, moved, and tried on what it was not tuned on. */
#ifndef PLUMB_TUNE_ANSWER_H
#define PLUMB_TUNE_ANSWER_H

#include "tuner.h"

/* Measures the best trials again, in turns with what is shipped, and takes the cheapest that misses
 * nothing in validation, or else the cheapest. */
pl_status pl_answer_choose(pl_tuner *t, pl_error *error);

/* Its sensitivities: each axis moved either way. */
pl_status pl_answer_slope(pl_tuner *t, pl_error *error);

/* The answer on what it was not tuned on: sets the checks anew. */
pl_status pl_answer_validate(pl_tuner *t, pl_error *error);

#endif
