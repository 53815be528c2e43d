/* The laws of the plan, of a process under limits, and of one run in this process. */
#include "base/sanitizer.h"
#include "check.h"
#include "engines/process.h"
#include "plumb_process.h"
#include "runner/plan.h"
#include "runner/progress.h"
#include "runner/resource_usage.h"
#include "runner/run_once.h"
#include "runner/session.h"

#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* --- the plan --- */

static void test_plan_has_every_run_once_and_rotates_engines(void **state)
{
    (void)state;
    pl_case problems[2] = {{.name = NULL}};
    pl_configuration configurations[3] = {{.label = "a"}, {.label = "b"}, {.label = "c"}};
    const pl_plan plan = {.cases = problems,
                          .case_count = 2,
                          .configurations = configurations,
                          .configuration_count = 3,
                          .repeats = 4};
    int seen[4][2][3] = {{{0}}};
    int first[3] = {0};
    assert_int_equal(pl_plan_size(&plan), 24);
    for (long i = 0; i < 24; ++i) {
        pl_planned_run run = pl_plan_run(&plan, i);
        seen[run.repeat][run.test_case - problems][run.configuration - configurations] += 1;
        if (i % 3 == 0 && run.repeat < 3) {
            first[run.configuration - configurations] += 1;
        }
        assert_int_equal(run.repeat, i / 6);
    }
    for (int i = 0; i < 24; ++i) {
        assert_int_equal((&seen[0][0][0])[i], 1);
    }
    for (int k = 0; k < 3; ++k) {
        assert_int_equal(first[k], 2); /* each engine goes first equally often */
    }
}

/* --- bounds --- */

static void test_bounds_depend_on_the_start_alone(void **state)
{
    (void)state;
    pl_body body = {.shape = {.kind = PL_SHAPE_SPHERE, .radius = 1},
                    .position = {5, 0, 0},
                    .orientation = {1, 0, 0, 0}};
    pl_scene scene = {.bodies = &body, .body_count = 1, .gravity = {0, 0, -10}, .duration = 1};
    double lower[3], upper[3], later_lower[3], later_upper[3];
    pl_scene_bounds(&scene, lower, upper);
    scene.duration = 1000;
    pl_scene_bounds(&scene, later_lower, later_upper);
    for (int k = 0; k < 3; ++k) {
        assert_close(lower[k], (k == 0 ? 5 : 0) - 101, 1e-12, 0);
        assert_close(upper[k], (k == 0 ? 5 : 0) + 101, 1e-12, 0);
        assert_close(later_lower[k], lower[k], 0, 0);
        assert_close(later_upper[k], upper[k], 0, 0);
    }
    body.velocity[1] = -30;
    pl_scene_bounds(&scene, lower, upper);
    assert_close(upper[0], 5 + 301, 1e-12, 0);
}

static const char travel_scene[] =
    "{ \"plumb_scene\": 1, \"dt\": 0.01, \"duration\": 1, \"bodies\": [\n"
    "  { \"name\": \"a\", \"mass\": 1, \"shape\": { \"type\": \"sphere\", \"radius\": 1 } } ],\n"
    "  \"expect\": { \"travel\": [ { \"body\": \"a\", \"direction\": [0, 0, -1],\n"
    "    \"distance\": 4.905, \"discrete\": 4.95405 } ] } }\n";

/* Adds a scene file with a setting, "" for none, to the plan. */
static pl_status add_file(pl_plan *plan, const char *path, const char *setting, pl_error *error)
{
    const pl_scenario *scenario = NULL;
    assert_int_equal(pl_plan_open_file(plan, path, &scenario, error), PL_OK);
    return pl_plan_add_scenario(plan, scenario, &setting, setting[0] != '\0', error);
}

static void test_scene_file_overrides_drop_invalid_expectations(void **state)
{
    (void)state;
    char *directory = make_directory();
    char *path = path_in(directory, "scene.json");
    write_text(path, travel_scene);
    pl_error error = {.message = ""};
    pl_plan plan = {.repeats = 1};
    assert_int_equal(add_file(&plan, path, "", &error), PL_OK);
    assert_int_equal(add_file(&plan, path, "dt=0.02", &error), PL_OK);
    assert_int_equal(plan.case_count, 2);
    assert_close(plan.cases[0].scene.travels[0].discrete, 4.95405, 0, 0);
    assert_true(isnan(plan.cases[1].scene.travels[0].discrete));
    assert_close(plan.cases[1].scene.dt, 0.02, 0, 0);
    assert_int_equal(add_file(&plan, path, "duration=2", &error), PL_BAD_INPUT);
    assert_contains(error.message, "travel");
    assert_int_equal(add_file(&plan, path, "dt=2", &error), PL_BAD_INPUT);
    assert_int_equal(add_file(&plan, path, "", &error), PL_OK);
    assert_int_equal(plan.case_count, 2); /* the same problem again is not added */
    pl_plan_free(&plan);
    free(path);
    remove_directory(directory);
}

