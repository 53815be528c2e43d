/* The runs of a tuning: which they are, how they are made, and what their results say. */
#include "base/heap.h"
#include "studies/tunable.h"
#include "tuner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Which run a result is of ---- */

static json_t *parameters_json(const pl_tune_space *space)
{
    json_t *list = json_array();
    for (int i = 0; i < space->parameter_count; ++i) {
        const pl_tune_parameter *p = &space->parameters[i];
        const bool is_rate = p->option == PL_TUNE_RATE;
        json_array_append_new(list, json_pack("{s:s, s:f, s:f}", "key", p->name, "low",
                                              is_rate ? 1 / p->high : p->low, "high",
                                              is_rate ? 1 / p->low : p->high));
    }
    return list;
}

json_t *pl_tuner_study(const pl_tune_def *def)
{
    json_t *scenarios = json_array(), *scenes = json_array(), *targets = json_array();
    for (int i = 0; i < def->plan->case_count; ++i) {
        const char *name = def->plan->cases[i].name;
        json_array_append_new(scenarios, pl_json_text(name));
        json_array_append_new(scenes, json_string(def->plan->cases[i].scene_hash));
    }
    for (int i = 0; i < def->targets->count; ++i) {
        char text[96];
        pl_target_text(&def->targets->items[i], text);
        json_array_append_new(targets, json_string(text));
    }
    char spec[PL_SPEC_SIZE];
    pl_tune_spec(&def->space->base, spec);
    return json_pack("{s:s, s:o, s:o, s:o, s:o, s:I, s:o, s:o, s:i}", "name", "tune", "engine",
                     pl_json_text(spec), "dt", pl_json_number_or_null(def->space->dt), "scenarios",
                     scenarios, "scenes", scenes, "seed", (json_int_t)def->plan->seed, "targets",
                     targets, "parameters", parameters_json(def->space), "budget", def->budget);
}

bool pl_tuner_is_of(const json_t *study, const json_t *run)
{
    const char *key;
    json_t *value;
    bool same = true;
    json_object_foreach((json_t *)study, key, value)
    {
        same = same && (strcmp(key, "scenes") == 0 || json_equal(value, json_object_get(run, key)));
    }
    return same;
}

/* The `study` of the runs of a subject on a case. */
static json_t *study_of(const pl_tuner *t, const pl_tuner_runs *runs, pl_subject subject,
                        int test_case)
{
    const pl_variant *variant = runs->variant == NULL ? &pl_variant_none : runs->variant;
    json_t *study = json_copy(t->study);
    json_object_set_new(study, "phase", json_string(runs->phase));
    json_object_set_new(study, "trial",
                        subject.trial < 0 ? json_null() : json_integer(subject.trial));
    json_object_set_new(study, "values",
                        subject.values == NULL ? json_null() : json_deep_copy(subject.values));
    json_object_set_new(study, "case", json_integer(test_case));
    json_object_set_new(study, "variant", json_string(variant->name));
    return study;
}

/* What tells the runs of a study apart, of which `study` and `repeat` are: malloc'd. */
static char *key_of(const json_t *study, int repeat)
{
    static const char *const keys[] = {"phase", "trial", "values", "case", "variant"};
    json_t *key = json_array();
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) {
        json_array_append(key, json_object_get(study, keys[i]));
    }
    json_array_append_new(key, json_integer(repeat));
    char *text = pl_result_to_line(key);
    json_decref(key);
    return text;
}

static const json_t *find_row(const pl_tuner *t, const json_t *study, int repeat)
{
    char *key = key_of(study, repeat);
    const json_t *row = json_object_get(t->rows, key);
    free(key);
    return row;
}

static void note_point(pl_tuner *t, const json_t *study)
{
    json_t *values = json_object_get(study, "values");
    const json_int_t trial = json_integer_value(json_object_get(study, "trial"));
    while (json_is_array(values) && (json_int_t)json_array_size(t->points) <= trial) {
        json_array_append_new(t->points, json_null());
    }
    if (json_is_array(values) && strcmp(pl_json_get_text(study, "phase"), "search") == 0 &&
        json_is_null(json_array_get(t->points, (size_t)trial))) {
        json_array_set(t->points, (size_t)trial, values);
    } else if (json_is_array(values) &&
               strcmp(pl_json_get_text(study, "phase"), "sensitivity") == 0) {
        json_array_append(t->moved, values);
    }
}

