/* plumb ensemble as a user meets it: its output, its refusals, and resuming a killed one. */
#include "check.h"
#include "plumb_process.h"
#include "results/store.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Runs "plumb ensemble A B C", as start_plumb_words reads it. Returns its process. */
static pid_t start(const workspace *f, const char *text)
{
    char *words = NULL;
    assert_true(asprintf(&words, "ensemble %s", text) >= 0);
    pid_t pid = start_plumb_words(f, words);
    free(words);
    return pid;
}

static plumb_output call(const workspace *f, const char *text)
{
    return wait_plumb(f->directory, start(f, text));
}

/* The output of a call that shall go well. */
static plumb_output well(const workspace *f, const char *text)
{
    plumb_output output = call(f, text);
    if (output.code != 0) {
        print_error("plumb ensemble %s: exit code %d\n%s", text, output.code, output.err);
    }
    assert_int_equal(output.code, 0);
    return output;
}

static json_t *read_results(const workspace *f)
{
    json_t *results = NULL;
    return pl_results_read(f->results, &results, NULL, NULL) == PL_OK ? results : json_array();
}

/* Distances are stated as multiples of their floors. */
static void check_ratios(const json_t *outcome)
{
    static const char *const names[][3] = {
        {"energy_distance", "energy_distance_floor", "energy_distance_ratio"},
        {"ks", "ks_floor", "ks_ratio"},
    };
    size_t index;
    const json_t *item;
    json_array_foreach(json_object_get(outcome, "comparisons"), index, item)
    {
        for (int k = 0; k < 2; ++k) {
            const double floor = json_number_value(json_object_get(item, names[k][1]));
            const json_t *ratio = json_object_get(item, names[k][2]);
            if (floor > 0) {
                assert_true(json_is_number(ratio));
                assert_close(json_number_value(ratio) * floor,
                             json_number_value(json_object_get(item, names[k][0])), 0, 1e-12);
            } else {
                assert_true(json_is_null(ratio));
            }
        }
    }
}

static json_t *read_outcome(const workspace *f)
{
    char *path = path_in(f->out, "ensemble.json");
    json_t *outcome = json_load_file(path, 0, NULL);
    free(path);
    assert_non_null(outcome);
    assert_string_equal(result_text(outcome, "schema"), "plumb.ensemble/1");
    check_ratios(outcome);
    return outcome;
}

static bool exists(const workspace *f, const char *name)
{
    char *path = path_in(f->out, name);
    bool there = access(path, F_OK) == 0;
    free(path);
    return there;
}

static json_int_t integer(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    assert_true(json_is_integer(value));
    return json_integer_value(value);
}

static void test_bad_options_exit_2_and_write_nothing(void **state)
{
    static const char *const cases[][2] = {
        {"@ --engine % --members 1", "--members takes an integer, 2 to 1000; found \"1\""},
        {"@ --engine % --members many", "--members takes an integer"},
        {"pile --engine % --engine %:nan --members 5",
         "--members 5: with 5 members no difference could be significant; at least 6 are needed "
         "for 7 comparisons at 5 %"},
        {"@ --engine % --jobs 0", "--jobs takes an integer"},
        {"@ --engine % --membrs 4", "did you mean --members?"},
        {"@ --engine % --seed -1", "--seed takes an integer"},
        {"@ --engine % --timeout 0", "--timeout takes seconds"},
        {"--suite chaotik --engine %", "chaotic"},
        {"pyle --engine %", "pile"},
        {"@ --engine %:god", "good"},
        {"pile --engine % --against friction", "--against takes NAME=VALUE"},
        {"pile --engine % --against =3", "--against takes NAME=VALUE"},
        {"pile --engine % --against ,", "--against takes NAME=VALUE"},
        {"pile --engine % --against frction=0.4", "did you mean friction?"},
        {"pile --engine % --against friction=-1", "friction"},
        {"pile --engine % --set n=0", "n: expected"},
        {"@ --engine % --against friction=0.4", "no chosen scenario has the parameter"},
        {"- --engine %", "give a file"},
        {"./none.json --engine %", "./none.json"},
    };
    const workspace *f = *state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        plumb_output output = call(f, cases[i][0]);
        if (output.code != 2) {
            print_error("plumb ensemble %s: exit code %d\n%s", cases[i][0], output.code,
                        output.err);
        }
        assert_int_equal(output.code, 2);
        assert_string_equal(output.out, "");
        assert_contains(output.err, cases[i][1]);
        free_output(&output);
    }
    assert_int_not_equal(access(f->out, F_OK), 0);
    assert_int_not_equal(access("ensemble", F_OK), 0);
}

