/* The points of a grid in order, and the plan of a shard. */
#include "grid.h"

#include "base/heap.h"
#include "grid_keys.h"
#include "results/store.h"
#include "studies/variant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The number of configurations, before equal ones are merged. */
static double count_configurations(const pl_grid_def *def)
{
    double count = 0;
    for (int i = 0; i < def->base->configuration_count; ++i) {
        pl_grid_keys keys = pl_grid_keys_of_configuration(def, &def->base->configurations[i]);
        count += pl_grid_combinations(&keys);
    }
    return count;
}

/* Changes the profile. Options that were not asked for by name get the profile's defaults. */
static void set_profile(pl_engine_choice *choice, int profile)
{
    const pl_engine_info *engine = choice->engine;
    const double *defaults = pl_engine_profile_values(engine, profile);
    for (int i = 0; i < engine->option_count; ++i) {
        char asked[PL_NAME_SIZE + 3];
        snprintf(asked, sizeof asked, ",%s=", engine->options[i].name);
        if (strstr(choice->spec, asked) == NULL) {
            choice->values[i] = defaults[i];
        }
    }
    choice->profile = profile;
}

/* The profile that is number `place` among those named that the engine has. */
static int named_profile(const pl_engine_info *engine, const pl_vary *vary, int place)
{
    for (int i = 0; i < vary->count; ++i) {
        const int profile = pl_engine_profile_index(engine, vary->names[i]);
        if (profile >= 0 && place-- == 0) {
            return profile;
        }
    }
    return 0;
}

static pl_status set_option(pl_engine_choice *choice, const char *name, double value,
                            pl_error *error)
{
    const pl_engine_info *engine = choice->engine;
    const int index = pl_engine_option_index(engine, name);
    const pl_engine_option *option = &engine->options[index];
    if (!(value >= option->min && value <= option->max)) {
        return pl_fail(error, PL_BAD_INPUT, "--vary %s: %s takes %g to %g, found %.17g", name,
                       engine->name, option->min, option->max, value);
    }
    if (option->integer && value != floor(value)) {
        return pl_fail(error, PL_BAD_INPUT, "--vary %s: %s takes an integer, found %.17g", name,
                       engine->name, value);
    }
    choice->values[index] = value;
    return PL_OK;
}

static pl_status vary_choice(const pl_grid_def *def, const pl_grid_keys *keys, long combination,
                             pl_engine_choice *choice, pl_error *error)
{
    pl_status status = PL_OK;
    for (int k = 0; k < keys->count; ++k) {
        const pl_vary *vary = &def->varied[keys->items[k]];
        if (vary->names != NULL) {
            const int place = pl_grid_digit(keys, combination, k);
            set_profile(choice, named_profile(choice->engine, vary, place));
        }
    }
    for (int k = 0; k < keys->count && status == PL_OK; ++k) {
        const pl_vary *vary = &def->varied[keys->items[k]];
        if (vary->names == NULL) {
            status = set_option(choice, vary->key,
                                vary->numbers[pl_grid_digit(keys, combination, k)], error);
        }
    }
    return status;
}

static bool are_equal(const pl_engine_choice *a, const pl_engine_choice *b)
{
    return a->engine == b->engine && a->profile == b->profile &&
           memcmp(a->values, b->values, (size_t)a->engine->option_count * sizeof *a->values) == 0;
}

/* Adds the configuration, made from the one that was asked for, unless it is in the plan. `labels`
 * maps labels to the plan's indices. */
static pl_status add_configuration(const pl_engine_choice *asked, const pl_engine_choice *choice,
                                   json_t *labels, pl_plan *plan, pl_error *error)
{
    char label[sizeof plan->configurations->label];
    pl_engine_choice_varied_label(asked, choice, label);
    const json_t *known = json_object_get(labels, label);
    if (known != NULL) {
        const pl_engine_choice *other = &plan->configurations[json_integer_value(known)].choice;
        return are_equal(choice, other)
                   ? PL_OK
                   : pl_fail(error, PL_BAD_INPUT,
                             "two engines would both be called %s: vary fewer options, or give "
                             "one of them label=NAME",
                             label);
    }
    json_object_set_new_nocheck(labels, label,
                                json_integer(pl_plan_add_choice(plan, choice, label)));
    return PL_OK;
}

