/* One run in this process: create, check the parameters, step and measure, destroy. An engine that
 * crashes ends the process: isolated_run.c makes the run in another one. */
#ifndef PLUMB_RUN_ONCE_H
#define PLUMB_RUN_ONCE_H

#include "adapters/contact_problems.h"
#include "engines/process.h"
#include "results/result.h"
#include "session.h"

#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>

/* The progress of a run, in memory that is shared with the process that watches it. */
typedef struct pl_run_watch {
    _Atomic(int) stage; /* pl_stage */
    atomic_long steps_done;
    _Atomic(int) program; /* process of an engine that is a program; 0: there is none */
} pl_run_watch;

/* The capture of the contact problems of one step during a run. */
typedef struct pl_capture {
    long step; /* from 1 */
    /* Takes over the contact problems (contact_problems.h), to destroy them. Called in the run's
     * process; anything but PL_OK means that the run could not be made. */
    pl_status (*take)(void *user, struct pe_contact_problem **problems, int count, pl_error *error);
    void *user;
} pl_capture;

/* What to run. */
typedef struct pl_run_def {
    const pl_scene *scene;
    const pl_engine_choice *choice;
    FILE *trajectory;          /* gets every frame as CSV; NULL: none */
    const char *positions;     /* file that gets a compact trajectory (positions.h); NULL: none */
    const char *recording;     /* raw file that gets a recording (recording.h); NULL: none */
    long positions_stride;     /* steps from one of its samples to the next; 0: the default */
    const pl_capture *capture; /* NULL: none; otherwise the engine exports contact problems */
    /* s of CPU time: a run of which create, steps and reads have taken more is not gone on with. A
     * call that does not return is ended by isolated_run.c. 0: no limit */
    double cpu_limit;
    /* Bytes that the process may take from the loading of the engine on: what the harness has then is
     * not the engine's. 0: no limit but that of the process */
    uint64_t memory_limit;
    int referee_threads; /* that share the referee's work where the scene is large; below 2: one */
    pl_run_watch *watch;
} pl_run_def;

/* Runs, and hands the result to `report`, whose result is returned. The result's arrays live
 * until `report` returns; the engine's instance is already destroyed. Any outcome is PL_OK;
 * another status, such as PL_IO (the trajectory), means that the run could not be made. */
pl_status pl_run_once(const pl_run_def *def,
                      pl_status (*report)(const pl_run_result *result, void *user, pl_error *error),
                      void *user, pl_error *error);

/* ---- A run in a process of its own, and its result (isolated_run.c): an engine that aborts, hangs, exits, prints or
 * takes too much memory gives a result like any other. ---- */

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
