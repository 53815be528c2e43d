/* The points of a search that were tried, each once, and the budget; for the stages of pl_search.
 */
#ifndef PLUMB_TUNE_LEDGER_H
#define PLUMB_TUNE_LEDGER_H

#include "search_driver.h"

typedef struct pl_evaluation_cache {
    const pl_search_def *def;
    pl_search_result *found;
    int limit;        /* points up to which the stage may go */
    pl_status status; /* of the first call that failed */
    pl_error *error;
} pl_evaluation_cache;

typedef struct pl_unit_point {
    double u[PL_TUNE_MAX_PARAMETERS]; /* 0 .. 1 */
} pl_unit_point;

/* No further point may be tried: the limit is reached, or the search stopped or failed. */
bool is_over(const pl_evaluation_cache *cache);

/* Where a trial's values are. */
pl_unit_point units_of(const pl_evaluation_cache *cache, const pl_evaluation *evaluation);

/* Tries a point unless it was tried; its place in found->evaluations, or -1 where it could not be.
 */
int evaluate(pl_evaluation_cache *cache, const pl_unit_point *point);

/* The stages. */
void sample_space(pl_evaluation_cache *cache);
void run_nlopt(pl_evaluation_cache *cache);
void refine_locally(pl_evaluation_cache *cache);

#endif
