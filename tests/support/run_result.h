/* One `plumb run`, and what its result says. */
#ifndef PLUMB_TEST_RUN_RESULT_H
#define PLUMB_TEST_RUN_RESULT_H

#include <jansson.h>

/* Runs plumb with `arguments` (NULL-terminated), which make it print one result as JSON. The test
 * fails unless it exits with 0 where the outcome is ok, and with 3 where it is not. The caller
 * decrefs. */
json_t *run_to_json(const char *const *arguments);

/* The value of a metric, or one of its percentiles ("p95"); NAN where it has none. */
double metric(const json_t *result, const char *name);
double metric_percentile(const json_t *result, const char *name, const char *percentile);

#endif
