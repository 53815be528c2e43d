/* The page of a study. */
#include "page.h"

#include "base/file_text.h"
#include "base/heap.h"
#include "base/json_field.h"
#include "results/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Adds the values of the text to an array. False with the fault of the text. */
static bool read_values(const char *text, size_t length, json_t *values, json_error_t *fault)
{
    size_t at = strspn(text, " \t\r\n");
    while (at < length) {
        json_t *value = json_loadb(text + at, length - at, JSON_DISABLE_EOF_CHECK, fault);
        if (value == NULL) {
            return false;
        }
        json_array_append_new(values, value);
        at += (size_t)fault->position;
        at += strspn(text + at, " \t\r\n");
    }
    return true;
}

/* The word of the schema of a study, or of its first row. A sweep's earlier form is none: its results make it again. */
static bool find_kind(const json_t *study, char kind[PL_STUDY_KIND_SIZE])
{
    const json_t *row = json_is_array(study) ? json_array_get(study, 0) : study;
    char rest[8];
    return sscanf(pl_json_get_text(row, "schema"), "plumb.%31[a-z_]/%7[0-9]", kind, rest) == 2 &&
           strcmp(kind, "result") != 0 && strcmp(kind, "recording") != 0 &&
           (strcmp(kind, "sweep") != 0 || strcmp(rest, "2") == 0);
}

pl_status pl_study_read(const char *path, json_t **study, char kind[PL_STUDY_KIND_SIZE],
                        pl_error *error)
{
    static const pl_file_kind file = {.noun = "study", .most_bytes = 256u << 20};
    char *text = NULL;
    size_t length = 0;
    json_error_t fault = {.line = 1};
    json_t *values = json_array();
    *study = NULL;
    pl_status status = pl_file_read(&file, path, &text, &length, error);
    if (status == PL_OK && !read_values(text, length, values, &fault)) {
        status = pl_fail(error, PL_BAD_INPUT, "%.200s:%d:%d: %.100s", path, fault.line,
                         fault.column, fault.text);
    }
    if (status == PL_OK) {
        *study = json_array_size(values) == 1 ? json_incref(json_array_get(values, 0))
                                              : json_incref(values);
        if (!find_kind(*study, kind)) {
            status =
                pl_fail(error, PL_BAD_INPUT,
                        "%.200s: expected the JSON of a study, such as plumb.threshold/1", path);
            json_decref(*study);
            *study = NULL;
        }
    }
    json_decref(values);
    free(text);
    return status;
}

pl_status pl_study_page_write(const char *directory, const char *name, const char *kind,
                              json_t *study, pl_error *error)
{
    pl_text_buffer page = {0};
    char *path = pl_heap_format("%s/%s.html", directory, name);
    pl_page_of_study(&page, kind, study);
    const pl_status status = pl_write_buffer(path, &page, error);
    free(path);
    return status;
}
