/* The report's files. All texts are made first; then all files are written under temporary names;
 * then all are renamed. CSV is that of RFC 4180 (Shafranovich 2005). */
#include "report.h"

#include "base/file_text.h"
#include "base/heap.h"
#include "page.h"
#include "page_data.h"
#include "report_document.h"
#include "results/result.h"
#include "results/store.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- CSV ---- */

/* Keys of a result; "a.b" is the key b of the object a. */
static const char *const run_columns[] = {
    "run",           "scenario",   "params",         "scene_hash",    "seed",     "repeat",
    "engine",        "profile",    "engine_version", "engine_binary", "label",    "settings",
    "outcome",       "reason",     "steps.asked",    "steps.done",    "host.cpu", "host.os",
    "host.compiler", "host.flags", "plumb.version",  "plumb.git",     "started",  NULL};
static const char *const metric_columns[] = {"unit", "direction",  "deterministic", "p50", "p95",
                                             "p99",  "worst_step", "reason",        NULL};
static const char *const verdict_columns[] = {"verdict", "verdict_reason", "acceptance", NULL};

/* Adds the comma between two fields of a line. */
static void add_comma(pl_text_buffer *out)
{
    pl_text_add(out, out->length == 0 || out->data[out->length - 1] == '\n' ? "" : ",");
}

/* Adds a field, empty for null. A real number has a point or an exponent, so that the type of a column does not depend
 * on its values. */
static void add_value(const json_t *value, pl_text_buffer *out)
{
    char digits[32];
    if (value == NULL || json_is_null(value)) {
        return;
    }
    if (json_is_string(value)) {
        pl_text_add_csv(out, json_string_value(value));
    } else if (json_is_real(value)) {
        snprintf(digits, sizeof digits, "%.17g", json_real_value(value));
        pl_text_format(out, "%s%s", digits, strpbrk(digits, ".e") == NULL ? ".0" : "");
    } else {
        char *text = pl_result_to_line(value);
        pl_text_add_csv(out, text);
        free(text);
    }
}

static const json_t *value_at(const json_t *result, const char *column)
{
    const char *dot = strchr(column, '.');
    if (dot == NULL) {
        return json_object_get(result, column);
    }
    char object[32];
    snprintf(object, sizeof object, "%.*s", (int)(dot - column), column);
    return json_object_get(json_object_get(result, object), dot + 1);
}

static void add_columns(const char *const *columns, pl_text_buffer *out)
{
    for (; *columns != NULL; ++columns) {
        add_comma(out);
        for (const char *c = *columns; *c != '\0'; ++c) {
            pl_text_format(out, "%c", *c == '.' ? '_' : *c);
        }
    }
}

static void add_values(const json_t *object, const char *const *columns, pl_text_buffer *out)
{
    for (; *columns != NULL; ++columns) {
        add_comma(out);
        add_value(value_at(object, *columns), out);
    }
}

/* Adds a row; `name` and `metric` are NULL for a run without metrics. */
static void add_line(const json_t *result, const char *name, const json_t *metric,
                     pl_text_buffer *out)
{
    const json_t *value = json_object_get(metric, "value");
    add_values(result, run_columns, out);
    pl_text_add(out, ",");
    pl_text_add_csv(out, name == NULL ? "" : name);
    pl_text_add(out, ",");
    add_value(json_is_string(value) ? NULL : value, out);
    add_values(metric, metric_columns, out);
    add_values(result, verdict_columns, out);
    pl_text_add(out, ",");
    add_value(json_is_string(value) ? value : NULL, out);
    pl_text_add(out, "\r\n");
}

/* The last column has the values that are texts, so that the column value has numbers alone. */
static void add_header(pl_text_buffer *out)
{
    add_columns(run_columns, out);
    pl_text_add(out, ",metric,value,unit,direction,deterministic,p50,p95,p99,worst_step,"
                     "metric_reason");
    add_columns(verdict_columns, out);
    pl_text_add(out, ",value_text\r\n");
}

