#define _POSIX_C_SOURCE 200809L

#include "file_text.h"

#include "text_buffer.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static pl_status fail_by_size(const pl_file_kind *kind, const char *label, const char *found,
                              pl_error *error)
{
    return pl_fail(error, PL_BAD_INPUT, "%s: expected a %s file of at most %zu MiB, found %s",
                   label, kind->noun, kind->most_bytes >> 20, found);
}

/* Checks the kind and the size of the file before it is read. */
static pl_status check_stream(const pl_file_kind *kind, FILE *stream, const char *label,
                              pl_error *error)
{
    struct stat status;
    if (fstat(fileno(stream), &status) != 0) {
        return pl_fail(error, PL_IO, "%s: %s", label, strerror(errno));
    }
    if (S_ISDIR(status.st_mode)) {
        return pl_fail(error, PL_BAD_INPUT, "%s: expected a %s file, found a directory", label,
                       kind->noun);
    }
    if (S_ISREG(status.st_mode) && (unsigned long long)status.st_size > kind->most_bytes) {
        char found[48];
        snprintf(found, sizeof found, "%lld bytes", (long long)status.st_size);
        return fail_by_size(kind, label, found, error);
    }
    return PL_OK;
}

/* Reads the whole stream. */
static pl_status read_stream(const pl_file_kind *kind, FILE *stream, const char *label,
                             pl_text_buffer *text, pl_error *error)
{
    char bytes[1 << 14];
    size_t got;
    while ((got = fread(bytes, 1, sizeof bytes, stream)) > 0) {
        pl_text_add_bytes(text, bytes, got);
        if (text->length > kind->most_bytes) {
            return fail_by_size(kind, label, "more", error);
        }
    }
    if (ferror(stream)) {
        return pl_fail(error, PL_IO, "%s: %s", label, strerror(errno));
    }
    pl_text_add(text, ""); /* so that an empty file has a text */
    return text->failed ? pl_fail(error, PL_NO_MEMORY, "%s: out of memory", label) : PL_OK;
}

const char *pl_file_label(const char *path)
{
    return strcmp(path, "-") == 0 ? "<stdin>" : path;
}

size_t pl_byte_order_mark(const char *text, size_t length)
{
    return length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
}

static pl_status read_all(const pl_file_kind *kind, FILE *stream, const char *label, char **text,
                          size_t *length, pl_error *error)
{
    pl_status status = check_stream(kind, stream, label, error);
    if (status == PL_OK) {
        pl_text_buffer read = {0};
        status = read_stream(kind, stream, label, &read, error);
        if (status == PL_OK) {
            *text = read.data;
            *length = read.length;
        } else {
            pl_text_free(&read);
        }
    }
    return status;
}

pl_status pl_file_read(const pl_file_kind *kind, const char *path, char **text, size_t *length,
                       pl_error *error)
{
    const bool is_stdin = strcmp(path, "-") == 0;
    const char *label = pl_file_label(path);
    FILE *stream = is_stdin ? stdin : fopen(path, "rb");
    if (stream == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "%s: expected a %s file, found none to read: %s", label,
                       kind->noun, strerror(errno));
    }
    const pl_status status = read_all(kind, stream, label, text, length, error);
    if (!is_stdin) {
        fclose(stream);
    }
    return status;
}

pl_status pl_file_read_open(const pl_file_kind *kind, int descriptor, const char *label,
                            char **text, size_t *length, pl_error *error)
{
    FILE *stream = fdopen(descriptor, "rb");
    if (stream == NULL) {
        close(descriptor);
        return pl_fail(error, PL_NO_MEMORY, "%s: out of memory", label);
    }
    const pl_status status = read_all(kind, stream, label, text, length, error);
    fclose(stream);
    return status;
}
