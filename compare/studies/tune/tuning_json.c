/* The conclusion of a tuning, plumb.tuning/1, from its results; and plumb.profile/1. */
#include "base/heap.h"
#include "base/program_name.h"
#include "tuner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The largest budget of a study that is read. */
enum { MOST_TRIALS = 100000 };

/* ---- Results ---- */

/* What all runs have in their `study`, of one of them. */
static json_t *shared_of(const json_t *run)
{
    static const char *const keys[] = {"name", "engine",  "dt",         "scenarios", "scenes",
                                       "seed", "targets", "parameters", "budget"};
    json_t *study = json_object();
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) {
        json_t *value = json_object_get(run, keys[i]);
        json_object_set_new(study, keys[i], value == NULL ? json_null() : json_incref(value));
    }
    return study;
}

/* Whether the `study` of a run says which run it is. */
static bool is_whole(const json_t *run)
{
    const json_t *trial = json_object_get(run, "trial"), *values = json_object_get(run, "values");
    const json_int_t number = json_integer_value(trial);
    return (json_is_null(trial) || (number >= 0 && number < MOST_TRIALS)) &&
           (json_is_null(values) ||
            json_array_size(values) == json_array_size(json_object_get(run, "parameters")));
}

/* Takes the results of the engine's build that made the last one, and of its scenes. */
static pl_status take_results(pl_tuner *t, const json_t *results, pl_error *error)
{
    const size_t last = json_array_size(results) - 1;
    const char *build = pl_json_get_text(json_array_get(results, last), "engine_binary");
    for (size_t i = 0; i <= last; ++i) {
        json_t *result = json_array_get(results, i);
        const json_t *run = json_object_get(result, "study");
        if (!is_whole(run)) {
            return pl_fail(error, PL_BAD_INPUT, "results[%zu].study: expected a run of a tuning",
                           i);
        }
        if (!pl_tuner_is_of(t->study, run)) {
            return pl_fail(error, PL_BAD_INPUT,
                           "results[%zu].study: of another tuning than results[%zu]: they are "
                           "concluded one at a time",
                           i, last);
        }
        if (strcmp(pl_json_get_text(result, "engine_binary"), build) == 0 &&
            json_equal(json_object_get(run, "scenes"), json_object_get(t->study, "scenes"))) {
            pl_tuner_take(t, result);
        }
    }
    return PL_OK;
}

/* ---- The search and the choice again ---- */

static pl_status repeat_search(pl_tuner *t, pl_error *error)
{
    const size_t trials = json_array_size(t->points);
    pl_status status = pl_evaluate_defaults(t, error);
    t->found.evaluations = pl_heap_new(trials + 1, sizeof *t->found.evaluations);
    for (size_t i = 0; i < trials && status == PL_OK; ++i) {
        pl_evaluation evaluation = {
            .cost = (double)INFINITY, .excess = PL_SEARCH_WORST, .trial = (int)i};
        if (!json_is_null(json_array_get(t->points, i))) {
            status = pl_evaluation_make(t, &evaluation, error);
            pl_search_add(&t->found, &evaluation);
        }
    }
    if (status == PL_OK && t->found.count == 0) {
        status = pl_fail(error, PL_BAD_INPUT, "the tuning has no trial yet: --resume goes on");
    }
    return status == PL_OK ? pl_tuner_choose(t, error) : status;
}

/* ---- Sensitivities ---- */

/* The answer with one parameter moved. */
typedef struct moved {
    size_t parameter;
    double value;
    const json_t *values;
} moved;

static int by_parameter(const void *left, const void *right)
{
    const moved *a = left, *b = right;
    return a->parameter != b->parameter
               ? (a->parameter > b->parameter) - (a->parameter < b->parameter)
               : (a->value > b->value) - (a->value < b->value);
}

/* Lists the neighbours of the answer that have rows, each once: (count), malloc'd. */
static moved *list_moved(const pl_tuner *t, int *count)
{
    const json_t *answer = pl_tuner_trial(t, t->best.trial).values;
    moved *list = NULL;
    int kept = 0;
    size_t index, k;
    json_t *values, *value;
    *count = 0;
    json_array_foreach(t->moved, index, values)
    {
        json_array_foreach(values, k, value)
        {
            if (json_number_value(value) != json_number_value(json_array_get(answer, k))) {
                const moved added = {k, json_number_value(value), values};
                pl_push(&list, count, &added, sizeof added);
                break;
            }
        }
    }
    if (*count > 0) {
        qsort(list, (size_t)*count, sizeof *list, by_parameter);
    }
    for (int i = 0; i < *count; ++i) {
        if (i == 0 || by_parameter(&list[i], &list[kept - 1]) != 0) {
            list[kept++] = list[i];
        }
    }
    *count = kept;
    return list;
}

