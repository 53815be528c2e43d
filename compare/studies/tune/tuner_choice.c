/* The choice of the answer among the evaluations of the search. */
#include "base/heap.h"
#include "tuner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The most that are measured side by side, and the most evaluations that are checked before it is said that none has a
 * margin. */
enum { MOST_FINALISTS = 6, MOST_CANDIDATES = 24 };

typedef struct finalists {
    pl_evaluation evaluations[MOST_FINALISTS]; /* (count) */
    double costs[MOST_FINALISTS];              /* (count): measured side by side */
    int order[MOST_FINALISTS];                 /* (count): in which they are validated */
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
    const pl_subject subject = pl_tuner_trial(t, evaluation->trial);
    pl_evaluation again = *evaluation;
    pl_readings readings;
    pl_status status = pl_tuner_measure(
        t, (pl_tuner_runs){.phase = "search", .subjects = &subject, .count = 1}, &readings, error);
    if (status == PL_OK && t->signal_number == 0) {
        status = pl_evaluation_judge(t, pl_readings_of(&readings, 0), pl_variants_chosen_by, &again,
                                     error);
    }
    pl_readings_free(&readings);
    evaluation->excess = fmax(evaluation->excess, again.excess);
    evaluation->holds = again.holds;
    *passes = evaluation->excess <= 0;
    return status;
}

/* The cheapest evaluations that pass the check. Where none does, the best ones that hold, or the
 * best of all. */
static pl_status find_finalists(pl_tuner *t, finalists *f, pl_error *error)
{
    const int count = t->found.count;
    pl_evaluation *sorted = pl_heap_new((size_t)count + 1, sizeof *sorted);
    pl_status status = PL_OK;
    memcpy(sorted, t->found.evaluations, (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, by_merit);
    for (int i = 0; i < count && i < MOST_CANDIDATES && f->count < MOST_FINALISTS &&
                    sorted[i].excess <= 0 && status == PL_OK && t->signal_number == 0;
         ++i) {
        bool passes = false;
        status = check_candidate(t, &sorted[i], &passes, error);
        if (passes) {
            f->evaluations[f->count++] = sorted[i];
        }
    }
    f->have_margin = f->count > 0;
    qsort(sorted, (size_t)count, sizeof *sorted, by_merit);
    for (int i = 0; !f->have_margin && i < count && i < MOST_FINALISTS; ++i) {
        if (i == 0 || sorted[i].holds) {
            f->evaluations[f->count++] = sorted[i];
        }
    }
    free(sorted);
    return status;
}

/* Measures the finalists again, in turns with the default settings. */
static pl_status measure_finalists(pl_tuner *t, const finalists *f, pl_error *error)
{
    pl_subject subjects[MOST_FINALISTS + 1] = {{.trial = -1}};
    for (int i = 0; i < f->count; ++i) {
        subjects[i + 1] = pl_tuner_trial(t, f->evaluations[i].trial);
    }
    const pl_tuner_runs runs = {
        .phase = "final", .subjects = subjects, .count = f->count + 1, .repeats = PL_TUNE_REPEATS};
    return pl_tuner_measure(t, runs, &t->final, error);
}

/* Orders finalists with a margin by their costs; others keep their order. */
static void put_in_order(const pl_tuner *t, finalists *f)
{
    for (int i = 0; i < f->count; ++i) {
        int place = i;
        f->costs[i] = pl_tuner_cost(t, pl_readings_of(&t->final, i + 1),
                                    pl_readings_of(&t->final, 0), 0, PL_TUNE_REPEATS);
        while (f->have_margin && place > 0 && f->costs[i] < f->costs[f->order[place - 1]]) {
            f->order[place] = f->order[place - 1];
            --place;
        }
        f->order[place] = i;
    }
}

/* Measures the answer on the variants that were held out, and sets the checks again. */
static pl_status validate(pl_tuner *t, pl_error *error)
{
    const pl_variants *variants = &pl_variants_held_out;
    const pl_subject subject = pl_tuner_trial(t, t->best.trial);
    pl_status status = PL_OK;
    json_array_clear(t->checks);
    t->missed = 0;
    for (int i = 0; i < variants->count && status == PL_OK && t->signal_number == 0; ++i) {
        const pl_tuner_runs runs = {
            .phase = "final", .subjects = &subject, .count = 1, .variant = &variants->items[i]};
        pl_readings readings;
        status = pl_tuner_measure(t, runs, &readings, error);
        for (int p = 0; p < readings.case_count; ++p) {
            const pl_reading *reading = &pl_readings_of(&readings, 0)[p];
            if (reading->is_there) {
                json_array_append_new(
                    t->checks,
                    json_pack("{s:O, s:s, s:s, s:o, s:f}", "scenario",
                              json_array_get(json_object_get(t->study, "scenarios"), (size_t)p),
                              "variant", variants->items[i].name, "outcome", reading->outcome,
                              "metrics", pl_target_values(&t->targets, &reading->target), "excess",
                              reading->target.excess));
                t->missed += reading->target.excess > 0;
            }
        }
        pl_readings_free(&readings);
    }
    return status;
}

/* Takes the first finalist that misses no target in validation, or else the first of all. */
static pl_status take_valid(pl_tuner *t, const finalists *f, pl_error *error)
{
    pl_status status = PL_OK;
    bool done = false;
    for (int k = 0; k <= f->count && status == PL_OK && t->signal_number == 0 && !done; ++k) {
        t->place = f->order[k % f->count];
        t->best = f->evaluations[t->place];
        t->cost = f->costs[t->place];
        status = t->met ? validate(t, error) : PL_OK;
        done = !t->met || t->missed == 0;
        t->passed_over = done ? k : 0;
    }
    return status;
}

pl_status pl_tuner_choose(pl_tuner *t, pl_error *error)
{
    finalists f = {.count = 0};
    pl_status status = find_finalists(t, &f, error);
    if (status != PL_OK || t->signal_number != 0 || f.count == 0) {
        return status;
    }
    t->met = f.evaluations[0].holds;
    t->has_margin = f.have_margin;
    status = measure_finalists(t, &f, error);
    if (status == PL_OK && t->signal_number == 0) {
        put_in_order(t, &f);
        status = take_valid(t, &f, error);
    }
    return status;
}
