#include "tune/tune.h"

#include "tune/score.h"
#include "tune/tunable.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Repeats of a setting that meets the targets, of which the first does not count. */
enum { SEARCH_REPEATS = 4, MOST_SETTINGS = 2 * PL_TUNE_MOST_AXES + 1 };

/* Costs that differ by less may be the same. */
static const double near_enough = 1.25;

typedef struct tuner {
    const pl_tune_def *def;
    pl_tuning *tuning;
    pl_progress bar;
    bool shows;
    pl_setting shipped;
    pl_spread *spreads;           /* (problem_count): of the trial in progress */
    double *shipped_instructions; /* (problem_count): per simulated second; NAN: not counted */
    double best_seconds;          /* wall time of the first runs of the best trial */
} tuner;

/* What takes much longer than the best so far costs more, and need not come to its end. */
static pl_limits limits_of(const tuner *t)
{
    const double patience = 5, least = 2;
    pl_limits limits = t->def->limits;
    if (t->tuning->found.met) {
        limits.timeout = fmin(limits.timeout, fmax(least, patience * t->best_seconds));
    }
    return limits;
}

static pl_status measure(tuner *t, const pl_variant *variant, const pl_setting *settings, int count,
                         int first_repeat, int repeats, pl_readings *readings, pl_error *error)
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

static pl_setting setting_of(const tuner *t, const double *values)
{
    pl_setting setting;
    setting.choice = pl_tune_choice(t->def->space, values, &setting.dt);
    return setting;
}

/* What is shipped, once: whether the engine does the scenarios, and what is counted there. */
static pl_status try_shipped(tuner *t, pl_error *error)
{
    pl_readings readings;
    pl_tuning *tuning = t->tuning;
    pl_status status = measure(t, &pl_variant_none, &t->shipped, 1, 0, 1, &readings, error);
    tuning->by_instructions = tuning->shipped_has_cost = true;
    for (int p = 0; p < readings.problem_count && status == PL_OK && tuning->signal_number == 0;
         ++p) {
        const pl_reading *reading = &pl_readings_of(&readings, 0)[p];
        if (reading->is_absent) {
            status = pl_fail(error, PL_UNSUPPORTED, "%s does not do %s",
                             t->shipped.choice.engine->name, t->def->plan->problems[p].name);
        }
        t->shipped_instructions[p] = reading->instructions[0];
        tuning->by_instructions = tuning->by_instructions && isfinite(reading->instructions[0]);
        tuning->shipped_has_cost = tuning->shipped_has_cost && isfinite(reading->seconds[0]);
    }
    pl_readings_free(&readings);
    return status;
}

static double cost_or_none(double cost)
{
    return isfinite(cost) ? cost : (double)INFINITY;
}

/* By the CPU time beside that of what is shipped, repeat by repeat. */
static double cost_of(const tuner *t, const pl_reading *mine, const pl_reading *shipped, int first,
                      int repeats)
{
    const int problems = t->def->plan->problem_count;
    double sum = 0;
    for (int p = 0; p < problems; ++p) {
        sum += log(pl_score_ratio(&mine[p], t->tuning->shipped_has_cost ? &shipped[p] : NULL, first,
                                  repeats));
    }
    return cost_or_none(exp(sum / problems));
}

static double instructions_of(const tuner *t, const pl_reading *mine)
{
    const int problems = t->def->plan->problem_count;
    double sum = 0;
    for (int p = 0; p < problems; ++p) {
        sum += log(mine[p].instructions[0] / t->shipped_instructions[p]);
    }
    return cost_or_none(exp(sum / problems));
}

static double excess_of(const tuner *t, const pl_reading *readings)
{
    double excess = -PL_SEEK_WORST;
    for (int p = 0; p < t->def->plan->problem_count; ++p) {
        excess = fmax(excess, readings[p].target.excess);
    }
    return excess;
}

/* What costs much more than the best so far needs no second look, and is no finalist. */
static bool may_be_best(const tuner *t, const pl_seek_trial *trial)
{
    const pl_seek_found *found = &t->tuning->found;
    return !found->met || trial->cost <= near_enough * found->trials[found->best].cost;
}