/* --- progress --- */

static void test_progress_bar_leaves_space_for_names(void **state)
{
    (void)state;
    for (int width = 1; width < 130; ++width) {
        char *text = NULL;
        size_t size = 0;
        FILE *out = open_memstream(&text, &size);
        const pl_progress progress = {
            .out = out, .terminal = true, .width = width, .total = 9, .done = 4};
        pl_progress_draw(&progress, "tower plumb:default", 0.5, 10);
        fclose(out);
        char *end = strstr(text, "\033[K");
        assert_int_equal(text[0], '\r');
        assert_non_null(end);
        assert_true(end - text - 1 <= width - 1);
        if (width >= 40) {
            assert_contains(text, "0:10 left  tower");
        }
        free(text);
    }
}

/* --- a process under limits --- */

static void collect(pl_process *process)
{
    struct pollfd polls[PL_PROCESS_POLLS];
    do {
        pl_process_polls(process, polls);
        poll(polls, PL_PROCESS_POLLS, 20);
    } while (!pl_process_advance(process, polls));
}

static void answer_much(void *user, FILE *answer)
{
    for (int i = 0; i < *(int *)user; ++i) {
        fputs("0123456789abcdef", answer);
    }
}

static void test_an_answer_larger_than_a_pipe_arrives_whole(void **state)
{
    (void)state;
    const pl_limits limits = {.timeout = 10};
    const int counts[] = {0, 1, 100000};
    for (int i = 0; i < 3; ++i) {
        int count = counts[i];
        pl_process process;
        assert_int_equal(pl_process_start(&process, &limits, answer_much, &count, NULL), PL_OK);
        collect(&process);
        assert_true(WIFEXITED(process.wait_status) && WEXITSTATUS(process.wait_status) == 0);
        assert_int_equal(process.text.length, 16 * (size_t)count);
        pl_process_free(&process);
    }
}

/* The child ignores what it can, and its own child holds the pipes. */
static void hang_for_ever(void *user, FILE *answer)
{
    (void)user;
    (void)answer;
    signal(SIGTERM, SIG_IGN);
    fork();
    for (;;) {
        puts("still here");
    }
}

static void test_endless_output_is_killed_at_the_timeout(void **state)
{
    (void)state;
    const pl_limits limits = {.timeout = 0.2};
    pl_process process;
    assert_int_equal(pl_process_start(&process, &limits, hang_for_ever, NULL, NULL), PL_OK);
    collect(&process);
    assert_true(process.timed_out);
    assert_true(WIFSIGNALED(process.wait_status) && WTERMSIG(process.wait_status) == SIGKILL);
    assert_int_equal(process.tail_length, PL_OUTPUT_TAIL);
    pl_process_free(&process);
}

static void print_some(void *user, FILE *answer)
{
    (void)answer;
    int length = *(int *)user;
    for (int i = 0; i < length; ++i) {
        putchar('a' + i % 26);
    }
}

static void test_output_tail_is_the_end_of_the_output(void **state)
{
    (void)state;
    const pl_limits limits = {.timeout = 10};
    const int lengths[] = {0, 1, 1999, 2000, 2001, 70000};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; ++i) {
        int length = lengths[i];
        int kept = length < PL_OUTPUT_TAIL ? length : PL_OUTPUT_TAIL;
        pl_process process;
        assert_int_equal(pl_process_start(&process, &limits, print_some, &length, NULL), PL_OK);
        collect(&process);
        assert_int_equal(process.tail_length, (size_t)kept);
        for (int k = 0; k < kept; ++k) {
            assert_int_equal(process.tail[k], 'a' + (length - kept + k) % 26);
        }
        pl_process_free(&process);
    }
}

static void print_mask(void *user, FILE *answer)
{
    (void)user;
    sigset_t mask;
    struct sigaction action;
    sigprocmask(SIG_BLOCK, NULL, &mask);
    sigaction(SIGINT, NULL, &action);
    fprintf(answer, "%d %d %d", sigismember(&mask, SIGTERM), action.sa_handler == SIG_DFL,
            getsid(0) == getpid());
}

