/* The laws of results: results are read back as they were written, hashes of different runs differ,
 * and an interrupted file is continued after its last complete line. */
#include "check.h"
#include "plumb_process.h"
#include "results/result.h"
#include "results/store.h"
#include "runner/plan.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static const pl_param params[] = {{"n", 3, 1, 100, true, "1", "cubes"},
                                  {"dt", 0.01, 1e-6, 1, false, "s", "step"}};
static const pl_scenario scenario = {.name = "tower", .params = params, .param_count = 2};
static const pl_engine_profile profiles[] = {{.name = "fast"}, {.name = "exact"}};
static const pl_engine_option options[] = {
    {.name = "iterations", .value = 10, .min = 1, .max = 100, .integer = true},
    {.name = "erp", .value = 0.2, .max = 1}};
static const double defaults[] = {10, 0.2, 10, 0.2}; /* of both profiles */
static const pl_engine_info engine = {.name = "some",
                                      .version = "1.2",
                                      .profiles = profiles,
                                      .profile_count = 2,
                                      .options = options,
                                      .option_count = 2,
                                      .defaults = defaults};
/* A run with what its pointers point to. */
typedef struct some_run {
    pl_plan plan;
    pl_case test_case;
    pl_configuration configuration;
    int repeat;
} some_run;

static some_run make_run(void)
{
    static char name[] = "tower";
    return (some_run){.plan = {.seed = 7},
                      .test_case = {.name = name,
                                    .descriptor = &scenario,
                                    .params = {25, 0.01},
                                    .scene = {.dt = 0.01, .duration = 5, .primary_error = "drift"},
                                    .scene_hash = "0123456789abcdef"},
                      .configuration = {.choice = {.engine = &engine, .values = {10, 0.2}},
                                        .label = "some:fast"}};
}

static json_t *identity_of(const some_run *run)
{
    const pl_planned_run planned = {&run->test_case, &run->configuration, run->repeat};
    json_t *identity = pl_planned_run_identity(&run->plan, &planned);
    assert_non_null(identity);
    return identity;
}

static void hash_of(const some_run *run, char hash[17])
{
    json_t *identity = identity_of(run);
    snprintf(hash, 17, "%s", result_text(identity, "run"));
    assert_int_equal(strlen(hash), 16);
    json_decref(identity);
}

static void test_runs_that_differ_have_different_hashes(void **state)
{
    (void)state;
    static char other[] = "wall";
    some_run runs[11];
    char hashes[11][17];
    for (int i = 0; i < 11; ++i) {
        runs[i] = make_run();
    }
    runs[1].test_case.name = other;
    runs[2].test_case.params[0] = 26;
    runs[3].test_case.scene_hash[15] = 'e';
    runs[4].configuration.choice.profile = 1;
    runs[5].configuration.choice.values[1] = 0.3;
    runs[6].plan.seed = 8;
    runs[7].repeat = 1;
    runs[8].test_case.scene.dt = 0.02;
    runs[9].test_case.variation.change = "n one larger";
    runs[10].test_case.variation.change = "n one smaller";
    for (int i = 0; i < 11; ++i) {
        hash_of(&runs[i], hashes[i]);
        for (int k = 0; k < i; ++k) {
            assert_string_not_equal(hashes[i], hashes[k]);
        }
    }
    char again[17];
    hash_of(&runs[0], again);
    assert_string_equal(again, hashes[0]);
}

static void test_identity_holds_every_parameter_and_option(void **state)
{
    (void)state;
    const some_run run = make_run();
    json_t *identity = identity_of(&run);
    char *line = pl_result_to_line(identity);
    assert_contains(line, "\"params\":{\"dt\":0.01,\"n\":25}");
    assert_contains(line, "\"settings\":{\"dt\":0.01,\"duration\":5.0,\"erp\":0.2");
    assert_contains(line, "\"iterations\":10");
    assert_contains(line, "\"profile\":\"fast\"");
    assert_contains(line, "\"seed\":7");
    free(line);
    json_decref(identity);
}

static void test_shipped_is_the_first_profile_with_defaults(void **state)
{
    (void)state;
    some_run runs[] = {make_run(), make_run(), make_run()};
    runs[1].configuration.choice.profile = 1;
    runs[2].configuration.choice.values[1] = 0.3;
    for (int i = 0; i < 3; ++i) {
        json_t *identity = identity_of(&runs[i]);
        const json_t *shipped = json_object_get(identity, "as_shipped");
        assert_true(i == 0 ? json_is_true(shipped) : json_is_false(shipped));
        json_decref(identity);
    }
}

