/* plumb compare: scenarios on engines side by side. Results are appended to DIR/results.jsonl as
 * runs end; the report is made at the end from all results in that file. Scene files that expect
 * nothing get a converged reference, DIR/reference.json. */
#include "base/folding.h"
#include "base/heap.h"
#include "open_page.h"
#include "report/report.h"
#include "request.h"
#include "results/store.h"
#include "runner/execute.h"
#include "runner/positions.h"
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

/* Converged references of the scene files that expect nothing. */
typedef struct references {
    char *folder;    /* of the paths of runs, while they are needed */
    char *path;      /* of reference.json */
    json_t *before;  /* what is there already; NULL: nothing */
    json_t *outcome; /* NULL: none */
} references;

static void print_table(const pl_result_table *results)
{
    const char *plain = getenv("NO_COLOR");
    bool terminal = isatty(STDOUT_FILENO) == 1;
    pl_report_print(stdout, results, terminal && (plain == NULL || plain[0] == '\0'),
                          pl_window_width(stdout));
}

/* Report, --json and table, of the results in the store that are of no study; the table last, because a reader of it
 * that leaves early ends the program. */
static pl_status deliver(const options *o, const json_t *all, json_t *results,
                         const json_t *reference, pl_error *error)
{
    const char *const folders[] = {o->request.out};
    char *path = pl_heap_format("%s/results.jsonl", o->request.out);
    const pl_result_file file = {.path = path, .results = all};
    const pl_result_table_def table_def = {
        .files = &file, .file_count = 1, .home = o->request.home};
    pl_result_table table;
    const pl_report_def def = {.directory = o->request.out,
                               .results = &table,
                               .folders = folders,
                               .folder_count = 1,
                               .reference = reference};
    pl_status status = pl_result_table_build(&table_def, &table, error);
    const bool is_built = status == PL_OK;
    if (is_built) {
        status = pl_report_write(&def, error);
    }
    if (status == PL_OK) {
        status = pl_results_write_json(o->request.json, results, error);
    }
    if (is_built && !pl_is_stdout(o->request.json)) {
        print_table(&table);
        pl_reference_study_print(stdout, reference);
    }
    if (status == PL_OK) {
        size_t count = json_array_size(results);
        fflush(stdout);
        pl_result_table_print_left_out(&table, stderr);
        pl_print_line(stderr, "%zu %s and the report are in %s/", count,
                      count == 1 ? "result" : "results", o->request.out);
    }
    if (status == PL_OK && o->open) {
        char page[4096];
        snprintf(page, sizeof page, "%.4000s/index.html", o->request.out);
        status = pl_open_page(page, error);
    }
    pl_result_table_free(&table);
    free(path);
    return status;
}

static pl_status run_all(const options *o, const pl_plan *plan, pl_store *store, json_t *provenance,
                         const char *recordings, int *signal_number, pl_error *error)
{
    const pl_execution_def execution = {.plan = plan,
                                        .jobs = o->request.jobs,
                                        .limits = o->request.limits,
                                        .recordings = recordings,
                                        .provenance = provenance,
                                        .store = store,
                                        .progress = stderr};
    return o->tolerance ? pl_tolerance_execute(&execution, signal_number, error)
                        : pl_execute(&execution, signal_number, error);
}

/* Makes the folder of recordings, whose path the caller frees; NULL: none are asked for. */
static pl_status prepare_recordings(const options *o, char **folder, pl_error *error)
{
    if (o->no_recordings) {
        return PL_OK;
    }
    char *path = pl_heap_format("%s/recordings", o->request.out);
    pl_status status = pl_make_directories(path, error);
    if (status == PL_OK) {
        *folder = realpath(path, NULL); /* an engine may change the working directory */
        status =
            *folder == NULL ? pl_fail(error, PL_IO, "%.300s: %s", path, strerror(errno)) : PL_OK;
    }
    free(path);
    return status;
}

/* Looks which references are due. The directory of results exists. The caller frees *r in any case. */
static pl_status begin_references(const options *o, const pl_plan *plan, references *r,
                                  pl_error *error)
{
    r->folder = pl_heap_format("%s/reference-paths", o->request.out);
    r->path = pl_heap_format("%s/reference.json", o->request.out);
    r->before = o->request.resume ? json_load_file(r->path, 0, NULL) : NULL;
    if (!o->request.resume) {
        pl_positions_clear(r->folder);
    }
    const bool is_due = !o->no_reference && pl_reference_study_due(plan, r->before) > 0;
    return is_due ? pl_make_directories(r->folder, error) : PL_OK;
}

