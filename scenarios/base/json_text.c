#include "json_text.h"

#include "file_text.h"
#include "json_locate.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static pl_status fail_at_offset(const char *text, size_t offset, const char *label,
                                const char *where, const char *what, pl_error *error)
{
    int line, column;
    pl_locate_offset(text, offset, &line, &column);
    return pl_fail(error, PL_BAD_INPUT, "%s:%d:%d: %s: %s", label, line, column, where, what);
}

static pl_status fail_by_syntax(const char *text, size_t length, const char *label,
                                json_error_t *syntax, pl_error *error)
{
    enum json_error_code code = json_error_code(syntax);
    if (code == json_error_out_of_memory) {
        return pl_fail(error, PL_NO_MEMORY, "%s: out of memory", label);
    }
    size_t end = syntax->position < 0 ? 0 : (size_t)syntax->position;
    end = end < length ? end : length;
    /* jansson stops before a byte that it cannot decode, at the end of the text when it is cut
     * short, and otherwise behind the token that it cannot use. */
    bool at_end = code == json_error_invalid_utf8 || code == json_error_premature_end_of_input;
    size_t offset = at_end ? end : pl_locate_token(text, end);
    char what[JSON_ERROR_TEXT_LENGTH + 48];
    snprintf(what, sizeof what, "expected valid JSON, found: %s", syntax->text);
    for (char *c = what; *c != '\0'; c++) {
        *c = (char)((unsigned char)*c < 0x20 || *c == 0x7F ? '?' : *c);
    }
    return fail_at_offset(text, offset, label, "JSON syntax", what, error);
}

static pl_status fail_by_diagnostic(const pl_json_kind *kind, const char *text, size_t length,
                                    const char *label, const pl_diagnostic *diagnostic,
                                    pl_error *error)
{
    if (diagnostic->status != PL_BAD_INPUT) {
        return pl_fail(error, diagnostic->status, "%s: %s", label, diagnostic->text);
    }
    char path[256];
    pl_path_text(&diagnostic->path, kind->noun, path, sizeof path);
    size_t offset = pl_locate_path(text, length, &diagnostic->path, diagnostic->at_key);
    return fail_at_offset(text, offset, label, path, diagnostic->text, error);
}

static bool is_blank(const char *text, size_t length)
{
    size_t i = 0;
    while (i < length && memchr(" \t\r\n", text[i], 4) != NULL) {
        i++;
    }
    return i == length;
}

pl_status pl_json_read_text(const pl_json_kind *kind, const char *text, size_t length,
                            const char *label, void *user, pl_error *error)
{
    if (length > kind->most_bytes) {
        return pl_fail(error, PL_BAD_INPUT, "%s: expected at most %zu bytes, found %zu", label,
                       kind->most_bytes, length);
    }
    if (is_blank(text, length)) {
        return fail_at_offset(text, 0, label, kind->noun,
                              "expected a JSON object, found an empty file", error);
    }
    json_error_t syntax;
    /* Whole numbers as reals: then 1e3, 1000 and -0 all are what they say, and none is too big. */
    json_t *json =
        json_loadb(text, length, JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, &syntax);
    if (json == NULL) {
        return fail_by_syntax(text, length, label, &syntax, error);
    }
    pl_diagnostic diagnostic = {.status = PL_OK};
    pl_status status = PL_OK;
    if (!kind->read(json, user, &diagnostic)) {
        status = fail_by_diagnostic(kind, text, length, label, &diagnostic, error);
    }
    json_decref(json);
    return status;
}

pl_status pl_json_read_file(const pl_json_kind *kind, const char *path, void *user, pl_error *error)
{
    const pl_file_kind file_kind = {.noun = kind->noun, .most_bytes = kind->most_bytes};
    char *text = NULL;
    size_t length = 0;
    pl_status status = pl_file_read(&file_kind, path, &text, &length, error);
    if (status == PL_OK) {
        status = pl_json_read_text(kind, text, length, pl_file_label(path), user, error);
        free(text);
    }
    return status;
}
