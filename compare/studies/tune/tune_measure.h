/* Runs of settings of one engine on all scenarios, and what they show: error and cost. */
#ifndef PLUMB_TUNE_MEASURE_H
#define PLUMB_TUNE_MEASURE_H

#include "runner/execute.h"
#include "target.h"
#include "variant.h"

/* Settings: an engine with its options, and the step. */
typedef struct pl_setting {
    pl_engine_choice choice;
    double dt; /* s; NAN: each scenario's own */
} pl_setting;

/* What one setting did on one scenario. */
typedef struct pl_reading {
    bool is_there;  /* false: the scenario cannot be built so, or the variant changes nothing */
    bool is_absent; /* the engine does not do the scenario at all */
    pl_target_reading target;
    char outcome[32];
    /* Of each repeat, per simulated second; NAN: none. */
    double *seconds, *instructions; /* (repeats), of the readings' one block */
} pl_reading;

typedef struct pl_readings {
    int setting_count, problem_count, repeats;
    pl_reading *items; /* (setting_count x problem_count) */
    double *numbers;   /* what the items' arrays are in */
} pl_readings;

/* The readings of `setting`, one for each problem. */
const pl_reading *pl_readings_of(const pl_readings *readings, int setting);
void pl_readings_free(pl_readings *readings);

typedef struct pl_measure_def {
    const pl_plan *plan; /* the problems as asked for, and the seed */
    double dt, duration; /* s: asked for of scene files; NAN: their own */
    const pl_variant *variant;
    const pl_setting *settings; /* (setting_count) */
    int setting_count;
    int repeats;      /* >= 1; the settings take turns in each */
    int first_repeat; /* those below have been made before, and are not made again */
    const pl_targets *targets;
    int jobs;
    pl_limits limits;
    json_t *provenance;
    pl_progress *bar; /* counts the runs; NULL: none */
} pl_measure_def;

/* Makes the runs. The caller frees *readings in any case. A signal ends it as in pl_execute.
 * PL_NO_MEMORY, PL_IO; PL_BAD_INPUT only where an unchanged scene at its own step is refused. */
pl_status pl_measure(const pl_measure_def *def, pl_readings *readings, long *runs,
                     int *signal_number, pl_error *error);

#endif
