/* The report: what it says of results made by hand, whose answers are known. */
#include "report/cells.h"
#include "report/csv.h"
#include "report/html.h"
#include "report/losses.h"
#include "report/markdown.h"
#include "report/quantity.h"
#include "report/report.h"

#include "check.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static const char hostile[] =
    "<script>alert(\"x\")</script>, 'a'|b\r\nhttps://x.y & `Grüße` \\ ]]> -->";

/* --- Results by hand --- */

static json_t *number(double value)
{
    return json_pack("{s:f}", "value", value);
}

/* A run whose engine is the part of `label` before its colon. */
static json_t *run_of(const char *scenario, const char *label, const char *outcome)
{
    json_t *row = json_pack(
        "{s:s, s:s, s:s, s:{}, s:s, s:s, s:s%, s:s, s:s, s:s, s:{}, s:i, s:i, s:s, s:n, "
        "s:{s:i, s:i}, s:{}, s:n, s:n, s:{s:s, s:s, s:s, s:s}, s:{s:s, s:s}, s:[s, s], s:s}",
        "schema", "plumb.result/1", "run", "00", "scenario", scenario, "params", "scene_hash",
        "cafe", "primary_error", "drift", "engine", label, strcspn(label, ":"), "profile", "p",
        "engine_version", "1.0", "label", label, "settings", "seed", 0, "repeat", 0, "outcome",
        outcome, "reason", "steps", "asked", 10, "done", 10, "metrics", "final_poses", "output",
        "host", "cpu", "one", "os", "linux", "compiler", "gcc", "flags", "-O2", "plumb", "version",
        "0.1.0", "git", "abc", "command", "plumb", "compare", "started", "2026-01-01T00:00:00Z");
    assert_non_null(row);
    return row;
}

static void set(json_t *row, const char *metric, json_t *value)
{
    int failed = json_object_set_new(json_object_get(row, "metrics"), metric, value);
    assert_int_equal(failed, 0);
}

static json_t *add(json_t *results, const char *scenario, const char *label, const char *outcome)
{
    json_t *row = run_of(scenario, label, outcome);
    json_array_append_new(results, row);
    return row;
}

/* Ours and another engine on one problem, with a value each of one metric. */
static json_t *duel(const char *metric, double ours, double theirs)
{
    json_t *results = json_array();
    set(add(results, "duel", "plumb:fast", "ok"), metric, number(ours));
    set(add(results, "duel", "ode:quick", "ok"), metric, number(theirs));
    return results;
}

/* Every outcome, hostile texts, repeats, and a null metric. */
static json_t *all_kinds(void)
{
    static const char *const outcomes[] = {"ok",      "collapsed", "diverged",   "nonfinite",
                                           "crashed", "timeout",   "unsupported"};
    json_t *results = json_array();
    for (int i = 0; i < 7; i++) {
        char label[32];
        snprintf(label, sizeof label, "%s", i == 0 ? "plumb:fast" : "");
        if (i > 0)
            snprintf(label, sizeof label, "engine%d:p", i);
        json_t *row = add(results, "kinds", label, outcomes[i]);
        if (i > 0)
            json_object_set_new(row, "reason", json_string(hostile));
        if (i == 4)
            json_object_set_new(row, "output", json_string(hostile));
        if (i < 4)
            set(row, "drift", number(1e-3 * (i + 1)));
        if (i < 4)
            set(row, "reference_error", number(1e-3 * (i + 1)));
    }
    json_t *row = add(results, hostile, "plumb:fast", "ok");
    json_object_set_new(row, "engine_version", json_string(hostile));
    set(row, "settle_time",
        json_pack("{s:n, s:s, s:s}", "value", "unit", "s", "reason", "moves to the end <&>"));
    row = add(results, hostile, hostile, "ok");
    json_object_set_new(json_object_get(row, "host"), "cpu", json_string(hostile));
    set(row, "settle_time", number(0.5));
    return results;
}

typedef struct report {
    json_t *results;
    pl_cells cells;
    pl_losses losses;
    pl_sheet html, markdown;
} report;

/* Takes `results`. */
static report make_report(json_t *results)
{
    report made = {.results = results};
    pl_error error = {PL_OK, ""};
    if (pl_cells_build(results, &made.cells, &error) != PL_OK)
        fail_msg("%s", error.message);
    assert_int_equal(pl_losses_find(&made.cells, &made.losses, &error), PL_OK);
    pl_html_write(&made.cells, &made.losses, &made.html);
    pl_markdown_write(&made.cells, &made.losses, &made.markdown);
    assert_false(made.html.failed);
    assert_false(made.markdown.failed);
    return made;
}

static void free_report(report *made)
{
    pl_losses_free(&made->losses);
    pl_cells_free(&made->cells);
    pl_sheet_free(&made->html);
    pl_sheet_free(&made->markdown);
    json_decref(made->results);
}

/* The terminal's table; the caller frees. */
static char *printed(const json_t *results, bool colour, int width)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    pl_report_print_table(out, results, colour, width);
    fclose(out);
    return text;
}

static int count_of(const char *text, const char *part)
{
    int count = 0;
    for (const char *at = strstr(text, part); at != NULL; at = strstr(at + 1, part))
        count++;
    return count;
}

