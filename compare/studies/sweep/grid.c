/* The points of a grid in order, and the plan of a shard. */
#include "grid.h"

#include "base/heap.h"
#include "results/store.h"
#include "studies/variant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_KEYS = PL_MAX_PARAMS + PL_ENGINE_MAX_OPTIONS + 1 };

/* The keys that apply to a case or a configuration, in the order given. */
typedef struct grid_keys {
    int items[MOST_KEYS];  /* (count) into pl_grid_def.varied */
    int values[MOST_KEYS]; /* (count) numbers of values; of profiles, those that exist */
    int count;
} grid_keys;

/* The number of combinations of the keys' values. It is a double, because it may be huge before it
 * is refused. */
static double combinations(const grid_keys *keys)
{
    double count = 1;
    for (int i = 0; i < keys->count; ++i) {
        count *= keys->values[i];
    }
    return count;
}

/* The index of the value of key number `key` in a combination; the last key varies fastest. */
static int digit(const grid_keys *keys, long combination, int key)
{
    for (int i = keys->count - 1; i > key; --i) {
        combination /= keys->values[i];
    }
    return (int)(combination % keys->values[key]);
}

/* A subject is a case or, after all cases, a configuration. This is the engine of a configuration; NULL: of a case. */
static const pl_engine_info *engine_of(const pl_plan *base, int subject)
{
    return subject < base->case_count
               ? NULL
               : base->configurations[subject - base->case_count].choice.engine;
}

static const char *name_of(const pl_plan *base, int subject)
{
    const pl_engine_info *engine = engine_of(base, subject);
    return engine != NULL ? engine->name : base->cases[subject].name;
}

/* The number of values that the key has for a subject, of profiles those that its engine has; 0 where it does not have
 * the key. */
static int count_values(const pl_plan *base, int subject, const pl_vary *vary)
{
    const pl_engine_info *engine = engine_of(base, subject);
    int count = 0;
    if (!pl_vary_is_of(vary, name_of(base, subject))) {
        return 0;
    }
    for (int i = 0; vary->names != NULL && engine != NULL && i < vary->count; ++i) {
        count += pl_engine_profile_index(engine, vary->names[i]) >= 0;
    }
    const bool has =
        vary->names == NULL &&
        (engine != NULL ? pl_engine_option_index(engine, vary->key)
                        : pl_scenario_param(base->cases[subject].descriptor, vary->key)) >= 0;
    return has ? vary->count : count;
}

/* Whether another key, which is restricted to `name`, takes precedence. */
static bool is_replaced(const pl_grid_def *def, const pl_vary *vary, const char *name)
{
    bool found = false;
    for (int i = 0; vary->owner[0] == '\0' && i < def->varied_count; ++i) {
        const pl_vary *other = &def->varied[i];
        found |= strcmp(other->owner, name) == 0 && strcmp(other->key, vary->key) == 0;
    }
    return found;
}

static grid_keys keys_of(const pl_grid_def *def, int subject)
{
    grid_keys keys = {.count = 0};
    for (int i = 0; i < def->varied_count; ++i) {
        const int values = count_values(def->base, subject, &def->varied[i]);
        if (values > 0 && !is_replaced(def, &def->varied[i], name_of(def->base, subject))) {
            keys.values[keys.count] = values;
            keys.items[keys.count++] = i;
        }
    }
    return keys;
}

/* ---- Checks of keys ---- */

/* The names that a word could have meant. */
typedef struct names {
    const char **items;
    int count;
} names;

static void add_name(names *n, const char *name)
{
    pl_push(&n->items, &n->count, &name, sizeof name);
}

static bool contains(const names *n, const char *name)
{
    for (int i = 0; i < n->count; ++i) {
        if (strcmp(n->items[i], name) == 0) {
            return true;
        }
    }
    return false;
}

typedef enum name_kind { OWNERS, KEYS, PROFILES } name_kind;

/* All owners; or the keys or profiles of the owner that the key is restricted to, of all without one. */
static names list_names(const pl_grid_def *def, const pl_vary *vary, name_kind of)
{
    const pl_plan *base = def->base;
    static const char *const of_all[] = {"dt", PL_VARY_PROFILE, "solver"};
    names n = {.count = 0};
    for (int i = 0; of == KEYS && i < 3; ++i) {
        add_name(&n, of_all[i]);
    }
    for (int i = 0; i < base->case_count + base->configuration_count; ++i) {
        const pl_engine_info *engine = engine_of(base, i);
        const pl_scenario *scenario = engine == NULL ? base->cases[i].descriptor : NULL;
        if (of == OWNERS) {
            add_name(&n, name_of(base, i));
        } else if (!pl_vary_is_of(vary, name_of(base, i))) {
            continue;
        }
        for (int k = 0; of == KEYS && scenario != NULL && k < scenario->param_count; ++k) {
            add_name(&n, scenario->params[k].name);
        }
        for (int k = 0; of == KEYS && engine != NULL && k < engine->option_count; ++k) {
            add_name(&n, engine->options[k].name);
        }
        for (int k = 0; of == PROFILES && engine != NULL && k < engine->profile_count; ++k) {
            add_name(&n, engine->profiles[k].name);
        }
    }
    return n;
}

