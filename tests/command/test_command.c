/* The command as a user meets it: exit codes, what goes where, and what is said about mistakes. */
#include "check.h"
#include "plumb/scenario.h"
#include "plumb_process.h"
#include "results/result.h"
#include "results/store.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static plumb_output call(const workspace *f, const char *text)
{
    return wait_plumb(f->directory, start_plumb_words(f, text));
}

static void check_call(void **state, const char *text, int code, const char *out, const char *err)
{
    plumb_output output = call(*state, text);
    if (output.code != code) {
        print_error("plumb %s: exit code %d, expected %d\n%s", text, output.code, code, output.err);
    }
    assert_int_equal(output.code, code);
    assert_contains(output.out, out);
    assert_contains(output.err, err);
    free_output(&output);
}

static void test_usage_errors_exit_2_and_suggest_a_name(void **state)
{
    static const char *const cases[][2] = {
        {"", "see plumb help"},
        {"compair", "did you mean compare?"},
        {"xyzzy", "see plumb help"},
        {"help lits", "did you mean list?"},
        {"list", "scenarios, engines, metrics or suites"},
        {"list metric", "did you mean metrics?"},
        {"list metrics scenarios", "one list at a time"},
        {"list engines scenarios", "unknown engine \"scenarios\""},
        {"list engines --page -", "--page is for scenarios"},
        {"compare --sute canonical", "did you mean --suite?"},
        {"compare --frobnicate", "there is no option --frobnicate"},
        {"compare --suite canonicle", "did you mean"},
        {"compare towr", "tower"},
        {"compare tower --engine plum", "plumb"},
        {"compare @ --engine %:god", "good"},
        {"compare tower --set m=3 --engine %", "no chosen scenario has the parameter m"},
        {"compare @ --set n=3 --engine %", "no chosen scenario has the parameter n"},
        {"compare tower --set n --engine %", "--set takes NAME=VALUE"},
        {"compare tower --set n=lots --engine %", "n"},
        {"compare @ --dt 0 --engine %", "--dt takes seconds"},
        {"compare @ --dt nan --engine %", "--dt takes seconds"},
        {"compare @ --duration=-1 --engine %", "--duration takes seconds"},
        {"compare @ --repeat 0 --engine %", "--repeat takes an integer"},
        {"compare @ --jobs 1.5 --engine %", "--jobs takes an integer"},
        {"compare @ --seed -1 --engine %", "--seed takes an integer"},
        {"compare @ --timeout 0 --engine %", "--timeout takes seconds"},
        {"compare ./none.json --engine %", "./none.json"},
        {"run @", "which engine?"},
        {"run --engine %", "which scenario?"},
        {"run @ @ --engine %", "one scenario at a time"},
        {"run @ --engine % --engine plumb", "one engine at a time"},
        {"run @ --engine % --json - --trajectory -", "would mix"},
        {"scene", "which scenario?"},
    };
    const workspace *f = *state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        check_call(state, cases[i][0], 2, "", cases[i][1]);
    }
    assert_int_not_equal(access(f->out, F_OK), 0); /* and nothing is written */
    assert_int_not_equal(access("report", F_OK), 0);
}

static void test_every_command_explains_itself(void **state)
{
    static const char *const commands[] = {"compare", "run", "list", "scene"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; ++i) {
        char text[64];
        snprintf(text, sizeof text, "%s --help", commands[i]);
        check_call(state, text, 0, "Examples:", "");
        snprintf(text, sizeof text, "help %s", commands[i]);
        check_call(state, text, 0, "Examples:", "");
        check_call(state, "help", 0, commands[i], "");
    }
    check_call(state, "--help", 0, "Exit codes:", "");
    check_call(state, "--version", 0, "plumb ", "");
    check_call(state, "version", 0, "plumb ", "");
}

static json_t *parse(const char *text)
{
    json_error_t error;
    json_t *value = json_loads(text, 0, &error);
    if (value == NULL) {
        print_error("%s in: %.200s\n", error.text, text);
    }
    assert_non_null(value);
    return value;
}

