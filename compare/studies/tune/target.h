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

/* A result held against the targets. */
typedef struct pl_target_reading {
    double values[PL_TUNE_MOST_TARGETS]; /* NAN: missing */
    /* The largest ln(value / bound) over the targets, which are met where it is <= 0. It is larger
     * where the run's outcome is not ok or a value is missing. */
    double excess;
} pl_target_reading;

/* Reads the values of the targets' metrics from a plumb.result/1. */
pl_target_reading pl_target_read(const pl_targets *targets, const json_t *result);

/* The values of the targets' metrics, by their names: null where one is missing. A new reference. */
json_t *pl_target_values(const pl_targets *targets, const pl_target_reading *reading);

#endif
