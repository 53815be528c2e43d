#include "grid_keys.h"

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

int pl_grid_param(const pl_scenario *scenario, const char *name)
{
    for (int i = 0; i < scenario->param_count; ++i) {
        if (strcmp(scenario->params[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

int pl_grid_profile(const pl_engine *engine, const char *name)
{
    for (int i = 0; i < engine->profile_count; ++i) {
        if (strcmp(engine->profiles[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

static bool is_of(const pl_vary *vary, const char *name)
{
    return vary->owner[0] == '\0' || strcmp(vary->owner, name) == 0;
}

static bool case_has(const pl_case *test_case, const pl_vary *vary)
{
    if (!is_of(vary, test_case->name)) {
        return false;
    }
    return test_case->descriptor == NULL ? strcmp(vary->key, "dt") == 0
                                         : pl_grid_param(test_case->descriptor, vary->key) >= 0;
}

/* How many of the profiles named the engine has. */
static int profiles_of(const pl_engine *engine, const pl_vary *vary)
{
    int count = 0;
    for (int i = 0; i < vary->count; ++i) {
        count += pl_grid_profile(engine, vary->names[i]) >= 0;
    }
    return count;
}

static bool configuration_has(const pl_configuration *configuration, const pl_vary *vary)
{
    const pl_engine *engine = configuration->choice.engine;
    if (!is_of(vary, engine->name)) {
        return false;
    }
    return strcmp(vary->key, PL_VARY_PROFILE) == 0 ? profiles_of(engine, vary) > 0
                                                   : pl_engine_option_index(engine, vary->key) >= 0;
}

/* Whether another key, restricted to `name`, takes the place of this one there. */
static bool is_replaced(const pl_grid_def *def, const pl_vary *vary, const char *name)
{
    for (int i = 0; vary->owner[0] == '\0' && i < def->varied_count; ++i) {
        const pl_vary *other = &def->varied[i];
        if (strcmp(other->owner, name) == 0 && strcmp(other->key, vary->key) == 0) {
            return true;
        }
    }
    return false;
}

pl_grid_keys pl_grid_keys_of_case(const pl_grid_def *def, const pl_case *test_case)
{
    pl_grid_keys keys = {.count = 0};
    for (int i = 0; i < def->varied_count; ++i) {
        const pl_vary *vary = &def->varied[i];
        if (case_has(test_case, vary) && !is_replaced(def, vary, test_case->name)) {
            keys.values[keys.count] = vary->count;
            keys.items[keys.count++] = i;
        }
    }
    return keys;
}

pl_grid_keys pl_grid_keys_of_configuration(const pl_grid_def *def,
                                           const pl_configuration *configuration)
{
    pl_grid_keys keys = {.count = 0};
    const pl_engine *engine = configuration->choice.engine;
    const char *name = engine->name;
    for (int i = 0; i < def->varied_count; ++i) {
        const pl_vary *vary = &def->varied[i];
        if (configuration_has(configuration, vary) && !is_replaced(def, vary, name)) {
            const bool is_profile = strcmp(vary->key, PL_VARY_PROFILE) == 0;
            keys.values[keys.count] = is_profile ? profiles_of(engine, vary) : vary->count;
            keys.items[keys.count++] = i;
        }
    }
    return keys;
}

/* The names that a word could have meant. */
typedef struct names {
    const char **items;
    int count;
} names;

static bool add_name(names *n, const char *name)
{
    const char **grown = realloc(n->items, ((size_t)n->count + 1) * sizeof *grown);
    if (grown == NULL) {
        return false;
    }
    n->items = grown;
    n->items[n->count++] = name;
    return true;
}

/* All keys of what the owner restricts to; of everything when that is empty. */
static bool list_keys(const pl_grid_def *def, const pl_vary *vary, names *n)
{
    bool fine = add_name(n, "dt") && add_name(n, PL_VARY_PROFILE) && add_name(n, "solver");
    for (int i = 0; i < def->base->case_count; ++i) {
        const pl_case *test_case = &def->base->cases[i];
        const pl_scenario *scenario = test_case->descriptor;
        for (int k = 0;
             scenario != NULL && is_of(vary, test_case->name) && k < scenario->param_count; ++k) {
            fine = fine && add_name(n, scenario->params[k].name);
        }
    }
    for (int i = 0; i < def->base->configuration_count; ++i) {
        const pl_engine *engine = def->base->configurations[i].choice.engine;
        for (int k = 0; is_of(vary, engine->name) && k < engine->option_count; ++k) {
            fine = fine && add_name(n, engine->options[k].name);
        }
    }
    return fine;
}

static bool list_owners(const pl_grid_def *def, names *n)
{
    bool fine = true;
    for (int i = 0; i < def->base->case_count; ++i) {
        fine = fine && add_name(n, def->base->cases[i].name);
    }
    for (int i = 0; i < def->base->configuration_count; ++i) {
        fine = fine && add_name(n, def->base->configurations[i].choice.engine->name);
    }
    return fine;
}

static bool is_there(const names *n, const char *name)
{
    for (int i = 0; i < n->count; ++i) {
        if (strcmp(n->items[i], name) == 0) {
            return true;
        }
    }
    return false;
}

static pl_status fail_unknown(const char *what, const char *word, const names *n, pl_error *error)
{
    char suggestion[PL_SUGGESTION_SIZE];
    return pl_fail(error, PL_BAD_INPUT, "--vary: %s %s%s", what, word,
                   pl_did_you_mean(word, n->items, n->count, suggestion));
}

static bool is_absent_engine(const char *name)
{
    int count = 0;
    const pl_known_engine *known = pl_known_engines(&count);
    for (int i = 0; i < count; ++i) {
        if (strcmp(known[i].name, name) == 0) {
            return known[i].engine == NULL;
        }
    }
    return false;
}

/* A key that goes nowhere. */
static pl_status reject(const pl_grid_def *def, const pl_vary *vary, pl_error *error)
{
    names owners = {.count = 0}, keys = {.count = 0};
    char what[2 * PL_NAME_SIZE];
    pl_status status = PL_BAD_INPUT;
    if (!list_owners(def, &owners) || !list_keys(def, vary, &keys)) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for --vary");
    } else if (vary->owner[0] == '\0') {
        fail_unknown("no chosen scenario has the parameter, and no chosen engine the option,",
                     vary->key, &keys, error);
    } else if (!is_there(&owners, vary->owner)) {
        fail_unknown("there is no chosen engine or scenario", vary->owner, &owners, error);
    } else {
        snprintf(what, sizeof what, "%s has no", vary->owner);
        fail_unknown(what, vary->key, &keys, error);
    }
    free(owners.items);
    free(keys.items);
    return status;
}

/* Every profile named must be one of some engine. */
static pl_status check_profiles(const pl_grid_def *def, const pl_vary *vary, pl_error *error)
{
    names known = {.count = 0};
    pl_status status = PL_OK;
    for (int i = 0; i < def->base->configuration_count && status == PL_OK; ++i) {
        const pl_engine *engine = def->base->configurations[i].choice.engine;
        for (int k = 0; is_of(vary, engine->name) && k < engine->profile_count; ++k) {
            if (!add_name(&known, engine->profiles[k].name)) {
                status = pl_fail(error, PL_NO_MEMORY, "out of memory for --vary");
            }
        }
    }
    for (int i = 0; i < vary->count && status == PL_OK; ++i) {
        if (!is_there(&known, vary->names[i])) {
            status =
                fail_unknown("no chosen engine has the profile", vary->names[i], &known, error);
        }
    }
    free(known.items);
    return status;
}

static bool owner_is_chosen(const pl_grid_def *def, const pl_vary *vary)
{
    for (int i = 0; i < def->base->configuration_count; ++i) {
        if (is_of(vary, def->base->configurations[i].choice.engine->name)) {
            return true;
        }
    }
    return false;
}

static pl_status check_key(const pl_grid_def *def, int index, pl_error *error)
{
    const pl_vary *vary = &def->varied[index];
    bool of_case = false, of_configuration = false;
    for (int i = 0; i < index; ++i) {
        if (strcmp(def->varied[i].owner, vary->owner) == 0 &&
            strcmp(def->varied[i].key, vary->key) == 0) {
            return pl_fail(error, PL_BAD_INPUT, "--vary %s%s%s is given twice", vary->owner,
                           vary->owner[0] == '\0' ? "" : ".", vary->key);
        }
    }
    for (int i = 0; i < def->base->case_count; ++i) {
        of_case = of_case || case_has(&def->base->cases[i], vary);
    }
    for (int i = 0; i < def->base->configuration_count; ++i) {
        of_configuration =
            of_configuration || configuration_has(&def->base->configurations[i], vary);
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
    const bool is_profile = strcmp(vary->key, PL_VARY_PROFILE) == 0;
    if (!of_case && !of_configuration && (!is_profile || !owner_is_chosen(def, vary))) {
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