/* The geometric mean over the scenarios of the ratio of costs. */
static double mean_cost_ratio(const pl_tuner *t, const pl_reading *readings,
                              const pl_reading *others, int repeats)
{
    double sum = 0;
    for (int p = 0; p < t->case_count; ++p) {
        sum += log(t->by_instructions ? readings[p].instructions[0] / others[p].instructions[0]
                                      : pl_score_ratio(&readings[p], &others[p], 0, repeats));
    }
    return exp(sum / t->case_count);
}

static json_t *sensitivities_json(pl_tuner *t)
{
    int count = 0;
    moved *list = list_moved(t, &count);
    pl_subject *subjects = pl_heap_new((size_t)count + 1, sizeof *subjects);
    const json_t *parameters = json_object_get(t->study, "parameters");
    json_t *all = json_array();
    subjects[0] = pl_tuner_trial(t, t->best.trial);
    for (int i = 0; i < count; ++i) {
        subjects[i + 1] = (pl_subject){t->best.trial, list[i].values};
    }
    const pl_tuner_runs runs = {.phase = "sensitivity",
                                .subjects = subjects,
                                .count = count + 1,
                                .repeats = t->by_instructions ? 1 : PL_TUNER_REPEATS};
    pl_readings readings;
    pl_tuner_measure(t, runs, &readings, NULL);
    for (int i = 0; i < count; ++i) {
        const pl_reading *mine = pl_readings_of(&readings, i + 1);
        const double ratio =
            mean_cost_ratio(t, mine, pl_readings_of(&readings, 0), readings.repeats);
        json_array_append_new(
            all, json_pack("{s:O, s:O, s:f, s:o, s:f}", "key",
                           json_object_get(json_array_get(parameters, list[i].parameter), "key"),
                           "from", json_array_get(subjects[0].values, list[i].parameter), "to",
                           list[i].value, "cost_ratio", pl_json_number_or_null(ratio), "excess",
                           pl_tuner_excess(t, mine)));
    }
    pl_readings_free(&readings);
    free(subjects);
    free(list);
    return all;
}

/* ---- The conclusion ---- */

/* A result of the answer. */
static const json_t *answer_row(const pl_tuner *t)
{
    static const char *const phases[] = {"final", "search"};
    const json_t *row = NULL;
    for (int i = 0; i < 2 * t->case_count && row == NULL; ++i) {
        row = pl_tuner_row(t, phases[i / t->case_count], pl_tuner_trial(t, t->best.trial),
                           i % t->case_count);
    }
    return row;
}

static json_t *setting_json(const pl_tuner *t)
{
    const json_t *row = answer_row(t), *study = json_object_get(row, "study");
    json_t *options = json_copy(json_object_get(row, "settings"));
    json_t *setting = json_pack("{s:O?, s:O?, s:o, s:O?}", "spec", json_object_get(study, "spec"),
                                "dt", json_object_get(options, "dt"), "options", options, "api",
                                json_object_get(study, "api"));
    json_object_del(options, "dt");
    json_object_del(options, "duration");
    return setting;
}

static json_t *scores_json(const pl_tuner *t)
{
    const pl_reading *mine = pl_readings_of(&t->final, t->place + 1),
                     *defaults = pl_readings_of(&t->final, 0);
    json_t *list = json_array();
    for (int p = 0; p < t->case_count; ++p) {
        json_array_append_new(
            list,
            json_pack(
                "{s:O, s:s, s:o, s:f, s:o, s:o, s:o, s:s, s:o}", "scenario",
                json_array_get(json_object_get(t->study, "scenarios"), (size_t)p), "outcome",
                mine[p].outcome, "metrics", pl_target_values(&t->targets, &mine[p].target),
                "excess", mine[p].target.excess, "cost_ratio",
                pl_json_number_or_null(pl_score_ratio(&mine[p], &defaults[p], 0, PL_TUNE_REPEATS)),
                "seconds",
                pl_json_number_or_null(pl_score_ratio(&mine[p], NULL, 0, PL_TUNE_REPEATS)),
                "shipped_seconds",
                pl_json_number_or_null(pl_score_ratio(&defaults[p], NULL, 0, PL_TUNE_REPEATS)),
                "shipped_outcome", defaults[p].outcome, "shipped_metrics",
                pl_target_values(&t->targets, &defaults[p].target)));
    }
    return list;
}