static void test_lists_are_text_or_json_with_everything(void **state)
{
    static const char *const kinds[][2] = {{"scenarios", "tower"},
                                           {"engines", "plumb"},
                                           {"metrics", "penetration_max"},
                                           {"suites", "canonical"}};
    for (int i = 0; i < 4; ++i) {
        char text[64];
        snprintf(text, sizeof text, "list %s", kinds[i][0]);
        check_call(state, text, 0, kinds[i][1], "");
        snprintf(text, sizeof text, "list --json %s", kinds[i][0]);
        plumb_output output = call(*state, text);
        json_t *list = parse(output.out);
        assert_true(json_array_size(list) > 0);
        assert_contains(output.out, kinds[i][1]);
        size_t index;
        const json_t *item;
        json_array_foreach(list, index, item)
        {
            assert_true(result_text(item, "name")[0] != '\0');
        }
        json_decref(list);
        free_output(&output);
    }
}

static void test_catalogue_page_has_every_scenario_without_network_requests(void **state)
{
    plumb_output page = call(*state, "list scenarios --page -");
    assert_int_equal(page.code, 0);
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        char name[160];
        snprintf(name, sizeof name, "\"name\":\"%s\"", scenarios[i]->name);
        assert_contains(page.out, name);
    }
    assert_contains(page.out, "default-src 'none'");
    free_output(&page);
    check_call(state, "list scenarios --page /no/such/directory/page.html", 3, "", "/no/such");
    check_call(state, "list scenarios --page /dev/full", 3, "", "No space left");
}

static void test_printed_scene_equals_the_scenario(void **state)
{
    const workspace *f = *state;
    plumb_output output = call(f, "scene tower --set n=3 --dt 1/100");
    assert_int_equal(output.code, 0);
    pl_scene scene = pl_scene_default();
    pl_error error = {.message = ""};
    assert_int_equal(pl_scene_read_text(output.out, strlen(output.out), "out", &scene, &error),
                     PL_OK);
    assert_int_equal(scene.body_count, 4);
    assert_close(scene.dt, 0.01, 0, 0);
    char printed[17];
    assert_int_equal(pl_scene_hash(&scene, printed, &error), PL_OK);
    pl_scene_free(&scene);
    free_output(&output);
    output = call(f, "run tower --set n=3 --dt 1/100 --engine plumb --json -");
    json_t *result = parse(output.out);
    assert_string_equal(result_text(result, "scene_hash"), printed);
    json_decref(result);
    free_output(&output);
}

static void test_run_prints_metrics_or_one_object(void **state)
{
    check_call(state, "run @ --engine %", 0, "on faulty:good: ok, 20 of 20 steps", "");
    check_call(state, "run @ --engine %", 0, "time_per_step", "");
    check_call(state, "run @ --engine %:abort", 3, "SIGABRT in step 3 of 20", "");
    check_call(state, "run @ --engine=%:hang --timeout=0.2", 3, "timeout, 2 of 20 steps", "");
    plumb_output output = call(*state, "run @ --engine %:abort --json - --seed 5");
    assert_int_equal(output.code, 3);
    json_t *result = parse(output.out);
    assert_string_equal(result_text(result, "schema"), "plumb.result/1");
    assert_string_equal(result_text(result, "outcome"), "crashed");
    assert_int_equal(json_integer_value(json_object_get(result, "seed")), 5);
    assert_int_equal(json_array_size(json_object_get(result, "command")), 9);
    json_decref(result);
    free_output(&output);
}