static void assert_absent(const char *text, const char *part)
{
    if (strstr(text, part) != NULL)
        fail_msg("\"%s\" is in the text", part);
}

static void assert_before(const char *text, const char *first, const char *second)
{
    assert_contains(text, first);
    assert_contains(text, second);
    if (strstr(text, first) > strstr(text, second))
        fail_msg("\"%s\" stands after \"%s\"", first, second);
}

/* --- Numbers --- */

static void test_quantity_has_three_digits_and_an_engineers_unit(void **state)
{
    (void)state;
    static const struct {
        double value;
        const char *unit, *text;
    } cases[] = {
        {1.2e-7, "m", "1.20e-7 m"},
        {0.0123456, "m", "0.0123 m"},
        {0, "m", "0 m"},
        {9.996, "1", "10.0"},
        {1234, "1", "1234"},
        {123456, "1", "1.23e5"},
        {-2.5e-9, "m/s", "-2.50e-9 m/s"},
        {4.32e-5, "s", "43.2 µs"},
        {1.5e-3, "s", "1.50 ms"},
        {0.9999, "s", "1.00 s"},
        {2e-10, "s", "0.200 ns"},
        {0, "s", "0 s"},
        {12345678, "bytes", "12.3 MB"},
        {512, "bytes", "512 B"},
        {0, "bytes", "0 B"},
        {0.001, "m", "0.00100 m"},
        {5e-324, "m", "4.94e-324 m"},
        {1, "as it says", "1.00 as it says"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[PL_QUANTITY_SIZE];
        pl_quantity_text(cases[i].value, cases[i].unit, text);
        assert_string_equal(text, cases[i].text);
    }
}

static void test_no_number_is_a_dash_and_never_zero(void **state)
{
    (void)state;
    char text[PL_QUANTITY_SIZE];
    pl_quantity_text((double)NAN, "m", text);
    assert_string_equal(text, "–");
    pl_quantity_text((double)INFINITY, "s", text);
    assert_string_equal(text, "–");
}

/* --- Cells --- */

static void test_repeats_give_the_median_and_its_absolute_deviation(void **state)
{
    (void)state;
    static const double times[] = {5e-3, 1e-3, 2e-3, 90e-3, 3e-3};
    json_t *results = json_array();
    for (int i = 0; i < 5; i++) {
        json_t *row = add(results, "s", "ode:quick", "ok");
        json_object_set_new(row, "repeat", json_integer(i));
        set(row, "time_per_step", number(times[i]));
    }
    report made = make_report(results);
    assert_int_equal(made.cells.block_count, 1);
    assert_int_equal(made.cells.column_count, 1);
    const pl_measure *time = &made.cells.blocks[0].cells[0].measure[PL_METRIC_TIME_PER_STEP];
    assert_int_equal(time->count, 5);
    assert_close(time->value, 3e-3, 0, 1e-15);
    assert_close(time->min, 1e-3, 0, 1e-15);
    assert_close(time->max, 90e-3, 0, 1e-15);
    assert_close(time->mad, 2e-3, 0, 1e-12); /* of 0, 1, 2, 2, 87 ms */
    assert_false(time->disagrees);
    assert_contains(made.html.data, "median of 5 repeats, 1.00 ms to 90.0 ms, MAD 2.00 ms");
    free_report(&made);
}

static void test_median_of_an_even_number_is_the_mean_of_the_middle_two(void **state)
{
    (void)state;
    static const double times[] = {4e-3, 1e-3, 2e-3, 90e-3};
    json_t *results = json_array();
    for (int i = 0; i < 4; i++) {
        json_t *row = add(results, "s", "ode:quick", "ok");
        json_object_set_new(row, "repeat", json_integer(i));
        set(row, "time_per_step", number(times[i]));
    }
    report made = make_report(results);
    assert_close(made.cells.blocks[0].cells[0].measure[PL_METRIC_TIME_PER_STEP].value, 3e-3, 0,
                 1e-15);
    free_report(&made);
}

static void test_deterministic_metric_that_differs_between_repeats_is_called_so(void **state)
{
    (void)state;
    json_t *results = json_array();
    for (int i = 0; i < 2; i++) {
        json_t *row = add(results, "s", "ode:quick", "ok");
        json_object_set_new(row, "repeat", json_integer(i));
        set(row, "drift", number(i == 0 ? 1.0 : nextafter(1.0, 2.0)));
    }
    report made = make_report(results);
    assert_true(made.cells.disagrees);
    assert_contains(made.html.data, "not deterministic");
    assert_contains(made.html.data, "<b>Not deterministic:</b>");
    assert_contains(made.markdown.data, "**Not deterministic:**");
    char *table = printed(made.results, false, 200);
    assert_contains(table, "(not deterministic)");
    free(table);
    free_report(&made);
}

static void test_repeats_that_agree_are_not_called_nondeterministic(void **state)
{
    (void)state;
    json_t *results = json_array();
    for (int i = 0; i < 3; i++) {
        json_t *row = add(results, "s", "ode:quick", "ok");
        json_object_set_new(row, "repeat", json_integer(i));
        set(row, "drift", number(0.1));
        set(row, "state_hash", json_pack("{s:s}", "value", "00ff"));
        set(row, "time_per_step", number(1e-3 * (i + 1)));
    }
    report made = make_report(results);
    assert_false(made.cells.disagrees);
    assert_absent(made.html.data, "<b>Not deterministic:</b>");
    assert_absent(made.html.data, "not deterministic</span>");
    free_report(&made);
}

static void test_one_failed_repeat_makes_the_run_failed_and_says_in_how_many(void **state)
{
    (void)state;
    json_t *results = json_array();
    for (int i = 0; i < 3; i++) {
        json_t *row = add(results, "s", "ode:quick", i == 1 ? "crashed" : "ok");
        json_object_set_new(row, "repeat", json_integer(i));
    }
    report made = make_report(results);
    const pl_cell *cell = &made.cells.blocks[0].cells[0];
    assert_false(cell->ok);
    assert_int_equal(cell->ok_repeats, 2);
    assert_true(pl_cell_disagrees(cell));
    assert_contains(made.html.data, "crashed in 1 of 3");
    free_report(&made);
}

static void test_order_of_rows_does_not_change_the_pages(void **state)
{
    (void)state;
    json_t *forward = all_kinds(), *backward = json_array();
    for (size_t i = json_array_size(forward); i-- > 0;)
        json_array_append(backward, json_array_get(forward, i));
    report a = make_report(forward), b = make_report(backward);
    assert_string_equal(a.html.data, b.html.data);
    assert_string_equal(a.markdown.data, b.markdown.data);
    free_report(&a);
    free_report(&b);
}

static void test_row_that_was_merged_twice_counts_once(void **state)
{
    (void)state;
    json_t *results = json_array();
    json_t *row = add(results, "s", "ode:quick", "ok");
    json_array_append_new(results, json_deep_copy(row));
    report made = make_report(results);
    assert_int_equal(made.cells.run_count, 1);
    free_report(&made);
}

static void test_parameters_seed_and_scene_make_problems_of_their_own(void **state)
{
    (void)state;
    json_t *results = json_array();
    add(results, "s", "ode:quick", "ok");
    json_object_set_new(json_object_get(add(results, "s", "ode:quick", "ok"), "params"), "n",
                        json_integer(5));
    json_object_set_new(add(results, "s", "ode:quick", "ok"), "seed", json_integer(7));
    json_object_set_new(add(results, "s", "ode:quick", "ok"), "scene_hash", json_string("beef"));
    report made = make_report(results);
    assert_int_equal(made.cells.block_count, 4);
    for (int i = 0; i < 4; i++)
        assert_int_equal(made.cells.blocks[i].cells[0].repeats, 1);
    assert_contains(made.html.data, "s seed=7");
    free_report(&made);
}

static void test_two_versions_of_an_engine_are_two_columns(void **state)
{
    (void)state;
    json_t *results = json_array();
    add(results, "s", "ode:quick", "ok");
    json_object_set_new(add(results, "s", "ode:quick", "ok"), "engine_version", json_string("2.0"));
    report made = make_report(results);
    assert_int_equal(made.cells.column_count, 2);
    assert_string_equal(made.cells.columns[0].name, "ode:quick 1.0");
    assert_string_equal(made.cells.columns[1].name, "ode:quick 2.0");
    free_report(&made);
}

static void test_bad_row_is_named_with_what_was_expected(void **state)
{
    (void)state;
    static const char *const texts[][2] = {
        {"{}", "expected an array"},
        {"[1]", "results[0]: expected an object"},
        {"[{}]", "results[0].schema: expected \"plumb.result/1\", found \"\""},
        {"[{\"schema\":\"plumb.result/2\"}]", "found \"plumb.result/2\""},
        {"[{\"schema\":\"plumb.result/1\",\"scenario\":1}]",
         "results[0].scenario: expected a string"},
        {"[{\"schema\":\"plumb.result/1\",\"scenario\":\"s\",\"engine\":\"e\",\"label\":\"l\","
         "\"outcome\":\"ok\",\"metrics\":[]}]",
         "results[0].metrics: expected an object"},
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        json_t *results = json_loads(texts[i][0], 0, NULL);
        pl_error error = {PL_OK, ""};
        assert_int_equal(pl_report_write("/nonexistent", results, &error), PL_BAD_INPUT);
        assert_contains(error.message, texts[i][1]);
        char *table = printed(results, false, 80);
        assert_contains(table, texts[i][1]);
        free(table);
        json_decref(results);
    }
}

static void test_row_with_the_least_that_is_required_makes_a_page(void **state)
{
    (void)state;
    report made = make_report(json_loads(
        "[{\"schema\":\"plumb.result/1\",\"scenario\":\"s\",\"engine\":\"e\",\"label\":\"l\","
        "\"outcome\":\"ok\",\"metrics\":{\"drift\":3,\"creep\":{\"value\":[]}}}]",
        0, NULL));
    assert_contains(made.html.data, "</html>");
    free_report(&made);
}

/* --- Losses --- */

static void test_loss_is_the_ratio_to_the_best_good_run_of_another_engine(void **state)
{
    (void)state;
    json_t *results = duel("drift", 6e-3, 2e-3);
    set(add(results, "duel", "bullet:si", "ok"), "drift", number(3e-3));
    set(add(results, "duel", "bullet:nncg", "collapsed"), "drift", number(1e-9));
    set(add(results, "duel", "plumb:accurate", "ok"), "drift", number(1e-3));
    json_t *row;
    size_t index;
    json_array_foreach(results, index, row)
        json_object_set_new(row, "primary_error", json_string(""));
    report made = make_report(results);
    assert_int_equal(made.losses.count, 1);
    assert_int_equal(made.losses.comparisons, 2);
    const pl_loss *loss = &made.losses.items[0];
    assert_int_equal(loss->kind, PL_LOSS_VALUE);
    assert_int_equal(loss->metric, PL_METRIC_DRIFT);
    assert_string_equal(loss->ours->label, "plumb:fast");
    assert_string_equal(loss->best->label, "ode:quick");
    assert_close(loss->ratio, 3, 0, 1e-15);
    free_report(&made);
}

static void test_difference_below_noise_is_no_loss(void **state)
{
    (void)state;
    static const struct {
        const char *metric;
        double ours, theirs;
        int losses;
    } cases[] = {
        {"creep", 9e-13, 1e-16, 0},
        {"creep", 2e-12, 1e-16, 1},
        {"time_per_step", 1.09e-3, 1e-3, 0},
        {"time_per_step", 1.11e-3, 1e-3, 1},
        {"memory_peak", 1.09e6, 1e6, 0},
        {"memory_peak", 1.2e6, 1e6, 1},
        {"creep", 1e-3, 1e-3, 0},
        {"creep", 1.001e-3, 1e-3, 1},
        {"creep", 1e-3, 0, 1},
        {"iterations_mean", 50, 10, 0},
        {"iterations_max", 50, 10, 0},
        {"residual_max", 50, 10, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        report made = make_report(duel(cases[i].metric, cases[i].ours, cases[i].theirs));
        if (made.losses.count != cases[i].losses)
            fail_msg("%s %g against %g: %d losses", cases[i].metric, cases[i].ours, cases[i].theirs,
                     made.losses.count);
        free_report(&made);
    }
}

static void test_primary_error_is_not_counted_under_two_names(void **state)
{
    (void)state;
    json_t *results = duel("drift", 2e-3, 1e-3); /* the primary error of these rows */
    set(json_array_get(results, 0), "reference_error", number(2e-3));
    set(json_array_get(results, 1), "reference_error", number(1e-3));
    report made = make_report(results);
    assert_int_equal(made.losses.count, 1);
    assert_int_equal(made.losses.items[0].metric, PL_METRIC_REFERENCE_ERROR);
    assert_contains(made.html.data, "reference_error (drift)");
    free_report(&made);
}

static void test_losses_go_from_failure_over_missing_value_to_falling_ratio(void **state)
{
    (void)state;
    json_t *results = duel("creep", 2e-3, 1e-3);
    json_t *ours = json_array_get(results, 0), *theirs = json_array_get(results, 1);
    set(ours, "settle_time", json_pack("{s:n, s:s}", "value", "reason", "it never rests"));
    set(theirs, "settle_time", number(1));
    set(ours, "energy_gain", number(5e-3));
    set(theirs, "energy_gain", number(1e-3));
    set(ours, "penetration_max", number(1e-3));
    set(theirs, "penetration_max", number(0));
    add(results, "other", "plumb:fast", "timeout");
    add(results, "other", "ode:quick", "ok");
    report made = make_report(results);
    assert_int_equal(made.losses.count, 5);
    assert_int_equal(made.losses.items[0].kind, PL_LOSS_OUTCOME);
    assert_string_equal(made.losses.items[0].block->scenario, "other");
    assert_int_equal(made.losses.items[1].kind, PL_LOSS_NO_VALUE);
    assert_int_equal(made.losses.items[1].metric, PL_METRIC_SETTLE_TIME);
    assert_int_equal(made.losses.items[2].metric, PL_METRIC_PENETRATION_MAX);
    assert_true(isinf(made.losses.items[2].ratio));
    assert_int_equal(made.losses.items[3].metric, PL_METRIC_ENERGY_GAIN);
    assert_close(made.losses.items[3].ratio, 5, 0, 1e-15);
    assert_int_equal(made.losses.items[4].metric, PL_METRIC_CREEP);
    assert_contains(made.html.data, "it never rests");
    free_report(&made);
}

static void test_times_of_different_machines_are_not_compared(void **state)
{
    (void)state;
    json_t *results = duel("time_per_step", 2e-3, 1e-3);
    json_object_set_new(json_object_get(json_array_get(results, 1), "host"), "cpu",
                        json_string("two"));
    report made = make_report(results);
    assert_int_equal(made.losses.count, 0);
    assert_contains(made.html.data, "come from several machines");
    free_report(&made);
}

static void test_no_losses_is_said_with_what_was_compared(void **state)
{
    (void)state;
    report made = make_report(duel("creep", 1e-3, 2e-3));
    static const char words[] =
        "No losses: in none of 1 comparisons is plumb worse than the best other "
        "engine, over 1 problem: plumb:fast against the best of ode:quick.";
    assert_contains(made.html.data, words);
    assert_contains(made.markdown.data, words);
    char *table = printed(made.results, false, 1000);
    assert_contains(table, words);
    free(table);
    free_report(&made);
}

static void test_nothing_compared_is_not_called_no_losses(void **state)
{
    (void)state;
    json_t *ours = json_array(), *theirs = json_array(), *apart = json_array();
    add(ours, "s", "plumb:fast", "ok");
    add(theirs, "s", "ode:quick", "ok");
    add(apart, "s", "plumb:fast", "ok");
    add(apart, "s", "ode:quick", "timeout");
    report reports[] = {make_report(ours), make_report(theirs), make_report(apart),
                        make_report(json_array())};
    for (int i = 0; i < 4; i++) {
        assert_contains(reports[i].html.data, "Nothing was compared");
        assert_absent(reports[i].html.data, "No losses");
        free_report(&reports[i]);
    }
}

static void test_losses_stand_before_every_other_table(void **state)
{
    (void)state;
    report made = make_report(all_kinds());
    assert_before(made.html.data, "Where plumb loses", "<table>");
    assert_before(made.html.data, "Where plumb loses", "id=\"results\"");
    assert_before(made.markdown.data, "## Where plumb loses", "\n|");
    assert_before(made.markdown.data, "## Where plumb loses", "## Results");
    char *table = printed(made.results, false, 100);
    assert_int_equal(strncmp(table, "Where plumb loses\n", 18), 0);
    free(table);
    free_report(&made);
}

/* --- Tables --- */

static void test_every_problem_and_engine_is_in_every_table(void **state)
{
    (void)state;
    static const char *const scenarios[] = {"alpha", "beta", "gamma"};
    static const char *const labels[] = {"plumb:fast", "ode:quick", "bullet:si"};
    json_t *results = json_array();
    for (int s = 0; s < 3; s++)
        for (int l = 0; l < 3; l++)
            set(add(results, scenarios[s], labels[l], "ok"), "reference_error",
                number(1.11e-3 * (1 + s * 3 + l)));
    report made = make_report(results);
    char *table = printed(made.results, false, 100);
    const char *texts[] = {made.html.data, made.markdown.data, table};
    for (int t = 0; t < 3; t++) {
        for (int i = 0; i < 3; i++) {
            assert_contains(texts[t], scenarios[i]);
            assert_contains(texts[t], labels[i]);
        }
        for (int i = 0; i < 9; i++) {
            char value[PL_QUANTITY_SIZE];
            pl_quantity_text(1.11e-3 * (1 + i), "", value);
            assert_contains(texts[t], value);
        }
    }
    free(table);
    free_report(&made);
}

static void test_run_that_is_missing_is_shown_as_not_run(void **state)
{
    (void)state;
    json_t *results = duel("creep", 1, 1);
    add(results, "alone", "ode:quick", "ok");
    report made = make_report(results);
    char *table = printed(made.results, false, 100);
    assert_contains(made.html.data, ">not run</td>");
    assert_contains(made.markdown.data, "| not run |");
    assert_contains(table, "not run");
    free(table);
    free_report(&made);
}

static void test_missing_value_is_a_dash_with_its_reason(void **state)
{
    (void)state;
    report made = make_report(all_kinds());
    assert_contains(made.html.data, "title=\"moves to the end &lt;&amp;&gt;\">–</td>");
    free_report(&made);
}

static void test_failed_run_shows_reason_and_output(void **state)
{
    (void)state;
    report made = make_report(all_kinds());
    static const char *const outcomes[] = {"collapsed", "diverged", "nonfinite",
                                           "crashed",   "timeout",  "unsupported"};
    const char *failures = strstr(made.html.data, "id=\"failures\"");
    assert_non_null(failures);
    for (int i = 0; i < 6; i++)
        assert_contains(failures, outcomes[i]);
    assert_contains(failures, "<pre>&lt;script&gt;alert");
    free_report(&made);
}

static void test_best_value_is_bold_among_good_runs_alone(void **state)
{
    (void)state;
    json_t *results = duel("creep", 2e-3, 3e-3);
    set(add(results, "duel", "bullet:si", "collapsed"), "creep", number(1e-3));
    report made = make_report(results);
    assert_int_equal(count_of(made.html.data, "class=\"best\""), 1);
    assert_contains(made.html.data, "<b class=\"best\">0.00200 m/s</b>");
    free_report(&made);
}

static void test_values_equal_to_rounding_are_best_together(void **state)
{
    (void)state;
    json_t *results = duel("creep", 2e-16, 1e-16);
    set(add(results, "duel", "bullet:si", "ok"), "creep", number(1e-3));
    report made = make_report(results);
    assert_int_equal(count_of(made.html.data, "class=\"best\""), 2);
    free_report(&made);
}

static void test_terminal_lines_fit_the_width_and_hold_no_control_characters(void **state)
{
    (void)state;
    json_t *results = all_kinds();
    json_object_set_new(
        json_array_get(results, 1), "reason",
        json_string("\033[2J\007 \302\233 Grüße, Grüße, Grüße, Grüße, Grüße, Grüße"));
    static const int widths[] = {40, 60, 80, 120, 300};
    for (int w = 0; w < 5; w++) {
        char *table = printed(results, false, widths[w]);
        int column = 0;
        for (const char *c = table; *c != '\0'; c++) {
            unsigned char byte = (unsigned char)*c;
            bool c1 = byte == 0xc2 && (unsigned char)c[1] < 0xa0;
            assert_false((byte < 0x20 && byte != '\n') || byte == 0x7f || c1);
            column = byte == '\n' ? 0 : column + ((byte & 0xc0) != 0x80);
            assert_at_most(column, widths[w]);
        }
        free(table);
    }
    char *coloured = printed(results, true, 80);
    assert_contains(coloured, "\033[31m");
    assert_absent(coloured, "\033[2J");
    free(coloured);
    json_decref(results);
}

/* --- CSV --- */

/* Reads one field of RFC 4180 at *at into `field`; returns the delimiter and moves behind it. */
static char read_field(const char **at, char *field, size_t size)
{
    size_t length = 0;
    const char *c = *at;
    bool quoted = *c == '"';
    for (c += quoted; *c != '\0'; c++) {
        if (quoted && *c == '"') {
            if (c[1] != '"') {
                c++;
                break;
            }
            c++;
        } else if (!quoted && (*c == ',' || *c == '\r')) {
            break;
        }
        assert_true(length + 1 < size);
        field[length++] = *c;
    }
    field[length] = '\0';
    char delimiter = *c;
    assert_true(delimiter == ',' || (delimiter == '\r' && c[1] == '\n'));
    *at = c + (delimiter == ',' ? 1 : 2);
    return delimiter;
}

enum { CSV_COLUMNS = 32, CSV_FIELD = 512 };

/* Parses a line; returns how many fields it has. */
static int read_line(const char **at, char fields[CSV_COLUMNS][CSV_FIELD])
{
    int count = 0;
    char delimiter = ',';
    while (delimiter == ',') {
        assert_true(count < CSV_COLUMNS);
        delimiter = read_field(at, fields[count++], CSV_FIELD);
    }
    return count;
}

static const char *field_of(char head[CSV_COLUMNS][CSV_FIELD], char line[CSV_COLUMNS][CSV_FIELD],
                            const char *name)
{
    for (int i = 0; i < CSV_COLUMNS; i++)
        if (strcmp(head[i], name) == 0)
            return line[i];
    fail_msg("no column %s", name);
    return NULL;
}

static void test_csv_parses_back_field_for_field(void **state)
{
    (void)state;
    static char head[CSV_COLUMNS][CSV_FIELD], line[CSV_COLUMNS][CSV_FIELD];
    json_t *results = json_array();
    json_t *row = add(results, hostile, "plumb:fast", "crashed");
    json_object_set_new(row, "reason", json_string(hostile));
    json_object_set_new(json_object_get(row, "params"), "n", json_integer(25));
    set(row, "drift",
        json_pack("{s:f, s:s, s:s, s:b, s:f, s:i}", "value", 0.1, "unit", "m", "direction", "lower",
                  "deterministic", 1, "p95", 1.0 / 3, "worst_step", 7));
    set(row, "settle_time", json_pack("{s:n, s:s}", "value", "reason", hostile));
    pl_sheet sheet = {0};
    pl_csv_write(results, &sheet);
    const char *at = sheet.data;
    int columns = read_line(&at, head);
    assert_int_equal(read_line(&at, line), columns);
    assert_string_equal(field_of(head, line, "scenario"), hostile);
    assert_string_equal(field_of(head, line, "reason"), hostile);
    assert_string_equal(field_of(head, line, "params"), "{\"n\":25}");
    assert_string_equal(field_of(head, line, "label"), "plumb:fast");
    assert_string_equal(field_of(head, line, "host_cpu"), "one");
    assert_string_equal(field_of(head, line, "steps_asked"), "10");
    assert_string_equal(field_of(head, line, "metric"), "drift");
    assert_true(strtod(field_of(head, line, "value"), NULL) == 0.1);
    assert_true(strtod(field_of(head, line, "p95"), NULL) == 1.0 / 3);
    assert_string_equal(field_of(head, line, "p50"), "");
    assert_string_equal(field_of(head, line, "worst_step"), "7");
    assert_string_equal(field_of(head, line, "deterministic"), "true");
    assert_int_equal(read_line(&at, line), columns);
    assert_string_equal(field_of(head, line, "metric"), "settle_time");
    assert_string_equal(field_of(head, line, "value"), "");
    assert_string_equal(field_of(head, line, "metric_reason"), hostile);
    assert_string_equal(at, "");
    pl_sheet_free(&sheet);
    json_decref(results);
}

static void test_csv_has_a_row_for_every_metric_and_for_a_run_without_any(void **state)
{
    (void)state;
    static char head[CSV_COLUMNS][CSV_FIELD], line[CSV_COLUMNS][CSV_FIELD];
    json_t *results = all_kinds();
    pl_sheet sheet = {0};
    pl_csv_write(results, &sheet);
    size_t expected = 0;
    json_t *row;
    size_t index;
    json_array_foreach(results, index, row)
    {
        size_t metrics = json_object_size(json_object_get(row, "metrics"));
        expected += metrics > 0 ? metrics : 1;
    }
    const char *at = sheet.data;
    int columns = read_line(&at, head);
    size_t lines = 0;
    for (; *at != '\0'; lines++)
        assert_int_equal(read_line(&at, line), columns);
    assert_int_equal(lines, expected);
    pl_sheet_free(&sheet);
    json_decref(results);
}

/* --- HTML and Markdown --- */

/* Checks that every element is closed in order, attributes are quoted, and text has no bare '<' or
 * '&'. */
static void check_balance(const char *html)
{
    static const char *const empty[] = {"meta", "br", "!DOCTYPE", "path", "circle", "use"};
    enum { DEEPEST = 64 };
    char open[DEEPEST][32];
    int depth = 0;
    for (const char *c = html; *c != '\0'; c++) {
        if (*c == '&' && (c[1] == ' ' || strcspn(c, ";") > 8))
            fail_msg("bare & at %.60s", c);
        if (*c != '<')
            continue;
        bool closing = c[1] == '/';
        const char *name = c + 1 + closing;
        size_t length = strcspn(name, " />\n");
        char tag[32];
        assert_true(length > 0 && length < sizeof tag);
        snprintf(tag, sizeof tag, "%.*s", (int)length, name);
        char quote = '\0';
        for (c = name + length; *c != '\0' && (*c != '>' || quote != '\0'); c++) {
            if (*c == '"')
                quote = quote == '\0' ? '"' : '\0';
            assert_true(*c != '<');
        }
        assert_int_equal(*c, '>');
        bool leaf = c[-1] == '/';
        for (size_t i = 0; i < sizeof empty / sizeof empty[0]; i++)
            leaf |= strcmp(tag, empty[i]) == 0;
        if (closing) {
            if (depth == 0 || strcmp(open[depth - 1], tag) != 0)
                fail_msg("</%s> closes <%s>", tag, depth == 0 ? "" : open[depth - 1]);
            depth--;
        } else if (!leaf) {
            assert_true(depth < DEEPEST);
            snprintf(open[depth++], sizeof open[0], "%s", tag);
            if (strcmp(tag, "style") == 0)
                c = strstr(c, "</style>") - 1;
        }
    }
    assert_int_equal(depth, 0);
}

static void test_html_is_balanced_and_holds_no_script(void **state)
{
    (void)state;
    report made = make_report(all_kinds());
    check_balance(made.html.data);
    assert_absent(made.html.data, "<script");
    assert_absent(made.html.data, "onload=");
    assert_contains(made.html.data, "&lt;script&gt;alert(&quot;x&quot;)&lt;/script&gt;");
    assert_contains(made.html.data, "Grüße");
    free_report(&made);
}

static void test_html_makes_no_request(void **state)
{
    (void)state;
    static const char *const requests[] = {"http:", "src=",    "url(",    "@import", "<link",
                                           "<img",  "<iframe", "<object", "<base",   "http-equiv"};
    json_t *results = duel("creep", 1, 2);
    int count = 0;
    const pl_scenario *scenario = pl_scenarios(&count)[0];
    assert_true(count > 0);
    add(results, scenario->name, "plumb:fast", "ok");
    report made = make_report(results);
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++)
        assert_absent(made.html.data, requests[i]);
    for (const char *at = strstr(made.html.data, "href="); at != NULL; at = strstr(at + 1, "href="))
        assert_int_equal(at[6], '#');
    free_report(&made);
}

static void test_html_defines_every_metric(void **state)
{
    (void)state;
    report made = make_report(json_array());
    check_balance(made.html.data);
    const char *definitions = strstr(made.html.data, "id=\"metrics\"");
    assert_non_null(definitions);
    for (int i = 0; i < PL_METRIC_COUNT; i++)
        assert_contains(definitions, pl_metric_table[i].name);
    free_report(&made);
}

/* Cells of a table line: unescaped '|' less one. */
static int markdown_cells(const char *line, size_t length)
{
    int bars = 0;
    for (size_t i = 0; i < length; i++) {
        if (line[i] == '\\')
            i++;
        else
            bars += line[i] == '|';
    }
    return bars - 1;
}

static void test_markdown_tables_are_rectangular_whatever_the_texts_hold(void **state)
{
    (void)state;
    report made = make_report(all_kinds());
    int columns = -1, tables = 0;
    for (const char *line = made.markdown.data; *line != '\0';) {
        size_t length = strcspn(line, "\n");
        assert_null(memchr(line, '\r', length));
        if (line[0] == '|') {
            int cells = markdown_cells(line, length);
            tables += columns < 0;
            if (columns >= 0)
                assert_int_equal(cells, columns);
            columns = cells;
        } else {
            columns = -1;
        }
        line += length + (line[length] == '\n');
    }
    assert_int_equal(tables, 3);
    assert_absent(made.markdown.data, "<script");
    free_report(&made);
}

/* --- Files --- */

static char *make_directory(void)
{
    char *directory = strdup("/tmp/plumb-report-XXXXXX");
    assert_non_null(mkdtemp(directory));
    return directory;
}

static char *read_file(const char *directory, const char *name)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return NULL;
    char *text = calloc(1, 1 << 22);
    assert_true(fread(text, 1, (1 << 22) - 1, file) < (1 << 22) - 1);
    fclose(file);
    return text;
}

