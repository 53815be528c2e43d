/* Everything that a scene states is judged: one deviation, of any kind, makes the run inaccurate and is
 * named. */
#include "check.h"
#include "results/result.h"
#include "synthetic_run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { KINDS = 10 };

/* What a still body of the synthetic scene is expected to do; `off` is the deviation of one of them. */
static void expect_all(run *r, int kind, double off)
{
    static const pl_quantity quantities[] = {PL_QUANTITY_POSITION, PL_QUANTITY_VELOCITY,
                                             PL_QUANTITY_SPIN, PL_QUANTITY_TURN, PL_QUANTITY_APEX};
    const double tilt = kind == 1 ? off : 0;
    pl_expect_rest rest = {.body = 1,
                           .position = {kind == 0 ? off : 0, 0, 0.5},
                           .orientation = {cos(0.5 * tilt), 0, sin(0.5 * tilt), 0},
                           .has_orientation = true,
                           .tolerance = 0.01,
                           .orientation_tolerance = 0.01};
    assert_int_equal(pl_scene_add_rest(&r->scene, &rest, NULL), PL_OK);
    pl_expect_travel travel = {.body = 2,
                               .direction = {1, 0, 0},
                               .distance = 1 + (kind == 2 ? off : 0),
                               .discrete = (double)NAN,
                               .tolerance = 0.01};
    assert_int_equal(pl_scene_add_travel(&r->scene, &travel, NULL), PL_OK);
    for (int i = 0; i < 5; ++i) {
        pl_expect_value value = {.body = 1,
                                 .quantity = quantities[i],
                                 .direction = {0, 0, 1},
                                 .until = 1,
                                 .value = kind == 3 + i ? off : 0,
                                 .discrete = (double)NAN,
                                 .scale = 1,
                                 .tolerance = 0.01};
        assert_int_equal(pl_scene_add_value(&r->scene, &value, NULL), PL_OK);
    }
    for (int i = 0; i < 2; ++i) {
        const double right = i == 0 ? 0.5 : 0.95, low = right + (kind == 8 + i ? off : 0);
        pl_expect_statistic statistic = {.metric = i == 0 ? PL_STATISTIC_MASS_HEIGHT
                                                          : PL_STATISTIC_RUN_OUT_P95,
                                         .low = low,
                                         .high = low,
                                         .scale = 1,
                                         .tolerance = 0.01};
        assert_int_equal(pl_scene_add_statistic(&r->scene, &statistic, NULL), PL_OK);
    }
}

/* A cube that rests on a floor, and one that moves by 1 m beside it; what the verdict is made of. */
static pl_verdict judged(int kind, double off, char reason[1024])
{
    run r;
    run_prepare_box_on_floor(&r, 1);
    r.scene.rest_count = 0;
    run_add_body(&r, "slider", pl_shape_box(0.5, 0.5, 0.5), false, 5, 0.5);
    expect_all(&r, kind, off);
    snprintf(r.scene.primary_error, sizeof r.scene.primary_error, "travel_error");
    run_begin(&r);
    for (int n = 1; n <= 64; ++n) {
        r.state[2].position[0] = 5 + n * H;
        r.state[2].velocity[0] = 1;
        run_step_many(&r, 1);
    }
    run_finish(&r);
    pl_run_result result = {.outcome = PL_OUTCOME_OK, .metrics = r.metrics};
    json_t *identity = json_pack("{s:s, s:n}", "primary_error", "travel_error", "acceptance");
    json_t *outcome = pl_run_result_to_json(&result), *provenance = json_object();
    json_object_del(json_object_get(outcome, "metrics"), "unexplained_motion");
    json_t *whole = pl_result_compose(identity, outcome, provenance, "", 0, "now");
    const pl_verdict verdict = pl_verdict_of(whole);
    snprintf(reason, 1024, "%s", pl_json_get_text(whole, "verdict_reason"));
    json_decref(whole);
    json_decref(identity);
    json_decref(outcome);
    json_decref(provenance);
    run_end(&r);
    return verdict;
}

static void test_twenty_random_deviations_are_named(void **state)
{
    (void)state;
    static const char *const names[KINDS] = {
        "rest of \"box\"",     "orientation of \"box\"", "end of the travel of \"slider\"",
        "position of \"box\"", "velocity of \"box\"",    "spin of \"box\"",
        "turn of \"box\"",     "apex of \"box\"",        "mass_height",
        "run_out_p95"};
    check_random random = {2026};
    for (int i = 0; i < 2 * KINDS; ++i) {
        char reason[1024], expected[64];
        const int kind = i % KINDS;
        const double off = check_uniform(&random, 0.011, 0.4);
        assert_int_equal(judged(kind, off, reason), PL_VERDICT_INACCURATE);
        assert_true(strncmp(reason, names[kind], strlen(names[kind])) == 0);
        assert_contains(reason, ": ");
        snprintf(expected, sizeof expected, "within 0.01");
        assert_contains(reason, expected);
        assert_absent(reason, ";");
    }
}

