#include "store.h"

#include "base/heap.h"
#include "base/json_field.h"
#include "result.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct pl_store {
    FILE *stream; /* for reading what is there; a lock of fcntl(2) lasts until any is closed */
    int file;     /* of the stream, for writing */
    char *path;
    char *replaced; /* path of what this file replaces; there is such a file, or none */
    bool replaces;  /* that file */
    off_t size;     /* bytes of complete lines */
    json_t *results;
    json_t *runs; /* run hash -> its first result */
};

static const char result_schema[] = "plumb.result/1";

/* Appends the result on one line to `results`. */
static pl_status read_line(const char *line, size_t length, const char *path, long number,
                           json_t *results, pl_error *error)
{
    json_error_t fault;
    json_t *result = json_loadb(line, length, JSON_REJECT_DUPLICATES, &fault);
    if (result == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "%s:%ld:%d: %s", path, number, fault.column,
                       fault.text);
    }
    const char *schema = json_string_value(json_object_get(result, "schema"));
    if (schema == NULL || strcmp(schema, result_schema) != 0 ||
        !json_is_string(json_object_get(result, "run"))) {
        pl_fail(error, PL_BAD_INPUT, "%s:%ld:1: expected a %s, found %s%.100s", path, number,
                result_schema, schema == NULL ? "no schema" : "schema ",
                schema == NULL ? "" : schema);
        json_decref(result);
        return PL_BAD_INPUT;
    }
    json_array_append_new(results, result);
    return PL_OK;
}

/* Reads the results of `stream` into a new array; `path` is for messages. */
static pl_status read_lines(FILE *stream, const char *path, json_t **results, long long *whole,
                            pl_error *error)
{
    char *line = NULL;
    size_t capacity = 0;
    long long end = 0;
    long number = 0;
    pl_status status = PL_OK;
    json_t *read = json_array();
    ssize_t length = 0;
    while (status == PL_OK && (length = getline(&line, &capacity, stream)) > 0 &&
           line[length - 1] == '\n') {
        ++number;
        status = read_line(line, (size_t)length, path, number, read, error);
        end += length;
    }
    if (status == PL_OK && ferror(stream)) {
        status = pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
    }
    free(line);
    if (status != PL_OK) {
        json_decref(read);
        return status;
    }
    if (whole != NULL) {
        *whole = end;
    }
    *results = read;
    return PL_OK;
}

pl_status pl_results_read(const char *path, json_t **results, long long *whole, pl_error *error)
{
    bool is_stdin = strcmp(path, "-") == 0;
    FILE *stream = is_stdin ? stdin : fopen(path, "re");
    if (stream == NULL) {
        return pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
    }
    pl_status status = read_lines(stream, path, results, whole, error);
    if (!is_stdin) {
        fclose(stream);
    }
    return status;
}

static pl_status write_all(int file, const char *text, size_t length, const char *path,
                           pl_error *error)
{
    while (length > 0) {
        ssize_t written = write(file, text, length);
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written < 0) {
            return pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
        }
        text += written;
        length -= (size_t)written;
    }
    return PL_OK;
}

/* Closes `file`; the first error wins. */
static pl_status close_written(int file, const char *path, pl_status status, pl_error *error)
{
    if (close(file) != 0 && status == PL_OK) {
        return pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
    }
    return status;
}

static pl_status write_by_rename(const char *path, const char *text, size_t length, pl_error *error)
{
    char *temporary = pl_heap_format("%s.XXXXXX", path);
    pl_status status = PL_OK;
    int file = mkstemp(temporary);
    if (file < 0) {
        status = pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
        goto cleanup;
    }
    mode_t mask = umask(0);
    umask(mask);
    fchmod(file, 0666 & ~mask);
    status = write_all(file, text, length, path, error);
    if (status == PL_OK && fsync(file) != 0) {
        status = pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
    }
    status = close_written(file, path, status, error);
    if (status == PL_OK && rename(temporary, path) != 0) {
        status = pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
    }
    if (status != PL_OK) {
        unlink(temporary);
    }

cleanup:
    free(temporary);
    return status;
}

bool pl_is_stdout(const char *path)
{
    return path != NULL && strcmp(path, "-") == 0;
}

pl_status pl_write_text(const char *path, const char *text, size_t length, pl_error *error)
{
    struct stat found;
    if (pl_is_stdout(path)) {
        fflush(stdout);
        return write_all(STDOUT_FILENO, text, length, "standard output", error);
    }
    if (stat(path, &found) == 0 && !S_ISREG(found.st_mode)) {
        int file = open(path, O_WRONLY | O_CLOEXEC);
        return file < 0
                   ? pl_fail(error, PL_IO, "%s: %s", path, strerror(errno))
                   : close_written(file, path, write_all(file, text, length, path, error), error);
    }
    return write_by_rename(path, text, length, error);
}

