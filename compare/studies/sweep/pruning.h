/* Runs that a sweep leaves out: repeats of long runs, changes of scenes that a point failed on, and
 * runs that would end at the time limit. */
#ifndef PLUMB_SWEEP_PRUNING_H
#define PLUMB_SWEEP_PRUNING_H

#include "runner/plan.h"

/* What the results so far tell of the runs of a plan. Repeats measure the noise of short runs; the
 * median over the steps of a long run varies little. A point that failed on the scene itself counts
 * nowhere, whatever it does on changed ones. */
typedef struct pl_pruning {
    const pl_plan *plan;
    double limit;   /* s of the engine's CPU time: longer runs are not repeated */
    json_t *runs;   /* run hash -> index in the plan */
    json_t *spared; /* points that are not repeated, as keys; changed scenes have the same points */
    json_t *failed; /* points whose outcome on the scene itself was not ok, as keys */
} pl_pruning;

/* Begins without results. The plan must outlive *pruning, which the caller frees. */
void pl_pruning_begin(pl_pruning *pruning, const pl_plan *plan, double limit);

/* Releases the JSON objects. */
void pl_pruning_free(pl_pruning *pruning);

/* Records a result. */
void pl_pruning_see(pl_pruning *pruning, const json_t *result);

/* Whether the run is a repeat of one that took too long to be repeated, or a failed one on a changed
 * scene. */
bool pl_pruning_spares(const pl_pruning *pruning, const char *run);

/* Prunes runs after a timeout: a run that timed out at one time step takes longer at a shorter one.
 * Where `result` timed out, passes to `keep` a result with the outcome `timeout` for the first run
 * of each point of the plan that differs only in a shorter time step; its reason says that it was
 * not run. `keep` borrows the result; a status other than PL_OK ends the call. */
pl_status pl_prune_timeouts(const pl_pruning *pruning, const json_t *result, json_t *provenance,
                            void *user,
                            pl_status (*keep)(void *user, json_t *result, pl_error *error),
                            pl_error *error);

#endif
