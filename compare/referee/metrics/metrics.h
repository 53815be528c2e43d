/* The metrics of a run and how it ended. Names, units and directions of metrics are stable, because
 * gates and scripts depend on them. The definitions are in the table in metrics.c. */
#ifndef PLUMB_METRICS_H
#define PLUMB_METRICS_H

#include "plumb/base.h"

#include <stdbool.h>

/* The metrics, in the order of the table in metrics.c. */
typedef enum pl_metric_id {
    PL_METRIC_REFERENCE_ERROR,
    PL_METRIC_REST_POSITION_ERROR,
    PL_METRIC_REST_ROTATION_ERROR,
    PL_METRIC_TRAVEL_ERROR,
    PL_METRIC_VALUE_ERROR,
    PL_METRIC_DISCRETE_ERROR,
    PL_METRIC_STATISTICS_ERROR,
    PL_METRIC_CHAOTIC_ERROR,
    PL_METRIC_EXPECTATION_ERROR,
    PL_METRIC_PATH_DEVIATION,
    PL_METRIC_LIFT,
    PL_METRIC_PENETRATION_MAX,
    PL_METRIC_PENETRATION_REST,
    PL_METRIC_DRIFT,
    PL_METRIC_CREEP,
    PL_METRIC_UNEXPLAINED_MOTION,
    PL_METRIC_FREE_FLIGHT_ERROR,
    PL_METRIC_ENERGY_GAIN,
    PL_METRIC_ENERGY_STEP_GAIN,
    PL_METRIC_MOMENTUM_ERROR,
    PL_METRIC_FORCE_BALANCE, /* these five: from the contacts that the engine reports */
    PL_METRIC_CONE_VIOLATION,
    PL_METRIC_FRICTION_EFFECTIVE,
    PL_METRIC_SIGNORINI,
    PL_METRIC_NATURAL_MAP,
    PL_METRIC_SETTLE_TIME,
    PL_METRIC_SPREAD_X, /* these two: only with two dynamic bodies or more */
    PL_METRIC_SPREAD_Y,
    PL_METRIC_MASS_HEIGHT,
    PL_METRIC_RUN_OUT_P95,
    PL_METRIC_ENERGY_LOST,
    PL_METRIC_ITERATIONS_MEAN,
    PL_METRIC_ITERATIONS_MAX,
    PL_METRIC_ITERATIONS_TO_TOLERANCE, /* of several runs: set by plumb compare */
    PL_METRIC_RESIDUAL_MAX,
    PL_METRIC_RESIDUAL_RMS,
    PL_METRIC_CONTACTS_MEAN,
    PL_METRIC_TIME_PER_STEP,
    PL_METRIC_WALL_TIME_PER_STEP, /* these seven: set by the runner */
    PL_METRIC_TIME_CREATE,
    PL_METRIC_WALL_TIME_CREATE,
    PL_METRIC_TIME_READ,
    PL_METRIC_WALL_TIME_READ,
    PL_METRIC_INSTRUCTIONS_PER_STEP,
    PL_METRIC_MEMORY_PEAK,
    PL_METRIC_INTEGRATOR,
    PL_METRIC_STATE_HASH,
    PL_METRIC_COUNT
} pl_metric_id;

/* Which of two values of a metric is the better one. */
typedef enum pl_direction { PL_LOWER_IS_BETTER, PL_HIGHER_IS_BETTER, PL_NO_DIRECTION } pl_direction;

/* What is fixed about a metric. The strings are static. */
typedef struct pl_metric_info {
    const char *name, *unit;
    pl_direction direction;
    bool deterministic; /* equal in every run on every machine, if the engine is deterministic */
    const char *definition;
} pl_metric_info;

/* Indexed by pl_metric_id. */
extern const pl_metric_info pl_metric_table[PL_METRIC_COUNT];

/* The pl_metric_id of a metric; -1 when no metric has this name. */
int pl_metric_by_name(const char *name);

/* What a metric of a run holds. */
typedef enum pl_metric_state {
    PL_METRIC_ABSENT, /* does not apply to this scene or engine; left out of the results */
    PL_METRIC_VALUE,
    PL_METRIC_TEXT,  /* integrator, state_hash */
    PL_METRIC_FAILED /* applies, but has no value; null in the results, with `reason` */
} pl_metric_state;

/* A metric of one run, in its unit. */
typedef struct pl_metric {
    pl_metric_state state;
    double value;
    char text[48];
    char reason[128];
    const char *unit; /* NULL: the table's */
    const char *part; /* of a maximum over unlike parts: the name of the largest; NULL: none */
    int answer; /* of a scene with several right answers, the number of the nearest; 0: of others */
    bool has_percentiles;
    double p50, p95, p99; /* over steps */
    long worst_step;      /* step number, from 1, of the largest value */
} pl_metric;

/* A metric with a value. */
pl_metric pl_metric_value(double value);

/* A failed metric; the reason is formatted as by printf and cut to size. */
#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
pl_metric
pl_metric_failed(const char *format, ...);

/* The most expectations that are named. */
enum { PL_MOST_DEVIATIONS = 3 };

/* The expectations of the scene that a run is off by more than their tolerance, worst first. */
typedef struct pl_deviations {
    int off; /* how many there are */
    char text[PL_MOST_DEVIATIONS]
             [192]; /* such as: turn of "box": 0.1 rad, expected within 0.01 rad */
    double ratio[PL_MOST_DEVIATIONS]; /* distance over tolerance, above 1, descending */
} pl_deviations;

/* All metrics of one run. */
typedef struct pl_metrics {
    pl_metric item[PL_METRIC_COUNT]; /* indexed by pl_metric_id */
    pl_deviations deviations;
} pl_metrics;

/* A sentence for people about a run that ended well; empty: nothing to say. */
typedef struct pl_note {
    char text[256];
} pl_note;

/* How a run ended, as far as its frames show. */
typedef enum pl_ending {
    PL_ENDING_OK,
    PL_ENDING_COLLAPSED, /* what should stand does not: see standing.h */
    PL_ENDING_DIVERGED,  /* energy or speed beyond the scene's bound; the run should end */
    PL_ENDING_NONFINITE  /* a pose or velocity is NaN or infinite; the run should end */
} pl_ending;

#endif
