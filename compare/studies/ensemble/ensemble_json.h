/* The whole outcome of an ensemble as one JSON object, plumb.ensemble/1 (SCHEMA.md beside this). */
#ifndef PLUMB_ENSEMBLE_JSON_H
#define PLUMB_ENSEMBLE_JSON_H

#include "verdict.h"

/* A new reference; NULL when out of memory. */
json_t *pl_ensemble_to_json(const pl_plan *plan, const pl_ensembles *ensembles,
                            const pl_ensemble_view *views, const pl_verdicts *verdicts);

/* The horizon that such an object holds of the ensemble with exactly these members' runs; false
 * where it has none. `before` may be NULL. */
bool pl_horizon_recall(const json_t *before, const pl_plan *plan, const pl_ensemble *ensemble,
                       int members, pl_horizon *horizon);

#endif