static void test_a_run_within_all_tolerances_is_accurate(void **state)
{
    (void)state;
    char reason[1024];
    for (int kind = 0; kind < KINDS; ++kind) {
        assert_int_equal(judged(kind, 0.0099, reason), PL_VERDICT_ACCURATE);
        assert_string_equal(reason, "");
    }
}

static void test_number_and_bound_never_print_equal(void **state)
{
    (void)state;
    char reason[1024];
    assert_int_equal(judged(3, 0.0100001, reason), PL_VERDICT_INACCURATE);
    assert_contains(reason, "0.0100001 m within 0.01 m");
}

/* What a value of a ball is found to be that moves up and down with z = sin 2 pi t, 1 m/s along x. */
static double value_found(pl_quantity quantity, pl_bound bound, double number, double expected)
{
    const double turn = 6.283185307179586;
    run r;
    run_prepare(&r, 3);
    run_add_body(&r, "ball", pl_shape_sphere(0.5), false, 0, 0);
    pl_expect_value value = pl_expect_value_default(&r.scene);
    value.quantity = quantity;
    value.bound = bound;
    value.number = number;
    value.value = expected;
    assert_int_equal(pl_scene_add_value(&r.scene, &value, NULL), PL_OK);
    snprintf(r.scene.primary_error, sizeof r.scene.primary_error, "value_error");
    run_begin(&r);
    for (int n = 1; n <= 192; ++n) {
        const double t = n * H, height = 1 - 0.1 * floor(t);
        r.state[0].position[0] = t;
        r.state[0].position[2] = height * sin(turn * t);
        r.state[0].velocity[0] = 1;
        run_step(&r);
    }
    run_finish(&r);
    const double error = run_value(&r, PL_METRIC_VALUE_ERROR);
    run_end(&r);
    return error;
}

static void test_bounds_over_time_count_on_one_side(void **state)
{
    (void)state;
    assert_close(value_found(PL_QUANTITY_APEX, PL_BOUND_AT_MOST, 0, 1.5), 0, 0, 0);
    assert_close(value_found(PL_QUANTITY_APEX, PL_BOUND_AT_MOST, 0, 0.4), 0.6, 1e-4, 0);
    assert_close(value_found(PL_QUANTITY_APEX, PL_BOUND_AT_LEAST, 0, 1.5), 0.5, 1e-4, 0);
    assert_close(value_found(PL_QUANTITY_TOP_SPEED, PL_BOUND_AT_MOST, 0, 1), 0, 0, 0);
    assert_close(value_found(PL_QUANTITY_TOP_SPEED, PL_BOUND_AT_MOST, 0, 0.7), 0.3, 1e-12, 0);
    assert_close(value_found(PL_QUANTITY_EXCURSION, PL_BOUND_AT_MOST, 0, 2.5), 0.5, 1e-12, 0);
    assert_close(value_found(PL_QUANTITY_EXCURSION, PL_BOUND_EQUAL, 0, 3), 0, 1e-12, 0);
}

static void test_apexes_are_counted_in_their_window(void **state)
{
    (void)state;
    for (int n = 1; n <= 3; ++n) {
        assert_close(value_found(PL_QUANTITY_APEX, PL_BOUND_EQUAL, n, 1.1 - 0.1 * n), 0, 1e-4, 0);
    }
    assert_close(value_found(PL_QUANTITY_APEX, PL_BOUND_EQUAL, 4, 0.7), 0.7, 0, 0);
}

/* A ball that lies still where an apex at the height of its start is expected. */
static void test_apex_that_is_not_there_is_off(void **state)
{
    (void)state;
    for (int bound = PL_BOUND_EQUAL; bound <= PL_BOUND_AT_LEAST; ++bound) {
        run r;
        run_prepare(&r, 1);
        run_add_body(&r, "ball", pl_shape_sphere(0.5), false, 0, 0);
        pl_expect_value value = pl_expect_value_default(&r.scene);
        value.quantity = PL_QUANTITY_APEX;
        value.bound = (pl_bound)bound;
        value.number = 2;
        value.tolerance = 0.01;
        assert_int_equal(pl_scene_add_value(&r.scene, &value, NULL), PL_OK);
        run_begin(&r);
        run_step_many(&r, 64);
        run_finish(&r);
        const bool is_off = bound != PL_BOUND_AT_MOST;
        assert_int_equal(r.metrics.deviations.off, is_off);
        if (is_off) {
            assert_contains(r.metrics.deviations.text[0], "apex 2 of \"ball\": none, expected ");
        }
        run_end(&r);
    }
}

static void test_energy_is_kinetic_and_potential(void **state)
{
    (void)state;
    /* 2 kg at 1 m/s, at the height of its start. */
    assert_close(value_found(PL_QUANTITY_ENERGY, PL_BOUND_EQUAL, 0, 1), 0, 1e-9, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_twenty_random_deviations_are_named),
        cmocka_unit_test(test_a_run_within_all_tolerances_is_accurate),
        cmocka_unit_test(test_number_and_bound_never_print_equal),
        cmocka_unit_test(test_bounds_over_time_count_on_one_side),
        cmocka_unit_test(test_apexes_are_counted_in_their_window),
        cmocka_unit_test(test_apex_that_is_not_there_is_off),
        cmocka_unit_test(test_energy_is_kinetic_and_potential),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
