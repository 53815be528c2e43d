/* One run in a process of its own, and its result: an engine that aborts, hangs, exits, prints or
 * takes too much memory gives a result like any other. */
#ifndef PLUMB_ISOLATED_RUN_H
#define PLUMB_ISOLATED_RUN_H

#include "engines/process.h"
#include "run_once.h"

/* A run in progress. */
typedef struct pl_isolated_run {
    pl_process process;
    pl_limits limits;
    pl_run_def def; /* its watch is shared with the child */
    json_t *identity;
    char started[32];
    /* The call of the engine that was last seen in progress, and the CPU time of the process then. */
    int call;
    long call_step;
    double call_cpu_time; /* s */
    bool is_over_limit;   /* a call took more than the limit of CPU time */
} pl_isolated_run;

/* Starts the run. `def` is copied, its `watch`, `cpu_limit` and `memory_limit` are not used; what it points to
 * must outlive the run. Takes its own reference of `identity`. */
pl_status pl_isolated_run_start(pl_isolated_run *run, const pl_run_def *def, json_t *identity,
                                const pl_limits *limits, pl_error *error);

/* Looks at the run, and ends it when one call of the engine has taken more than the limit of CPU
 * time. To be called from time to time while the run has such a limit. (A timer of CPU time in the
 * process itself would make Linux count its CPU time in ticks of the scheduler.) */
void pl_isolated_run_look(pl_isolated_run *run);

/* After pl_process_advance said that the process has ended: its plumb.result/1, a new reference.
 * PL_IO when the run itself could not be made. Frees the run in any case. */
pl_status pl_isolated_run_finish(pl_isolated_run *run, json_t *provenance, json_t **result,
                                 pl_error *error);

/* Kills the process, and frees the run. */
void pl_isolated_run_cancel(pl_isolated_run *run);

/* The part of its steps that is done, 0 .. 1. */
double pl_isolated_run_progress(const pl_isolated_run *run);

#endif