static void test_numbers_survive_the_line_bit_for_bit(void **state)
{
    (void)state;
    check_random random = {.state = 1};
    for (int i = 0; i < 2000; ++i) {
        int exponent = (int)check_uniform(&random, -300, 300);
        double value = ldexp(check_uniform(&random, -1, 1), exponent);
        json_t *array = json_pack("[f]", value);
        char *line = pl_result_to_line(array);
        json_t *read = json_loads(line, 0, NULL);
        double back = json_number_value(json_array_get(read, 0));
        assert_memory_equal(&back, &value, sizeof value);
        json_decref(read);
        json_decref(array);
        free(line);
    }
}

static pl_run_result some_finding(const pl_body_state *bodies)
{
    pl_run_result finding = {.outcome = PL_OUTCOME_COLLAPSED,
                             .reason = "box fell",
                             .steps_asked = 300,
                             .steps_done = 300,
                             .body_count = 1,
                             .bodies = bodies};
    finding.metrics.item[PL_METRIC_DRIFT] = (pl_metric){.state = PL_METRIC_VALUE, .value = 0.25};
    finding.metrics.item[PL_METRIC_CREEP] = (pl_metric){.state = PL_METRIC_VALUE, .value = NAN};
    finding.metrics.item[PL_METRIC_SETTLE_TIME] =
        (pl_metric){.state = PL_METRIC_FAILED, .reason = "it never settled"};
    finding.metrics.item[PL_METRIC_STATE_HASH] =
        (pl_metric){.state = PL_METRIC_TEXT, .text = "00ff"};
    finding.metrics.item[PL_METRIC_TIME_PER_STEP] = (pl_metric){.state = PL_METRIC_VALUE,
                                                                .value = 1e-5,
                                                                .has_percentiles = true,
                                                                .p50 = 1,
                                                                .p95 = 2,
                                                                .p99 = 3,
                                                                .worst_step = 4};
    return finding;
}

static void test_metrics_are_absent_null_with_reason_or_values(void **state)
{
    (void)state;
    const pl_body_state body = {.position = {1, 2, 3}, .orientation = {1, 0, 0, 0}};
    pl_run_result finding = some_finding(&body);
    json_t *object = pl_run_result_to_json(&finding);
    assert_string_equal(result_text(object, "outcome"), "collapsed");
    assert_string_equal(result_text(object, "reason"), "box fell");
    const json_t *metrics = json_object_get(object, "metrics");
    assert_int_equal(json_object_size(metrics), 5);
    assert_null(json_object_get(metrics, "penetration_max"));
    const json_t *drift = json_object_get(metrics, "drift");
    assert_close(json_number_value(json_object_get(drift, "value")), 0.25, 0, 0);
    assert_string_equal(result_text(drift, "unit"), "m");
    assert_string_equal(result_text(drift, "direction"), "lower");
    const json_t *creep = json_object_get(metrics, "creep");
    assert_true(json_is_null(json_object_get(creep, "value")));
    assert_contains(result_text(creep, "reason"), "finite");
    const json_t *settle = json_object_get(metrics, "settle_time");
    assert_true(json_is_null(json_object_get(settle, "value")));
    assert_string_equal(result_text(settle, "reason"), "it never settled");
    assert_string_equal(result_text(json_object_get(metrics, "state_hash"), "value"), "00ff");
    const json_t *time = json_object_get(metrics, "time_per_step");
    assert_int_equal(json_integer_value(json_object_get(time, "worst_step")), 4);
    assert_int_equal(json_integer_value(json_object_get(object, "final_poses")), 1);
    json_decref(object);
}

static void test_a_run_without_a_frame_has_null_poses(void **state)
{
    (void)state;
    pl_run_result finding = some_finding(NULL);
    finding.reason[0] = '\0';
    json_t *object = pl_run_result_to_json(&finding);
    assert_true(json_is_null(json_object_get(object, "final_poses")));
    assert_true(json_is_null(json_object_get(object, "reason")));
    json_decref(object);
}

static void test_any_bytes_become_valid_text(void **state)
{
    (void)state;
    const char bytes[] = "caf\xc3\xa9 \xff\x01\0 end";
    json_t *text = pl_json_bytes(bytes, sizeof bytes - 1);
    assert_string_equal(json_string_value(text), "caf?? ??? end");
    json_decref(text);
    text = pl_json_bytes("caf\xc3\xa9\n", 6);
    assert_string_equal(json_string_value(text), "caf\xc3\xa9\n");
    json_decref(text);
    text = pl_json_bytes("", 0);
    assert_string_equal(json_string_value(text), "");
    json_decref(text);
}

