/* The referee as a whole: verdicts, early ends, and statistics of what an engine reports. */
#include "referee/referee.h"

#include "check.h"
#include "synthetic_run.h"

#include <math.h>
#include <string.h>

static void test_every_metric_has_name_unit_and_definition(void **state)
{
    (void)state;
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const pl_metric_info *info = &pl_metric_table[i];
        assert_non_null(info->name);
        assert_true(strlen(info->unit) > 0 && strlen(info->definition) > 0);
        assert_int_equal(pl_metric_by_name(info->name), i);
        bool is_cost = strstr(info->name, "time_") == info->name ||
                       strstr(info->name, "wall_time_") == info->name ||
                       i == PL_METRIC_INSTRUCTIONS_PER_STEP || i == PL_METRIC_MEMORY_PEAK;
        assert_int_equal(pl_metric_is(i, PL_TRAIT_MEASURED), is_cost);
    }
    assert_int_equal(pl_metric_by_name("penetration"), -1);
    assert_int_equal(pl_metric_by_name(""), -1);
}

static void test_body_at_rest_at_its_reference_is_exact(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 2);
    run_begin(&r);
    run_step_many(&r, 128);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    const pl_metric_id zero[] = {
        PL_METRIC_REFERENCE_ERROR, PL_METRIC_REST_POSITION_ERROR, PL_METRIC_REST_ROTATION_ERROR,
        PL_METRIC_PENETRATION_MAX, PL_METRIC_PENETRATION_REST,    PL_METRIC_DRIFT,
        PL_METRIC_CREEP,           PL_METRIC_ENERGY_GAIN,         PL_METRIC_SETTLE_TIME};
    for (size_t i = 0; i < sizeof zero / sizeof zero[0]; ++i) {
        assert_close(run_value(&r, zero[i]), 0, 0, 0);
    }
    assert_string_equal(run_metric(&r, PL_METRIC_REFERENCE_ERROR)->unit, "m");
    assert_int_equal(run_metric(&r, PL_METRIC_TRAVEL_ERROR)->state, PL_METRIC_ABSENT);
    assert_int_equal(run_metric(&r, PL_METRIC_DISCRETE_ERROR)->state, PL_METRIC_ABSENT);
    assert_int_equal(run_metric(&r, PL_METRIC_MEMORY_PEAK)->state, PL_METRIC_ABSENT);
    /* It rests on a static body, and the force is not known. */
    assert_int_equal(run_metric(&r, PL_METRIC_MOMENTUM_ERROR)->state, PL_METRIC_FAILED);
    assert_contains(run_metric(&r, PL_METRIC_MOMENTUM_ERROR)->reason, "no contacts");
    run_end(&r);
}

static void test_points_without_impulses_are_the_reason(void **state)
{
    (void)state;
    static const pl_metric_id of_force[] = {PL_METRIC_FORCE_BALANCE,      PL_METRIC_CONE_VIOLATION,
                                            PL_METRIC_FRICTION_EFFECTIVE, PL_METRIC_SIGNORINI,
                                            PL_METRIC_NATURAL_MAP,        PL_METRIC_MOMENTUM_ERROR};
    for (int points = 0; points < 2; ++points) {
        run r;
        run_prepare_box_on_floor(&r, 1);
        run_begin(&r);
        for (int k = 0; k < 64; ++k) {
            const pl_step seen = {.after = r.state,
                                  .stats = &r.stats,
                                  .contact_count = -1,
                                  .has_points_alone = points == 1};
            assert_int_equal(pl_referee_step(r.referee, &seen, NULL), PL_ENDING_OK);
        }
        assert_int_equal(run_finish(&r), PL_ENDING_OK);
        for (size_t i = 0; i < sizeof of_force / sizeof of_force[0]; ++i) {
            const pl_metric *metric = run_metric(&r, of_force[i]);
            if (points == 1) {
                assert_int_equal(metric->state, PL_METRIC_FAILED);
                assert_string_equal(metric->reason,
                                    "the engine reports contact points without impulses");
            } else {
                assert_null(strstr(metric->reason, "without impulses"));
            }
        }
        run_end(&r);
    }
}