/* Fails with "--vary: WHAT WORD" and the nearest of the names, unless the word may be one of them and is; frees them. */
static pl_status check_name(const char *what, const char *word, bool may_be, names n,
                            pl_error *error)
{
    char suggestion[PL_SUGGESTION_SIZE];
    pl_status status = PL_OK;
    if (!may_be || !contains(&n, word)) {
        pl_did_you_mean(word, n.items, n.count, suggestion);
        status = pl_fail(error, PL_BAD_INPUT, "--vary: %s %s%s", what, word, suggestion);
    }
    free(n.items);
    return status;
}

static bool is_absent_engine(const char *name)
{
    const pl_built_in *known = pl_built_in_find(name);
    return known != NULL && !pl_built_in_is_present(known);
}

/* Fails for a key that no case and no engine has. */
static pl_status reject(const pl_grid_def *def, const pl_vary *vary, pl_error *error)
{
    char what[2 * PL_NAME_SIZE] =
        "no chosen scenario has the parameter, and no chosen engine the option,";
    pl_status status = PL_OK;
    for (int i = 0; i < def->base->configuration_count; ++i) {
        const pl_engine_choice *choice = &def->base->configurations[i].choice;
        if (choice->engine->fault.is_fault) { /* its options are not known */
            return pl_fail(error, PL_IO, "--vary %s: %s: %s", vary->key, choice->spec,
                           choice->engine->fault.reason);
        }
    }
    if (vary->owner[0] != '\0') {
        snprintf(what, sizeof what, "%s has no", vary->owner);
        status = check_name("there is no chosen engine or scenario", vary->owner, true,
                            list_names(def, vary, OWNERS), error);
    }
    return status != PL_OK ? status
                           : check_name(what, vary->key, false, list_names(def, vary, KEYS), error);
}

static pl_status check_key(const pl_grid_def *def, int index, pl_error *error)
{
    const pl_vary *vary = &def->varied[index];
    bool of_case = false, of_engine = false, owner_is_chosen = false;
    pl_status status = PL_OK;
    for (int i = 0; i < index; ++i) {
        if (strcmp(def->varied[i].owner, vary->owner) == 0 &&
            strcmp(def->varied[i].key, vary->key) == 0) {
            return pl_fail(error, PL_BAD_INPUT, "--vary %s%s%s is given twice", vary->owner,
                           vary->owner[0] == '\0' ? "" : ".", vary->key);
        }
    }
    for (int i = 0; i < def->base->case_count + def->base->configuration_count; ++i) {
        const bool is_engine = engine_of(def->base, i) != NULL;
        const bool has = count_values(def->base, i, vary) > 0;
        of_case |= has && !is_engine;
        of_engine |= has && is_engine;
        owner_is_chosen |= is_engine && pl_vary_is_of(vary, name_of(def->base, i));
    }
    if (of_case && of_engine) {
        return pl_fail(error, PL_BAD_INPUT,
                       "--vary %s: a scenario's parameter and an engine's option have that name; "
                       "write SCENARIO.%s or ENGINE.%s",
                       vary->key, vary->key, vary->key);
    }
    if (is_absent_engine(vary->owner)) {
        return PL_OK;
    }
    if (!of_case && !of_engine && (vary->names == NULL || !owner_is_chosen)) {
        return reject(def, vary, error);
    }
    for (int i = 0; vary->names != NULL && i < vary->count && status == PL_OK; ++i) {
        status = check_name("no chosen engine has the profile", vary->names[i], true,
                            list_names(def, vary, PROFILES), error);
    }
    return status;
}

static pl_status check_keys(const pl_grid_def *def, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < def->varied_count && status == PL_OK; ++i) {
        status = check_key(def, i, error);
    }
    return status;
}

/* ---- Configurations ---- */

/* A grid that is put into a plan. */
typedef struct grid {
    const pl_grid_def *def;
    pl_plan *plan;
    json_t *labels; /* label -> place in the plan */
    double *steps;  /* (configurations of the plan) s: the time step that it is run at; NAN: all */
    int step_count;
} grid;

/* Sets the profile that is number `place` among those named that the engine has. Options that were not asked for by
 * name get its defaults. */
