/* The steps of tuning: the search, the choice among its best points, their sensitivities and the
 * validation. */
#include "studies/tunable.h"
#include "tuner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Writes one line per evaluation where progress is not shown on a terminal. */
static void log_evaluation(const pl_tuner *t, const pl_evaluation *evaluation)
{
    if (t->bar.terminal) {
        return;
    }
    FILE *out = t->how->progress;
    const pl_setting setting =
        pl_tune_setting(t->def->space, pl_tuner_trial(t, "search", evaluation->trial).values);
    fprintf(out, "[%d/%d] %s at 1/%.4g s: cost x %.3g, ", evaluation->trial + 1, t->def->budget,
            setting.choice.spec, 1 / setting.dt, evaluation->cost);
    if (evaluation->excess >= PL_SEARCH_WORST) {
        fprintf(out, "no value\n");
    } else {
        fprintf(out, "%s by a factor of %.3g%s\n",
                evaluation->holds && evaluation->excess <= 0 ? "meets the target"
                                                             : "misses the target",
                exp(fabs(evaluation->excess)),
                evaluation->holds && evaluation->excess > 0 ? ", likely" : "");
    }
}

/* pl_search_def.measure */
static bool measure(void *user, pl_evaluation *evaluation)
{
    pl_tuner *t = user;
    json_array_append_new(t->points, pl_tune_values(t->def->space, evaluation->values));
    pl_evaluation_make(t, evaluation);
    if (pl_tuner_goes_on(t)) {
        log_evaluation(t, evaluation);
    }
    return pl_tuner_goes_on(t);
}

/* Measures the answer with each parameter moved either way, and then unchanged: these are the last runs of a tuning. */
static void vary_answer(pl_tuner *t)
{
    const pl_tune_space *space = t->def->space;
    const pl_subject answer = pl_tuner_trial(t, "sensitivity", t->best.trial);
    pl_subject subjects[2 * PL_TUNE_MAX_PARAMETERS + 1];
    json_t *moved = json_array();
    int count = 0;
    for (int i = 0; i < 2 * space->parameter_count; ++i) {
        double values[PL_TUNE_MAX_PARAMETERS];
        const int k = i / 2;
        memcpy(values, t->best.values, sizeof values);
        values[k] = pl_tune_neighbour(&space->parameters[k], values[k], i % 2 == 0 ? -1 : 1);
        if (values[k] != t->best.values[k]) {
            json_t *point = pl_tune_values(space, values);
            json_array_append_new(moved, point);
            subjects[count] = answer;
            subjects[count++].values = point;
        }
    }
    subjects[count++] = answer;
    pl_tuner_measure(t, subjects, count, pl_tuner_sensitivity_repeats(t));
    json_decref(moved);
}

static void make_all(pl_tuner *t)
{
    const pl_tune_def *def = t->def;
    const pl_search_def search = {.parameters = def->space->parameters,
                                  .parameter_count = def->space->parameter_count,
                                  .budget = def->budget,
                                  .seed = def->plan->seed,
                                  .user = t,
                                  .measure = measure};
    pl_evaluate_defaults(t);
    if (pl_tuner_goes_on(t)) {
        pl_search(&search, &t->found);
    }
    if (pl_tuner_goes_on(t)) {
        pl_tuner_choose(t);
        vary_answer(t);
    }
}

/* The store must have no runs of another tuning. */
static pl_status check_store(const pl_tuner *t, const pl_store *store, pl_error *error)
{
    json_t *result;
    const char *run;
    json_object_foreach((json_t *)pl_store_runs(store), run, result)
    {
        const json_t *study = json_object_get(result, "study");
        if (strcmp(pl_json_get_text(study, "name"), "tune") == 0 &&
            !pl_tuner_is_of(t->study, study)) {
            return pl_fail(error, PL_BAD_INPUT,
                           "the folder has results of another tuning, of %s: --force replaces "
                           "them, and --out takes another folder",
                           pl_json_get_text(study, "engine"));
        }
    }
    return PL_OK;
}

pl_status pl_tune_run(const pl_tune_def *def, const pl_execution_def *how, int *signal_number,
                      pl_error *error)
{
    json_t *study = pl_tuner_study(def);
    pl_tuner t = pl_tuner_begin(study, error);
    t.def = def;
    t.how = how;
    /* The bar expects about three runs per case and setting. */
    t.bar = pl_progress_begin(how->progress, (long)def->plan->case_count * def->budget * 3,
                              pl_monotonic_seconds());
    t.status = check_store(&t, how->store, error);
    if (t.status == PL_OK) {
        make_all(&t);
    }
    pl_progress_end(&t.bar);
    *signal_number = t.signal_number;
    pl_tuner_free(&t);
    json_decref(study);
    return t.status;
}

const pl_study pl_tune_study = {.name = "tune",
                                .kind = "tuning",
                                .conclude = pl_tune_conclude,
                                .document = pl_tune_fill_document};
