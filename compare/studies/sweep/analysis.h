/* Speed against error: the analysis of runs with many settings and time steps, as plain data.
 *
 * A scene is a scenario with its parameters except the time step. A point is an engine with its
 * options at a time step on a scene, over all repeats. Its cost is the CPU time of the engine's
 * steps per second of simulated time (s/s): time_per_step / dt. Its error is the scenario's primary
 * error, the largest over the scene and the changes of it that were run. Each engine is listed with
 * all its profiles together, each profile by itself, and as shipped. Ratios are above 1 where the first of a pair
 * is ahead. */
#ifndef PLUMB_SWEEP_ANALYSIS_H
#define PLUMB_SWEEP_ANALYSIS_H

#include "results/result_table.h"
#include "studies/study.h"

#include <stdint.h>

enum {
    PL_SWEEP_LEVELS = 8,
    PL_SWEEP_TIMES = 25,
    PL_SWEEP_MATCHED_LEVEL = 2, /* the level of 1e-3 */
    PL_BOOTSTRAP_REPLICATES = 1000
};

/* Errors that are asked for, in the unit of the primary error: 1e-1 ... 1e-8. */
extern const double pl_sweep_levels[PL_SWEEP_LEVELS];
/* Costs that are asked for, s/s: 1, 2, 5 of each decade, 1e-6 ... 100. */
extern const double pl_sweep_times[PL_SWEEP_TIMES];
/* Smaller errors count as this one, because they are rounding. */
extern const double pl_sweep_error_floor;

/* What of an engine is listed as a row of the analysis. */
typedef enum pl_sweep_kind {
    PL_SWEEP_WHOLE,   /* all that was run of it: its best settings count */
    PL_SWEEP_PROFILE, /* one profile, with any options */
    PL_SWEEP_SHIPPED  /* its first profile with default options: only the time step varies */
} pl_sweep_kind;
enum { PL_SWEEP_KINDS = 3 };

/* Whether a point has a cost and an error, and if not, why. */
typedef enum pl_sweep_state {
    PL_SWEEP_OK,
    PL_SWEEP_FAILED,     /* the outcome of a repeat or on a change of the scene is not ok */
    PL_SWEEP_UNMEASURED, /* all are ok, but the error or the time is missing */
    PL_SWEEP_UNSUPPORTED /* the engine does not support it with these settings: not a failure */
} pl_sweep_state;

/* Cost and error of one repeat. */
typedef struct pl_sweep_sample {
    double cost;  /* s/s, > 0 */
    double error; /* not below the floor */
} pl_sweep_sample;

/* All texts and rows are borrowed from the results. */
typedef struct pl_sweep_point {
    const pl_result_row
        *row; /* of the worst repeat or change where that is not ok, else the first */
    int scene;
    int engines[PL_SWEEP_KINDS]; /* indices, by kind; -1: it is not as shipped */
    int configuration; /* of the table: points of a scene that have it in common differ in dt */
    double dt;         /* s */
    const char *reason;
    /* Of the scene, on which the point has its error, or failed; "": the scene itself. */
    const char *change;
    pl_sweep_state state;
    int repeats; /* of the scene itself */
    int changes; /* runs on changes of it */
    /* The following fields are set only where the state is OK. */
    pl_sweep_sample *samples; /* (sample_count), by cost; owned */
    int sample_count;
    double cost, cost_mad; /* median, and median of |x - median|, s/s */
    double error;          /* median, or the largest of the changes; not below the floor */
    double raw_error;      /* the same without the floor */
    double instructions;   /* for a second of simulated time, median; NAN: not counted */
    uint64_t hash;         /* of the point's keys */
} pl_sweep_point;

/* An engine, or a part of its points, as a row of the analysis. */
typedef struct pl_sweep_engine {
    char name[128]; /* "ode", "ode:quick" */
    bool is_home;   /* all of its configurations are of the home engine */
    bool
        is_first; /* it is compared with others of its kind as the first of a pair: a home engine, or each where its kind has none */
    pl_sweep_kind kind;
    /* Of a profile with a run whose conformance is not known to have passed: its SPEC, borrowed from
     * the results. NULL: passed. */
    const char *unverified;
} pl_sweep_engine;

/* Places of ratios of two engines: cost at error, by level, and error at cost, by time, the second over the first. They
 * are of the cheapest points at or below the error, and of the most exact ones that cost no more; those between are
 * interpolated linearly in the logarithms between points, where the error, or cost, lies within both fronts. */
