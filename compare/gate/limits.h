/* How far a metric may be from its baseline. */
#ifndef PLUMB_GATE_LIMITS_H
#define PLUMB_GATE_LIMITS_H

#include "referee/metrics/metrics.h"

typedef struct pl_gate_limit {
    bool given; /* by the caller */
    bool off;   /* not compared */
    double relative, absolute;
} pl_gate_limit;

typedef struct pl_gate_limits {
    pl_gate_limit of[PL_METRIC_COUNT];
    double time, instructions; /* growth of a ratio to the reference engine: 0.1 is 10 % */
} pl_gate_limits;

pl_gate_limits pl_gate_limits_default(void);

/* "METRIC=RELATIVE[,ABSOLUTE]" or "METRIC=off". PL_BAD_INPUT names the metric (with the nearest) or
 * the number that is wrong. */
pl_status pl_gate_limits_parse(const char *text, pl_gate_limits *limits, pl_error *error);

/* Names that a rule knows beside those of pl_metric_table. */
enum { PL_GATE_OWN_COUNT = 4 };
extern const char *const pl_gate_own_names[PL_GATE_OWN_COUNT];

/* Of both. The nearest is NULL where none is near. */
bool pl_gate_name_is_known(const char *name);
const char *pl_gate_nearest_name(const char *name);

/* The difference from `value` that is allowed, in the metric's unit. `dt`: the run's step, s. */
double pl_gate_limit_at(const pl_gate_limit *limit, int metric, double value, double dt);

/* Whether a baseline keeps the metric: what differs from run to run only where a limit is given.
 * `metric` is -1 for one that this build does not know. */
bool pl_gate_limits_keep(const pl_gate_limits *limits, int metric, bool deterministic);

#endif
