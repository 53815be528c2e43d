#include "plan.h"

#include "base/hash.h"
#include "base/heap.h"
#include "plumb/jitter.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Notes what distinguishes the case from others. Returns whether the plan has it already. */
static bool note_case(pl_plan *plan, const pl_case *test_case, const char *name)
{
    pl_text_buffer text = {0};
    char *study = test_case->study == NULL ? NULL : pl_result_to_line(test_case->study);
    pl_text_format(&text, "%s\n%s\n%s", test_case->scene_hash, name, study == NULL ? "" : study);
    for (int i = 0; i < test_case->descriptor->param_count; ++i) {
        pl_text_format(&text, "\n%a", test_case->params[i]);
    }
    char *key = pl_text_take(&text);
    if (plan->known == NULL) {
        plan->known = json_object();
    }
    const bool is_known = json_object_get(plan->known, key) != NULL;
    json_object_set_new_nocheck(plan->known, key, json_true());
    free(study);
    free(key);
    return is_known;
}

/* The parameters that the scene of a case is built with. */
static const double *built_with(const pl_variation *variation, const double *params)
{
    return variation->change != NULL ? variation->changed : params;
}

static void vary_scene(const pl_plan *plan, const pl_case *test_case, pl_scene *scene)
{
    if (test_case->variation.is_member) {
        pl_scene_jitter(scene, plan->seed, test_case->variation.member);
    }
}

/* Frees the scene, except for the fields that identify a run. */
static void defer(pl_case *test_case)
{
    pl_scene kept = pl_scene_default();
    kept.dt = test_case->scene.dt;
    kept.duration = test_case->scene.duration;
    kept.acceptance = test_case->scene.acceptance;
    memcpy(kept.primary_error, test_case->scene.primary_error, sizeof kept.primary_error);
    pl_scene_free(&test_case->scene);
    test_case->scene = kept;
    test_case->deferred = true;
}

/* Varies and hashes the case and moves it into the plan, or frees it. */
static pl_status add_case(pl_plan *plan, pl_case *test_case, const char *name, pl_error *error)
{
    test_case->variation = plan->variation;
    test_case->study = json_incref(plan->study);
    vary_scene(plan, test_case, &test_case->scene);
    pl_status status = pl_scene_hash(&test_case->scene, test_case->scene_hash, error);
    if (status != PL_OK || note_case(plan, test_case, name)) {
        json_decref(test_case->study);
        pl_scene_free(&test_case->scene);
        return status;
    }
    if (plan->defers && test_case->descriptor->file == NULL) {
        defer(test_case);
    }
    test_case->name = pl_heap_copy(name);
    pl_push(&plan->cases, &plan->case_count, test_case, sizeof *test_case);
    return PL_OK;
}

pl_status pl_plan_build_scene(const pl_plan *plan, const pl_case *test_case, pl_scene *scene,
                              pl_error *error)
{
    *scene = pl_scene_default();
    const double *params = built_with(&test_case->variation, test_case->params);
    pl_status status = pl_scenario_build(test_case->descriptor, params, plan->seed, scene, error);
    if (status == PL_OK) {
        vary_scene(plan, test_case, scene);
    }
    return status;
}

/* Hashes the scene as the file states it; leaves the edition empty where only other parameters give a scene. */
static void note_edition(pl_scenario *scenario)
{
    double values[PL_MAX_PARAMS];
    pl_scene scene = pl_scene_default();
    if (pl_scenario_values(scenario, NULL, 0, values, NULL) != PL_OK ||
        pl_scenario_build(scenario, values, 0, &scene, NULL) != PL_OK ||
        pl_scene_hash(&scene, scenario->edition, NULL) != PL_OK) {
        scenario->edition[0] = '\0';
    }
    pl_scene_free(&scene);
}

