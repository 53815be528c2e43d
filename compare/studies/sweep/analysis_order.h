/* Observed order of convergence. */
#ifndef PLUMB_SWEEP_ANALYSIS_ORDER_H
#define PLUMB_SWEEP_ANALYSIS_ORDER_H

#include "analysis.h"

/* Fills kind, order, deviation, range and counts of *order from time steps dt (s, falling) and
 * their errors (NAN: none; not below the floor).
 *
 * The converging part is the longest segment of neighbouring time steps, of equal ones that of the
 * smaller steps, in which the error is above the floor and falls at least as fast as dt^(1/4). From
 * its ends go those that fall less than half as fast as its median pair of neighbours does: there
 * the steps are still too large, or something other than the step limits the error. */
void pl_order_fit(const double *dt, const double *error, int count, pl_sweep_order *order);

/* Finds the orders of all series of two time steps or more. */
pl_status pl_orders_find(pl_sweep_analysis *analysis, pl_error *error);

#endif
