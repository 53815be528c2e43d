/* Targets, and the plan and the results of the runs that measure settings. */
#include "tune_measure.h"

#include "results/result.h"
#include "tune_search.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The excess that a run whose outcome is not ok adds to that of its numbers. */
static const double failed_run = 2;

static pl_status fail_metric(const char *name, pl_error *error)
{
    const char *names[PL_METRIC_COUNT];
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        names[i] = pl_metric_table[i].name;
    }
    char suggestion[PL_SUGGESTION_SIZE];
    pl_did_you_mean(name, names, PL_METRIC_COUNT, suggestion);
    return pl_fail(error, PL_BAD_INPUT, "--target: there is no metric %s%s", name,
                   suggestion[0] == '\0' ? "; see plumb list metrics" : suggestion);
}

pl_status pl_target_add(pl_targets *targets, const char *text, pl_error *error)
{
    char name[PL_NAME_SIZE];
    const size_t length = strcspn(text, "<>=!");
    const char *sign = text + length;
    const bool strict = sign[0] == '<' && sign[1] != '=';
    pl_target target = {.strict = strict};
    if (sign[0] != '<' || length == 0 || length >= sizeof name) {
        return pl_fail(error, PL_BAD_INPUT,
                       "--target takes METRIC<=VALUE or METRIC<VALUE; found \"%.200s\"", text);
    }
    memcpy(name, text, length);
    name[length] = '\0';
    target.metric = pl_metric_by_name(name);
    if (target.metric < 0) {
        return fail_metric(name, error);
    }
    if (pl_metric_table[target.metric].direction != PL_LOWER_IS_BETTER) {
        return pl_fail(error, PL_BAD_INPUT, "--target: of %s lower is not better", name);
    }
    if (!pl_parse_number(sign + (strict ? 1 : 2), &target.bound) || !(target.bound > 0)) {
        return pl_fail(error, PL_BAD_INPUT, "--target %s: expected a positive number, found \"%s\"",
                       name, sign + (strict ? 1 : 2));
    }
    if (targets->count == PL_TUNE_MOST_TARGETS) {
        return pl_fail(error, PL_BAD_INPUT, "--target: more than %d", (int)PL_TUNE_MOST_TARGETS);
    }
    targets->items[targets->count++] = target;
    return PL_OK;
}

void pl_target_text(const pl_target *target, char text[96])
{
    snprintf(text, 96, "%s%s%.6g", pl_metric_table[target->metric].name,
             target->strict ? "<" : "<=", target->bound);
}

static double excess_of(const pl_target *target, double value)
{
    if (!isfinite(value)) {
        return PL_SEARCH_WORST;
    }
    if (value <= 0) {
        return -PL_SEARCH_WORST;
    }
    const double excess = log(value / target->bound);
    /* Rounding of the quotient must not decide whether the target is met. */
    if (value > target->bound || (target->strict && value >= target->bound)) {
        return fmin(fmax(excess, DBL_EPSILON), PL_SEARCH_WORST);
    }
    return fmax(fmin(excess, 0), -PL_SEARCH_WORST);
}

pl_target_reading pl_target_read(const pl_targets *targets, const json_t *result)
{
    pl_target_reading reading = {.excess = -PL_SEARCH_WORST};
    for (int i = 0; i < targets->count; ++i) {
        const pl_target *target = &targets->items[i];
        reading.values[i] = pl_result_metric(result, pl_metric_table[target->metric].name);
        reading.excess = fmax(reading.excess, excess_of(target, reading.values[i]));
    }
    if (strcmp(pl_json_get_text(result, "outcome"), "ok") != 0) {
        reading.excess = fmin(fmax(reading.excess, 0) + failed_run, PL_SEARCH_WORST);
    }
    return reading;
}

/* A run of the plan, and where its reading goes. */
typedef struct place {
    char run[17];
    pl_reading *reading;
    int repeat;
    bool filled;
} place;

typedef struct gatherer {
    const pl_measure_def *def;
    pl_plan plan;
    pl_readings *readings;
    pl_reading **of_pairing; /* (pairing_count of the plan) */
    place *places;           /* (size of the plan) */
    long place_count;
    long done;
} gatherer;

const pl_reading *pl_readings_of(const pl_readings *readings, int setting)
{
    return &readings->items[setting * readings->case_count];
}

void pl_readings_free(pl_readings *readings)
{
    free(readings->items);
    free(readings->numbers);
    *readings = (pl_readings){.repeats = 0};
}

static pl_status make_room(gatherer *g, pl_error *error)
{
    const pl_measure_def *def = g->def;
    pl_readings *r = g->readings;
    *r = (pl_readings){.setting_count = def->setting_count,
                       .case_count = def->plan->case_count,
                       .repeats = def->repeats};
    const size_t count = (size_t)r->setting_count * (size_t)r->case_count;
    const size_t repeats = (size_t)r->repeats;
    r->items = calloc(count, sizeof *r->items);
    r->numbers = calloc(2 * count * repeats, sizeof *r->numbers);
    g->of_pairing = calloc(count, sizeof(pl_reading *));
    g->places = calloc(count * repeats, sizeof *g->places);
    if (r->items == NULL || r->numbers == NULL || g->of_pairing == NULL || g->places == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %zu runs", count * repeats);
    }
    for (size_t i = 0; i < count; ++i) {
        r->items[i].seconds = &r->numbers[2 * i * repeats];
        r->items[i].instructions = r->items[i].seconds + repeats;
        r->items[i].target.excess = PL_SEARCH_WORST;
        for (size_t k = 0; k < 2 * repeats; ++k) {
            r->items[i].seconds[k] = (double)NAN;
        }
    }
    return PL_OK;
}