/* Adds all configurations to the plan. PL_BAD_INPUT: a value out of its option's range, or two
 * configurations with the same label. */
static pl_status add_configurations(const pl_grid_def *def, json_t *labels, pl_plan *plan,
                                    pl_error *error)
{
    pl_status status = PL_OK;
    bool more = true;
    for (long number = 0; more && status == PL_OK; ++number) {
        more = false;
        for (int i = 0; i < def->base->configuration_count && status == PL_OK; ++i) {
            const pl_configuration *asked = &def->base->configurations[i];
            pl_grid_keys keys = pl_grid_keys_of_configuration(def, asked);
            if ((double)number < pl_grid_combinations(&keys)) {
                pl_engine_choice choice = asked->choice;
                more = true;
                status = vary_choice(def, &keys, number, &choice, error);
                if (status == PL_OK) {
                    status = add_configuration(&asked->choice, &choice, labels, plan, error);
                }
            }
        }
    }
    return status;
}

/* Adds the drawn settings that the plan does not have yet. */
static pl_status add_drawn(const pl_drawn_settings *drawn, const pl_plan *base, json_t *labels,
                           double *steps, pl_plan *plan, pl_error *error)
{
    const int varied = plan->configuration_count;
    pl_status status = PL_OK;
    for (int i = 0; i < drawn->count && status == PL_OK; ++i) {
        const pl_setting *setting = &drawn->items[i];
        const int before = plan->configuration_count;
        status = add_configuration(&pl_drawn_from(base, setting)->choice, &setting->choice, labels,
                                   plan, error);
        if (plan->configuration_count > before) {
            steps[before - varied] = setting->dt;
        }
    }
    return status;
}

/* A case of the whole grid: a case of the base, and a combination of its keys' values. */
typedef struct place {
    int base;
    long combination;
    int test_case; /* its place in the plan; -1: none of its points is the shard's */
} place;

typedef struct grid {
    const pl_grid_def *def;
    int varied_count;   /* configurations that are run at all time steps: the first ones */
    double *steps;      /* s: of each further configuration, the time step that it is run at */
    pl_grid_keys *keys; /* (of the base's cases) */
    place *places;      /* (count): each case once */
    int count;
} grid;

/* The values of all parameters of a case, varied. */
static void vary_values(const grid *g, const place *at, double *values)
{
    const pl_case *test_case = &g->def->base->cases[at->base];
    const pl_grid_keys *keys = &g->keys[at->base];
    memcpy(values, test_case->params, sizeof test_case->params);
    for (int k = 0; k < keys->count; ++k) {
        const pl_vary *vary = &g->def->varied[keys->items[k]];
        values[pl_scenario_param(test_case->descriptor, vary->key)] =
            vary->numbers[pl_grid_digit(keys, at->combination, k)];
    }
}

/* A malloc'd text that identifies the case. PL_BAD_INPUT: a value out of its range. */
static pl_status name_place(const grid *g, const place *at, char **name, pl_error *error)
{
    const pl_case *test_case = &g->def->base->cases[at->base];
    const pl_scenario *scenario = test_case->descriptor;
    double values[PL_MAX_PARAMS];
    pl_error why = {.message = ""};
    pl_settings settings;
    vary_values(g, at, values);
    pl_settings_make(scenario, values, &settings);
    pl_status status = pl_scenario_values(scenario, settings.items, settings.count, values, &why);
    if (status != PL_OK) {
        return pl_fail(error, status, "--vary: %s", why.message);
    }
    pl_text_buffer text = {0};
    pl_text_add(&text, test_case->name);
    for (int i = 0; i < scenario->param_count; ++i) {
        pl_text_format(&text, "\n%a", values[i]);
    }
    *name = pl_text_take(&text);
    return PL_OK;
}

