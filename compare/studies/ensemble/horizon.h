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
#include <stdbool.h>

/* The prediction horizon of one ensemble, or the reason why it is unknown. */
typedef struct pl_horizon {
    bool known; /* false: `reason` says why, and the other fields are undefined */
    char reason[160];
    double time;        /* s; INFINITY: not passed within the time that all members have */
    double threshold;   /* m: 1 % of the smallest body's size */
    double last_spread; /* m, at the last sample */
    double last_time;   /* s, of that sample */
} pl_horizon;

/* Computes the horizon from the trajectories in `folder` of all members, whose runs an array of texts names.
 * `least_size` is that of the smallest body, m. */
void pl_horizon_find(const char *folder, const json_t *runs, double least_size,
                     pl_horizon *horizon);

/* The spread of `bodies` bodies over `members` samples of 3 x bodies coordinates, m. */
double pl_ensemble_spread(const double *const *members, int member_count, int bodies);

#endif