static void test_help_has_examples(void **state)
{
    plumb_output output = well(*state, "--help");
    assert_contains(output.out, "Examples:");
    assert_contains(output.out, "--against");
    free_output(&output);
}

static void test_a_scene_in_which_nothing_moves_is_refused(void **state)
{
    const workspace *f = *state;
    static const char still[] =
        "{ \"plumb_scene\": 1, \"name\": \"still\", \"gravity\": [0, 0, -9.81], \"dt\": 0.01,\n"
        "  \"duration\": 0.2, \"materials\": { \"wood\": { \"friction\": 0.5, \"restitution\": 0 } "
        "},\n"
        "  \"bodies\": [ { \"name\": \"floor\", \"static\": true, \"material\": \"wood\",\n"
        "    \"shape\": { \"type\": \"plane\", \"normal\": [0, 0, 1], \"offset\": 0 } } ] }\n";
    write_text(f->scene, still);
    plumb_output output = call(f, "@ --engine %:good --out #");
    assert_int_equal(output.code, 2);
    assert_contains(output.err, "nothing in the scene can move");
    free_output(&output);
    write_text(f->scene, falling_scene);
}

static void test_every_member_row_has_a_shared_jitter(void **state)
{
    const workspace *f = *state;
    plumb_output output = well(
        f, "@ --engine plumb --engine %:good --members 6 --seed 9 --out # --keep-trajectories");
    json_t *results = read_results(f), *outcome = read_outcome(f);
    assert_int_equal(json_array_size(results), 12);
    json_t *hashes = json_object(); /* member -> hash of its scene */
    size_t index;
    const json_t *row;
    json_array_foreach(results, index, row)
    {
        char member[16];
        snprintf(member, sizeof member, "%d", (int)integer(row, "member"));
        assert_int_equal(integer(row, "seed"), 9);
        assert_string_equal(result_text(row, "outcome"), "ok");
        const char *known = json_string_value(json_object_get(hashes, member));
        if (known != NULL) {
            assert_string_equal(result_text(row, "scene_hash"), known);
        }
        json_object_set(hashes, member, json_object_get(row, "scene_hash"));
    }
    assert_int_equal(json_object_size(hashes), 6);
    assert_string_not_equal(json_string_value(json_object_get(hashes, "0")),
                            json_string_value(json_object_get(hashes, "1")));
    assert_int_equal(integer(outcome, "members"), 6);
    assert_int_equal(json_array_size(json_object_get(outcome, "ensembles")), 2);
    const json_t *first = json_array_get(json_object_get(outcome, "ensembles"), 0);
    assert_int_equal(json_array_size(json_object_get(first, "runs")), 6);
    assert_contains(output.out,
                    "Ensembles, compared by their end states\n\nEach ensemble has 6 members.");
    assert_absent(output.out, "# Ensembles");
    assert_absent(output.out, "|---");
    assert_true(exists(f, "ensemble.md") && exists(f, "trajectories"));
    json_decref(hashes);
    json_decref(results);
    json_decref(outcome);
    free_output(&output);
}

/* Two spheres fall freely, so that members keep their distance: it never reaches the horizon, and
 * after a second run is still known, though the trajectories are gone. */
