/* An engine that aborts, hangs, exits, prints, takes all memory or returns NaN is a row of the
 * results, and nothing else suffers: plumb compare with faulty_engine.c. */
#include "base/sanitizer.h"
#include "check.h"
#include "plumb_process.h"
#include "results/result.h"
#include "results/store.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>

typedef struct fixture {
    workspace at;
    json_t *results;
} fixture;

static int compare_all(void **state)
{
    fixture *f = calloc(1, sizeof *f);
    f->at = make_workspace();
    const char *const arguments[] = {"compare",          f->at.scene, "--out",          f->at.out,
                                     "--timeout",        "2",         "--jobs",         "2",
                                     "--memory",         "2",         "--no-reference", "--engine",
                                     FAULTY ":good",     "--engine",  FAULTY ":abort",  "--engine",
                                     FAULTY ":segfault", "--engine",  FAULTY ":hang",   "--engine",
                                     FAULTY ":stop",     "--engine",  FAULTY ":nan",    "--engine",
                                     FAULTY ":memory",   "--engine",  FAULTY ":exit",   "--engine",
                                     FAULTY ":print",    "--engine",  FAULTY ":mass",   "--engine",
                                     FAULTY ":friction", "--engine",  FAULTY ":refuse", "--engine",
                                     FAULTY ":orphan",   "--engine",  FAULTY ":create", "--engine",
                                     FAULTY ":destroy",  NULL};
    plumb_output output = run_plumb(f->at.directory, arguments);
    if (output.code != 0) {
        print_error("exit code %d: %s\n", output.code, output.err);
    }
    assert_int_equal(output.code, 0);
    free_output(&output);
    pl_error error = {.message = ""};
    assert_int_equal(pl_results_read(f->at.results, &f->results, NULL, &error), PL_OK);
    *state = f;
    return 0;
}

static int clean(void **state)
{
    fixture *f = *state;
    json_decref(f->results);
    remove_workspace(&f->at);
    free(f);
    return 0;
}

static const json_t *check_outcome(void **state, const char *label, const char *outcome)
{
    const fixture *f = *state;
    const json_t *result = result_of(f->results, label);
    if (strcmp(result_text(result, "outcome"), outcome) != 0) {
        print_error("%s: %s: %s\n", label, result_text(result, "outcome"),
                    result_text(result, "reason"));
    }
    assert_string_equal(result_text(result, "outcome"), outcome);
    return result;
}

static void test_every_engine_has_its_row(void **state)
{
    const fixture *f = *state;
    assert_int_equal(json_array_size(f->results), 15);
}

static void test_correct_test_engine_has_exact_free_fall(void **state)
{
    const json_t *good = check_outcome(state, "faulty:good", "ok");
    assert_true(json_is_null(json_object_get(good, "reason")));
    assert_true(json_is_null(json_object_get(good, "output")));
    const json_t *pose = json_array_get(json_object_get(good, "final_poses"), 1);
    /* Semi-implicit Euler: z0 - g h^2 n (n + 1) / 2. */
    assert_close(json_number_value(json_array_get(pose, 2)), 5 - 9.81 * 1e-4 * 20 * 21 / 2, 1e-12,
                 0);
    const json_t *steps = json_object_get(good, "steps");
    assert_int_equal(json_integer_value(json_object_get(steps, "done")), 20);
    const json_t *metrics = json_object_get(good, "metrics");
    const json_t *memory = json_object_get(json_object_get(metrics, "memory_peak"), "value");
    assert_true(json_is_number(memory));
    assert_true(json_number_value(memory) >= 0 && json_number_value(memory) < 16e6);
    assert_non_null(json_object_get(metrics, "time_per_step"));
    /* What it does not report is null, never 0. */
    const json_t *iterations = json_object_get(metrics, "iterations_mean");
    assert_true(json_is_null(json_object_get(iterations, "value")));
    assert_true(result_text(iterations, "reason")[0] != '\0');
}

static void test_abort_is_crashed_with_signal_and_step(void **state)
{
    const json_t *row = check_outcome(state, "faulty:abort", "crashed");
    assert_contains(result_text(row, "reason"), "SIGABRT in step 3 of 20");
    assert_contains(result_text(row, "reason"), "last line: assertion failed: depth < 1e-3");
    assert_contains(result_text(row, "output"), "first line\n");
    assert_int_equal(json_integer_value(json_object_get(json_object_get(row, "steps"), "done")), 2);
}

