/* The suites with a right answer, on plumb:accurate at 1/240 s: every scenario within the error
 * that its kind allows; and the hard suite, at two steps, with the outcome of a right engine. */
#include "check.h"
#include "plumb_process.h"
#include "run_result.h"

#include "plumb/scenario.h"

#include <stdio.h>
#include <string.h>

/* Relative; at rest m. */
static const double AT_REST = 1e-6, SMOOTH = 1e-4, IMPACT = 1e-3, ROLLING_EDGE = 0.06;

typedef struct bound {
    const char *scenario;
    double error; /* of the primary error */
} bound;

static const bound bounds[] = {
    {"free-fall", 1e-12},
    {"projectile", 1e-12},
    {"rocket", 1e-12},
    {"torque-free", 1e-5},
    {"top", SMOOTH},
    {"slope-slide", SMOOTH},
    {"slide-to-stop", SMOOTH},
    {"isotropy", SMOOTH},
    {"reaction-split", SMOOTH},
    {"spin-stop", SMOOTH},
    {"slide-and-spin", SMOOTH},
    {"roll-slope", SMOOTH},
    {"bowling", SMOOTH},
    {"carried-balls", SMOOTH},
    {"bounce", IMPACT},
    {"bounce-row", IMPACT},
    {"rain", IMPACT},
    {"spinning-coin", ROLLING_EDGE},
    {"oblique-impact", IMPACT},
    {"collision-train", IMPACT},
    {"cradle", IMPACT},
    {"rocking-block", IMPACT},
};

static double bound_of(const char *scenario)
{
    for (size_t i = 0; i < sizeof bounds / sizeof bounds[0]; ++i) {
        if (strcmp(bounds[i].scenario, scenario) == 0) {
            return bounds[i].error;
        }
    }
    return AT_REST;
}

/* One entry of a suite at `dt`; the caller decrefs. */
static json_t *run(const pl_suite_entry *entry, const char *dt)
{
    const char *const arguments[] = {"run",
                                     entry->scenario,
                                     "--engine",
                                     "plumb:accurate",
                                     "--dt",
                                     dt,
                                     "--json",
                                     "-",
                                     entry->setting != NULL ? "--set" : NULL,
                                     entry->setting,
                                     NULL};
    return run_to_json(arguments);
}

static void test_every_analytic_scenario_meets_its_error_bound(void **state)
{
    (void)state;
    const pl_suite *suite = pl_suite_find("analytic", NULL);
    for (int i = 0; i < suite->entry_count; ++i) {
        const pl_suite_entry *entry = &suite->entries[i];
        json_t *r = run(entry, "0.004166666666666667");
        const double error = metric(r, result_text(r, "primary_error"));
        print_message("    %-16s %s %.2g\n", entry->scenario, result_text(r, "primary_error"),
                      error);
        assert_string_equal(result_text(r, "outcome"), "ok");
        if (!(error <= bound_of(entry->scenario))) {
            fail_msg("%s: error %g, allowed %g", entry->scenario, error, bound_of(entry->scenario));
        }
        json_decref(r);
    }
}

static void check_hard(const char *dt, const char *except)
{
    const pl_suite *suite = pl_suite_find("hard", NULL);
    for (int i = 0; i < suite->entry_count; ++i) {
        if (strcmp(suite->entries[i].scenario, except) == 0) {
            continue;
        }
        json_t *r = run(&suite->entries[i], dt);
        if (strcmp(result_text(r, "outcome"), "ok") != 0) {
            fail_msg("%s at %s s: %s: %s", suite->entries[i].scenario, dt,
                     result_text(r, "outcome"), result_text(r, "reason"));
        }
        json_decref(r);
    }
}

static void test_what_breaks_engines_does_not_break_ours(void **state)
{
    (void)state;
    check_hard("0.016666666666666666", "");
    check_hard("0.004166666666666667", "pile"); /* which takes a minute, and ends as well */
}

static void test_a_tumbling_box_keeps_its_angular_momentum(void **state)
{
    (void)state;
    const char *const arguments[] = {"run",  "torque-free",          "--engine", "plumb:accurate",
                                     "--dt", "0.004166666666666667", "--json",   "-",
                                     NULL};
    json_t *r = run_to_json(arguments);
    assert_at_most(metric(r, "momentum_error"), 1e-9);
    json_decref(r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_analytic_scenario_meets_its_error_bound),
        cmocka_unit_test(test_what_breaks_engines_does_not_break_ours),
        cmocka_unit_test(test_a_tumbling_box_keeps_its_angular_momentum),
    };
    return cmocka_run_group_tests_name("analytic", tests, NULL, NULL);
}
