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
    int jobs; /* most runs at a time, >= 1, see schedule.h; times are reliable only with 1 on a quiet machine */
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

/* The path in that folder of the positions of the run with this hash: malloc'd. */
char *pl_positions_path(const char *folder, const char *run);

/* Counts the runs that are to be made: those that are not skipped, and that the store does not have. */
long pl_execution_due(const pl_execution_def *def);

/* Returns when all runs are done, or at SIGINT, SIGTERM or SIGHUP (unless they are ignored) with
 * its number in *signal_number, 0 otherwise: runs in progress are then killed and leave nothing.
 * PL_IO: a run could not be made. */
pl_status pl_execute(const pl_execution_def *def, int *signal_number, pl_error *error);

/* Makes the first run of a case on a configuration, with the seed of def->plan and the limits,
 * provenance, store and bar of `def`; its other fields are not used. *result is a new
 * reference; NULL at a signal. */
pl_status pl_execute_one(const pl_execution_def *def, const pl_case *test_case,
                         const pl_configuration *configuration, json_t **result, int *signal_number,
                         pl_error *error);

#endif
