/* Chaotic scenes are judged by what is visible: converged runs end as expected, and a slop counts
 * only once it shows. */
#include "check.h"
#include "run_result.h"

#include <math.h>
#include <string.h>

static const char *part_of(const json_t *result, const char *name)
{
    const json_t *of = json_object_get(json_object_get(result, "metrics"), name);
    const char *part = json_string_value(json_object_get(of, "part"));
    return part != NULL ? part : "";
}

static void test_converged_runs_end_as_expected(void **state)
{
    (void)state;
    static const char *const scenarios[] = {"falling-cubes", "dominoes"};
    for (size_t i = 0; i < sizeof scenarios / sizeof *scenarios; ++i) {
        const char *const arguments[] = {"run",  scenarios[i], "--engine", "plumb:accurate",
                                         "--dt", "1/480",      "--json",   "-",
                                         NULL};
        json_t *result = run_to_json(arguments);
        /* Of ten converged runs one may lie outside, but none far outside. */
        assert_at_most(metric(result, "statistics_error"), 0.02);
        assert_at_most(metric(result, "chaotic_error"), 0.02);
        json_decref(result);
    }
}

/* The cubes have a side of 1 m. */
static json_t *cubes(const char *engine)
{
    const char *const arguments[] = {"run", "falling-cubes", "--engine", engine, "--json", "-",
                                     NULL};
    return run_to_json(arguments);
}

static void test_slop_counts_only_once_it_shows(void **state)
{
    (void)state;
    static const char *const hidden[] = {"plumb,slop=1e-5", "plumb,slop=1e-4"};
    for (int i = 0; i < 2; ++i) {
        json_t *result = cubes(hidden[i]);
        assert_close(metric(result, "chaotic_error"), 1e-3, 0, 0);
        assert_string_equal(part_of(result, "chaotic_error"), "resolution");
        json_decref(result);
    }
    json_t *result = cubes("plumb,slop=1e-3");
    const double p99 = metric_percentile(result, "penetration_max", "p99");
    assert_true(p99 > 1e-3);
    assert_close(metric(result, "chaotic_error"), p99, 0, 1e-15);
    assert_string_equal(part_of(result, "reference_error"), "penetration_p99");
    json_decref(result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_converged_runs_end_as_expected),
        cmocka_unit_test(test_slop_counts_only_once_it_shows),
    };
    return cmocka_run_group_tests_name("chaotic, slow", tests, NULL, NULL);
}
