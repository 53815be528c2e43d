/* What the search found, measured again, moved, and tried on what it was not tuned on. */
#ifndef PLUMB_TUNE_ANSWER_H
#define PLUMB_TUNE_ANSWER_H

#include "tuner.h"

/* Measures the best trials again, in turns with what is shipped, and takes the cheapest that misses
 * nothing in validation, or else the cheapest. */
pl_status choose_best(pl_tuner *t, pl_error *error);

/* Its sensitivities: each parameter moved either way. */
pl_status find_sensitivities(pl_tuner *t, pl_error *error);

/* The answer on what it was not tuned on: sets the checks anew. */
pl_status validate(pl_tuner *t, pl_error *error);

#endif