static json_t *row(const char *run)
{
    return json_pack("{s:s, s:s}", "schema", "plumb.result/1", "run", run);
}

/* A directory with a results.jsonl of the rows a and b. */
static char *directory_with_two(void)
{
    char *directory = make_directory();
    pl_store *store = NULL;
    pl_error error;
    assert_int_equal(pl_store_open(directory, PL_STORE_NEW, NULL, &store, &error), PL_OK);
    for (int i = 0; i < 2; ++i) {
        json_t *result = row(i == 0 ? "a" : "b");
        assert_int_equal(pl_store_append(store, result, &error), PL_OK);
        json_decref(result);
    }
    pl_store_close(store);
    return directory;
}

static void test_resume_keeps_complete_lines_only(void **state)
{
    (void)state;
    char *directory = directory_with_two();
    char *path = path_in(directory, "results.jsonl");
    char *whole = read_text(path);
    size_t first = strcspn(whole, "\n") + 1;
    /* The file is cut at every byte, as a kill may leave it. */
    for (size_t length = 0; length <= strlen(whole); ++length) {
        char *part = strndup(whole, length);
        write_text(path, part);
        pl_store *store = NULL;
        pl_error error = {.message = ""};
        assert_int_equal(pl_store_open(directory, PL_STORE_RESUME, NULL, &store, &error), PL_OK);
        assert_int_equal(pl_store_find(store, "a") != NULL, length >= first);
        assert_int_equal(pl_store_find(store, "b") != NULL, length == strlen(whole));
        json_t *result = row("c");
        assert_int_equal(pl_store_append(store, result, &error), PL_OK);
        json_decref(result);
        size_t rows = json_array_size(pl_store_results(store));
        pl_store_close(store);
        json_t *read = NULL;
        long long end = 0;
        assert_int_equal(pl_results_read(path, &read, &end, &error), PL_OK);
        assert_int_equal(json_array_size(read), rows);
        json_decref(read);
        free(part);
    }
    free(whole);
    free(path);
    remove_directory(directory);
}

static void check_text(const char *path, const char *expected)
{
    char *text = read_text(path);
    assert_string_equal(text, expected);
    free(text);
}

static void test_without_resume_or_force_results_are_refused(void **state)
{
    (void)state;
    char *directory = directory_with_two();
    char *path = path_in(directory, "results.jsonl");
    char *before = read_text(path);
    pl_store *store = NULL;
    pl_error error = {.message = ""};
    assert_int_equal(pl_store_open(directory, PL_STORE_NEW, NULL, &store, &error), PL_BAD_INPUT);
    assert_null(store);
    assert_contains(error.message, path);
    assert_contains(error.message, "--resume");
    assert_contains(error.message, "--force");
    check_text(path, before);
    /* A file that such a folder may have in place of results. */
    static const char *const others[] = {"index.html", NULL};
    char *page = path_in(directory, "index.html");
    write_text(page, "mine");
    write_text(path, "");
    assert_int_equal(pl_store_open(directory, PL_STORE_NEW, others, &store, &error), PL_BAD_INPUT);
    assert_contains(error.message, "index.html exists");
    check_text(page, "mine");
    free(page);
    free(before);
    free(path);
    remove_directory(directory);
}

/* At every moment the old results, or complete new ones, are there. */
static void test_replaced_results_stay_until_the_end(void **state)
{
    (void)state;
    char *directory = directory_with_two();
    char *path = path_in(directory, "results.jsonl");
    char *replaced = path_in(directory, "results.jsonl.replaced");
    char *before = read_text(path);
    for (int round = 0; round < 3; ++round) {
        pl_store *store = NULL;
        pl_error error = {.message = ""};
        assert_int_equal(pl_store_open(directory, PL_STORE_REPLACE, NULL, &store, &error), PL_OK);
        assert_null(pl_store_find(store, "a"));
        check_text(replaced, before);
        if (round > 0) { /* the second round ends as a killed process does */
            json_t *result = row("c");
            assert_int_equal(pl_store_append(store, result, &error), PL_OK);
            json_decref(result);
            check_text(replaced, before);
        }
        if (round == 2) {
            pl_store_finish(store);
        }
        pl_store_close(store);
        assert_int_equal(access(replaced, F_OK) == 0, round == 1);
        if (round == 0) { /* nothing came in their place */
            check_text(path, before);
        }
    }
    json_t *read = NULL;
    assert_int_equal(pl_results_read(path, &read, NULL, NULL), PL_OK);
    assert_int_equal(json_array_size(read), 1);
    json_decref(read);
    free(before);
    free(replaced);
    free(path);
    remove_directory(directory);
}