static void test_segfault_is_crashed(void **state)
{
    const json_t *row = check_outcome(state, "faulty:segfault", "crashed");
    assert_contains(result_text(row, "reason"), "SIGSEGV in step 3 of 20");
}

static void test_hang_is_timeout_with_the_steps_done(void **state)
{
    const json_t *row = check_outcome(state, "faulty:hang", "timeout");
    assert_contains(result_text(row, "reason"), "no end within 2 s");
    assert_contains(result_text(row, "reason"), "step 3 of 20");
    assert_int_equal(json_integer_value(json_object_get(json_object_get(row, "steps"), "done")), 2);
}

static void test_cpu_limit_counts_create_and_steps(void **state)
{
    static const char *const engines[] = {FAULTY ":work_in_create", FAULTY ":work_in_step"};
    const fixture *f = *state;
    for (int i = 0; i < 2; ++i) {
        plumb_output output = run_plumb(
            f->at.directory, (const char *const[]){"run", f->at.scene, "--engine", engines[i],
                                                   "--cpu-limit", "0.02", NULL});
        assert_int_equal(output.code, 3);
        assert_contains(output.out, "timeout, ");
        assert_contains(output.out,
                        "the engine's calls took more than the --cpu-limit of 0.02 s: ");
        if (i == 0) { /* one call that takes more than twice the limit */
            assert_contains(output.out, "killed in create");
        }
        free_output(&output);
    }
}

/* All reads together take longer than the limit, and none of them does by itself. */
static void test_cpu_limit_leaves_out_reads(void **state)
{
    const fixture *f = *state;
    plumb_output output =
        run_plumb(f->at.directory,
                  (const char *const[]){"run", f->at.scene, "--engine", FAULTY ":work_in_read",
                                        "--cpu-limit", "0.02", NULL});
    assert_int_equal(output.code, 0);
    assert_contains(output.out, "ok, ");
    free_output(&output);
}

/* The engine sleeps 0.4 s in the one, and the referee takes about as long for 1000 balls in the
 * other, where the engine's calls take a few milliseconds. */
static void test_cpu_limit_leaves_out_waiting_and_the_referee(void **state)
{
    const fixture *f = *state;
    plumb_output output = run_plumb(
        f->at.directory, (const char *const[]){"run", f->at.scene, "--engine", FAULTY ":slow_print",
                                               "--cpu-limit", "0.2", NULL});
    assert_int_equal(output.code, 0);
    free_output(&output);
    output =
        run_plumb(f->at.directory,
                  (const char *const[]){"run", "pile", "--set", "shape=0", "--set", "n=1000",
                                        "--engine", FAULTY ":good", "--cpu-limit", "0.2", NULL});
    assert_contains(output.out, "ok, 240 of 240 steps");
    free_output(&output);
}

/* Linux counts the CPU time of a process that has a timer of CPU time in ticks: that of a short run
 * would be 0. */
static void test_cpu_limit_leaves_the_clock_exact(void **state)
{
    const fixture *f = *state;
    for (int i = 0; i < 4; ++i) {
        plumb_output output = run_plumb(
            f->at.directory, (const char *const[]){"run", "free-fall", "--engine", "plumb",
                                                   "--cpu-limit", "10", "--json", "-", NULL});
        json_t *result = json_loads(output.out, 0, NULL);
        assert_true(pl_result_metric(result, "time_per_step") > 0);
        json_decref(result);
        free_output(&output);
    }
}

static void test_a_stopped_process_is_timeout(void **state)
{
    const json_t *row = check_outcome(state, "faulty:stop", "timeout");
    assert_contains(result_text(row, "reason"), "step 3 of 20");
}

static void test_nan_is_nonfinite_with_the_last_good_frame(void **state)
{
    const json_t *row = check_outcome(state, "faulty:nan", "nonfinite");
    const json_t *pose = json_array_get(json_object_get(row, "final_poses"), 2);
    assert_close(json_number_value(json_array_get(pose, 1)), 0, 0, 0);
    assert_close(json_number_value(json_array_get(pose, 2)), 5 - 9.81 * 1e-4 * 2 * 3 / 2, 1e-12, 0);
}

static void test_all_memory_taken_is_crashed(void **state)
{
#if PL_SANITIZER
    (void)state;
    skip(); /* its shadow memory allows no limit of address space */
#else
    const json_t *row = check_outcome(state, "faulty:memory", "crashed");
    assert_contains(result_text(row, "reason"), "last line: out of memory");
#endif
}

static void test_exit_in_a_step_is_always_crashed(void **state)
{
    const json_t *row = check_outcome(state, "faulty:exit", "crashed");
    assert_contains(result_text(row, "reason"), "exit(0) in step 3 of 20");
}

