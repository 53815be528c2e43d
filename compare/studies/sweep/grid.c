#include "grid.h"

#include "grid_configurations.h"
#include "grid_keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SETTING_SIZE = PL_NAME_SIZE + 32 };

/* A problem of the whole grid: which combination of the values of the keys of which of the base's.
 */
typedef struct place {
    int base;
    long combination;
} place;

typedef struct grid {
    const pl_grid_def *def;
    pl_grid_keys *keys; /* (of the base's problems) */
    place *places;      /* (count): each problem once */
    int count;
} grid;

/* The settings of all parameters of a catalogue problem, varied. */
static void list_settings(const grid *g, const place *at, char (*settings)[SETTING_SIZE])
{
    const pl_case *problem = &g->def->base->cases[at->base];
    const pl_scenario *scenario = problem->descriptor;
    const pl_grid_keys *keys = &g->keys[at->base];
    for (int i = 0; i < scenario->param_count; ++i) {
        double value = problem->params[i];
        for (int k = 0; k < keys->count; ++k) {
            const pl_vary *vary = &g->def->varied[keys->items[k]];
            if (strcmp(vary->key, scenario->params[i].name) == 0) {
                value = vary->numbers[pl_grid_digit(keys, at->combination, k)];
            }
        }
        snprintf(settings[i], SETTING_SIZE, "%s=%.17g", scenario->params[i].name, value);
    }
}

/* Of a scene file. NAN: its own. */
static double time_step(const grid *g, const place *at)
{
    const pl_grid_keys *keys = &g->keys[at->base];
    return keys->count == 0
               ? g->def->dt
               : g->def->varied[keys->items[0]].numbers[pl_grid_digit(keys, at->combination, 0)];
}

static void point_at(char (*settings)[SETTING_SIZE], const char **texts)
{
    for (int i = 0; i < PL_MAX_PARAMS; ++i) {
        texts[i] = settings[i];
    }
}

/* What tells the problem from others; malloc'd. PL_BAD_INPUT: a value out of its range. */
static pl_status name_place(const grid *g, const place *at, char **name, pl_error *error)
{
    const pl_case *problem = &g->def->base->cases[at->base];
    char settings[PL_MAX_PARAMS][SETTING_SIZE];
    const char *texts[PL_MAX_PARAMS];
    double values[PL_MAX_PARAMS] = {time_step(g, at)};
    int count = 1;
    pl_status status = PL_OK;
    if (problem->descriptor != NULL) {
        pl_error why = {.message = ""};
        count = problem->descriptor->param_count;
        list_settings(g, at, settings);
        point_at(settings, texts);
        status = pl_scenario_values(problem->descriptor, texts, count, values, &why);
        if (status != PL_OK) {
            return pl_fail(error, status, "--vary: %s", why.message);
        }
    }
    size_t length = 0;
    FILE *stream = open_memstream(name, &length);
    if (stream == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for the grid");
    }
    fputs(problem->name, stream);
    for (int i = 0; i < count; ++i) {
        fprintf(stream, "\n%a", values[i]);
    }
    return fclose(stream) == 0 ? PL_OK : pl_fail(error, PL_NO_MEMORY, "out of memory for the grid");
}

/* All problems of the grid, equal ones once. */
static pl_status list_places(grid *g, long most, pl_error *error)
{
    json_t *seen = json_object();
    pl_status status = PL_OK;
    g->places = malloc(((size_t)most + 1) * sizeof *g->places);
    if (g->places == NULL || seen == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for the grid");
    }
    for (int i = 0; i < g->def->base->case_count; ++i) {
        const long size = (long)pl_grid_combinations(&g->keys[i]);
        for (long k = 0; k < size && status == PL_OK; ++k) {
            const place at = {.base = i, .combination = k};
            char *name = NULL;
            status = name_place(g, &at, &name, error);
            if (status == PL_OK && json_object_get(seen, name) == NULL) {
                g->places[g->count++] = at;
                if (json_object_set_new_nocheck(seen, name, json_true()) != 0) {
                    status = pl_fail(error, PL_NO_MEMORY, "out of memory for the grid");
                }
            }
            free(name);
        }
    }
    json_decref(seen);
    return status;
}

static pl_status add_place(const grid *g, const place *at, pl_plan *plan, pl_error *error)
{
    const pl_case *problem = &g->def->base->cases[at->base];
    if (problem->descriptor == NULL) {
        return pl_plan_add_scene_file(plan, problem->name, time_step(g, at), g->def->duration,
                                      error);
    }
    char settings[PL_MAX_PARAMS][SETTING_SIZE];
    const char *texts[PL_MAX_PARAMS];
    list_settings(g, at, settings);
    point_at(settings, texts);
    return pl_plan_add_scenario(plan, problem->descriptor, texts, problem->descriptor->param_count,
                                error);
}

/* The problem and its points, as far as they are the shard's. */
static pl_status add_share(const grid *g, int number, pl_plan *plan, pl_error *error)
{
    const pl_shard *shard = &g->def->shard;
    const int problem = plan->case_count;
    pl_status status = PL_OK;
    for (int i = 0; i < plan->configuration_count && status == PL_OK; ++i) {
        if (pl_shard_of_point(shard->count, g->count, plan->configuration_count, number, i) !=
            shard->index) {
            continue;
        }
        if (plan->case_count == problem) {
            status = add_place(g, &g->places[number], plan, error);
        }
        /* A plan of whole problems needs no list of points. */
        if (status != PL_OK || plan->case_count == problem || g->count >= shard->count) {
            break;
        }
        status = pl_plan_add_pairing(plan, problem, i, error);
    }
    return status;
}

/* The runs of the whole grid must not be too many. */
static pl_status check_size(const pl_grid_def *def, double problems, double configurations,
                            pl_error *error)
{
    const double runs = problems * fmax(configurations, 1) * def->base->repeats;
    return runs <= PL_GRID_MOST_RUNS
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT,
                         "%.0f problems x %.0f engines x %d repeats are %.0f runs; a sweep has at "
                         "most %d",
                         problems, configurations, def->base->repeats, runs,
                         (int)PL_GRID_MOST_RUNS);
}

pl_status pl_grid_plan(const pl_grid_def *def, pl_plan *plan, pl_error *error)
{
    grid g = {.def = def};
    double problems = 0;
    pl_status status = pl_grid_keys_check(def, error);
    if (status != PL_OK) {
        return status;
    }
    g.keys = calloc((size_t)def->base->case_count + 1, sizeof *g.keys);
    if (g.keys == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for the grid");
    }
    for (int i = 0; i < def->base->case_count; ++i) {
        g.keys[i] = pl_grid_keys_of_problem(def, &def->base->cases[i]);
        problems += pl_grid_combinations(&g.keys[i]);
    }
    plan->repeats = def->base->repeats;
    plan->seed = def->base->seed;
    plan->defers = true;
    status = check_size(def, problems, pl_grid_contender_count(def), error);
    if (status == PL_OK) {
        status = pl_grid_add_contenders(def, plan, error);
    }
    if (status == PL_OK) {
        status = list_places(&g, (long)problems, error);
    }
    for (int i = 0; i < g.count && status == PL_OK; ++i) {
        status = add_share(&g, i, plan, error);
    }
    free(g.keys);
    free(g.places);
    return status;
}