static void test_results_hold_every_key_of_the_schema(void **state)
{
    static const char *const keys[] = {
        "schema",        "run",         "scenario",       "params",         "scene_hash",
        "primary_error", "engine",      "profile",        "engine_version", "label",
        "settings",      "seed",        "repeat",         "outcome",        "reason",
        "steps",         "metrics",     "final_poses",    "output",         "host",
        "plumb",         "command",     "started",        "engine_binary",  "substeps",
        "read_back",     "engine_spec", "conformance",    "as_shipped",     "acceptance",
        "note",          "verdict",     "verdict_reason", "engine_runtime", "threads",
        "off",           "off_count",   "scene_edition"};
    plumb_output output = call(*state, "run @ --engine % --json -");
    json_t *result = parse(output.out);
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i) {
        if (json_object_get(result, keys[i]) == NULL) {
            print_error("missing: %s\n", keys[i]);
        }
        assert_non_null(json_object_get(result, keys[i]));
    }
    assert_int_equal(json_object_size(result), sizeof keys / sizeof keys[0]);
    json_decref(result);
    free_output(&output);
}

static void test_trajectory_goes_to_file_or_standard_output(void **state)
{
    const workspace *f = *state;
    check_call(state, "run @ --engine % --trajectory #.csv", 0, "20 of 20 steps", "");
    char *path = path_in(f->directory, "report.csv");
    char *text = read_text(path);
    assert_contains(text, "time,body,");
    plumb_output output = call(f, "run @ --engine % --trajectory -");
    assert_string_equal(output.out, text);
    free_output(&output);
    free(text);
    /* One that crashes leaves the frames before it. */
    check_call(state, "run @ --engine %:segfault --trajectory #.csv --force", 3, "SIGSEGV", "");
    text = read_text(path);
    assert_contains(text, "\n0.02,\"b\"");
    assert_int_equal(text[strlen(text) - 1], '\n');
    free(text);
    free(path);
    check_call(state, "run @ --engine % --trajectory /dev/full", 3, "", "No space left");
    check_call(state, "run @ --engine % --trajectory #/none/t.csv", 3, "", "t.csv");
}

static void test_compare_separates_data_from_messages_in_all_forms(void **state)
{
    const workspace *f = *state;
    plumb_output output =
        call(f, "compare @ --engine % --engine %:nan --repeat 2 --out # --json -");
    assert_int_equal(output.code, 0);
    json_t *results = parse(output.out); /* and nothing else is on standard output */
    assert_int_equal(json_array_size(results), 4);
    /* Engines take turns in going first. */
    static const char *const labels[] = {"faulty:good", "faulty:nan", "faulty:nan", "faulty:good"};
    for (size_t i = 0; i < 4; ++i) {
        const json_t *result = json_array_get(results, i);
        assert_string_equal(result_text(result, "label"), labels[i]);
        assert_int_equal(json_integer_value(json_object_get(result, "repeat")), i / 2);
    }
    json_decref(results);
    assert_contains(output.err, "[4/4]");
    assert_null(strchr(output.err, '\033')); /* no terminal, no colours */
    free_output(&output);
    static const char *const files[] = {"results.jsonl", "results.csv", "summary.md", "index.html"};
    for (int i = 0; i < 4; ++i) {
        char *path = path_in(f->out, files[i]);
        assert_int_equal(access(path, R_OK), 0);
        free(path);
    }
    check_call(state, "compare @ --engine % --out # --json #.json --force", 0, "faulty:good",
               "report");
    char *path = path_in(f->directory, "report.json");
    json_t *written = json_load_file(path, 0, NULL);
    assert_int_equal(json_array_size(written), 1);
    json_decref(written);
    free(path);
}

static void test_jobs_side_by_side_make_the_same_runs(void **state)
{
    plumb_output output = call(
        *state,
        "compare @ --engine % --engine %:slow_print --repeat 8 --jobs 4 --out # --json - --force");
    assert_int_equal(output.code, 0);
    json_t *results = parse(output.out);
    json_t *runs = json_object();
    size_t index;
    const json_t *result;
    json_array_foreach(results, index, result)
    {
        assert_string_equal(result_text(result, "outcome"), "ok");
        json_object_set_new(runs, result_text(result, "run"), json_true());
    }
    assert_int_equal(json_object_size(runs), 16);
    json_decref(runs);
    json_decref(results);
    free_output(&output);
}

