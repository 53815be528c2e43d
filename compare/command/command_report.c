/* plumb report: the report of existing results, from any number of files. */
#include "base/folding.h"
#include "base/heap.h"
#include "figure.h"
#include "report/report.h"
#include "report/study_page.h"
#include "results/result.h"
#include "results/store.h"
#include "studies/sweep/analysis.h"
#include "studies/sweep/shard_merge.h"
#include "study_command.h"
#include "study_list.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* What --format names: one file of the report, or the format of a picture. */
typedef struct format {
    const char *name;
    const char *file; /* NULL: a picture */
    pl_figure_format picture;
} format;
static const format formats[] = {{"html", "index.html", 0},    {"md", "summary.md", 0},
                                 {"csv", "runs.csv", 0},       {"svg", NULL, PL_FIGURE_SVG},
                                 {"png", NULL, PL_FIGURE_PNG}, {"pdf", NULL, PL_FIGURE_PDF}};
enum { FORMAT_COUNT = sizeof formats / sizeof formats[0] };

typedef struct options {
    pl_request request;
    const char *figure; /* --figure; NULL: none */
    const char *named;  /* --format; NULL: none */
    const format *format;
} options;

static bool has_run(const pl_merge *merge, const json_t *result)
{
    return json_object_get(merge->runs, pl_json_get_text(result, "run")) != NULL;
}

/* Results of the folder that are not in the report would be lost. */
static pl_status check_kept(const pl_merge *merge, const char *out, pl_store *store, bool force,
                            pl_error *error)
{
    long lost = 0;
    if (force) {
        return PL_OK;
    }
    size_t index;
    const json_t *result;
    json_array_foreach(pl_store_results(store), index, result)
    {
        lost += !has_run(merge, result);
    }
    return lost == 0 ? PL_OK
                     : pl_fail(error, PL_BAD_INPUT,
                               "%s/results.jsonl has %ld results that the report would not have: "
                               "name it too, or choose another --out; --force leaves them out",
                               out, lost);
}

/* Whether the folder is one of those that are read. */
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

/* Whether a file of --out may be written: it is not there, or is a report of the same results. */
static pl_status check_file(const pl_request *request, bool is_own, const char *file,
                            pl_error *error)
{
    char *path = pl_heap_format("%s/%s", request->out, file);
    const pl_status status = is_own ? PL_OK : pl_output_check(path, request->force, error);
    free(path);
    return status;
}

static pl_status build_table(const pl_request *request, const pl_merge *merge, bool has_changes,
                             pl_result_table *results, pl_error *error)
{
    const pl_result_table_def def = {.files = merge->sources,
                                     .file_count = merge->source_count,
                                     .has_changes = has_changes,
                                     .home = request->home};
    return pl_result_table_build(&def, results, error);
}

/* Of a sweep, where an engine has several points on a scene, who is faster at the same error. */
static pl_status analyse(const pl_request *request, const pl_merge *merge, pl_error *error)
{
    pl_result_table results;
    pl_status status = build_table(request, merge, true, &results, error);
    json_t *conclusion = status == PL_OK ? pl_sweep_conclude(&results) : NULL;
    if (pl_sweep_has_settings(conclusion)) {
        status = pl_study_write(request, &pl_sweep_study, conclusion, error);
        if (status == PL_OK) {
            pl_print_line(stderr, "speed against error is in %s/sweep.html", request->out);
        }
    }
    json_decref(conclusion);
    pl_result_table_free(&results);
    return status;
}

/* The JSON of a comparison without a reference of its own (plumb.reference/1) next to the results;
 * NULL: none. */
static json_t *find_reference(const pl_request *request)
{
    json_t *found = NULL;
    for (int i = 0; i < request->names.count && found == NULL; ++i) {
        char path[4096];
        snprintf(path, sizeof path, "%.4000s/reference.json", request->names.items[i]);
        found = json_load_file(path, 0, NULL);
    }
    return found;
}

/* Writes the report of the results, or a picture, without those of changed scenes: only a sweep asks
 * whether its points hold on them. */
static pl_status write_report(const options *o, const pl_merge *merge, pl_error *error)
{
    const pl_request *request = &o->request;
    pl_result_table results;
    pl_status status = build_table(request, merge, false, &results, error);
    json_t *reference = find_reference(request);
    const pl_report_def def = {.directory = request->out,
                               .only = o->format == NULL ? NULL : o->format->file,
                               .reference = reference,
                               .results = &results,
                               .folders = request->names.items,
                               .folder_count = request->names.count};
    char *picture = NULL;
    if (status == PL_OK) {
        pl_result_table_print_left_out(&results, stderr);
        status = o->figure != NULL && o->format != NULL
                     ? pl_figure_write(&def, o->figure, o->format->picture, request->force,
                                       &picture, error)
                     : pl_report_write(&def, error);
    }
    if (picture != NULL && status == PL_OK) {
        pl_print_line(stderr, "the picture is in %s", picture);
    }
    free(picture);
    json_decref(reference);
    pl_result_table_free(&results);
    return status;
}

