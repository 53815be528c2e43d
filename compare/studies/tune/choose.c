/* From the search's evaluations to the answer. */
#include "best_point.h"
#include "tune_trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Trials that are looked at again before it is said that none has a margin. */
enum { MOST_CANDIDATES = 24 };

typedef struct finalists {
    pl_evaluation evaluations[PL_TUNE_FINALISTS]; /* (count) */
    double costs[PL_TUNE_FINALISTS];              /* (count): measured side by side */
    int order[PL_TUNE_FINALISTS];                 /* (count): in which they are validated */
    int count;
    bool stand; /* with a margin */
} finalists;

static int by_merit(const void *left, const void *right)
{
    const pl_evaluation *a = left, *b = right;
    return pl_evaluation_is_better(a, b) ? -1 : pl_evaluation_is_better(b, a);
}

/* Whether a evaluation meets the targets with the same margin on changed scenarios that the search
 * did not see: of many evaluations the cheapest is often one that was lucky on those that it did.
 */
static pl_status check_candidate(pl_tuner *t, pl_evaluation *evaluation, bool *stands,
                                 pl_error *error)
{
    const pl_setting setting = pl_tuner_setting(t, evaluation->values);
    int count = 0;
    const pl_variant *variants = pl_variants_chosen_by(&count);
    pl_evaluation again = *evaluation;
    pl_readings readings;
    pl_status status = pl_tuner_measure(t, &pl_variant_none, &setting, 1, 0, 1, &readings, error);
    if (status == PL_OK && t->tuning->signal_number == 0) {
        status = pl_evaluation_judge(t, &setting, pl_readings_of(&readings, 0), variants, count,
                                     &again, error);
    }
    pl_readings_free(&readings);
    evaluation->excess = fmax(evaluation->excess, again.excess);
    evaluation->holds = again.holds;
    *stands = evaluation->excess <= 0;
    return status;
}

/* The cheapest that stand a second look; where none does, those nearest to it that hold, or the
 * nearest of all. `sorted` is by merit, and may be changed. */
static pl_status find(pl_tuner *t, pl_evaluation *sorted, finalists *f, pl_error *error)
{
    const pl_tuning *tuning = t->tuning;
    const int evaluations = tuning->found.count;
    pl_status status = PL_OK;
    for (int i = 0; i < evaluations && i < MOST_CANDIDATES && f->count < PL_TUNE_FINALISTS &&
                    sorted[i].excess <= 0 && status == PL_OK && tuning->signal_number == 0;
         ++i) {
        bool stands = false;
        status = check_candidate(t, &sorted[i], &stands, error);
        if (stands) {
            f->evaluations[f->count++] = sorted[i];
        }
    }
    f->stand = f->count > 0;
    qsort(sorted, (size_t)evaluations, sizeof *sorted, by_merit);
    for (int i = 0; !f->stand && i < evaluations && i < PL_TUNE_FINALISTS; ++i) {
        if (i == 0 || sorted[i].holds) {
            f->evaluations[f->count++] = sorted[i];
        }
    }
    return status;
}

/* Those with a margin by their costs; the others as they are. */
static void put_in_order(const pl_tuner *t, const pl_readings *readings, finalists *f)
{
    for (int i = 0; i < f->count; ++i) {
        int place = i;
        f->costs[i] = pl_tuner_cost(t, pl_readings_of(readings, i + 1), pl_readings_of(readings, 0),
                                    0, PL_TUNE_REPEATS);
        while (f->stand && place > 0 && f->costs[i] < f->costs[f->order[place - 1]]) {
            f->order[place] = f->order[place - 1];
            --place;
        }
        f->order[place] = i;
    }
}

static void take(pl_tuner *t, const pl_readings *readings, const finalists *f, int index)
{
    pl_tuning *tuning = t->tuning;
    tuning->best = f->evaluations[index];
    tuning->setting = pl_tuner_setting(t, f->evaluations[index].values);
    tuning->cost = f->costs[index];
    tuning->worst = f->evaluations[index].excess;
    for (int p = 0; p < t->def->plan->problem_count; ++p) {
        tuning->scores[p] = pl_score_of(&pl_readings_of(readings, index + 1)[p],
                                        &pl_readings_of(readings, 0)[p], PL_TUNE_REPEATS);
    }
}

/* The first that misses nothing in validation; the first of all where there is none. */
static pl_status take_valid(pl_tuner *t, const pl_readings *readings, const finalists *f,
                            pl_error *error)
{
    pl_tuning *tuning = t->tuning;
    pl_status status = PL_OK;
    bool done = false;
    for (int k = 0; k <= f->count && status == PL_OK && tuning->signal_number == 0 && !done; ++k) {
        take(t, readings, f, f->order[k % f->count]);
        status = tuning->met ? validate(t, error) : PL_OK;
        done = !tuning->met || tuning->missed == 0;
        tuning->passed_over = done ? k : 0;
    }
    return status;
}

pl_status choose_best(pl_tuner *t, pl_error *error)
{
    pl_tuning *tuning = t->tuning;
    const size_t evaluations = (size_t)tuning->found.count;
    pl_evaluation *sorted = calloc(evaluations + 1, sizeof *sorted);
    pl_setting settings[PL_TUNE_FINALISTS + 1] = {t->shipped};
    pl_readings readings;
    finalists f = {.count = 0};
    if (sorted == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %zu trials", evaluations);
    }
    memcpy(sorted, tuning->found.evaluations, evaluations * sizeof *sorted);
    qsort(sorted, evaluations, sizeof *sorted, by_merit);
    pl_status status = find(t, sorted, &f, error);
    free(sorted);
    if (status != PL_OK || tuning->signal_number != 0 || f.count == 0) {
        return status;
    }
    tuning->met = f.evaluations[0].holds;
    tuning->has_margin = f.stand;
    for (int i = 0; i < f.count; ++i) {
        settings[i + 1] = pl_tuner_setting(t, f.evaluations[i].values);
    }
    status = pl_tuner_measure(t, &pl_variant_none, settings, f.count + 1, 0, PL_TUNE_REPEATS,
                              &readings, error);
    if (status == PL_OK && tuning->signal_number == 0) {
        put_in_order(t, &readings, &f);
        status = take_valid(t, &readings, &f, error);
    }
    pl_readings_free(&readings);
    return status;
}
