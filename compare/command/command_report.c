/* plumb report: the report of results that are there, of any number of files. */
#include "commands.h"
#include "report/report.h"
#include "report/sweep_report.h"
#include "results/result.h"
#include "results/store.h"
#include "selection.h"
#include "studies/sweep/shard_merge.h"

#include <stdlib.h>
#include <string.h>

typedef struct options {
    pl_texts paths;
    const char *out;
} options;

enum { KEY_OUT = 0x200 };

static const struct argp_option argp_options[] = {
    {"out", KEY_OUT, "DIR", 0, "Where the report and all results go (default report)", 0}, {0}};

static error_t parse(int key, char *text, struct argp_state *state)
{
    options *o = state->input;
    switch (key) {
    case KEY_OUT:
        o->out = text;
        return 0;
    case ARGP_KEY_ARG:
        pl_texts_add(&o->paths, text);
        return 0;
    case ARGP_KEY_END:
        if (o->paths.count == 0) {
            argp_error(state, "name a file or folder of results");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc = "RESULTS...",
    .doc =
        "Reads results of comparisons and sweeps and writes their report: index.html, "
        "summary.md, results.csv and results.jsonl; where an engine ran with several settings "
        "or time steps sweep.html and sweep.json too, with its tables printed. RESULTS are files "
        "of JSON lines, or folders "
        "with a results.jsonl, and those of shards, shard-*-of-*, beside it. A run that is there "
        "several times counts once, as it is found first; a double whose deterministic metrics "
        "differ is said.\v"
        "Examples:\n"
        "  plumb report sweep\n"
        "  plumb report monday/results.jsonl tuesday --out both"};

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

/* Whether an engine has several points on a problem: other settings, or time steps. */
static bool is_sweep(const pl_sweep_analysis *analysis)
{
    for (int i = 0; i < analysis->scene_count; ++i) {
        for (int k = 0; k < analysis->engine_count; ++k) {
            const pl_sweep_curve *curve = &analysis->scenes[i].curves[k];
            if (!analysis->engines[k].whole && curve->ok + curve->failed + curve->unmeasured > 1) {
                return true;
            }
        }
    }
    return false;
}

/* Of a sweep, who is faster at the same error. */
static pl_status analyse(const options *o, const pl_merge *merge, pl_error *error)
{
    pl_sweep_analysis analysis;
    pl_status status = pl_sweep_analyse(merge->results, &analysis, error);
    if (status == PL_OK && is_sweep(&analysis)) {
        status = pl_sweep_report_write(o->out, &analysis, error);
        if (status == PL_OK) {
            pl_sweep_report_print(stdout, &analysis);
            fflush(stdout);
            fprintf(stderr, "speed against error is in %s/sweep.html\n", o->out);
        }
    }
    pl_sweep_analysis_free(&analysis);
    return status;
}

/* The store is held open while its file is replaced, so that nobody else is writing it. */
static pl_status deliver(const options *o, const pl_merge *merge, pl_error *error)
{
    pl_store *store = NULL;
    char *path = NULL;
    if (asprintf(&path, "%s/results.jsonl", o->out) < 0) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    pl_status status = pl_store_open(o->out, true, &store, error);
    if (status == PL_OK) {
        status = check_kept(merge, o->out, store, error);
    }
    if (status == PL_OK) {
        status = pl_report_write(o->out, merge->results, error);
    }
    if (status == PL_OK) {
        status = analyse(o, merge, error);
    }
    if (status == PL_OK) {
        status = pl_merge_write(merge, path, error);
    }
    pl_store_close(store);
    free(path);
    return status;
}

static void say_counts(const options *o, const pl_merge *merge)
{
    const size_t count = json_array_size(merge->results);
    fprintf(stderr, "%zu %s of %ld %s and the report are in %s/\n", count,
            count == 1 ? "result" : "results", merge->files, merge->files == 1 ? "file" : "files",
            o->out);
    if (merge->doubles > 0) {
        fprintf(stderr, "%ld %s dropped: the same runs\n", merge->doubles,
                merge->doubles == 1 ? "double was" : "doubles were");
    }
    if (merge->differing > 0) {
        fprintf(stderr,
                "plumb report: warning: %ld of them differ in their outcome or in metrics that "
                "should be the same at every run; what was read first is kept\n",
                merge->differing);
    }
}

int pl_command_report(const pl_call *call)
{
    options o = {.out = "report"};
    pl_call_parse(call, &argp, &o);
    pl_error error = {.message = ""};
    pl_merge merge;
    int code = PL_EXIT_OK;
    pl_status status = pl_merge_begin(&merge, &error);
    for (int i = 0; i < o.paths.count && status == PL_OK; ++i) {
        status = pl_merge_add(&merge, o.paths.items[i], stderr, &error);
    }
    const bool empty = status == PL_OK && json_array_size(merge.results) == 0;
    if (status == PL_OK && !empty) {
        status = deliver(&o, &merge, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (empty) {
        fprintf(stderr, "plumb report: there are no results\n");
        code = PL_EXIT_NOTHING;
    } else {
        say_counts(&o, &merge);
    }
    pl_merge_free(&merge);
    free(o.paths.items);
    return code;
}