/* Concludes every study that has runs among the results. */
static pl_status conclude_studies(const pl_request *request, const pl_merge *merge, pl_error *error)
{
    pl_status status = PL_OK;
    int count = 0;
    const pl_study *const *studies = pl_studies(&count);
    for (int i = 0; i < count && status == PL_OK; ++i) {
        if (studies[i]->conclude == NULL) {
            continue;
        }
        const pl_result_table_def def = {.files = merge->sources,
                                         .file_count = merge->source_count,
                                         .study = studies[i]->name,
                                         .has_changes = true};
        json_t *own = NULL, *conclusion = NULL;
        status = pl_results_that_count(&def, &own, error);
        if (status == PL_OK && json_array_size(own) > 0) {
            status = pl_study_deliver(request, studies[i], own, request->names.items[0],
                                      &conclusion, error);
        }
        json_decref(conclusion);
        json_decref(own);
    }
    return status;
}

/* The report of the runs that belong to no study. */
static pl_status report_plain(const options *o, const pl_merge *merge, pl_error *error)
{
    json_t *plain = pl_results_of_study(merge->results, NULL);
    pl_status status = PL_OK;
    if (json_array_size(plain) > 0) {
        status = write_report(o, merge, error);
    }
    if (status == PL_OK && json_array_size(plain) > 0) {
        status = analyse(&o->request, merge, error);
    }
    json_decref(plain);
    return status;
}

/* The store is held open while its file is replaced, so that nobody else is writing it. */
static pl_status deliver(const options *o, const pl_merge *merge, pl_error *error)
{
    const pl_request *request = &o->request;
    pl_store *store = NULL;
    if (o->format != NULL) {
        pl_status made = o->format->file == NULL
                             ? PL_OK
                             : check_file(request, is_read(request), o->format->file, error);
        if (made == PL_OK) {
            made = pl_make_directories(request->out, error);
        }
        return made == PL_OK ? write_report(o, merge, error) : made;
    }
    char *path = pl_heap_format("%s/results.jsonl", request->out);
    pl_status status = pl_store_open(request->out, PL_STORE_RESUME, NULL, &store, error);
    if (status == PL_OK) {
        status = check_kept(merge, request->out, store, request->force, error);
    }
    if (status == PL_OK) {
        status =
            check_file(request, json_array_size(pl_store_results(store)) > 0, "index.html", error);
    }
    if (status == PL_OK) {
        status = report_plain(o, merge, error);
    }
    if (status == PL_OK) {
        status = conclude_studies(request, merge, error);
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
    pl_print_line(stderr, "%zu %s of %ld %s and the report are in %s/", count,
                  count == 1 ? "result" : "results", merge->files,
                  merge->files == 1 ? "file" : "files", request->out);
    if (merge->doubles > 0) {
        pl_print_line(stderr, "%ld %s dropped: the same runs", merge->doubles,
                      merge->doubles == 1 ? "duplicate was" : "duplicates were");
    }
    if (merge->differing > 0) {
        pl_print_line(
            stderr,
            "plumb report: warning: %ld of them differ in their outcome or in metrics that "
            "should be the same at every run; the first that was read is kept",
            merge->differing);
    }
}

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

/* Whether the only name is the JSON of a study; its page is then written. */
static bool is_study(const pl_request *request, pl_status *status, pl_error *error)
{
    char kind[PL_STUDY_KIND_SIZE];
    json_t *study = NULL;
    pl_error unused = {.message = ""};
    if (request->names.count != 1 ||
        pl_study_read(request->names.items[0], &study, kind, &unused) != PL_OK) {
        return false;
    }
    char page[PL_STUDY_KIND_SIZE + 8];
    const pl_study *known = pl_study_find(kind);
    const char *name = known != NULL ? known->name : kind;
    snprintf(page, sizeof page, "%s.html", name);
    *status = check_file(request, false, page, error);
    if (*status == PL_OK) {
        *status = pl_make_directories(request->out, error);
    }
    if (*status == PL_OK) {
        *status = known != NULL ? pl_study_write_page(request->out, known, study, error)
                                : pl_study_page_write(request->out, kind, kind, study, error);
    }
    if (*status == PL_OK) {
        pl_print_line(stderr, "the page is in %s/%s.html", request->out, name);
    }
    json_decref(study);
    return true;
}

static int run(const pl_call *call)
{
    options o = {.request = pl_request_default()};
    o.request.out = "report";
    pl_call_parse(call, &o);
    pl_request request = o.request;
    pl_error error = {.message = ""};
    pl_merge merge;
    int code = PL_EXIT_OK;
    pl_status status = PL_OK;
    if (is_study(&request, &status, &error)) {
        pl_request_free(&request);
        return status == PL_OK ? code : pl_call_fail(call, &error);
    }
    merge = pl_merge_begin();
    for (int i = 0; i < request.names.count && status == PL_OK; ++i) {
        status = pl_merge_add(&merge, request.names.items[i], stderr, &error);
    }
    const bool empty = status == PL_OK && json_array_size(merge.results) == 0;
    if (status == PL_OK && !empty) {
        status = deliver(&o, &merge, &error);
    }
    if (status != PL_OK) {
        code = pl_call_fail(call, &error);
    } else if (empty) {
        code = pl_call_nothing(call, "there are no results");
    } else if (o.format == NULL) {
        say_counts(&request, &merge);
    }
    pl_merge_free(&merge);
    pl_request_free(&request);
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
