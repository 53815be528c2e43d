/* Shards: which one a process is, what it gets, and how their results become one. */
#include "check.h"
#include "plumb_process.h"
#include "results/store.h"
#include "studies/sweep/shard.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const variables[] = {"SLURM_ARRAY_TASK_ID",
                                        "SLURM_ARRAY_TASK_COUNT",
                                        "SLURM_ARRAY_TASK_MIN",
                                        "SLURM_ARRAY_TASK_STEP",
                                        "OMPI_COMM_WORLD_RANK",
                                        "OMPI_COMM_WORLD_SIZE",
                                        "PMIX_RANK",
                                        "PMIX_SIZE",
                                        "PMI_RANK",
                                        "PMI_SIZE"};

/* The environment is "NAME=VALUE NAME=VALUE..." of those variables and no other. */
static pl_status read_environment(const char *text, pl_shard *shard, bool *found, pl_error *error)
{
    char copy[256];
    snprintf(copy, sizeof copy, "%s", text);
    for (size_t i = 0; i < sizeof variables / sizeof variables[0]; ++i) {
        unsetenv(variables[i]);
    }
    for (char *rest = copy, *part; (part = strsep(&rest, " ")) != NULL;) {
        char *equals = strchr(part, '=');
        if (equals != NULL) {
            *equals = '\0';
            setenv(part, equals + 1, 1);
        }
    }
    return pl_shard_from_environment(shard, found, error);
}

static void check_environment(const char *text, int index, int count)
{
    pl_shard shard;
    bool found = false;
    pl_error error = {.message = ""};
    if (read_environment(text, &shard, &found, &error) != PL_OK) {
        fail_msg("%s: %s", text, error.message);
    }
    assert_int_equal(found, count > 0);
    assert_int_equal(shard.index, index);
    assert_int_equal(shard.count, count > 0 ? count : 1);
}

static void test_the_environment_says_which_shard(void **state)
{
    (void)state;
    check_environment("", 0, 0);
    check_environment("SLURM_ARRAY_TASK_ID=3", 0, 0);
    check_environment("SLURM_ARRAY_TASK_ID=1 SLURM_ARRAY_TASK_COUNT=4 SLURM_ARRAY_TASK_MIN=1", 0,
                      4);
    check_environment("SLURM_ARRAY_TASK_ID=0 SLURM_ARRAY_TASK_COUNT=4 SLURM_ARRAY_TASK_MIN=0", 0,
                      4);
    check_environment("SLURM_ARRAY_TASK_ID=4 SLURM_ARRAY_TASK_COUNT=4", 3, 4);
    check_environment("SLURM_ARRAY_TASK_ID=15 SLURM_ARRAY_TASK_COUNT=3 SLURM_ARRAY_TASK_MIN=5 "
                      "SLURM_ARRAY_TASK_STEP=5",
                      2, 3);
    check_environment("OMPI_COMM_WORLD_RANK=0 OMPI_COMM_WORLD_SIZE=2", 0, 2);
    check_environment("OMPI_COMM_WORLD_RANK=1 OMPI_COMM_WORLD_SIZE=2 PMIX_RANK=1", 1, 2);
    check_environment("PMIX_RANK=6 PMIX_SIZE=7", 6, 7);
    check_environment("PMI_RANK=2 PMI_SIZE=3", 2, 3);
    check_environment("PMIX_RANK=6", 0, 0);
    /* Ranks within a task of an array. */
    check_environment("SLURM_ARRAY_TASK_ID=2 SLURM_ARRAY_TASK_COUNT=3 OMPI_COMM_WORLD_RANK=3 "
                      "OMPI_COMM_WORLD_SIZE=4",
                      7, 12);
}

static void test_an_environment_without_sense_is_refused(void **state)
{
    (void)state;
    static const char *const wrong[][2] = {
        {"SLURM_ARRAY_TASK_ID=7 SLURM_ARRAY_TASK_COUNT=3 SLURM_ARRAY_TASK_MIN=1",
         "use an array without gaps, or give --shard"},
        {"SLURM_ARRAY_TASK_ID=0 SLURM_ARRAY_TASK_COUNT=3 SLURM_ARRAY_TASK_MIN=1", "none of 3 ids"},
        {"SLURM_ARRAY_TASK_ID=x SLURM_ARRAY_TASK_COUNT=3", "SLURM_ARRAY_TASK_ID is \"x\""},
        {"SLURM_ARRAY_TASK_ID=1 SLURM_ARRAY_TASK_COUNT=0", "none of 0 ids"},
        {"OMPI_COMM_WORLD_RANK=2 OMPI_COMM_WORLD_SIZE=2", "OMPI_COMM_WORLD_RANK is 2"},
        {"PMIX_RANK=-1 PMIX_SIZE=2", "PMIX_RANK is -1"},
        {"PMIX_RANK=1 PMIX_SIZE=", "PMIX_SIZE is \"\""},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        pl_shard shard;
        bool found;
        pl_error error = {.message = ""};
        assert_int_equal(read_environment(wrong[i][0], &shard, &found, &error), PL_BAD_INPUT);
        assert_contains(error.message, wrong[i][1]);
    }
}

