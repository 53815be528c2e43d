/* plumb report: the report of existing results, from any number of files. */
#include "base/folding.h"
#include "base/heap.h"
#include "report/page.h"
#include "report/report.h"
#include "results/result.h"
#include "results/store.h"
#include "studies/sweep/analysis.h"
#include "studies/sweep/shard.h"
#include "study_command.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* What --format names: one file of the report, or the format of a picture. */
typedef struct format {
    const char *name;
    const char *file; /* NULL: a picture */
} format;
static const format formats[] = {{"html", "index.html"}, {"md", "summary.md"}, {"csv", "runs.csv"},
                                 {"svg", NULL},          {"png", NULL},        {"pdf", NULL}};
enum { FORMAT_COUNT = sizeof formats / sizeof formats[0] };

typedef struct options {
    pl_request request;
    const char *figure; /* --figure; NULL: none */
    const char *named;  /* --format; NULL: none */
    const format *format;
} options;

/* A report in the making. */
typedef struct making {
    const pl_call *call;
    const options *o;
    const pl_request *request; /* of o */
    pl_merge merge;
} making;

/* Results of the folder that are not in the report would be lost. */
static void check_kept(making *m, pl_store *store)
{
    long lost = 0;
    size_t index;
    const json_t *result;
    json_array_foreach(pl_store_results(store), index, result)
    {
        lost += json_object_get(m->merge.runs, pl_json_get_text(result, "run")) == NULL;
    }
    if (lost > 0 && !m->request->force) {
        pl_call_need(m->call,
                     pl_fail(m->call->error, PL_BAD_INPUT,
                             "%s/results.jsonl has %ld results that the report would not have: "
                             "name it too, or choose another --out; --force leaves them out",
                             m->request->out, lost));
    }
}

/* Whether the folder of the report is one of those that are read. */
static bool is_read(const pl_request *request)
{
    struct stat out, name;
    bool found = false;
    for (int i = 0; i < request->names.count && stat(request->out, &out) == 0; ++i) {
        found = found || (stat(request->names.items[i], &name) == 0 && name.st_ino == out.st_ino &&
                          name.st_dev == out.st_dev);
    }
    return found;
}

/* A file of --out may be written if it is not there, or is a report of the same results. */
static void check_file(making *m, bool is_own, const char *file)
{
    char *path = pl_heap_format("%s/%s", m->request->out, file);
    if (!is_own) {
        pl_call_need(m->call, pl_output_check(path, m->request->force, m->call->error));
    }
    free(path);
}

static pl_result_table build_table(making *m, bool has_changes)
{
    const pl_result_table_def def = {.files = m->merge.sources,
                                     .file_count = m->merge.source_count,
                                     .has_changes = has_changes,
                                     .home = m->request->home};
    pl_result_table results;
    pl_call_need(m->call, pl_result_table_build(&def, &results, m->call->error));
    return results;
}

/* Of a sweep, where an engine has several points on a scene, who is faster at the same error. */
static void analyse(making *m)
{
    pl_result_table results = build_table(m, true);
    json_t *conclusion = pl_sweep_conclude(&results);
    if (json_is_true(json_object_get(conclusion, "varied"))) {
        pl_call_need(m->call,
                     pl_study_write(m->request, &pl_sweep_study, conclusion, m->call->error));
        pl_print_line(stderr, "speed against error is in %s/sweep.html", m->request->out);
    }
    json_decref(conclusion);
    pl_result_table_free(&results);
}

/* The JSON of a comparison without a reference of its own (plumb.reference/1) next to the results;
 * NULL: none. */
static json_t *find_reference(const pl_request *request)
{
    json_t *found = NULL;
    for (int i = 0; i < request->names.count && found == NULL; ++i) {
        char *path = pl_heap_format("%s/reference.json", request->names.items[i]);
        found = json_load_file(path, 0, NULL);
        free(path);
    }
    return found;
}

/* Writes the report of the results, or a picture, without those of changed scenes: only a sweep asks
 * whether its points hold on them. */
