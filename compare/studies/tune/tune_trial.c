#include "tune_trial.h"

#include "tunable.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What is shipped, once: whether the engine does the scenarios, and what is counted there. */
pl_status measure_shipped(pl_tuner *t, pl_error *error)
{
    pl_readings readings;
    pl_tuning *tuning = t->tuning;
    pl_status status =
        pl_tuner_measure(t, &pl_variant_none, &t->shipped, 1, 0, 1, &readings, error);
    tuning->by_instructions = tuning->shipped_has_cost = true;
    for (int p = 0; p < readings.problem_count && status == PL_OK && tuning->signal_number == 0;
         ++p) {
        const pl_reading *reading = &pl_readings_of(&readings, 0)[p];
        if (reading->is_absent) {
            status = pl_fail(error, PL_UNSUPPORTED, "%s does not do %s",
                             t->shipped.choice.engine->name, t->def->plan->cases[p].name);
        }
        t->shipped_instructions[p] = reading->instructions[0];
        tuning->by_instructions = tuning->by_instructions && isfinite(reading->instructions[0]);
        tuning->shipped_has_cost = tuning->shipped_has_cost && isfinite(reading->seconds[0]);
    }
    pl_readings_free(&readings);
    return status;
}

/* What costs much more than the best so far needs no second look, and is no finalist. */
static bool may_be_best(const pl_tuner *t, const pl_evaluation *evaluation)
{
    const pl_search_result *found = &t->tuning->found;
    return !found->met || pl_tuner_is_near(evaluation->cost, found->evaluations[found->best].cost);
}

pl_status pl_evaluation_judge(pl_tuner *t, const pl_setting *setting, const pl_reading *asked,
                              const pl_variant *variants, int count, pl_evaluation *evaluation,
                              pl_error *error)
{
    pl_status status = PL_OK;
    for (int p = 0; p < t->def->plan->case_count; ++p) {
        t->spreads[p] = (pl_spread){.count = 0};
        pl_spread_add(&t->spreads[p], asked[p].target.excess);
    }
    double worst = pl_tuner_excess(t, asked);
    for (int i = 0; i < count && status == PL_OK && worst <= 0; ++i) {
        pl_readings readings;
        status = pl_tuner_measure(t, &variants[i], setting, 1, 0, 1, &readings, error);
        for (int p = 0; p < readings.problem_count && status == PL_OK; ++p) {
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
    for (int p = 0; p < t->def->plan->problem_count && evaluation->holds; ++p) {
        evaluation->excess = fmax(evaluation->excess, pl_spread_likely(&t->spreads[p]));
    }
    return status;
}

/* A line a evaluation, where there is no terminal whose line could be drawn again. */
static void log_evaluation(const pl_tuner *t, const pl_setting *setting,
                           const pl_evaluation *evaluation)
{
    char spec[256], step[32] = "";
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

/* One repeat; a setting that meets the targets also on the changed scenarios is timed by more.
 * What is shipped runs beside it, so that a machine that drifts does so for both. */
pl_status pl_evaluation_make(void *user, pl_evaluation *evaluation, bool *stop, pl_error *error)
{
    pl_tuner *t = user;
    pl_tuning *tuning = t->tuning;
    const bool counted = tuning->by_instructions;
    const pl_setting settings[2] = {pl_tuner_setting(t, evaluation->values), t->shipped};
    const double began = pl_monotonic_seconds();
    pl_readings readings;
    pl_status status =
        pl_tuner_measure(t, &pl_variant_none, settings, counted ? 1 : 2, 0, 1, &readings, error);
    const double seconds = pl_monotonic_seconds() - began;
    if (status == PL_OK) {
        const pl_reading *mine = pl_readings_of(&readings, 0);
        evaluation->cost = counted ? pl_tuner_instructions(t, mine)
                                   : pl_tuner_cost(t, mine, pl_readings_of(&readings, 1), 0, 1);
    }
    const bool is_near = may_be_best(t, evaluation);
    if (status == PL_OK && tuning->signal_number == 0) {
        int count = 0;
        const pl_variant *variants = pl_variants_tuned_on(&count);
        status = pl_evaluation_judge(t, &settings[0], pl_readings_of(&readings, 0), variants,
                                     is_near ? count : 0, evaluation, error);
    }
    pl_readings_free(&readings);
    if (status == PL_OK && tuning->signal_number == 0 && evaluation->holds && is_near && !counted) {
        status = pl_tuner_measure(t, &pl_variant_none, settings, 2, 1, PL_TUNER_REPEATS, &readings,
                                  error);
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
