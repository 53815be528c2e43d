/* plumb metamorphic as a user meets it: exit codes, names, verdicts of engines with known faults;
 * and the judgement itself, on trajectories written by hand. */
#include "check.h"
#include "plumb_process.h"
#include "results/store.h"
#include "studies/metamorphic/metamorphic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static plumb_output call(const workspace *f, const char *const *arguments)
{
    return run_plumb(f->directory, arguments);
}

/* ---- Names and exit codes ---- */

static void test_usage_errors_exit_2_and_suggest_a_name(void **state)
{
    static const char *const cases[][5] = {
        {NULL, NULL, NULL, NULL, "which scenario?"},
        {"towr", NULL, NULL, NULL, "did you mean \"tower\"?"},
        {"tower", "--check", "rotat", NULL, "did you mean \"rotate\"?"},
        {"tower", "--check", "rotate-z91", NULL, "did you mean \"rotate-z90\"?"},
        {"tower", "--check", "gravity", NULL, "scale, shift, restart, split, tessellate and late"},
        {"tower", "--engine", "plum", NULL, "plumb"},
        {"--suite", "canonicle", NULL, NULL, "did you mean"},
        {"tower", "--chekc", "far", NULL, "did you mean --check?"},
        {"tower", "--set", "m=3", NULL, "no chosen scenario has the parameter m"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const char *const *c = cases[i];
        const char *arguments[] = {"metamorphic", c[0], c[1], c[2], NULL};
        plumb_output output = call(*state, arguments);
        assert_contains(output.err, c[4]);
        assert_int_equal(output.code, 2);
        assert_string_equal(output.out, "");
        free_output(&output);
    }
}

static void test_it_explains_itself(void **state)
{
    const char *const arguments[] = {"help", "metamorphic", NULL};
    plumb_output output = call(*state, arguments);
    assert_int_equal(output.code, 0);
    assert_contains(output.out, "Examples:");
    free_output(&output);
}

/* The one trial of a call, which writes JSON to standard output. The caller decrefs. */
static json_t *trial_of(const workspace *f, const char *scene, const char *engine,
                        const char *check, int code)
{
    const char *const arguments[] = {"metamorphic", scene, "--engine", engine, "--json",  "-",
                                     "--check",     check, "--out",    f->out, "--force", NULL};
    plumb_output output = call(f, arguments);
    if (output.code != code) {
        fail_msg("exit code %d, expected %d: %s", output.code, code, output.err);
    }
    json_t *trials = json_loads(output.out, 0, NULL);
    assert_int_equal(json_array_size(trials), 1);
    json_t *trial = json_incref(json_array_get(trials, 0));
    json_decref(trials);
    free_output(&output);
    return trial;
}

static const json_t *finding_of(const json_t *trial, const char *check)
{
    size_t index;
    const json_t *finding;
    json_array_foreach(json_object_get(trial, "checks"), index, finding)
    {
        if (strcmp(result_text(finding, "check"), check) == 0) {
            return finding;
        }
    }
    fail_msg("there is no check %s", check);
    return NULL;
}

static void test_json_reports_runs_and_results(void **state)
{
    json_t *trial = trial_of(*state, "rocket", "plumb:fast", "rotate", 0);
    assert_string_equal(result_text(trial, "schema"), "plumb.metamorphic/1");
    assert_string_equal(result_text(trial, "scenario"), "rocket");
    assert_string_equal(result_text(trial, "label"), "plumb:fast");
    assert_string_equal(result_text(trial, "outcome"), "ok");
    assert_true(json_number_value(json_object_get(trial, "size")) > 0);
    assert_int_equal(json_array_size(json_object_get(trial, "checks")), 3);
    const json_t *finding = finding_of(trial, "rotate-z45");
    assert_true(json_is_null(json_object_get(finding, "reason")));
    assert_true(json_is_null(json_object_get(finding, "passes_at")));
    const char *const parts[] = {"early", "end"};
    for (int i = 0; i < 2; ++i) {
        const json_t *difference = json_object_get(finding, parts[i]);
        assert_at_most(json_number_value(json_object_get(difference, "position")), 1e-9);
        assert_at_most(json_number_value(json_object_get(difference, "rotation")), 1e-9);
        assert_contains("bitwise or exact", result_text(difference, "verdict"));
    }
    json_decref(trial);
}

/* ---- Engines with known faults ---- */

static void check_verdict(const workspace *f, const char *engine, const char *check,
                          const char *verdict, const char *reason, int code)
{
    json_t *trial = trial_of(f, f->scene, engine, check, code);
    const json_t *finding = finding_of(trial, check);
    assert_string_equal(result_text(finding, "verdict"), verdict);
    assert_contains(result_text(finding, "reason"), reason);
    json_decref(trial);
}

/* A plain run that does not come to its end says why, and has no checks. */
static void check_plain(const workspace *f, const char *engine, const char *outcome,
                        const char *reason, int code)
{
    json_t *trial = trial_of(f, f->scene, engine, "again", code);
    assert_string_equal(result_text(trial, "outcome"), outcome);
    assert_contains(result_text(trial, "reason"), reason);
    assert_int_equal(json_array_size(json_object_get(trial, "checks")), 0);
    json_decref(trial);
}

static void test_broken_run_fails_and_unsupported_run_is_skipped(void **state)
{
    check_verdict(*state, FAULTY ":good", "again", "bitwise", "", 0);
    check_verdict(*state, FAULTY ":good", "mirror", "bitwise", "", 0);
    check_plain(*state, FAULTY ":abort", "crashed", "SIGABRT", 0);
    check_plain(*state, FAULTY ":nan", "nonfinite", "", 0);
    check_plain(*state, FAULTY ":mass", "unsupported", "", 4);
}

static void test_progress_and_tables_use_separate_streams(void **state)
{
    const workspace *f = *state;
    const char *const arguments[] = {"metamorphic", f->scene, "--engine", FAULTY ":good", "--check",
                                     "mirror",      "--out",  f->out,     "--force",      NULL};
    plumb_output output = call(f, arguments);
    assert_int_equal(output.code, 0);
    assert_contains(output.out, "mirror");
    assert_contains(output.out, "bitwise");
    assert_contains(output.err, "[2/2]");
    assert_absent(output.out, "[2/2]");
    free_output(&output);
}

/* ---- Judgement ---- */

enum { STEPS = 20 };

/* One ball that moves along x, and in the steps from `from` to `until` is displaced by `off` along y. */
static void write_frames(pl_trajectory *trajectory, int frames, int from, int until, double off,
                         double turn)
{
    pl_error error = {.message = ""};
    assert_int_equal(pl_trajectory_open(trajectory, &error), PL_OK);
    fprintf(trajectory->file, "time,body,...\n");
    for (int i = 0; i < frames; ++i) {
        const bool is_off = i >= from && i <= until;
        double y = is_off ? off : 0, w = is_off ? turn / 2 : 0;
        fprintf(trajectory->file, "%.17g,\"a \"\"ball\"\", 1\",%.17g,%.17g,0", 0.1 * i, 0.3 * i, y);
        fprintf(trajectory->file, ",%.17g,%.17g,0,0,3,0,0,0,0,0\n", cos(w), sin(w));
    }
}

/* The caller decrefs. */
static json_t *compare(int frames, int from, int until, double off, double turn)
{
    pl_error error = {.message = ""};
    pl_body ball = pl_body_default();
    pl_scene scene = pl_scene_default();
    pl_trajectory plain, other;
    const pl_transform same = pl_transform_identity();
    ball.shape = pl_shape_sphere(0.5);
    scene.dt = 0.1;
    scene.duration = 0.1 * STEPS;
    assert_int_equal(pl_scene_add_body(&scene, &ball, NULL, &error), PL_OK);
    write_frames(&plain, STEPS + 1, 0, STEPS, 0, 0);
    write_frames(&other, frames, from, until, off, turn);
    const pl_trajectory_pair comparison = {.scene = &scene,
                                           .transform = &same,
                                           .size = 2,
                                           .plain = &plain,
                                           .other = &other,
                                           .other_body_count = 1};
    json_t *agreement = pl_agreement_of(&comparison);
    pl_trajectory_close(&plain);
    pl_trajectory_close(&other);
    pl_scene_free(&scene);
    return agreement;
}

static void test_differences_are_graded_at_two_times(void **state)
{
    (void)state;
    static const struct {
        int from;
        double off, turn;
        const char *early, *end;
        double passes_at;
    } cases[] = {
        {0, 0, 0, "bitwise", "bitwise", (double)NAN},
        {0, 1.9e-9, 0, "exact", "exact", (double)NAN},
        {3, 1.9e-9, 0, "bitwise", "exact", (double)NAN},
        {2, 2.1e-9, 0, "close", "close", (double)NAN},
        {4, 1.9e-6, 0, "bitwise", "close", (double)NAN},
        {4, 2.1e-6, 0, "bitwise", "close", 0.4},
        {7, 1.9e-3, 0, "bitwise", "close", 0.7},
        {20, 2.1e-3, 0, "bitwise", "differs", 2},
        {5, 0, 0.9e-9, "bitwise", "exact", (double)NAN},
        {5, 0, 1.1e-9, "bitwise", "close", (double)NAN},
        {0, 0, 1.1e-3, "differs", "differs", (double)NAN},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        json_t *a = compare(STEPS + 1, cases[i].from, STEPS, cases[i].off, cases[i].turn);
        const json_t *end = json_object_get(a, "end"), *passes_at = json_object_get(a, "passes_at");
        assert_string_equal(result_text(json_object_get(a, "early"), "verdict"), cases[i].early);
        assert_string_equal(result_text(end, "verdict"), cases[i].end);
        assert_close(json_number_value(json_object_get(end, "position")), cases[i].off / 2, 1e-18,
                     0);
        assert_close(json_number_value(json_object_get(end, "rotation")), cases[i].turn, 1e-15, 0);
        assert_int_equal(json_is_null(passes_at), isnan(cases[i].passes_at));
        if (!json_is_null(passes_at)) {
            assert_close(json_number_value(passes_at), cases[i].passes_at, 1e-12, 0);
        }
        json_decref(a);
    }
}

static void test_a_detour_that_comes_back_is_not_bitwise(void **state)
{
    (void)state;
    json_t *a = compare(STEPS + 1, 5, 6, 1, 0);
    const json_t *end = json_object_get(a, "end");
    assert_string_equal(result_text(end, "verdict"), "exact");
    assert_close(json_number_value(json_object_get(end, "position")), 0, 0, 0);
    json_decref(a);
}

static void test_too_few_frames_are_no_agreement(void **state)
{
    (void)state;
    json_t *a = compare(STEPS, 0, STEPS, 0, 0);
    assert_string_equal(result_text(a, "reason"), "20 of 21 frames to compare");
    assert_int_equal(json_object_size(a), 1);
    json_decref(a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_usage_errors_exit_2_and_suggest_a_name),
        cmocka_unit_test(test_it_explains_itself),
        cmocka_unit_test(test_json_reports_runs_and_results),
        cmocka_unit_test(test_broken_run_fails_and_unsupported_run_is_skipped),
        cmocka_unit_test(test_progress_and_tables_use_separate_streams),
        cmocka_unit_test(test_differences_are_graded_at_two_times),
        cmocka_unit_test(test_a_detour_that_comes_back_is_not_bitwise),
        cmocka_unit_test(test_too_few_frames_are_no_agreement),
    };
    return cmocka_run_group_tests(tests, setup_workspace, teardown_workspace);
}
