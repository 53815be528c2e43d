#include "reference_study.h"

#include "base/folding.h"
#include "reference_json.h"

#include <stdlib.h>
#include <string.h>

/* ---- Which cases ---- */

int pl_reference_study_cases(const pl_plan *plan)
{
    int count = 0;
    for (int i = 0; i < plan->case_count; ++i) {
        count += pl_reference_applies(&plan->cases[i]);
    }
    return count;
}

/* The item of an earlier outcome with exactly the runs of a case, borrowed; NULL: there is none. */
static json_t *recall(const json_t *before, const pl_plan *plan, const pl_case *test_case)
{
    size_t index;
    json_t *item, *found = NULL;
    json_t *runs = pl_reference_runs_json(plan, test_case);
    json_array_foreach(json_object_get(before, "cases"), index, item)
    {
        found = json_equal(json_object_get(item, "runs"), runs) ? item : found;
    }
    json_decref(runs);
    return found;
}

int pl_reference_study_due(const pl_plan *plan, const json_t *before)
{
    int due = 0;
    for (int i = 0; i < plan->case_count; ++i) {
        const pl_case *test_case = &plan->cases[i];
        due += pl_reference_applies(test_case) && recall(before, plan, test_case) == NULL;
    }
    return due;
}

/* ---- Runs of the compared configurations ---- */

/* Whether a run is known to leave no path to its end. */
static bool is_hopeless(void *user, const char *run)
{
    static const pl_outcome hopeless[] = {PL_OUTCOME_CRASHED, PL_OUTCOME_TIMEOUT,
                                          PL_OUTCOME_UNSUPPORTED};
    const pl_reference_def *def = user;
    size_t index;
    const json_t *result;
    json_array_foreach(def->results, index, result)
    {
        for (size_t i = 0; i < sizeof hopeless / sizeof hopeless[0]; ++i) {
            if (strcmp(pl_json_get_text(result, "run"), run) == 0 &&
                strcmp(pl_json_get_text(result, "outcome"), pl_outcome_name(hopeless[i])) == 0) {
                return true;
            }
        }
    }
    return false;
}

/* Makes the runs of a case again, with their positions. */
static pl_status run_with_positions(pl_reference_def *def, pl_case *test_case, int *signal_number,
                                    pl_error *error)
{
    const pl_plan *plan = def->execution.plan;
    const pl_plan one = {.cases = test_case,
                         .case_count = 1,
                         .configurations = plan->configurations,
                         .configuration_count = plan->configuration_count,
                         .repeats = 1,
                         .seed = plan->seed};
    pl_execution_def execution = def->execution;
    execution.plan = &one;
    execution.needs_positions = true;
    execution.user = def;
    execution.skip = is_hopeless;
    const long due = pl_execution_due(&execution);
    if (due == 0) {
        return PL_OK;
    }
    if (execution.bar != NULL) {
        execution.bar->total += due;
    }
    return pl_execute(&execution, signal_number, error);
}

/* ---- A case ---- */

/* Judges the configurations by a reference that is known. */
static pl_status judge_by(const pl_reference_def *def, const pl_reference *reference,
                          json_t *sentences, json_t **item, int *signal_number, pl_error *error)
{
    const pl_plan *plan = def->execution.plan;
    pl_reference_verdict verdict =
        pl_reference_judge(plan, def->original, def->execution.positions, def->results, reference);
    pl_after_horizon after = {.from = 0};
    const pl_status status = pl_after_horizon_make(def, &verdict, &after, signal_number, error);
    if (status == PL_OK && *signal_number == 0) {
        pl_reference_sentences(&verdict, sentences);
        pl_after_horizon_sentences(&verdict, &after, sentences);
        *item = pl_reference_case_json(plan, def->original, reference, &verdict, &after, sentences);
    }
    pl_after_horizon_free(&after);
    pl_reference_verdict_free(&verdict);
    return status;
}

