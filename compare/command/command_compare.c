/* plumb compare: scenarios on engines side by side. Results are appended to DIR/results.jsonl as
 * runs end; the report is made at the end from all results in that file. Scene files that expect
 * nothing get a converged reference, DIR/reference.json. */
#include "base/folding.h"
#include "base/heap.h"
#include "report/report.h"
#include "request.h"
#include "results/store.h"
#include "runner/execute.h"
#include "runner/recording.h"
#include "studies/iterations/iterations_to_tolerance.h"
#include "studies/reference/reference_study.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct options {
    pl_request request;
    int repeats;
    bool tolerance;     /* --iterations-to-tolerance */
    bool no_recordings; /* --no-recordings */
    bool no_reference;  /* --no-reference */
    bool open;          /* --open */
} options;

static void print_table(const pl_result_table *results)
{
    const char *plain = getenv("NO_COLOR");
    bool terminal = isatty(STDOUT_FILENO) == 1;
    pl_report_print(stdout, results, terminal && (plain == NULL || plain[0] == '\0'),
                    pl_window_width(stdout));
}

/* Report, --json and table, of the results in the store that are of no study; the table last, because a reader of it
 * that leaves early ends the program. Returns the exit code. */
static int deliver(const pl_call *call, const options *o, const json_t *all,
                   const json_t *reference)
{
    json_t *results = pl_results_of_study(all, NULL);
    const size_t count = json_array_size(results);
    const char *const folders[] = {o->request.out};
    char *path = pl_heap_format("%s/results.jsonl", o->request.out);
    char *page = pl_heap_format("%s/index.html", o->request.out);
    const pl_result_file file = {.path = path, .results = all};
    const pl_result_table_def table_def = {
        .files = &file, .file_count = 1, .home = o->request.home};
    pl_result_table table;
    const pl_report_def def = {.directory = o->request.out,
                               .results = &table,
                               .folders = folders,
                               .folder_count = 1,
                               .reference = reference};
    pl_call_need(call, pl_result_table_build(&table_def, &table, call->error));
    pl_status status = pl_report_write(&def, call->error);
    if (status == PL_OK) {
        status = pl_results_write_json(o->request.json, results, call->error);
    }
    if (!pl_is_stdout(o->request.json)) {
        print_table(&table);
        pl_reference_study_print(stdout, reference);
    }
    pl_call_need(call, status);
    fflush(stdout);
    pl_result_table_print_left_out(&table, stderr);
    pl_print_line(stderr, "%zu %s and the report are in %s/", count,
                  count == 1 ? "result" : "results", o->request.out);
    if (o->open) {
        pl_call_need(call, pl_open_page(page, call->error));
    }
    const int code = pl_results_all_unsupported(results) ? PL_EXIT_NOTHING : PL_EXIT_OK;
    pl_result_table_free(&table);
    json_decref(results);
    free(path);
    free(page);
    return code;
}

/* Makes the folder of recordings. Returns its path, which the caller frees. */
static char *prepare_recordings(const pl_call *call, const options *o)
{
    char *path = pl_heap_format("%s/recordings", o->request.out);
    pl_call_need(call, pl_make_directories(path, call->error));
    char *folder = realpath(path, NULL); /* an engine may change the working directory */
    if (folder == NULL) {
        pl_call_need(call, pl_fail(call->error, PL_IO, "%.300s: %s", path, strerror(errno)));
    }
    free(path);
    return folder;
}

static void make_runs(const pl_call *call, const options *o, pl_execution_def execution)
{
    int signal_number = 0;
    char *recordings = o->no_recordings ? NULL : prepare_recordings(call, o);
    execution.recordings = recordings;
    pl_request_note_threads(call, execution.plan);
    const pl_status status =
        (o->tolerance ? pl_tolerance_execute : pl_execute)(&execution, &signal_number, call->error);
    free(recordings);
    pl_call_check_end(call, status, signal_number);
}

/* Makes the converged references of scene files that expect nothing. Returns their outcome; NULL: there is none. */
static json_t *make_references(const pl_call *call, const options *o, pl_execution_def execution)
{
    static const pl_plan none = {.repeats = 1};
    int signal_number = 0;
    json_t *outcome = NULL;
    execution.plan = o->no_reference ? &none : execution.plan;
    const pl_status status = pl_reference_study(&execution, o->request.out, o->request.resume,
                                                &outcome, &signal_number, call->error);
    pl_call_check_end(call, status, signal_number);
    return outcome;
}