/* All cases of the grid, equal ones once. */
static pl_status list_places(grid *g, long most, pl_error *error)
{
    json_t *seen = json_object();
    pl_status status = PL_OK;
    g->places = pl_heap_new((size_t)most, sizeof *g->places);
    for (int i = 0; i < g->def->base->case_count; ++i) {
        const long size = (long)pl_grid_combinations(&g->keys[i]);
        for (long k = 0; k < size && status == PL_OK; ++k) {
            const place at = {.base = i, .combination = k};
            char *name = NULL;
            status = name_place(g, &at, &name, error);
            if (status == PL_OK && json_object_get(seen, name) == NULL) {
                g->places[g->count++] = at;
                json_object_set_new_nocheck(seen, name, json_true());
            }
            free(name);
        }
    }
    json_decref(seen);
    return status;
}

static pl_status add_place(const grid *g, const place *at, pl_plan *plan, pl_error *error)
{
    const pl_case *test_case = &g->def->base->cases[at->base];
    double values[PL_MAX_PARAMS];
    vary_values(g, at, values);
    return pl_plan_add_values(plan, test_case->descriptor, values, NULL, error);
}

/* The time step of a place, s; NAN: the scene file's own. */
static double step_of(const grid *g, const place *at)
{
    double values[PL_MAX_PARAMS];
    vary_values(g, at, values);
    return values[pl_scenario_param(g->def->base->cases[at->base].descriptor, "dt")];
}

/* Whether the grid has the point, and it is the shard's. */
static bool has_point(const grid *g, const pl_plan *plan, int number, int configuration)
{
    const pl_shard *shard = &g->def->shard;
    return (configuration < g->varied_count ||
            g->steps[configuration - g->varied_count] == step_of(g, &g->places[number])) &&
           pl_shard_of_point(shard->count, g->count, plan->configuration_count, number,
                             configuration) == shard->index;
}

/* A plan of whole cases, all on all engines, needs no list of points. */
static bool needs_pairings(const grid *g)
{
    return g->count < g->def->shard.count || g->def->drawn != NULL || g->def->changes > 0;
}

/* Adds the points of a case that are the shard's. */
static void add_points(const grid *g, int number, int test_case, pl_plan *plan)
{
    for (int i = 0; i < plan->configuration_count; ++i) {
        if (has_point(g, plan, number, i)) {
            pl_plan_add_pairing(plan, test_case, i);
        }
    }
}

/* The case and its points, as far as they are the shard's. */
static pl_status add_share(const grid *g, int number, pl_plan *plan, pl_error *error)
{
    place *at = &g->places[number];
    bool is_due = false;
    at->test_case = -1;
    for (int i = 0; i < plan->configuration_count && !is_due; ++i) {
        is_due = has_point(g, plan, number, i);
    }
    const int before = plan->case_count;
    pl_status status = is_due ? add_place(g, at, plan, error) : PL_OK;
    if (status != PL_OK || plan->case_count == before) {
        return status;
    }
    at->test_case = before;
    if (needs_pairings(g)) {
        add_points(g, number, before, plan);
    }
    return PL_OK;
}

/* The scene of a case with each of its changes, and the points. */
static pl_status add_changes(const grid *g, int number, pl_plan *plan, pl_error *error)
{
    const place *at = &g->places[number];
    const pl_scenario *scenario = g->def->base->cases[at->base].descriptor;
    pl_status status = PL_OK;
    int applied = 0;
    for (int i = 0; at->test_case >= 0 && i < pl_variants_swept.count &&
                    applied < g->def->changes && status == PL_OK;
         ++i) {
        const pl_variant *variant = &pl_variants_swept.items[i];
        const int before = plan->case_count;
        vary_values(g, at, plan->variation.changed);
        if (!pl_variant_apply(variant, scenario, plan->seed, plan->variation.changed)) {
            continue;
        }
        plan->variation.change = variant->name;
        status = add_place(g, at, plan, error);
        if (status == PL_BAD_INPUT) { /* the changed values do not go together */
            status = PL_OK;
        } else if (plan->case_count > before) {
            ++applied;
            add_points(g, number, before, plan);
        }
    }
    plan->variation = (pl_variation){.change = NULL};
    return status;
}