enum {
    PL_SPEED = 0,
    PL_SPEED_BETWEEN = PL_SPEED + PL_SWEEP_LEVELS,
    PL_EXACTNESS = PL_SPEED_BETWEEN + PL_SWEEP_LEVELS,
    PL_EXACTNESS_BETWEEN = PL_EXACTNESS + PL_SWEEP_TIMES,
    PL_READINGS = PL_EXACTNESS_BETWEEN + PL_SWEEP_TIMES
};

/* A front read at all levels and times, at the places of its ratios (PL_SPEED ...): costs and errors of its samples,
 * and interpolated ones. NAN: no value. */
typedef struct pl_front_reading {
    double at[PL_READINGS];
} pl_front_reading;

/* One engine on one scene. */
typedef struct pl_sweep_curve {
    int tried; /* settings: points that the engine supports, with any outcome. 0: it was not run on the scene */
    int ok, failed, unmeasured; /* of them */
    int *front; /* (front_count): points of which no other is both cheaper and as exact, by rising
                   cost and falling error; owned */
    int front_count;
    int cheapest[PL_SWEEP_LEVELS];  /* the cheapest point at or below the level; -1: not reached */
    int most_exact[PL_SWEEP_TIMES]; /* the most exact point that costs no more; -1: none does */
    pl_front_reading reading;
} pl_sweep_curve;

/* The engines that have a point at an error or at a cost. */
typedef enum pl_attained_by {
    PL_ATTAINED_BY_NEITHER,
    PL_ATTAINED_BY_FIRST_ONLY,
    PL_ATTAINED_BY_SECOND_ONLY,
    PL_ATTAINED_BY_BOTH /* the sum of the two before */
} pl_attained_by;

/* A ratio with its 95 % bootstrap interval. NAN: none. There is no interval where nothing was
 * repeated, or where over 5 % of the replicates have no ratio. */
typedef struct pl_sweep_ratio {
    double value, low, high;
} pl_sweep_ratio;

/* Two engines on one scene. */
typedef struct pl_pairwise_comparison {
    bool run; /* both were run and there is a primary error; else the other fields are undefined */
    pl_attained_by at_error[PL_SWEEP_LEVELS]; /* who has a point at or below the error */
    pl_attained_by at_cost[PL_SWEEP_TIMES];   /* who has a point that costs no more */
    pl_sweep_ratio ratios[PL_READINGS];
    double instructions
        [PL_SWEEP_LEVELS]; /* the second over the first, of the points of PL_SPEED; NAN: not counted */
} pl_pairwise_comparison;

/* A scene with its points, cost-error curves and pairwise comparisons. */
typedef struct pl_sweep_scene {
    const pl_result_scene *of; /* borrowed */
    const char *unit;          /* of its primary error */
    int first, count;          /* its points */
    double noise; /* standard deviation of ln(cost) over repeats; NAN: nothing was repeated */
    pl_sweep_curve *curves;              /* (engine_count) */
    pl_pairwise_comparison *comparisons; /* (pair_count) */
} pl_sweep_scene;

/* Two engines that are compared, of the same kind: the home engine with each other one, or where a kind has no home
 * engine, each with each. */
typedef struct pl_sweep_pair {
    int first, second;
    int shipped; /* of two whole engines: the pair of both as shipped; -1: none */
    /* Over all scenes on which both were run, by level. */
    pl_sweep_ratio mean[PL_SWEEP_LEVELS]; /* geometric mean of PL_SPEED, of scenes both reached */
    int reached[PL_ATTAINED_BY_BOTH + 1][PL_SWEEP_LEVELS]; /* scenes, by pl_attained_by */
    int scenes;
} pl_sweep_pair;

/* The analysis of the results of a sweep. `results` is borrowed, the arrays are owned. */
typedef struct pl_sweep_analysis {
    const pl_result_table *results;
    pl_sweep_point *points; /* by scene, configuration, falling dt */
    int point_count;
    pl_sweep_engine *engines; /* by kind; the home engine first, then by name */
    int engine_count;
    pl_sweep_scene *scenes; /* in the catalogue's order, then by name */
    int scene_count;
    pl_sweep_pair *pairs;
    int pair_count;
    /* The kind of engines that tables show pairs and losses of: whole ones, or profiles where the home engine is one
     * profile of several. */
    pl_sweep_kind shown;
    int unjudged;        /* scenes without a primary error: their points are unmeasured */
    bool several_builds; /* rows come from different builds or versions of one engine */
} pl_sweep_analysis;

/* Analyses a table with the runs on changed scenes, which must outlive *analysis. The caller frees *analysis. */
void pl_sweep_analyse(const pl_result_table *results, pl_sweep_analysis *analysis);