static void test_first_nonfinite_number_ends_the_run(void **state)
{
    (void)state;
    const double bad[3] = {nan(""), HUGE_VAL, -HUGE_VAL};
    enum { NUMBERS = sizeof(pl_body_state) / sizeof(double), OF_POSE = 7 };
    /* All numbers of the box, and then those of the static floor's pose. */
    for (size_t i = 0; i < NUMBERS + OF_POSE; ++i) {
        run r;
        run_prepare_box_on_floor(&r, 1);
        run_begin(&r);
        run_step_many(&r, 9);
        double wrong = bad[i % 3];
        const size_t body = i < NUMBERS, number = i < NUMBERS ? i : i - NUMBERS;
        memcpy((char *)&r.state[body] + number * sizeof wrong, &wrong, sizeof wrong);
        assert_int_equal(run_step(&r), PL_ENDING_NONFINITE);
        assert_contains(r.error.message, r.scene.bodies[body].name);
        assert_contains(r.error.message, "step 10");
        assert_int_equal(run_step(&r), PL_ENDING_NONFINITE);
        assert_int_equal(run_finish(&r), PL_ENDING_NONFINITE);
        const pl_metric *rest = run_metric(&r, PL_METRIC_REST_POSITION_ERROR);
        assert_int_equal(rest->state, PL_METRIC_FAILED);
        assert_string_equal(rest->reason, "the run ended at step 9 of 64");
        run_end(&r);
    }
}

static void test_null_quaternion_is_no_rotation(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    run_begin(&r);
    memset(r.state[1].orientation, 0, sizeof r.state[1].orientation);
    assert_int_equal(run_step(&r), PL_ENDING_NONFINITE);
    assert_contains(r.error.message, "no rotation");
    run_end(&r);
}

static void test_run_that_starts_with_nan_has_no_metrics(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    run_begin(&r);
    r.state[1].position[0] = nan("");
    pl_frame frame = run_frame(&r);
    assert_int_equal(pl_referee_start(r.referee, &r.engine, &frame), PL_ENDING_NONFINITE);
    assert_int_equal(run_finish(&r), PL_ENDING_NONFINITE);
    assert_contains(r.error.message, "step 0");
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        assert_true(run_metric(&r, (pl_metric_id)i)->state == PL_METRIC_FAILED ||
                    run_metric(&r, (pl_metric_id)i)->state == PL_METRIC_ABSENT);
    }
    run_end(&r);
}

static void test_diverged_run_keeps_its_maxima(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    run_begin(&r);
    r.state[1].position[2] = 0.49;
    run_step_many(&r, 5);
    r.state[1].velocity[0] = 1e5;
    assert_int_equal(run_step(&r), PL_ENDING_DIVERGED);
    assert_contains(r.error.message, "\"box\"");
    assert_contains(r.error.message, "step 6");
    assert_int_equal(run_finish(&r), PL_ENDING_DIVERGED);
    assert_close(run_value(&r, PL_METRIC_PENETRATION_MAX), 0.01, 1e-15, 0);
    assert_int_equal(run_metric(&r, PL_METRIC_PENETRATION_REST)->state, PL_METRIC_FAILED);
    assert_int_equal(run_metric(&r, PL_METRIC_STATE_HASH)->state, PL_METRIC_FAILED);
    assert_int_equal(run_metric(&r, PL_METRIC_REFERENCE_ERROR)->state, PL_METRIC_FAILED);
    run_end(&r);
}

static void test_energy_gain_below_the_speed_bound_diverges(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    run_begin(&r);
    /* E_ref = 2 kg x 9.81 x sqrt(3) m = 34 J, so that 300 m/s (9e4 J) is 2600 times as much. */
    r.state[1].velocity[0] = 300;
    assert_int_equal(run_step(&r), PL_ENDING_DIVERGED);
    assert_contains(r.error.message, "energy");
    run_end(&r);
}

/* Without contacts, momentum is known as long as nothing can have touched the floor. A body that hovers
 * within rounding of it can; it is no penetration. */
