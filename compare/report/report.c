/* Writes the report's files: all texts first, then all under temporary names, then the renames. */
#include "report.h"

#include "csv.h"
#include "findings.h"
#include "html.h"
#include "losses.h"
#include "markdown.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A file of the report: its text, and where it is written before it gets its name. */
typedef struct report_file {
    const char *name;
    pl_text_buffer text;
    char final[PATH_MAX], temporary[PATH_MAX];
    bool written;
} report_file;

static pl_status write_all(int descriptor, const char *data, size_t length)
{
    while (length > 0) {
        ssize_t count = write(descriptor, data, length);
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0)
            return PL_IO;
        data += count;
        length -= (size_t)count;
    }
    return PL_OK;
}

static pl_status write_temporary(report_file *file, const char *directory, pl_error *error)
{
    int length = snprintf(file->temporary, sizeof file->temporary, "%s/.%s.%ld.tmp", directory,
                          file->name, (long)getpid());
    if (length < 0 || (size_t)length >= sizeof file->temporary)
        return pl_fail(error, PL_IO, "%.200s: the path is too long", directory);
    snprintf(file->final, sizeof file->final, "%.*s/%s", (int)strlen(directory), directory,
             file->name);
    int descriptor =
        open(file->temporary, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor < 0)
        return pl_fail(error, PL_IO, "%.300s cannot be written: %s", file->final, strerror(errno));
    file->written = true;
    pl_status status = write_all(descriptor, file->text.data, file->text.length);
    if (status == PL_OK && fsync(descriptor) != 0 && errno != EINVAL && errno != EROFS)
        status = PL_IO;
    int cause = errno;
    if (close(descriptor) != 0 && status == PL_OK) {
        status = PL_IO;
        cause = errno;
    }
    if (status != PL_OK)
        return pl_fail(error, status, "%.300s cannot be written: %s", file->final, strerror(cause));
    return PL_OK;
}

static pl_status write_files(report_file *files, int count, const char *directory, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < count && status == PL_OK; i++)
        status = write_temporary(&files[i], directory, error);
    for (int i = 0; i < count && status == PL_OK; i++) {
        if (rename(files[i].temporary, files[i].final) != 0)
            status = pl_fail(error, PL_IO, "%.300s cannot be replaced: %s", files[i].final,
                             strerror(errno));
        else
            files[i].written = false;
    }
    for (int i = 0; i < count; i++)
        if (files[i].written)
            unlink(files[i].temporary);
    return status;
}

pl_status pl_report_write(const char *directory, json_t *results, pl_error *error)
{
    report_file files[] = {{.name = "results.csv"}, {.name = "summary.md"}, {.name = "index.html"}};
    enum { FILE_COUNT = sizeof files / sizeof files[0] };
    pl_result_matrix cells = {0};
    pl_losses losses = {0};
    pl_faults findings = {0};
    pl_status status = pl_result_matrix_build(results, &cells, error);
    if (status == PL_OK)
        status = pl_losses_find(&cells, &losses, error);
    if (status == PL_OK)
        status = pl_faults_find(&cells, &findings, error);
    if (status != PL_OK)
        goto cleanup;
    pl_csv_write(results, &files[0].text);
    pl_markdown_write(&cells, &losses, &findings, &files[1].text);
    pl_html_write(&cells, &losses, &findings, &files[2].text);
    for (int i = 0; i < FILE_COUNT; i++) {
        if (files[i].text.failed) {
            status = pl_fail(error, PL_NO_MEMORY, "no memory to write %s", files[i].name);
            goto cleanup;
        }
    }
    status = write_files(files, FILE_COUNT, directory, error);

cleanup:
    for (int i = 0; i < FILE_COUNT; i++)
        pl_text_free(&files[i].text);
    pl_faults_free(&findings);
    pl_losses_free(&losses);
    pl_result_matrix_free(&cells);
    return status;
}