static void test_a_shard_is_given_from_one(void **state)
{
    (void)state;
    pl_shard shard;
    assert_int_equal(pl_shard_parse("1/4", &shard, NULL), PL_OK);
    assert_int_equal(shard.index, 0);
    assert_int_equal(shard.count, 4);
    assert_int_equal(pl_shard_parse("1000000/1000000", &shard, NULL), PL_OK);
    char *folder = pl_shard_folder("out", (pl_shard){.index = 0, .count = 4});
    assert_string_equal(folder, "out/shard-1-of-4");
    free(folder);
    static const char *const wrong[] = {"0/4", "5/4", "1/0", "-1/4", "1",     "1/",        "/4",
                                        "a/4", "1/b", "",    "1/4x", "1.5/4", "1/1000001", " 1/4"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        pl_error error = {.message = ""};
        assert_int_equal(pl_shard_parse(wrong[i], &shard, &error), PL_BAD_INPUT);
        assert_contains(error.message, "--shard takes I/N");
    }
}

static void check_dealing(int count, int problems, int configurations)
{
    long shares[64] = {0};
    int last = 0;
    for (int p = 0; p < problems; ++p) {
        for (int c = 0; c < configurations; ++c) {
            const int shard = pl_shard_of_point(count, problems, configurations, p, c);
            assert_in_range(shard, 0, count - 1);
            shares[shard] += 1;
            if (problems >= count) {
                assert_int_equal(shard, pl_shard_of_point(count, problems, configurations, p, 0));
            } else {
                assert_true(shard >= last);
            }
            last = shard;
        }
    }
    /* As even as whole problems, or whole points, allow. */
    const long unit = problems >= count ? configurations : 1;
    long least = shares[0], most = shares[0];
    for (int i = 1; i < count; ++i) {
        least = shares[i] < least ? shares[i] : least;
        most = shares[i] > most ? shares[i] : most;
    }
    assert_true(most - least <= unit);
}

static void test_points_are_dealt_evenly(void **state)
{
    (void)state;
    for (int count = 1; count <= 12; ++count) {
        for (int problems = 1; problems <= 15; ++problems) {
            for (int configurations = 1; configurations <= 7; ++configurations) {
                check_dealing(count, problems, configurations);
            }
        }
    }
}

/* A result with one deterministic metric and one that is none. */
static void write_results(const char *directory, const char *name, const char *const *lines)
{
    char *path = path_in(directory, name);
    char text[4096] = "";
    for (int i = 0; lines[i] != NULL; ++i) {
        char run[8], outcome[16];
        double drift = 0, time = 0;
        assert_int_equal(sscanf(lines[i], "%7s %15s %lf %lf", run, outcome, &drift, &time), 4);
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used,
                 "{\"schema\":\"plumb.result/1\",\"run\":\"%s\",\"outcome\":\"%s\",\"scenario\":"
                 "\"tower\",\"label\":\"ode:quick\",\"repeat\":0,\"metrics\":{\"drift\":{\"value\":"
                 "%g,\"deterministic\":true},\"time_per_step\":{\"value\":%g,\"deterministic\":"
                 "false}}}\n",
                 run, outcome, drift, time);
    }
    write_text(path, text);
    free(path);
}

#define LINES(...) ((const char *const[]){__VA_ARGS__, NULL})

/* Merges the paths in the workspace and returns the warnings, to free. */
static char *merge_paths(const char *directory, const char *const *names, pl_merge *merge)
{
    char *warnings = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&warnings, &length);
    *merge = pl_merge_begin();
    for (int i = 0; names[i] != NULL; ++i) {
        char *path = path_in(directory, names[i]);
        pl_error error = {.message = ""};
        if (pl_merge_add(merge, path, stream, &error) != PL_OK) {
            fail_msg("%s", error.message);
        }
        free(path);
    }
    fclose(stream);
    return warnings;
}