void pl_report_csv(const pl_result_table *results, pl_text_buffer *out)
{
    const pl_result_row **rows = pl_result_table_by_place(results);
    add_header(out);
    for (int i = 0; i < results->row_count; ++i) {
        if (json_object_size(rows[i]->metrics) == 0) {
            add_line(rows[i]->result, NULL, NULL, out);
        }
        const char *name;
        json_t *metric;
        json_object_foreach((json_t *)rows[i]->metrics, name, metric)
        {
            add_line(rows[i]->result, name, metric, out);
        }
    }
    free(rows);
}

/* ---- Files ---- */

/* A file of the report: its text, its path, and its path until all files are complete. */
typedef struct report_file {
    const char *name;
    pl_text_buffer text;
    char *final, *temporary; /* NULL: not written */
} report_file;

static pl_status write_temporary(report_file *file, const char *directory, pl_error *error)
{
    pl_error cause = {PL_OK, ""};
    file->final = pl_heap_format("%s/%s", directory, file->name);
    file->temporary = pl_heap_format("%s/.%s.%ld.tmp", directory, file->name, (long)getpid());
    const pl_status status = pl_write_buffer(file->temporary, &file->text, &cause);
    return status == PL_OK ? PL_OK
                           : pl_fail(error, status, "%.200s cannot be written: %.200s", file->final,
                                     cause.message);
}

/* Writes all or none. */
static pl_status write_files(report_file *files, int count, const pl_report_def *def,
                             pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < count && status == PL_OK; ++i) {
        if (def->only == NULL || strcmp(def->only, files[i].name) == 0) {
            status = write_temporary(&files[i], def->directory, error);
        }
    }
    for (int i = 0; i < count && status == PL_OK; ++i) {
        if (files[i].temporary != NULL && rename(files[i].temporary, files[i].final) != 0) {
            status = pl_fail(error, PL_IO, "%.300s cannot be replaced: %s", files[i].final,
                             strerror(errno));
        }
    }
    for (int i = 0; i < count; ++i) {
        if (files[i].temporary != NULL) {
            unlink(files[i].temporary); /* of a file that was not renamed */
        }
        free(files[i].final);
        free(files[i].temporary);
        pl_text_free(&files[i].text);
    }
    return status;
}

/* ---- Runs in a row each ---- */

void pl_report_runs_csv(const pl_result_table *results, pl_text_buffer *out)
{
    const pl_result_row **rows = pl_result_table_by_place(results);
    add_columns(run_columns, out);
    add_columns(verdict_columns, out);
    for (int id = 0; id < PL_METRIC_COUNT; ++id) {
        const char *unit = pl_metric_table_unit(id);
        pl_text_format(out, unit[0] == '\0' ? ",%s" : ",%s (%s)", pl_metric_table[id].name, unit);
    }
    pl_text_add(out, "\r\n");
    for (int i = 0; i < results->row_count; ++i) {
        add_values(rows[i]->result, run_columns, out);
        add_values(rows[i]->result, verdict_columns, out);
        for (int id = 0; id < PL_METRIC_COUNT; ++id) {
            const json_t *metric = json_object_get(rows[i]->metrics, pl_metric_table[id].name);
            pl_text_add(out, ",");
            add_value(json_object_get(metric, "value"), out);
        }
        pl_text_add(out, "\r\n");
    }
    free(rows);
}

/* ---- The page ---- */

/* The most bytes of recordings in a page, so that it can be mailed. */
enum { MOST_RECORDINGS = 8 << 20, MOST_RECORDING = 64 << 20 };

typedef struct recording {
    char run[17];
    char path[PATH_MAX];
    long long size;
} recording;

static int compare_sizes(const void *left, const void *right)
{
    const recording *a = left, *b = right;
    const int order = (a->size > b->size) - (a->size < b->size);
    return order != 0 ? order : strcmp(a->run, b->run);
}

/* The length of the folder's name: of a file, that of the folder it is in. */
static int folder_length(const char *path)
{
    struct stat information;
    const char *slash = strrchr(path, '/');
    const bool is_folder = stat(path, &information) == 0 && S_ISDIR(information.st_mode);
    return (int)(is_folder || slash == NULL ? strlen(path) : (size_t)(slash - path));
}

