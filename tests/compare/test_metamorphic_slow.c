/* What our engine promises and keeps without a reference: it knows no directions, no places, no
 * order of bodies and nothing of what is far away. */
#include "check.h"
#include "plumb_process.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

typedef enum part { EARLY, END } part; /* at a tenth of the run, at its end */

static const char *const profiles[] = {"plumb:accurate", "plumb", "plumb:fast"};
enum { ACCURATE = 1, DEFAULT = 2, FAST = 4, SOLVED = ACCURATE | DEFAULT, ALL = SOLVED | FAST };

/* A scene: the scenario with up to three NAME=VALUE, so many seconds of it. */
typedef struct scene {
    const char *name, *set[3], *duration;
} scene;

static const scene resting[] = {
    {"tower", {"n=25"}, "5"},
    {"tower", {"n=10", "offset=0.02"}, "2"},
    {"wall", {"rows=10", "columns=10"}, "3"},
    {"rest-shape", {"shape=1"}, "2"},
    {"rest-shape", {"shape=2"}, "2"},
    {"rest-shape", {"shape=4"}, "2"},
    {"rest-shape", {"shape=6"}, "2"},
};
static const scene moving[] = {
    {"slope-slide", {NULL}, "2"}, {"slide-to-stop", {NULL}, "3"}, {"rocket", {NULL}, "2"}};
static const scene collapse = {"wall-collapse", {"rows=10", "columns=10"}, "0.6667"};

/* The findings of one call; the caller decrefs. */
static json_t *findings_of(const scene *at, const char *engine, const char *const *checks)
{
    const char *arguments[40] = {"metamorphic", at->name, "--engine",   engine,
                                 "--json",      "-",      "--duration", at->duration};
    int count = 8;
    for (int i = 0; i < 3 && at->set[i] != NULL; ++i) {
        arguments[count++] = "--set";
        arguments[count++] = at->set[i];
    }
    for (; *checks != NULL; ++checks) {
        arguments[count++] = "--check";
        arguments[count++] = *checks;
    }
    char *directory = make_directory();
    arguments[count++] = "--out";
    arguments[count++] = directory;
    plumb_output output = run_plumb(directory, arguments);
    if (output.code != 0) {
        fail_msg("%s on %s: exit code %d: %s", at->name, engine, output.code, output.err);
    }
    json_t *trials = json_loads(output.out, 0, NULL);
    json_t *findings = json_incref(json_object_get(json_array_get(trials, 0), "checks"));
    json_decref(trials);
    free_output(&output);
    remove_directory(directory);
    return findings;
}

static double number(const json_t *finding, part at, const char *key)
{
    const json_t *difference = json_object_get(finding, at == EARLY ? "early" : "end");
    const json_t *value = json_object_get(difference, key);
    return json_is_number(value) ? json_number_value(value) : 1e300;
}

/* All of the checks on these profiles agree to `bound`, of the scene's size and in rad; a bound of
 * 0 is bitwise, over the whole run up to there. */
static void expect(const scene *at, int on, const char *const *checks, part when, double bound)
{
    for (int i = 0; i < 3; ++i) {
        if ((on & 1 << i) == 0) {
            continue;
        }
        json_t *findings = findings_of(at, profiles[i], checks);
        size_t index;
        const json_t *finding;
        assert_true(json_array_size(findings) > 0);
        json_array_foreach(findings, index, finding)
        {
            const json_t *part_of = json_object_get(finding, when == EARLY ? "early" : "end");
            const char *verdict = result_text(part_of, "verdict");
            double off = number(finding, when, "position"),
                   turned = number(finding, when, "rotation");
            bool kept =
                bound > 0 ? off <= bound && turned <= bound : strcmp(verdict, "bitwise") == 0;
            if (!kept) {
                fail_msg("%s %s on %s: %s is %s, %.3g of the size, %.3g rad; promised %g", at->name,
                         at->set[0] == NULL ? "" : at->set[0], profiles[i],
                         result_text(finding, "check"), verdict, off, turned, bound);
            }
        }
        json_decref(findings);
    }
}