static json_t *trials_json(const pl_tuner *t)
{
    const json_t *parameters = json_object_get(t->study, "parameters");
    json_t *list = json_array();
    for (int i = 0; i < t->found.count; ++i) {
        const pl_evaluation *evaluation = &t->found.evaluations[i];
        const json_t *point = pl_tuner_trial(t, evaluation->trial).values;
        json_t *values = json_object(), *parameter;
        size_t k;
        json_array_foreach((json_t *)parameters, k, parameter)
        {
            json_object_set(values, pl_json_get_text(parameter, "key"), json_array_get(point, k));
        }
        json_array_append_new(list, json_pack("{s:o, s:o, s:f, s:b}", "values", values, "cost",
                                              pl_json_number_or_null(evaluation->cost), "excess",
                                              evaluation->excess, "holds", (int)evaluation->holds));
    }
    return list;
}

static json_t *tuning_json(pl_tuner *t, const json_t *results)
{
    static const char *const kept[] = {"engine", "engine_version", "profile",
                                       "host",   PL_PROGRAM,       "command"};
    static const char *const asked[] = {"scenarios", "targets", "seed", "budget"};
    const json_t *first = answer_row(t);
    json_t *json = json_pack(
        "{s:s, s:b, s:b, s:b, s:o, s:b, s:f, s:o, s:o, s:o, s:O, s:i, s:s, s:i, s:o}", "schema",
        "plumb.tuning/1", "met", (int)t->met, "has_margin", (int)t->has_margin, "validated",
        (int)(t->met && json_array_size(t->checks) > 0 && t->missed == 0), "cost",
        pl_json_number_or_null(t->cost), "cost_is_ratio", (int)t->default_has_cost, "excess",
        t->best.excess, "setting", setting_json(t), "on", scores_json(t), "sensitivity",
        sensitivities_json(t), "validation", t->checks, "passed_over", t->passed_over,
        "search_cost", t->by_instructions ? "instructions" : "cpu_time", "runs",
        (int)json_array_size(results), "trials", trials_json(t));
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; ++i) {
        json_object_set(json, kept[i], json_object_get(first, kept[i]));
    }
    for (size_t i = 0; i < sizeof asked / sizeof asked[0]; ++i) {
        json_object_set(json, asked[i], json_object_get(t->study, asked[i]));
    }
    return json;
}

pl_status pl_tune_conclude(const json_t *results, const char *folder, json_t **conclusion,
                           pl_error *error)
{
    const json_t *last = json_array_get(results, json_array_size(results) - 1);
    json_t *study = shared_of(json_object_get(last, "study"));
    pl_tuner t = pl_tuner_begin(study, error);
    (void)folder;
    pl_status status =
        t.targets.count > 0 && t.case_count > 0
            ? take_results(&t, results, error)
            : pl_fail(error, PL_BAD_INPUT, "results[%zu].study: expected scenarios and targets",
                      json_array_size(results) - 1);
    if (status == PL_OK) {
        status = repeat_search(&t, error);
    }
    if (status == PL_OK) {
        *conclusion = tuning_json(&t, results);
    }
    pl_tuner_free(&t);
    json_decref(study);
    return status;
}

json_t *pl_tune_profile(const json_t *conclusion)
{
    static const char *const kept[] = {"engine",    "engine_version", "profile",
                                       "scenarios", "targets",        "validated",
                                       "budget",    "command",        PL_PROGRAM};
    const json_t *setting = json_object_get(conclusion, "setting");
    char made[32];
    pl_timestamp(made);
    json_t *profile = json_pack("{s:s, s:s, s:O?, s:O?, s:s}", "schema", "plumb.profile/1", "name",
                                "tuned", "dt", json_object_get(setting, "dt"), "options",
                                json_object_get(setting, "options"), "made", made);
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; ++i) {
        json_object_set(profile, kept[i], json_object_get(conclusion, kept[i]));
    }
    return profile;
}
