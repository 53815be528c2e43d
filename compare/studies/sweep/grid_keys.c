/* The keys that apply to each case and configuration, and the checks of all keys. */
#include "grid_keys.h"

#include "base/heap.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double pl_grid_combinations(const pl_grid_keys *keys)
{
    double count = 1;
    for (int i = 0; i < keys->count; ++i) {
        count *= keys->values[i];
    }
    return count;
}

int pl_grid_digit(const pl_grid_keys *keys, long combination, int key)
{
    for (int i = keys->count - 1; i > key; --i) {
        combination /= keys->values[i];
    }
    return (int)(combination % keys->values[key]);
}

/* The number of values that the key has for a case; 0 where the case does not have it. */
static int values_of_case(const pl_case *test_case, const pl_vary *vary)
{
    const bool has =
        vary->names == NULL && pl_scenario_param(test_case->descriptor, vary->key) >= 0;
    return has && pl_vary_is_of(vary, test_case->name) ? vary->count : 0;
}

/* The same for a configuration; of profiles, those that the engine has count. */
static int values_of_configuration(const pl_configuration *configuration, const pl_vary *vary)
{
    const pl_engine_info *engine = configuration->choice.engine;
    if (!pl_vary_is_of(vary, engine->name)) {
        return 0;
    }
    if (strcmp(vary->key, PL_VARY_PROFILE) != 0) {
        return pl_engine_option_index(engine, vary->key) >= 0 ? vary->count : 0;
    }
    int count = 0;
    for (int i = 0; i < vary->count; ++i) {
        count += pl_engine_profile_index(engine, vary->names[i]) >= 0;
    }
    return count;
}

/* Adds the key number `index` unless it has no values for `name`, or a key restricted to `name`
 * takes precedence. */
static void add_key(const pl_grid_def *def, int index, const char *name, int values,
                    pl_grid_keys *keys)
{
    const pl_vary *vary = &def->varied[index];
    bool is_replaced = false;
    for (int i = 0; vary->owner[0] == '\0' && i < def->varied_count; ++i) {
        const pl_vary *other = &def->varied[i];
        is_replaced =
            is_replaced || (strcmp(other->owner, name) == 0 && strcmp(other->key, vary->key) == 0);
    }
    if (values > 0 && !is_replaced) {
        keys->values[keys->count] = values;
        keys->items[keys->count++] = index;
    }
}

pl_grid_keys pl_grid_keys_of_case(const pl_grid_def *def, const pl_case *test_case)
{
    pl_grid_keys keys = {.count = 0};
    for (int i = 0; i < def->varied_count; ++i) {
        add_key(def, i, test_case->name, values_of_case(test_case, &def->varied[i]), &keys);
    }
    return keys;
}

pl_grid_keys pl_grid_keys_of_configuration(const pl_grid_def *def,
                                           const pl_configuration *configuration)
{
    pl_grid_keys keys = {.count = 0};
    for (int i = 0; i < def->varied_count; ++i) {
        add_key(def, i, configuration->choice.engine->name,
                values_of_configuration(configuration, &def->varied[i]), &keys);
    }
    return keys;
}

/* ---- Checks ---- */

/* The names that a word could have meant. */
typedef struct names {
    const char **items;
    int count;
} names;

static void add_name(names *n, const char *name)
{
    pl_push(&n->items, &n->count, &name, sizeof name);
}

