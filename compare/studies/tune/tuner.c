/* Measurements of settings next to the default settings, and the evaluations of the search. */
#include "tuner.h"

#include "base/statistics.h"
#include "studies/tunable.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_REPEATS = 64 };

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

/* Runs that take much longer than those of the best evaluation so far are cut short. */
static pl_limits limits_of(const pl_tuner *t)
{
    const double patience = 5, least = 2;
    pl_limits limits = t->def->limits;
    if (t->tuning->found.met) {
        limits.timeout = fmin(limits.timeout, fmax(least, patience * t->best_seconds));
    }
    return limits;
}

pl_status pl_tuner_measure(pl_tuner *t, pl_tuner_runs runs, pl_readings *readings, pl_error *error)
{
    const pl_tune_def *def = t->def;
    const pl_measure_def measured = {.plan = def->plan,
                                     .variant =
                                         runs.variant == NULL ? &pl_variant_none : runs.variant,
                                     .settings = runs.settings,
                                     .setting_count = runs.count,
                                     .repeats = runs.repeats == 0 ? 1 : runs.repeats,
                                     .first_repeat = runs.first_repeat,
                                     .targets = def->targets,
                                     .jobs = def->jobs,
                                     .limits = limits_of(t),
                                     .provenance = def->provenance,
                                     .store = def->store,
                                     .bar = t->shows ? &t->bar : NULL};
    return pl_measure(&measured, readings, &t->tuning->runs, &t->tuning->signal_number, error);
}

pl_setting pl_tuner_setting(const pl_tuner *t, const double *values)
{
    pl_setting setting;
    setting.choice = pl_tune_choice(t->def->space, values, &setting.dt);
    return setting;
}

static double cost_or_none(double cost)
{
    return isfinite(cost) ? cost : (double)INFINITY;
}

double pl_tuner_cost(const pl_tuner *t, const pl_reading *mine, const pl_reading *defaults,
                     int first, int repeats)
{
    const int cases = t->def->plan->case_count;
    double sum = 0;
    for (int p = 0; p < cases; ++p) {
        sum += log(pl_score_ratio(&mine[p], t->tuning->default_has_cost ? &defaults[p] : NULL,
                                  first, repeats));
    }
    return cost_or_none(exp(sum / cases));
}

/* The same for the instructions of the first repeat. */
static double instructions_ratio(const pl_tuner *t, const pl_reading *mine)
{
    const int cases = t->def->plan->case_count;
    double sum = 0;
    for (int p = 0; p < cases; ++p) {
        sum += log(mine[p].instructions[0] / t->default_instructions[p]);
    }
    return cost_or_none(exp(sum / cases));
}

double pl_tuner_excess(const pl_tuner *t, const pl_reading *readings)
{
    double excess = -PL_SEARCH_WORST;
    for (int p = 0; p < t->def->plan->case_count; ++p) {
        excess = fmax(excess, readings[p].target.excess);
    }
    return excess;
}

pl_status pl_evaluate_defaults(pl_tuner *t, pl_error *error)
{
    pl_readings readings;
    pl_tuning *tuning = t->tuning;
    pl_status status = pl_tuner_measure(t, (pl_tuner_runs){.settings = &t->defaults, .count = 1},
                                        &readings, error);
    tuning->by_instructions = tuning->default_has_cost = true;
    for (int p = 0; p < readings.case_count && status == PL_OK && tuning->signal_number == 0; ++p) {
        const pl_reading *reading = &pl_readings_of(&readings, 0)[p];
        if (reading->is_absent) {
            status = pl_fail(error, PL_UNSUPPORTED, "%s does not do %s",
                             t->defaults.choice.engine->name, t->def->plan->cases[p].name);
        }
        t->default_instructions[p] = reading->instructions[0];
        tuning->by_instructions = tuning->by_instructions && isfinite(reading->instructions[0]);
        tuning->default_has_cost = tuning->default_has_cost && isfinite(reading->seconds[0]);
    }
    pl_readings_free(&readings);
    return status;
}

/* Whether the cost may turn out to be the lowest when it is measured again. */
static bool may_be_best(const pl_tuner *t, const pl_evaluation *evaluation)
{
    const double near_enough = 1.25;
    const pl_search_result *found = &t->tuning->found;
    return !found->met || evaluation->cost <= near_enough * found->evaluations[found->best].cost;
}

