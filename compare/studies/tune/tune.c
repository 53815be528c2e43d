/* The steps of tuning: the search, the choice among its best points, their sensitivities and the
 * validation. */
#include "tune.h"

#include "studies/tunable.h"
#include "tuner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PL_TUNE_REPEATS = 5, PL_TUNE_FINALISTS = 6 };

/* The best point, and each parameter moved either way. */
enum { MOST_SETTINGS = 2 * PL_TUNE_MAX_PARAMETERS + 1 };

/* The geometric mean over the scenarios of the ratio of costs. */
static double mean_cost_ratio(const pl_reading *readings, const pl_reading *others, int case_count,
                              int repeats, bool by_instructions)
{
    double sum = 0;
    for (int p = 0; p < case_count; ++p) {
        sum += log(by_instructions ? readings[p].instructions[0] / others[p].instructions[0]
                                   : pl_score_ratio(&readings[p], &others[p], 0, repeats));
    }
    return exp(sum / case_count);
}

/* Measures the best point with each parameter moved either way. */
static pl_status find_sensitivities(pl_tuner *t, pl_error *error)
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
    if (count == 0) {
        return PL_OK;
    }
    const pl_tuner_runs runs = {.settings = settings,
                                .count = count + 1,
                                .repeats = tuning->by_instructions ? 1 : PL_TUNER_REPEATS};
    pl_status status = pl_tuner_measure(t, runs, &readings, error);
    if (status == PL_OK && tuning->signal_number == 0) {
        tuning->sensitivity_count = count;
    }
    for (int i = 0; i < tuning->sensitivity_count; ++i) {
        const pl_reading *mine = pl_readings_of(&readings, i + 1);
        tuning->sensitivities[i].excess = pl_tuner_excess(t, mine);
        tuning->sensitivities[i].cost =
            mean_cost_ratio(mine, pl_readings_of(&readings, 0), readings.case_count,
                            readings.repeats, tuning->by_instructions);
    }
    pl_readings_free(&readings);
    return status;
}

/* Measures the best point on the variants that were held out, and sets the checks again. */
static pl_status validate(pl_tuner *t, pl_error *error)
{
    pl_tuning *tuning = t->tuning;
    const pl_variants *variants = &pl_variants_held_out;
    pl_status status = PL_OK;
    free(tuning->checks);
    tuning->check_count = tuning->missed = 0;
    tuning->checks =
        calloc((size_t)variants->count * (size_t)t->def->plan->case_count, sizeof *tuning->checks);
    if (tuning->checks == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for validation");
    }
    for (int i = 0; i < variants->count && status == PL_OK && tuning->signal_number == 0; ++i) {
        const pl_tuner_runs runs = {
            .settings = &tuning->setting, .count = 1, .variant = &variants->items[i]};
        pl_readings readings;
        status = pl_tuner_measure(t, runs, &readings, error);
        for (int p = 0; p < readings.case_count && status == PL_OK; ++p) {
            const pl_reading *reading = &pl_readings_of(&readings, 0)[p];
            if (reading->is_there) {
                pl_tune_check *check = &tuning->checks[tuning->check_count++];
                *check = (pl_tune_check){
                    .variant = variants->items[i].name, .test_case = p, .target = reading->target};
                memcpy(check->outcome, reading->outcome, sizeof check->outcome);
                tuning->missed += reading->target.excess > 0;
            }
        }
        pl_readings_free(&readings);
    }
    return status;
}

/* ---- The choice among the search's evaluations ---- */

/* The most evaluations that are checked before the search reports that none has a margin. */
enum { MOST_CANDIDATES = 24 };

typedef struct finalists {
    pl_evaluation evaluations[PL_TUNE_FINALISTS]; /* (count) */
    double costs[PL_TUNE_FINALISTS];              /* (count): measured side by side */
    int order[PL_TUNE_FINALISTS];                 /* (count): in which they are validated */
    int count;
    bool have_margin;
} finalists;

