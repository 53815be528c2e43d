/* Files of contact problems, which plumb run --capture writes and the engine's tools read: every
 * bit survives, and a message about a bad file names its field. Each bad case changes a good file
 * at one place and marks with an @, which is taken out, where the fault is. */
#include "check.h"
#include "command/capture_file.h"
#include "contact_problem_for_tests.h"
#include "plumb_process.h"
#include "problem_file.h"
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

static pe_contact_problem *read_problem(const char *text)
{
    char message[PROBLEM_MESSAGE_SIZE];
    pe_contact_problem *problem = problem_read_text(text, strlen(text), "good.json", message);
    if (problem == NULL) {
        fail_msg("%s", message);
    }
    return problem;
}

/* ---- Good files ---- */

static void test_handwritten_file_is_read_correctly(void **state)
{
    (void)state;
    pe_contact_problem *p = read_problem(sample);
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

static void assert_same_solutions(const pe_contact_problem *a, const pe_contact_problem *b)
{
    const pe_solve_limits limits = {.tolerance = 1e-10, .max_iterations = 50};
    for (int i = 0; i < pe_solver_count(); ++i) {
        pe_contact_solution x, y;
        const char *name = pe_solver(i).name;
        assert_int_equal(pe_contact_problem_solve(a, name, &limits, NULL, &x, NULL), PE_OK);
        assert_int_equal(pe_contact_problem_solve(b, name, &limits, NULL, &y, NULL), PE_OK);
        assert_int_equal(x.iterations, y.iterations);
        if (a->point_count > 0) {
            assert_memory_equal(x.impulses, y.impulses,
                                (size_t)a->point_count * sizeof *x.impulses);
            assert_memory_equal(x.velocities, y.velocities,
                                (size_t)a->body_count * sizeof *x.velocities);
        }
        pe_contact_solution_free(&x);
        pe_contact_solution_free(&y);
    }
}

/* Destroys the problem. */
static void check_round_trip(pe_contact_problem *problem)
{
    json_t *source = json_pack("{s:s, s:f}", "scenario", "by hand", "x", 0.1);
    char *text = pl_capture_text(problem, source);
    pe_contact_problem *again = read_problem(text);
    assert_same_problem(again, problem);
    assert_same_solutions(again, problem);
    char *text_again = pl_capture_text(again, source);
    assert_string_equal(text_again, text);
    free(text_again);
    free(text);
    json_decref(source);
    pe_contact_problem_destroy(again);
    pe_contact_problem_destroy(problem);
}

static void test_problems_and_solutions_survive_the_file_exactly(void **state)
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

/* ---- Bad files ---- */

static void check_fault(const text_fault *item)
{
    char *text = text_with(sample, item->from, item->to);
    char expected[256], message[PROBLEM_MESSAGE_SIZE] = "";
    int line, column;
    take_mark(text, &line, &column);
    snprintf(expected, sizeof expected, "bad.json: %s: ", item->path);
    assert_null(problem_read_text(text, strlen(text), "bad.json", message));
    if (strncmp(message, expected, strlen(expected)) != 0) {
        fail_msg("\"%s\"\n  does not begin with \"%s\"", message, expected);
    }
    assert_contains(message, item->part);
    free(text);
}

static void check_faults(const text_fault *faults, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        check_fault(&faults[i]);
    }
}

#define CHECK(faults) check_faults(faults, sizeof faults / sizeof faults[0])