static void write_report(making *m)
{
    const options *o = m->o;
    pl_result_table results = build_table(m, false);
    json_t *reference = find_reference(m->request);
    const pl_report_def def = {.directory = m->request->out,
                               .only = o->format == NULL ? NULL : o->format->file,
                               .reference = reference,
                               .results = &results,
                               .folders = m->request->names.items,
                               .folder_count = m->request->names.count};
    char *picture = NULL;
    pl_result_table_print_left_out(&results, stderr);
    if (o->figure == NULL) {
        pl_call_need(m->call, pl_report_write(&def, m->call->error));
    } else {
        /* NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a picture has a format */
        pl_call_need(m->call, pl_figure_write(&def, o->figure, o->format->name, m->request->force,
                                              &picture, m->call->error));
        pl_print_line(stderr, "the picture is in %s", picture);
        free(picture);
    }
    json_decref(reference);
    pl_result_table_free(&results);
}

/* Concludes every study that has runs among the results. */
static void conclude_studies(making *m)
{
    int count = 0;
    const pl_study *const *studies = pl_studies(&count);
    for (int i = 0; i < count; ++i) {
        if (studies[i]->conclude == NULL) {
            continue;
        }
        const pl_result_table_def def = {.files = m->merge.sources,
                                         .file_count = m->merge.source_count,
                                         .study = studies[i]->name,
                                         .has_changes = true};
        json_t *own = NULL, *conclusion = NULL;
        pl_call_need(m->call, pl_results_that_count(&def, &own, m->call->error));
        if (json_array_size(own) > 0) {
            pl_call_need(m->call,
                         pl_study_deliver(m->request, studies[i], own, m->request->names.items[0],
                                          &conclusion, m->call->error));
        }
        json_decref(conclusion);
        json_decref(own);
    }
}

static void say_counts(const making *m)
{
    const size_t count = json_array_size(m->merge.results);
    pl_print_line(stderr, "%zu %s of %ld %s and the report are in %s/", count,
                  count == 1 ? "result" : "results", m->merge.files,
                  m->merge.files == 1 ? "file" : "files", m->request->out);
    if (m->merge.doubles > 0) {
        pl_print_line(stderr, "%ld %s dropped: the same runs", m->merge.doubles,
                      m->merge.doubles == 1 ? "duplicate was" : "duplicates were");
    }
    if (m->merge.differing > 0) {
        pl_print_line(
            stderr,
            "plumb report: warning: %ld of them differ in their outcome or in metrics that "
            "should be the same at every run; the first that was read is kept",
            m->merge.differing);
    }
}

/* Writes all files: the report of the runs that belong to no study, the studies, and the results. The store is held
 * open while its file is replaced, so that nobody else is writing it. */
static void deliver_all(making *m)
{
    pl_store *store = NULL;
    json_t *plain = pl_results_of_study(m->merge.results, NULL);
    char *path = pl_heap_format("%s/results.jsonl", m->request->out);
    pl_call_need(m->call,
                 pl_store_open(m->request->out, PL_STORE_RESUME, NULL, &store, m->call->error));
    check_kept(m, store);
    check_file(m, json_array_size(pl_store_results(store)) > 0, "index.html");
    if (json_array_size(plain) > 0) {
        write_report(m);
        analyse(m);
    }
    conclude_studies(m);
    pl_call_need(m->call, pl_merge_write(&m->merge, path, m->call->error));
    say_counts(m);
    pl_store_close(store);
    json_decref(plain);
    free(path);
}

/* Writes the one file that --format or --figure names. */
static void deliver_one(making *m)
{
    if (m->o->format->file != NULL) {
        check_file(m, is_read(m->request), m->o->format->file);
    }
    pl_call_need(m->call, pl_make_directories(m->request->out, m->call->error));
    write_report(m);
}

/* ---- The page of a study ---- */