static void write_file(const char *directory, const char *name, const char *text)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static const char *const file_names[] = {"results.csv", "summary.md", "index.html"};

/* Removes the directory, which fails when any other file is left in it. */
static void remove_directory(char *directory)
{
    for (int i = 0; i < 3; i++) {
        char path[256];
        snprintf(path, sizeof path, "%s/%s", directory, file_names[i]);
        unlink(path);
    }
    assert_int_equal(rmdir(directory), 0);
    free(directory);
}

static void test_write_makes_the_three_files_and_nothing_else(void **state)
{
    (void)state;
    char *directory = make_directory();
    json_t *results = all_kinds();
    pl_error error = {PL_OK, ""};
    if (pl_report_write(directory, results, &error) != PL_OK)
        fail_msg("%s", error.message);
    report made = make_report(results);
    char *html = read_file(directory, "index.html"), *markdown = read_file(directory, "summary.md");
    char *csv = read_file(directory, "results.csv");
    assert_string_equal(html, made.html.data);
    assert_string_equal(markdown, made.markdown.data);
    assert_non_null(csv);
    free(html);
    free(markdown);
    free(csv);
    free_report(&made);
    remove_directory(directory);
}

static void test_full_disk_leaves_what_stood_there(void **state)
{
    (void)state;
    char *directory = make_directory();
    for (int i = 0; i < 3; i++)
        write_file(directory, file_names[i], "old");
    json_t *results = all_kinds();
    struct rlimit before, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    small = (struct rlimit){.rlim_cur = 5000, .rlim_max = before.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    pl_error error = {PL_OK, ""};
    pl_status status = pl_report_write(directory, results, &error);
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, handler);
    assert_int_equal(status, PL_IO);
    assert_contains(error.message, "cannot be written");
    for (int i = 0; i < 3; i++) {
        char *text = read_file(directory, file_names[i]);
        assert_string_equal(text, "old");
        free(text);
    }
    json_decref(results);
    remove_directory(directory);
}

