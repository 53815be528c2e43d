#include "study_command.h"

#include "base/folding.h"
#include "base/heap.h"
#include "report/page.h"
#include "results/result_table.h"
#include "results/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

pl_status pl_study_write_page(const char *directory, const pl_study *study,
                              const json_t *conclusion, pl_error *error)
{
    pl_document document = {.title = study->name};
    study->document(conclusion, &document);
    json_t *data = pl_document_json(&document);
    const pl_status status = pl_study_page_write(directory, study->name, "document", data, error);
    json_decref(data);
    pl_document_free(&document);
    return status;
}

/* Writes a text, which it frees, into DIRECTORY/NAME.SUFFIX. */
static pl_status write_file(const char *directory, const pl_study *study, const char *suffix,
                            char *text, pl_error *error)
{
    char *path = pl_heap_format("%s/%s.%s", directory, study->name, suffix);
    const pl_status status = pl_write_text(path, text, strlen(text), error);
    free(path);
    free(text);
    return status;
}

pl_status pl_study_write(const pl_request *request, const pl_study *study, const json_t *conclusion,
                         pl_error *error)
{
    const char *out = request->out;
    pl_document document = {.title = study->name};
    study->document(conclusion, &document);
    char *json = pl_heap_format("%s/%s.json", out, study->name);
    pl_status status = pl_results_write_json(json, conclusion, error);
    if (status == PL_OK) {
        status = write_file(out, study, "md", pl_document_markdown(&document), error);
    }
    if (status == PL_OK) {
        status = write_file(out, study, "csv", pl_document_csv(&document), error);
    }
    if (status == PL_OK) {
        status = pl_study_write_page(out, study, conclusion, error);
    }
    if (status == PL_OK && !pl_is_stdout(request->json)) {
        char *text = pl_document_text(&document, pl_window_width(stdout));
        fputs(text, stdout);
        fflush(stdout);
        free(text);
    }
    free(json);
    pl_document_free(&document);
    return status;
}

pl_status pl_study_deliver(const pl_request *request, const pl_study *study, const json_t *results,
                           const char *folder, json_t **conclusion, pl_error *error)
{
    *conclusion = NULL;
    pl_status status = study->conclude(results, folder, conclusion, error);
    if (status == PL_OK) {
        status = pl_study_write(request, study, *conclusion, error);
    }
    if (status == PL_OK) {
        status = pl_results_write_json(request->json, *conclusion, error);
    }
    if (status == PL_OK) {
        pl_print_line(stderr, "%zu %s in %s/results.jsonl; the page is %s/%s.html",
                      json_array_size(results),
                      json_array_size(results) == 1 ? "result is" : "results are", folder,
                      request->out, study->name);
    }
    return status;
}

/* Concludes from the results of the store that count. */
static pl_status conclude(const pl_study_work *work, pl_store *store, int *code, pl_error *error)
{
    const pl_request *request = work->options;
    char *path = pl_heap_format("%s/results.jsonl", request->out);
    const pl_result_file made = {.path = path, .results = pl_store_results(store)};
    const pl_result_table_def def = {
        .files = &made, .file_count = 1, .study = work->study->name, .has_changes = true};
    json_t *results = NULL, *conclusion = NULL;
    pl_status status = pl_results_that_count(&def, &results, error);
    *code = pl_results_all_unsupported(results) ? PL_EXIT_NOTHING : PL_EXIT_OK;
    if (status == PL_OK) {
        status = pl_study_deliver(request, work->study, results, request->out, &conclusion, error);
    }
    if (status == PL_OK && work->finish != NULL) {
        status = work->finish(work->options, conclusion, code, error);
    }
    json_decref(conclusion);
    json_decref(results);
    free(path);
    return status;
}

/* Makes the runs of the plan that are missing, and concludes. Returns the exit code. */
static int carry_out(const pl_call *call, const pl_study_work *work, const pl_plan *plan)
{
    const pl_request *request = work->options;
    int signal_number = 0, code = PL_EXIT_OK;
    char *file = pl_heap_format("%s.json", work->study->name);
    pl_call_need(call, pl_request_outputs(request, work->output == NULL ? NULL : *work->output,
                                          call->error));
    pl_store *store = pl_request_open_store(call, request, (const char *const[]){file, NULL});
    pl_execution_def how = {.plan = plan,
                            .jobs = request->jobs,
                            .limits = request->limits,
                            .provenance = pl_call_provenance(call),
                            .store = store,
                            .progress = stderr};
    pl_status status = work->run == NULL
                           ? pl_execute(&how, &signal_number, call->error)
                           : work->run(work->options, &how, &signal_number, call->error);
    if (status == PL_OK && signal_number == 0) {
        status = conclude(work, store, &code, call->error);
        if (status == PL_OK) {
            pl_store_finish(store);
        }
    }
    json_decref(how.provenance);
    free(file);
    code = pl_call_end_store(call, store, request->out, status, signal_number, code);
    return status == PL_UNSUPPORTED ? PL_EXIT_NOTHING : code;
}

int pl_study_main(const pl_call *call, const pl_study_work *work)
{
    pl_request *request = work->options;
    json_t *named = json_pack("{s:s}", "name", work->study->name);
    pl_plan plan = {.repeats = 1, .study = work->plan == NULL ? named : NULL};
    request->out = work->study->name;
    pl_call_parse(call, request);
    pl_call_need(call, work->plan == NULL ? pl_request_plan(call, request, &plan, call->error)
                                          : work->plan(work->options, call, &plan, call->error));
    const int code =
        pl_plan_size(&plan) > 0
            ? carry_out(call, work, &plan)
            : pl_call_nothing(call, work->nothing == NULL ? "there is nothing to compare"
                                                          : work->nothing);
    pl_plan_free(&plan);
    json_decref(named);
    pl_request_free(request);
    return code;
}
