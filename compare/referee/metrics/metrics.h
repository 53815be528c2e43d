/* The metrics: names, units and directions (stable: gates and other people's scripts use them), and
 * the values of one run. The table itself, with each definition in a line, is in metrics.c. */
#ifndef PLUMB_METRICS_H
#define PLUMB_METRICS_H

#include "plumb/base.h"

#include <stdbool.h>

typedef enum pl_metric_id {
    PL_METRIC_REFERENCE_ERROR, /* the scene's primary error, copied */
    PL_METRIC_REST_POSITION_ERROR,
    PL_METRIC_REST_ROTATION_ERROR,
    PL_METRIC_TRAVEL_ERROR, /* 1: |travelled - distance| / |distance|, largest over expect.travel */
    PL_METRIC_VALUE_ERROR,  /* 1: |found - expected| / scale, largest over expect.values */
    PL_METRIC_DISCRETE_ERROR, /* 1: the same against the exact answer of its integrator */
    PL_METRIC_PATH_DEVIATION,
    PL_METRIC_LIFT,
    PL_METRIC_PENETRATION_MAX,
    PL_METRIC_PENETRATION_REST,
    PL_METRIC_DRIFT,
    PL_METRIC_CREEP,
    PL_METRIC_ENERGY_GAIN,
    PL_METRIC_ENERGY_STEP_GAIN,
    PL_METRIC_MOMENTUM_ERROR,
    PL_METRIC_FORCE_BALANCE,      /* 1: these five from the contacts that the engine reports */
    PL_METRIC_CONE_VIOLATION,     /* 1 */
    PL_METRIC_FRICTION_EFFECTIVE, /* 1 */
    PL_METRIC_SIGNORINI,          /* W */
    PL_METRIC_NATURAL_MAP,        /* m/s */
    PL_METRIC_SETTLE_TIME,
    PL_METRIC_SPREAD_X, /* these five: of scenes in which two bodies or more can move */
    PL_METRIC_SPREAD_Y,
    PL_METRIC_MASS_HEIGHT,
    PL_METRIC_RUN_OUT_P95,
    PL_METRIC_ENERGY_LOST,
    PL_METRIC_ITERATIONS_MEAN,
    PL_METRIC_ITERATIONS_MAX,
    PL_METRIC_ITERATIONS_TO_TOLERANCE, /* of several runs: plumb compare puts it in */
    PL_METRIC_RESIDUAL_MAX,            /* as the engine reports it, in the engine's own unit */
    PL_METRIC_RESIDUAL_RMS,            /* the same unit */
    PL_METRIC_CONTACTS_MEAN,
    PL_METRIC_TIME_PER_STEP,
    PL_METRIC_INSTRUCTIONS_PER_STEP, /* 1: put in by who makes the run, as memory_peak is */
    PL_METRIC_MEMORY_PEAK,
    PL_METRIC_INTEGRATOR,
    PL_METRIC_STATE_HASH,
    PL_METRIC_COUNT
} pl_metric_id;

typedef enum pl_direction { PL_LOWER_IS_BETTER, PL_HIGHER_IS_BETTER, PL_NO_DIRECTION } pl_direction;

typedef struct pl_metric_info {
    const char *name, *unit;
    pl_direction direction;
    bool deterministic; /* the same at every run on every machine, for a deterministic engine */
    const char *definition;
} pl_metric_info;

/* (PL_METRIC_COUNT), indexed by pl_metric_id. */
extern const pl_metric_info pl_metric_table[PL_METRIC_COUNT];

/* -1 when there is none. */
int pl_metric_by_name(const char *name);

typedef enum pl_metric_state {
    PL_METRIC_ABSENT, /* does not apply to this scene or engine: not in the results at all */
    PL_METRIC_VALUE,
    PL_METRIC_TEXT,  /* integrator, state_hash */
    PL_METRIC_FAILED /* applies, but has no value: null with `reason` */
} pl_metric_state;

typedef struct pl_metric {
    pl_metric_state state;
    double value;
    char text[48];
    char reason[128];
    const char *unit; /* NULL: the table's */
    /* Of metrics taken over steps: percentiles and the step (from 1) of the worst. */
    bool has_percentiles;
    double p50, p95, p99;
    long worst_step;
} pl_metric;

typedef struct pl_metrics {
    pl_metric item[PL_METRIC_COUNT];
} pl_metrics;

#endif