/* Runs what is due and delivers. */
static int execute(const pl_call *call, const options *o, const pl_plan *plan)
{
    static const char *const report_files[] = {"index.html", NULL};
    pl_store *store = pl_request_open_store(call, &o->request, report_files);
    json_t *provenance = pl_call_provenance(call);
    const pl_execution_def execution = {.plan = plan,
                                        .jobs = o->request.jobs,
                                        .limits = o->request.limits,
                                        .provenance = provenance,
                                        .store = store,
                                        .progress = stderr};
    char *recordings = pl_heap_format("%s/recordings", o->request.out);
    make_runs(call, o, execution);
    json_t *reference = make_references(call, o, execution);
    const int code = deliver(call, o, pl_store_results(store), reference);
    pl_store_finish(store);
    if (o->request.force) {
        pl_recordings_remove(recordings, pl_store_runs(store));
    }
    json_decref(reference);
    json_decref(provenance);
    free(recordings);
    return pl_call_end_store(call, store, o->request.out, PL_OK, 0, code);
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default(), .repeats = 1};
    o.request.out = "report";
    pl_call_parse(call, &o);
    if (o.request.names.count == 0 && o.request.suites.count == 0) {
        pl_texts_add(&o.request.suites, "canonical");
    }
    pl_plan plan = {.repeats = o.repeats};
    pl_call_need(call, pl_request_outputs(&o.request, NULL, call->error));
    pl_call_need(call, pl_request_plan(call, &o.request, &plan, call->error));
    const int code = pl_plan_size(&plan) == 0 ? pl_call_nothing(call, "there is nothing to compare")
                                              : execute(call, &o, &plan);
    pl_plan_free(&plan);
    pl_request_free(&o.request);
    return code;
}

static const pl_option OPTIONS[] = {
    {"repeat", "N",
     "Runs of each case on each engine, interleaved (default 1); the table shows medians with "
     "their spread",
     PL_OPTION_INTEGER, .field = offsetof(options, repeats), .min = 1, .max = 1000000},
    {"iterations-to-tolerance", NULL,
     "Also find that metric (see plumb list metrics), with up to 20 more runs of each case "
     "on each engine that has an option iterations",
     PL_OPTION_FLAG, .field = offsetof(options, tolerance)},
    {"no-recordings", NULL, "Do not record the runs: the page then has neither replay nor curves",
     PL_OPTION_FLAG, .field = offsetof(options, no_recordings)},
    {"open", NULL, "Open the page at the end, as plumb view does", PL_OPTION_FLAG,
     .field = offsetof(options, open)},
    {"no-reference", NULL, "Make no converged reference for scene files that expect nothing",
     PL_OPTION_FLAG, .field = offsetof(options, no_reference)},
    {"suite", NULL,
     "All scenarios of a suite (repeatable; default canonical when no scenario is named)",
     .kind = PL_OPTION_HELP},
    {"out", NULL, "Where results and report go (default report)", .kind = PL_OPTION_HELP},
    {0}};

const pl_command pl_command_compare = {
    .name = "compare",
    .summary = "run scenarios on engines side by side and report",
    .arguments = "[SCENARIO|SCENE.json...]",
    .description =
        "Runs scenarios on engines side by side, each run in a process of its own, prints a table "
        "and writes a report. An engine that crashes, hangs or fails is a row of the table; the "
        "command still succeeds. For a scene file without \"expect\" a converged reference is "
        "made, "
        "from two engines at ever smaller steps, and sentences after the table say which engine "
        "differs from it in which body, by how much and from when on.",
    .notes = "Examples:\n"
             "  plumb compare\n"
             "  plumb compare tower wall --engine plumb --engine ode:quick --repeat 5\n"
             "  plumb compare tower --set n=50 --dt 1/240 --out report-50\n"
             "  plumb compare ./mine.json --engine ./mine.so:fast --json - | jq .",
    .options = OPTIONS,
    .shared = {pl_scene_options, pl_file_options, pl_limit_options, pl_comparison_options,
               pl_home_options, pl_jobs_options, pl_out_options},
    .run = run};