#define CHECKS(...) ((const char *const[]){__VA_ARGS__, NULL})
enum { RESTING = sizeof resting / sizeof resting[0], MOVING = sizeof moving / sizeof moving[0] };

static void test_a_run_repeats_bit_for_bit(void **state)
{
    (void)state;
    for (int i = 0; i < RESTING; ++i) {
        expect(&resting[i], ALL, CHECKS("again"), END, 0);
    }
    for (int i = 0; i < MOVING; ++i) {
        expect(&moving[i], ALL, CHECKS("again"), END, 0);
    }
    expect(&collapse, ALL, CHECKS("again"), END, 0);
}

static void test_what_is_far_away_changes_no_bit(void **state)
{
    (void)state;
    for (int i = 0; i < RESTING; ++i) {
        expect(&resting[i], ALL, CHECKS("far"), END, 0);
    }
    for (int i = 0; i < MOVING; ++i) {
        expect(&moving[i], ALL, CHECKS("far"), END, 0);
    }
    expect(&collapse, ALL, CHECKS("far"), END, 0);
}

static void test_direct_solution_is_independent_of_direction_and_order(void **state)
{
    (void)state;
    for (int i = 0; i < RESTING; ++i) {
        expect(&resting[i], SOLVED, CHECKS("rotate", "mirror", "order"), END, 1e-9);
    }
    for (int i = 0; i < MOVING; ++i) {
        expect(&moving[i], SOLVED, CHECKS("rotate", "mirror", "order"), END, 1e-9);
    }
}

/* A place at 1e6 m is known to 1.2e-10 m, at 1e7 m to 1.9e-9 m. */
static void test_direct_solution_far_away_is_exact_to_rounding(void **state)
{
    (void)state;
    const char *const near[] = {"shift-1e3", "shift-1e4", "shift-1e5", "shift-1e6", NULL};
    for (int i = 0; i < RESTING; ++i) {
        expect(&resting[i], SOLVED, near, END, 1e-9);
        expect(&resting[i], SOLVED, CHECKS("shift-1e7"), END, 1e-8);
    }
    for (int i = 0; i < MOVING; ++i) {
        expect(&moving[i], SOLVED, near, END, 1e-9);
        expect(&moving[i], SOLVED, CHECKS("shift-1e7"), END, 1e-8);
    }
}

/* The fast profile does not iterate soft contacts to convergence: what it leaves depends on the
 * order in which they come, within what it sags. */
static void test_soft_contacts_depend_little_on_direction_and_order(void **state)
{
    (void)state;
    for (int i = 0; i < RESTING; ++i) {
        expect(&resting[i], FAST, CHECKS("rotate", "mirror", "order", "shift"), END, 1e-3);
    }
    for (int i = 0; i < MOVING; ++i) {
        expect(&moving[i], FAST, CHECKS("rotate", "mirror", "shift"), END, 1e-4);
        /* They begin at rest, where they are solved directly. */
        expect(&moving[i], FAST, CHECKS("order"), END, 1e-9);
    }
}

/* The ball strikes at 0.1 s; until then all is at rest. */
static void test_resting_wall_is_independent_of_direction_and_order(void **state)
{
    (void)state;
    expect(&collapse, SOLVED, CHECKS("rotate", "mirror", "order"), EARLY, 1e-9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_run_repeats_bit_for_bit),
        cmocka_unit_test(test_what_is_far_away_changes_no_bit),
        cmocka_unit_test(test_direct_solution_is_independent_of_direction_and_order),
        cmocka_unit_test(test_direct_solution_far_away_is_exact_to_rounding),
        cmocka_unit_test(test_soft_contacts_depend_little_on_direction_and_order),
        cmocka_unit_test(test_resting_wall_is_independent_of_direction_and_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
