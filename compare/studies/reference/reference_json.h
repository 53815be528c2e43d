/* A judged case as an item of `cases` of plumb.reference/1. */
#ifndef PLUMB_REFERENCE_JSON_H
#define PLUMB_REFERENCE_JSON_H

#include "after_horizon.h"

/* The runs that the item of a case depends on, by their hashes, as an array: those of the compared
 * configurations, and that of the reference's engine at the asked step. A new reference. */
json_t *pl_reference_runs_json(const pl_plan *plan, const pl_case *test_case);

/* The item of a case. `verdict` and `after` are NULL where there is no reference. `sentences` is
 * borrowed. A new reference. */
json_t *pl_reference_case_json(const pl_plan *plan, const pl_case *test_case,
                               const pl_reference *reference, const pl_reference_verdict *verdict,
                               const pl_after_horizon *after, json_t *sentences);

#endif