void pl_tuner_take(pl_tuner *t, json_t *result)
{
    const json_t *study = json_object_get(result, "study");
    char *key = key_of(study, (int)json_integer_value(json_object_get(result, "repeat")));
    json_object_set(t->rows, key, result);
    free(key);
    note_point(t, study);
}

const json_t *pl_tuner_row(const pl_tuner *t, const char *phase, pl_subject subject, int test_case)
{
    json_t *study = study_of(t, &(pl_tuner_runs){.phase = phase}, subject, test_case);
    const json_t *row = find_row(t, study, 0);
    json_decref(study);
    return row;
}

/* ---- Making runs ---- */

/* Runs that take much longer than those of the best evaluation so far are cut short. */
static pl_limits limits_of(const pl_tuner *t)
{
    const double patience = 5, least = 2;
    pl_limits limits = t->how->limits;
    if (t->found.met) {
        limits.timeout = fmin(limits.timeout, fmax(least, patience * t->best_seconds));
    }
    return limits;
}

static pl_setting setting_of(const pl_tuner *t, pl_subject subject)
{
    const pl_tune_space *space = t->def->space;
    return subject.values == NULL ? (pl_setting){pl_tune_defaults(&space->base), (double)NAN}
                                  : pl_tune_setting(space, subject.values);
}

/* What a conclusion says of settings that are not the default ones. */
static void describe(json_t *study, const pl_setting *setting)
{
    const char *spec = setting->choice.spec;
    json_object_set_new(study, "spec", pl_json_text(spec));
    json_object_set_new(study, "api", pl_tune_api(&setting->choice, setting->dt));
}

/* Adds the scenario with the step of a setting to the plan; *index is -1 when it cannot be built so. */
static pl_status add_case(pl_plan *plan, const pl_case *test_case, const pl_variant *variant,
                          uint64_t seed, double dt, int *index, pl_error *error)
{
    const pl_scenario *scenario = test_case->descriptor;
    const bool is_changed = variant->kind != PL_VARIANT_NONE || !isnan(dt);
    double values[PL_MAX_PARAMS];
    *index = -1;
    memcpy(values, test_case->params, sizeof values);
    if (!pl_variant_apply(variant, scenario, seed, values)) {
        return PL_OK;
    }
    if (!isnan(dt)) {
        values[pl_scenario_param(scenario, "dt")] = dt;
    }
    const pl_status status = pl_plan_add_values(plan, scenario, values, index, error);
    return status == PL_BAD_INPUT && is_changed ? PL_OK : status;
}

/* Adds the runs of a subject on all cases. */
static pl_status add_subject(const pl_tuner *t, const pl_tuner_runs *runs, int number,
                             pl_plan *plan, pl_error *error)
{
    const pl_plan *asked = t->def->plan;
    const pl_subject subject = runs->subjects[number];
    const pl_variant *variant = runs->variant == NULL ? &pl_variant_none : runs->variant;
    const pl_setting setting = setting_of(t, subject);
    char label[PL_LABEL_SIZE];
    pl_engine_choice_label(&setting.choice, label);
    const int configuration = pl_plan_add_choice(plan, &setting.choice, label);
    pl_status status = PL_OK;
    for (int p = 0; p < asked->case_count && status == PL_OK; ++p) {
        json_t *study = study_of(t, runs, subject, p);
        int index = -1;
        if (subject.values != NULL) {
            describe(study, &setting);
        }
        plan->study = study;
        status = add_case(plan, &asked->cases[p], variant, asked->seed, setting.dt, &index, error);
        if (status == PL_OK && index >= 0) {
            pl_plan_add_pairing(plan, index, configuration);
        }
        json_decref(study);
    }
    return status;
}

static pl_status take(void *user, json_t *result, pl_error *error)
{
    pl_tuner *t = user;
    (void)error;
    pl_tuner_take(t, result);
    if (t->how->progress != NULL) {
        t->bar.done += 1;
        pl_progress_draw(&t->bar, pl_json_get_text(result, "scenario"), 0, pl_monotonic_seconds());
    }
    return PL_OK;
}