static void check_bad_line(const char *text, const char *where)
{
    char *directory = make_directory();
    char *path = path_in(directory, "results.jsonl");
    write_text(path, text);
    pl_store *store = NULL;
    pl_error error = {.message = ""};
    assert_int_equal(pl_store_open(directory, PL_STORE_RESUME, NULL, &store, &error), PL_BAD_INPUT);
    assert_null(store);
    assert_contains(error.message, path);
    assert_contains(error.message, where);
    char *after = read_text(path);
    assert_string_equal(after, text);
    free(after);
    free(path);
    remove_directory(directory);
}

static void test_invalid_complete_line_is_an_error_without_changes(void **state)
{
    (void)state;
    const char good[] = "{\"schema\":\"plumb.result/1\",\"run\":\"a\"}\n";
    char text[256];
    const char *const bad[] = {"{\"schema\":\"plumb.res\n",
                               "\n",
                               "7\n",
                               "{\"run\":\"a\"}\n",
                               "{\"schema\":\"plumb.result/1\"}\n",
                               "{\"schema\":\"plumb.result/2\",\"run\":\"a\"}\n"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        snprintf(text, sizeof text, "%s%s%s", good, bad[i], good);
        check_bad_line(text, "results.jsonl:2:");
    }
    snprintf(text, sizeof text, "%s", bad[0]);
    check_bad_line(text, "results.jsonl:1:");
}

static void test_one_process_at_a_time_writes_a_file(void **state)
{
    (void)state;
    char *directory = directory_with_two();
    pl_store *store = NULL;
    assert_int_equal(pl_store_open(directory, PL_STORE_RESUME, NULL, &store, NULL), PL_OK);
    pid_t pid = fork();
    if (pid == 0) {
        pl_store *second = NULL;
        pl_error error = {.message = ""};
        bool refused = true;
        for (int mode = PL_STORE_NEW; mode <= PL_STORE_REPLACE; ++mode) {
            refused =
                refused &&
                pl_store_open(directory, (pl_store_mode)mode, NULL, &second, &error) == PL_IO &&
                strstr(error.message, "another plumb") != NULL;
        }
        _exit(refused ? 0 : 1);
    }
    int ended = 0;
    assert_int_equal(waitpid(pid, &ended, 0), pid);
    assert_int_equal(ended, 0);
    assert_non_null(pl_store_find(store, "b"));
    /* And none reads what another has not finished: its lines would be cut off afterwards. */
    pid = fork();
    if (pid == 0) {
        char *path = path_in(directory, "results.jsonl");
        write_text(path, "{\"unfinished\n");
        pl_store *second = NULL;
        _exit(pl_store_open(directory, PL_STORE_RESUME, NULL, &second, NULL) == PL_IO ? 0 : 1);
    }
    assert_int_equal(waitpid(pid, &ended, 0), pid);
    assert_int_equal(ended, 0);
    pl_store_close(store);
    remove_directory(directory);
}

static void test_a_full_disk_is_an_error(void **state)
{
    (void)state;
    char *directory = make_directory();
    char *path = path_in(directory, "results.jsonl");
    assert_int_equal(symlink("/dev/full", path), 0);
    pl_store *store = NULL;
    pl_error error = {.message = ""};
    assert_int_equal(pl_store_open(directory, PL_STORE_NEW, NULL, &store, &error), PL_OK);
    json_t *result = row("a");
    assert_int_equal(pl_store_append(store, result, &error), PL_IO);
    assert_contains(error.message, "No space left");
    assert_int_equal(json_array_size(pl_store_results(store)), 0);
    assert_int_equal(pl_results_write_json("/dev/full", result, &error), PL_IO);
    json_decref(result);
    pl_store_close(store);
    free(path);
    remove_directory(directory);
}