static void test_hovering_within_rounding_is_touching(void **state)
{
    (void)state;
    static const double gaps[] = {2.8e-7, 5e-4, 0.5};
    for (int i = 0; i < 3; ++i) {
        run r;
        run_prepare_box_on_floor(&r, 1);
        r.scene.bodies[1].position[2] += gaps[i];
        run_begin(&r);
        run_step_many(&r, 64);
        assert_int_equal(run_finish(&r), PL_ENDING_OK);
        const pl_metric *momentum = run_metric(&r, PL_METRIC_MOMENTUM_ERROR);
        assert_int_equal(momentum->state, i < 2 ? PL_METRIC_FAILED : PL_METRIC_VALUE);
        assert_close(run_value(&r, PL_METRIC_PENETRATION_MAX), 0, 0, 0);
        run_end(&r);
    }
}

/* 100 sqrt(2 |g| (H + D)) + 100 m/s + |g| T for a cube of side 1 at rest, whose bounding sphere has the
 * diameter H = sqrt(3) m and D = 3 m; beyond it the speed is the reason, below it the energy. */
static void test_speed_bound_is_that_of_its_definition(void **state)
{
    (void)state;
    const double bound = 100 * sqrt(2 * 9.81 * (sqrt(3) + 3)) + 100 + 9.81;
    for (int beyond = 0; beyond < 2; ++beyond) {
        run r;
        run_prepare_box_on_floor(&r, 1);
        run_begin(&r);
        r.state[1].velocity[0] = bound * (beyond ? 1.001 : 0.999);
        assert_int_equal(run_step(&r), PL_ENDING_DIVERGED);
        assert_contains(r.error.message, beyond ? "moves at" : "energy has grown");
        run_end(&r);
    }
}

static void test_early_end_leaves_the_maxima(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    run_begin(&r);
    r.stats.iterations = 7;
    run_step_many(&r, 10);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_ITERATIONS_MAX), 7, 0, 0);
    assert_close(run_value(&r, PL_METRIC_PENETRATION_MAX), 0, 0, 0);
    assert_string_equal(run_metric(&r, PL_METRIC_CREEP)->reason,
                        "the run has no frame after step 32");
    assert_string_equal(run_metric(&r, PL_METRIC_STATE_HASH)->reason,
                        "the run ended at step 10 of 64");
    run_end(&r);
}

static void test_statistics_of_steps(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 200 * H);
    run_begin(&r);
    for (int k = 1; k <= 200; ++k) {
        r.stats.iterations = k == 77 ? 500 : k % 100;
        r.stats.contacts = k <= 100 ? 4 : nan("");
        r.stats.residual = k == 33 ? 0.5 : k <= 8 ? 1e-3 : 1e-6;
        run_step_many(&r, 1);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    const pl_metric *iterations = run_metric(&r, PL_METRIC_ITERATIONS_MEAN);
    assert_close(iterations->value, (2 * 4950 + 500 - 77) / 200.0, 1e-12, 0);
    assert_int_equal(iterations->worst_step, 77);
    /* Whole numbers below 256 have a bin each. */
    assert_close(iterations->p50, 49, 0, 0);
    assert_close(iterations->p95, 95, 0, 0);
    assert_close(run_value(&r, PL_METRIC_ITERATIONS_MAX), 500, 0, 0);
    assert_close(run_value(&r, PL_METRIC_CONTACTS_MEAN), 4, 0, 0);
    assert_close(run_value(&r, PL_METRIC_TIME_PER_STEP), 1e-3, 0, 1e-12);
    const pl_metric *residual = run_metric(&r, PL_METRIC_RESIDUAL_MAX);
    assert_close(residual->value, 0.5, 0, 0);
    assert_int_equal(residual->worst_step, 33);
    /* 191 of 200 steps, more than 95 %, are at 1e-6; 8 at 1e-3 and one at 0.5 above them. */
    assert_close(residual->p95, 1e-6, 0, 1e-12);
    assert_close(residual->p99, 1e-3, 0, 1e-12);
    assert_close(run_value(&r, PL_METRIC_RESIDUAL_RMS), sqrt((0.25 + 8e-6 + 191e-12) / 200), 0,
                 1e-14);
    assert_string_equal(run_metric(&r, PL_METRIC_RESIDUAL_RMS)->unit, "m/s");
    run_end(&r);
}