static pl_status make_runs(pl_tuner *t, const pl_tuner_runs *runs, pl_error *error)
{
    const bool own_seed = runs->variant != NULL && runs->variant->kind == PL_VARIANT_OFFSET;
    pl_plan plan = {.repeats = runs->repeats,
                    .seed = t->def->plan->seed + (own_seed ? (uint64_t)runs->variant->seed : 0)};
    pl_status status = PL_OK;
    for (int s = 0; s < runs->count && status == PL_OK; ++s) {
        status = add_subject(t, runs, s, &plan, error);
    }
    if (status == PL_OK && plan.pairing_count > 0) {
        pl_execution_def execution = *t->how;
        execution.plan = &plan;
        execution.limits = limits_of(t);
        execution.progress = NULL;
        execution.user = t;
        execution.take = take;
        status = pl_execute(&execution, &t->signal_number, error);
    }
    pl_plan_free(&plan);
    return status;
}

/* ---- Reading results ---- */

const pl_reading *pl_readings_of(const pl_readings *readings, int subject)
{
    return &readings->items[subject * readings->case_count];
}

void pl_readings_free(pl_readings *readings)
{
    free(readings->items);
    free(readings->numbers);
    *readings = (pl_readings){.repeats = 0};
}

static pl_readings make_room(const pl_tuner *t, const pl_tuner_runs *runs)
{
    const size_t count = (size_t)runs->count * (size_t)t->case_count;
    const size_t repeats = (size_t)runs->repeats;
    pl_readings r = {.subject_count = runs->count,
                     .case_count = t->case_count,
                     .repeats = runs->repeats,
                     .items = pl_heap_new(count, sizeof *r.items),
                     .numbers = pl_heap_new(2 * count * repeats, sizeof *r.numbers)};
    for (size_t i = 0; i < 2 * count * repeats; ++i) {
        r.numbers[i] = (double)NAN;
    }
    for (size_t i = 0; i < count; ++i) {
        r.items[i].seconds = &r.numbers[2 * i * repeats];
        r.items[i].instructions = r.items[i].seconds + repeats;
        r.items[i].target.excess = PL_SEARCH_WORST;
    }
    return r;
}

/* A number per simulated second; NAN where it is not positive. */
static double rate_of(const json_t *result, pl_metric_id id)
{
    const double dt = json_number_value(json_object_get(json_object_get(result, "settings"), "dt"));
    const double value = pl_result_metric(result, pl_metric_table[id].name);
    return value > 0 ? value / dt : (double)NAN;
}

static void read_row(const pl_tuner *t, const json_t *row, int repeat, pl_reading *reading)
{
    reading->is_there = true;
    reading->target = pl_target_read(&t->targets, row);
    snprintf(reading->outcome, sizeof reading->outcome, "%s", pl_json_get_text(row, "outcome"));
    reading->is_absent = strcmp(reading->outcome, "unsupported") == 0;
    reading->duration =
        json_number_value(json_object_get(json_object_get(row, "settings"), "duration"));
    reading->seconds[repeat] = rate_of(row, PL_METRIC_TIME_PER_STEP);
    reading->instructions[repeat] = rate_of(row, PL_METRIC_INSTRUCTIONS_PER_STEP);
}

pl_status pl_tuner_measure(pl_tuner *t, pl_tuner_runs runs, pl_readings *readings, pl_error *error)
{
    runs.repeats = runs.repeats == 0 ? 1 : runs.repeats;
    const pl_status status = t->def == NULL ? PL_OK : make_runs(t, &runs, error);
    *readings = make_room(t, &runs);
    for (int i = 0; i < runs.count * t->case_count; ++i) {
        json_t *study = study_of(t, &runs, runs.subjects[i / t->case_count], i % t->case_count);
        for (int k = 0; k < runs.repeats; ++k) {
            const json_t *row = find_row(t, study, k);
            if (row != NULL) {
                read_row(t, row, k, &readings->items[i]);
            }
        }
        json_decref(study);
    }
    return status;
}