/* A limit of the file's size lets a write begin and not end, as a disk does that fills up. */
static void test_failed_write_leaves_the_earlier_lines(void **state)
{
    (void)state;
    char *directory = directory_with_two();
    char *path = path_in(directory, "results.jsonl");
    pl_store *store = NULL;
    pl_error error = {.message = ""};
    assert_int_equal(pl_store_open(directory, PL_STORE_RESUME, NULL, &store, &error), PL_OK);
    json_t *result = row("c");
    assert_int_equal(pl_store_append(store, result, &error), PL_OK);
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    char *after = read_text(path);
    const struct rlimit tight = {strlen(after) + 10, limit.rlim_max};
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &tight), 0);
    assert_int_equal(pl_store_append(store, result, &error), PL_IO);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    signal(SIGXFSZ, SIG_DFL);
    assert_contains(error.message, path);
    char *left = read_text(path);
    assert_string_equal(left, after);
    /* The run then resumes where it was. */
    assert_int_equal(pl_store_append(store, result, &error), PL_OK);
    json_decref(result);
    pl_store_close(store);
    json_t *read = NULL;
    assert_int_equal(pl_results_read(path, &read, NULL, &error), PL_OK);
    assert_int_equal(json_array_size(read), 4);
    json_decref(read);
    free(left);
    free(after);
    free(path);
    remove_directory(directory);
}

static void test_directories_are_created_unless_a_file_blocks(void **state)
{
    (void)state;
    char *directory = make_directory();
    char *deep = path_in(directory, "a/b//c/");
    char *blocked = path_in(directory, "a/b/c/results.jsonl/d");
    pl_store *store = NULL;
    pl_error error = {.message = ""};
    assert_int_equal(pl_store_open(deep, PL_STORE_NEW, NULL, &store, &error), PL_OK);
    pl_store_close(store);
    assert_int_equal(pl_store_open(blocked, PL_STORE_NEW, NULL, &store, &error), PL_IO);
    assert_contains(error.message, "results.jsonl");
    free(deep);
    free(blocked);
    remove_directory(directory);
}

static void test_json_is_written_whole_or_not_at_all(void **state)
{
    (void)state;
    char *directory = make_directory();
    char *path = path_in(directory, "all.json");
    char *nowhere = path_in(directory, "none/all.json");
    json_t *result = row("a");
    pl_error error = {.message = ""};
    write_text(path, "old");
    assert_int_equal(pl_results_write_json(path, result, &error), PL_OK);
    json_t *read = json_load_file(path, 0, NULL);
    assert_true(json_equal(read, result));
    json_decref(read);
    assert_int_equal(pl_results_write_json(nowhere, result, &error), PL_IO);
    assert_contains(error.message, nowhere);
    json_decref(result);
    free(path);
    free(nowhere);
    remove_directory(directory);
}

static void test_provenance_names_machine_build_and_call(void **state)
{
    (void)state;
    char *argv[] = {(char[]){"plumb"}, (char[]){"run"}, NULL};
    json_t *provenance = pl_provenance(2, argv);
    const json_t *host = json_object_get(provenance, "host");
    assert_true(result_text(host, "cpu")[0] != '\0');
    assert_contains(result_text(host, "os"), "Linux");
    assert_contains(result_text(host, "flags"), "-ffp-contract=off");
    assert_true(result_text(host, "compiler")[0] != '\0');
    assert_int_equal(json_array_size(json_object_get(provenance, "command")), 2);
    json_decref(provenance);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_runs_that_differ_have_different_hashes),
        cmocka_unit_test(test_identity_holds_every_parameter_and_option),
        cmocka_unit_test(test_shipped_is_the_first_profile_with_defaults),
        cmocka_unit_test(test_numbers_survive_the_line_bit_for_bit),
        cmocka_unit_test(test_metrics_are_absent_null_with_reason_or_values),
        cmocka_unit_test(test_a_run_without_a_frame_has_null_poses),
        cmocka_unit_test(test_any_bytes_become_valid_text),
        cmocka_unit_test(test_resume_keeps_complete_lines_only),
        cmocka_unit_test(test_without_resume_or_force_results_are_refused),
        cmocka_unit_test(test_replaced_results_stay_until_the_end),
        cmocka_unit_test(test_invalid_complete_line_is_an_error_without_changes),
        cmocka_unit_test(test_one_process_at_a_time_writes_a_file),
        cmocka_unit_test(test_a_full_disk_is_an_error),
        cmocka_unit_test(test_failed_write_leaves_the_earlier_lines),
        cmocka_unit_test(test_directories_are_created_unless_a_file_blocks),
        cmocka_unit_test(test_json_is_written_whole_or_not_at_all),
        cmocka_unit_test(test_provenance_names_machine_build_and_call),
    };
    return cmocka_run_group_tests_name("results", tests, NULL, NULL);
}