/* The scenarios as asked for, whose readings are given, and changed. */
static pl_status judge(tuner *t, const pl_setting *setting, const pl_reading *asked,
                       pl_seek_trial *trial, pl_error *error)
{
    int count = 0;
    const pl_variant *variants = pl_variants_tuned_on(&count);
    pl_status status = PL_OK;
    for (int p = 0; p < t->def->plan->problem_count; ++p) {
        t->spreads[p] = (pl_spread){.count = 0};
        pl_spread_add(&t->spreads[p], asked[p].target.excess);
    }
    double worst = excess_of(t, asked);
    const int needed = worst <= 0 && may_be_best(t, trial) ? count : 0;
    for (int i = 0; i < needed && status == PL_OK && worst <= 0; ++i) {
        pl_readings readings;
        status = measure(t, &variants[i], setting, 1, 0, 1, &readings, error);
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
    trial->holds = worst <= 0;
    trial->excess = fmin(worst, PL_SEEK_WORST);
    for (int p = 0; p < t->def->plan->problem_count && trial->holds; ++p) {
        trial->excess = fmax(trial->excess, pl_spread_likely(&t->spreads[p]));
    }
    return status;
}

/* A line a trial, where there is no terminal whose line could be drawn again. */
static void tell(const tuner *t, const pl_setting *setting, const pl_seek_trial *trial)
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
            t->def->budget, spec, step, trial->cost);
    if (trial->excess >= PL_SEEK_WORST) {
        fprintf(t->def->progress, "no value\n");
    } else {
        fprintf(t->def->progress, "%s by a factor of %.3g%s\n",
                trial->holds && trial->excess <= 0 ? "meets the target" : "misses the target",
                exp(fabs(trial->excess)), trial->holds && trial->excess > 0 ? ", likely" : "");
    }
}

/* One repeat; a setting that meets the targets also on the changed scenarios is timed by more.
 * What is shipped runs beside it, so that a machine that drifts does so for both. */
static pl_status try_setting(void *user, pl_seek_trial *trial, bool *stop, pl_error *error)
{
    tuner *t = user;
    pl_tuning *tuning = t->tuning;
    const bool counted = tuning->by_instructions;
    const pl_setting settings[2] = {setting_of(t, trial->values), t->shipped};
    const double began = pl_monotonic_seconds();
    pl_readings readings;
    pl_status status =
        measure(t, &pl_variant_none, settings, counted ? 1 : 2, 0, 1, &readings, error);
    const double seconds = pl_monotonic_seconds() - began;
    if (status == PL_OK) {
        const pl_reading *mine = pl_readings_of(&readings, 0);
        trial->cost = counted ? instructions_of(t, mine)
                              : cost_of(t, mine, pl_readings_of(&readings, 1), 0, 1);
    }
    const bool is_near = may_be_best(t, trial);
    if (status == PL_OK && tuning->signal_number == 0) {
        status = judge(t, &settings[0], pl_readings_of(&readings, 0), trial, error);
    }
    pl_readings_free(&readings);
    if (status == PL_OK && tuning->signal_number == 0 && trial->holds && is_near && !counted) {
        status = measure(t, &pl_variant_none, settings, 2, 1, SEARCH_REPEATS, &readings, error);
        if (status == PL_OK) {
            trial->cost = cost_of(t, pl_readings_of(&readings, 0), pl_readings_of(&readings, 1), 1,
                                  SEARCH_REPEATS);
        }
        pl_readings_free(&readings);
    }
    *stop = tuning->signal_number != 0;
    const pl_seek_found *found = &tuning->found;
    if (trial->excess <= 0 && (!found->met || trial->cost < found->trials[found->best].cost)) {
        t->best_seconds = seconds;
    }
    if (status == PL_OK && !*stop) {
        tell(t, &settings[0], trial);
    }
    return status;
}

static int by_merit(const void *left, const void *right)
{
    const pl_seek_trial *a = left, *b = right;
    return pl_seek_better(a, b) ? -1 : pl_seek_better(b, a);
}