/* Frees all arrays of the analysis. */
void pl_sweep_analysis_free(pl_sweep_analysis *analysis);

/* Whether a point is one of the engine's. */
bool pl_sweep_point_is_of(const pl_sweep_point *point, int engine);

/* The analysis as one JSON object, plumb.sweep/2 (SCHEMA.md): a new reference. */
json_t *pl_sweep_to_json(const pl_sweep_analysis *analysis);

/* The same of a table: the conclusion of the study. A new reference. */
json_t *pl_sweep_conclude(const pl_result_table *results);

/* ---- Parts of the analysis, in the order in which pl_sweep_analyse calls them ---- */

/* Fills scenes, engines and points from the table, and the flags of hosts and builds. */
void pl_sweep_gather(pl_sweep_analysis *analysis);

/* ---- Pareto fronts of cost and error ---- */

/* `order` holds the indices of `count` of the samples. Sorts it by cost, then error, then index,
 * and moves the indices of the front to its beginning, by rising cost and falling error; of equal
 * samples the first is kept. Returns the size of the front. */
int pl_front_find(const pl_sweep_sample *samples, int *order, int count);

/* The index of a front's cheapest sample at or below an error; -1: none. */
int pl_front_cheapest(const pl_sweep_sample *front, int count, double error);

/* The index of a front's most exact sample that costs no more; -1: none. */
int pl_front_most_exact(const pl_sweep_sample *front, int count, double cost);

/* The cost at an error, interpolated between neighbours of a front linearly in the logarithms; NAN
 * outside of the front. */
double pl_front_cost_at_error(const pl_sweep_sample *front, int count, double error);

/* The error at a cost, interpolated in the same way; NAN outside of the front. */
double pl_front_error_at_cost(const pl_sweep_sample *front, int count, double cost);

/* The points of a scene with what fronts are found in: (count) each. */
typedef struct pl_front_choice {
    const pl_sweep_point *points;
    int count;
    pl_sweep_sample
        *samples;           /* of the points, owned; the caller sets those of points that are ok */
    int *order;             /* gets the front, indices of points; owned */
    pl_sweep_sample *front; /* gets its samples; owned */
} pl_front_choice;

/* The points of a scene without samples, for pl_front_end to free. */
pl_front_choice pl_front_begin(const pl_sweep_analysis *analysis, const pl_sweep_scene *scene);

/* Frees the arrays that are owned. */
void pl_front_end(pl_front_choice *choice);

/* Finds the front of an engine's points that are ok, and reads it at all levels and times. Returns its size. */
int pl_front_of(const pl_front_choice *choice, int engine, pl_front_reading *reading);

/* ---- Pairs of engines ---- */

/* Fills the pairs with their means, and the comparisons of each scene, from the curves. */
void pl_compare_pairwise(pl_sweep_analysis *analysis);

/* The middle 95 % of `values`, which are sorted, without those that are NAN; NAN where over 5 %
 * are. Percentile interval, Efron 1981. */
void pl_bootstrap_interval(double *values, int count, double *low, double *high);

/* ---- Observed orders of convergence ---- */

/* How fast the error falls with the time step: the slope of log error over log dt, by least squares
 * over the converging part. */
typedef struct pl_sweep_order {
    /* "found"; "too few time steps": fewer than 3 have an error above the floor; "exact": all errors are at the floor;
     * "not converging": there are no 3 time steps in a row over which it converges. */
    const char *finding;
    double order, deviation; /* the latter: root mean square of the fit, decades of error */
    double dt_low, dt_high;  /* s: the range used */
    int used, total;         /* time steps: in the fit, and run */
} pl_sweep_order;

/* The order of errors (NAN: none; not below the floor) at time steps dt (s, falling).
 *
 * The converging part is the longest segment of neighbouring time steps in which the error is above
 * the floor and falls at least as fast as dt^(1/4); of equally long ones, the one of smaller steps.
 * Ends that fall less than half as fast as the segment's median pair of neighbours are cut off:
 * there the steps are still too large, or something other than the step limits the error. */
pl_sweep_order pl_order_fit(const double *dt, const double *error, int count);

/* The orders of all series of two time steps or more with an error, as in plumb.sweep/2. */
json_t *pl_orders_find(const pl_sweep_analysis *analysis);

/* The performance profiles, as in plumb.sweep/2: those of whole engines by level, then those of profiles. */
json_t *pl_profiles_find(const pl_sweep_analysis *analysis);

/* The study, whose runs are results of no study: pl_sweep_conclude concludes from them. */
extern const pl_study pl_sweep_study;

#endif
