/* Executes a plan: several runs at a time, each in a process of its own, and each result handed on
 * when its run ends. */
#ifndef PLUMB_EXECUTE_H
#define PLUMB_EXECUTE_H

#include "engines/process.h"
#include "plan.h"
#include "progress.h"
#include "results/store.h"
#include "run_once.h"

/* What to execute, and how. */
typedef struct pl_execution_def {
    const pl_plan *plan;
    int jobs; /* most runs at a time, >= 1; times are reliable only with 1 on a quiet machine */
    pl_limits limits;
    const pl_capture *capture; /* of a plan with one run; NULL: none */
    bool needs_positions;   /* a result of the store counts only with the file of its positions */
    const char *positions;  /* folder that gets RUN.positions of every run; NULL: none */
    const char *recordings; /* folder that gets RUN.json, a recording of every run; NULL: none */
    long positions_stride;  /* steps from one of their samples to the next; 0: the default */
    json_t *provenance;     /* pl_provenance */
    pl_store
        *store; /* has the results of runs that were made before, and keeps new ones; NULL: none */
    FILE *progress; /* where progress is shown; NULL: nowhere */
    /* A bar that several executions share, begun and ended by the caller with the runs of all in
     * its total; `progress` is then not used. NULL: one of its own. */
    pl_progress *bar;
    void *user;
    /* Whether this run is not to be made; NULL: all are. */
    bool (*skip)(void *user, const char *run);
    /* Sets *file to one that gets the frames of this run as CSV, and stays open until its result is amended; NULL:
     * none. A status other than PL_OK ends the execution. NULL: no run has one. */
    pl_status (*frames)(void *user, const char *run, FILE **file, pl_error *error);
    /* Adds to the result of a run that ended, before the store has it. NULL: nothing. */
    void (*amend)(void *user, json_t *result);
    /* Takes each result, of the store or when its run ends, and after the store has it. A status other than PL_OK
     * ends the execution. NULL: nothing does. */
    pl_status (*take)(void *user, json_t *result, pl_error *error);
} pl_execution_def;

/* Counts the runs that are to be made: those that are not skipped, and that the store does not have. Marks them in
 * `due` (size of the plan), unless that is NULL. */
long pl_execution_due(const pl_execution_def *def, bool *due);

/* Returns when all runs are done, or at SIGINT, SIGTERM or SIGHUP (unless they are ignored) with
 * its number in *signal_number, 0 otherwise: runs in progress are then killed and leave nothing.
 * PL_IO: a run could not be made. */
pl_status pl_execute(const pl_execution_def *def, int *signal_number, pl_error *error);

/* ---- Which runs are made at the same time: at most as many as there are jobs, and no more threads than the process
 * has CPUs, so that no run takes time from another one's step ---- */

/* The runs in progress and their CPUs. Starts with the first two set and the others 0. */
typedef struct pl_schedule {
    int jobs; /* runs at a time, >= 1 */
    int cpus; /* >= 1 */
    int runs, busy_cpus;
} pl_schedule;

/* Whether a run whose engine has `threads` threads may begin. A run that wants more than there are
 * gets all CPUs, and runs alone. */
bool pl_schedule_has_room(const pl_schedule *schedule, int threads);

/* Begins a run for which there is room. Returns the CPUs that it may use from now on: as many as its
 * engine has threads, and at least its share of all, cpus / jobs, as far as that is free. */
int pl_schedule_begin(pl_schedule *schedule, int threads);

/* Ends a run that began with `cpus` CPUs. */
void pl_schedule_end(pl_schedule *schedule, int cpus);

#endif
