/* Costs and excesses of settings next to the default settings, the evaluations of the search, and the choice among
 * them. */
#include "tuner.h"

#include "base/heap.h"
#include "base/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

pl_tuner pl_tuner_begin(json_t *study, pl_error *error)
{
    pl_tuner t = {.error = error,
                  .study = json_incref(study),
                  .rows = json_object(),
                  .points = json_array(),
                  .case_count = (int)json_array_size(json_object_get(study, "scenarios")),
                  .found = {.best = -1},
                  .checks = json_array()};
    const json_t *texts = json_object_get(study, "targets");
    for (size_t i = 0; i < json_array_size(texts); ++i) {
        const char *text = json_string_value(json_array_get(texts, i));
        if (text == NULL || pl_target_add(&t.targets, text, error) != PL_OK) {
            t.targets.count = 0;
            break;
        }
    }
    return t;
}

void pl_tuner_free(pl_tuner *t)
{
    json_decref(t->study);
    json_decref(t->rows);
    json_decref(t->points);
    json_decref(t->checks);
    free(t->found.evaluations);
}

const char *pl_tuner_scenario(const pl_tuner *t, int test_case)
{
    return json_string_value(
        json_array_get(json_object_get(t->study, "scenarios"), (size_t)test_case));
}

/* ---- Costs and excesses ---- */

/* A metric per simulated second; NAN where it is not positive. */
static double rate_of(const json_t *row, pl_metric_id id)
{
    const double value = pl_result_metric(row, pl_metric_table[id].name);
    return value > 0 ? value / pl_study_number(row, "settings.dt") : (double)NAN;
}

double pl_tuner_ratio(const pl_tuner *t, pl_metric_id metric, const pl_subject *mine,
                      const pl_subject *other, int test_case, int first, int end)
{
    double ratios[PL_TUNE_REPEATS];
    int count = 0;
    for (int i = first; i < end; ++i) {
        const double rate = rate_of(pl_tuner_row(t, mine, test_case, i), metric);
        const double ratio =
            other == NULL ? rate : rate / rate_of(pl_tuner_row(t, other, test_case, i), metric);
        if (isfinite(ratio)) {
            ratios[count++] = ratio;
        }
    }
    return pl_median(ratios, count);
}

double pl_tuner_cost(const pl_tuner *t, pl_metric_id metric, const pl_subject *mine,
                     const pl_subject *other, int first, int end)
{
    double sum = 0;
    for (int p = 0; p < t->case_count; ++p) {
        sum += log(pl_tuner_ratio(t, metric, mine, other, p, first, end));
    }
    const double cost = exp(sum / t->case_count);
    return isfinite(cost) ? cost : (double)INFINITY;
}

int pl_tuner_sensitivity_repeats(const pl_tuner *t)
{
    return t->by_instructions ? 1 : PL_TUNER_REPEATS;
}

double pl_tuner_excess(const pl_tuner *t, const pl_subject *subject)
{
    double excess = -PL_SEARCH_WORST;
    for (int p = 0; p < t->case_count; ++p) {
        excess = fmax(excess, pl_targets_excess(&t->targets, pl_tuner_row(t, subject, p, 0)));
    }
    return excess;
}

double pl_likely_excess(const double *excesses, int count)
{
    const double much = -3; /* ln(1 / 20) */
    double sum = 0, squares = 0;
    for (int i = 0; i < count; ++i) {
        const double value = fmax(excesses[i], much);
        sum += value;
        squares += value * value;
    }
    const double mean = sum / count, variance = squares / count - mean * mean;
    return mean + 2 * sqrt(count > 1 ? fmax(variance, 0) * count / (count - 1) : 0);
}

/* ---- Evaluations ---- */

const pl_subject pl_tuner_defaults = {.phase = "search", .trial = -1};

pl_subject pl_tuner_trial(const pl_tuner *t, const char *phase, int trial)
{
    return (pl_subject){
        .phase = phase, .trial = trial, .values = json_array_get(t->points, (size_t)trial)};
}

void pl_evaluate_defaults(pl_tuner *t)
{
    t->by_instructions = t->default_has_cost = true;
    if (!pl_tuner_measure(t, &pl_tuner_defaults, 1, 1)) {
        return;
    }
    for (int p = 0; p < t->case_count; ++p) {
        const json_t *row = pl_tuner_row(t, &pl_tuner_defaults, p, 0);
        if (strcmp(pl_json_get_text(row, "outcome"), "unsupported") == 0) {
            t->status = pl_fail(t->error, PL_UNSUPPORTED, "%s does not do %s",
                                pl_json_get_text(row, "engine"), pl_tuner_scenario(t, p));
        }
        t->by_instructions =
            t->by_instructions && isfinite(rate_of(row, PL_METRIC_INSTRUCTIONS_PER_STEP));
        t->default_has_cost =
            t->default_has_cost && isfinite(rate_of(row, PL_METRIC_TIME_PER_STEP));
    }
}

