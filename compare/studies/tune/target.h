/* What tuned settings must meet: METRIC<=VALUE or METRIC<VALUE. */
#ifndef PLUMB_TUNE_TARGET_H
#define PLUMB_TUNE_TARGET_H

#include "referee/metrics/metrics.h"

#include <jansson.h>

enum { PL_TUNE_MOST_TARGETS = 8 };

typedef struct pl_target {
    int metric;   /* pl_metric_id */
    double bound; /* > 0, in the metric's unit */
    bool strict;  /* < */
} pl_target;

typedef struct pl_targets {
    pl_target items[PL_TUNE_MOST_TARGETS];
    int count;
} pl_targets;

/* Adds what the text says. PL_BAD_INPUT: an unknown metric (with the nearest one), one of which
 * higher is better, another comparison, a bound that is not positive, or too many. */
pl_status pl_target_add(pl_targets *targets, const char *text, pl_error *error);

/* As it was written. */
void pl_target_text(const pl_target *target, char text[96]);

/* What a result is against the targets. */
typedef struct pl_target_reading {
    double values[PL_TUNE_MOST_TARGETS]; /* NAN: none */
    /* Largest ln(value / bound) over the targets: met where <= 0. More where the run's outcome is
     * not ok, and where a value is missing. */
    double excess;
} pl_target_reading;

pl_target_reading pl_target_read(const pl_targets *targets, const json_t *result);

#endif
