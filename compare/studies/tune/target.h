/* The targets of a tuning, METRIC<=VALUE or METRIC<VALUE, and results held against them. */
#ifndef PLUMB_TUNE_TARGET_H
#define PLUMB_TUNE_TARGET_H

#include "plumb/base.h"

#include <jansson.h>

enum { PL_TUNE_MOST_TARGETS = 8 };

/* An upper bound on a metric. */
typedef struct pl_target {
    int metric;   /* pl_metric_id */
    double bound; /* > 0, in the metric's unit */
    bool strict;  /* < */
} pl_target;

/* The bounds that all runs of a setting must keep. */
typedef struct pl_targets {
    pl_target items[PL_TUNE_MOST_TARGETS];
    int count;
} pl_targets;

/* Parses a target and adds it. PL_BAD_INPUT: an unknown metric (the message suggests the nearest),
 * a metric that is better when higher, another comparison, a bound that is not positive, or too
 * many targets. */
pl_status pl_target_add(pl_targets *targets, const char *text, pl_error *error);

/* The target as pl_target_add reads it. */
void pl_target_text(const pl_target *target, char text[96]);

/* The largest ln(value / bound) of a plumb.result/1 over the targets, which are met where it is <= 0: at most
 * PL_SEARCH_WORST, which it is where a value or the result (NULL) is missing. It is larger where the run's outcome is
 * not ok. */
double pl_targets_excess(const pl_targets *targets, const json_t *result);

/* The values of the targets' metrics of a result, by their names: null where one is missing. A new reference. */
json_t *pl_targets_values(const pl_targets *targets, const json_t *result);

#endif
