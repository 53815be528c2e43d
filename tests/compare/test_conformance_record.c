/* The laws of conformance records: a record is read back as it was written, it belongs to one binary
 * and one profile, and anything that is no whole record counts as none. */
#include "check.h"
#include "results/result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[] = "/tmp/plumb-records-XXXXXX";

static pl_engine_info some_engine(void)
{
    return (pl_engine_info){.name = "some", .version = "1.2", .binary = "0123456789abcdef"};
}

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) == NULL || setenv("PLUMB_CACHE", folder, 1) != 0;
}

static int remove_folder(void **state)
{
    char command[128];
    (void)state;
    snprintf(command, sizeof command, "chmod -R u+w %s && rm -r %s", folder, folder);
    return system(command);
}

static void path_of(char path[256])
{
    snprintf(path, 256, "%s/conformance-0123456789abcdef-some-fast.json", folder);
}

static void write_record(const pl_engine_info *engine, const char *profile, int failed)
{
    pl_error error = {.message = ""};
    assert_int_equal(pl_conformance_record_write(engine, profile, 31, failed, 2, &error), PL_OK);
}

static bool is_known(const pl_engine_info *engine, const char *profile)
{
    json_t *found = pl_conformance_find(engine, profile);
    const bool known = json_is_object(found);
    assert_true(known || json_is_null(found));
    json_decref(found);
    return known;
}

/* What is found of the profile "fast". */
static void check_found(const pl_engine_info *engine, const char *outcome, int failed)
{
    json_t *found = pl_conformance_find(engine, "fast");
    assert_string_equal(json_string_value(json_object_get(found, "outcome")), outcome);
    assert_int_equal(json_integer_value(json_object_get(found, "checks")), 31);
    assert_int_equal(json_integer_value(json_object_get(found, "failed")), failed);
    assert_non_null(json_string_value(json_object_get(found, "plumb")));
    json_decref(found);
}

static void a_record_reads_back_as_written(void **state)
{
    (void)state;
    const pl_engine_info engine = some_engine();
    write_record(&engine, "fast", 0);
    check_found(&engine, "passed", 0);
    write_record(&engine, "fast", 3);
    check_found(&engine, "failed", 3);
}

static void other_binaries_versions_profiles_have_none(void **state)
{
    (void)state;
    const pl_engine_info engine = some_engine();
    pl_engine_info rebuilt = engine, renamed = engine, newer = engine, unloaded = engine;
    write_record(&engine, "fast", 0);
    snprintf(rebuilt.binary, sizeof rebuilt.binary, "0123456789abcdee");
    renamed.name = "other";
    newer.version = "1.3";
    unloaded.binary[0] = '\0';
    assert_false(is_known(&rebuilt, "fast"));
    assert_false(is_known(&renamed, "fast"));
    assert_false(is_known(&newer, "fast"));
    assert_false(is_known(&engine, "exact"));
    write_record(&unloaded, "fast", 0);
    assert_false(is_known(&unloaded, "fast"));
    assert_true(is_known(&engine, "fast"));
}

/* Names that differ only in characters that a path may not have share a file, and no record. */
static void profiles_that_share_a_file_differ(void **state)
{
    (void)state;
    const pl_engine_info engine = some_engine();
    write_record(&engine, "../a/b", 0);
    assert_true(is_known(&engine, "../a/b"));
    assert_false(is_known(&engine, "../a b"));
}

static void replace_text(const char *path, const char *from, const char *to)
{
    char text[4096] = "", *at;
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    const size_t length = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    text[length] = '\0';
    at = strstr(text, from);
    assert_non_null(at);
    file = fopen(path, "w");
    fprintf(file, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    fclose(file);
}

static void damaged_records_count_as_none(void **state)
{
    static const char *const changes[][2] = {
        {"plumb.conformance_record/1", "plumb.conformance_record/9"},
        {"\"failed\": 0", "\"failed\": 1"},
        {"\"failed\": 0", "\"failed\": 32"},
        {"\"checks\": 31", "\"checks\": 0"},
        {"\"checks\": 31", "\"checks\": \"31\""},
        {"\"engine\": \"some\"", "\"engine\": \"else\""},
        {"0123456789abcdef", "0123456789abcde0"},
        {"}", ""},
    };
    char path[256];
    (void)state;
    const pl_engine_info engine = some_engine();
    path_of(path);
    for (size_t i = 0; i < sizeof changes / sizeof changes[0]; ++i) {
        write_record(&engine, "fast", 0);
        assert_true(is_known(&engine, "fast"));
        replace_text(path, changes[i][0], changes[i][1]);
        assert_false(is_known(&engine, "fast"));
    }
    assert_int_equal(truncate(path, 0), 0);
    assert_false(is_known(&engine, "fast"));
}

static void the_folder_follows_the_environment(void **state)
{
    char under[128], none[128];
    (void)state;
    const pl_engine_info engine = some_engine();
    snprintf(under, sizeof under, "%s/home", folder);
    snprintf(none, sizeof none, "%s/home/.cache/plumb", folder);
    unsetenv("PLUMB_CACHE");
    unsetenv("XDG_CACHE_HOME");
    setenv("HOME", under, 1);
    write_record(&engine, "fast", 0);
    assert_int_equal(access(none, R_OK), 0);
    assert_true(is_known(&engine, "fast"));
    setenv("XDG_CACHE_HOME", folder, 1);
    assert_false(is_known(&engine, "fast"));
    unsetenv("XDG_CACHE_HOME");
    unsetenv("HOME");
    write_record(&engine, "fast", 0);
    assert_false(is_known(&engine, "fast"));
    setenv("PLUMB_CACHE", folder, 1);
}

static void an_unwritable_folder_is_an_error(void **state)
{
    char file[128];
    pl_error error = {.message = ""};
    (void)state;
    const pl_engine_info engine = some_engine();
    snprintf(file, sizeof file, "%s/file", folder);
    fclose(fopen(file, "w"));
    setenv("PLUMB_CACHE", file, 1);
    assert_int_equal(pl_conformance_record_write(&engine, "fast", 31, 0, 0, &error), PL_IO);
    assert_non_null(strstr(error.message, file));
    assert_false(is_known(&engine, "fast"));
    setenv("PLUMB_CACHE", folder, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_record_reads_back_as_written),
        cmocka_unit_test(other_binaries_versions_profiles_have_none),
        cmocka_unit_test(profiles_that_share_a_file_differ),
        cmocka_unit_test(damaged_records_count_as_none),
        cmocka_unit_test(the_folder_follows_the_environment),
        cmocka_unit_test(an_unwritable_folder_is_an_error),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
