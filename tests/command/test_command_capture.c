/* plumb run --capture as a user meets it, and as the engine's tools read what it writes. */
#include "check.h"
#include "plumb_process.h"
#include "problem_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A directory for what is captured. */
typedef struct desk {
    char *directory;
} desk;

static int set_up(void **state)
{
    desk *d = malloc(sizeof *d);
    assert_non_null(d);
    d->directory = make_directory();
    *state = d;
    return 0;
}

static int tear_down(void **state)
{
    desk *d = *state;
    remove_directory(d->directory);
    free(d);
    return 0;
}

static plumb_output call(const desk *d, const char *const *arguments)
{
    return run_plumb(d->directory, arguments);
}

#define CALL(d, ...) call(d, (const char *const[]){__VA_ARGS__, NULL})

static void check(plumb_output output, int code, const char *out, const char *err)
{
    if (output.code != code) {
        print_error("exit code %d, expected %d\n%s%s", output.code, code, output.out, output.err);
    }
    assert_int_equal(output.code, code);
    assert_contains(output.out, out);
    assert_contains(output.err, err);
    free_output(&output);
}

static json_t *parse(const char *text)
{
    json_t *json = json_loads(text, 0, NULL);
    if (json == NULL) {
        fail_msg("no JSON: %s", text);
    }
    return json;
}

/* The problem in a file; the caller destroys it. */
static pe_contact_problem *read_problem(const char *path)
{
    char message[PROBLEM_MESSAGE_SIZE];
    pe_contact_problem *problem = problem_read_file(path, message);
    if (problem == NULL) {
        fail_msg("%s", message);
    }
    return problem;
}

static void test_run_captures_a_problem_and_its_source(void **state)
{
    desk *d = *state;
    char *path = path_in(d->directory, "captured.json");
    char *option = NULL;
    assert_true(asprintf(&option, "--capture=20:%s", path) >= 0);
    check(CALL(d, "run", "tower", "--set", "n=3", "--duration", "0.5", "--engine", "plumb", option),
          0, "30 of 30 steps", "");
    pe_contact_problem *problem = read_problem(path);
    char *text = read_text(path);
    json_t *json = parse(text);
    const json_t *source = json_object_get(json, "source");
    assert_int_equal(problem->body_count, 3);
    assert_int_equal(problem->manifold_count, 3);
    assert_string_equal(json_string_value(json_object_get(source, "scenario")), "tower");
    assert_string_equal(json_string_value(json_object_get(source, "engine")), "plumb");
    assert_true(json_number_value(json_object_get(source, "step")) == 20);
    assert_true(json_number_value(json_object_get(source, "islands")) == 1);
    assert_true(json_number_value(json_object_get(json_object_get(source, "params"), "n")) == 3);
    json_decref(json);
    free(text);
    pe_contact_problem_destroy(problem);
    free(option);
    free(path);
}

static void test_run_captures_every_island_if_path_has_braces(void **state)
{
    desk *d = *state;
    char *option = NULL, *scene = path_in(d->directory, "two.json");
    write_text(
        scene,
        "{ \"plumb_scene\": 1, \"duration\": 0.1, \"bodies\": [\n"
        "  { \"name\": \"floor\", \"shape\": { \"type\": \"plane\", \"normal\": [0, 0, 1], "
        "\"offset\": 0 } },\n"
        "  { \"name\": \"a\", \"mass\": 1, \"position\": [0, 0, 0.5], \"shape\": { \"type\": "
        "\"sphere\", \"radius\": 0.5 } },\n"
        "  { \"name\": \"b\", \"mass\": 2, \"position\": [3, 0, 0.5], \"shape\": { \"type\": "
        "\"box\", \"half_extents\": [0.5, 0.5, 0.5] } } ] }\n");
    assert_true(asprintf(&option, "--capture=2:%s/island{}.json", d->directory) >= 0);
    check(CALL(d, "run", scene, "--engine", "plumb", option), 0, "6 of 6 steps", "");
    for (int k = 1; k <= 2; ++k) {
        char *path = NULL;
        assert_true(asprintf(&path, "%s/island%d.json", d->directory, k) >= 0);
        pe_contact_problem *problem = read_problem(path);
        assert_int_equal(problem->body_count, 1);
        assert_true(problem->bodies[0].mass == k);
        pe_contact_problem_destroy(problem);
        free(path);
    }
    free(option);
    free(scene);
}

static void test_capturing_does_not_change_the_result(void **state)
{
    desk *d = *state;
    char *option = NULL;
    assert_true(asprintf(&option, "--capture=5:%s/x.json", d->directory) >= 0);
    json_t *hashes[2];
    for (int k = 0; k < 2; ++k) {
        plumb_output output = k == 0 ? CALL(d, "run", "slope-slide", "--duration", "0.5",
                                            "--engine", "plumb", "--json", "-")
                                     : CALL(d, "run", "slope-slide", "--duration", "0.5",
                                            "--engine", "plumb", "--json", "-", option);
        assert_int_equal(output.code, 0);
        json_t *json = parse(output.out);
        const json_t *metrics = json_object_get(json, "metrics");
        hashes[k] = json_deep_copy(json_object_get(metrics, "state_hash"));
        assert_non_null(hashes[k]);
        json_decref(json);
        free_output(&output);
    }
    assert_true(json_equal(hashes[0], hashes[1]));
    json_decref(hashes[0]);
    json_decref(hashes[1]);
    free(option);
}

static void test_run_reports_impossible_captures(void **state)
{
    desk *d = *state;
    check(CALL(d, "run", "tower", "--engine", "plumb", "--capture", "x.json"), 2, "", "STEP:FILE");
    check(CALL(d, "run", "tower", "--engine", "plumb", "--capture", "0:x.json"), 2, "",
          "STEP:FILE");
    check(CALL(d, "run", "tower", "--engine", "plumb", "--capture", "5:"), 2, "", "STEP:FILE");
    check(CALL(d, "run", "tower", "--engine", "plumb", "--duration", "0.1", "--capture",
               "7:/tmp/x.json"),
          2, "", "expected a step of 1 to 6, found 7");
    check(CALL(d, "run", "tower", "--engine", FAULTY ":good", "--capture", "1:/tmp/x.json"), 3, "",
          "does not give its contact problems");
    check(CALL(d, "run", "pile", "--engine", "plumb", "--duration", "0.1", "--capture",
               "1:/nowhere/x.json"),
          3, "", "nothing to capture: step 1 has no contact");
    check(CALL(d, "run", "tower", "--engine", "plumb", "--duration", "0.1", "--capture",
               "2:/nowhere/x.json"),
          3, "", "/nowhere/x.json");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_run_captures_a_problem_and_its_source),
        cmocka_unit_test(test_run_captures_every_island_if_path_has_braces),
        cmocka_unit_test(test_capturing_does_not_change_the_result),
        cmocka_unit_test(test_run_reports_impossible_captures),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
