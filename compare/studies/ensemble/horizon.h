/* The prediction horizon of an engine's members: until then a single trajectory can be predicted;
 * afterwards only distributions can be compared.
 *
 * The spread of a body is the square root of the summed variance of its three coordinates over the
 * members (divided by n - 1), that is the root mean square distance from the ensemble's mean: the
 * spread of an ensemble forecast (Leith 1974). The spread of the ensemble is the largest of its
 * bodies'. */
#ifndef PLUMB_HORIZON_H
#define PLUMB_HORIZON_H

#include <jansson.h>

/* The horizon by the trajectories in `folder` of all members, whose runs an array of texts names; `least_size` is that of
 * the smallest body, m. A new object as in plumb.ensemble/1: "time" in s, null with a "reason" where the members stayed
 * together as long as all have a trajectory, or where the horizon is unknown; unless it is unknown also "threshold" in m, 1 % of that size,
 * and of the last sample "last_time" in s and "last_spread" in m. */
json_t *pl_horizon_find(const char *folder, const json_t *runs, double least_size);

/* The spread of `bodies` bodies over `members` samples of 3 x bodies coordinates, m. */
double pl_ensemble_spread(const double *const *members, int member_count, int bodies);

#endif