/* All keys of what the owner restricts to; of everything when the owner is empty. */
static void list_keys(const pl_grid_def *def, const pl_vary *vary, names *n)
{
    add_name(n, "dt");
    add_name(n, PL_VARY_PROFILE);
    add_name(n, "solver");
    for (int i = 0; i < def->base->case_count; ++i) {
        const pl_case *test_case = &def->base->cases[i];
        const pl_scenario *scenario = test_case->descriptor;
        const bool counts = pl_vary_is_of(vary, test_case->name);
        for (int k = 0; counts && k < scenario->param_count; ++k) {
            add_name(n, scenario->params[k].name);
        }
    }
    for (int i = 0; i < def->base->configuration_count; ++i) {
        const pl_engine_info *engine = def->base->configurations[i].choice.engine;
        for (int k = 0; pl_vary_is_of(vary, engine->name) && k < engine->option_count; ++k) {
            add_name(n, engine->options[k].name);
        }
    }
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

/* Fails with "--vary: WHAT WORD" and the nearest of the names; frees them. */
static pl_status fail_unknown(const char *what, const char *word, names *n, pl_error *error)
{
    char suggestion[PL_SUGGESTION_SIZE];
    pl_did_you_mean(word, n->items, n->count, suggestion);
    const pl_status status =
        pl_fail(error, PL_BAD_INPUT, "--vary: %s %s%s", what, word, suggestion);
    free(n->items);
    return status;
}

static bool is_absent_engine(const char *name)
{
    int count = 0;
    const pl_built_in *known = pl_built_in_engines(&count);
    for (int i = 0; i < count; ++i) {
        if (strcmp(known[i].name, name) == 0) {
            return !pl_built_in_is_present(&known[i]);
        }
    }
    return false;
}

/* Fails for a key that no case and no engine has. */
static pl_status reject(const pl_grid_def *def, const pl_vary *vary, pl_error *error)
{
    for (int i = 0; i < def->base->configuration_count; ++i) {
        const pl_engine_choice *choice = &def->base->configurations[i].choice;
        if (choice->engine->fault.is_fault) { /* its options are not known */
            return pl_fail(error, PL_IO, "--vary %s: %s: %s", vary->key, choice->spec,
                           choice->engine->fault.reason);
        }
    }
    names owners = {.count = 0}, keys = {.count = 0};
    char what[2 * PL_NAME_SIZE] =
        "no chosen scenario has the parameter, and no chosen engine the option,";
    for (int i = 0; i < def->base->case_count; ++i) {
        add_name(&owners, def->base->cases[i].name);
    }
    for (int i = 0; i < def->base->configuration_count; ++i) {
        add_name(&owners, def->base->configurations[i].choice.engine->name);
    }
    if (vary->owner[0] != '\0' && !contains(&owners, vary->owner)) {
        return fail_unknown("there is no chosen engine or scenario", vary->owner, &owners, error);
    }
    free(owners.items);
    if (vary->owner[0] != '\0') {
        snprintf(what, sizeof what, "%s has no", vary->owner);
    }
    list_keys(def, vary, &keys);
    return fail_unknown(what, vary->key, &keys, error);
}

/* Every profile named must be one of some chosen engine. */
static pl_status check_profiles(const pl_grid_def *def, const pl_vary *vary, pl_error *error)
{
    names known = {.count = 0};
    for (int i = 0; i < def->base->configuration_count; ++i) {
        const pl_engine_info *engine = def->base->configurations[i].choice.engine;
        for (int k = 0; pl_vary_is_of(vary, engine->name) && k < engine->profile_count; ++k) {
            add_name(&known, engine->profiles[k].name);
        }
    }
    for (int i = 0; i < vary->count; ++i) {
        if (!contains(&known, vary->names[i])) {
            return fail_unknown("no chosen engine has the profile", vary->names[i], &known, error);
        }
    }
    free(known.items);
    return PL_OK;
}

static pl_status check_key(const pl_grid_def *def, int index, pl_error *error)
{
    const pl_vary *vary = &def->varied[index];
    const bool is_profile = strcmp(vary->key, PL_VARY_PROFILE) == 0;
    bool of_case = false, of_configuration = false, owner_is_chosen = false;
    for (int i = 0; i < index; ++i) {
        if (strcmp(def->varied[i].owner, vary->owner) == 0 &&
            strcmp(def->varied[i].key, vary->key) == 0) {
            return pl_fail(error, PL_BAD_INPUT, "--vary %s%s%s is given twice", vary->owner,
                           vary->owner[0] == '\0' ? "" : ".", vary->key);
        }
    }
    for (int i = 0; i < def->base->case_count; ++i) {
        of_case = of_case || values_of_case(&def->base->cases[i], vary) > 0;
    }
    for (int i = 0; i < def->base->configuration_count; ++i) {
        const pl_configuration *configuration = &def->base->configurations[i];
        of_configuration = of_configuration || values_of_configuration(configuration, vary) > 0;
        owner_is_chosen =
            owner_is_chosen || pl_vary_is_of(vary, configuration->choice.engine->name);
    }
    if (of_case && of_configuration) {
        return pl_fail(error, PL_BAD_INPUT,
                       "--vary %s: a scenario's parameter and an engine's option have that name; "
                       "write SCENARIO.%s or ENGINE.%s",
                       vary->key, vary->key, vary->key);
    }
    if (is_absent_engine(vary->owner)) {
        return PL_OK;
    }
    if (!of_case && !of_configuration && (!is_profile || !owner_is_chosen)) {
        return reject(def, vary, error);
    }
    return is_profile ? check_profiles(def, vary, error) : PL_OK;
}

pl_status pl_grid_keys_check(const pl_grid_def *def, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < def->varied_count && status == PL_OK; ++i) {
        status = check_key(def, i, error);
    }
    return status;
}