/* Writes the page where the only name is the JSON of a study, and returns whether it is. */
static bool deliver_study(making *m)
{
    char kind[PL_STUDY_KIND_SIZE];
    json_t *study = NULL;
    pl_error unused = {.message = ""};
    if (m->request->names.count != 1 ||
        pl_study_read(m->request->names.items[0], &study, kind, &unused) != PL_OK) {
        return false;
    }
    const char *out = m->request->out;
    const pl_study *known = pl_study_find(kind);
    const char *name = known != NULL ? known->name : kind;
    char *page = pl_heap_format("%s.html", name);
    check_file(m, false, page);
    pl_call_need(m->call, pl_make_directories(out, m->call->error));
    pl_call_need(m->call, known != NULL
                              ? pl_study_write_page(out, known, study, m->call->error)
                              : pl_study_page_write(out, kind, kind, study, m->call->error));
    pl_print_line(stderr, "the page is in %s/%s", out, page);
    free(page);
    json_decref(study);
    return true;
}

/* ---- The command ---- */

static pl_status check(void *user, pl_error *error)
{
    options *o = user;
    const char *names[FORMAT_COUNT];
    for (int i = 0; i < FORMAT_COUNT; ++i) {
        names[i] = formats[i].name;
        if (o->named != NULL && strcmp(o->named, names[i]) == 0) {
            o->format = &formats[i];
        }
    }
    if (o->named != NULL && o->format == NULL) {
        char hint[PL_SUGGESTION_SIZE];
        return pl_fail(error, PL_BAD_INPUT,
                       "--format: expected html, md, csv, svg, png or pdf, found \"%.40s\"%s",
                       o->named, pl_did_you_mean(o->named, names, FORMAT_COUNT, hint));
    }
    if (o->figure != NULL && o->format == NULL) {
        o->format = &formats[3];
    }
    if ((o->figure != NULL) != (o->format != NULL && o->format->file == NULL)) {
        return pl_fail(error, PL_BAD_INPUT,
                       o->figure != NULL ? "--figure makes svg, png or pdf"
                                         : "svg, png and pdf are for --figure");
    }
    return pl_request_check(&o->request, "name a file or folder of results", NULL, error);
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    o.request.out = "report";
    pl_call_parse(call, &o);
    making m = {.call = call, .o = &o, .request = &o.request, .merge = pl_merge_begin()};
    int code = PL_EXIT_OK;
    if (!deliver_study(&m)) {
        for (int i = 0; i < o.request.names.count; ++i) {
            pl_call_need(call,
                         pl_merge_add(&m.merge, o.request.names.items[i], stderr, call->error));
        }
        if (json_array_size(m.merge.results) == 0) {
            code = pl_call_nothing(call, "there are no results");
        } else if (o.format != NULL) {
            deliver_one(&m);
        } else {
            deliver_all(&m);
        }
    }
    pl_merge_free(&m.merge);
    pl_request_free(&o.request);
    return code;
}

static const pl_option OPTIONS[] = {
    {.name = "out",
     .argument = "DIR",
     .help = "Where the report and all results go (default report)",
     .kind = PL_OPTION_TEXT,
     .field = offsetof(options, request.out)},
    {.name = "format",
     .argument = "FORMAT",
     .help = "Only this: html, md, csv (a row a run); of --figure svg "
             "(default), png, pdf",
     .kind = PL_OPTION_TEXT,
     .field = offsetof(options, named),
     .values = "html|md|csv|svg|png|pdf"},
    {.name = "figure",
     .argument = "SCENARIO[:t=S]",
     .help = "Only a picture of a scenario, all engines side by side, "
             "at the end or at a time; needs Chromium",
     .kind = PL_OPTION_TEXT,
     .field = offsetof(options, figure)},
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
        "metrics differ are reported. Of the JSON of one study (threshold, ensemble, metamorphic, "
        "solve, "
        "tune) it writes the page.",
    .notes = "Examples:\n"
             "  plumb report sweep\n"
             "  plumb report monday/results.jsonl tuesday --out both\n"
             "  plumb report report --format csv --out tables\n"
             "  plumb report report --figure tower:t=2.5 --format pdf --out pictures\n"
             "  plumb report threshold.json --out thresholds",
    .options = OPTIONS,
    .shared = {pl_home_options, pl_file_options, pl_force_options},
    .check = check,
    .run = run};