static void test_missing_directory_is_an_io_error_that_names_the_file(void **state)
{
    (void)state;
    json_t *results = all_kinds();
    pl_error error = {PL_OK, ""};
    assert_int_equal(pl_report_write("/nonexistent/report", results, &error), PL_IO);
    assert_contains(error.message, "/nonexistent/report/results.csv");
    json_decref(results);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_quantity_has_three_digits_and_an_engineers_unit),
        cmocka_unit_test(test_no_number_is_a_dash_and_never_zero),
        cmocka_unit_test(test_repeats_give_the_median_and_its_absolute_deviation),
        cmocka_unit_test(test_median_of_an_even_number_is_the_mean_of_the_middle_two),
        cmocka_unit_test(test_deterministic_metric_that_differs_between_repeats_is_called_so),
        cmocka_unit_test(test_repeats_that_agree_are_not_called_nondeterministic),
        cmocka_unit_test(test_one_failed_repeat_makes_the_run_failed_and_says_in_how_many),
        cmocka_unit_test(test_order_of_rows_does_not_change_the_pages),
        cmocka_unit_test(test_row_that_was_merged_twice_counts_once),
        cmocka_unit_test(test_parameters_seed_and_scene_make_problems_of_their_own),
        cmocka_unit_test(test_two_versions_of_an_engine_are_two_columns),
        cmocka_unit_test(test_bad_row_is_named_with_what_was_expected),
        cmocka_unit_test(test_row_with_the_least_that_is_required_makes_a_page),
        cmocka_unit_test(test_loss_is_the_ratio_to_the_best_good_run_of_another_engine),
        cmocka_unit_test(test_difference_below_noise_is_no_loss),
        cmocka_unit_test(test_primary_error_is_not_counted_under_two_names),
        cmocka_unit_test(test_losses_go_from_failure_over_missing_value_to_falling_ratio),
        cmocka_unit_test(test_times_of_different_machines_are_not_compared),
        cmocka_unit_test(test_no_losses_is_said_with_what_was_compared),
        cmocka_unit_test(test_nothing_compared_is_not_called_no_losses),
        cmocka_unit_test(test_losses_stand_before_every_other_table),
        cmocka_unit_test(test_every_problem_and_engine_is_in_every_table),
        cmocka_unit_test(test_run_that_is_missing_is_shown_as_not_run),
        cmocka_unit_test(test_missing_value_is_a_dash_with_its_reason),
        cmocka_unit_test(test_failed_run_shows_reason_and_output),
        cmocka_unit_test(test_best_value_is_bold_among_good_runs_alone),
        cmocka_unit_test(test_values_equal_to_rounding_are_best_together),
        cmocka_unit_test(test_terminal_lines_fit_the_width_and_hold_no_control_characters),
        cmocka_unit_test(test_csv_parses_back_field_for_field),
        cmocka_unit_test(test_csv_has_a_row_for_every_metric_and_for_a_run_without_any),
        cmocka_unit_test(test_html_is_balanced_and_holds_no_script),
        cmocka_unit_test(test_html_makes_no_request),
        cmocka_unit_test(test_html_defines_every_metric),
        cmocka_unit_test(test_markdown_tables_are_rectangular_whatever_the_texts_hold),
        cmocka_unit_test(test_write_makes_the_three_files_and_nothing_else),
        cmocka_unit_test(test_full_disk_leaves_what_stood_there),
        cmocka_unit_test(test_missing_directory_is_an_io_error_that_names_the_file),
    };
    return cmocka_run_group_tests_name("report", tests, NULL, NULL);
}