/* The cost in CPU time next to the default settings, which alone counts where these have none. */
static double cost_in_time(const pl_tuner *t, const pl_subject subjects[2], int first, int end)
{
    return pl_tuner_cost(t, PL_METRIC_TIME_PER_STEP, &subjects[0],
                         t->default_has_cost ? &subjects[1] : NULL, first, end);
}

/* Whether the cost may turn out to be the lowest when it is measured again. */
static bool may_be_best(const pl_tuner *t, const pl_evaluation *evaluation)
{
    const double near_enough = 1.25;
    const pl_search_result *found = &t->found;
    return !found->met || evaluation->cost <= near_enough * found->evaluations[found->best].cost;
}

/* The excess that one more run of a case is unlikely to exceed, from the run as asked for and those of the variants. */
static double likely_excess_of(const pl_tuner *t, pl_subject subject, pl_variants variants,
                               int test_case)
{
    double *excesses = pl_heap_new((size_t)variants.count + 1, sizeof *excesses);
    int count = 0;
    for (int i = -1; i < variants.count; ++i) {
        subject.variant = i < 0 ? NULL : &variants.items[i];
        const json_t *row = pl_tuner_row(t, &subject, test_case, 0);
        if (row != NULL) {
            excesses[count++] = pl_targets_excess(&t->targets, row);
        }
    }
    const double likely = pl_likely_excess(excesses, count);
    free(excesses);
    return likely;
}

/* Sets `excess` and `holds` from the runs of the scenarios as asked for, which were made, and from those of the
 * scenarios as the variants change them, up to the first that misses a target. */
static void judge(pl_tuner *t, pl_variants variants, pl_evaluation *evaluation)
{
    const pl_subject asked = pl_tuner_trial(t, "search", evaluation->trial);
    double worst = pl_tuner_excess(t, &asked);
    for (int i = 0; i < variants.count && worst <= 0; ++i) {
        pl_subject changed = asked;
        changed.variant = &variants.items[i];
        if (!pl_tuner_measure(t, &changed, 1, 1)) {
            return;
        }
        for (int p = 0; p < t->case_count; ++p) {
            const json_t *row = pl_tuner_row(t, &changed, p, 0);
            worst = row == NULL ? worst : fmax(worst, pl_targets_excess(&t->targets, row));
        }
    }
    evaluation->holds = worst <= 0;
    evaluation->excess = fmin(worst, PL_SEARCH_WORST);
    for (int p = 0; p < t->case_count && evaluation->holds; ++p) {
        evaluation->excess = fmax(evaluation->excess, likely_excess_of(t, asked, variants, p));
    }
}

/* The CPU time of the engine's steps in the first runs of the subjects. It is that of the results, so that a search that
 * is continued takes the same way. */
static double seconds_of(const pl_tuner *t, const pl_subject *subjects, int count)
{
    double sum = 0;
    for (int i = 0; i < count * t->case_count; ++i) {
        const json_t *row = pl_tuner_row(t, &subjects[i / t->case_count], i % t->case_count, 0);
        const double rate = rate_of(row, PL_METRIC_TIME_PER_STEP);
        sum += isfinite(rate) ? rate * pl_study_number(row, "settings.duration") : 0;
    }
    return sum;
}

/* Measures one repeat, and where times count more repeats of a setting that also meets the targets on the changed
 * scenarios. The default settings then run next to it, so that drift of the machine affects both. */
void pl_evaluation_make(pl_tuner *t, pl_evaluation *evaluation)
{
    const pl_subject subjects[] = {pl_tuner_trial(t, "search", evaluation->trial),
                                   {.phase = "search", .trial = evaluation->trial}};
    const int count = t->by_instructions ? 1 : 2;
    const pl_search_result *found = &t->found;
    if (!pl_tuner_measure(t, subjects, count, 1)) {
        return;
    }
    evaluation->cost = t->by_instructions ? pl_tuner_cost(t, PL_METRIC_INSTRUCTIONS_PER_STEP,
                                                          &subjects[0], &pl_tuner_defaults, 0, 1)
                                          : cost_in_time(t, subjects, 0, 1);
    const bool is_near = may_be_best(t, evaluation);
    judge(t, is_near ? pl_variants_tuned_on : (pl_variants){.count = 0}, evaluation);
    if (evaluation->holds && is_near && !t->by_instructions) {
        pl_tuner_measure(t, subjects, count, PL_TUNER_REPEATS);
        evaluation->cost = cost_in_time(t, subjects, 1, PL_TUNER_REPEATS);
    }
    if (evaluation->excess <= 0 &&
        (!found->met || evaluation->cost < found->evaluations[found->best].cost)) {
        t->best_seconds = seconds_of(t, subjects, count);
    }
}

/* ---- The choice of the answer among the evaluations ---- */

/* The most that are measured side by side, and the most evaluations that are checked before it is said that none has a
 * margin. */
enum { MOST_FINALISTS = 6, MOST_CANDIDATES = 24 };

