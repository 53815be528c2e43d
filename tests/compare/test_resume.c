/* A comparison that is killed loses at most the run in progress, and --resume makes what is missing
 * and nothing else. Ctrl-C leaves whole lines and no process behind. */
#include "check.h"
#include "plumb_process.h"
#include "results/result.h"
#include "results/store.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* 4 repeats of two engines, of which one takes 0.4 s a run. */
enum { RUN_COUNT = 8 };

/* With an empty directory for the results. */
static int prepare(void **state)
{
    setup_workspace(state);
    const workspace *f = *state;
    return mkdir(f->out, 0777);
}

static pid_t start_compare(const workspace *f, const char *slow, const char *resume)
{
    const char *const arguments[] = {"compare", f->scene,   "--out", f->out,     "--repeat",
                                     "4",       "--engine", slow,    "--engine", FAULTY ":good",
                                     resume,    NULL};
    return start_plumb(f->directory, arguments);
}

static void pause_milliseconds(long milliseconds)
{
    const struct timespec time = {milliseconds / 1000, milliseconds % 1000 * 1000000};
    nanosleep(&time, NULL);
}

/* Complete lines of the file; an empty array when there is no file yet. */
static json_t *read_results(const workspace *f)
{
    json_t *results = NULL;
    pl_error error = {.message = ""};
    pl_status status = pl_results_read(f->results, &results, NULL, &error);
    if (status == PL_IO) {
        return json_array();
    }
    if (status != PL_OK) {
        print_error("%s\n", error.message);
    }
    assert_int_equal(status, PL_OK);
    json_t *own = pl_results_of_study(results, NULL);
    json_decref(results);
    return own;
}

/* Waits until every process that was left to this one has ended: forever, when one lives on. */
static void await_orphans(void)
{
    while (waitpid(-1, NULL, 0) > 0) {}
    assert_int_equal(errno, ECHILD);
}

/* No run twice, and everything of `before` still there as it was. */
static void check_kept(const json_t *before, const json_t *after)
{
    json_t *runs = json_object();
    size_t index;
    const json_t *result;
    json_array_foreach(after, index, result)
    {
        const char *run = result_text(result, "run");
        assert_null(json_object_get(runs, run));
        json_object_set_new(runs, run, json_true());
    }
    json_decref(runs);
    json_array_foreach(before, index, result)
    {
        assert_true(json_equal(result, json_array_get(after, index)));
    }
}

/* Resumes to the end: every run is there, and those of `before` (released here) as they were. */
static void check_resume(const workspace *f, const char *engine, json_t *before)
{
    plumb_output output = wait_plumb(f->directory, start_compare(f, engine, "--resume"));
    assert_int_equal(output.code, 0);
    free_output(&output);
    json_t *after = read_results(f);
    check_kept(before, after);
    assert_int_equal(json_array_size(after), RUN_COUNT);
    json_decref(before);
    json_decref(after);
}

/* Waits until a run has its result, at most a minute. */
static void await_result(const workspace *f)
{
    struct stat file;
    for (int i = 0; i < 6000 && (stat(f->results, &file) != 0 || file.st_size == 0); ++i) {
        pause_milliseconds(10);
    }
}

static void test_kill_and_resume_make_each_run_exactly_once(void **state)
{
    const workspace *f = *state;
    const long moments[] = {1, 30, 250, 450, 900};
    const size_t count = sizeof moments / sizeof moments[0];
    json_t *before = json_array();
    for (size_t i = 0; i < count; ++i) {
        pid_t pid = start_compare(f, FAULTY ":slow_print", "--resume");
        pause_milliseconds(moments[i]);
        if (i + 1 == count) { /* on a slow machine */
            await_result(f);
        }
        kill(pid, SIGKILL);
        plumb_output output = wait_plumb(f->directory, pid);
        assert_int_equal(output.code, 128 + SIGKILL);
        free_output(&output);
        await_orphans();
        json_t *after = read_results(f);
        check_kept(before, after);
        assert_true(json_array_size(after) < RUN_COUNT);
        json_decref(before);
        before = after;
    }
    assert_true(json_array_size(before) > 0);
    check_resume(f, FAULTY ":slow_print", before);
}

static void test_resume_of_a_complete_comparison_runs_nothing(void **state)
{
    const workspace *f = *state;
    for (int i = 0; i < 2; ++i) {
        check_resume(f, FAULTY ":exit", read_results(f));
    }
}

