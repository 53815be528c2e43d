#include "tune_measure.h"

#include "results/result.h"
#include "search_driver.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    return &readings->items[setting * readings->problem_count];
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
                       .problem_count = def->plan->case_count,
                       .repeats = def->repeats};
    const size_t count = (size_t)r->setting_count * (size_t)r->problem_count;
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

/* Adds the catalogue scenario at the step to the plan; *index -1 when it cannot be built so. */
static pl_status add_scenario(gatherer *g, const pl_case *problem, double dt, int *index,
                              pl_error *error)
{
    const pl_scenario *scenario = problem->descriptor;
    const bool is_changed = g->def->variant->kind != PL_VARIANT_NONE || !isnan(dt);
    double values[PL_MAX_PARAMS];
    char texts[PL_MAX_PARAMS][PL_NAME_SIZE + 32];
    const char *settings[PL_MAX_PARAMS];
    *index = -1;
    memcpy(values, problem->params, sizeof values);
    if (!pl_variant_apply(g->def->variant, scenario, g->def->plan->seed, values)) {
        return PL_OK;
    }
    for (int i = 0; i < scenario->param_count; ++i) {
        if (strcmp(scenario->params[i].name, "dt") == 0 && !isnan(dt)) {
            values[i] = dt;
        }
        snprintf(texts[i], sizeof texts[i], "%s=%.17g", scenario->params[i].name, values[i]);
        settings[i] = texts[i];
    }
    for (int i = 0; i < g->plan.case_count; ++i) {
        const pl_case *known = &g->plan.cases[i];
        if (known->descriptor == scenario &&
            memcmp(known->params, values, (size_t)scenario->param_count * sizeof *values) == 0) {
            *index = i;
            return PL_OK;
        }
    }
    const int before = g->plan.case_count;
    pl_status status =
        pl_plan_add_scenario(&g->plan, scenario, settings, scenario->param_count, error);
    *index = g->plan.case_count > before ? before : -1;
    return status == PL_BAD_INPUT && is_changed ? PL_OK : status;
}

static pl_status add_file(gatherer *g, const pl_case *problem, double dt, int *index,
                          pl_error *error)
{
    *index = -1;
    if (g->def->variant->kind != PL_VARIANT_NONE) {
        return PL_OK;
    }
    const double step = isnan(dt) ? problem->scene.dt : dt;
    for (int i = 0; i < g->plan.case_count; ++i) {
        if (strcmp(g->plan.cases[i].name, problem->name) == 0 &&
            g->plan.cases[i].scene.dt == step) {
            *index = i;
            return PL_OK;
        }
    }
    const int before = g->plan.case_count;
    pl_status status = pl_plan_add_scene_file(&g->plan, problem->name, isnan(dt) ? g->def->dt : dt,
                                              g->def->duration, error);
    *index = g->plan.case_count > before ? before : -1;
    return status;
}

static pl_status add_runs(gatherer *g, pl_error *error)
{
    const pl_measure_def *def = g->def;
    pl_status status = PL_OK;
    for (int s = 0; s < def->setting_count && status == PL_OK; ++s) {
        char label[128];
        pl_engine_choice_label(&def->settings[s].choice, label);
        status = pl_plan_add_choice(&g->plan, &def->settings[s].choice, label, NULL, error);
    }
    for (int p = 0; p < def->plan->case_count && status == PL_OK; ++p) {
        const pl_case *problem = &def->plan->cases[p];
        for (int s = 0; s < def->setting_count && status == PL_OK; ++s) {
            const double dt = def->settings[s].dt;
            int index = -1;
            status = problem->descriptor != NULL ? add_scenario(g, problem, dt, &index, error)
                                                 : add_file(g, problem, dt, &index, error);
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

/* Whose run it is: the pairing's of its problem and configuration. */
static pl_reading *reading_of(const gatherer *g, const pl_planned_run *run)
{
    for (int i = 0; i < g->plan.pairing_count; ++i) {
        if (run->test_case == &g->plan.cases[g->plan.pairings[i].test_case] &&
            run->configuration == &g->plan.configurations[g->plan.pairings[i].configuration]) {
            return g->of_pairing[i];
        }
    }
    return NULL;
}

static pl_status name_runs(gatherer *g, pl_error *error)
{
    g->place_count = g->plan.pairing_count > 0 ? pl_plan_size(&g->plan) : 0;
    for (long i = 0; i < g->place_count; ++i) {
        const pl_planned_run run = pl_plan_run(&g->plan, i);
        json_t *identity = pl_planned_run_identity(&g->plan, &run);
        if (identity == NULL) {
            return pl_fail(error, PL_NO_MEMORY, "out of memory for a run");
        }
        place *to = &g->places[i];
        *to = (place){.reading = reading_of(g, &run), .repeat = run.repeat};
        snprintf(to->run, sizeof to->run, "%s", pl_json_get_text(identity, "run"));
        json_decref(identity);
    }
    return PL_OK;
}

static double metric_of(const json_t *result, int id)
{
    const json_t *metric =
        json_object_get(json_object_get(result, "metrics"), pl_metric_table[id].name);
    const json_t *value = json_object_get(metric, "value");
    return json_is_number(value) && json_number_value(value) > 0 ? json_number_value(value)
                                                                 : (double)NAN;
}

static pl_status keep(void *user, json_t *result, pl_error *error)
{
    gatherer *g = user;
    const char *run = pl_json_get_text(result, "run");
    const double dt = json_number_value(json_object_get(json_object_get(result, "settings"), "dt"));
    (void)error;
    for (long i = 0; i < g->place_count; ++i) {
        place *to = &g->places[i];
        /* Two settings may be the same run, each made. */
        if (to->filled || strcmp(to->run, run) != 0) {
            continue;
        }
        pl_reading *reading = to->reading;
        to->filled = true;
        reading->target = pl_target_read(g->def->targets, result);
        snprintf(reading->outcome, sizeof reading->outcome, "%s",
                 pl_json_get_text(result, "outcome"));
        reading->is_absent = strcmp(reading->outcome, "unsupported") == 0;
        reading->seconds[to->repeat] = metric_of(result, PL_METRIC_TIME_PER_STEP) / dt;
        reading->instructions[to->repeat] = metric_of(result, PL_METRIC_INSTRUCTIONS_PER_STEP) / dt;
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
                                            .user = &g,
                                            .skip = skip,
                                            .keep = keep};
        status = pl_execute(&execution, signal_number, error);
    }
    *runs += g.done;
    free(g.of_pairing);
    free(g.places);
    pl_plan_free(&g.plan);
    return status;
}