static void test_megabytes_of_output_leave_their_last_2000_bytes(void **state)
{
    const json_t *row = check_outcome(state, "faulty:print", "ok");
    const char *output = result_text(row, "output");
    assert_int_equal(strlen(output), 2000);
    assert_string_equal(output + 2000 - 7, "262143\n");
}

static void test_changed_mass_or_friction_is_unsupported_with_numbers(void **state)
{
    const json_t *row = check_outcome(state, "faulty:mass", "unsupported");
    assert_contains(result_text(row, "reason"), "mass of a");
    assert_contains(result_text(row, "reason"), "the scene has 1, the engine 1.000000001");
    row = check_outcome(state, "faulty:friction", "unsupported");
    assert_contains(result_text(row, "reason"), "friction between");
    assert_contains(result_text(row, "reason"), "the scene has 0.5, the engine 0.75");
}

static void test_a_step_that_refuses_is_unsupported(void **state)
{
    const json_t *row = check_outcome(state, "faulty:refuse", "unsupported");
    assert_string_equal(result_text(row, "reason"), "this is too steep for it");
}

static void test_a_crash_outside_of_steps_says_where(void **state)
{
    const json_t *row = check_outcome(state, "faulty:create", "crashed");
    assert_contains(result_text(row, "reason"), "SIGABRT in create");
    row = check_outcome(state, "faulty:destroy", "crashed");
    assert_contains(result_text(row, "reason"), "SIGABRT in destroy, 20 of 20 steps done");
}

static void test_leftover_process_is_killed_without_delay(void **state)
{
    check_outcome(state, "faulty:orphan", "ok");
    /* As subreaper this process would have inherited it. */
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
    assert_int_equal(errno, ECHILD);
}

static void test_a_need_that_the_engine_lacks_is_named(void **state)
{
    const fixture *f = *state;
    char *scene = path_in(f->at.directory, "box.json");
    char *text = strdup(falling_scene);
    char *shape = strstr(text, "\"type\": \"sphere\", \"radius\": 0.5");
    const char box[] = "\"type\":\"box\",\"half_extents\":[1,1,1]";
    assert_true(strlen(box) >= strlen("\"type\": \"sphere\", \"radius\": 0.5"));
    char *joined = NULL;
    assert_true(asprintf(&joined, "%.*s%s%s", (int)(shape - text), text, box,
                         shape + strlen("\"type\": \"sphere\", \"radius\": 0.5")) > 0);
    write_text(scene, joined);
    const char *const arguments[] = {"run", scene, "--engine", FAULTY, NULL};
    plumb_output output = run_plumb(f->at.directory, arguments);
    assert_int_equal(output.code, 3);
    assert_contains(output.out, "unsupported");
    assert_contains(output.out, "faulty lacks box");
    free_output(&output);
    free(joined);
    free(text);
    free(scene);
}

int main(void)
{
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_engine_has_its_row),
        cmocka_unit_test(test_correct_test_engine_has_exact_free_fall),
        cmocka_unit_test(test_abort_is_crashed_with_signal_and_step),
        cmocka_unit_test(test_segfault_is_crashed),
        cmocka_unit_test(test_hang_is_timeout_with_the_steps_done),
        cmocka_unit_test(test_a_stopped_process_is_timeout),
        cmocka_unit_test(test_cpu_limit_counts_create_and_steps),
        cmocka_unit_test(test_cpu_limit_leaves_out_reads),
        cmocka_unit_test(test_cpu_limit_leaves_out_waiting_and_the_referee),
        cmocka_unit_test(test_cpu_limit_leaves_the_clock_exact),
        cmocka_unit_test(test_nan_is_nonfinite_with_the_last_good_frame),
        cmocka_unit_test(test_all_memory_taken_is_crashed),
        cmocka_unit_test(test_exit_in_a_step_is_always_crashed),
        cmocka_unit_test(test_megabytes_of_output_leave_their_last_2000_bytes),
        cmocka_unit_test(test_changed_mass_or_friction_is_unsupported_with_numbers),
        cmocka_unit_test(test_a_step_that_refuses_is_unsupported),
        cmocka_unit_test(test_a_crash_outside_of_steps_says_where),
        cmocka_unit_test(test_leftover_process_is_killed_without_delay),
        cmocka_unit_test(test_a_need_that_the_engine_lacks_is_named),
    };
    return cmocka_run_group_tests_name("faults", tests, compare_all, clean);
}
