#include "best_point.h"

#include <stdlib.h>
#include <string.h>

/* The answer, and each parameter moved either way. */
enum { MOST_SETTINGS = 2 * PL_TUNE_MAX_PARAMETERS + 1 };

pl_status find_sensitivities(pl_tuner *t, pl_error *error)
{
    pl_tuning *tuning = t->tuning;
    const pl_tune_space *space = t->def->space;
    pl_setting settings[MOST_SETTINGS];
    pl_readings readings;
    int count = 0;
    tuning->sensitivities = calloc(MOST_SETTINGS, sizeof *tuning->sensitivities);
    if (tuning->sensitivities == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for sensitivities");
    }
    settings[0] = tuning->setting;
    for (int i = 0; i < 2 * space->parameter_count; ++i) {
        double values[PL_TUNE_MAX_PARAMETERS];
        const int parameter = i / 2;
        memcpy(values, tuning->best.values, sizeof values);
        values[parameter] = pl_tune_neighbour(&space->parameters[parameter], values[parameter],
                                              i % 2 == 0 ? -1 : 1);
        if (values[parameter] != tuning->best.values[parameter]) {
            settings[count + 1] = pl_tuner_setting(t, values);
            tuning->sensitivities[count++] =
                (pl_tune_sensitivity){.parameter = parameter, .value = values[parameter]};
        }
    }
    pl_status status = count == 0 ? PL_OK
                                  : pl_tuner_measure(t, &pl_variant_none, settings, count + 1, 0,
                                                     tuning->by_instructions ? 1 : PL_TUNER_REPEATS,
                                                     &readings, error);
    if (count == 0 || status != PL_OK || tuning->signal_number != 0) {
        goto done;
    }
    tuning->sensitivity_count = count;
    for (int i = 0; i < count; ++i) {
        const pl_reading *mine = pl_readings_of(&readings, i + 1);
        tuning->sensitivities[i].excess = pl_tuner_excess(t, mine);
        tuning->sensitivities[i].cost =
            pl_score_mean_ratio(mine, pl_readings_of(&readings, 0), readings.problem_count,
                                readings.repeats, tuning->by_instructions);
    }
done:
    if (count > 0) {
        pl_readings_free(&readings);
    }
    return status;
}

pl_status validate(pl_tuner *t, pl_error *error)
{
    pl_tuning *tuning = t->tuning;
    int count = 0;
    const pl_variant *variants = pl_variants_held_out(&count);
    pl_status status = PL_OK;
    free(tuning->checks);
    tuning->check_count = tuning->missed = 0;
    tuning->checks = calloc((size_t)(count * t->def->plan->case_count), sizeof *tuning->checks);
    if (tuning->checks == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for validation");
    }
    for (int i = 0; i < count && status == PL_OK && tuning->signal_number == 0; ++i) {
        pl_readings readings;
        status = pl_tuner_measure(t, &variants[i], &tuning->setting, 1, 0, 1, &readings, error);
        for (int p = 0; p < readings.problem_count && status == PL_OK; ++p) {
            const pl_reading *reading = &pl_readings_of(&readings, 0)[p];
            if (reading->is_there) {
                pl_tune_check *check = &tuning->checks[tuning->check_count++];
                *check = (pl_tune_check){
                    .variant = variants[i].name, .problem = p, .target = reading->target};
                memcpy(check->outcome, reading->outcome, sizeof check->outcome);
                tuning->missed += reading->target.excess > 0;
            }
        }
        pl_readings_free(&readings);
    }
    return status;
}
