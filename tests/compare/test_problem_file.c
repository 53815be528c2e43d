/* Files of contact problems: every bit survives, and what is wrong with a file is said with its
 * line, column and field. Each bad case changes a good file at one place and marks with an @, which
 * is taken out, where the fault is: so the expected line and column are counted here. */
#include "check.h"
#include "contact_problem_for_tests.h"
#include "plumb_process.h"
#include "studies/solve/problem_file.h"
#include "text_fault.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char sample[] =
    "{ \"schema\": \"plumb.contact_problem/1\",\n"
    "  \"source\": { \"scenario\": \"héros\", \"step\": 60 },\n"
    "  \"bodies\": [\n"
    "    { \"mass\": 1, \"inertia\": [0.1, 0, 0, 0.1, 0, 0.1],\n"
    "      \"free_velocity\": [0, 0, -0.1635, 0, 0, 0] },\n"
    "    { \"mass\": 2, \"inertia\": [0.2, 0.01, 0, 0.2, 0, 0.3],\n"
    "      \"free_velocity\": [1, 0, -0.1635, 0, 0, 0] } ],\n"
    "  \"manifolds\": [\n"
    "    { \"a\": -1, \"b\": 0, \"friction\": 0.5, \"frame\": [0, 0, 1, 1, 0, 0, 0, 1, 0],\n"
    "      \"arm_b\": [0, 0, -0.5],\n"
    "      \"points\": [ { \"offset\": [0, 0.5, 0.5], \"bias\": 0 },\n"
    "                  { \"offset\": [0, -0.5, 0.5], \"bias\": 0 } ] },\n"
    "    { \"a\": 0, \"b\": 1, \"friction\": 0, \"frame\": [0, 0, 1, 1, 0, 0, 0, 1, 0],\n"
    "      \"arm_a\": [0, 0, 0.5], \"arm_b\": [0, 0, -0.25],\n"
    "      \"points\": [ { \"offset\": [0, 0, 0], \"bias\": 0.25, \"impulse\": [0.1, -0.02, 0] } ] "
    "} ] }\n";

