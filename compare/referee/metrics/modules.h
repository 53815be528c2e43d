/* The modules of the referee. Each measures something of a run: it keeps a state of its own, sees every
 * frame, and sets its metrics at the end. The view of the run has the data that several of them need. */
#ifndef PLUMB_MODULES_H
#define PLUMB_MODULES_H

#include "expectations.h"
#include "mechanics.h"

#include <math.h>
#include <stdint.h>

/* ---- Series (series.c) ---- */

/* Streaming statistics of a number that is seen once a step or more often: mean, largest value, the
 * step of the largest value, and percentiles.
 *
 * Percentiles are by nearest rank, from a histogram with 128 bins an octave over 2^-80 .. 2^48, one
 * bin below and one above. A percentile is the mean of the numbers in its bin. Its error is below
 * 1/128 = 0.8 %, and zero where all numbers in the bin are equal, as small whole numbers are. */

/* A bin of the histogram: how many numbers fell into it, and their sum. */
typedef struct pl_bin {
    uint64_t count;
    double sum;
} pl_bin;

/* A histogram of the values of one metric over the steps, with their sums and maximum. */
typedef struct pl_series {
    pl_bin *bins; /* (PL_SERIES_BINS), of the arena */
    uint64_t count;
    double sum, square_sum, max;
    long worst_step; /* the first step at which max was seen; 0 before any */
    bool applies;    /* its metric has a value, 0, even if none was seen */
} pl_series;

enum { PL_SERIES_BINS = 128 * 128 + 2 }; /* 128 octaves, and the two outer bins */

/* Makes an empty series, with its bins from the arena. */
void pl_series_init(pl_series *series, pl_arena *arena);

/* Adds `value` >= 0, which may be infinite, seen at `step`. A NaN means "not reported" and is not
 * added. */
void pl_series_add(pl_series *series, double value, long step);

/* `value`, or infinity for a NaN that the referee itself computed: a series would take it for "not
 * reported". */
static inline double pl_or_infinity(double value)
{
    return isnan(value) ? HUGE_VAL : value;
}

/* The smallest number that at least the fraction `q` of all numbers do not exceed; 0 of an empty
 * series. */
double pl_series_percentile(const pl_series *series, double q);

/* The metric of a series with these traits: the maximum, mean or root of the mean square, 0 of an empty
 * series, with percentiles and worst step. PL_METRIC_FAILED when it is not finite. */
pl_metric pl_series_metric(const pl_series *series, unsigned traits);

/* ---- Bodies that touch (touching.c) ---- */

/* Metrics of the pairs of bodies that touch: how deep they penetrate each other, and the islands
 * that they form.
 *
 * An island of a step consists of bodies that touch, directly or through others, in the frame
 * before or in the frame after the step. Energy that passes from body to body in a step stays
 * within one island. Static bodies join nothing, because no energy passes through them. */

/* What a body touched in the frames before and after the last step. */
typedef struct pl_touched {
    bool met, met_before;       /* another body (pl_near_pair); neither: it flew through the step */
    double depth, depth_before; /* sum of its overlaps, m */
} pl_touched;

/* The state of these metrics over a run. */
typedef struct pl_touching {
    const pl_scene *scene;
    pl_series *depths;  /* of each touching pair (gap <= 0) after each step, m */
    pl_touched *bodies; /* (body_count) */
    double deepest;     /* overlap of the last frame, m */
    bool met_static;    /* a dynamic body met a static one, whose impulses are then possible */

    long step;       /* of the current frame */
    long rest_from;  /* first step of the last second */
    double rest_sum; /* of the deepest of each frame */
    long rest_count;
    int unknown_a, unknown_b; /* the first pair whose gap could not be computed */
    long unknown_step;        /* -1: none */
    int *now, *both; /* (body_count): parents; a root is its own parent and the least of its set */
    double *sum;     /* (body_count): by root */
} pl_touching;

/* `scene` and `depths` must outlive it. Memory of the arena. */
pl_touching *pl_touching_create(const pl_scene *scene, pl_series *depths, pl_arena *arena);

/* Begins the frame after step number `step`. Step 0 (the start) has no penetration. */
void pl_touching_begin(pl_touching *touching, long step);

