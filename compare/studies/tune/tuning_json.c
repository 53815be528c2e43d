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
                                       "seed", "targets", "parameters", "budget",    NULL};
    json_t *study = json_object();
    pl_study_copy(study, run, keys);
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

static void repeat_search(pl_tuner *t)
{
    const size_t trials = json_array_size(t->points);
    pl_evaluate_defaults(t);
    t->found.evaluations = pl_heap_new(trials + 1, sizeof *t->found.evaluations);
    for (size_t i = 0; i < trials && t->status == PL_OK; ++i) {
        pl_evaluation evaluation = {
            .cost = (double)INFINITY, .excess = PL_SEARCH_WORST, .trial = (int)i};
        if (!json_is_null(json_array_get(t->points, i))) {
            pl_evaluation_make(t, &evaluation);
            pl_search_add(&t->found, &evaluation);
        }
    }
    if (t->status == PL_OK && t->found.count == 0) {
        t->status =
            pl_fail(t->error, PL_BAD_INPUT, "the tuning has no trial yet: --resume goes on");
    }
    pl_tuner_choose(t);
}

/* ---- Sensitivities ---- */

/* The values of a result of the answer or of a neighbour of it; NULL: it is another one. */
static const json_t *near_answer(const pl_tuner *t, const json_t *row)
{
    return strcmp(pl_study_text(row, "study.phase"), "sensitivity") == 0 &&
                   pl_study_integer(row, "study.trial") == t->best.trial
               ? pl_study_get(row, "study.values")
               : NULL;
}

/* The values of the runs next to the answer in which that parameter is moved down (direction < 0) or up; NULL: none. */
static const json_t *find_moved(const pl_tuner *t, const json_t *answer, size_t parameter,
                                int direction)
{
    const double from = json_number_value(json_array_get(answer, parameter));
    const json_t *found = NULL;
    const char *key;
    json_t *row;
    json_object_foreach(t->rows, key, row)
    {
        const json_t *values = near_answer(t, row);
        const double by = json_number_value(json_array_get(values, parameter)) - from;
        found = values != NULL && by * direction > 0 ? values : found;
    }
    return found;
}

static json_t *sensitivities_json(const pl_tuner *t)
{
    const pl_subject answer = pl_tuner_trial(t, "sensitivity", t->best.trial);
    const json_t *parameters = json_object_get(t->study, "parameters");
    const pl_metric_id metric =
        t->by_instructions ? PL_METRIC_INSTRUCTIONS_PER_STEP : PL_METRIC_TIME_PER_STEP;
    json_t *all = json_array();
    for (size_t i = 0; i < 2 * json_array_size(parameters); ++i) {
        pl_subject there = answer;
        there.values = find_moved(t, answer.values, i / 2, i % 2 == 0 ? -1 : 1);
        if (there.values != NULL) {
            const double ratio =
                pl_tuner_cost(t, metric, &there, &answer, 0, pl_tuner_sensitivity_repeats(t));
            json_array_append_new(
                all,
                json_pack("{s:O, s:O, s:O, s:o, s:f}", "key",
                          json_object_get(json_array_get(parameters, i / 2), "key"), "from",
                          json_array_get(answer.values, i / 2), "to",
                          json_array_get(there.values, i / 2), "cost_ratio",
                          pl_json_number_or_null(ratio), "excess", pl_tuner_excess(t, &there)));
        }
    }
    return all;
}

/* Whether all repeats of a subject are there on every case of which the run of `begun` is. */
static bool is_complete(const pl_tuner *t, const pl_subject *subject, const pl_subject *begun)
{
    for (int p = 0; p < t->case_count; ++p) {
        for (int i = 0; i < pl_tuner_sensitivity_repeats(t); ++i) {
            if (pl_tuner_row(t, begun, p, 0) != NULL && pl_tuner_row(t, subject, p, i) == NULL) {
                return false;
            }
        }
    }
    return true;
}

/* Whether the tuning came to its end: its last runs are those of the answer and of its neighbours. */
static bool is_finished(const pl_tuner *t)
{
    const pl_subject answer = pl_tuner_trial(t, "sensitivity", t->best.trial),
                     tried = pl_tuner_trial(t, "search", t->best.trial);
    bool finished = is_complete(t, &answer, &tried);
    const char *key;
    json_t *row;
    json_object_foreach(t->rows, key, row)
    {
        pl_subject moved = answer;
        moved.values = near_answer(t, row);
        finished = finished && (moved.values == NULL || is_complete(t, &moved, &moved));
    }
    return finished;
}

/* ---- The conclusion ---- */

