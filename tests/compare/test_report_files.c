/* The report's files: all of them, or what stood there. */
#include "report/report.h"

#include "check.h"
#include "report_rows.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static char *make_directory(void)
{
    char *directory = strdup("/tmp/plumb-report-XXXXXX");
    assert_non_null(mkdtemp(directory));
    return directory;
}

static char *read_file(const char *directory, const char *name)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return NULL;
    }
    char *text = calloc(1, 1 << 22);
    assert_true(fread(text, 1, (1 << 22) - 1, file) < (1 << 22) - 1);
    fclose(file);
    return text;
}

static void write_file(const char *directory, const char *name, const char *text)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static pl_status write_in(const char *directory, json_t *results, pl_error *error)
{
    pl_result_table *table = table_of(results);
    const pl_report_def def = {.directory = directory, .results = table};
    const pl_status status = pl_report_write(&def, error);
    free_table(table);
    return status;
}

static const char *const file_names[] = {"results.csv", "runs.csv", "summary.md", "index.html"};

/* Removes the directory, which fails when any other file is left in it. */
static void remove_directory(char *directory)
{
    for (int i = 0; i < 4; ++i) {
        char path[256];
        snprintf(path, sizeof path, "%s/%s", directory, file_names[i]);
        unlink(path);
    }
    assert_int_equal(rmdir(directory), 0);
    free(directory);
}

static void test_write_makes_its_files_and_nothing_else(void **state)
{
    (void)state;
    char *directory = make_directory();
    json_t *results = runs_of_every_kind();
    pl_error error = {PL_OK, ""};
    if (write_in(directory, results, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    made_report made = make_report(results);
    char *html = read_file(directory, "index.html"), *markdown = read_file(directory, "summary.md");
    char *csv = read_file(directory, "results.csv");
    assert_contains(html, made.table->configurations[0].name);
    assert_string_equal(markdown, made.markdown);
    assert_non_null(csv);
    free(html);
    free(markdown);
    free(csv);
    free_report(&made);
    remove_directory(directory);
}

static void test_full_disk_leaves_the_old_files(void **state)
{
    (void)state;
    char *directory = make_directory();
    for (int i = 0; i < 4; ++i) {
        write_file(directory, file_names[i], "old");
    }
    json_t *results = runs_of_every_kind();
    struct rlimit before, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    small = (struct rlimit){.rlim_cur = 5000, .rlim_max = before.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    pl_error error = {PL_OK, ""};
    pl_status status = write_in(directory, results, &error);
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, handler);
    assert_int_equal(status, PL_IO);
    assert_contains(error.message, "cannot be written");
    for (int i = 0; i < 4; ++i) {
        char *text = read_file(directory, file_names[i]);
        assert_string_equal(text, "old");
        free(text);
    }
    json_decref(results);
    remove_directory(directory);
}

static void test_missing_directory_is_an_error_naming_the_file(void **state)
{
    (void)state;
    json_t *results = runs_of_every_kind();
    pl_error error = {PL_OK, ""};
    assert_int_equal(write_in("/nonexistent/report", results, &error), PL_IO);
    assert_contains(error.message, "/nonexistent/report/results.csv");
    json_decref(results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_write_makes_its_files_and_nothing_else),
        cmocka_unit_test(test_full_disk_leaves_the_old_files),
        cmocka_unit_test(test_missing_directory_is_an_error_naming_the_file),
    };
    return cmocka_run_group_tests_name("report_files", tests, NULL, NULL);
}