/* Adds the scenario at the step to the plan; *index -1 when it cannot be built so. */
static pl_status add_scenario(gatherer *g, const pl_case *test_case, double dt, int *index,
                              pl_error *error)
{
    const pl_scenario *scenario = test_case->descriptor;
    const bool is_changed = g->def->variant->kind != PL_VARIANT_NONE || !isnan(dt);
    double values[PL_MAX_PARAMS];
    *index = -1;
    memcpy(values, test_case->params, sizeof values);
    if (!pl_variant_apply(g->def->variant, scenario, g->def->plan->seed, values)) {
        return PL_OK;
    }
    if (!isnan(dt)) {
        values[pl_scenario_param(scenario, "dt")] = dt;
    }
    pl_status status = pl_plan_add_values(&g->plan, scenario, values, index, error);
    return status == PL_BAD_INPUT && is_changed ? PL_OK : status;
}

static pl_status add_runs(gatherer *g, pl_error *error)
{
    const pl_measure_def *def = g->def;
    pl_status status = PL_OK;
    for (int s = 0; s < def->setting_count && status == PL_OK; ++s) {
        char label[PL_LABEL_SIZE];
        pl_engine_choice_label(&def->settings[s].choice, label);
        status = pl_plan_add_choice(&g->plan, &def->settings[s].choice, label, NULL, error);
    }
    for (int p = 0; p < def->plan->case_count && status == PL_OK; ++p) {
        const pl_case *test_case = &def->plan->cases[p];
        for (int s = 0; s < def->setting_count && status == PL_OK; ++s) {
            const double dt = def->settings[s].dt;
            int index = -1;
            status = add_scenario(g, test_case, dt, &index, error);
            if (status == PL_OK && index >= 0) {
                pl_reading *reading = &g->readings->items[s * def->plan->case_count + p];
                reading->is_there = true;
                g->of_pairing[g->plan.pairing_count] = reading;
                status = pl_plan_add_pairing(&g->plan, index, s, error);
            }
        }
    }
    return status;
}

/* Lists the runs of the plan with their hashes and readings. */
static pl_status name_runs(gatherer *g, pl_error *error)
{
    g->place_count = g->plan.pairing_count > 0 ? pl_plan_size(&g->plan) : 0;
    pl_status status = PL_OK;
    for (long i = 0; i < g->place_count && status == PL_OK; ++i) {
        const pl_planned_run run = pl_plan_run(&g->plan, i);
        const pl_pairing *pairing = g->plan.pairings;
        while (run.test_case != &g->plan.cases[pairing->test_case] ||
               run.configuration != &g->plan.configurations[pairing->configuration]) {
            ++pairing;
        }
        g->places[i] =
            (place){.reading = g->of_pairing[pairing - g->plan.pairings], .repeat = run.repeat};
        status = pl_planned_run_hash(&g->plan, &run, g->places[i].run, error);
    }
    return status;
}

/* A number per simulated second; NAN where it is not positive. */
static double rate_of(const json_t *result, pl_metric_id id)
{
    const double dt = json_number_value(json_object_get(json_object_get(result, "settings"), "dt"));
    const double value = pl_result_metric(result, pl_metric_table[id].name);
    return value > 0 ? value / dt : (double)NAN;
}

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    gatherer *g = user;
    const char *run = pl_json_get_text(result, "run");
    (void)error;
    for (long i = 0; i < g->place_count; ++i) {
        place *to = &g->places[i];
        /* Two settings may give the same run, which is then made twice. */
        if (to->filled || strcmp(to->run, run) != 0) {
            continue;
        }
        pl_reading *reading = to->reading;
        to->filled = true;
        reading->target = pl_target_read(g->def->targets, result);
        snprintf(reading->outcome, sizeof reading->outcome, "%s",
                 pl_json_get_text(result, "outcome"));
        reading->is_absent = strcmp(reading->outcome, "unsupported") == 0;
        reading->seconds[to->repeat] = rate_of(result, PL_METRIC_TIME_PER_STEP);
        reading->instructions[to->repeat] = rate_of(result, PL_METRIC_INSTRUCTIONS_PER_STEP);
        break;
    }
    g->done += 1;
    if (g->def->bar != NULL) {
        g->def->bar->done += 1;
        pl_progress_draw(g->def->bar, pl_json_get_text(result, "scenario"), 0,
                         pl_monotonic_seconds());
    }
    return PL_OK;
}

static bool skip(void *user, const char *run)
{
    const gatherer *g = user;
    for (long i = 0; i < g->place_count; ++i) {
        if (strcmp(g->places[i].run, run) == 0) {
            return g->places[i].repeat < g->def->first_repeat;
        }
    }
    return false;
}

pl_status pl_measure(const pl_measure_def *def, pl_readings *readings, long *runs,
                     int *signal_number, pl_error *error)
{
    const bool own_seed = def->variant->kind == PL_VARIANT_OFFSET;
    gatherer g = {.def = def, .readings = readings};
    g.plan.repeats = def->repeats;
    g.plan.seed = def->plan->seed + (own_seed ? (uint64_t)def->variant->seed : 0);
    *signal_number = 0;
    pl_status status = make_room(&g, error);
    if (status == PL_OK) {
        status = add_runs(&g, error);
    }
    if (status == PL_OK) {
        status = name_runs(&g, error);
    }
    if (status == PL_OK && g.place_count > 0) {
        const pl_execution_def execution = {.plan = &g.plan,
                                            .jobs = def->jobs,
                                            .limits = def->limits,
                                            .provenance = def->provenance,
                                            .store = def->store,
                                            .user = &g,
                                            .skip = skip,
                                            .take = keep};
        status = pl_execute(&execution, signal_number, error);
    }
    *runs += g.done;
    free(g.of_pairing);
    free(g.places);
    pl_plan_free(&g.plan);
    return status;
}
