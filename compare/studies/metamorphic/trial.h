/* Makes the checks: for each scene and engine a plain run, and for each check the run that is to be
 * like it, every run in a process of its own. */
#ifndef PLUMB_TRIAL_H
#define PLUMB_TRIAL_H

#include "agreement.h"
#include "check_list.h"
#include "runner/plan.h"
#include "runner/process.h"

/* What a check found. */
typedef struct pl_check_result {
    const pl_check *check;
    pl_grade early, end;    /* at a tenth of the run, and at its end */
    pl_agreement agreement; /* no meaning where failed or inapplicable */
    char reason[640];       /* of these two; else empty */
} pl_check_result;

/* One scene on one engine. The pointers are borrowed for the length of a call. */
typedef struct pl_checks_of_run {
    const pl_plan *plan;
    pl_planned_run run;
    const char *outcome;            /* of the plain run, as in a result */
    double size;                    /* m, of the scene */
    const pl_check_result *results; /* (result_count) */
    int result_count;
} pl_checks_of_run;

typedef struct pl_metamorphic_def {
    const pl_plan *plan; /* with one repeat: all its problems on all its contenders */
    const bool *chosen;  /* which of pl_checks */
    pl_limits limits;
    json_t *provenance;
    FILE *progress; /* NULL: nowhere */
    void *user;
    /* Gets each trial as it ends; anything but PL_OK ends the trials with that. */
    pl_status (*keep)(void *user, const pl_checks_of_run *trial, pl_error *error);
} pl_metamorphic_def;

/* Returns when all is done, or at a signal, as pl_execute does. PL_IO, PL_NO_MEMORY: a run could
 * not be made. */
pl_status pl_run_checks(const pl_metamorphic_def *def, int *signal_number, pl_error *error);

#endif