static void test_trajectories_go_and_the_horizon_stays(void **state)
{
    const workspace *f = *state;
    for (int round = 0; round < 2; ++round) {
        plumb_output output = well(f, "@ --engine %:good --members 2 --out # --resume");
        json_t *outcome = read_outcome(f);
        const json_t *first = json_array_get(json_object_get(outcome, "ensembles"), 0);
        const json_t *horizon = json_object_get(first, "horizon");
        assert_true(json_is_null(json_object_get(horizon, "time")));
        assert_contains(result_text(horizon, "reason"), "not passed within 0.2 s");
        assert_close(json_number_value(json_object_get(horizon, "threshold")), 0.01, 1e-12, 0);
        assert_false(exists(f, "trajectories"));
        json_decref(outcome);
        free_output(&output);
    }
}

static void test_json_on_standard_output_is_the_file(void **state)
{
    const workspace *f = *state;
    plumb_output output = well(f, "@ --engine %:good --members 2 --out # --json -");
    json_t *printed = json_loads(output.out, 0, NULL), *outcome = read_outcome(f);
    assert_non_null(printed);
    assert_true(json_equal(printed, outcome));
    json_decref(printed);
    json_decref(outcome);
    free_output(&output);
}

static void test_engines_that_fail_are_counted(void **state)
{
    const workspace *f = *state;
    plumb_output output = well(f, "@ --engine %:good --engine %:nan --engine %:abort --members 6 "
                                  "--out #");
    json_t *outcome = read_outcome(f);
    const json_t *ensembles = json_object_get(outcome, "ensembles");
    const json_t *nan_one = result_of(ensembles, "faulty:nan");
    assert_int_equal(integer(json_object_get(nan_one, "invariants"), "not_finite"), 6);
    assert_int_equal(integer(json_object_get(nan_one, "outcomes"), "nonfinite"), 6);
    const json_t *aborted = result_of(ensembles, "faulty:abort");
    assert_int_equal(integer(json_object_get(aborted, "outcomes"), "crashed"), 6);
    const json_t *good = result_of(ensembles, "faulty:good");
    assert_int_equal(integer(json_object_get(good, "outcomes"), "ok"), 6);
    assert_int_equal(integer(json_object_get(good, "invariants"), "fell_through"), 0);
    const json_t *spread = json_object_get(json_object_get(aborted, "observables"), "spread_x");
    assert_int_equal(json_array_size(json_object_get(spread, "values")), 0);
    assert_contains(output.out, "6 crashed");
    json_decref(outcome);
    free_output(&output);
}

/* The faulty engine knows no contacts: after 1.2 s its spheres are beneath the plane. */
static void test_bodies_beyond_a_plane_are_counted(void **state)
{
    const workspace *f = *state;
    plumb_output output =
        well(f, "@ --engine %:good --engine plumb --duration 1.2 --members 6 --out #");
    json_t *outcome = read_outcome(f);
    const json_t *ensembles = json_object_get(outcome, "ensembles");
    const json_t *good = result_of(ensembles, "faulty:good");
    assert_int_equal(integer(json_object_get(good, "invariants"), "fell_through"), 6);
    const json_t *plumb = result_of(ensembles, "plumb:default");
    assert_int_equal(integer(json_object_get(plumb, "invariants"), "fell_through"), 0);
    assert_int_equal(integer(json_object_get(plumb, "invariants"), "energy_grew"), 0);
    json_decref(outcome);
    free_output(&output);
}

static void test_all_unsupported_exits_4(void **state)
{
    plumb_output output = call(*state, "@ --engine %:mass --members 2 --out #");
    assert_int_equal(output.code, 4);
    free_output(&output);
}