/* The signals that the process blocks, as a bit each. */
static unsigned long long blocked_signals(pid_t pid)
{
    char path[64], line[256];
    unsigned long long blocked = 0;
    snprintf(path, sizeof path, "/proc/%d/status", (int)pid);
    FILE *file = fopen(path, "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        if (strncmp(line, "SigBlk:", 7) == 0) {
            blocked = strtoull(line + 7, NULL, 16);
        }
    }
    if (file != NULL) {
        fclose(file);
    }
    return blocked;
}

/* Starts a comparison that hangs in a run, and waits until it has begun its runs: from there on it
 * handles SIGINT. */
static pid_t start_hanging(const workspace *f)
{
    pid_t pid = start_compare(f, FAULTY ":hang", "--resume");
    for (int i = 0; i < 6000 && (blocked_signals(pid) >> (SIGINT - 1) & 1) == 0; ++i) {
        pause_milliseconds(10);
    }
    pause_milliseconds(300);
    return pid;
}

static void check_interrupted(const workspace *f, int number)
{
    pid_t pid = start_hanging(f);
    kill(pid, number);
    plumb_output output = wait_plumb(f->directory, pid);
    assert_int_equal(output.code, 128 + number);
    assert_contains(output.err, "--resume goes on from there");
    assert_string_equal(output.out, "");
    free_output(&output);
    /* Nothing was left to this process, not even a dead one. */
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
    char *text = read_text(f->results);
    assert_true(text == NULL || text[0] == '\0' || text[strlen(text) - 1] == '\n');
    free(text);
    json_decref(read_results(f));
}

static void test_signals_kill_the_run_and_explain_resume(void **state)
{
    check_interrupted(*state, SIGINT);
    check_interrupted(*state, SIGTERM);
}

static void test_a_killed_comparison_takes_its_run_with_it(void **state)
{
    const workspace *f = *state;
    pid_t pid = start_hanging(f);
    kill(pid, SIGKILL);
    plumb_output output = wait_plumb(f->directory, pid);
    free_output(&output);
    int ended = 0;
    pid_t orphan = 0;
    for (int i = 0; i < 500 && orphan == 0; ++i) {
        pause_milliseconds(10);
        orphan = waitpid(-1, &ended, WNOHANG);
    }
    assert_true(orphan > 0);
    /* The process that watches over the run ends by itself, after the run. */
    assert_true(WIFEXITED(ended) || (WIFSIGNALED(ended) && WTERMSIG(ended) == SIGKILL));
}

static void test_results_are_replaced_with_force_alone(void **state)
{
    const workspace *f = *state;
    write_text(f->results, "anything\n");
    plumb_output output = wait_plumb(f->directory, start_compare(f, FAULTY ":good", NULL));
    assert_int_equal(output.code, 2);
    assert_contains(output.err, "--resume");
    assert_contains(output.err, "--force");
    free_output(&output);
    char *after = read_text(f->results);
    assert_string_equal(after, "anything\n");
    free(after);
    output = wait_plumb(f->directory, start_compare(f, FAULTY ":good", "--force"));
    assert_int_equal(output.code, 0);
    free_output(&output);
    json_t *results = read_results(f);
    assert_int_equal(json_array_size(results), RUN_COUNT / 2); /* the same engine twice is one */
    json_decref(results);
}

static void test_a_broken_line_stops_resume_and_stays(void **state)
{
    const workspace *f = *state;
    const char text[] = "{\"broken\n{\"schema\":\"plumb.result/1\",\"run\":\"a\"}\n";
    write_text(f->results, text);
    plumb_output output = wait_plumb(f->directory, start_compare(f, FAULTY ":good", "--resume"));
    assert_int_equal(output.code, 2);
    assert_contains(output.err, "results.jsonl:1:");
    free_output(&output);
    char *after = read_text(f->results);
    assert_string_equal(after, text);
    free(after);
}

int main(void)
{
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_kill_and_resume_make_each_run_exactly_once, prepare,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_resume_of_a_complete_comparison_runs_nothing, prepare,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_signals_kill_the_run_and_explain_resume, prepare,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_a_killed_comparison_takes_its_run_with_it, prepare,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_results_are_replaced_with_force_alone, prepare,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_a_broken_line_stops_resume_and_stays, prepare,
                                        teardown_workspace),
    };
    return cmocka_run_group_tests_name("resume", tests, NULL, NULL);
}