static pe_contact_problem *read_problem(const char *text, json_t **source)
{
    pe_contact_problem *problem = NULL;
    pl_error error;
    if (pl_problem_read_text(text, strlen(text), "good.json", &problem, source, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    return problem;
}

/* ---- Good files ---- */

static void test_handwritten_file_is_read_correctly(void **state)
{
    (void)state;
    json_t *source = NULL;
    pe_contact_problem *p = read_problem(sample, &source);
    assert_int_equal(p->body_count, 2);
    assert_int_equal(p->manifold_count, 2);
    assert_int_equal(p->point_count, 3);
    assert_true(p->bodies[1].mass == 2 && p->bodies[1].inertia[1] == 0.01);
    assert_true(p->bodies[0].free_velocity[2] == -0.1635);
    assert_int_equal(p->manifolds[0].a, PE_STATIC);
    assert_int_equal(p->manifolds[1].first, 2);
    assert_true(p->manifolds[1].frame[0][2] == 1 && p->manifolds[1].frame[2][1] == 1);
    assert_true(p->manifolds[1].arm_b[2] == -0.25);
    assert_true(p->points[1].offset[1] == -0.5 && p->points[1].impulse[0] == 0);
    assert_true(p->points[2].bias == 0.25 && p->points[2].impulse[1] == -0.02);
    assert_string_equal(json_string_value(json_object_get(source, "scenario")), "héros");
    json_decref(source);
    pe_contact_problem_destroy(p);
}

static void assert_same_problem(const pe_contact_problem *a, const pe_contact_problem *b)
{
    assert_int_equal(a->body_count, b->body_count);
    assert_int_equal(a->manifold_count, b->manifold_count);
    assert_int_equal(a->point_count, b->point_count);
    for (int i = 0; i < a->body_count; ++i) {
        const pe_problem_body *x = &a->bodies[i], *y = &b->bodies[i];
        assert_memory_equal(&x->mass, &y->mass, sizeof x->mass);
        assert_memory_equal(x->inertia, y->inertia, sizeof x->inertia);
        assert_memory_equal(x->free_velocity, y->free_velocity, sizeof x->free_velocity);
    }
    for (int i = 0; i < a->manifold_count; ++i) {
        const pe_problem_manifold *x = &a->manifolds[i], *y = &b->manifolds[i];
        assert_true(x->a == y->a && x->b == y->b && x->first == y->first && x->count == y->count);
        assert_memory_equal(&x->friction, &y->friction, sizeof x->friction);
        assert_memory_equal(x->frame, y->frame, sizeof x->frame);
        assert_memory_equal(x->arm_a, y->arm_a, sizeof x->arm_a);
        assert_memory_equal(x->arm_b, y->arm_b, sizeof x->arm_b);
    }
    assert_memory_equal(a->points, b->points, (size_t)a->point_count * sizeof *a->points);
}

static void check_round_trip(pe_contact_problem *problem)
{
    json_t *source = json_pack("{s:s, s:f}", "scenario", "by hand", "x", 0.1), *back = NULL;
    char *text = pl_problem_to_text(problem, source);
    assert_non_null(text);
    pe_contact_problem *again = read_problem(text, &back);
    assert_same_problem(again, problem);
    assert_true(json_equal(source, back));
    char *text_again = pl_problem_to_text(again, back);
    assert_string_equal(text_again, text);
    free(text_again);
    free(text);
    json_decref(source);
    json_decref(back);
    pe_contact_problem_destroy(again);
    pe_contact_problem_destroy(problem);
}

static void test_every_bit_of_a_problem_survives_the_file(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 30; ++seed) {
        check_round_trip(problem_at_random(seed, 5, 9));
    }
    check_round_trip(make_problem(0, 0, 0));
}

static void test_extreme_numbers_survive_the_file(void **state)
{
    (void)state;
    pe_contact_problem *problem = problem_at_random(3, 4, 5);
    problem->bodies[0].mass = 1e-300;
    problem->bodies[1].mass = 1.7976931348623157e308;
    problem->bodies[2].free_velocity[0] = 4.9406564584124654e-324; /* the least above 0 */
    problem->points[0].impulse[0] = -0.0;
    problem->points[0].bias = 1.0 / 3;
    problem->points[1].offset[2] = nextafter(1, 2);
    check_round_trip(problem);
}

static void test_valid_problems_round_trip_and_invalid_are_refused(void **state)
{
    (void)state;
    char *directory = make_directory();
    char *path = path_in(directory, "problem.json");
    pe_contact_problem *problem = problem_at_random(8, 3, 4), *again = NULL;
    json_t *source = NULL;
    pl_error error = {.message = ""};
    assert_int_equal(pl_problem_write_file(path, problem, NULL, &error), PL_OK);
    assert_int_equal(pl_problem_read_file(path, &again, &source, &error), PL_OK);
    assert_null(source);
    assert_same_problem(again, problem);
    remove(path);
    problem->bodies[2].mass = (double)NAN;
    assert_int_equal(pl_problem_write_file(path, problem, NULL, &error), PL_FAILED);
    assert_contains(error.message, "bodies[2].mass");
    assert_null(read_text(path));
    pe_contact_problem_destroy(problem);
    pe_contact_problem_destroy(again);
    free(path);
    remove_directory(directory);
}

/* ---- Bad files ---- */

static void check_fault(const text_fault *item)
{
    char *text = text_with(sample, item->from, item->to);
    char expected[256];
    int line, column;
    take_mark(text, &line, &column);
    snprintf(expected, sizeof expected, "bad.json:%d:%d: %s: ", line, column, item->path);
    pe_contact_problem *problem = NULL;
    json_t *source = NULL;
    pl_error error = {.status = PL_OK};
    assert_int_equal(
        pl_problem_read_text(text, strlen(text), "bad.json", &problem, &source, &error),
        PL_BAD_INPUT);
    if (strncmp(error.message, expected, strlen(expected)) != 0) {
        fail_msg("\"%s\"\n  does not begin with \"%s\"", error.message, expected);
    }
    assert_contains(error.message, item->part);
    assert_null(problem);
    assert_null(source);
    free(text);
}

static void check_faults(const text_fault *faults, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        check_fault(&faults[i]);
    }
}

#define CHECK(faults) check_faults(faults, sizeof faults / sizeof faults[0])