typedef struct finalist {
    pl_evaluation evaluation;
    double cost; /* measured side by side */
} finalist;

typedef struct finalists {
    finalist items[MOST_FINALISTS]; /* (count): in the order in which they are validated */
    int count;
    bool have_margin;
} finalists;

static int by_merit(const void *left, const void *right)
{
    const pl_evaluation *a = left, *b = right;
    return pl_evaluation_is_better(a, b) ? -1 : pl_evaluation_is_better(b, a);
}

static int by_cost(const void *left, const void *right)
{
    const finalist *a = left, *b = right;
    return a->cost != b->cost ? (a->cost > b->cost) - (a->cost < b->cost)
                              : by_merit(&a->evaluation, &b->evaluation);
}

/* Checks an evaluation with the same margin on changed scenarios that the search did not use. The cheapest of many
 * evaluations often met the targets by chance. */
static void check_candidate(pl_tuner *t, pl_evaluation *evaluation)
{
    const double before = evaluation->excess;
    judge(t, pl_variants_chosen_by, evaluation);
    evaluation->excess = fmax(evaluation->excess, before);
}

/* The cheapest evaluations that pass the check. Where none does, the best ones that hold, or the
 * best of all. */
static void find_finalists(pl_tuner *t, finalists *f)
{
    const int count = t->found.count;
    pl_evaluation *sorted = pl_heap_new((size_t)count + 1, sizeof *sorted);
    memcpy(sorted, t->found.evaluations, (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, by_merit);
    for (int i = 0; i < count && i < MOST_CANDIDATES && f->count < MOST_FINALISTS &&
                    sorted[i].excess <= 0 && pl_tuner_goes_on(t);
         ++i) {
        check_candidate(t, &sorted[i]);
        if (sorted[i].excess <= 0) {
            f->items[f->count++].evaluation = sorted[i];
        }
    }
    f->have_margin = f->count > 0;
    qsort(sorted, (size_t)count, sizeof *sorted, by_merit);
    for (int i = 0; !f->have_margin && i < count && i < MOST_FINALISTS; ++i) {
        if (i == 0 || sorted[i].holds) {
            f->items[f->count++].evaluation = sorted[i];
        }
    }
    free(sorted);
}

/* Measures the finalists again, in turns with the default settings, and puts those with a margin in the order of their
 * costs. */
static void measure_finalists(pl_tuner *t, finalists *f)
{
    pl_subject subjects[MOST_FINALISTS + 1];
    for (int i = 0; i < f->count; ++i) {
        subjects[i + 1] = pl_tuner_trial(t, "final", f->items[i].evaluation.trial);
    }
    subjects[0] = (pl_subject){.phase = "final", .trial = -1};
    pl_tuner_measure(t, subjects, f->count + 1, PL_TUNE_REPEATS);
    for (int i = 0; i < f->count; ++i) {
        const pl_subject pair[] = {subjects[i + 1], subjects[0]};
        f->items[i].cost = cost_in_time(t, pair, 0, PL_TUNE_REPEATS);
    }
    if (f->have_margin) {
        qsort(f->items, (size_t)f->count, sizeof *f->items, by_cost);
    }
}

/* Measures the answer on the variants that were held out, and sets the checks again. */
static void validate(pl_tuner *t)
{
    pl_subject subject = pl_tuner_trial(t, "final", t->best.trial);
    json_array_clear(t->checks);
    t->missed = 0;
    for (int i = 0; i < pl_variants_held_out.count; ++i) {
        subject.variant = &pl_variants_held_out.items[i];
        pl_tuner_measure(t, &subject, 1, 1);
        for (int p = 0; p < t->case_count; ++p) {
            const json_t *row = pl_tuner_row(t, &subject, p, 0);
            const double excess = pl_targets_excess(&t->targets, row);
            if (row != NULL) {
                json_array_append_new(
                    t->checks, json_pack("{s:s, s:s, s:O, s:o, s:f}", "scenario",
                                         pl_tuner_scenario(t, p), "variant", subject.variant->name,
                                         "outcome", json_object_get(row, "outcome"), "metrics",
                                         pl_targets_values(&t->targets, row), "excess", excess));
                t->missed += excess > 0;
            }
        }
    }
}

/* Takes the first finalist that misses no target in validation, or else the first of all. */
static void take_valid(pl_tuner *t, const finalists *f)
{
    bool done = false;
    for (int k = 0; k <= f->count && !done; ++k) {
        t->best = f->items[k % f->count].evaluation;
        t->cost = f->items[k % f->count].cost;
        if (t->met) {
            validate(t);
        }
        done = !t->met || t->missed == 0;
        t->passed_over = done ? k : 0;
    }
}

void pl_tuner_choose(pl_tuner *t)
{
    finalists f = {.count = 0};
    find_finalists(t, &f);
    if (f.count > 0) {
        t->met = f.items[0].evaluation.holds;
        t->has_margin = f.have_margin;
        measure_finalists(t, &f);
        take_valid(t, &f);
    }
}
