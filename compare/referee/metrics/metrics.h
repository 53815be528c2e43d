/* The metrics of a run and how it ended. Names, units and directions of metrics are stable, because
 * gates and scripts depend on them. All that is known of a metric is in its row of metrics.def. */
#ifndef PLUMB_METRICS_H
#define PLUMB_METRICS_H

#include "plumb/base.h"

#include <stdbool.h>

/* The metrics, as metrics.def lists them: PL_METRIC_DRIFT is of the row METRIC(DRIFT, ...). */
typedef enum pl_metric_id {
#define METRIC(id, ...) PL_METRIC_##id,
#include "metrics.def"
    PL_METRIC_COUNT
} pl_metric_id;

/* Which of two values of a metric is the better one. */
typedef enum pl_direction { PL_LOWER_IS_BETTER, PL_HIGHER_IS_BETTER, PL_NO_DIRECTION } pl_direction;

/* Further properties of a metric, as bits. */
typedef enum pl_trait {
    PL_TRAIT_MEASURED = 1 << 0, /* differs from run to run, even if the engine is deterministic */
    PL_TRAIT_COMPARED = 1 << 1, /* means the same to every engine: reports compare the home engine
                                   with the best other one */
    PL_TRAIT_OVER_STEPS =
        1 << 2,              /* has percentiles and a worst step; needs a step; the largest value
                                     of the steps, except: */
    PL_TRAIT_MEAN = 1 << 11, /* the mean */
    PL_TRAIT_RMS = 1 << 12,  /* the root of the mean square */
    PL_TRAIT_BY_INTEGRATOR =
        1 << 13,                     /* measured for each integrator, until the engine's is known */
    PL_TRAIT_VALUE_OF_END = 1 << 3,  /* a value is void after an early end of the run */
    PL_TRAIT_REASON_OF_END = 1 << 4, /* the reason why there is none is void then */
    PL_TRAIT_OF_END = PL_TRAIT_VALUE_OF_END | PL_TRAIT_REASON_OF_END,
    PL_TRAIT_IMPULSES = 1 << 5,        /* void without the impulses of all contacts */
    PL_TRAIT_STATIC_IMPULSES = 1 << 6, /* void without those of contacts with static bodies */
    PL_TRAIT_OWN_UNIT = 1 << 7,        /* each run names the unit */
    PL_TRAIT_TEXT = 1 << 8,            /* the value is a text */
    PL_TRAIT_TO_ONE_STEP = 1 << 9,     /* a time that is known to one step of the scene */
    PL_TRAIT_GATED = 1 << 10, /* the gate compares the ratio without a rule that names it */
} pl_trait;

/* What is fixed about a metric. The strings are static. */
typedef struct pl_metric_info {
    const char *name, *unit;
    pl_direction direction;
    unsigned traits; /* of pl_trait */
    const char *definition;
    double noise;      /* between engines a difference up to this says nothing, in the unit */
    const char *ratio; /* of a cost: the name of its ratio to that of a reference engine, which the
                            gate compares in its place; NULL: no cost */
    const char *more[2]; /* of what ensembles are compared by: the words before and after an amount,
                            for the engine with more of it; NULL: they are not */
} pl_metric_info;

/* Indexed by pl_metric_id. */
extern const pl_metric_info pl_metric_table[PL_METRIC_COUNT];

/* Whether the metric has one of the traits; false for -1. */
bool pl_metric_is(int id, unsigned traits);

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
    PL_ENDING_COLLAPSED, /* what should stand does not: see pl_standing_judge */
    PL_ENDING_DIVERGED,  /* energy or speed beyond the scene's bound; the run should end */
    PL_ENDING_NONFINITE  /* a pose or velocity is NaN or infinite; the run should end */
} pl_ending;

#endif
