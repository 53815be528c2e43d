/* The spread of repeats on the terminal. */
#include "base/number_format.h"
#include "check.h"
#include "report_rows.h"

#include <stdlib.h>

/* Repeats of one run with these values of a metric. */
static json_t *repeats(const char *metric, const double *values, int count)
{
    json_t *results = json_array();
    for (int i = 0; i < count; ++i) {
        json_t *row = add_run(results, "s", "ode:quick", "ok");
        json_object_set_new(row, "repeat", json_integer(i));
        set_metric(row, metric, metric_value(values[i]));
    }
    return results;
}

static void check_printed(json_t *results, const char *part, int count)
{
    char *text = printed_table(results, false, 120);
    assert_contains(text, part);
    assert_int_equal(count_of(text, " ± "), count + 1); /* one is in the note */
    free(text);
    json_decref(results);
}

static void test_spread_has_the_places_of_its_number(void **state)
{
    (void)state;
    static const struct {
        double value, spread;
        const char *unit, *text;
    } cases[] = {{12.34e-6, 0.41e-6, "s", "12.3 ± 0.4 µs"},
                 {12.3e-6, 0.04e-6, "s", "12.3 ± 0.04 µs"},
                 {1.15e-3, 2.4e-6, "s", "1.15 ± 0.002 ms"},
                 {635e-6, 5.7e-6, "s", "635 ± 6 µs"},
                 {1.2e-3, 0, "s", "1.20 ± 0 ms"},
                 {0.00271, 0.1, "m", "0.00271 ± 0.10000 m"},
                 {1.2e-7, 3.1e-9, "m", "1.20e-7 ± 3.10e-9 m"},
                 {0, 1e-12, "1", "0 ± 1.00e-12"},
                 {9.99e-6, 0.0996e-6, "s", "9.99 ± 0.10 µs"},
                 {100, 0.0996, "", "100 ± 0.1"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char text[PL_QUANTITY_SIZE];
        pl_format_spread(cases[i].value, cases[i].spread, cases[i].unit, text);
        assert_string_equal(text, cases[i].text);
    }
}

static void test_times_show_median_and_median_deviation(void **state)
{
    (void)state;
    const double times[] = {5e-3, 1e-3, 2e-3, 90e-3, 3e-3};
    check_printed(repeats("time_per_step", times, 5), " 3.00 ± 2.00 ms", 1);
    check_printed(repeats("time_per_step", times, 5),
                  "Each number is the median of 5 repeats. ± is the median distance", 1);
}

static void test_errors_show_a_spread_where_repeats_differ(void **state)
{
    (void)state;
    const double equal[] = {0.5, 0.5, 0.5}, other[] = {0.5, 0.25, 0.75};
    check_printed(repeats("reference_error", equal, 3), " 0.500 ", 0);
    check_printed(repeats("reference_error", other, 3), " 0.500 ± 0.250", 1);
}

static void test_one_run_has_no_spread_and_no_note(void **state)
{
    (void)state;
    const double time = 5e-3;
    json_t *results = repeats("time_per_step", &time, 1);
    char *text = printed_table(results, false, 120);
    assert_absent(text, "±");
    assert_contains(text, "5.00 ms");
    free(text);
    json_decref(results);
}

/* The wall time stands there where the run asked for several threads, and only there. */
static void test_wall_time_is_shown_with_several_threads(void **state)
{
    (void)state;
    const double time = 5e-3;
    for (int threads = 1; threads <= 2; ++threads) {
        json_t *results = repeats("time_per_step", &time, 1);
        json_t *row = json_array_get(results, 0);
        set_metric(row, "wall_time_per_step", metric_value(3e-3));
        json_object_set_new(row, "threads", json_integer(threads));
        char *text = printed_table(results, false, 120);
        assert_int_equal(count_of(text, "5.00 ms, wall 3.00 ms"), threads - 1);
        assert_int_equal(count_of(text, "wall"), threads == 1 ? 0 : 2);
        free(text);
        json_decref(results);
    }
}

/* The time of an engine in another runtime is not divided by that of a native engine. */
static void test_summary_names_what_an_engine_runs_in(void **state)
{
    (void)state;
    json_t *results = json_array();
    for (int i = 0; i < 2; ++i) {
        json_t *row = add_run(results, "s", i == 0 ? "ode:quick" : "web:default", "ok");
        set_metric(row, "time_per_step", metric_value(i == 0 ? 2e-3 : 5e-3));
        json_object_set_new(row, "engine_runtime", json_string(i == 0 ? "native" : "web|assembly"));
    }
    made_report made = make_report(results);
    assert_contains(made.markdown, "2.00 ms (");
    assert_contains(made.markdown, "5.00 ms in web\\|assembly |");
    free_report(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spread_has_the_places_of_its_number),
        cmocka_unit_test(test_times_show_median_and_median_deviation),
        cmocka_unit_test(test_errors_show_a_spread_where_repeats_differ),
        cmocka_unit_test(test_one_run_has_no_spread_and_no_note),
        cmocka_unit_test(test_wall_time_is_shown_with_several_threads),
        cmocka_unit_test(test_summary_names_what_an_engine_runs_in),
    };
    return cmocka_run_group_tests_name("spread of repeats", tests, NULL, NULL);
}