pl_status pl_plan_open_file(pl_plan *plan, const char *path, const pl_scenario **scenario,
                            pl_error *error)
{
    pl_scenario *opened = NULL;
    pl_status status = pl_scenario_open_file(path, &opened, error);
    if (status == PL_OK) {
        pl_push(&plan->files, &plan->file_count, &opened, sizeof(pl_scenario *));
        note_edition(opened);
        *scenario = opened;
    }
    return status;
}

void pl_plan_take_files(pl_plan *plan, pl_plan *from)
{
    plan->files = from->files;
    plan->file_count = from->file_count;
    from->files = NULL;
    from->file_count = 0;
}

/* Divides the time step by the plan's refinement; that of a scene file is in its scene. */
static pl_status refine_step(const pl_plan *plan, const pl_scenario *scenario, double *params,
                             pl_error *error)
{
    pl_scene scene = pl_scene_default();
    double *dt = &params[pl_scenario_param(scenario, "dt")];
    pl_status status = PL_OK;
    if (plan->variation.refinement <= 1) {
        return PL_OK;
    }
    if (isnan(*dt)) {
        status = pl_scenario_build(scenario, params, plan->seed, &scene, error);
        *dt = scene.dt;
        pl_scene_free(&scene);
    }
    *dt /= plan->variation.refinement;
    return status;
}

pl_status pl_plan_add_scenario(pl_plan *plan, const pl_scenario *scenario,
                               const char *const *settings, int count, pl_error *error)
{
    pl_case test_case = {.descriptor = scenario, .scene = pl_scene_default()};
    pl_status status = pl_scenario_values(scenario, settings, count, test_case.params, error);
    if (status == PL_OK) {
        status = refine_step(plan, scenario, test_case.params, error);
    }
    if (status == PL_OK) {
        status = pl_scenario_build(scenario, built_with(&plan->variation, test_case.params),
                                   plan->seed, &test_case.scene, error);
    }
    return status == PL_OK ? add_case(plan, &test_case, scenario->name, error) : status;
}

pl_status pl_plan_add_values(pl_plan *plan, const pl_scenario *scenario, const double *values,
                             int *index, pl_error *error)
{
    char texts[PL_MAX_PARAMS][PL_NAME_SIZE + 32]; /* exact; NAN: none */
    const char *settings[PL_MAX_PARAMS];
    int count = 0;
    for (int i = 0; i < scenario->param_count; ++i) {
        if (!isnan(values[i])) {
            snprintf(texts[count], sizeof texts[count], "%s=%.17g", scenario->params[i].name,
                     values[i]);
            settings[count] = texts[count];
            ++count;
        }
    }
    const int before = plan->case_count;
    pl_status status = pl_plan_add_scenario(plan, scenario, settings, count, error);
    if (index != NULL) {
        *index = plan->case_count > before ? before : -1;
        for (int i = 0; i < before && status == PL_OK && *index < 0; ++i) {
            const pl_case *known = &plan->cases[i];
            if (known->descriptor == scenario &&
                memcmp(known->params, values, (size_t)scenario->param_count * sizeof *values) ==
                    0) {
                *index = i;
            }
        }
    }
    return status;
}

static bool is_same_choice(const pl_engine_choice *a, const pl_engine_choice *b)
{
    return a->engine == b->engine && a->profile == b->profile &&
           memcmp(a->values, b->values, (size_t)a->engine->option_count * sizeof *a->values) == 0;
}

pl_status pl_plan_add_engine(pl_plan *plan, const char *spec, pl_error *error)
{
    pl_configuration added = {.label = ""};
    pl_status status = pl_engine_choose(spec, &added.choice, error);
    if (status != PL_OK) {
        return status;
    }
    pl_engine_choice_label(&added.choice, added.label);
    for (int i = 0; i < plan->configuration_count; ++i) {
        const pl_configuration *other = &plan->configurations[i];
        if (strcmp(other->label, added.label) == 0) {
            return is_same_choice(&other->choice, &added.choice)
                       ? PL_OK
                       : pl_fail(error, PL_BAD_INPUT,
                                 "%s and %s are both called %s: give one of them label=NAME",
                                 other->choice.spec, spec, added.label);
        }
    }
    pl_plan_add_choice(plan, &added.choice, added.label);
    return PL_OK;
}