static void set_profile(pl_engine_choice *choice, const pl_vary *vary, int place)
{
    const pl_engine_info *engine = choice->engine;
    int name = 0;
    while (pl_engine_profile_index(engine, vary->names[name]) < 0 || place-- > 0) {
        ++name;
    }
    choice->profile = pl_engine_profile_index(engine, vary->names[name]);
    for (int i = 0; i < engine->option_count; ++i) {
        char asked[PL_NAME_SIZE + 3];
        snprintf(asked, sizeof asked, ",%s=", engine->options[i].name);
        if (strstr(choice->spec, asked) == NULL) {
            choice->values[i] = pl_engine_profile_values(engine, choice->profile)[i];
        }
    }
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

/* The profile first, then options. */
static pl_status vary_choice(const pl_grid_def *def, const grid_keys *keys, long combination,
                             pl_engine_choice *choice, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < 2 * keys->count && status == PL_OK; ++i) {
        const int k = i % keys->count, place = digit(keys, combination, k);
        const pl_vary *vary = &def->varied[keys->items[k]];
        if (i < keys->count && vary->names != NULL) {
            set_profile(choice, vary, place);
        } else if (i >= keys->count && vary->names == NULL) {
            status = set_option(choice, vary->key, vary->numbers[place], error);
        }
    }
    return status;
}

/* Adds the configuration, made from the one that was asked for, unless it is in the plan. */
static pl_status add_configuration(grid *g, const pl_engine_choice *asked,
                                   const pl_engine_choice *choice, double dt, pl_error *error)
{
    char label[sizeof g->plan->configurations->label];
    pl_engine_choice_varied_label(asked, choice, label);
    const json_t *known = json_object_get(g->labels, label);
    if (known == NULL) {
        json_object_set_new_nocheck(g->labels, label,
                                    json_integer(pl_plan_add_choice(g->plan, choice, label)));
        pl_push(&g->steps, &g->step_count, &dt, sizeof dt);
        return PL_OK;
    }
    const pl_engine_choice *other = &g->plan->configurations[json_integer_value(known)].choice;
    return choice->engine == other->engine && choice->profile == other->profile &&
                   memcmp(choice->values, other->values,
                          (size_t)choice->engine->option_count * sizeof *choice->values) == 0
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT,
                         "two engines would both be called %s: vary fewer options, or give one of "
                         "them label=NAME",
                         label);
}

/* Adds all configurations that are varied, then the drawn settings that the plan does not have yet. PL_BAD_INPUT: a
 * value out of its option's range, or two configurations with the same label. */
static pl_status add_configurations(grid *g, pl_error *error)
{
    const pl_plan *base = g->def->base;
    pl_status status = PL_OK;
    bool more = true;
    for (long number = 0; more && status == PL_OK; ++number) {
        more = false;
        for (int i = 0; i < base->configuration_count && status == PL_OK; ++i) {
            const pl_engine_choice *asked = &base->configurations[i].choice;
            const grid_keys keys = keys_of(g->def, base->case_count + i);
            if ((double)number < combinations(&keys)) {
                pl_engine_choice choice = *asked;
                more = true;
                status = vary_choice(g->def, &keys, number, &choice, error);
                if (status == PL_OK) {
                    status = add_configuration(g, asked, &choice, (double)NAN, error);
                }
            }
        }
    }
    for (int i = 0; i < g->def->drawn_count && status == PL_OK; ++i) {
        const pl_setting *setting = &g->def->drawn[i];
        status = add_configuration(g, &pl_drawn_from(base, setting)->choice, &setting->choice,
                                   setting->dt, error);
    }
    return status;
}

/* ---- Cases ---- */

/* Adds a case of the base with a combination of its keys' values. */
static pl_status add_case(const grid *g, const pl_case *asked, const grid_keys *keys,
                          long combination, pl_error *error)
{
    pl_error why = {.message = ""};
    double values[PL_MAX_PARAMS];
    memcpy(values, asked->params, sizeof values);
    for (int k = 0; k < keys->count; ++k) {
        const pl_vary *vary = &g->def->varied[keys->items[k]];
        values[pl_scenario_param(asked->descriptor, vary->key)] =
            vary->numbers[digit(keys, combination, k)];
    }
    const pl_status status = pl_plan_add_values(g->plan, asked->descriptor, values, NULL, &why);
    return status == PL_OK ? PL_OK : pl_fail(error, status, "--vary: %s", why.message);
}

