/* Reads any bytes as a file of results. They are accepted, or refused with the line and column of the
 * fault. What is accepted is the same after a store took it over and added a result, is summarised
 * into rows that read back the same from a baseline, and is analysed and printed as a report. */
#define _GNU_SOURCE

#include "fuzz_rows.h"

#include "gate/gate.h"
#include "report/report.h"
#include "results/store.h"
#include "studies/sweep/analysis.h"

#include <jansson.h>
#include <stdlib.h>
#include <unistd.h>

static const char added[] = "{\"schema\":\"plumb.result/1\",\"run\":\"0123456789abcdef\"}";

/* The folder of a store whose file of results is at `path`; there is one for all inputs. */
static const char *folder_of(const char *path)
{
    static char folder[] = "/tmp/plumb_fuzz_XXXXXX";
    static char link[sizeof folder + 16];
    if (link[0] == '\0') {
        fuzz_check(mkdtemp(folder) != NULL, "a folder can be made");
        snprintf(link, sizeof link, "%s/results.jsonl", folder);
    }
    unlink(link);
    fuzz_check(symlink(path, link) == 0, "a link can be made");
    return folder;
}

/* A store keeps the lines that it found, and has one more after it added one. */
static void resume(const char *path, json_t *results)
{
    pl_error error = {.message = ""};
    pl_store *store = NULL;
    json_t *again = NULL, *result = json_loads(added, 0, NULL);
    fuzz_check(pl_store_open(folder_of(path), PL_STORE_RESUME, NULL, &store, &error) == PL_OK,
               "a store takes over what can be read");
    fuzz_check(json_equal(pl_store_results(store), results), "a store has what was read");
    fuzz_check(pl_store_append(store, result, &error) == PL_OK, "a store takes a result");
    pl_store_close(store);
    fuzz_check(pl_results_read(path, &again, NULL, &error) == PL_OK, "its file can be read");
    json_array_append(results, result);
    fuzz_check(json_equal(again, results), "its file has what was there, and the result");
    json_array_remove(results, json_array_size(results) - 1);
    json_decref(again);
    json_decref(result);
}

static void report(const pl_result_table *results, FILE *nowhere)
{
    pl_document document = {.title = ""};
    pl_text_buffer text = {0};
    pl_report_csv(results, &text);
    pl_report_runs_csv(results, &text);
    pl_report_print(nowhere, results, true, 100);
    json_t *sweep = pl_sweep_conclude(results);
    pl_sweep_study.document(sweep, &document);
    free(pl_document_text(&document, 100));
    pl_document_free(&document);
    json_decref(sweep);
    pl_text_free(&text);
}

static void summarise(const pl_result_table *results)
{
    pl_gate_rows rows;
    const pl_gate_tolerances tolerances = pl_gate_tolerances_default();
    pl_gate_gather(results, &tolerances, &rows);
    fuzz_rows_survive(&rows);
    pl_gate_rows_free(&rows);
}

/* A table is made, or the line is named that is none of its rows. */
static void tabulate(const char *path, const json_t *results, FILE *nowhere)
{
    pl_error error = {.message = ""};
    const pl_result_file file = {.path = path, .results = results};
    pl_result_table_def def = {.files = &file, .file_count = 1, .has_changes = true};
    pl_result_table table;
    if (pl_result_table_build(&def, &table, &error) == PL_OK) {
        report(&table, nowhere);
    } else {
        fuzz_check(fuzz_has_place(error.message, path), "a refused result has a line");
    }
    pl_result_table_free(&table);
    def.has_changes = false;
    if (pl_result_table_build(&def, &table, &error) == PL_OK) {
        summarise(&table);
    }
    pl_result_table_free(&table);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static FILE *nowhere;
    pl_error error = {.message = ""};
    char path[FUZZ_PATH_SIZE];
    json_t *results = NULL;
    const int file = fuzz_file(data, size, path);
    nowhere = nowhere == NULL ? fopen("/dev/null", "we") : nowhere;
    if (pl_results_read(path, &results, NULL, &error) == PL_OK) {
        tabulate(path, results, nowhere);
        resume(path, results);
        json_decref(results);
    } else {
        fuzz_check(fuzz_has_place(error.message, path), "a refusal has a line and a column");
    }
    close(file);
    return 0;
}
