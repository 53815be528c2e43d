/* What the members of one ensemble showed: from their results to samples of numbers. */
#ifndef PLUMB_SAMPLE_H
#define PLUMB_SAMPLE_H

#include "members.h"
#include "referee/metrics/metrics.h"

#include <jansson.h>

/* The metrics that ensembles are compared by. */
enum { PL_OBSERVABLE_COUNT = 7 };
extern const pl_metric_id pl_observables[PL_OBSERVABLE_COUNT];

/* The values of one observable, of the members that ran to their end. */
typedef struct pl_sample {
    double *values; /* (count), by member */
    int count;
    int unsettled; /* settle_time alone: those of them that never settled, for which the duration
                      stands */
    double mean, deviation; /* NAN for fewer than 1 and 2 values; the deviation divides by n - 1 */
} pl_sample;

/* Laws that every member of every engine should keep. */
typedef struct pl_invariants {
    int energy_grew;      /* members: by more than pl_energy_growth */
    double energy_growth; /* the largest of all members; NAN: none is known */
    int fell_through;     /* members with a body whose centre ended beyond a static plane */
    int not_finite;       /* members */
} pl_invariants;

/* Relative to the energy of the scene: what is let pass as rounding of the engine's own. */
extern const double pl_energy_growth;

typedef struct pl_observations {
    int results;                    /* members whose result is there */
    int outcomes[PL_OUTCOME_COUNT]; /* of those */
    pl_invariants invariants;
    pl_sample samples[PL_OBSERVABLE_COUNT];
} pl_observations;

/* Gathers an ensemble's part of `results`. The caller frees *observed by pl_observations_free, in
 * any case. */
pl_status pl_observations_gather(const pl_plan *plan, const pl_ensemble *ensemble, int members,
                                 const json_t *results_by_run, pl_observations *observed,
                                 pl_error *error);
void pl_observations_free(pl_observations *observed);

/* An object run -> result of an array of results; NULL when out of memory. */
json_t *pl_results_by_run(const json_t *results);

/* Mean and standard deviation of the values. */
void pl_sample_summarise(pl_sample *sample);

#endif
