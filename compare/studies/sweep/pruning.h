/* Runs that a sweep leaves out: repeats of long runs, changes of scenes that a point failed on, and
 * runs that would end at the time limit. */
#ifndef PLUMB_SWEEP_PRUNING_H
#define PLUMB_SWEEP_PRUNING_H

#include "runner/plan.h"

/* Decides which runs are repeated, and which are made again on changed scenes. Repeats measure the
 * noise of short runs; the median over the steps of a long run varies little. A point that failed
 * on the scene itself counts nowhere, whatever it does on changed ones. */
typedef struct pl_repeats {
    double limit;    /* s of the engine's CPU time: longer runs are not repeated */
    json_t *points;  /* run hash -> point, of all runs; changed scenes have the same points */
    json_t *first;   /* hashes of the first run of each point, as keys */
    json_t *changed; /* hashes of the runs on changed scenes, as keys */
    json_t *spared;  /* points that are not repeated, as keys */
    json_t *failed;  /* points whose outcome on the scene itself was not ok, as keys */
} pl_repeats;

/* Numbers the points of a plan. The caller frees *repeats. */
void pl_repeats_begin(pl_repeats *repeats, const pl_plan *plan, double limit);

/* Releases the JSON objects. */
void pl_repeats_free(pl_repeats *repeats);

/* Records a result. */
void pl_repeats_see(pl_repeats *repeats, const json_t *result);

/* Whether the run is a repeat of one that took too long to be repeated, or a failed one on a changed
 * scene. */
bool pl_repeats_spare(const pl_repeats *repeats, const char *run);

/* Prunes runs after a timeout: a run that timed out at one time step takes longer at a shorter one.
 * Where `result` timed out, passes to `keep` a result with the outcome `timeout` for the first run
 * of each point of the plan that differs only in a shorter time step; its reason says that it was
 * not run. `keep` borrows the result; a status other than PL_OK ends the call. */
pl_status pl_prune_timeouts(const pl_plan *plan, const json_t *result, json_t *provenance,
                            void *user,
                            pl_status (*keep)(void *user, json_t *result, pl_error *error),
                            pl_error *error);

#endif