static void test_wrong_kinds_are_named_by_their_field(void **state)
{
    (void)state;
    const text_fault faults[] = {
        {"\"plumb.contact_problem/1\"", "@\"plumb.contact_problem/2\"", "schema",
         "expected \"plumb.contact_problem/1\""},
        {"\"plumb.contact_problem/1\"", "@1", "schema", "expected \"plumb.contact_problem/1\""},
        {"\"mass\": 1,", "\"mass\": @\"1\",", "bodies[0].mass", "got string"},
        {"\"mass\": 1,", "\"mass\": @null,", "bodies[0].mass", "got null"},
        {"{ \"mass\": 1, ", "@{ ", "bodies[0].mass", "item not found: mass"},
        {"\"mass\": 1,", "\"mass\": 1, @\"mas\": 1,", "bodies[0]", "left unpacked: mas"},
        {"[0.1, 0, 0, 0.1, 0, 0.1]", "@[0.1, 0, 0, 0.1, 0]", "bodies[0].inertia", "Array index 5"},
        {"[0.1, 0, 0, 0.1, 0, 0.1]", "@[0.1, 0, 0, 0.1, 0, 0.1, 0]", "bodies[0].inertia",
         "1 array item(s) left"},
        {"[0, 0, -0.1635, 0, 0, 0] },\n    { \"mass\": 2",
         "[0, 0, @true, 0, 0, 0] },\n    { \"mass\": 2", "bodies[0].free_velocity", "got true"},
        {"{ \"a\": -1,", "{ \"a\": @0.5,", "manifolds[0].a", "Expected integer, got real"},
        {"{ \"a\": -1,", "{ \"a\": @\"floor\",", "manifolds[0].a", "Expected integer"},
        {"\"b\": 0,", "\"b\": @1e300,", "manifolds[0].b", "Expected integer"},
        {"\"b\": 0,", "\"b\": @4294967296,", "manifolds[0].b", "the index of a body"},
        {"{ \"a\": 0, \"b\": 1, \"friction\": 0, ", "@{ \"a\": 0, \"b\": 1, ",
         "manifolds[1].friction", "item not found: friction"},
        {"{ \"a\": -1, \"b\": 0", "@{ \"a\": 1, \"b\": 0", "manifolds[0].arm_a",
         "item not found: arm_a"},
        {"\"points\": [ { \"offset\": [0, 0.5, 0.5]", "\"points\": [ { @\"ofset\": [0, 0.5, 0.5]",
         "manifolds[0].points[0].offset", "item not found: offset"},
        {"\"bias\": 0.25,", "\"bias\": @[],", "manifolds[1].points[0].bias", "got array"},
    };
    CHECK(faults);
}

static void test_bad_numbers_are_named_by_their_field(void **state)
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
         "manifolds[1].points", "expected an array of at least one point"},
    };
    CHECK(faults);
}

static void check_syntax(const char *to, int column, const char *part)
{
    char *text = text_with(sample, "\"mass\": 2", to);
    char place[64], message[PROBLEM_MESSAGE_SIZE] = "";
    snprintf(place, sizeof place, "bad.json:6:%d: ", column);
    assert_null(problem_read_text(text, strlen(text), "bad.json", message));
    assert_contains(message, place);
    assert_contains(message, part);
    free(text);
}

static void test_text_that_is_no_json_has_a_line(void **state)
{
    (void)state;
    check_syntax("\"mass\": NaN", 17, "invalid token");
    check_syntax("\"mass\": 1e999", 19, "real number overflow");
    check_syntax("\"mass\": 2, \"mass\": 2", 23, "duplicate object key");
}

static void test_a_file_cut_short_anywhere_is_refused(void **state)
{
    (void)state;
    for (size_t length = 0; length + 2 < sizeof sample; ++length) {
        char message[PROBLEM_MESSAGE_SIZE] = "";
        assert_null(problem_read_text(sample, length, "cut.json", message));
        assert_contains(message, "cut.json:");
    }
}

static void check_refused_file(const char *path, const char *part)
{
    char message[PROBLEM_MESSAGE_SIZE] = "";
    assert_null(problem_read_file(path, message));
    assert_contains(message, path);
    assert_contains(message, part);
}

static void test_files_that_are_no_problem_are_refused(void **state)
{
    (void)state;
    char *directory = make_directory();
    char *path = path_in(directory, "x.json");
    check_refused_file(path, "No such file");
    check_refused_file(directory, "expected");
    check_refused_file("/dev/zero", "expected");
    write_text(path, "\n\n");
    check_refused_file(path, "'[' or '{' expected");
    write_text(path, "[1]");
    check_refused_file(path, "x.json: Expected object, got array");
    write_text(path, "{\"plumb_scene\": 1}");
    check_refused_file(path, "x.json: schema: Object item not found");
    write_text(path,
               "{\"schema\": \"plumb.contact_problem/1\", \"bodies\": {}, \"manifolds\": []}");
    check_refused_file(path, "x.json: bodies: expected an array");
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
        cmocka_unit_test(test_problems_and_solutions_survive_the_file_exactly),
        cmocka_unit_test(test_extreme_numbers_survive_the_file),
        cmocka_unit_test(test_wrong_kinds_are_named_by_their_field),
        cmocka_unit_test(test_bad_numbers_are_named_by_their_field),
        cmocka_unit_test(test_text_that_is_no_json_has_a_line),
        cmocka_unit_test(test_a_file_cut_short_anywhere_is_refused),
        cmocka_unit_test(test_files_that_are_no_problem_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
