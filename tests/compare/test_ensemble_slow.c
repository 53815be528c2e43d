/* Ensembles tell apart what differs and nothing else: an engine from itself with another friction,
 * and not from itself with other members. */
#include "check.h"
#include "plumb_process.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double never = 2; /* above any p */

/* The least corrected p of the comparisons with this setting (1: the first --against). */
static double least_p(const json_t *outcome, json_int_t setting)
{
    const json_t *ensembles = json_object_get(outcome, "ensembles");
    double least = never;
    size_t index;
    const json_t *comparison;
    json_array_foreach(json_object_get(outcome, "comparisons"), index, comparison)
    {
        json_int_t b = json_integer_value(json_object_get(comparison, "b"));
        const json_t *other = json_array_get(ensembles, (size_t)b);
        double p = json_number_value(json_object_get(comparison, "p_corrected"));
        if (json_integer_value(json_object_get(other, "setting")) == setting && p < least) {
            least = p;
        }
    }
    assert_true(least < never);
    return least;
}

/* A small collapse on the engine, against itself and against the same with less friction. NULL
 * where this build lacks the engine. */
static json_t *collapse(const workspace *f, const char *engine)
{
    const char *const arguments[] = {
        "ensemble",  "wall-collapse", "--set",      "rows=4",    "--set",
        "columns=6", "--engine",      engine,       "--against", "itself",
        "--against", "friction=0.4",  "--duration", "1.5",       "--out",
        f->out,      "--json",        "-",          NULL};
    plumb_output output = run_plumb(f->directory, arguments);
    json_t *outcome = output.code == 4 ? NULL : json_loads(output.out, 0, NULL);
    if (output.code != 0 && output.code != 4) {
        print_error("%s", output.err);
    }
    assert_true(output.code == 4 || (output.code == 0 && outcome != NULL));
    free_output(&output);
    return outcome;
}

static void check_engine(const workspace *f, const char *engine)
{
    json_t *outcome = collapse(f, engine);
    if (outcome == NULL) {
        return;
    }
    double itself = least_p(outcome, 1), slippery = least_p(outcome, 2);
    if (!(itself > 0.05 && slippery < 0.01)) {
        print_error("%s: p %g against itself, %g against less friction\n", engine, itself,
                    slippery);
    }
    assert_true(itself > 0.05);
    assert_true(slippery < 0.01);
    json_decref(outcome);
}

static void test_plumb_is_told_apart_by_friction_alone(void **state)
{
    check_engine(*state, "plumb");
}

static void test_ode_is_told_apart_by_friction_alone(void **state)
{
    check_engine(*state, "ode:quick");
}

static void test_bullet_is_told_apart_by_friction_alone(void **state)
{
    check_engine(*state, "bullet:si");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_plumb_is_told_apart_by_friction_alone, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_ode_is_told_apart_by_friction_alone, setup_workspace,
                                        teardown_workspace),
        cmocka_unit_test_setup_teardown(test_bullet_is_told_apart_by_friction_alone,
                                        setup_workspace, teardown_workspace),
    };
    return cmocka_run_group_tests_name("ensemble", tests, NULL, NULL);
}
