/* Pictures of a scenario for papers, drawn by the report's page in Chromium without a window. */
#include "command.h"

#include "base/file_text.h"
#include "base/heap.h"
#include "base/number.h"
#include "report/report.h"
#include "results/store.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The page and what becomes of it. */
typedef struct drawing {
    char folder[64];     /* of the page, removed afterwards */
    pl_text_buffer url;  /* of the page, with what is to be drawn */
    pl_text_buffer name; /* of the picture, without its ending */
    char *document;      /* the page as Chromium has drawn it */
} drawing;

static bool is_svg(const char *format)
{
    return strcmp(format, "svg") == 0;
}

/* Splits "NAME:t=SECONDS", and finds the case. */
static pl_status find_case(const pl_result_table *results, const char *what, int *index,
                           double *time, pl_error *error)
{
    const char *colon = strstr(what, ":t=");
    const size_t length = colon == NULL ? strlen(what) : (size_t)(colon - what);
    if (colon != NULL && (!pl_parse_number(colon + 3, time) || *time < 0)) {
        return pl_fail(error, PL_BAD_INPUT, "--figure: expected a time in seconds, found \"%.40s\"",
                       colon + 3);
    }
    for (int pass = 0; pass < 2; ++pass) {
        for (*index = 0; *index < results->case_count; ++*index) {
            const pl_result_case *test_case = &results->cases[*index];
            const char *name = pass == 0 ? test_case->name : test_case->row->scenario;
            if (strlen(name) == length && strncmp(name, what, length) == 0) {
                return PL_OK;
            }
        }
    }
    return pl_fail(error, PL_BAD_INPUT, "--figure: the results have no scenario \"%.*s\"",
                   (int)length, what);
}

/* Runs Chromium on the page with one more option and the size of its window; its standard output goes
 * to the file `drawn` of the folder. */
static pl_status run_chromium(const drawing *d, const char *option, const char *window,
                              pl_error *error)
{
    const char *program = getenv("CHROMIUM");
    program = program != NULL && program[0] != '\0' ? program : "chromium";
    char output[96], size[64];
    snprintf(output, sizeof output, "%s/drawn", d->folder);
    snprintf(size, sizeof size, "--window-size=%s", window);
    const char *const argv[] = {program,
                                "--headless=new",
                                "--use-angle=swiftshader",
                                "--enable-unsafe-swiftshader",
                                "--hide-scrollbars",
                                "--no-pdf-header-footer",
                                "--no-first-run",
                                "--virtual-time-budget=30000",
                                geteuid() == 0 ? "--no-sandbox" : "--disable-extensions",
                                size,
                                option,
                                d->url.data,
                                NULL};
    const int code = pl_run_program(argv, output);
    if (code >= 0) {
        return code == 0 ? PL_OK : pl_fail(error, PL_IO, "%.100s failed to draw the page", program);
    }
    return errno == ENOENT
               ? pl_fail(error, PL_IO,
                         "--figure needs Chromium, and there is no program \"%.100s\": install the "
                         "Debian package chromium, or set CHROMIUM",
                         program)
               : pl_fail(error, PL_IO, "%.100s cannot be started: %s", program, strerror(errno));
}

/* Writes the page into a folder of its own, and lets Chromium draw it. */
static pl_status draw(const pl_report_def *def, drawing *d, int index, double time,
                      const char *format, pl_error *error)
{
    static const pl_file_kind kind = {.noun = "page", .most_bytes = 512u << 20};
    char output[96];
    size_t length = 0;
    pl_report_def own = *def;
    snprintf(d->folder, sizeof d->folder, "/tmp/plumb-figure-XXXXXX");
    if (mkdtemp(d->folder) == NULL) {
        d->folder[0] = '\0';
        return pl_fail(error, PL_IO, "/tmp cannot be written: %s", strerror(errno));
    }
    own.directory = d->folder;
    own.only = "index.html";
    snprintf(output, sizeof output, "%s/drawn", d->folder);
    pl_text_format(&d->url, "file://%s/index.html#figure=%d;format=%s", d->folder, index,
                   is_svg(format) ? "svg" : "png");
    if (time >= 0) {
        pl_text_format(&d->url, ";t=%.17g", time);
    }
    pl_status status = pl_report_write(&own, error);
    if (status == PL_OK) {
        status = run_chromium(d, "--dump-dom", "1400,900", error);
    }
    return status == PL_OK ? pl_file_read(&kind, output, &d->document, &length, error) : status;
}

