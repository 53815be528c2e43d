/* The observations of one ensemble: samples of numbers from its members' results. */
#ifndef PLUMB_SAMPLE_H
#define PLUMB_SAMPLE_H

#include "referee/metrics/metrics.h"
#include "results/result.h"

#include <jansson.h>

/* Whether ensembles are compared by the metric. */
bool pl_is_observable(int metric);

/* The values of one metric by which ensembles are compared, of the members that ran to their end. */
typedef struct pl_sample {
    double *values; /* (count), by member */
    int count;
    int unsettled; /* settle_time only: members that never settled, whose value is the duration */
    double mean, deviation; /* NAN for fewer than 1 and 2 values; the deviation divides by n - 1 */
} pl_sample;

/* The growth, relative to the energy of the scene, that is accepted as rounding. */
extern const double pl_energy_growth;

/* What was observed in the members of one ensemble. */
typedef struct pl_observations {
    json_t *outcomes; /* of each outcome that members had, how many did */
    json_t *
        invariants; /* violations of laws that every member of every engine should obey: "energy_grew", members whose
                         * energy grew by more than pl_energy_growth, by at most "energy_growth" (null: unknown);
                         * "fell_through", members with a body whose centre ended beyond a static plane; "not_finite",
                         * members whose state became infinite or NaN */
    pl_sample samples[PL_METRIC_COUNT]; /* empty where the metric is no observable */
} pl_observations;

/* Gathers the observations of an ensemble from an array of its members' results. The caller frees *observed. */
void pl_observations_gather(const json_t *results, pl_observations *observed);

/* Whether a body's centre ended on the solid side of a static plane of the scene. */
bool pl_fell_through(const pl_scene *scene, const json_t *result);

/* Frees all of it. */
void pl_observations_free(pl_observations *observed);

/* ---- Horizons ---- */

/* The prediction horizon of an engine's members: until then a single trajectory can be predicted; afterwards only
 * distributions can be compared. It is the time from which on their spread passes 1 % of `least_size`, the size of the
 * smallest body in m, by the trajectories in `folder` of all members, whose runs an array of texts names.
 *
 * Returns a new object as in plumb.ensemble/1. "time" is in s; null with a "reason" where the members stayed together as
 * long as all have a trajectory, or where the horizon is unknown. Unless it is unknown there are also "threshold" in m,
 * and of the last sample "last_time" in s and "last_spread" in m. */
json_t *pl_horizon_find(const char *folder, const json_t *runs, double least_size);

/* The spread of `bodies` bodies over member_count samples of 3 x bodies coordinates, m. That of a body is the square root
 * of the summed variance of its three coordinates over the members, divided by n - 1: the root mean square distance from
 * the mean of the ensemble, as of an ensemble forecast (Leith 1974). The spread is the largest of the bodies'. */
double pl_ensemble_spread(const double *const *members, int member_count, int bodies);

#endif
