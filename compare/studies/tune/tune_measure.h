/* Runs settings of one engine on all scenarios and reads their errors, which are held against
 * targets, and their costs. */
#ifndef PLUMB_TUNE_MEASURE_H
#define PLUMB_TUNE_MEASURE_H

#include "referee/metrics/metrics.h"
#include "runner/execute.h"
#include "studies/design.h"
#include "studies/variant.h"

#include <jansson.h>

/* ---- Targets: METRIC<=VALUE or METRIC<VALUE ---- */

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

/* The target as it was written. */
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

/* ---- Runs ---- */

/* The measurements of one setting on one scenario. */
typedef struct pl_reading {
    bool is_there;  /* false: the scenario cannot be built so, or the variant changes nothing */
    bool is_absent; /* the engine does not support the scenario */
    pl_target_reading target;
    char outcome[32];
    /* Per simulated second, one number per repeat; NAN: missing. Borrowed from the readings. */
    double *seconds, *instructions;
} pl_reading;

/* The readings of several settings, each on all cases, setting by setting. */
typedef struct pl_readings {
    int setting_count, case_count, repeats;
    pl_reading *items; /* (setting_count x case_count) */
    double *numbers;   /* the block that holds the items' arrays */
} pl_readings;

/* The readings of `setting`, one per case. */
const pl_reading *pl_readings_of(const pl_readings *readings, int setting);

/* Frees the readings and their numbers. */
void pl_readings_free(pl_readings *readings);

/* The settings to be measured and the cases to measure them on. The pointers are borrowed. */
typedef struct pl_measure_def {
    const pl_plan *plan; /* the cases as asked for, and the seed */
    const pl_variant *variant;
    const pl_setting *settings; /* (setting_count) */
    int setting_count;
    int repeats;      /* >= 1; the settings take turns within each repeat */
    int first_repeat; /* earlier repeats were made before and are skipped */
    const pl_targets *targets;
    int jobs;
    pl_limits limits;
    json_t *provenance;
    pl_store *store;  /* NULL: none */
    pl_progress *bar; /* counts the runs; NULL: none */
} pl_measure_def;

/* Makes the runs. The caller frees *readings in any case. A signal ends them as in pl_execute.
 * PL_NO_MEMORY, PL_IO; PL_BAD_INPUT only where an unchanged scene at its own step is refused. */
pl_status pl_measure(const pl_measure_def *def, pl_readings *readings, long *runs,
                     int *signal_number, pl_error *error);

#endif
