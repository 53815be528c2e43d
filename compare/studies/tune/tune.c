#include "tune.h"

#include "best_point.h"
#include "tunable.h"
#include "tune_trial.h"

#include <math.h>
#include <stdlib.h>

/* What a search of this budget makes of runs, about: for the bar. */
static long expected_runs(const pl_tune_def *def)
{
    return (long)def->plan->case_count * def->budget * 3;
}

static pl_status search(pl_tuner *t, pl_error *error)
{
    const pl_tune_def *def = t->def;
    const pl_search_def seek = {.parameters = def->space->parameters,
                                .parameter_count = def->space->parameter_count,
                                .budget = def->budget,
                                .seed = def->plan->seed,
                                .user = t,
                                .measure = pl_evaluation_make};
    pl_tuning *tuning = t->tuning;
    pl_status status = measure_shipped(t, error);
    if (status == PL_OK && tuning->signal_number == 0) {
        status = pl_search(&seek, &tuning->found, error);
    }
    if (status == PL_OK && tuning->signal_number == 0) {
        status = choose_best(t, error);
    }
    if (status == PL_OK && tuning->signal_number == 0) {
        status = find_sensitivities(t, error);
    }
    return status;
}

pl_status pl_tune(const pl_tune_def *def, pl_tuning *tuning, pl_error *error)
{
    *tuning = (pl_tuning){.found = {.best = -1}};
    pl_tuner t = {.def = def, .tuning = tuning, .shows = def->progress != NULL};
    const size_t problems = (size_t)def->plan->case_count;
    t.shipped.dt = (double)NAN;
    t.shipped_instructions = calloc(problems, sizeof *t.shipped_instructions);
    t.spreads = calloc(problems, sizeof *t.spreads);
    tuning->scores = calloc(problems, sizeof *tuning->scores);
    pl_status status = t.shipped_instructions == NULL || t.spreads == NULL || tuning->scores == NULL
                           ? pl_fail(error, PL_NO_MEMORY, "out of memory")
                           : pl_tune_shipped(&def->space->base, &t.shipped.choice, error);
    if (t.shows) {
        t.bar = pl_progress_begin(def->progress, expected_runs(def), pl_monotonic_seconds());
    }
    if (status == PL_OK) {
        status = search(&t, error);
    }
    if (t.shows) {
        pl_progress_end(&t.bar);
    }
    free(t.spreads);
    free(t.shipped_instructions);
    return status;
}

void pl_tuning_free(pl_tuning *tuning)
{
    free(tuning->found.evaluations);
    free(tuning->scores);
    free(tuning->sensitivities);
    free(tuning->checks);
    *tuning = (pl_tuning){.runs = 0};
}