/* A result of the answer. */
static const json_t *answer_row(const pl_tuner *t)
{
    static const char *const phases[] = {"final", "search"};
    const json_t *row = NULL;
    for (int i = 0; i < 2 * t->case_count && row == NULL; ++i) {
        const pl_subject answer = pl_tuner_trial(t, phases[i / t->case_count], t->best.trial);
        row = pl_tuner_row(t, &answer, i % t->case_count, 0);
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

/* The CPU time of a subject on a case over that of another, or in s a simulated second. */
static json_t *time_json(const pl_tuner *t, const pl_subject *mine, const pl_subject *other,
                         int test_case)
{
    return pl_json_number_or_null(
        pl_tuner_ratio(t, PL_METRIC_TIME_PER_STEP, mine, other, test_case, 0, PL_TUNE_REPEATS));
}

static json_t *scores_json(const pl_tuner *t)
{
    const pl_subject mine = pl_tuner_trial(t, "final", t->best.trial),
                     defaults = {.phase = "final", .trial = -1};
    json_t *list = json_array();
    for (int p = 0; p < t->case_count; ++p) {
        const json_t *row = pl_tuner_row(t, &mine, p, 0),
                     *shipped = pl_tuner_row(t, &defaults, p, 0);
        json_array_append_new(
            list,
            json_pack("{s:s, s:s, s:o, s:f, s:o, s:o, s:o, s:s, s:o}", "scenario",
                      pl_tuner_scenario(t, p), "outcome", pl_json_get_text(row, "outcome"),
                      "metrics", pl_targets_values(&t->targets, row), "excess",
                      pl_targets_excess(&t->targets, row), "cost_ratio",
                      time_json(t, &mine, &defaults, p), "seconds", time_json(t, &mine, NULL, p),
                      "shipped_seconds", time_json(t, &defaults, NULL, p), "shipped_outcome",
                      pl_json_get_text(shipped, "outcome"), "shipped_metrics",
                      pl_targets_values(&t->targets, shipped)));
    }
    return list;
}

static json_t *trials_json(const pl_tuner *t)
{
    const json_t *parameters = json_object_get(t->study, "parameters");
    json_t *list = json_array();
    for (int i = 0; i < t->found.count; ++i) {
        const pl_evaluation *evaluation = &t->found.evaluations[i];
        const json_t *point = pl_tuner_trial(t, "search", evaluation->trial).values;
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

static json_t *tuning_json(const pl_tuner *t, const json_t *results)
{
    static const char *const kept[] = {"engine",   "engine_version", "profile", "host",
                                       PL_PROGRAM, "command",        NULL};
    static const char *const asked[] = {"scenarios", "targets", "seed", "budget", NULL};
    json_t *json = json_pack(
        "{s:s, s:b, s:b, s:b, s:b, s:o, s:b, s:f, s:o, s:o, s:o, s:O, s:i, s:s, s:i, s:o}",
        "schema", "plumb.tuning/1", "finished", (int)is_finished(t), "met", (int)t->met,
        "has_margin", (int)t->has_margin, "validated",
        (int)(t->met && json_array_size(t->checks) > 0 && t->missed == 0), "cost",
        pl_json_number_or_null(t->cost), "cost_is_ratio", (int)t->default_has_cost, "excess",
        t->best.excess, "setting", setting_json(t), "on", scores_json(t), "sensitivity",
        sensitivities_json(t), "validation", t->checks, "passed_over", t->passed_over,
        "search_cost", t->by_instructions ? "instructions" : "cpu_time", "runs",
        (int)json_array_size(results), "trials", trials_json(t));
    pl_study_copy(json, answer_row(t), kept);
    pl_study_copy(json, t->study, asked);
    return json;
}

pl_status pl_tune_conclude(const json_t *results, const char *folder, json_t **conclusion,
                           pl_error *error)
{
    const json_t *last = json_array_get(results, json_array_size(results) - 1);
    json_t *study = shared_of(json_object_get(last, "study"));
    pl_tuner t = pl_tuner_begin(study, error);
    (void)folder;
    t.status =
        t.targets.count > 0 && t.case_count > 0
            ? take_results(&t, results, error)
            : pl_fail(error, PL_BAD_INPUT, "results[%zu].study: expected scenarios and targets",
                      json_array_size(results) - 1);
    if (t.status == PL_OK) {
        repeat_search(&t);
    }
    if (t.status == PL_OK) {
        *conclusion = tuning_json(&t, results);
    }
    pl_tuner_free(&t);
    json_decref(study);
    return t.status;
}

json_t *pl_tune_profile(const json_t *conclusion)
{
    static const char *const kept[] = {
        "engine",    "engine_version", "profile", "scenarios", "targets",
        "validated", "budget",         "command", PL_PROGRAM,  NULL};
    const json_t *setting = json_object_get(conclusion, "setting");
    char made[32];
    pl_timestamp(made);
    json_t *profile = json_pack("{s:s, s:s, s:O?, s:O?, s:s}", "schema", "plumb.profile/1", "name",
                                "tuned", "dt", json_object_get(setting, "dt"), "options",
                                json_object_get(setting, "options"), "made", made);
    pl_study_copy(profile, conclusion, kept);
    return profile;
}