/* Adds all cases with their points: those that are repeated, then the changed scenes. */
static pl_status add_cases(const grid *g, pl_plan *plan, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < g->count && status == PL_OK; ++i) {
        status = add_share(g, i, plan, error);
    }
    plan->repeated_count = plan->pairing_count;
    for (int i = 0; i < g->count && status == PL_OK && g->def->changes > 0; ++i) {
        status = add_changes(g, i, plan, error);
    }
    if (status == PL_OK && pl_plan_size(plan) > PL_GRID_MOST_RUNS) {
        status = pl_fail(error, PL_BAD_INPUT, "%ld runs; a sweep has at most %d",
                         pl_plan_size(plan), (int)PL_GRID_MOST_RUNS);
    }
    return status;
}

/* The runs of the whole grid must not be too many. */
static pl_status check_size(const pl_grid_def *def, double cases, double configurations,
                            pl_error *error)
{
    const double runs = cases * fmax(configurations, 1) * def->base->repeats;
    return runs <= PL_GRID_MOST_RUNS
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT,
                         "%.0f cases x %.0f engines x %d repeats are %.0f runs; a sweep has at "
                         "most %d",
                         cases, configurations, def->base->repeats, runs, (int)PL_GRID_MOST_RUNS);
}

pl_status pl_grid_plan(const pl_grid_def *def, pl_plan *plan, pl_error *error)
{
    grid g = {.def = def};
    double cases = 0;
    pl_status status = pl_grid_keys_check(def, error);
    if (status != PL_OK) {
        return status;
    }
    json_t *labels = json_object();
    const size_t settings = def->drawn == NULL ? 0 : (size_t)def->drawn->count;
    g.keys = pl_heap_new((size_t)def->base->case_count, sizeof *g.keys);
    g.steps = pl_heap_new(settings, sizeof *g.steps);
    for (int i = 0; i < def->base->case_count; ++i) {
        g.keys[i] = pl_grid_keys_of_case(def, &def->base->cases[i]);
        cases += pl_grid_combinations(&g.keys[i]);
    }
    plan->repeats = def->base->repeats;
    plan->seed = def->base->seed;
    plan->defers = true;
    status = check_size(def, cases, count_configurations(def), error);
    if (status == PL_OK) {
        status = add_configurations(def, labels, plan, error);
    }
    g.varied_count = plan->configuration_count;
    if (status == PL_OK && def->drawn != NULL) {
        status = add_drawn(def->drawn, def->base, labels, g.steps, plan, error);
    }
    if (status == PL_OK) {
        status = list_places(&g, (long)cases, error);
    }
    if (status == PL_OK) {
        status = add_cases(&g, plan, error);
    }
    json_decref(labels);
    free(g.keys);
    free(g.steps);
    free(g.places);
    return status;
}

pl_status pl_grid_list(const pl_plan *plan, const char *path, pl_error *error)
{
    pl_text_buffer text = {0};
    for (long i = 0; i < pl_plan_size(plan); ++i) {
        const pl_planned_run run = pl_plan_run(plan, i);
        json_t *identity = pl_planned_run_identity(plan, &run);
        json_object_set_new(identity, "schema", json_string("plumb.plan/1"));
        json_object_set_new(identity, "index", json_integer(i));
        pl_result_add_line(&text, identity);
        json_decref(identity);
    }
    return pl_write_buffer(path, &text, error);
}
