/* The runs of a tuning: which they are, and how they are made. */
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

static const pl_variant *variant_of(const pl_subject *subject)
{
    return subject->variant == NULL ? &pl_variant_none : subject->variant;
}

/* The `study` of the runs of a subject on a case. */
static json_t *study_of(const pl_tuner *t, const pl_subject *subject, int test_case)
{
    json_t *study = json_copy(t->study);
    json_object_set_new(study, "phase", json_string(subject->phase));
    json_object_set_new(study, "trial",
                        subject->trial < 0 ? json_null() : json_integer(subject->trial));
    json_object_set_new(study, "values",
                        subject->values == NULL ? json_null() : json_deep_copy(subject->values));
    json_object_set_new(study, "case", json_integer(test_case));
    json_object_set_new(study, "variant", json_string(variant_of(subject)->name));
    return study;
}

/* What tells the results of a tuning apart: malloc'd. */
static char *key_of(const json_t *result)
{
    static const char *const keys[] = {"study.phase", "study.trial",   "study.values",
                                       "study.case",  "study.variant", "repeat",
                                       NULL};
    return pl_study_key(result, keys);
}

void pl_tuner_take(pl_tuner *t, json_t *result)
{
    json_t *values = pl_study_get(result, "study.values");
    const int trial = pl_study_integer(result, "study.trial");
    char *key = key_of(result);
    json_object_set(t->rows, key, result);
    free(key);
    while (json_is_array(values) && (int)json_array_size(t->points) <= trial) {
        json_array_append_new(t->points, json_null());
    }
    /* Subjects borrow the values of a trial, so that they stay. */
    if (json_is_array(values) && strcmp(pl_study_text(result, "study.phase"), "search") == 0 &&
        json_is_null(json_array_get(t->points, (size_t)trial))) {
        json_array_set(t->points, (size_t)trial, values);
    }
}

const json_t *pl_tuner_row(const pl_tuner *t, const pl_subject *subject, int test_case, int repeat)
{
    json_t *wanted =
        json_pack("{s:o, s:i}", "study", study_of(t, subject, test_case), "repeat", repeat);
    char *key = key_of(wanted);
    const json_t *row = json_object_get(t->rows, key);
    free(key);
    json_decref(wanted);
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

/* Adds the runs of a subject on all cases. They say of settings that are not the default ones what a conclusion does. */
static pl_status add_subject(const pl_tuner *t, const pl_subject *subject, pl_plan *plan,
                             pl_error *error)
{
    const pl_plan *asked = t->def->plan;
    const pl_tune_space *space = t->def->space;
    const pl_setting setting = subject->values == NULL
                                   ? (pl_setting){pl_tune_defaults(&space->base), (double)NAN}
                                   : pl_tune_setting(space, subject->values);
    char label[PL_LABEL_SIZE];
    pl_engine_choice_label(&setting.choice, label);
    const int configuration = pl_plan_add_choice(plan, &setting.choice, label);
    pl_status status = PL_OK;
    for (int p = 0; p < asked->case_count && status == PL_OK; ++p) {
        json_t *study = study_of(t, subject, p);
        int index = -1;
        if (subject->values != NULL) {
            json_object_set_new(study, "spec", pl_json_text(setting.choice.spec));
            json_object_set_new(study, "api", pl_tune_api(&setting.choice, setting.dt));
        }
        plan->study = study;
        status = add_case(plan, &asked->cases[p], variant_of(subject), asked->seed, setting.dt,
                          &index, error);
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
    t->bar.done += 1;
    pl_progress_draw(&t->bar, pl_json_get_text(result, "scenario"), 0, pl_monotonic_seconds());
    return PL_OK;
}

bool pl_tuner_goes_on(const pl_tuner *t)
{
    return t->status == PL_OK && t->signal_number == 0;
}

bool pl_tuner_measure(pl_tuner *t, const pl_subject *subjects, int count, int repeats)
{
    if (t->def == NULL || !pl_tuner_goes_on(t)) {
        return pl_tuner_goes_on(t);
    }
    const pl_variant *variant = variant_of(&subjects[0]);
    const int own_seed = variant->kind == PL_VARIANT_OFFSET ? variant->seed : 0;
    pl_plan plan = {.repeats = repeats, .seed = t->def->plan->seed + (uint64_t)own_seed};
    for (int s = 0; s < count && t->status == PL_OK; ++s) {
        t->status = add_subject(t, &subjects[s], &plan, t->error);
    }
    if (t->status == PL_OK && plan.pairing_count > 0) {
        pl_execution_def execution = *t->how;
        execution.plan = &plan;
        execution.limits = limits_of(t);
        execution.progress = NULL;
        execution.user = t;
        execution.take = take;
        t->status = pl_execute(&execution, &t->signal_number, t->error);
    }
    pl_plan_free(&plan);
    return pl_tuner_goes_on(t);
}