static void test_metrics_that_no_step_reports_have_no_value(void **state)
{
    (void)state;
    const pl_metric_id of_residual[] = {PL_METRIC_RESIDUAL_MAX, PL_METRIC_RESIDUAL_RMS};
    run r;
    run_prepare_box_on_floor(&r, 1);
    run_begin(&r);
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    pl_metrics other;
    pl_note note;
    assert_int_equal(pl_referee_finish(r.referee, NULL, &other, &note, NULL), PL_ENDING_OK);
    for (int i = 0; i < 2; ++i) {
        const pl_metric *residual = run_metric(&r, of_residual[i]);
        assert_int_equal(residual->state, PL_METRIC_FAILED);
        assert_string_equal(residual->reason, "the engine reports none");
        assert_string_equal(residual->unit, "m/s");
        assert_int_equal(other.item[of_residual[i]].state, PL_METRIC_ABSENT);
    }
    assert_int_equal(run_metric(&r, PL_METRIC_ITERATIONS_MEAN)->state, PL_METRIC_FAILED);
    run_end(&r);
}

static void hash_with(double x, char text[24])
{
    run r;
    run_prepare_box_on_floor(&r, 1);
    run_begin(&r);
    r.state[1].position[0] = x;
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_int_equal(run_metric(&r, PL_METRIC_STATE_HASH)->state, PL_METRIC_TEXT);
    memcpy(text, run_metric(&r, PL_METRIC_STATE_HASH)->text, 24);
    run_end(&r);
}

static void test_state_hash_changes_with_one_bit(void **state)
{
    (void)state;
    char first[24], again[24], next[24], zero[24], minus_zero[24];
    hash_with(0.1, first);
    hash_with(0.1, again);
    hash_with(nextafter(0.1, 1), next);
    hash_with(0, zero);
    hash_with(-0.0, minus_zero);
    assert_int_equal(strlen(first), 16);
    assert_string_equal(first, again);
    assert_string_not_equal(first, next);
    assert_string_not_equal(zero, minus_zero);
}

/* A box that falls on a floor, by an engine that reports its contacts. */
static void test_table_says_which_metrics_have_percentiles(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 64 * H);
    run_expect_travel(&r, 1, 1, 1);
    run_begin(&r);
    const pl_contact contact = {.body_b = 1, .normal = {[2] = 1}, .impulse = {2, 0, 2}};
    for (int k = 1; k <= 64; ++k) {
        r.stats = (pl_step_stats){.iterations = 1, .residual = 1, .contacts = 1};
        r.state[1].velocity[0] = 1;
        r.state[1].position[2] = k < 32 ? 9 : 0.5;
        assert_int_equal(run_step_with(&r, &contact, k < 32 ? 0 : 1), PL_ENDING_OK);
    }
    (void)run_finish(&r);
    for (int id = PL_METRIC_REFERENCE_ERROR + 1; id < PL_METRIC_COUNT; ++id) {
        const bool has_percentiles = r.metrics.item[id].has_percentiles;
        if (has_percentiles != pl_metric_is(id, PL_TRAIT_OVER_STEPS)) {
            fail_msg("%s: percentiles %d", pl_metric_table[id].name, has_percentiles);
        }
    }
    run_end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_metric_has_name_unit_and_definition),
        cmocka_unit_test(test_body_at_rest_at_its_reference_is_exact),
        cmocka_unit_test(test_points_without_impulses_are_the_reason),
        cmocka_unit_test(test_first_nonfinite_number_ends_the_run),
        cmocka_unit_test(test_null_quaternion_is_no_rotation),
        cmocka_unit_test(test_run_that_starts_with_nan_has_no_metrics),
        cmocka_unit_test(test_diverged_run_keeps_its_maxima),
        cmocka_unit_test(test_energy_gain_below_the_speed_bound_diverges),
        cmocka_unit_test(test_hovering_within_rounding_is_touching),
        cmocka_unit_test(test_speed_bound_is_that_of_its_definition),
        cmocka_unit_test(test_early_end_leaves_the_maxima),
        cmocka_unit_test(test_statistics_of_steps),
        cmocka_unit_test(test_table_says_which_metrics_have_percentiles),
        cmocka_unit_test(test_metrics_that_no_step_reports_have_no_value),
        cmocka_unit_test(test_state_hash_changes_with_one_bit),
    };
    return cmocka_run_group_tests_name("referee", tests, NULL, NULL);
}