/* Takes one pair of the frame. `touching` is a pl_touching. */
void pl_touching_see(void *touching, const pl_near_pair *pair);

/* Ends the frame, after all of its pairs. */
void pl_touching_end(pl_touching *touching);

/* The largest sum of `growth`, (body_count), over an island of the last step; the entries of static
 * bodies are not read. 0 in a scene without dynamic bodies. A NaN counts as infinite. */
double pl_touching_island_max(pl_touching *touching, const double *growth);

/* The island of the last step that a dynamic body is in, by the least index of its bodies. */
int pl_touching_island(pl_touching *touching, int body);

/* ---- Modules ---- */

/* The data of a run that modules use. Pointers are borrowed until the call returns. */
typedef struct pl_run_view {
    const pl_scene *scene;
    pl_scale scale;
    /* Of each metric over steps (PL_TRAIT_OVER_STEPS); one for each rule of one by the integrator. */
    pl_series *series[PL_METRIC_COUNT];
    pl_touching *touching;       /* has seen the frame */
    pl_mechanics *mechanics;     /* has seen the step */
    pl_values *values;           /* have seen the frame */
    pl_step step;                /* the last one; number 0 and before NULL: the start */
    const char *residual_unit;   /* at the end; NULL: the engine never reports a residual */
    pl_position_rule integrator; /* at the end */
    const pl_body_state *last;   /* at the end, (scene->body_count): the last valid frame */
} pl_run_view;

/* Makes view->series, in memory of the arena. */
void pl_make_series(pl_run_view *view, pl_arena *arena);

/* Adds the value of a metric over steps in the last step, >= 0; a NaN is not added. */
void pl_see_value(const pl_run_view *view, pl_metric_id id, double value);

/* The same of a metric by the integrator (PL_TRAIT_BY_INTEGRATOR), for one of these. */
void pl_see_value_by(const pl_run_view *view, pl_metric_id id, pl_position_rule rule, double value);

/* Sets the metrics over steps in item (PL_METRIC_COUNT) for which a value was seen, or whose series
 * applies without one. Those of impulses stay absent unless the engine reported all. */
void pl_series_metrics(const pl_run_view *view, bool has_impulses, pl_metric *item);

/* A module. `state` is what its create returned. The referee makes the metrics over steps of the values
 * that modules have added. */
typedef struct pl_module {
    /* Makes the state, in memory of the arena. The scene outlives the state. A module without a state
     * can have NULL here. */
    void *(*create)(const pl_run_view *view, pl_arena *arena);
    /* Takes the frame after each step. A module that reads the end alone has NULL here. */
    void (*see)(void *state, const pl_run_view *view);
    /* Sets the module's other metrics in item (PL_METRIC_COUNT), which has those over steps. A metric
     * that does not apply stays PL_METRIC_ABSENT. NULL: there are none. */
    void (*collect)(void *state, const pl_run_view *view, pl_metric *item);
    bool needs_no_motion; /* it is also used in a scene without dynamic bodies */
    bool needs_no_pairs;  /* it sees a step while the pairs that touch are found */
    bool sees_start;      /* it also sees the start */
} pl_module;

/* pl_NAME_module is in NAME.c. */
extern const pl_module pl_step_stats_module, pl_mechanics_module, pl_contact_force_module,
    pl_touching_module, pl_motion_module, pl_unexplained_motion_module;

/* ---- The velocities that contacts leave (contact_motion.c) ---- */

/* Memory for one step of all bodies. */
typedef struct pl_contact_motion pl_contact_motion;

/* `scene` and `arena` must outlive it. Memory of the arena. */
pl_contact_motion *pl_contact_motion_create(const pl_scene *scene, pl_arena *arena);

/* Takes a step whose contacts have times, and follows its bodies. */
void pl_contact_motion_step(pl_contact_motion *motion, const pl_step *step);

/* Velocities of B's point relative to A's, m/s, world. */
typedef struct pl_contact_velocity {
    pl_vec left; /* at the end of the interval, where the contact law holds */
    pl_vec mean; /* of its begin and its end, where the impulse acted */
} pl_contact_velocity;

/* Those of contact i of the step. */
pl_contact_velocity pl_contact_motion_velocity(const pl_contact_motion *motion, const pl_step *step,
                                               int i);

#endif