/* The picture as it stands in the drawn page. */
static pl_status write_svg(const drawing *d, const char *path, pl_error *error)
{
    const char *begin = strstr(d->document, "id=\"figure\"");
    const char *end = strstr(d->document, "</svg></main>");
    while (begin != NULL && begin > d->document && *begin != '<') {
        --begin;
    }
    return begin == NULL || end == NULL
               ? pl_fail(error, PL_BAD_INPUT, "--figure: nothing could be drawn of this scenario")
               : pl_write_text(path, begin, (size_t)(end - begin) + strlen("</svg>"), error);
}

/* Draws the page once more, in the size of the picture, as PNG or PDF: into the folder, from which the
 * whole file goes to its path. */
static pl_status write_print(const drawing *d, const char *format, const char *path,
                             pl_error *error)
{
    int width = 0, height = 0;
    const char *size = strstr(d->document, "data-figure=\"");
    static const pl_file_kind kind = {.noun = "picture", .most_bytes = 512u << 20};
    char option[128], window[64], drawn[96], *text = NULL;
    size_t length = 0;
    if (size == NULL || sscanf(size, "data-figure=\"%dx%d", &width, &height) != 2 || width == 0) {
        return pl_fail(error, PL_BAD_INPUT, "--figure: nothing could be drawn of this scenario");
    }
    snprintf(window, sizeof window, "%d,%d", width, height);
    const bool is_png = strcmp(format, "png") == 0;
    snprintf(drawn, sizeof drawn, "%s/picture.%s", d->folder, format);
    snprintf(option, sizeof option, "--%s=%s", is_png ? "screenshot" : "print-to-pdf", drawn);
    pl_status status = run_chromium(d, option, window, error);
    if (status == PL_OK) {
        status = pl_file_read(&kind, drawn, &text, &length, error);
    }
    if (status == PL_OK) {
        status = pl_write_text(path, text, length, error);
    }
    free(text);
    return status;
}

static void clean(drawing *d)
{
    static const char *const names[] = {"index.html", "drawn", "picture.png", "picture.pdf"};
    for (size_t i = 0; i < sizeof names / sizeof names[0] && d->folder[0] != '\0'; ++i) {
        char path[96];
        snprintf(path, sizeof path, "%s/%s", d->folder, names[i]);
        unlink(path);
    }
    if (d->folder[0] != '\0') {
        rmdir(d->folder);
    }
    free(d->document);
    pl_text_free(&d->url);
    pl_text_free(&d->name);
}

pl_status pl_figure_write(const pl_report_def *def, const char *what, const char *format,
                          bool force, char **path, pl_error *error)
{
    drawing d = {.folder = ""};
    int index = 0;
    double time = -1;
    *path = NULL;
    pl_status status = find_case(def->results, what, &index, &time, error);
    /* A name that is safe as that of a file: letters, digits, and '-' for all else. */
    for (const char *c = what; status == PL_OK && *c != '\0'; ++c) {
        const bool plain = strchr("/:= \t\n\"'\\", *c) == NULL;
        pl_text_format(&d.name, "%c", plain ? *c : '-');
    }
    if (status == PL_OK) {
        *path = pl_heap_format("%s/%s.%s", def->directory, d.name.data, format);
        status = pl_output_check(*path, force, error);
    }
    if (status == PL_OK) {
        status = draw(def, &d, index, time, format, error);
    }
    if (status == PL_OK) {
        status =
            is_svg(format) ? write_svg(&d, *path, error) : write_print(&d, format, *path, error);
    }
    clean(&d);
    return status;
}
