#include "reference_study.h"

#include "base/folding.h"
#include "base/heap.h"
#include "reference_verdict.h"
#include "runner/positions.h"

#include <stdlib.h>
#include <unistd.h>

/* The item of an earlier outcome with exactly the runs of a case, a new reference; NULL: there is none. */
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
    return json_incref(found);
}

/* Makes the runs of a case again, with their positions. Returns whether the work goes on. */
static bool run_with_positions(pl_reference_work *work, pl_case *test_case)
{
    pl_plan one = *work->execution.plan;
    one.cases = test_case;
    one.case_count = one.repeats = 1;
    return pl_reference_run(work, &one, 0);
}

/* The item of a case judged by a reference that is known: a new reference; NULL where the work does not go on. */
static json_t *judge_by(pl_reference_work *work, const pl_reference *reference, json_t *sentences)
{
    pl_reference_verdict verdict = pl_reference_judge(work, reference);
    json_t *item = NULL;
    pl_after_horizon_make(work, &verdict);
    if (pl_reference_goes_on(work)) {
        pl_reference_sentences(&verdict, sentences);
        pl_after_horizon_sentences(&verdict, sentences);
        item = pl_reference_case_json(work, reference, &verdict, sentences);
    }
    pl_reference_verdict_free(&verdict);
    return item;
}

/* The item of a case: a new reference; NULL where the work does not go on. */
static json_t *judge_case(pl_reference_work *work, pl_case *test_case)
{
    pl_reference reference = {.known = false};
    json_t *sentences = json_array(), *item = NULL;
    work->original = test_case;
    if (run_with_positions(work, test_case)) {
        pl_reference_make(work, &reference);
    }
    if (pl_reference_goes_on(work) && reference.known) {
        item = judge_by(work, &reference, sentences);
    } else if (pl_reference_goes_on(work)) {
        pl_sentence_add(sentences, "There is no reference: %s", reference.reason);
        item = pl_reference_case_json(work, &reference, NULL, sentences);
    }
    pl_reference_free(&reference);
    json_decref(sentences);
    return item;
}

/* An object of the cases, with the sentences of all. */
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
    return json_pack("{s:s, s:f, s:f, s:f, s:O, s:o}", "schema", "plumb.reference/1", "share",
                     pl_reference_share, "least_bound", pl_reference_least_bound, "safety",
                     pl_reference_safety, "cases", cases, "sentences", sentences);
}

/* The item of a case, of an earlier outcome or judged now: a new reference; NULL where the work does not go on. */
static json_t *item_of(pl_reference_work *work, const json_t *before, FILE *out, pl_case *test_case)
{
    json_t *item = recall(before, work->execution.plan, test_case);
    if (item != NULL) {
        return item;
    }
    /* Where the display cannot be drawn again, a line for each run would be hundreds of lines. */
    if (work->execution.bar == NULL) {
        pl_print_line(out, "%s: a converged reference", test_case->name);
    }
    work->status = pl_make_directories(work->execution.positions, work->error);
    return work->status == PL_OK ? judge_case(work, test_case) : NULL;
}

/* Writes the outcome of all cases, or removes an earlier one. */
static pl_status write_outcome(const char *path, json_t *cases, json_t **outcome, pl_error *error)
{
    *outcome = json_array_size(cases) == 0 ? NULL : compose(cases);
    if (*outcome == NULL) {
        unlink(path);
        return PL_OK;
    }
    return pl_results_write_json(path, *outcome, error);
}

pl_status pl_reference_study(const pl_execution_def *how, const char *directory, bool resumes,
                             json_t **outcome, int *signal_number, pl_error *error)
{
    char *folder = pl_heap_format("%s/reference-paths", directory),
         *path = pl_heap_format("%s/reference.json", directory);
    json_t *before = resumes ? json_load_file(path, 0, NULL) : NULL, *cases = json_array();
    pl_progress bar = pl_progress_begin(how->progress, 0, pl_monotonic_seconds());
    pl_reference_work work = {.execution = *how, .error = error};
    work.execution.positions = folder;
    work.execution.progress = NULL;
    work.execution.bar = bar.terminal ? &bar : NULL;
    if (!resumes) {
        pl_positions_clear(folder);
    }
    for (int i = 0; i < how->plan->case_count && pl_reference_goes_on(&work); ++i) {
        pl_case *test_case = &how->plan->cases[i];
        if (pl_reference_applies(test_case)) {
            json_array_append_new(cases, item_of(&work, before, how->progress, test_case));
        }
    }
    pl_progress_end(&bar);
    if (pl_reference_goes_on(&work)) {
        work.status = write_outcome(path, cases, outcome, error);
    }
    pl_positions_clear(folder);
    *signal_number = work.signal_number;
    json_decref(cases);
    json_decref(before);
    free(path);
    free(folder);
    return work.status;
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
