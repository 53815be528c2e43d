/* One run in this process: create, check the parameters, step and measure, destroy. An engine that
 * crashes ends the process: isolated_run.h makes the run in another one. */
#ifndef PLUMB_RUN_ONCE_H
#define PLUMB_RUN_ONCE_H

#include "adapters/contact_problems.h"
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
     * call that does not return is ended by isolated_run.h. 0: no limit */
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

#endif