static void test_run_starts_with_default_signals_and_session(void **state)
{
    (void)state;
    const pl_limits limits = {.timeout = 10};
    sigset_t blocked;
    sigset_t before;
    pl_process process;
    sigemptyset(&blocked);
    sigaddset(&blocked, SIGTERM);
    sigprocmask(SIG_BLOCK, &blocked, &before);
    signal(SIGINT, SIG_IGN);
    assert_int_equal(pl_process_start(&process, &limits, print_mask, NULL, NULL), PL_OK);
    collect(&process);
    signal(SIGINT, SIG_DFL);
    sigprocmask(SIG_SETMASK, &before, NULL);
    assert_string_equal(process.text.data, "0 1 1");
    pl_process_free(&process);
}

/* ---- Resident set size ---- */

/* Takes `bytes` in small blocks, touches and frees them; a last block above keeps the heap from
 * shrinking. */
static void use_heap(size_t bytes)
{
    enum { BLOCK = 4096 };
    size_t count = bytes / BLOCK;
    char **blocks = calloc(count + 1, sizeof *blocks);
    for (size_t i = 0; i <= count; ++i) {
        blocks[i] = malloc(BLOCK - 16);
        explicit_bzero(blocks[i], BLOCK - 16); /* which no compiler leaves out */
    }
    for (size_t i = 0; i < count; ++i) {
        free(blocks[i]);
    }
    free(blocks);
}

static void measure_growth(void *user, FILE *answer)
{
    size_t bytes = *(size_t *)user;
    /* Memory that was used and freed before neither counts nor hides memory that is taken later. */
    use_heap(2 * bytes);
    double baseline = pl_resident_set_baseline(0);
    use_heap(bytes);
    fprintf(answer, "%.17g", pl_resident_set_growth(0, baseline));
}

static void test_resident_set_growth_is_the_touched_peak(void **state)
{
    (void)state;
#if PL_SANITIZER
    skip(); /* it keeps freed memory */
#endif
    const pl_limits limits = {.timeout = 10};
    const size_t sizes[] = {8u << 20, 64u << 20};
    for (int i = 0; i < 2; ++i) {
        size_t bytes = sizes[i];
        pl_process process;
        assert_int_equal(pl_process_start(&process, &limits, measure_growth, &bytes, NULL), PL_OK);
        collect(&process);
        /* Linux keeps a process's counters in batches of 64 pages. */
        assert_close(strtod(process.text.data, NULL), (double)bytes, 1 << 20, 0);
        pl_process_free(&process);
    }
}

static void test_progress_is_the_part_of_steps_done(void **state)
{
    (void)state;
    static const long steps[] = {1, 4, 0};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = pl_scene_default();
        pl_run_watch watch = {.steps_done = steps[i]};
        pl_isolated_run run = {.def = {.scene = &scene, .watch = &watch}};
        scene.duration = (double)steps[i] * scene.dt;
        assert_close(pl_isolated_run_progress(&run), steps[i] > 0, 0, 0);
        if (steps[i] > 1) {
            watch.steps_done = 1;
            assert_close(pl_isolated_run_progress(&run), 1.0 / (double)steps[i], 0, 0);
        }
        pl_scene_free(&scene);
    }
}

/* --- one run in this process --- */

static pl_status count_report(const pl_run_result *finding, void *user, pl_error *error)
{
    (void)error;
    pl_run_result *kept = user;
    assert_non_null(finding->bodies);
    *kept = *finding;
    kept->bodies = NULL;
    return PL_OK;
}

static void run_profile(const char *spec, pl_run_result *finding, FILE *trajectory)
{
    pl_scene scene = pl_scene_default();
    pl_engine_choice choice;
    pl_error error = {.message = ""};
    pl_run_watch watch = {0};
    assert_int_equal(
        pl_scene_read_text(falling_scene, strlen(falling_scene), "scene", &scene, &error), PL_OK);
    assert_int_equal(pl_engine_choose(spec, &choice, &error), PL_OK);
    const pl_run_def def = {
        .scene = &scene, .choice = &choice, .trajectory = trajectory, .watch = &watch};
    assert_int_equal(pl_run_once(&def, count_report, finding, &error), PL_OK);
    assert_int_equal(watch.steps_done, finding->steps_done);
    pl_scene_free(&scene);
}

/* A wall that is hit: more bodies than one thread judges alone, with impacts and sliding. */
static void build_hit_wall(pl_scene *scene)
{
    static const char *const settings[] = {"rows=40", "columns=60", "duration=0.05"};
    double values[PL_MAX_PARAMS];
    const pl_scenario *scenario = pl_scenario_find("wall-collapse", NULL);
    assert_non_null(scenario);
    assert_int_equal(pl_scenario_values(scenario, settings, 3, values, NULL), PL_OK);
    assert_int_equal(pl_scenario_build(scenario, values, 0, scene, NULL), PL_OK);
}

