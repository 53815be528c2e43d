#include "tune/answer.h"

#include "tune/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    /* What is shipped, the answer, and each axis moved either way. */
    MOST_SETTINGS = 2 * PL_TUNE_MOST_AXES + 1,
    /* Trials that are looked at again before it is said that none has a margin. */
    MOST_CANDIDATES = 24
};

static int by_merit(const void *left, const void *right)
{
    const pl_seek_trial *a = left, *b = right;
    return pl_seek_better(a, b) ? -1 : pl_seek_better(b, a);
}

/* Whether a trial meets the targets with the same margin on changed scenarios that the search did
 * not see: of many trials the cheapest is often one that was lucky on those that it did. */
static pl_status look_again(pl_tuner *t, pl_seek_trial *trial, bool *stands, pl_error *error)
{
    const pl_setting setting = pl_tuner_setting(t, trial->values);
    int count = 0;
    const pl_variant *variants = pl_variants_chosen_by(&count);
    pl_seek_trial again = *trial;
    pl_readings readings;
    pl_status status = pl_tuner_measure(t, &pl_variant_none, &setting, 1, 0, 1, &readings, error);
    if (status == PL_OK && t->tuning->signal_number == 0) {
        status = pl_trial_judge(t, &setting, pl_readings_of(&readings, 0), variants, count, &again,
                                error);
    }
    pl_readings_free(&readings);
    trial->excess = fmax(trial->excess, again.excess);
    *stands = trial->excess <= 0;
    return status;
}

/* Moves the cheapest trials that stand a second look to the front of those sorted by merit. Where
 * none does, the first stays there. */
static pl_status find_finalists(pl_tuner *t, pl_seek_trial *sorted, int *count, pl_error *error)
{
    const pl_tuning *tuning = t->tuning;
    const int most = tuning->by_instructions ? 1 : PL_TUNE_FINALISTS;
    pl_status status = PL_OK;
    *count = 0;
    for (int i = 0; i < tuning->found.count && i < MOST_CANDIDATES && *count < most &&
                    sorted[i].excess <= 0 && status == PL_OK && tuning->signal_number == 0;
         ++i) {
        bool stands = false;
        if (*count == 0 || pl_tuner_is_near(sorted[i].cost, sorted[0].cost)) {
            status = look_again(t, &sorted[i], &stands, error);
        }
        if (stands) {
            sorted[(*count)++] = sorted[i];
        }
    }
    return status;
}

/* Measures the best trials again, in turns with what is shipped, and takes the cheapest. */
pl_status pl_answer_choose(pl_tuner *t, pl_error *error)
{
    pl_tuning *tuning = t->tuning;
    const int problems = t->def->plan->problem_count;
    pl_seek_trial *sorted = calloc((size_t)tuning->found.count + 1, sizeof *sorted);
    pl_setting settings[PL_TUNE_FINALISTS + 1] = {t->shipped};
    pl_readings readings;
    int count = 0, best = 0;
    double least = (double)INFINITY;
    if (sorted == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d trials", tuning->found.count);
    }
    memcpy(sorted, tuning->found.trials, (size_t)tuning->found.count * sizeof *sorted);
    qsort(sorted, (size_t)tuning->found.count, sizeof *sorted, by_merit);
    tuning->met = tuning->found.count > 0 && sorted[0].holds;
    pl_status status = find_finalists(t, sorted, &count, error);
    if (status != PL_OK || tuning->signal_number != 0) {
        free(sorted);
        return status;
    }
    tuning->has_margin = count > 0;
    count = count == 0 && tuning->found.count > 0 ? 1 : count;
    for (int i = 0; i < count; ++i) {
        settings[i + 1] = pl_tuner_setting(t, sorted[i].values);
    }
    status = pl_tuner_measure(t, &pl_variant_none, settings, count + 1, 0, PL_TUNE_REPEATS,
                              &readings, error);
    for (int i = 0; i < count && status == PL_OK && tuning->signal_number == 0; ++i) {
        const double cost = pl_tuner_cost(t, pl_readings_of(&readings, i + 1),
                                          pl_readings_of(&readings, 0), 0, PL_TUNE_REPEATS);
        if (i == 0 || cost < least) {
            least = cost;
            best = i;
        }
    }
    if (status == PL_OK && tuning->signal_number == 0) {
        tuning->answer = sorted[best];
        tuning->setting = settings[best + 1];
        tuning->cost = least;
        tuning->worst = sorted[best].excess;
        for (int p = 0; p < problems; ++p) {
            tuning->scores[p] = pl_score_of(&pl_readings_of(&readings, best + 1)[p],
                                            &pl_readings_of(&readings, 0)[p], PL_TUNE_REPEATS);
        }
    }
    pl_readings_free(&readings);
    free(sorted);
    return status;
}

/* The answer, and each axis moved either way. */
pl_status pl_answer_slope(pl_tuner *t, pl_error *error)
{
    pl_tuning *tuning = t->tuning;
    const pl_tune_space *space = t->def->space;
    pl_setting settings[MOST_SETTINGS];
    pl_readings readings;
    int count = 0;
    tuning->slopes = calloc(MOST_SETTINGS, sizeof *tuning->slopes);
    if (tuning->slopes == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for sensitivities");
    }
    settings[0] = tuning->setting;
    for (int i = 0; i < 2 * space->axis_count; ++i) {
        double values[PL_TUNE_MOST_AXES];
        const int axis = i / 2;
        memcpy(values, tuning->answer.values, sizeof values);
        values[axis] = pl_tune_neighbour(&space->axes[axis], values[axis], i % 2 == 0 ? -1 : 1);
        if (values[axis] != tuning->answer.values[axis]) {
            settings[count + 1] = pl_tuner_setting(t, values);
            tuning->slopes[count++] = (pl_tune_slope){.axis = axis, .value = values[axis]};
        }
    }
    pl_status status = count == 0 ? PL_OK
                                  : pl_tuner_measure(t, &pl_variant_none, settings, count + 1, 0,
                                                     tuning->by_instructions ? 1 : PL_TUNER_REPEATS,
                                                     &readings, error);
    if (count == 0 || status != PL_OK || tuning->signal_number != 0) {
        goto done;
    }
    tuning->slope_count = count;
    for (int i = 0; i < count; ++i) {
        const pl_reading *mine = pl_readings_of(&readings, i + 1);
        tuning->slopes[i].excess = pl_tuner_excess(t, mine);
        tuning->slopes[i].cost =
            pl_score_mean_ratio(mine, pl_readings_of(&readings, 0), readings.problem_count,
                                readings.repeats, tuning->by_instructions);
    }
done:
    if (count > 0) {
        pl_readings_free(&readings);
    }
    return status;
}

/* The answer on what it was not tuned on. */
pl_status pl_answer_validate(pl_tuner *t, pl_error *error)
{
    pl_tuning *tuning = t->tuning;
    int count = 0;
    const pl_variant *variants = pl_variants_held_out(&count);
    pl_status status = PL_OK;
    tuning->checks = calloc((size_t)(count * t->def->plan->problem_count), sizeof *tuning->checks);
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