static int by_merit(const void *left, const void *right)
{
    const pl_evaluation *a = left, *b = right;
    return pl_evaluation_is_better(a, b) ? -1 : pl_evaluation_is_better(b, a);
}

/* Whether an evaluation meets the targets with the same margin on changed scenarios that the search
 * did not use. The cheapest of many evaluations often met the targets by chance. */
static pl_status check_candidate(pl_tuner *t, pl_evaluation *evaluation, bool *passes,
                                 pl_error *error)
{
    const pl_setting setting = pl_tuner_setting(t, evaluation->values);
    pl_evaluation again = *evaluation;
    pl_readings readings;
    pl_status status =
        pl_tuner_measure(t, (pl_tuner_runs){.settings = &setting, .count = 1}, &readings, error);
    if (status == PL_OK && t->tuning->signal_number == 0) {
        status = pl_evaluation_judge(t, &setting, pl_readings_of(&readings, 0),
                                     pl_variants_chosen_by, &again, error);
    }
    pl_readings_free(&readings);
    evaluation->excess = fmax(evaluation->excess, again.excess);
    evaluation->holds = again.holds;
    *passes = evaluation->excess <= 0;
    return status;
}

/* The cheapest evaluations that pass the check. Where none does, the best ones that hold, or the
 * best of all. `sorted` is by merit, and is changed. */
static pl_status find_finalists(pl_tuner *t, pl_evaluation *sorted, finalists *f, pl_error *error)
{
    const pl_tuning *tuning = t->tuning;
    const int evaluations = tuning->found.count;
    pl_status status = PL_OK;
    for (int i = 0; i < evaluations && i < MOST_CANDIDATES && f->count < PL_TUNE_FINALISTS &&
                    sorted[i].excess <= 0 && status == PL_OK && tuning->signal_number == 0;
         ++i) {
        bool passes = false;
        status = check_candidate(t, &sorted[i], &passes, error);
        if (passes) {
            f->evaluations[f->count++] = sorted[i];
        }
    }
    f->have_margin = f->count > 0;
    qsort(sorted, (size_t)evaluations, sizeof *sorted, by_merit);
    for (int i = 0; !f->have_margin && i < evaluations && i < PL_TUNE_FINALISTS; ++i) {
        if (i == 0 || sorted[i].holds) {
            f->evaluations[f->count++] = sorted[i];
        }
    }
    return status;
}

/* Orders finalists with a margin by their costs; others keep their order. */
static void put_in_order(const pl_tuner *t, const pl_readings *readings, finalists *f)
{
    for (int i = 0; i < f->count; ++i) {
        int place = i;
        f->costs[i] = pl_tuner_cost(t, pl_readings_of(readings, i + 1), pl_readings_of(readings, 0),
                                    0, PL_TUNE_REPEATS);
        while (f->have_margin && place > 0 && f->costs[i] < f->costs[f->order[place - 1]]) {
            f->order[place] = f->order[place - 1];
            --place;
        }
        f->order[place] = i;
    }
}

static pl_tune_score score_of(const pl_reading *reading, const pl_reading *defaults, int repeats)
{
    pl_tune_score score = {.seconds = pl_score_ratio(reading, NULL, 0, repeats),
                           .default_seconds = pl_score_ratio(defaults, NULL, 0, repeats),
                           .ratio = pl_score_ratio(reading, defaults, 0, repeats),
                           .target = reading->target,
                           .default_target = defaults->target};
    memcpy(score.outcome, reading->outcome, sizeof score.outcome);
    memcpy(score.default_outcome, defaults->outcome, sizeof score.default_outcome);
    return score;
}

static void take_finalist(pl_tuner *t, const pl_readings *readings, const finalists *f, int index)
{
    pl_tuning *tuning = t->tuning;
    tuning->best = f->evaluations[index];
    tuning->setting = pl_tuner_setting(t, f->evaluations[index].values);
    tuning->cost = f->costs[index];
    tuning->worst = f->evaluations[index].excess;
    for (int p = 0; p < t->def->plan->case_count; ++p) {
        tuning->scores[p] = score_of(&pl_readings_of(readings, index + 1)[p],
                                     &pl_readings_of(readings, 0)[p], PL_TUNE_REPEATS);
    }
}