static void test_referee_threads_change_no_metric(void **state)
{
    (void)state;
    static pl_run_result results[3];
    pl_scene scene = pl_scene_default();
    pl_engine_choice choice;
    build_hit_wall(&scene);
    assert_int_equal(pl_engine_choose("plumb:fast", &choice, NULL), PL_OK);
    for (int i = 0; i < 3; ++i) {
        pl_run_watch watch = {0};
        const pl_run_def def = {
            .scene = &scene, .choice = &choice, .referee_threads = i + 1, .watch = &watch};
        assert_int_equal(pl_run_once(&def, count_report, &results[i], NULL), PL_OK);
        assert_int_equal(results[i].outcome, PL_OUTCOME_OK);
        assert_int_equal(results[i].metrics.item[PL_METRIC_NATURAL_MAP].state, PL_METRIC_VALUE);
        for (int id = 0; id < PL_METRIC_COUNT; ++id) {
            const pl_metric *one = &results[0].metrics.item[id];
            const pl_metric *more = &results[i].metrics.item[id];
            if (!pl_metric_is(id, PL_TRAIT_MEASURED)) {
                assert_int_equal(more->state, one->state);
                assert_memory_equal(&more->value, &one->value, sizeof one->value);
                assert_memory_equal(&more->p99, &one->p99, sizeof one->p99);
                assert_string_equal(more->text, one->text);
            }
        }
    }
    pl_scene_free(&scene);
}

static void test_run_makes_and_shows_all_steps(void **state)
{
    (void)state;
    pl_run_result finding;
    run_profile(FAULTY ":good", &finding, NULL);
    assert_int_equal(finding.outcome, PL_OUTCOME_OK);
    assert_int_equal(finding.steps_done, 20);
    assert_int_equal(finding.metrics.item[PL_METRIC_STATE_HASH].state, PL_METRIC_TEXT);
}

static void test_the_same_run_has_the_same_state_hash(void **state)
{
    (void)state;
    pl_run_result first;
    pl_run_result second;
    run_profile(FAULTY ":good", &first, NULL);
    run_profile(FAULTY ":good", &second, NULL);
    assert_string_equal(first.metrics.item[PL_METRIC_STATE_HASH].text,
                        second.metrics.item[PL_METRIC_STATE_HASH].text);
}

static void test_trajectory_has_a_row_per_body_and_frame(void **state)
{
    (void)state;
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    pl_run_result finding;
    run_profile(FAULTY ":good", &finding, file);
    fclose(file);
    int lines = 0;
    for (const char *c = text; *c != '\0'; ++c) {
        lines += *c == '\n';
    }
    assert_int_equal(lines, 1 + 3 * 21);
    assert_contains(text, "time,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n");
    assert_contains(text, "\n0,\"b\",3,0,5,1,0,0,0,0,0,0,0,0,0\n");
    assert_contains(text, "\n0.01,\"a\",0,0,4.99");
    free(text);
}

static void test_engine_without_a_capability_is_named(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    pl_engine_info none = {.name = "none", .capabilities = 0};
    pl_error error = {.message = ""};
    assert_int_equal(
        pl_scene_read_text(falling_scene, strlen(falling_scene), "scene", &scene, &error), PL_OK);
    assert_int_equal(pl_needs_check(&scene, &none, &error), PL_UNSUPPORTED);
    assert_contains(error.message, "none lacks ");
    assert_contains(error.message, "sphere");
    none.capabilities = pl_scene_needs(&scene);
    assert_int_equal(pl_needs_check(&scene, &none, &error), PL_OK);
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plan_has_every_run_once_and_rotates_engines),
        cmocka_unit_test(test_bounds_depend_on_the_start_alone),
        cmocka_unit_test(test_scene_file_overrides_drop_invalid_expectations),
        cmocka_unit_test(test_progress_bar_leaves_space_for_names),
        cmocka_unit_test(test_an_answer_larger_than_a_pipe_arrives_whole),
        cmocka_unit_test(test_endless_output_is_killed_at_the_timeout),
        cmocka_unit_test(test_output_tail_is_the_end_of_the_output),
        cmocka_unit_test(test_run_starts_with_default_signals_and_session),
        cmocka_unit_test(test_progress_is_the_part_of_steps_done),
        cmocka_unit_test(test_resident_set_growth_is_the_touched_peak),
        cmocka_unit_test(test_referee_threads_change_no_metric),
        cmocka_unit_test(test_run_makes_and_shows_all_steps),
        cmocka_unit_test(test_the_same_run_has_the_same_state_hash),
        cmocka_unit_test(test_trajectory_has_a_row_per_body_and_frame),
        cmocka_unit_test(test_engine_without_a_capability_is_named),
    };
    return cmocka_run_group_tests_name("runner", tests, NULL, NULL);
}
