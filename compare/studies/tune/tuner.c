#include "tuner.h"

#include <math.h>

/* What takes much longer than the best so far costs more, and need not come to its end. */
static pl_limits limits_of(const pl_tuner *t)
{
    const double patience = 5, least = 2;
    pl_limits limits = t->def->limits;
    if (t->tuning->found.met) {
        limits.timeout = fmin(limits.timeout, fmax(least, patience * t->best_seconds));
    }
    return limits;
}

pl_status pl_tuner_measure(pl_tuner *t, const pl_variant *variant, const pl_setting *settings,
                           int count, int first_repeat, int repeats, pl_readings *readings,
                           pl_error *error)
{
    const pl_tune_def *def = t->def;
    const pl_measure_def measured = {.plan = def->plan,
                                     .dt = def->dt,
                                     .duration = def->duration,
                                     .variant = variant,
                                     .settings = settings,
                                     .setting_count = count,
                                     .repeats = repeats,
                                     .first_repeat = first_repeat,
                                     .targets = def->targets,
                                     .jobs = def->jobs,
                                     .limits = limits_of(t),
                                     .provenance = def->provenance,
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

double pl_tuner_cost(const pl_tuner *t, const pl_reading *mine, const pl_reading *shipped,
                     int first, int repeats)
{
    const int problems = t->def->plan->case_count;
    double sum = 0;
    for (int p = 0; p < problems; ++p) {
        sum += log(pl_score_ratio(&mine[p], t->tuning->shipped_has_cost ? &shipped[p] : NULL, first,
                                  repeats));
    }
    return cost_or_none(exp(sum / problems));
}

double pl_tuner_instructions(const pl_tuner *t, const pl_reading *mine)
{
    const int problems = t->def->plan->case_count;
    double sum = 0;
    for (int p = 0; p < problems; ++p) {
        sum += log(mine[p].instructions[0] / t->shipped_instructions[p]);
    }
    return cost_or_none(exp(sum / problems));
}

double pl_tuner_excess(const pl_tuner *t, const pl_reading *readings)
{
    double excess = -PL_SEARCH_WORST;
    for (int p = 0; p < t->def->plan->problem_count; ++p) {
        excess = fmax(excess, readings[p].target.excess);
    }
    return excess;
}

bool pl_tuner_is_near(double cost, double best)
{
    const double near_enough = 1.25;
    return cost <= near_enough * best;
}