pl_status pl_evaluation_judge(pl_tuner *t, const pl_setting *setting, const pl_reading *asked,
                              pl_variants variants, pl_evaluation *evaluation, pl_error *error)
{
    pl_status status = PL_OK;
    for (int p = 0; p < t->def->plan->case_count; ++p) {
        t->spreads[p] = (pl_spread){.count = 0};
        pl_spread_add(&t->spreads[p], asked[p].target.excess);
    }
    double worst = pl_tuner_excess(t, asked);
    for (int i = 0; i < variants.count && status == PL_OK && worst <= 0; ++i) {
        const pl_tuner_runs runs = {.settings = setting, .count = 1, .variant = &variants.items[i]};
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
        if (t->tuning->signal_number != 0) {
            return status;
        }
    }
    evaluation->holds = worst <= 0;
    evaluation->excess = fmin(worst, PL_SEARCH_WORST);
    for (int p = 0; p < t->def->plan->case_count && evaluation->holds; ++p) {
        evaluation->excess = fmax(evaluation->excess, pl_spread_likely(&t->spreads[p]));
    }
    return status;
}

/* Writes one line per evaluation where progress is not shown on a terminal. */
static void log_evaluation(const pl_tuner *t, const pl_setting *setting,
                           const pl_evaluation *evaluation)
{
    char spec[PL_SPEC_SIZE], step[32] = "";
    if (!t->shows || t->bar.terminal) {
        return;
    }
    pl_tune_spec(&setting->choice, spec);
    if (!isnan(setting->dt)) {
        snprintf(step, sizeof step, " at 1/%.4g s", 1 / setting->dt);
    }
    fprintf(t->def->progress, "[%d/%d] %s%s: cost x %.3g, ", t->tuning->found.count + 1,
            t->def->budget, spec, step, evaluation->cost);
    if (evaluation->excess >= PL_SEARCH_WORST) {
        fprintf(t->def->progress, "no value\n");
    } else {
        fprintf(t->def->progress, "%s by a factor of %.3g%s\n",
                evaluation->holds && evaluation->excess <= 0 ? "meets the target"
                                                             : "misses the target",
                exp(fabs(evaluation->excess)),
                evaluation->holds && evaluation->excess > 0 ? ", likely" : "");
    }
}

/* The CPU time of the engine's steps in all runs of the readings. It is that of the results, so that a search that
 * is continued takes the same way. */
static double seconds_of(const pl_tuner *t, const pl_readings *readings)
{
    const int cases = readings->case_count;
    double sum = 0;
    for (int i = 0; i < readings->setting_count * cases; ++i) {
        const double rate = readings->items[i].is_there ? readings->items[i].seconds[0] : 0;
        sum += isfinite(rate) ? rate * t->def->plan->cases[i % cases].scene.duration : 0;
    }
    return sum;
}

/* Measures one repeat. A setting that also meets the targets on the changed scenarios is timed by
 * more repeats. The default settings run next to it, so that drift of the machine affects both. */
pl_status pl_evaluation_make(void *user, pl_evaluation *evaluation, bool *stop, pl_error *error)
{
    pl_tuner *t = user;
    pl_tuning *tuning = t->tuning;
    const bool counted = tuning->by_instructions;
    const pl_setting settings[2] = {pl_tuner_setting(t, evaluation->values), t->defaults};
    pl_tuner_runs runs = {.settings = settings, .count = counted ? 1 : 2};
    pl_readings readings;
    pl_status status = pl_tuner_measure(t, runs, &readings, error);
    const double seconds = status == PL_OK ? seconds_of(t, &readings) : 0;
    if (status == PL_OK) {
        const pl_reading *mine = pl_readings_of(&readings, 0);
        evaluation->cost = counted ? instructions_ratio(t, mine)
                                   : pl_tuner_cost(t, mine, pl_readings_of(&readings, 1), 0, 1);
    }
    const bool is_near = may_be_best(t, evaluation);
    if (status == PL_OK && tuning->signal_number == 0) {
        status = pl_evaluation_judge(t, &settings[0], pl_readings_of(&readings, 0),
                                     is_near ? pl_variants_tuned_on : (pl_variants){.count = 0},
                                     evaluation, error);
    }
    pl_readings_free(&readings);
    if (status == PL_OK && tuning->signal_number == 0 && evaluation->holds && is_near && !counted) {
        runs.first_repeat = 1;
        runs.repeats = PL_TUNER_REPEATS;
        status = pl_tuner_measure(t, runs, &readings, error);
        if (status == PL_OK) {
            evaluation->cost = pl_tuner_cost(t, pl_readings_of(&readings, 0),
                                             pl_readings_of(&readings, 1), 1, PL_TUNER_REPEATS);
        }
        pl_readings_free(&readings);
    }
    *stop = tuning->signal_number != 0;
    const pl_search_result *found = &tuning->found;
    if (evaluation->excess <= 0 &&
        (!found->met || evaluation->cost < found->evaluations[found->best].cost)) {
        t->best_seconds = seconds;
    }
    if (status == PL_OK && !*stop) {
        log_evaluation(t, &settings[0], evaluation);
    }
    return status;
}