/* Other settings have members of their own; a reference has the members of what it refers to. */
static void test_other_settings_and_references_are_separate_ensembles(void **state)
{
    const workspace *f = *state;
    plumb_output output =
        well(f, "pile --set n=2 --duration 0.1 --engine plumb --members 6 --out # "
                "--against itself --against n=3,friction=0.4 --converged");
    json_t *results = read_results(f), *outcome = read_outcome(f);
    const json_t *ensembles = json_object_get(outcome, "ensembles");
    static const char *const names[] = {"plumb:default", "plumb:default [itself]",
                                        "plumb:default [n=3,friction=0.4]",
                                        "plumb:default@converged"};
    assert_int_equal(json_array_size(results), 24);
    assert_int_equal(json_array_size(ensembles), 4);
    for (size_t i = 0; i < 4; ++i) {
        const json_t *ensemble = json_array_get(ensembles, i);
        assert_string_equal(result_text(ensemble, "name"), names[i]);
        assert_close(json_number_value(json_object_get(ensemble, "dt")),
                     i == 3 ? 1.0 / 60 / 16 : 1.0 / 60, 0, 1e-15);
    }
    int members[18] = {0}, finer = 0;
    size_t index;
    const json_t *row;
    json_array_foreach(results, index, row)
    {
        const json_t *params = json_object_get(row, "params");
        const bool third = integer(params, "n") == 3;
        assert_true(third == (integer(row, "member") >= 12));
        assert_close(json_number_value(json_object_get(params, "friction")), third ? 0.4 : 0.5, 0,
                     0);
        members[integer(row, "member")] += 1;
        finer += json_number_value(json_object_get(params, "dt")) < 1.0 / 900;
    }
    assert_int_equal(finer, 6);
    for (int i = 0; i < 18; ++i) {
        assert_int_equal(members[i], i < 6 ? 2 : 1);
    }
    json_decref(results);
    json_decref(outcome);
    free_output(&output);
}

static void test_references_have_more_iterations_if_supported(void **state)
{
    const workspace *f = *state;
    static const struct {
        const char *engine, *label;
        int iterations;
    } cases[] = {{"bullet:si", "bullet:si@converged", 80},
                 {"ode:quick,iterations=5", "ode:quick,iterations=5@converged", 40},
                 {"ode:dantzig", "ode:dantzig@converged", 20}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char text[160];
        snprintf(
            text, sizeof text,
            "pile --set n=2 --duration 0.1 --engine %s --members 6 --out # --converged --force",
            cases[i].engine);
        plumb_output output = call(f, text);
        if (output.code == 4) { /* this build lacks the engine */
            free_output(&output);
            continue;
        }
        assert_int_equal(output.code, 0);
        free_output(&output);
        json_t *results = read_results(f);
        size_t index, found = 0;
        const json_t *row;
        json_array_foreach(results, index, row)
        {
            if (strcmp(result_text(row, "label"), cases[i].label) == 0) {
                found += 1;
                assert_string_equal(result_text(row, "outcome"), "ok");
                assert_int_equal(integer(json_object_get(row, "settings"), "iterations"),
                                 cases[i].iterations);
            }
        }
        assert_int_equal(found, 6);
        json_decref(results);
    }
}

static void pause_milliseconds(long milliseconds)
{
    const struct timespec time = {milliseconds / 1000, milliseconds % 1000 * 1000000};
    nanosleep(&time, NULL);
}

/* What a run found, by its hash, without what depends on when and how fast it was made. */
static json_t *found_by_run(const json_t *results)
{
    json_t *by_run = json_object();
    size_t index;
    const json_t *row;
    json_array_foreach(results, index, row)
    {
        json_t *found = json_deep_copy(row);
        json_t *metrics = json_object_get(found, "metrics");
        json_object_del(found, "started");
        json_object_del(found, "command");
        const char *name;
        json_t *metric;
        void *next;
        json_object_foreach_safe(metrics, next, name, metric)
        {
            if (json_is_false(json_object_get(metric, "deterministic"))) {
                json_object_del(metrics, name);
            }
        }
        const char *run = result_text(row, "run");
        assert_null(json_object_get(by_run, run)); /* no run twice */
        json_object_set_new(by_run, run, found);
    }
    return by_run;
}