pl_status pl_write_buffer(const char *path, pl_text_buffer *text, pl_error *error)
{
    const size_t length = text->length;
    char *whole = pl_text_take(text);
    const pl_status status = pl_write_text(path, whole, length, error);
    free(whole);
    return status;
}

/* Whether there is a regular file that is not empty. */
static bool has_content(const char *path)
{
    struct stat found;
    return path != NULL && stat(path, &found) == 0 && S_ISREG(found.st_mode) && found.st_size > 0;
}

pl_status pl_output_check(const char *path, bool force, pl_error *error)
{
    return path == NULL || force || pl_is_stdout(path) || !has_content(path)
               ? PL_OK
               : pl_fail(error, PL_BAD_INPUT, "%s exists; --force replaces it", path);
}

pl_status pl_results_write_json(const char *path, const json_t *value, pl_error *error)
{
    if (path == NULL) {
        return PL_OK;
    }
    char *lines = pl_heap_json(value, JSON_INDENT(1));
    pl_text_buffer text = {0};
    pl_text_format(&text, "%s\n", lines);
    free(lines);
    return pl_write_buffer(path, &text, error);
}

pl_status pl_make_directories(const char *directory, pl_error *error)
{
    char *path = pl_heap_copy(directory);
    pl_status status = PL_OK;
    for (char *at = path; status == PL_OK && at != NULL;) {
        at = strchr(at + 1, '/');
        if (at != NULL) {
            *at = '\0';
        }
        if (mkdir(path, 0777) != 0 && errno != EEXIST) {
            status =
                pl_fail(error, PL_IO, "cannot make the directory %s: %s", path, strerror(errno));
        }
        if (at != NULL) {
            *at = '/';
        }
    }
    free(path);
    return status;
}

static void note_run(pl_store *store, json_t *result)
{
    const char *run = pl_json_get_text(result, "run");
    if (json_object_get(store->runs, run) == NULL) {
        json_object_set(store->runs, run, result);
    }
}

/* Takes over the lines that are there. */
static pl_status keep_lines(pl_store *store, pl_error *error)
{
    json_t *kept = NULL;
    long long whole = 0;
    pl_status status = read_lines(store->stream, store->path, &kept, &whole, error);
    if (status != PL_OK) {
        return status;
    }
    json_decref(store->results);
    store->results = kept;
    store->size = (off_t)whole;
    size_t index;
    json_t *result;
    json_array_foreach(kept, index, result)
    {
        note_run(store, result);
    }
    return PL_OK;
}

/* The lock goes with the process, so that nothing is left behind by one that was killed. */
static pl_status lock_file(int file, const char *path, pl_error *error)
{
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    struct stat locked, named;
    const bool is_locked = fcntl(file, F_SETLK, &lock) == 0;
    if (!is_locked && errno != EACCES && errno != EAGAIN) {
        return pl_fail(error, PL_IO, "%s: %s", path, strerror(errno));
    }
    /* Meanwhile another process may have given the file another name. */
    const bool is_there = is_locked && fstat(file, &locked) == 0 && stat(path, &named) == 0 &&
                          locked.st_ino == named.st_ino && locked.st_dev == named.st_dev;
    return is_there ? PL_OK
                    : pl_fail(error, PL_IO, "%s: another plumb is writing it; choose another --out",
                              path);
}

/* Cuts the file to its complete lines. */
static pl_status cut(const pl_store *store, pl_error *error)
{
    struct stat found;
    if (fstat(store->file, &found) != 0) {
        return pl_fail(error, PL_IO, "%s: %s", store->path, strerror(errno));
    }
    if (S_ISREG(found.st_mode) && (ftruncate(store->file, store->size) != 0 ||
                                   lseek(store->file, store->size, SEEK_SET) < 0)) {
        return pl_fail(error, PL_IO, "%s: %s", store->path, strerror(errno));
    }
    return PL_OK;
}

