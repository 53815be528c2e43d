/* The conclusions of metamorphic checks and of ensembles, from results that are made up. */
#include "check.h"
#include "plumb_process.h"
#include "studies/ensemble/ensemble.h"
#include "studies/metamorphic/metamorphic.h"

#include <string.h>

static json_t *conclude(const pl_study *study, json_t *results)
{
    json_t *conclusion = NULL;
    pl_error error = {.message = ""};
    if (study->conclude(results, "/nonexistent", &conclusion, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    json_decref(results);
    return conclusion;
}

/* ---- Metamorphic checks ---- */

static json_t *plain_run(const char *run, const char *outcome, double size)
{
    return json_pack("{s:s, s:s, s:s, s:s, s:{s:s, s:s}, s:{s:f}}", "run", run, "scenario", "tower",
                     "label", "plumb", "outcome", outcome, "study", "name", "metamorphic", "check",
                     "plain", "agreement", "size", size);
}

static json_t *check_run(const char *plain, const char *check, const char *outcome,
                         const char *early, const char *end)
{
    json_t *run =
        json_pack("{s:s, s:s, s:s, s:{s:s, s:s, s:s}}", "scenario", "tower", "outcome", outcome,
                  "reason", "why", "study", "name", "metamorphic", "check", check, "plain", plain);
    if (early != NULL) {
        json_object_set_new(run, "agreement",
                            json_pack("{s:f, s:{s:s, s:f}, s:{s:s, s:f}}", "passes_at", 0.5,
                                      "early", "verdict", early, "position", 1e-10, "end",
                                      "verdict", end, "position", 2e-3));
    }
    return run;
}

static void test_a_check_has_its_early_and_late_verdict(void **state)
{
    (void)state;
    json_t *rows = conclude(&pl_metamorphic_study,
                            json_pack("[o, o, o, o]", plain_run("1", "ok", 2),
                                      check_run("1", "mirror", "ok", "exact", "differs"),
                                      check_run("1", "split-x", "unsupported", NULL, NULL),
                                      check_run("1", "far", "crashed", NULL, NULL)));
    const json_t *checks = json_object_get(json_array_get(rows, 0), "checks");
    const json_t *mirror = json_array_get(checks, 0), *far = json_array_get(checks, 1),
                 *split = json_array_get(checks, 2);
    assert_int_equal(json_array_size(checks), 3);
    assert_string_equal(result_text(mirror, "check"), "mirror");
    assert_string_equal(result_text(mirror, "verdict"), "differs");
    assert_string_equal(result_text(json_object_get(mirror, "early"), "verdict"), "exact");
    assert_string_equal(result_text(json_object_get(mirror, "end"), "verdict"), "differs");
    assert_true(json_is_null(json_object_get(mirror, "reason")));
    assert_string_equal(result_text(far, "verdict"), "failed");
    assert_string_equal(result_text(far, "reason"), "transformed run crashed: why");
    assert_true(json_is_null(json_object_get(json_object_get(far, "end"), "position")));
    assert_string_equal(result_text(split, "verdict"), "inapplicable");
    assert_string_equal(result_text(split, "reason"), "why");
    json_decref(rows);
}

static void test_checks_belong_to_the_newest_plain_run(void **state)
{
    (void)state;
    json_t *rows = conclude(&pl_metamorphic_study,
                            json_pack("[o, o, o, o]", plain_run("1", "ok", 2),
                                      check_run("1", "mirror", "ok", "exact", "differs"),
                                      plain_run("2", "ok", 3),
                                      check_run("2", "again", "ok", "bitwise", "bitwise")));
    const json_t *row = json_array_get(rows, 0);
    const json_t *checks = json_object_get(row, "checks");
    assert_int_equal(json_array_size(rows), 1);
    assert_close(json_number_value(json_object_get(row, "size")), 3, 0, 0);
    assert_int_equal(json_array_size(checks), 1);
    assert_string_equal(result_text(json_array_get(checks, 0), "check"), "again");
    json_decref(rows);
}

static void test_a_result_of_another_form_is_refused(void **state)
{
    (void)state;
    static const pl_study *const studies[] = {&pl_metamorphic_study, &pl_ensemble_study};
    for (int i = 0; i < 2; ++i) {
        json_t *results = json_pack("[{s:s, s:{s:s}}]", "run", "1", "study", "name", "other");
        json_t *conclusion = NULL;
        pl_error error = {.message = ""};
        assert_int_equal(studies[i]->conclude(results, "/nonexistent", &conclusion, &error),
                         PL_BAD_INPUT);
        assert_contains(error.message, "results[0]: expected");
        assert_null(conclusion);
        json_decref(results);
    }
}

/* ---- Ensembles ---- */

static json_t *member_run(const char *run, int setting, int member, int members, double spread)
{
    return json_pack("{s:s, s:s, s:s, s:s, s:i, s:i, s:{s:s, s:{}, s:i, s:s?, s:b}, s:{s:f, s:f},"
                     " s:{s:i, s:i, s:f, s:b}, s:{s:{s:f}}}",
                     "run", run, "scenario", "pile", "label", "plumb", "outcome", "ok", "seed", 0,
                     "member", member, "study", "name", "ensemble", "case", "setting", setting,
                     "against", setting == 0 ? NULL : "itself", "converged", 0, "settings", "dt",
                     0.01, "duration", 1.0, "ensemble", "members", members, "place", setting,
                     "least_size", 1.0, "fell_through", member == 1, "metrics", "spread_x", "value",
                     spread);
}

static void test_a_negative_member_is_refused(void **state)
{
    (void)state;
    json_t *results = json_pack("[o]", member_run("a", 0, -1, 2, 1)), *conclusion = NULL;
    pl_error error = {.message = ""};
    assert_int_equal(pl_ensemble_study.conclude(results, "/nonexistent", &conclusion, &error),
                     PL_BAD_INPUT);
    assert_contains(error.message, "results[0]: expected a member of an ensemble");
    json_decref(results);
}

static void check_values(const json_t *ensemble, const double *expected, size_t count)
{
    const json_t *sample = json_object_get(json_object_get(ensemble, "observables"), "spread_x");
    const json_t *values = json_object_get(sample, "values");
    assert_int_equal(json_array_size(values), count);
    for (size_t i = 0; i < count; ++i) {
        assert_close(json_number_value(json_array_get(values, i)), expected[i], 0, 0);
    }
}

/* Two members were asked for, and later four: those of the other setting have numbers from 4 on. */
static void test_members_are_in_order_and_the_newest_count(void **state)
{
    (void)state;
    json_t *conclusion = conclude(
        &pl_ensemble_study, json_pack("[o, o, o, o, o, o, o, o]", member_run("a", 0, 1, 2, 1),
                                      member_run("b", 0, 0, 2, 2), member_run("c", 1, 2, 2, 3),
                                      member_run("d", 0, 3, 4, 4), member_run("e", 0, 2, 4, 5),
                                      member_run("f", 1, 5, 4, 6), member_run("g", 1, 4, 4, 7),
                                      member_run("h", 0, 1, 4, 8)));
    const json_t *ensembles = json_object_get(conclusion, "ensembles");
    const json_t *asked = json_array_get(ensembles, 0), *itself = json_array_get(ensembles, 1);
    assert_int_equal(json_integer_value(json_object_get(conclusion, "members")), 4);
    assert_int_equal(json_array_size(ensembles), 2);
    check_values(asked, (const double[]){2, 8, 5, 4}, 4);
    check_values(itself, (const double[]){7, 6}, 2);
    assert_string_equal(json_string_value(json_array_get(json_object_get(asked, "runs"), 1)), "h");
    assert_string_equal(result_text(itself, "name"), "plumb [itself]");
    const json_t *kept = json_object_get(asked, "invariants");
    assert_int_equal(json_integer_value(json_object_get(kept, "fell_through")), 1);
    assert_contains(result_text(json_object_get(asked, "horizon"), "reason"), "0 of 4 members");
    json_decref(conclusion);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_check_has_its_early_and_late_verdict),
        cmocka_unit_test(test_checks_belong_to_the_newest_plain_run),
        cmocka_unit_test(test_a_result_of_another_form_is_refused),
        cmocka_unit_test(test_a_negative_member_is_refused),
        cmocka_unit_test(test_members_are_in_order_and_the_newest_count),
    };
    return cmocka_run_group_tests_name("study conclusions", tests, NULL, NULL);
}