/* Finds the recording of a run in the first folder that has it. */
static bool find_recording(const pl_report_def *def, const char *run, recording *found)
{
    struct stat information;
    for (int f = 0; f < def->folder_count && strlen(run) == 16; ++f) {
        const int length = snprintf(found->path, sizeof found->path, "%.*s/recordings/%s.json",
                                    folder_length(def->folders[f]), def->folders[f], run);
        if (length < (int)sizeof found->path && stat(found->path, &information) == 0) {
            snprintf(found->run, sizeof found->run, "%s", run);
            found->size = information.st_size;
            return true;
        }
    }
    return false;
}

/* The recordings of the runs that cells show, the smallest first. The caller frees. */
static recording *find_recordings(const pl_report_def *def, int *count)
{
    recording *found = NULL, next;
    *count = 0;
    for (int i = 0; i < def->results->cell_count; ++i) {
        if (find_recording(def, def->results->cells[i].worst->run, &next)) {
            pl_push(&found, count, &next, sizeof next);
        }
    }
    if (found != NULL) {
        qsort(found, (size_t)*count, sizeof *found, compare_sizes);
    }
    return found;
}

/* Adds those recordings that fit. One that cannot be read is left out, as if it were not there. */
static void add_recordings(const pl_report_def *def, pl_text_buffer *out)
{
    static const pl_file_kind kind = {.noun = "recording", .most_bytes = MOST_RECORDING};
    int count = 0;
    long long total = 0;
    recording *found = find_recordings(def, &count);
    json_t *left_out = json_array();
    for (int i = 0; i < count; ++i) {
        char *text = NULL, id[32];
        size_t length = 0;
        total += found[i].size;
        if (total > MOST_RECORDINGS) {
            json_array_append_new(left_out, json_string(found[i].run));
        } else if (pl_file_read(&kind, found[i].path, &text, &length, NULL) == PL_OK) {
            snprintf(id, sizeof id, "recording-%s", found[i].run);
            pl_page_add_text(out, id, text, length);
        }
        free(text);
    }
    pl_page_add(out, "left-out", left_out);
    json_decref(left_out);
    free(found);
}

static void add_page(const pl_report_def *def, const pl_report *report, pl_text_buffer *out)
{
    json_t *data = pl_page_data(report);
    if (def->reference != NULL) {
        json_object_set_new(data, "reference", json_deep_copy(def->reference));
    }
    pl_page_open(out);
    pl_page_add(out, "data", data);
    add_recordings(def, out);
    pl_page_close(out);
    json_decref(data);
}

static void add_summary(const pl_report *report, pl_text_buffer *out)
{
    pl_document document = {0};
    pl_report_document(report, PL_READER_SUMMARY, &document);
    char *text = pl_document_markdown(&document);
    pl_text_add(out, text);
    free(text);
    pl_document_free(&document);
}

pl_status pl_report_write(const pl_report_def *def, pl_error *error)
{
    report_file files[] = {{.name = "results.csv"},
                           {.name = "runs.csv"},
                           {.name = "summary.md"},
                           {.name = "index.html"}};
    enum { FILE_COUNT = sizeof files / sizeof files[0] };
    pl_report report = pl_report_build(def->results);
    pl_report_csv(def->results, &files[0].text);
    pl_report_runs_csv(def->results, &files[1].text);
    add_summary(&report, &files[2].text);
    add_page(def, &report, &files[3].text);
    const pl_status status = write_files(files, FILE_COUNT, def, error);
    pl_report_free(&report);
    return status;
}

void pl_report_print(FILE *out, const pl_result_table *results, bool colour, int width)
{
    pl_report report = pl_report_build(results);
    pl_document document = {.colour = colour};
    pl_report_document(&report, PL_READER_TERMINAL, &document);
    char *text = pl_document_text(&document, width);
    fputs(text, out);
    free(text);
    pl_document_free(&document);
    pl_report_free(&report);
}