/* Measures the best trials again, in turns with what is shipped, and takes the cheapest. */
static pl_status choose(tuner *t, pl_error *error)
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
    tuning->has_margin = tuning->found.met;
    while (count < tuning->found.count && count < PL_TUNE_FINALISTS &&
           (count == 0 || (sorted[count].excess <= 0 && !tuning->by_instructions &&
                           sorted[count].cost <= near_enough * sorted[0].cost))) {
        settings[count + 1] = setting_of(t, sorted[count].values);
        count += 1;
    }
    pl_status status =
        measure(t, &pl_variant_none, settings, count + 1, 0, PL_TUNE_REPEATS, &readings, error);
    for (int i = 0; i < count && status == PL_OK && tuning->signal_number == 0; ++i) {
        const double cost = cost_of(t, pl_readings_of(&readings, i + 1),
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
static pl_status slope(tuner *t, pl_error *error)
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
            settings[count + 1] = setting_of(t, values);
            tuning->slopes[count++] = (pl_tune_slope){.axis = axis, .value = values[axis]};
        }
    }
    pl_status status =
        count == 0 ? PL_OK
                   : measure(t, &pl_variant_none, settings, count + 1, 0,
                             tuning->by_instructions ? 1 : SEARCH_REPEATS, &readings, error);
    if (count == 0 || status != PL_OK || tuning->signal_number != 0) {
        goto done;
    }
    tuning->slope_count = count;
    for (int i = 0; i < count; ++i) {
        const pl_reading *mine = pl_readings_of(&readings, i + 1);
        tuning->slopes[i].excess = excess_of(t, mine);
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
static pl_status validate(tuner *t, pl_error *error)
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
        status = measure(t, &variants[i], &tuning->setting, 1, 0, 1, &readings, error);
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

/* What a search of this budget makes of runs, about: for the bar. */
static long expected_runs(const pl_tune_def *def)
{
    return (long)def->plan->problem_count * def->budget * 3;
}

static pl_status search(tuner *t, pl_error *error)
{
    const pl_tune_def *def = t->def;
    const pl_seek_def seek = {.axes = def->space->axes,
                              .axis_count = def->space->axis_count,
                              .budget = def->budget,
                              .seed = def->plan->seed,
                              .user = t,
                              .measure = try_setting};
    pl_tuning *tuning = t->tuning;
    pl_status status = try_shipped(t, error);
    if (status == PL_OK && tuning->signal_number == 0) {
        status = pl_seek(&seek, &tuning->found, error);
    }
    if (status == PL_OK && tuning->signal_number == 0) {
        status = choose(t, error);
    }
    if (status == PL_OK && tuning->signal_number == 0) {
        status = slope(t, error);
    }
    if (status == PL_OK && tuning->signal_number == 0 && tuning->met) {
        status = validate(t, error);
    }
    return status;
}

pl_status pl_tune(const pl_tune_def *def, pl_tuning *tuning, pl_error *error)
{
    *tuning = (pl_tuning){.found = {.best = -1}};
    tuner t = {.def = def, .tuning = tuning, .shows = def->progress != NULL};
    const size_t problems = (size_t)def->plan->problem_count;
    t.shipped.dt = (double)NAN;
    t.shipped_instructions = calloc(problems, sizeof *t.shipped_instructions);
    t.spreads = calloc(problems, sizeof *t.spreads);
    tuning->scores = calloc(problems, sizeof *tuning->scores);
    pl_status status = t.shipped_instructions == NULL || t.spreads == NULL || tuning->scores == NULL
                           ? pl_fail(error, PL_NO_MEMORY, "out of memory")
                           : pl_tune_shipped(&def->space->base, &t.shipped.choice, error);
    if (t.shows) {
        t.bar = pl_progress_begin(def->progress, expected_runs(def), pl_monotonic_seconds());
    }
    if (status == PL_OK) {
        status = search(&t, error);
    }
    if (t.shows) {
        pl_progress_end(&t.bar);
    }
    free(t.spreads);
    free(t.shipped_instructions);
    return status;
}

void pl_tuning_free(pl_tuning *tuning)
{
    free(tuning->found.trials);
    free(tuning->scores);
    free(tuning->slopes);
    free(tuning->checks);
    *tuning = (pl_tuning){.runs = 0};
}