/* Takes the first finalist that misses no target in validation, or else the first of all. */
static pl_status take_valid(pl_tuner *t, const pl_readings *readings, const finalists *f,
                            pl_error *error)
{
    pl_tuning *tuning = t->tuning;
    pl_status status = PL_OK;
    bool done = false;
    for (int k = 0; k <= f->count && status == PL_OK && tuning->signal_number == 0 && !done; ++k) {
        take_finalist(t, readings, f, f->order[k % f->count]);
        status = tuning->met ? validate(t, error) : PL_OK;
        done = !tuning->met || tuning->missed == 0;
        tuning->passed_over = done ? k : 0;
    }
    return status;
}

/* Measures the finalists again, in turns with the default settings, and takes the cheapest that
 * misses no target in validation, or else the cheapest. */
static pl_status choose_best(pl_tuner *t, pl_error *error)
{
    pl_tuning *tuning = t->tuning;
    const size_t evaluations = (size_t)tuning->found.count;
    pl_evaluation *sorted = calloc(evaluations + 1, sizeof *sorted);
    pl_setting settings[PL_TUNE_FINALISTS + 1] = {t->defaults};
    pl_readings readings;
    finalists f = {.count = 0};
    if (sorted == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %zu settings", evaluations);
    }
    memcpy(sorted, tuning->found.evaluations, evaluations * sizeof *sorted);
    qsort(sorted, evaluations, sizeof *sorted, by_merit);
    pl_status status = find_finalists(t, sorted, &f, error);
    free(sorted);
    if (status != PL_OK || tuning->signal_number != 0 || f.count == 0) {
        return status;
    }
    tuning->met = f.evaluations[0].holds;
    tuning->has_margin = f.have_margin;
    for (int i = 0; i < f.count; ++i) {
        settings[i + 1] = pl_tuner_setting(t, f.evaluations[i].values);
    }
    const pl_tuner_runs runs = {
        .settings = settings, .count = f.count + 1, .repeats = PL_TUNE_REPEATS};
    status = pl_tuner_measure(t, runs, &readings, error);
    if (status == PL_OK && tuning->signal_number == 0) {
        put_in_order(t, &readings, &f);
        status = take_valid(t, &readings, &f, error);
    }
    pl_readings_free(&readings);
    return status;
}

static pl_status search(pl_tuner *t, pl_error *error)
{
    const pl_tune_def *def = t->def;
    const pl_search_def search_def = {.parameters = def->space->parameters,
                                      .parameter_count = def->space->parameter_count,
                                      .budget = def->budget,
                                      .seed = def->plan->seed,
                                      .user = t,
                                      .measure = pl_evaluation_make};
    pl_tuning *tuning = t->tuning;
    pl_status status = pl_evaluate_defaults(t, error);
    if (status == PL_OK && tuning->signal_number == 0) {
        status = pl_search(&search_def, &tuning->found, error);
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
    const size_t cases = (size_t)def->plan->case_count;
    t.defaults.dt = (double)NAN;
    t.default_instructions = calloc(cases, sizeof *t.default_instructions);
    t.spreads = calloc(cases, sizeof *t.spreads);
    tuning->scores = calloc(cases, sizeof *tuning->scores);
    pl_status status = t.default_instructions == NULL || t.spreads == NULL || tuning->scores == NULL
                           ? pl_fail(error, PL_NO_MEMORY, "out of memory")
                           : PL_OK;
    t.defaults.choice = pl_tune_defaults(&def->space->base);
    /* The bar expects about three runs per case and setting. */
    if (t.shows) {
        t.bar = pl_progress_begin(def->progress, (long)def->plan->case_count * def->budget * 3,
                                  pl_monotonic_seconds());
    }
    if (status == PL_OK) {
        status = search(&t, error);
    }
    if (t.shows) {
        pl_progress_end(&t.bar);
    }
    free(t.spreads);
    free(t.default_instructions);
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