int pl_plan_add_choice(pl_plan *plan, const pl_engine_choice *choice, const char *label)
{
    const pl_engine_info *engine = choice->engine;
    pl_configuration added = {
        .choice = *choice,
        .conformance = pl_conformance_find(engine, engine->profiles[choice->profile].name)};
    snprintf(added.label, sizeof added.label, "%s", label);
    pl_push(&plan->configurations, &plan->configuration_count, &added, sizeof added);
    return plan->configuration_count - 1;
}

void pl_plan_add_pairing(pl_plan *plan, int test_case, int configuration)
{
    const pl_pairing added = {test_case, configuration};
    pl_push(&plan->pairings, &plan->pairing_count, &added, sizeof added);
}

/* The number of runs of the first repeat. */
static long first_runs(const pl_plan *plan)
{
    return plan->pairings != NULL ? plan->pairing_count
                                  : (long)plan->case_count * plan->configuration_count;
}

/* How many of them each further repeat has. */
static long repeated(const pl_plan *plan)
{
    return plan->repeated_count > 0 ? plan->repeated_count : first_runs(plan);
}

long pl_plan_size(const pl_plan *plan)
{
    return first_runs(plan) + (plan->repeats - 1L) * repeated(plan);
}

static pl_pairing pairing_at(const pl_plan *plan, long place)
{
    const int engines = plan->configuration_count;
    return plan->pairings != NULL ? plan->pairings[place]
                                  : (pl_pairing){(int)(place / engines), (int)(place % engines)};
}

/* The pairing at `place` in a repeat: neighbours with the same case take turns. */
static pl_pairing turn(const pl_plan *plan, long place, long repeat)
{
    const int test_case = pairing_at(plan, place).test_case;
    long first = place, end = place + 1;
    while (first > 0 && pairing_at(plan, first - 1).test_case == test_case) {
        --first;
    }
    while (end < first_runs(plan) && pairing_at(plan, end).test_case == test_case) {
        ++end;
    }
    return pairing_at(plan, first + (place - first + repeat) % (end - first));
}

pl_planned_run pl_plan_run(const pl_plan *plan, long index)
{
    const long further = index - first_runs(plan);
    const long repeat = further < 0 ? 0 : 1 + further / repeated(plan);
    const pl_pairing pairing = turn(plan, further < 0 ? index : further % repeated(plan), repeat);
    return (pl_planned_run){.test_case = &plan->cases[pairing.test_case],
                            .configuration = &plan->configurations[pairing.configuration],
                            .repeat = (int)repeat};
}

/* An integral parameter is written as an integer. */
static void set_number(json_t *object, const char *name, double value, bool integer)
{
    json_object_set_new(object, name,
                        integer ? json_integer((json_int_t)value) : pl_json_number_or_null(value));
}

json_t *pl_plan_case_params(const pl_case *test_case)
{
    json_t *params = json_object();
    for (int i = 0; i < test_case->descriptor->param_count; ++i) {
        const pl_param *param = &test_case->descriptor->params[i];
        if (!isnan(test_case->params[i])) {
            set_number(params, param->name, test_case->params[i], param->integer);
        }
    }
    return params;
}

static json_t *settings_json(const pl_scene *scene, const pl_engine_choice *choice)
{
    json_t *settings = json_object();
    set_number(settings, "dt", scene->dt, false);
    set_number(settings, "duration", scene->duration, false);
    for (int i = 0; i < choice->engine->option_count; ++i) {
        const pl_engine_option *option = &choice->engine->options[i];
        set_number(settings, option->name, choice->values[i], option->integer);
    }
    return settings;
}

/* The SPEC of the engine and its profile: what plumb check-engine takes. */
static json_t *spec_json(const pl_engine_info *engine, const char *profile)
{
    char *spec = pl_heap_format("%s:%s", engine->spec, profile);
    json_t *text = pl_json_text(spec);
    free(spec);
    return text;
}