/* Makes the references and writes them. */
static pl_status make_references(const options *o, const pl_plan *plan, const json_t *results,
                                 json_t *provenance, pl_store *store, references *r,
                                 int *signal_number, pl_error *error)
{
    const pl_reference_study_def def = {.execution = {.plan = plan,
                                                      .jobs = o->request.jobs,
                                                      .limits = o->request.limits,
                                                      .positions = r->folder,
                                                      .provenance = provenance,
                                                      .store = store,
                                                      .progress = stderr},
                                        .results = results,
                                        .before = r->before};
    if (o->no_reference || pl_reference_study_cases(plan) == 0) {
        return PL_OK;
    }
    pl_status status = pl_reference_study(&def, &r->outcome, signal_number, error);
    if (status == PL_OK && r->outcome != NULL) {
        status = pl_results_write_json(r->path, r->outcome, error);
    }
    pl_positions_clear(r->folder);
    return status;
}

/* What a comparison that has ended replaces. */
static void remove_old(const options *o, pl_store *store)
{
    pl_store_finish(store);
    if (o->request.force) {
        char *recordings = pl_heap_format("%s/recordings", o->request.out);
        pl_recordings_remove(recordings, pl_store_runs(store));
        free(recordings);
    }
}

/* The outcome of an earlier comparison does not stay next to the results of this one. */
static void drop_old_reference(const references *r)
{
    if (r->outcome == NULL) {
        unlink(r->path);
    }
}

static void free_references(references *r)
{
    free(r->folder);
    free(r->path);
    json_decref(r->before);
    json_decref(r->outcome);
}

/* Runs what is due and delivers. */
static int execute(const pl_call *call, const options *o, const pl_plan *plan)
{
    pl_error error = {.message = ""};
    pl_store *store = NULL;
    references r = {.folder = NULL};
    static const char *const report_files[] = {"index.html", NULL};
    const pl_store_mode mode = pl_store_mode_of(o->request.resume, o->request.force);
    int signal_number = 0;
    int code = PL_EXIT_OK;
    json_t *provenance = pl_call_provenance(call);
    pl_status status = pl_store_open(o->request.out, mode, report_files, &store, &error);
    char *recordings = NULL;
    if (status == PL_OK) {
        status = prepare_recordings(o, &recordings, &error);
    }
    if (status == PL_OK) {
        status = begin_references(o, plan, &r, &error);
    }
    if (status == PL_OK) {
        pl_request_note_threads(call, plan);
        status = run_all(o, plan, store, provenance, recordings, &signal_number, &error);
    }
    free(recordings);
    if (status == PL_OK && signal_number == 0) {
        status = make_references(o, plan, pl_store_results(store), provenance, store, &r,
                                 &signal_number, &error);
    }
    if (status == PL_OK && signal_number == 0) {
        json_t *results = pl_results_of_study(pl_store_results(store), NULL);
        drop_old_reference(&r);
        status = deliver(o, pl_store_results(store), results, r.outcome, &error);
        code = pl_results_all_unsupported(results) ? PL_EXIT_NOTHING : PL_EXIT_OK;
        json_decref(results);
    }
    if (status == PL_OK && signal_number == 0) {
        remove_old(o, store);
    }
    free_references(&r);
    json_decref(provenance);
    return pl_call_end_store(call, store, o->request.out, status, &error, signal_number, code);
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default(), .repeats = 1};
    o.request.out = "report";
    pl_call_parse(call, &o);
    if (o.request.names.count == 0 && o.request.suites.count == 0) {
        pl_texts_add(&o.request.suites, "canonical");
    }
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = o.repeats};
    int code = PL_EXIT_OK;
    pl_status status = pl_request_outputs(&o.request, NULL, &error);
    if (status == PL_OK) {
        status = pl_request_plan(call, &o.request, &plan, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (pl_plan_size(&plan) == 0) {
        code = pl_call_nothing(call, "there is nothing to compare");
    } else {
        code = execute(call, &o, &plan);
    }
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
