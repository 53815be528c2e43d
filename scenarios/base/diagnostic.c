/* Errors (plumb/base.h), diagnostics and checks. */
#include "diagnostic.h"

#include "number.h"
#include "text_buffer.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

pl_status(pl_fail)(pl_error *error, pl_status status, const char *format, ...)
{
    if (error == NULL) {
        return status;
    }
    error->status = status;
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    if (length < 0) {
        error->message[0] = '\0';
    } else if ((size_t)length >= sizeof error->message) {
        /* A cut must not leave half a UTF-8 character: drop its continuation bytes and its head. */
        size_t end = sizeof error->message - 1;
        while (end > 0 && ((unsigned char)error->message[end - 1] & 0xC0u) == 0x80u) {
            --end;
        }
        if (end > 0 && (unsigned char)error->message[end - 1] >= 0xC0u) {
            --end;
        }
        error->message[end] = '\0';
    }
    pl_make_plain(error->message);
    return status;
}

static void push(pl_path *path, pl_path_step step)
{
    if (path->depth < PL_PATH_DEPTH) {
        path->steps[path->depth] = step;
    }
    ++path->depth;
}

void pl_path_push_key(pl_path *path, const char *key)
{
    push(path, (pl_path_step){.key = key});
}

void pl_path_push_index(pl_path *path, int index)
{
    push(path, (pl_path_step){.index = index});
}

void pl_path_pop(pl_path *path)
{
    --path->depth;
}

static bool is_plain_word(const char *key)
{
    if (!isalpha((unsigned char)key[0])) {
        return false;
    }
    for (const char *c = key; *c != '\0'; ++c) {
        if (!isalnum((unsigned char)*c) && *c != '_') {
            return false;
        }
    }
    return strlen(key) < PL_NAME_SIZE;
}

void pl_path_text(const pl_path *path, const char *whole, char *text, size_t size)
{
    snprintf(text, size, "%s", path->depth == 0 ? whole : "");
    for (int i = 0; i < path->depth && i < PL_PATH_DEPTH; ++i) {
        const pl_path_step *step = &path->steps[i];
        size_t used = strlen(text);
        char quoted[PL_QUOTED_SIZE];
        if (step->key == NULL) {
            snprintf(text + used, size - used, "[%d]", step->index);
        } else if (is_plain_word(step->key)) {
            snprintf(text + used, size - used, "%s%s", i == 0 ? "" : ".", step->key);
        } else {
            snprintf(text + used, size - used, "[%s]", pl_quoted(step->key, quoted));
        }
    }
}

#if defined(__GNUC__)
__attribute__((format(printf, 2, 0)))
#endif
static void
set_text(pl_diagnostic *diagnostic, const char *format, va_list arguments)
{
    diagnostic->status = PL_BAD_INPUT;
    vsnprintf(diagnostic->text, sizeof diagnostic->text, format, arguments);
    pl_make_plain(diagnostic->text);
}

bool pl_diagnose(pl_diagnostic *diagnostic, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    set_text(diagnostic, format, arguments);
    va_end(arguments);
    return false;
}

bool pl_diagnose_field(pl_diagnostic *diagnostic, const char *key, const char *format, ...)
{
    pl_path_push_key(&diagnostic->path, key);
    va_list arguments;
    va_start(arguments, format);
    set_text(diagnostic, format, arguments);
    va_end(arguments);
    return false;
}

bool pl_diagnose_reference(pl_diagnostic *diagnostic, const char *key, const char *kind,
                           const char *name, const char *nearest)
{
    char quoted[PL_QUOTED_SIZE];
    if (nearest == NULL) {
        return pl_diagnose_field(diagnostic, key, "expected the name of a %s, found %s", kind,
                                 pl_quoted(name, quoted));
    }
    return pl_diagnose_field(diagnostic, key,
                             "expected the name of a %s, found %s; did you mean \"%s\"?", kind,
                             pl_quoted(name, quoted), nearest);
}

bool pl_diagnose_no_memory(pl_diagnostic *diagnostic)
{
    diagnostic->status = PL_NO_MEMORY;
    snprintf(diagnostic->text, sizeof diagnostic->text, "out of memory");
    return false;
}

const char *pl_quoted(const char *bytes, char text[PL_QUOTED_SIZE])
{
    enum { LONGEST = 40 };
    const char *end = memchr(bytes, '\0', LONGEST + 1);
    size_t length = end != NULL ? (size_t)(end - bytes) : LONGEST;
    if (end == NULL) {
        while (length > 0 && ((unsigned char)bytes[length] & 0xC0u) == 0x80u) {
            --length; /* not in the middle of a UTF-8 character */
        }
    }
    snprintf(text, PL_QUOTED_SIZE, "\"%.*s", (int)length, bytes);
    pl_make_plain(text);
    length = strlen(text);
    snprintf(text + length, PL_QUOTED_SIZE - length, "%s\"", end == NULL ? "..." : "");
    return text;
}

/* ---- Checks ---- */

bool pl_check_name(const char *name, size_t length, pl_diagnostic *diagnostic)
{
    if (length == 0 || length >= PL_NAME_SIZE) {
        return pl_diagnose(diagnostic, "expected a name of 1 to %d bytes, found %zu bytes",
                           PL_NAME_SIZE - 1, length);
    }
    for (size_t i = 0; i < length; ++i) {
        if ((unsigned char)name[i] < 0x20 || name[i] == 0x7F) {
            return pl_diagnose(diagnostic,
                               "expected a name without control characters, found byte 0x%02X",
                               (unsigned)(unsigned char)name[i]);
        }
    }
    return true;
}

double pl_norm(const double *vector, int n)
{
    double sum = 0;
    for (int k = 0; k < n; ++k) {
        sum += vector[k] * vector[k];
    }
    return sqrt(sum);
}

bool pl_check_number(pl_diagnostic *diagnostic, const char *key, double value, bool right,
                     const char *expected)
{
    if (right) {
        return true;
    }
    char found[PL_NUMBER_SIZE];
    if (key != NULL) {
        pl_path_push_key(&diagnostic->path, key);
    }
    return pl_diagnose(diagnostic, "expected %s, found %s", expected, pl_number_text(value, found));
}

bool pl_check_is_finite(pl_diagnostic *diagnostic, const char *key, double value)
{
    return pl_check_number(diagnostic, key, value, isfinite(value), "a finite number");
}

bool pl_check_positive(pl_diagnostic *diagnostic, const char *key, double value)
{
    return pl_check_number(diagnostic, key, value, isfinite(value) && value > 0,
                           "a finite number above 0");
}

bool pl_check_vector(pl_diagnostic *diagnostic, const char *key, const double vector[3])
{
    pl_path_push_key(&diagnostic->path, key);
    for (int k = 0; k < 3; ++k) {
        if (!isfinite(vector[k])) {
            pl_path_push_index(&diagnostic->path, k);
            return pl_check_is_finite(diagnostic, NULL, vector[k]);
        }
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

bool pl_check_unit(pl_diagnostic *diagnostic, const char *key, const double *vector, int n,
                   const char *expected)
{
    char found[PL_NUMBER_SIZE];
    double norm = pl_norm(vector, n);
    if (fabs(norm - 1) <= PL_UNIT_TOLERANCE) {
        return true;
    }
    return pl_diagnose_field(diagnostic, key, "expected %s, found one of norm %s", expected,
                             pl_number_text(norm, found));
}