/* The engine's first profile with its default options. */
static bool is_as_shipped(const pl_engine_choice *choice)
{
    bool equal = choice->profile == 0;
    for (int i = 0; i < choice->engine->option_count && equal; ++i) {
        equal = choice->values[i] == pl_engine_profile_values(choice->engine, 0)[i];
    }
    return equal;
}

/* Sets `run`, the hash of the keys so far: FNV-1a over their canonical JSON. */
static void set_hash(json_t *identity)
{
    char *text = pl_result_to_line(identity), hash[PL_HASH_TEXT_SIZE];
    pl_hash_hex(pl_hash_text(PL_HASH_START, text), hash);
    free(text);
    json_object_set_new(identity, "run", json_string(hash));
}

json_t *pl_planned_run_identity(const pl_plan *plan, const pl_planned_run *run)
{
    const pl_case *test_case = run->test_case;
    const pl_engine_choice *choice = &run->configuration->choice;
    const pl_engine_info *engine = choice->engine;
    const char *profile = engine->profiles[choice->profile].name;
    json_t *label = pl_json_text(run->configuration->label);
    json_t *identity =
        json_pack("{s:o, s:o, s:s, s:s, s:s, s:s, s:s, s:o, s:I, s:i}", "scenario",
                  pl_json_text(test_case->name), "params", pl_plan_case_params(test_case),
                  "scene_hash", test_case->scene_hash, "engine", engine->name, "engine_version",
                  engine->version, "engine_binary", engine->binary, "profile", profile, "settings",
                  settings_json(&test_case->scene, choice), "seed", (json_int_t)plan->seed,
                  "repeat", run->repeat);
    if (test_case->variation.is_member) {
        json_object_set_new(identity, "member", json_integer(test_case->variation.member));
    }
    if (test_case->variation.change != NULL) {
        json_object_set_new(identity, "change", json_string(test_case->variation.change));
    }
    if (test_case->study != NULL) {
        json_object_set(identity, "study", test_case->study);
    }
    if (choice->label[0] != '\0') {
        json_object_set(identity, "label", label);
    }
    set_hash(identity);
    json_object_set_new(identity, "label", label);
    if (test_case->descriptor->edition[0] != '\0') {
        json_object_set_new(identity, "scene_edition", json_string(test_case->descriptor->edition));
    }
    json_object_update_new(
        identity,
        json_pack("{s:s, s:o, s:o, s:s, s:i, s:b, s:O?}", "primary_error",
                  test_case->scene.primary_error, "acceptance",
                  pl_json_number_or_null(test_case->scene.acceptance), "engine_spec",
                  spec_json(engine, profile), "engine_runtime", pl_engine_runtime(engine),
                  "threads", pl_engine_threads(engine, choice->values), "as_shipped",
                  (int)is_as_shipped(choice), "conformance", run->configuration->conformance));
    return identity;
}

void pl_planned_run_hash(const pl_plan *plan, const pl_planned_run *run, char hash[17])
{
    json_t *identity = pl_planned_run_identity(plan, run);
    snprintf(hash, 17, "%s", pl_json_get_text(identity, "run"));
    json_decref(identity);
}

void pl_plan_free(pl_plan *plan)
{
    for (int i = 0; i < plan->case_count; ++i) {
        free(plan->cases[i].name);
        json_decref(plan->cases[i].study);
        pl_scene_free(&plan->cases[i].scene);
    }
    for (int i = 0; i < plan->file_count; ++i) {
        pl_scenario_close_file(plan->files[i]);
    }
    free(plan->files);
    free(plan->cases);
    for (int i = 0; plan->configurations != NULL && i < plan->configuration_count; ++i) {
        json_decref(plan->configurations[i].conformance);
    }
    free(plan->configurations);
    free(plan->pairings);
    json_decref(plan->known);
    *plan = (pl_plan){.repeats = 0};
}