static pl_status judge_case(const pl_reference_study_def *def, pl_case *test_case, pl_progress *bar,
                            json_t **item, int *signal_number, pl_error *error)
{
    pl_reference reference = {.known = false};
    pl_reference_def making = {.original = test_case,
                               .execution = def->execution,
                               .study = json_pack("{s:s}", "name", "reference"),
                               .results = def->results};
    json_t *sentences = json_array();
    making.execution.progress = NULL;
    making.execution.bar = bar;
    *item = NULL;
    pl_status status = run_with_positions(&making, test_case, signal_number, error);
    if (status == PL_OK && *signal_number == 0) {
        status = pl_reference_make(&making, &reference, signal_number, error);
    }
    if (status == PL_OK && *signal_number == 0 && reference.known) {
        status = judge_by(&making, &reference, sentences, item, signal_number, error);
    } else if (status == PL_OK && *signal_number == 0) {
        pl_text_buffer text = {0};
        pl_text_format(&text, "There is no reference: %s", reference.reason);
        pl_sentence_add(sentences, &text);
        *item = pl_reference_case_json(def->execution.plan, test_case, &reference, NULL, NULL,
                                       sentences);
    }
    pl_reference_free(&reference);
    json_decref(making.study);
    json_decref(sentences);
    return status;
}

/* ---- The study ---- */

/* An object of the cases, with the sentences of all. Takes the reference of `cases`. */
static json_t *compose(json_t *cases)
{
    json_t *sentences = json_array();
    size_t index, k;
    const json_t *item;
    json_t *sentence;
    json_array_foreach(cases, index, item)
    {
        const char *name = pl_json_get_text(item, "name");
        json_array_foreach(json_object_get(item, "sentences"), k, sentence)
        {
            json_array_append_new(sentences,
                                  json_array_size(cases) == 1
                                      ? json_incref(sentence)
                                      : json_sprintf("%s: %s", name, json_string_value(sentence)));
        }
    }
    return json_pack("{s:s, s:f, s:f, s:f, s:o, s:o}", "schema", "plumb.reference/1", "share",
                     pl_reference_share, "least_bound", pl_reference_least_bound, "safety",
                     pl_reference_safety, "cases", cases, "sentences", sentences);
}

pl_status pl_reference_study(const pl_reference_study_def *def, json_t **outcome,
                             int *signal_number, pl_error *error)
{
    const pl_plan *plan = def->execution.plan;
    FILE *out = def->execution.progress;
    pl_progress bar = {.terminal = false};
    json_t *cases = json_array();
    pl_status status = PL_OK;
    *signal_number = 0;
    *outcome = NULL;
    if (out != NULL) {
        bar = pl_progress_begin(out, 0, pl_monotonic_seconds());
    }
    for (int i = 0; i < plan->case_count && status == PL_OK && *signal_number == 0; ++i) {
        pl_case *test_case = &plan->cases[i];
        if (!pl_reference_applies(test_case)) {
            continue;
        }
        json_t *item = json_incref(recall(def->before, plan, test_case));
        if (item == NULL) {
            /* Where the display cannot be drawn again, a line a run would be hundreds of lines. */
            if (out != NULL && !bar.terminal) {
                pl_print_line(out, "%s: a converged reference", test_case->name);
            }
            status =
                judge_case(def, test_case, bar.terminal ? &bar : NULL, &item, signal_number, error);
        }
        json_array_append_new(cases, item);
    }
    if (out != NULL) {
        pl_progress_end(&bar);
    }
    if (status != PL_OK || *signal_number != 0) {
        json_decref(cases);
        return status;
    }
    *outcome = compose(cases);
    return PL_OK;
}

void pl_reference_study_print(FILE *out, const json_t *outcome)
{
    size_t index, k;
    const json_t *item, *sentence;
    json_array_foreach(json_object_get(outcome, "cases"), index, item)
    {
        pl_print_line(out, "%s, against a converged reference:", pl_json_get_text(item, "name"));
        json_array_foreach(json_object_get(item, "sentences"), k, sentence)
        {
            fprintf(out, "  %s.\n", json_string_value(sentence));
        }
    }
}