/* All cases of the grid, equal ones once. */
static pl_status add_cases(const grid *g, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < g->def->base->case_count; ++i) {
        const grid_keys keys = keys_of(g->def, i);
        for (long k = 0; (double)k < combinations(&keys) && status == PL_OK; ++k) {
            status = add_case(g, &g->def->base->cases[i], &keys, k, error);
        }
    }
    return status;
}

/* Adds the points of all cases that are the shard's. */
static void add_points(const grid *g)
{
    const pl_shard *shard = &g->def->shard;
    pl_plan *plan = g->plan;
    plan->pairings =
        pl_heap_new(1, sizeof *plan->pairings); /* without points the plan has no runs */
    for (int i = 0; i < plan->case_count; ++i) {
        const pl_case *test_case = &plan->cases[i];
        const double step = test_case->params[pl_scenario_param(test_case->descriptor, "dt")];
        for (int k = 0; k < plan->configuration_count; ++k) {
            /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): each configuration has one */
            if ((isnan(g->steps[k]) || g->steps[k] == step) &&
                pl_shard_of_point(shard->count, plan->case_count, plan->configuration_count, i,
                                  k) == shard->index) {
                pl_plan_add_pairing(plan, i, k);
            }
        }
    }
    plan->repeated_count = plan->pairing_count;
}

/* The scene of a case with each of its changes, and its points: the pairings [first, end). */
static pl_status add_changes(const grid *g, int first, int end, pl_error *error)
{
    pl_plan *plan = g->plan;
    const pl_case asked = plan->cases[plan->pairings[first].test_case];
    pl_status status = PL_OK;
    int applied = 0;
    for (int i = 0; i < pl_variants_swept.count && applied < g->def->changes && status == PL_OK;
         ++i) {
        const pl_variant *variant = &pl_variants_swept.items[i];
        const int before = plan->case_count;
        memcpy(plan->variation.changed, asked.params, sizeof asked.params);
        if (!pl_variant_apply(variant, asked.descriptor, plan->seed, plan->variation.changed)) {
            continue;
        }
        plan->variation.change = variant->name;
        status = pl_plan_add_values(plan, asked.descriptor, asked.params, NULL, error);
        if (status == PL_BAD_INPUT) { /* the changed values do not go together */
            status = PL_OK;
        }
        applied += plan->case_count > before;
        for (int k = first; plan->case_count > before && k < end; ++k) {
            pl_plan_add_pairing(plan, before, plan->pairings[k].configuration);
        }
    }
    plan->variation = (pl_variation){.change = NULL};
    return status;
}

/* The changes of all cases that have points, after all that is repeated. */
static pl_status add_all_changes(const grid *g, pl_error *error)
{
    pl_status status = PL_OK;
    for (int first = 0, end; first < g->plan->repeated_count && status == PL_OK; first = end) {
        const int test_case = g->plan->pairings[first].test_case;
        for (end = first;
             end < g->plan->repeated_count && g->plan->pairings[end].test_case == test_case;) {
            ++end;
        }
        status = add_changes(g, first, end, error);
    }
    return status;
}

/* The runs of the whole grid must not be too many. */
static pl_status check_size(const pl_grid_def *def, pl_error *error)
{
    double counts[2] = {0, 0}; /* cases, configurations */
    for (int i = 0; i < def->base->case_count + def->base->configuration_count; ++i) {
        const grid_keys keys = keys_of(def, i);
        counts[i >= def->base->case_count] += combinations(&keys);
    }
    const double runs = counts[0] * fmax(counts[1], 1) * def->base->repeats;
    return runs <= PL_GRID_MOST_RUNS
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT,
                         "%.0f cases x %.0f engines x %d repeats are %.0f runs; a sweep has at "
                         "most %d",
                         counts[0], counts[1], def->base->repeats, runs, (int)PL_GRID_MOST_RUNS);
}

pl_status pl_grid_plan(const pl_grid_def *def, pl_plan *plan, pl_error *error)
{
    grid g = {.def = def, .plan = plan, .labels = json_object()};
    plan->repeats = def->base->repeats;
    plan->seed = def->base->seed;
    plan->defers = true;
    pl_status status = check_keys(def, error);
    if (status == PL_OK) {
        status = check_size(def, error);
    }
    if (status == PL_OK) {
        status = add_configurations(&g, error);
    }
    if (status == PL_OK) {
        status = add_cases(&g, error);
    }
    if (status == PL_OK) {
        add_points(&g);
        status = add_all_changes(&g, error);
    }
    if (status == PL_OK && pl_plan_size(plan) > PL_GRID_MOST_RUNS) {
        status = pl_fail(error, PL_BAD_INPUT, "%ld runs; a sweep has at most %d",
                         pl_plan_size(plan), (int)PL_GRID_MOST_RUNS);
    }
    json_decref(g.labels);
    free(g.steps);
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
