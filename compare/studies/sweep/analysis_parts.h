/* The parts of the analysis of a sweep, in the order in which pl_sweep_analyse calls them. */
#ifndef PLUMB_SWEEP_ANALYSIS_PARTS_H
#define PLUMB_SWEEP_ANALYSIS_PARTS_H

#include "analysis.h"

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

/* Lists the losses from the comparisons. */
void pl_list_losses(pl_sweep_analysis *analysis);

/* ---- Observed orders of convergence ---- */

/* Whether an order of convergence was found, and if not, why. */
typedef enum pl_sweep_order_kind {
    PL_SWEEP_ORDER_FOUND,
    PL_SWEEP_ORDER_TOO_FEW,        /* fewer than 3 time steps have an error above the floor */
    PL_SWEEP_ORDER_EXACT,          /* all errors are at the floor */
    PL_SWEEP_ORDER_NOT_CONVERGING, /* no 3 time steps in a row over which it converges */
} pl_sweep_order_kind;

/* How fast the error falls with the time step: the slope of log error over log dt, by least squares
 * over the converging part. */
typedef struct pl_sweep_order {
    pl_sweep_order_kind kind;
    double order;
    double deviation;       /* root mean square of the fit, decades of error */
    double dt_low, dt_high; /* s: the range used */
    int used, total;        /* time steps: in the fit, and run */
} pl_sweep_order;

/* Fills *order from time steps dt (s, falling) and
 * their errors (NAN: none; not below the floor).
 *
 * The converging part is the longest segment of neighbouring time steps in which the error is above
 * the floor and falls at least as fast as dt^(1/4); of equally long ones, the one of smaller steps.
 * Ends that fall less than half as fast as the segment's median pair of neighbours are cut off:
 * there the steps are still too large, or something other than the step limits the error. */
void pl_order_fit(const double *dt, const double *error, int count, pl_sweep_order *order);

/* The orders of all series of two time steps or more with an error, as in plumb.sweep/2. */
json_t *pl_orders_find(const pl_sweep_analysis *analysis);

#endif