static void test_wrong_kinds_are_found_where_they_are(void **state)
{
    (void)state;
    const text_fault faults[] = {
        {"\"plumb.contact_problem/1\"", "@\"plumb.contact_problem/2\"", "schema",
         "expected \"plumb.contact_problem/1\", found \"plumb.contact_problem/2\""},
        {"\"plumb.contact_problem/1\"", "@1", "schema", "found 1"},
        {"{ \"schema\": \"plumb.contact_problem/1\",\n", "@{ ", "schema", "found nothing"},
        {"{ \"scenario\": \"héros\", \"step\": 60 }", "@[]", "source",
         "expected an object, found an array of 0"},
        {"\"mass\": 1,", "\"mass\": @\"1\",", "bodies[0].mass", "expected a number, found \"1\""},
        {"\"mass\": 1,", "\"mass\": @null,", "bodies[0].mass", "expected a number, found null"},
        {"{ \"mass\": 1, ", "@{ ", "bodies[0].mass", "found nothing"},
        {"\"mass\": 1,", "\"mass\": 1, @\"mas\": 1,", "bodies[0].mas", "did you mean \"mass\"?"},
        {"[0.1, 0, 0, 0.1, 0, 0.1]", "@[0.1, 0, 0, 0.1, 0]", "bodies[0].inertia",
         "expected an array of 6 numbers, found an array of 5"},
        {"[0, 0, -0.1635, 0, 0, 0] },\n    { \"mass\": 2",
         "[0, 0, @true, 0, 0, 0] },\n    { \"mass\": 2", "bodies[0].free_velocity[2]",
         "expected a number, found true"},
        {"{ \"a\": -1,", "{ \"a\": @0.5,", "manifolds[0].a", "found 0.5"},
        {"{ \"a\": -1,", "{ \"a\": @\"floor\",", "manifolds[0].a", "expected a number"},
        {"\"b\": 0,", "\"b\": @1e300,", "manifolds[0].b", "index of a body"},
        {"{ \"a\": 0, \"b\": 1, \"friction\": 0, ", "@{ \"a\": 0, \"b\": 1, ",
         "manifolds[1].friction", "found nothing"},
        {"{ \"a\": -1, \"b\": 0", "@{ \"a\": 1, \"b\": 0", "manifolds[0].arm_a",
         "expected an array of 3 numbers, found nothing"},
        {"\"points\": [ { \"offset\": [0, 0.5, 0.5]", "\"points\": [ { @\"ofset\": [0, 0.5, 0.5]",
         "manifolds[0].points[0].ofset", "did you mean \"offset\"?"},
        {"\"bias\": 0.25,", "\"bias\": @[],", "manifolds[1].points[0].bias", "expected a number"},
    };
    CHECK(faults);
}

static void test_bad_numbers_are_found_where_they_are(void **state)
{
    (void)state;
    const text_fault faults[] = {
        {"\"mass\": 2", "\"mass\": @0", "bodies[1].mass",
         "expected a finite number above 0, found 0"},
        {"\"mass\": 2", "\"mass\": @-2", "bodies[1].mass", "found -2"},
        {"[0.2, 0.01, 0, 0.2, 0, 0.3]", "@[0.2, 0.3, 0, 0.2, 0, 0.3]", "bodies[1].inertia",
         "positive definite"},
        {"[0.2, 0.01, 0, 0.2, 0, 0.3]", "@[0, 0, 0, 0, 0, 0]", "bodies[1].inertia",
         "positive definite"},
        {"{ \"a\": 0, \"b\": 1,", "{ \"a\": @2, \"b\": 1,", "manifolds[1].a",
         "expected an index of the 2 bodies"},
        {"{ \"a\": 0, \"b\": 1,", "{ \"a\": @-2, \"b\": 1,", "manifolds[1].a", "found -2"},
        {"{ \"a\": 0, \"b\": 1,", "{ \"a\": 0, \"b\": @0,", "manifolds[1].b", "another body"},
        {"{ \"a\": -1, \"b\": 0", "{ \"a\": -1, \"b\": @-1", "manifolds[0].b", "another body"},
        {"\"friction\": 0.5", "\"friction\": @-0.5", "manifolds[0].friction", "at least 0"},
        {"[0, 0, 1, 1, 0, 0, 0, 1, 0],\n      \"arm_b\"",
         "@[0, 0, 1, 1, 0, 0, 0, 2, 0],\n      \"arm_b\"", "manifolds[0].frame",
         "row 3 . row 3 = 4"},
        {"[0, 0, 1, 1, 0, 0, 0, 1, 0],\n      \"arm_b\"",
         "@[0, 0, 1, 0, 1, 0, 1, 0, 0],\n      \"arm_b\"", "manifolds[0].frame", "right-handed"},
        {"[ { \"offset\": [0, 0, 0], \"bias\": 0.25, \"impulse\": [0.1, -0.02, 0] } ]", "@[]",
         "manifolds[1].points", "expected at least one point, found an array of 0"},
    };
    CHECK(faults);
}

