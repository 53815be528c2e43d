#include "study_command.h"

#include "base/folding.h"
#include "base/heap.h"
#include "report/page.h"
#include "results/result_table.h"
#include "results/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Writes DIRECTORY/NAME.SUFFIX. */
static pl_status write_file(const char *directory, const pl_study *study, const char *suffix,
                            const char *text, pl_error *error)
{
    char *path = pl_heap_format("%s/%s.%s", directory, study->name, suffix);
    const pl_status status = pl_write_text(path, text, strlen(text), error);
    free(path);
    return status;
}

static pl_status write_page(const char *directory, const pl_study *study,
                            const pl_document *document, pl_error *error)
{
    json_t *data = pl_document_json(document);
    const pl_status status = pl_study_page_write(directory, study->name, "document", data, error);
    json_decref(data);
    return status;
}

pl_status pl_study_write_page(const char *directory, const pl_study *study,
                              const json_t *conclusion, pl_error *error)
{
    pl_document document = {.title = study->name};
    study->document(conclusion, &document);
    const pl_status status = write_page(directory, study, &document, error);
    pl_document_free(&document);
    return status;
}

/* NAME.json, NAME.md, NAME.csv and NAME.html. */
static pl_status write_files(const pl_request *request, const pl_study *study,
                             const json_t *conclusion, const pl_document *document, pl_error *error)
{
    char *path = pl_heap_format("%s/%s.json", request->out, study->name);
    char *markdown = pl_document_markdown(document);
    char *csv = pl_document_csv(document);
    pl_status status = pl_results_write_json(path, conclusion, error);
    if (status == PL_OK) {
        status = write_file(request->out, study, "md", markdown, error);
    }
    if (status == PL_OK) {
        status = write_file(request->out, study, "csv", csv, error);
    }
    if (status == PL_OK) {
        status = write_page(request->out, study, document, error);
    }
    free(path);
    free(markdown);
    free(csv);
    return status;
}

pl_status pl_study_write(const pl_request *request, const pl_study *study, const json_t *conclusion,
                         pl_error *error)
{
    pl_document document = {.title = study->name};
    study->document(conclusion, &document);
    const pl_status status = write_files(request, study, conclusion, &document, error);
    if (status == PL_OK && !pl_is_stdout(request->json)) {
        char *text = pl_document_text(&document, pl_window_width(stdout));
        fputs(text, stdout);
        fflush(stdout);
        free(text);
    }
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

int pl_study_command(const pl_call *call, const pl_request *request, const pl_study_work *work,
                     const pl_plan *plan)
{
    pl_error error = {.message = ""};
    pl_store *store = NULL;
    int signal_number = 0, code = PL_EXIT_OK;
    char *file = pl_heap_format("%s.json", work->study->name);
    const char *const others[] = {file, NULL};
    json_t *provenance = pl_call_provenance(call);
    pl_status status = pl_request_outputs(request, work->output, &error);
    if (status == PL_OK) {
        status = pl_store_open(request->out, pl_store_mode_of(request->resume, request->force),
                               others, &store, &error);
    }
    if (status == PL_OK) {
        pl_execution_def how = {.plan = plan,
                                .jobs = request->jobs,
                                .limits = request->limits,
                                .provenance = provenance,
                                .store = store,
                                .progress = stderr};
        status = work->run == NULL ? pl_execute(&how, &signal_number, &error)
                                   : work->run(work->user, &how, &signal_number, &error);
    }
    if (status == PL_OK && signal_number == 0) {
        char *path = pl_heap_format("%s/results.jsonl", request->out);
        const pl_result_file made = {.path = path, .results = pl_store_results(store)};
        const pl_result_table_def def = {
            .files = &made, .file_count = 1, .study = work->study->name, .has_changes = true};
        json_t *results = NULL, *conclusion = NULL;
        status = pl_results_that_count(&def, &results, &error);
        code = pl_results_all_unsupported(results) ? PL_EXIT_NOTHING : PL_EXIT_OK;
        if (status == PL_OK) {
            status =
                pl_study_deliver(request, work->study, results, request->out, &conclusion, &error);
        }
        if (status == PL_OK && work->finish != NULL) {
            status = work->finish(work->user, conclusion, &code, &error);
        }
        json_decref(conclusion);
        json_decref(results);
        free(path);
        if (status == PL_OK) {
            pl_store_finish(store);
        }
    }
    json_decref(provenance);
    free(file);
    code = pl_call_end_store(call, store, request->out, status, &error, signal_number, code);
    return status == PL_UNSUPPORTED ? PL_EXIT_NOTHING : code;
}

int pl_study_main(const pl_call *call, const pl_study_work *work)
{
    pl_request *request = work->user;
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    int code = PL_EXIT_OK;
    request->out = work->study->name;
    pl_call_parse(call, request);
    const pl_status status = work->plan == NULL ? pl_request_plan(call, request, &plan, &error)
                                                : work->plan(work->user, call, &plan, &error);
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (pl_plan_size(&plan) == 0) {
        code = pl_call_nothing(call, work->nothing == NULL ? "there is nothing to compare"
                                                           : work->nothing);
    } else {
        code = pl_study_command(call, request, work, &plan);
    }
    pl_plan_free(&plan);
    pl_request_free(request);
    return code;
}