static void test_each_run_is_merged_once(void **state)
{
    const workspace *f = *state;
    pl_merge merge;
    write_results(f->directory, "a", LINES("r1 ok 1 0.5", "r2 ok 2 0.5"));
    write_results(f->directory, "b", LINES("r2 ok 2 0.7", "r3 ok 3 0.5", "r1 ok 1 0.1"));
    char *warnings = merge_paths(f->directory, LINES("a", "b"), &merge);
    assert_string_equal(warnings, "");
    assert_int_equal(merge.files, 2);
    assert_int_equal(merge.doubles, 2);
    assert_int_equal(merge.differing, 0);
    assert_int_equal(json_array_size(merge.results), 3);
    for (int i = 0; i < 3; ++i) {
        const json_t *row = json_array_get(merge.results, (size_t)i);
        assert_string_equal(result_text(row, "run"), ((const char *[]){"r1", "r2", "r3"})[i]);
        const json_t *time = json_object_get(json_object_get(row, "metrics"), "time_per_step");
        assert_close(json_number_value(json_object_get(time, "value")), 0.5, 0, 0);
    }
    free(warnings);
    pl_merge_free(&merge);
}

static void test_doubles_that_differ_are_said(void **state)
{
    const workspace *f = *state;
    pl_merge merge;
    write_results(f->directory, "a", LINES("r1 ok 1.25 0.5", "r2 ok 2 0.5"));
    write_results(f->directory, "b", LINES("r1 ok 1.5 0.5", "r2 timeout 2 0.5"));
    char *warnings = merge_paths(f->directory, LINES("a", "b"), &merge);
    assert_contains(warnings, "run r1, tower on ode:quick, repeat 0, was made twice and differs: "
                              "drift 1.25, then 1.5\n");
    assert_contains(warnings, "run r2, tower on ode:quick, repeat 0, was made twice and differs: "
                              "outcome ok, then timeout\n");
    assert_int_equal(merge.doubles, 2);
    assert_int_equal(merge.differing, 2);
    free(warnings);
    pl_merge_free(&merge);
}

static void test_folder_results_include_its_shards(void **state)
{
    const workspace *f = *state;
    pl_merge merge;
    static const char *const folders[] = {
        "all",       "all/shard-2-of-10",    "all/shard-10-of-10", "all/shard-1-of-10",
        "all/other", "all/shard-3-of-10.old"};
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; ++i) {
        char *path = path_in(f->directory, folders[i]);
        assert_int_equal(pl_make_directories(path, NULL), PL_OK);
        free(path);
    }
    write_results(f->directory, "all/shard-2-of-10/results.jsonl", LINES("r2 ok 1 1"));
    write_results(f->directory, "all/shard-10-of-10/results.jsonl", LINES("r3 ok 1 1"));
    write_results(f->directory, "all/other/results.jsonl", LINES("r4 ok 1 1"));
    write_results(f->directory, "all/shard-3-of-10.old/results.jsonl", LINES("r5 ok 1 1"));
    write_results(f->directory, "all/results.jsonl", LINES("r1 ok 1 1"));
    char *warnings = merge_paths(f->directory, LINES("all"), &merge);
    assert_int_equal(merge.files, 3);
    assert_int_equal(json_array_size(merge.results), 3);
    for (size_t i = 0; i < 3; ++i) {
        assert_string_equal(result_text(json_array_get(merge.results, i), "run"),
                            ((const char *[]){"r1", "r2", "r3"})[i]);
    }
    free(warnings);
    pl_merge_free(&merge);
}

static void test_what_is_no_result_is_refused(void **state)
{
    const workspace *f = *state;
    pl_merge merge = pl_merge_begin();
    pl_error error = {.message = ""};
    char *empty = path_in(f->directory, "empty");
    assert_int_equal(pl_make_directories(empty, NULL), PL_OK);
    assert_int_equal(pl_merge_add(&merge, empty, NULL, &error), PL_BAD_INPUT);
    assert_contains(error.message, "has neither a results.jsonl nor shard-*-of-*");
    assert_int_equal(pl_merge_add_any(&merge, empty, &error), PL_OK);
    assert_int_equal(pl_merge_add(&merge, f->scene, NULL, &error), PL_BAD_INPUT);
    char *missing = path_in(f->directory, "missing");
    assert_int_equal(pl_merge_add(&merge, missing, NULL, &error), PL_IO);
    assert_int_equal(pl_merge_add_any(&merge, missing, &error), PL_OK);
    assert_int_equal(json_array_size(merge.results), 0);
    free(empty);
    free(missing);
    pl_merge_free(&merge);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_environment_says_which_shard),
        cmocka_unit_test(test_an_environment_without_sense_is_refused),
        cmocka_unit_test(test_a_shard_is_given_from_one),
        cmocka_unit_test(test_points_are_dealt_evenly),
        cmocka_unit_test_setup_teardown(test_each_run_is_merged_once, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_doubles_that_differ_are_said, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_folder_results_include_its_shards, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_what_is_no_result_is_refused, setup_workspace,
                                        teardown_workspace),
    };
    return cmocka_run_group_tests_name("sweep shard", tests, NULL, NULL);
}