static void test_invalid_json_is_a_syntax_error(void **state)
{
    (void)state;
    const text_fault faults[] = {
        {"\"mass\": 2", "\"mass\": @NaN", "JSON syntax", "expected valid JSON"},
        {"\"mass\": 2", "\"mass\": @Infinity", "JSON syntax", "expected valid JSON"},
        {"\"mass\": 2", "\"mass\": @1e999", "JSON syntax", "real number overflow"},
        {"\"mass\": 1,", "\"mass\": 1, @\"mass\": 1,", "JSON syntax", "duplicate"},
    };
    CHECK(faults);
}

static void test_a_file_cut_short_anywhere_is_refused(void **state)
{
    (void)state;
    for (size_t length = 0; length + 2 < sizeof sample; ++length) {
        pe_contact_problem *problem = NULL;
        json_t *source = NULL;
        pl_error error = {.message = ""};
        assert_int_equal(
            pl_problem_read_text(sample, length, "cut.json", &problem, &source, &error),
            PL_BAD_INPUT);
        assert_contains(error.message, "cut.json:");
        assert_null(problem);
    }
}

static void check_refused_file(const char *path, pl_status status, const char *part)
{
    pe_contact_problem *problem = NULL;
    json_t *source = NULL;
    pl_error error = {.message = ""};
    assert_int_equal(pl_problem_read_file(path, &problem, &source, &error), status);
    assert_contains(error.message, part);
    assert_null(problem);
}

static void test_invalid_problem_files_are_refused(void **state)
{
    (void)state;
    char *directory = make_directory();
    char *path = path_in(directory, "x.json");
    check_refused_file(path, PL_BAD_INPUT, "expected a contact problem file, found none to read");
    check_refused_file(directory, PL_BAD_INPUT, "found a directory");
    check_refused_file("/dev/zero", PL_BAD_INPUT, "at most 256 MiB");
    write_text(path, "\n\n");
    check_refused_file(path, PL_BAD_INPUT, "x.json:1:1: contact problem: expected a JSON object");
    write_text(path, "[1]");
    check_refused_file(path, PL_BAD_INPUT, "x.json:1:1: contact problem: expected an object");
    write_text(path, "{\"plumb_scene\": 1}");
    check_refused_file(path, PL_BAD_INPUT, "x.json:1:2: plumb_scene: expected one of schema");
    free(path);
    remove_directory(directory);
}

static void test_a_capture_is_a_step_and_a_path(void **state)
{
    (void)state;
    static const char *const refused[] = {"",     ":path",  "5",       "5:",     "5path",
                                          "path", "0:path", "-1:path", "5 :path"};
    long step = 0;
    const char *path = NULL;
    assert_true(pl_capture_parse("12:folder/a:b", &step, &path));
    assert_int_equal(step, 12);
    assert_string_equal(path, "folder/a:b");
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; ++i) {
        assert_false(pl_capture_parse(refused[i], &step, &path));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_capture_is_a_step_and_a_path),
        cmocka_unit_test(test_handwritten_file_is_read_correctly),
        cmocka_unit_test(test_every_bit_of_a_problem_survives_the_file),
        cmocka_unit_test(test_extreme_numbers_survive_the_file),
        cmocka_unit_test(test_valid_problems_round_trip_and_invalid_are_refused),
        cmocka_unit_test(test_wrong_kinds_are_found_where_they_are),
        cmocka_unit_test(test_bad_numbers_are_found_where_they_are),
        cmocka_unit_test(test_invalid_json_is_a_syntax_error),
        cmocka_unit_test(test_a_file_cut_short_anywhere_is_refused),
        cmocka_unit_test(test_invalid_problem_files_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
