/* What compare, threshold, metamorphic and ensemble parse alike, and the limits of their runs. */
#include "check.h"
#include "plumb_process.h"
#include "results/store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const commands[] = {"compare", "threshold", "metamorphic", "ensemble"};
enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

static plumb_output call(void **state, const char *const *arguments)
{
    const workspace *f = *state;
    return run_plumb(f->directory, arguments);
}

/* The call exits with 2, says `said` and not `unsaid`, and writes nothing. */
static void check_refused(void **state, const char *const *arguments, const char *said,
                          const char *unsaid)
{
    const workspace *f = *state;
    plumb_output output = call(state, arguments);
    assert_contains(output.err, said);
    assert_absent(output.err, unsaid);
    assert_int_equal(output.code, 2);
    assert_string_equal(output.out, "");
    assert_int_not_equal(access(f->out, F_OK), 0);
    free_output(&output);
}

static void test_comparison_commands_share_their_options(void **state)
{
    static const char *const options[] = {"--suite",    "--engine", "--json",    "--set",   "--dt",
                                          "--duration", "--seed",   "--timeout", "--memory"};
    for (size_t i = 0; i < COMMAND_COUNT; ++i) {
        plumb_output output = call(state, (const char *const[]){commands[i], "--help", NULL});
        assert_int_equal(output.code, 0);
        for (size_t k = 0; k < sizeof options / sizeof options[0]; ++k) {
            assert_contains(output.out, options[k]);
        }
        assert_contains(output.out, "Longest wall time of a run in seconds (default\n");
        free_output(&output);
    }
}

static void test_an_option_that_a_command_lacks_is_refused(void **state)
{
    static const char *const lacking[][2] = {{"metamorphic", "--repeat"},
                                             {"metamorphic", "--trajectory"},
                                             {"run", "--resume"},
                                             {"ensemble", "--repeat"},
                                             {"compare", "--members"}};
    for (size_t i = 0; i < sizeof lacking / sizeof lacking[0]; ++i) {
        char said[64];
        snprintf(said, sizeof said, "plumb %s: there is no option %s", lacking[i][0],
                 lacking[i][1]);
        check_refused(state, (const char *const[]){lacking[i][0], "pile", lacking[i][1], "2", NULL},
                      said, "Usage");
    }
}

static void test_mistakes_are_said_alike_by_all(void **state)
{
    static const char *const mistakes[][3] = {
        {"--engin", "plum", "unknown engine"},
        {"--sute", "canonical", "did you mean --suite?"},
        {"--suite", "canonicle", "did you mean"},
        {"--set", "n", "--set takes NAME=VALUE"},
        {"--set", "frction=1", "--set frction=1: no chosen scenario has the parameter"},
        {"--dt", "0", "--dt takes seconds"},
        {"--duration", "nan", "--duration takes seconds"},
        {"--seed", "-1", "--seed takes an integer"},
        {"--timeout", "0", "--timeout takes seconds"},
        {"--memory", "-1", "--memory takes GiB"},
    };
    for (size_t i = 0; i < COMMAND_COUNT; ++i) {
        for (size_t k = 0; k < sizeof mistakes / sizeof mistakes[0]; ++k) {
            check_refused(state,
                          (const char *const[]){commands[i], "slope-threshold", mistakes[k][0],
                                                mistakes[k][1], NULL},
                          mistakes[k][2], "--against");
        }
    }
}

static void test_misspelt_parameter_names_its_option(void **state)
{
    const workspace *f = *state;
    static const char *const misspelt[][4] = {
        /* values of --set and --against, the message, the option that is not named */
        {"friction=0.3", "frction=0.4", "--against frction=0.4", "--set"},
        {"frction=0.3", "friction=0.4", "--set frction=0.3", "--against"},
    };
    for (size_t i = 0; i < sizeof misspelt / sizeof misspelt[0]; ++i) {
        const char *const *values = misspelt[i];
        const char *const arguments[] = {"ensemble", "pile",    "--engine",  "plumb",
                                         "--set",    values[0], "--against", values[1],
                                         "--out",    f->out,    NULL};
        char said[256];
        snprintf(said, sizeof said,
                 "%s: no chosen scenario has the parameter frction; did you mean friction?",
                 values[2]);
        check_refused(state, arguments, said, values[3]);
    }
    check_refused(state,
                  (const char *const[]){"ensemble", f->scene, "--engine", "plumb", "--against",
                                        "friction=0.4", "--out", f->out, NULL},
                  "--against friction=0.4: no chosen scenario has the parameter", "--set");
}

static void test_members_that_hang_are_rows_of_the_ensemble(void **state)
{
    const workspace *f = *state;
    plumb_output output =
        call(state, (const char *const[]){"ensemble", f->scene, "--engine", FAULTY ":hang",
                                          "--engine", FAULTY ":good", "--members", "6", "--timeout",
                                          "0.3", "--jobs", "2", "--out", f->out, NULL});
    assert_int_equal(output.code, 0);
    assert_contains(output.out, "faulty:hang");
    json_t *results = NULL;
    assert_int_equal(pl_results_read(f->results, &results, NULL, NULL), PL_OK);
    assert_int_equal(json_array_size(results), 12);
    size_t index;
    const json_t *row;
    json_array_foreach(results, index, row)
    {
        bool hangs = strcmp(result_text(row, "label"), "faulty:hang") == 0;
        assert_string_equal(result_text(row, "outcome"), hangs ? "timeout" : "ok");
    }
    json_decref(results);
    free_output(&output);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_comparison_commands_share_their_options),
        cmocka_unit_test(test_an_option_that_a_command_lacks_is_refused),
        cmocka_unit_test(test_mistakes_are_said_alike_by_all),
        cmocka_unit_test(test_misspelt_parameter_names_its_option),
        cmocka_unit_test(test_members_that_hang_are_rows_of_the_ensemble),
    };
    return cmocka_run_group_tests_name("comparison", tests, setup_workspace, teardown_workspace);
}
