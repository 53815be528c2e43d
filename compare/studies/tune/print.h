/* What came of tuning, for people, as JSON, and as a profile. */
#ifndef PLUMB_TUNE_PRINT_H
#define PLUMB_TUNE_PRINT_H

#include "tune.h"

#include <stdio.h>

/* The settings as a SPEC and in the engine's own API, what they cost, and how they were judged. */
void pl_tune_print(FILE *out, const pl_tune_def *def, const pl_tuning *tuning);

/* plumb.tuning/1 (SCHEMA.md), with the search's trials; NULL when out of memory. */
json_t *pl_tune_json(const pl_tune_def *def, const pl_tuning *tuning);

/* plumb.profile/1, as pl_engine_choose reads it; NULL when out of memory. */
json_t *pl_tune_profile(const pl_tune_def *def, const pl_tuning *tuning);

#endif
