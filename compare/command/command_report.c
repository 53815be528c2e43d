/* plumb report: the report of existing results, from any number of files. */
#include "report/report.h"
#include "report/sweep_report.h"
#include "request.h"
#include "results/result.h"
#include "results/store.h"
#include "studies/sweep/shard_merge.h"

#include <stdlib.h>

static bool has_run(const pl_merge *merge, const json_t *result)
{
    return json_object_get(merge->runs, pl_json_get_text(result, "run")) != NULL;
}

/* Results of the folder that are not in the report would be lost. */
static pl_status check_kept(const pl_merge *merge, const char *out, pl_store *store,
                            pl_error *error)
{
    long lost = 0;
    size_t index;
    const json_t *result;
    json_array_foreach(pl_store_results(store), index, result)
    {
        lost += !has_run(merge, result);
    }
    return lost == 0 ? PL_OK
                     : pl_fail(error, PL_BAD_INPUT,
                               "%s/results.jsonl has %ld results that the report would not have: "
                               "name it too, or choose another --out",
                               out, lost);
}

/* Whether an engine has several points on a scene: other settings or time steps. */
static bool is_sweep(const pl_sweep_analysis *analysis)
{
    for (int i = 0; i < analysis->scene_count; ++i) {
        for (int k = 0; k < analysis->engine_count; ++k) {
            const pl_sweep_curve *curve = &analysis->scenes[i].curves[k];
            if (analysis->engines[k].kind == PL_SWEEP_PROFILE &&
                curve->ok + curve->failed + curve->unmeasured > 1) {
                return true;
            }
        }
    }
    return false;
}

/* Of a sweep, who is faster at the same error. */
static pl_status analyse(const pl_request *request, const pl_merge *merge, pl_error *error)
{
    pl_sweep_analysis analysis;
    pl_status status = pl_sweep_analyse(merge->results, &analysis, error);
    if (status == PL_OK && is_sweep(&analysis)) {
        status = pl_sweep_report_write(request->out, &analysis, error);
        if (status == PL_OK) {
            pl_sweep_report_print(stdout, &analysis);
            fflush(stdout);
            fprintf(stderr, "speed against error is in %s/sweep.html\n", request->out);
        }
    }
    pl_sweep_analysis_free(&analysis);
    return status;
}

/* Writes the report of the results, without those of changed scenes: only a sweep asks whether its
 * points hold on them. */
static pl_status write_report(const pl_request *request, const json_t *results, pl_error *error)
{
    json_t *unchanged = json_array();
    bool failed = unchanged == NULL;
    for (size_t i = 0; i < json_array_size(results) && !failed; ++i) {
        json_t *result = json_array_get(results, i);
        failed =
            json_object_get(result, "change") == NULL && json_array_append(unchanged, result) != 0;
    }
    const pl_report_def def = {.directory = request->out,
                               .results = unchanged,
                               .folders = request->names.items,
                               .folder_count = request->names.count};
    pl_status status = failed ? pl_fail(error, PL_NO_MEMORY, "out of memory for a report")
                              : pl_report_write(&def, error);
    json_decref(unchanged);
    return status;
}

/* The store is held open while its file is replaced, so that nobody else is writing it. */
static pl_status deliver(const pl_request *request, const pl_merge *merge, pl_error *error)
{
    pl_store *store = NULL;
    char *path = NULL;
    if (asprintf(&path, "%s/results.jsonl", request->out) < 0) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    pl_status status = pl_store_open(request->out, true, &store, error);
    if (status == PL_OK) {
        status = check_kept(merge, request->out, store, error);
    }
    if (status == PL_OK) {
        status = write_report(request, merge->results, error);
    }
    if (status == PL_OK) {
        status = analyse(request, merge, error);
    }
    if (status == PL_OK) {
        status = pl_merge_write(merge, path, error);
    }
    pl_store_close(store);
    free(path);
    return status;
}

static void say_counts(const pl_request *request, const pl_merge *merge)
{
    const size_t count = json_array_size(merge->results);
    fprintf(stderr, "%zu %s of %ld %s and the report are in %s/\n", count,
            count == 1 ? "result" : "results", merge->files, merge->files == 1 ? "file" : "files",
            request->out);
    if (merge->doubles > 0) {
        fprintf(stderr, "%ld %s dropped: the same runs\n", merge->doubles,
                merge->doubles == 1 ? "duplicate was" : "duplicates were");
    }
    if (merge->differing > 0) {
        fprintf(stderr,
                "plumb report: warning: %ld of them differ in their outcome or in metrics that "
                "should be the same at every run; the first that was read is kept\n",
                merge->differing);
    }
}

static pl_status check(void *user, pl_error *error)
{
    return pl_request_check(user, "name a file or folder of results", NULL, error);
}

static int run(const pl_call *call)
{
    pl_request request = pl_request_default();
    request.out = "report";
    pl_call_parse(call, &request);
    pl_error error = {.message = ""};
    pl_merge merge;
    int code = PL_EXIT_OK;
    pl_status status = pl_merge_begin(&merge, &error);
    for (int i = 0; i < request.names.count && status == PL_OK; ++i) {
        status = pl_merge_add(&merge, request.names.items[i], stderr, &error);
    }
    const bool empty = status == PL_OK && json_array_size(merge.results) == 0;
    if (status == PL_OK && !empty) {
        status = deliver(&request, &merge, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (empty) {
        code = pl_call_nothing(call, "there are no results");
    } else {
        say_counts(&request, &merge);
    }
    pl_merge_free(&merge);
    pl_request_free(&request);
    return code;
}

static const pl_option OPTIONS[] = {{.name = "out",
                                     .argument = "DIR",
                                     .help = "Where the report and all results go (default report)",
                                     .kind = PL_OPTION_TEXT,
                                     .field = offsetof(pl_request, out)},
                                    {0}};

const pl_command pl_command_report = {
    .name = "report",
    .summary = "report on existing results",
    .arguments = "RESULTS...",
    .description =
        "Reads results of comparisons and sweeps and writes their report: index.html, summary.md, "
        "results.csv and results.jsonl; where an engine ran with several settings or time steps, "
        "also sweep.html and sweep.json, and prints their tables. RESULTS are files of JSON lines, "
        "or folders with a results.jsonl, and those of shards, shard-*-of-*, next to it. A run "
        "that occurs several times counts once: the first is kept, and copies whose deterministic "
        "metrics differ are reported.",
    .notes = "Examples:\n"
             "  plumb report sweep\n"
             "  plumb report monday/results.jsonl tuesday --out both",
    .options = OPTIONS,
    .check = check,
    .run = run};