static void await_orphans(void)
{
    while (waitpid(-1, NULL, 0) > 0) {}
}

static void test_killed_and_resumed_study_has_equal_rows(void **state)
{
    const workspace *f = *state;
    static const char whole[] = "wall-collapse --set rows=3 --set columns=4 --duration 1 "
                                "--engine plumb --engine plumb:fast --members 6 --jobs 2 --out #";
    plumb_output output = well(f, whole);
    free_output(&output);
    json_t *results = read_results(f), *expected = found_by_run(results);
    json_t *outcome = read_outcome(f);
    assert_int_equal(json_object_size(expected), 12);
    json_decref(results);
    char *file = path_in(f->out, "ensemble.json");
    remove(f->results);
    remove(file);
    free(file);

    char resumed[sizeof whole + 16];
    snprintf(resumed, sizeof resumed, "%s --resume", whole);
    size_t before = 0;
    for (long wait = 40; before < 12; wait += 40) {
        pid_t pid = start(f, resumed);
        pause_milliseconds(wait);
        kill(pid, SIGKILL);
        output = wait_plumb(f->directory, pid);
        free_output(&output);
        await_orphans();
        results = read_results(f);
        assert_true(json_array_size(results) >= before);
        before = json_array_size(results);
        json_decref(results);
    }
    output = well(f, resumed);
    free_output(&output);
    results = read_results(f);
    json_t *found = found_by_run(results), *again = read_outcome(f);
    assert_true(json_equal(found, expected));
    assert_true(json_equal(again, outcome));
    json_decref(results);
    json_decref(found);
    json_decref(again);
    json_decref(expected);
    json_decref(outcome);
}

static void test_more_members_are_added_to_those_there(void **state)
{
    const workspace *f = *state;
    plumb_output output = well(f, "@ --engine %:good --members 2 --out #");
    free_output(&output);
    json_t *two = read_results(f);
    output = well(f, "@ --engine %:good --members 4 --out # --resume");
    free_output(&output);
    json_t *four = read_results(f), *outcome = read_outcome(f);
    assert_int_equal(json_array_size(four), 4);
    for (size_t i = 0; i < 2; ++i) {
        assert_true(json_equal(json_array_get(four, i), json_array_get(two, i)));
    }
    const json_t *horizon =
        json_object_get(json_array_get(json_object_get(outcome, "ensembles"), 0), "horizon");
    assert_contains(result_text(horizon, "reason"), "2 of 4 members");
    json_decref(two);
    json_decref(four);
    json_decref(outcome);
}

int main(void)
{
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_bad_options_exit_2_and_write_nothing, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_help_has_examples, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_a_scene_in_which_nothing_moves_is_refused,
                                        setup_workspace, teardown_workspace),
        cmocka_unit_test_setup_teardown(test_every_member_row_has_a_shared_jitter, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_trajectories_go_and_the_horizon_stays, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_json_on_standard_output_is_the_file, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_engines_that_fail_are_counted, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_bodies_beyond_a_plane_are_counted, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_all_unsupported_exits_4, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_other_settings_and_references_are_separate_ensembles,
                                        setup_workspace, teardown_workspace),
        cmocka_unit_test_setup_teardown(test_references_have_more_iterations_if_supported,
                                        setup_workspace, teardown_workspace),
        cmocka_unit_test_setup_teardown(test_killed_and_resumed_study_has_equal_rows,
                                        setup_workspace, teardown_workspace),
        cmocka_unit_test_setup_teardown(test_more_members_are_added_to_those_there, setup_workspace,
                                        teardown_workspace),
    };
    return cmocka_run_group_tests_name("ensemble", tests, NULL, NULL);
}
