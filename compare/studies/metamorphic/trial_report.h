/* What checks found, as a table for people and as JSON. */
#ifndef PLUMB_TRIAL_REPORT_H
#define PLUMB_TRIAL_REPORT_H

#include "trial.h"

/* Prints the trial's scene and engine, then a line a check. */
void pl_checks_print(FILE *out, const pl_checks_of_run *trial);

/* "plumb.metamorphic/1": the plain run's identity and outcome as in a result, `size` (m) and
 * `checks`, an array of objects with check, verdict, reason, passes_at (s or null), early and end,
 * each with position (over the size), rotation (rad) and verdict. Numbers are null where there is
 * no run to take them from. A new reference; NULL when out of memory. */
json_t *pl_checks_to_json(const pl_checks_of_run *trial);

#endif