static void test_nothing_compared_exits_4(void **state)
{
    check_call(state, "compare @ --engine %:mass --out # --force", 4, "", "");
}

static void test_unwritable_output_exits_3_with_its_name(void **state)
{
    const workspace *f = *state;
    check_call(state, "compare @ --engine % --out @/x", 3, "", "scene.json");
    check_call(state, "compare @ --engine % --out # --json /dev/full --force", 3, "", "/dev/full");
    check_call(state, "compare @ --engine % --out # --json #/none/all.json --force", 3, "",
               "all.json");
    check_call(state, "run @ --engine % --json /dev/full", 3, "", "/dev/full");
    char *path = path_in(f->directory, "full");
    char *file = path_in(path, "results.jsonl");
    assert_int_equal(mkdir(path, 0777), 0);
    assert_int_equal(symlink("/dev/full", file), 0);
    char text[512];
    snprintf(text, sizeof text, "compare @ --engine %% --out %s", path);
    check_call(state, text, 3, "", "No space left on device");
    free(file);
    free(path);
}

/* The exit code of "plumb CALL REDIRECTION", given to bash. */
static int shell(const workspace *f, const char *text, const char *redirection)
{
    char *command = NULL;
    assert_true(asprintf(&command, "cd %s && exec bash -c '%s/plumb %s %s'", f->directory,
                         PLUMB_BINARY_DIR, text, redirection) > 0);
    int status = system(command);
    free(command);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void test_a_full_standard_output_exits_3(void **state)
{
    static const char *const calls[] = {"list metrics", "help", "scene tower", "version"};
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; ++i) {
        assert_int_equal(shell(*state, calls[i], ">/dev/full 2>err"), 3);
    }
}

static void test_help_to_a_full_disk_exits_3_too(void **state)
{
    const workspace *f = *state;
    static const char *const calls[] = {"run --help", "compare --usage", "help scene", "list -V"};
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; ++i) {
        assert_int_equal(shell(f, calls[i], ">/dev/full"), 3);
    }
}

static void test_a_closed_standard_stream_never_becomes_a_file(void **state)
{
    const workspace *f = *state;
    static const char *const closed[] = {">&-", "<&- >&-", "<&- >&- 2>&-"};
    for (size_t i = 0; i < sizeof closed / sizeof closed[0]; ++i) {
        char text[512];
        snprintf(text, sizeof text, "compare %s --engine %s --out %s --json - --force", f->scene,
                 FAULTY, f->out);
        assert_int_equal(shell(f, text, closed[i]), 3);
        json_t *results = NULL;
        assert_int_equal(pl_results_read(f->results, &results, NULL, NULL), PL_OK);
        json_t *own = pl_results_of_study(results, NULL);
        assert_int_equal(json_array_size(own), 1);
        json_decref(own);
        json_decref(results);
    }
    char *frames = path_in(f->directory, "frames.csv");
    char text[512];
    snprintf(text, sizeof text, "run %s --engine %s --trajectory %s", f->scene, FAULTY, frames);
    assert_int_equal(shell(f, text, "<&- 2>&- >/dev/null"), 0);
    char *csv = read_text(frames);
    assert_contains(csv, "time,body,");
    assert_contains(csv, "\n0.20000000000000001,\"b\"");
    free(csv);
    free(frames);
    assert_int_equal(shell(f, "run - --engine plumb", "<&- >/dev/null"), 3);
}

static void test_json_file_is_complete_after_a_broken_pipe(void **state)
{
    const workspace *f = *state;
    enum { SCENE_COUNT = 40 }; /* a table longer than any buffer of standard output */
    for (int i = 0; i < SCENE_COUNT; ++i) {
        char name[32];
        snprintf(name, sizeof name, "many-%d.json", i);
        char *path = path_in(f->directory, name);
        write_text(path, falling_scene);
        free(path);
    }
    int code = shell(f, "compare many-*.json --json all --out many --engine " FAULTY,
                     "2>err | true; exit ${PIPESTATUS[0]}");
    assert_int_equal(code, 128 + SIGPIPE);
    char *path = path_in(f->directory, "all");
    json_t *written = json_load_file(path, 0, NULL);
    assert_int_equal(json_array_size(written), SCENE_COUNT);
    json_decref(written);
    free(path);
}

