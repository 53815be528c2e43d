/* Runs metamorphic checks: for each scene and engine a plain run, and for each check the run of a
 * transformed scene that must agree with it. Every run has a process of its own. */
#ifndef PLUMB_METAMORPHIC_H
#define PLUMB_METAMORPHIC_H

#include "agreement.h"
#include "check_list.h"
#include "engines/process.h"
#include "results/journal.h"
#include "runner/plan.h"

/* The result of one check. */
typedef struct pl_check_result {
    const pl_check *check;
    pl_grade early, end;    /* at a tenth of the run, and at its end */
    pl_agreement agreement; /* undefined where the grade is FAILED or INAPPLICABLE */
    char reason[640];       /* of these two grades; empty for the others */
} pl_check_result;

/* All checks of one scene on one engine. The pointers are borrowed for the length of a call. */
typedef struct pl_checks_of_run {
    const pl_plan *plan;
    pl_planned_run run;
    const char *outcome;            /* of the plain run, as in a result */
    double size;                    /* m, of the scene */
    const pl_check_result *results; /* (result_count) */
    int result_count;
} pl_checks_of_run;

/* A metamorphic study. The pointers are borrowed. */
typedef struct pl_metamorphic_def {
    const pl_plan *plan; /* with one repeat: all its cases on all its engines */
    const bool *chosen;  /* which of pl_checks */
    pl_limits limits;
    json_t *provenance;
    pl_journal *journal; /* of the checks and plain runs; NULL: none */
    FILE *progress;      /* NULL: no progress is shown */
    void *user;
    /* Receives the checks of each run as they end. A status other than PL_OK ends the study. */
    pl_status (*keep)(void *user, const pl_checks_of_run *checks, pl_error *error);
} pl_metamorphic_def;

/* Returns when all checks are done, or at a signal, as pl_execute does. PL_IO, PL_NO_MEMORY: a run
 * could not be made. */
pl_status pl_run_checks(const pl_metamorphic_def *def, int *signal_number, pl_error *error);

/* Prints the scene and the engine, then one line per check. */
void pl_checks_print(FILE *out, const pl_checks_of_run *checks);

/* "plumb.metamorphic/1": the plain run's identity and outcome as in a result, `size` (m) and
 * `checks`, an array of objects with check, verdict, reason, passes_at (s or null), early and end,
 * each with position (over the size), rotation (rad) and verdict. Numbers are null where a run is
 * missing. A new reference; NULL when out of memory. */
json_t *pl_checks_to_json(const pl_checks_of_run *checks);

#endif