/* Opens the file of that name, made where it is missing, and locks it. */
static pl_status open_and_lock(pl_store *store, pl_error *error)
{
    if (store->stream != NULL) {
        fclose(store->stream);
        store->stream = NULL;
    }
    store->file = open(store->path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    store->stream = store->file < 0 ? NULL : fdopen(store->file, "r");
    return store->stream == NULL ? pl_fail(error, PL_IO, "%s: %s", store->path, strerror(errno))
                                 : lock_file(store->file, store->path, error);
}

/* Gives the file its other name, unless one that it should replace itself has it: that is the last
 * complete one. */
static pl_status set_aside(pl_store *store, pl_error *error)
{
    if (!has_content(store->path) || has_content(store->replaced)) {
        return PL_OK;
    }
    return rename(store->path, store->replaced) == 0
               ? open_and_lock(store, error)
               : pl_fail(error, PL_IO, "%s: %s", store->path, strerror(errno));
}

/* Opens the file of a store that has its paths alone. */
static pl_status open_store(pl_store *store, pl_store_mode mode, pl_error *error)
{
    pl_status status = open_and_lock(store, error);
    if (status == PL_OK && mode == PL_STORE_NEW &&
        (has_content(store->path) || has_content(store->replaced))) {
        status = pl_fail(error, PL_BAD_INPUT,
                         "%s has results: --resume keeps them and makes the runs that are missing, "
                         "--force replaces them, and --out takes another folder",
                         store->path);
    }
    if (status == PL_OK && mode == PL_STORE_REPLACE) {
        status = set_aside(store, error);
        store->replaces = status == PL_OK;
    }
    if (status == PL_OK && mode == PL_STORE_RESUME) {
        status = keep_lines(store, error);
    }
    return status == PL_OK ? cut(store, error) : status;
}

/* A folder without results may have files that a command would write. */
static pl_status check_others(const char *directory, const char *const *others, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; status == PL_OK && others != NULL && others[i] != NULL; ++i) {
        char *path = pl_heap_format("%s/%s", directory, others[i]);
        if (has_content(path)) {
            status =
                pl_fail(error, PL_BAD_INPUT,
                        "%s exists: --force replaces it, and --out takes another folder", path);
        }
        free(path);
    }
    return status;
}

pl_status pl_store_open(const char *directory, pl_store_mode mode, const char *const *others,
                        pl_store **store, pl_error *error)
{
    pl_status status = pl_make_directories(directory, error);
    if (status != PL_OK) {
        return status;
    }
    pl_store *made = pl_heap_new(1, sizeof *made);
    *made = (pl_store){.file = -1,
                       .path = pl_heap_format("%s/results.jsonl", directory),
                       .replaced = pl_heap_format("%s/results.jsonl.replaced", directory),
                       .results = json_array(),
                       .runs = json_object()};
    status = open_store(made, mode, error);
    if (status == PL_OK && mode == PL_STORE_NEW) {
        status = check_others(directory, others, error);
        if (status != PL_OK) {
            unlink(made->path);
        }
    }
    if (status != PL_OK) {
        pl_store_close(made);
        return status;
    }
    *store = made;
    return PL_OK;
}

pl_store_mode pl_store_mode_of(bool resume, bool force)
{
    return resume ? PL_STORE_RESUME : force ? PL_STORE_REPLACE : PL_STORE_NEW;
}

void pl_store_finish(pl_store *store)
{
    unlink(store->replaced);
}

void pl_store_close(pl_store *store)
{
    if (store == NULL) {
        return;
    }
    if (store->replaces && store->size == 0 && has_content(store->replaced)) {
        (void)rename(store->replaced, store->path);
    }
    if (store->stream != NULL) {
        fclose(store->stream);
    } else if (store->file >= 0) {
        close(store->file);
    }
    json_decref(store->results);
    json_decref(store->runs);
    free(store->replaced);
    free(store->path);
    free(store);
}

json_t *pl_store_results(pl_store *store)
{
    return store->results;
}

const json_t *pl_store_runs(const pl_store *store)
{
    return store->runs;
}

json_t *pl_store_find(const pl_store *store, const char *run)
{
    return json_object_get(store->runs, run);
}

pl_status pl_store_append(pl_store *store, json_t *result, pl_error *error)
{
    pl_text_buffer line = {0};
    pl_result_add_line(&line, result);
    const size_t length = line.length;
    char *text = pl_text_take(&line);
    pl_status status = write_all(store->file, text, length, store->path, error);
    free(text);
    /* A pipe or device cannot be synchronised: EINVAL, and nothing is wrong. */
    if (status == PL_OK && fdatasync(store->file) != 0 && errno != EINVAL) {
        status = pl_fail(error, PL_IO, "%s: %s", store->path, strerror(errno));
    }
    if (status != PL_OK) {
        if (ftruncate(store->file, store->size) == 0) {
            lseek(store->file, store->size, SEEK_SET);
        }
        return status;
    }
    store->size += (off_t)length;
    json_array_append(store->results, result);
    note_run(store, result);
    return PL_OK;
}