static void test_a_time_limit_is_told_by_help(void **state)
{
    check_call(state, "compare --help", 0, "(default\n                             120)", "");
}

/* Every "--engine plumb..." of the examples is a SPEC that can be run. */
static void test_engines_in_the_examples_of_help_exist(void **state)
{
    static const char *const commands[] = {"help run", "help compare"};
    const char key[] = "--engine plumb";
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; ++i) {
        plumb_output output = call(*state, commands[i]);
        int found = 0;
        for (const char *at = strstr(output.out, key); at != NULL; at = strstr(at + 1, key)) {
            char text[256];
            snprintf(text, sizeof text, "run @ %.*s", (int)strcspn(at + 9, " \n") + 9, at);
            check_call(state, text, 0, "20 of 20 steps", "");
            ++found;
        }
        assert_true(found > 0);
        free_output(&output);
    }
}

static void test_dt_and_duration_reach_the_scene(void **state)
{
    plumb_output output = call(*state, "run @ --dt 1/50 --duration 0.4 --engine % --json -");
    json_t *result = parse(output.out);
    const json_t *settings = json_object_get(result, "settings");
    assert_close(json_number_value(json_object_get(settings, "dt")), 0.02, 0, 0);
    assert_close(json_number_value(json_object_get(settings, "duration")), 0.4, 0, 0);
    assert_int_equal(json_integer_value(json_object_get(json_object_get(result, "steps"), "done")),
                     20);
    json_decref(result);
    free_output(&output);
    output = call(*state, "run tower --set n=2 --dt 1/50 --duration 0.4 --engine plumb --json -");
    result = parse(output.out);
    const json_t *params = json_object_get(result, "params");
    assert_close(json_number_value(json_object_get(params, "dt")), 0.02, 0, 0);
    assert_close(json_number_value(json_object_get(params, "duration")), 0.4, 0, 0);
    assert_int_equal(json_integer_value(json_object_get(params, "n")), 2);
    json_decref(result);
    free_output(&output);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_usage_errors_exit_2_and_suggest_a_name),
        cmocka_unit_test(test_every_command_explains_itself),
        cmocka_unit_test(test_lists_are_text_or_json_with_everything),
        cmocka_unit_test(test_catalogue_page_has_every_scenario_without_network_requests),
        cmocka_unit_test(test_printed_scene_equals_the_scenario),
        cmocka_unit_test(test_run_prints_metrics_or_one_object),
        cmocka_unit_test(test_results_hold_every_key_of_the_schema),
        cmocka_unit_test(test_trajectory_goes_to_file_or_standard_output),
        cmocka_unit_test(test_compare_separates_data_from_messages_in_all_forms),
        cmocka_unit_test(test_jobs_side_by_side_make_the_same_runs),
        cmocka_unit_test(test_nothing_compared_exits_4),
        cmocka_unit_test(test_unwritable_output_exits_3_with_its_name),
        cmocka_unit_test(test_a_full_standard_output_exits_3),
        cmocka_unit_test(test_help_to_a_full_disk_exits_3_too),
        cmocka_unit_test(test_a_closed_standard_stream_never_becomes_a_file),
        cmocka_unit_test(test_json_file_is_complete_after_a_broken_pipe),
        cmocka_unit_test(test_a_time_limit_is_told_by_help),
        cmocka_unit_test(test_engines_in_the_examples_of_help_exist),
        cmocka_unit_test(test_dt_and_duration_reach_the_scene),
    };
    return cmocka_run_group_tests_name("command", tests, setup_workspace, teardown_workspace);
}
