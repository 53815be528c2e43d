/* Costs and excesses from the readings of settings next to the default settings, and the evaluations of the search. */
#include "tuner.h"

#include "base/heap.h"
#include "base/statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_REPEATS = 64 };

pl_tuner pl_tuner_begin(json_t *study, pl_error *error)
{
    pl_tuner t = {.study = json_incref(study),
                  .rows = json_object(),
                  .points = json_array(),
                  .moved = json_array(),
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
    t.default_instructions = pl_heap_new((size_t)t.case_count + 1, sizeof *t.default_instructions);
    t.spreads = pl_heap_new((size_t)t.case_count + 1, sizeof *t.spreads);
    return t;
}

void pl_tuner_free(pl_tuner *t)
{
    json_decref(t->study);
    json_decref(t->rows);
    json_decref(t->points);
    json_decref(t->moved);
    json_decref(t->checks);
    free(t->default_instructions);
    free(t->spreads);
    free(t->found.evaluations);
    pl_readings_free(&t->final);
}

/* ---- Costs and excesses ---- */

double pl_score_ratio(const pl_reading *reading, const pl_reading *other, int first, int repeats)
{
    double ratios[MOST_REPEATS];
    int count = 0;
    for (int i = first; i < repeats && count < MOST_REPEATS; ++i) {
        const double ratio = reading->seconds[i] / (other == NULL ? 1 : other->seconds[i]);
        if (isfinite(ratio)) {
            ratios[count++] = ratio;
        }
    }
    return pl_median(ratios, count);
}

void pl_spread_add(pl_spread *spread, double excess)
{
    const double much = -3; /* ln(1 / 20) */
    const double value = fmax(excess, much);
    spread->count += 1;
    spread->sum += value;
    spread->squares += value * value;
}

double pl_spread_likely(const pl_spread *spread)
{
    const double mean = spread->sum / spread->count;
    const double variance = spread->squares / spread->count - mean * mean;
    const double unbiased =
        spread->count > 1 ? variance * spread->count / (spread->count - 1.0) : 0;
    return mean + 2 * sqrt(fmax(unbiased, 0));
}

static double cost_or_none(double cost)
{
    return isfinite(cost) ? cost : (double)INFINITY;
}

double pl_tuner_cost(const pl_tuner *t, const pl_reading *mine, const pl_reading *defaults,
                     int first, int repeats)
{
    double sum = 0;
    for (int p = 0; p < t->case_count; ++p) {
        sum += log(
            pl_score_ratio(&mine[p], t->default_has_cost ? &defaults[p] : NULL, first, repeats));
    }
    return cost_or_none(exp(sum / t->case_count));
}

/* The same for the instructions of the first repeat. */
static double instructions_ratio(const pl_tuner *t, const pl_reading *mine)
{
    double sum = 0;
    for (int p = 0; p < t->case_count; ++p) {
        sum += log(mine[p].instructions[0] / t->default_instructions[p]);
    }
    return cost_or_none(exp(sum / t->case_count));
}

double pl_tuner_excess(const pl_tuner *t, const pl_reading *readings)
{
    double excess = -PL_SEARCH_WORST;
    for (int p = 0; p < t->case_count; ++p) {
        excess = fmax(excess, readings[p].target.excess);
    }
    return excess;
}

/* ---- Evaluations ---- */

pl_subject pl_tuner_trial(const pl_tuner *t, int trial)
{
    return (pl_subject){trial, json_array_get(t->points, (size_t)trial)};
}

pl_status pl_evaluate_defaults(pl_tuner *t, pl_error *error)
{
    const pl_subject defaults = {.trial = -1};
    pl_readings readings;
    pl_status status = pl_tuner_measure(
        t, (pl_tuner_runs){.phase = "search", .subjects = &defaults, .count = 1}, &readings, error);
    t->by_instructions = t->default_has_cost = true;
    for (int p = 0; p < readings.case_count && status == PL_OK && t->signal_number == 0; ++p) {
        const pl_reading *reading = &pl_readings_of(&readings, 0)[p];
        if (reading->is_absent) {
            status = pl_fail(error, PL_UNSUPPORTED, "%s does not do %s",
                             pl_json_get_text(pl_tuner_row(t, "search", defaults, p), "engine"),
                             json_string_value(json_array_get(
                                 json_object_get(t->study, "scenarios"), (size_t)p)));
        }
        t->default_instructions[p] = reading->instructions[0];
        t->by_instructions = t->by_instructions && isfinite(reading->instructions[0]);
        t->default_has_cost = t->default_has_cost && isfinite(reading->seconds[0]);
    }
    pl_readings_free(&readings);
    return status;
}

/* Whether the cost may turn out to be the lowest when it is measured again. */
static bool may_be_best(const pl_tuner *t, const pl_evaluation *evaluation)
{
    const double near_enough = 1.25;
    const pl_search_result *found = &t->found;
    return !found->met || evaluation->cost <= near_enough * found->evaluations[found->best].cost;
}

pl_status pl_evaluation_judge(pl_tuner *t, const pl_reading *asked, pl_variants variants,
                              pl_evaluation *evaluation, pl_error *error)
{
    const pl_subject subject = pl_tuner_trial(t, evaluation->trial);
    pl_status status = PL_OK;
    for (int p = 0; p < t->case_count; ++p) {
        t->spreads[p] = (pl_spread){.count = 0};
        pl_spread_add(&t->spreads[p], asked[p].target.excess);
    }
    double worst = pl_tuner_excess(t, asked);
    for (int i = 0; i < variants.count && status == PL_OK && worst <= 0; ++i) {
        const pl_tuner_runs runs = {
            .phase = "search", .subjects = &subject, .count = 1, .variant = &variants.items[i]};
        pl_readings readings;
        status = pl_tuner_measure(t, runs, &readings, error);
        for (int p = 0; p < readings.case_count && status == PL_OK; ++p) {
            const pl_reading *reading = &pl_readings_of(&readings, 0)[p];
            if (reading->is_there) {
                worst = fmax(worst, reading->target.excess);
                pl_spread_add(&t->spreads[p], reading->target.excess);
            }
        }
        pl_readings_free(&readings);
        if (t->signal_number != 0) {
            return status;
        }
    }
    evaluation->holds = worst <= 0;
    evaluation->excess = fmin(worst, PL_SEARCH_WORST);
    for (int p = 0; p < t->case_count && evaluation->holds; ++p) {
        evaluation->excess = fmax(evaluation->excess, pl_spread_likely(&t->spreads[p]));
    }
    return status;
}

/* The CPU time of the engine's steps in all runs of the readings. It is that of the results, so that a search that
 * is continued takes the same way. */
static double seconds_of(const pl_readings *readings)
{
    double sum = 0;
    for (int i = 0; i < readings->subject_count * readings->case_count; ++i) {
        const pl_reading *reading = &readings->items[i];
        const double rate = reading->is_there ? reading->seconds[0] : 0;
        sum += isfinite(rate) ? rate * reading->duration : 0;
    }
    return sum;
}

/* Times a setting that also meets the targets on the changed scenarios by more repeats. */
static pl_status time_again(pl_tuner *t, pl_tuner_runs runs, pl_evaluation *evaluation,
                            pl_error *error)
{
    pl_readings readings;
    runs.repeats = PL_TUNER_REPEATS;
    const pl_status status = pl_tuner_measure(t, runs, &readings, error);
    evaluation->cost = pl_tuner_cost(t, pl_readings_of(&readings, 0), pl_readings_of(&readings, 1),
                                     1, PL_TUNER_REPEATS);
    pl_readings_free(&readings);
    return status;
}

/* Measures one repeat. The default settings run next to it, so that drift of the machine affects both. */
pl_status pl_evaluation_make(pl_tuner *t, pl_evaluation *evaluation, pl_error *error)
{
    const bool counted = t->by_instructions;
    const pl_subject subjects[] = {pl_tuner_trial(t, evaluation->trial),
                                   {.trial = evaluation->trial}};
    const pl_tuner_runs runs = {.phase = "search", .subjects = subjects, .count = counted ? 1 : 2};
    pl_readings readings;
    pl_status status = pl_tuner_measure(t, runs, &readings, error);
    const pl_reading *mine = pl_readings_of(&readings, 0);
    const double seconds = seconds_of(&readings);
    evaluation->cost = counted ? instructions_ratio(t, mine)
                               : pl_tuner_cost(t, mine, pl_readings_of(&readings, 1), 0, 1);
    const bool is_near = may_be_best(t, evaluation);
    if (status == PL_OK && t->signal_number == 0) {
        status = pl_evaluation_judge(
            t, mine, is_near ? pl_variants_tuned_on : (pl_variants){.count = 0}, evaluation, error);
    }
    pl_readings_free(&readings);
    if (status == PL_OK && t->signal_number == 0 && evaluation->holds && is_near && !counted) {
        status = time_again(t, runs, evaluation, error);
    }
    const pl_search_result *found = &t->found;
    if (evaluation->excess <= 0 &&
        (!found->met || evaluation->cost < found->evaluations[found->best].cost)) {
        t->best_seconds = seconds;
    }
    return status;
}
