/* Metrics of poses and velocities, against synthetic motions whose metrics are known in closed
 * form: final state, penetration, settling, drift. */
#include "referee/referee.h"

#include "check.h"
#include "synthetic_run.h"

#include <math.h>
#include <string.h>

static void test_final_pose_errors_are_distance_and_angle(void **state)
{
    (void)state;
    run r;
    for (int sign = -1; sign <= 1; sign += 2) {
        run_prepare_box_on_floor(&r, 1);
        run_begin(&r);
        run_step_many(&r, 63);
        double angle = 1e-9;
        r.state[1].position[0] += 3e-3;
        r.state[1].position[1] -= 4e-3;
        /* q and -q are the same orientation. */
        r.state[1].orientation[0] = sign * cos(angle / 2);
        r.state[1].orientation[2] = sign * sin(angle / 2);
        run_step_many(&r, 1);
        assert_int_equal(run_finish(&r), PL_ENDING_OK);
        assert_close(run_value(&r, PL_METRIC_REST_POSITION_ERROR), 5e-3, 0, 1e-12);
        assert_close(run_value(&r, PL_METRIC_REST_ROTATION_ERROR), angle, 0, 1e-12);
        assert_close(run_value(&r, PL_METRIC_REFERENCE_ERROR), 5e-3, 0, 1e-12);
        run_end(&r);
    }
}

static void test_sphere_has_no_rotation_error(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "ball", pl_shape_sphere(1), false, 0, 0);
    run_expect_rest(&r, 0);
    run_begin(&r);
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_int_equal(run_metric(&r, PL_METRIC_REST_ROTATION_ERROR)->state, PL_METRIC_ABSENT);
    assert_int_equal(run_metric(&r, PL_METRIC_PENETRATION_MAX)->state, PL_METRIC_ABSENT);
    run_end(&r);
}

static void test_body_beyond_collapse_distance_is_named(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    r.scene.collapse_distance = 0.25;
    run_begin(&r);
    r.state[1].position[2] += 0.25;
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    run_end(&r);

    run_prepare_box_on_floor(&r, 1);
    r.scene.collapse_distance = 0.25;
    run_begin(&r);
    r.state[1].position[2] += 0.2500001;
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_COLLAPSED);
    assert_contains(r.error.message, "\"box\"");
    assert_contains(r.error.message, "0.25 m");
    assert_close(run_value(&r, PL_METRIC_REST_POSITION_ERROR), 0.2500001, 0, 1e-12);
    run_end(&r);
}

static void test_travel_errors_are_relative_to_their_own_references(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "block", pl_shape_box(1, 1, 1), false, 10, 0);
    run_expect_travel(&r, 0, 4, 5);
    run_begin(&r);
    r.state[0].velocity[0] = 4.4; /* from rest: semi-implicit Euler */
    for (int i = 1; i <= 64; ++i) {
        r.state[0].position[0] = 10 + 4.4 * i / 64;
        run_step_many(&r, 1);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_TRAVEL_ERROR), 0.1, 1e-14, 0);
    assert_close(run_value(&r, PL_METRIC_DISCRETE_ERROR), 0.12, 1e-14, 0);
    assert_int_equal(run_metric(&r, PL_METRIC_SETTLE_TIME)->state, PL_METRIC_ABSENT);
    run_end(&r);
}

static void test_drift_to_the_side_is_a_travel_error(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "block", pl_shape_box(1, 1, 1), false, 10, 0);
    run_expect_travel(&r, 0, 4, 4);
    r.scene.bodies[0].velocity[0] = r.state[0].velocity[0] = 4;
    run_begin(&r);
    for (int i = 1; i <= 64; ++i) {
        r.state[0].position[0] = 10 + 4.0 * i / 64;
        r.state[0].position[1] = 0.6 * i / 64;
        r.state[0].position[2] = -0.8 * i / 64;
        run_step_many(&r, 1);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_TRAVEL_ERROR), 0.25, 1e-14, 0);
    assert_close(run_value(&r, PL_METRIC_DISCRETE_ERROR), 0.25, 1e-14, 0);
    run_end(&r);
}

/* Depth 1e-6 k at step k: the maximum, its step, the percentiles and the last second all follow. */
static void test_penetration_statistics_of_a_known_ramp(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 200 * H);
    run_begin(&r);
    for (int k = 1; k <= 200; ++k) {
        int up_and_down = k <= 150 ? k : 300 - k;
        r.state[1].position[2] = 0.5 - 1e-6 * up_and_down;
        run_step_many(&r, 1);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    const pl_metric *m = run_metric(&r, PL_METRIC_PENETRATION_MAX);
    assert_close(run_value(&r, PL_METRIC_PENETRATION_MAX), 150e-6, 1e-15, 0);
    assert_int_equal(m->worst_step, 150);
    assert_true(m->has_percentiles);
    /* 1 .. 99 and 150 occur once, 100 .. 149 twice: ranks 100, 190 and 198 of 200. */
    assert_close(m->p50, 100e-6, 0, 1.0 / 128);
    assert_close(m->p95, 145e-6, 0, 1.0 / 128);
    assert_close(m->p99, 149e-6, 0, 1.0 / 128);
    double sum = 0;
    for (int k = 200 - 64 + 1; k <= 200; ++k) {
        sum += 1e-6 * (k <= 150 ? k : 300 - k);
    }
    assert_close(run_value(&r, PL_METRIC_PENETRATION_REST), sum / 64, 1e-15, 0);
    run_end(&r);
}

static void test_overlap_of_the_first_frame_is_ignored(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    r.scene.bodies[1].position[2] = 0.4;
    run_begin(&r);
    r.state[1].position[2] = 0.51;
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_PENETRATION_MAX), 0, 0, 0);
    run_end(&r);
}

static void test_overlapping_static_bodies_do_not_count(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "step", pl_shape_box(1, 1, 1), true, 0, 0);
    run_add_body(&r, "next", pl_shape_box(1, 1, 1), true, 0.5, 0);
    run_add_body(&r, "ball", pl_shape_sphere(1), false, 0, 2 - 1e-3);
    run_begin(&r);
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_PENETRATION_MAX), 1e-3, 1e-15, 0);
    run_end(&r);
}

static void test_static_body_stays_where_the_scene_has_it(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "floor", pl_shape_box(5, 5, 1), true, 0, -1);
    run_add_body(&r, "box", pl_shape_box(0.5, 0.5, 0.5), false, 0, 0.5 - 1e-3);
    run_begin(&r);
    memset(&r.state[0], 0, sizeof r.state[0]);
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_PENETRATION_MAX), 1e-3, 1e-15, 0);
    run_end(&r);
}

/* v = 0.1 exp(-t) falls below 1 mm/s at t = ln 100. */
static void test_settle_time_of_a_decaying_motion(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 6);
    run_begin(&r);
    for (int k = 1; k <= 384; ++k) {
        r.state[1].velocity[0] = 0.1 * exp(-k * H);
        run_step_many(&r, 1);
    }
    /* The scene starts at rest, but moves within half a second. */
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_SETTLE_TIME), ceil(log(100) / H) * H, 0, 0);
    run_end(&r);
}

static void test_quiet_below_half_a_second_does_not_settle(void **state)
{
    (void)state;
    const int lengths[2] = {32, 33};
    for (int c = 0; c < 2; ++c) {
        run r;
        run_prepare_box_on_floor(&r, 2);
        run_begin(&r);
        for (int k = 1; k <= 128; ++k) {
            r.state[1].angular_velocity[1] = k >= 10 && k < 10 + lengths[c] ? 0.9e-3 : 1e-3;
            run_step_many(&r, 1);
        }
        assert_int_equal(run_finish(&r), PL_ENDING_OK);
        if (c == 0) {
            assert_int_equal(run_metric(&r, PL_METRIC_SETTLE_TIME)->state, PL_METRIC_FAILED);
            assert_contains(run_metric(&r, PL_METRIC_SETTLE_TIME)->reason, "never below");
        } else {
            assert_close(run_value(&r, PL_METRIC_SETTLE_TIME), 10 * H, 0, 0);
        }
        run_end(&r);
    }
}

/* Unsettled, x = 0.03 t and z = 0.04 t: from 1 s on, drift = 0.05 (T - 1) and creep = 0.05. */
static void test_drift_and_creep_of_a_steady_motion(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 4);
    run_begin(&r);
    for (int k = 1; k <= 256; ++k) {
        r.state[1].position[0] = 0.03 * k * H;
        r.state[1].position[2] = 0.5 + 0.04 * k * H;
        r.state[1].velocity[0] = 0.03;
        run_step_many(&r, 1);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_DRIFT), 0.15, 1e-14, 0);
    assert_close(run_value(&r, PL_METRIC_CREEP), 0.05, 0, 1e-12);
    run_end(&r);
}

/* It moves by 1 m in the first 1.5 s, settles, and then creeps at 1e-5 m/s. */
static void test_drift_counts_from_the_settled_pose(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 5);
    run_begin(&r);
    for (int k = 1; k <= 320; ++k) {
        bool settled = k >= 96;
        r.state[1].position[0] = settled ? 1 + 1e-5 * (k - 96) * H : k / 96.0;
        r.state[1].velocity[0] = settled ? 1e-5 : 1 / (96 * H);
        run_step_many(&r, 1);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_SETTLE_TIME), 1.5, 0, 0);
    assert_close(run_value(&r, PL_METRIC_DRIFT), 1e-5 * 3.5, 1e-15, 0);
    assert_close(run_value(&r, PL_METRIC_CREEP), 1e-5, 0, 1e-9);
    run_end(&r);
}

static void test_drift_leaves_out_the_direction_of_travel(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 2);
    run_add_body(&r, "block", pl_shape_box(1, 1, 1), false, 0, 0);
    run_expect_travel(&r, 0, 1, nan(""));
    run_begin(&r);
    for (int k = 1; k <= 128; ++k) {
        r.state[0].position[0] = k * H;
        r.state[0].position[1] = 1e-3 * k * H;
        r.state[0].velocity[0] = 1;
        run_step_many(&r, 1);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_DRIFT), 1e-3, 1e-15, 0);
    assert_close(run_value(&r, PL_METRIC_CREEP), 1e-3, 0, 1e-10);
    assert_int_equal(run_metric(&r, PL_METRIC_DISCRETE_ERROR)->state, PL_METRIC_ABSENT);
    run_end(&r);
}

/* A box between a floor and a wall: the height over the floor counts, and sinking is no lift. */
static void test_lift_is_the_height_over_the_floor(void **state)
{
    (void)state;
    static const double x[] = {0, 0.2, -0.2, 0, 0}, z[] = {0, 0, 0, -0.1, 0.03};
    for (int k = 0; k < 5; ++k) {
        run r;
        run_prepare_box_on_floor(&r, 1);
        run_add_body(&r, "wall", pl_shape_plane(1, 0, 0, -4), true, 0, 0);
        run_add_body(&r, "slope", pl_shape_plane(0.6, 0, 0.8, -4), true, 0, 0);
        run_begin(&r);
        r.state[1].position[0] += x[k];
        r.state[1].position[2] += z[k];
        run_step_many(&r, 64);
        assert_int_equal(run_finish(&r), PL_ENDING_OK);
        assert_close(run_value(&r, PL_METRIC_LIFT), k == 4 ? 0.03 : 0, 1e-15, 0);
        run_end(&r);
    }
}

/* Two balls that the scene expects nothing of come to rest at 1.5 s, and the second one then creeps
 * at 1e-5 m/s. */
static void test_without_expectations_all_settled_bodies_drift(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 5);
    run_add_body(&r, "still", pl_shape_sphere(1), false, 0, 0);
    run_add_body(&r, "creeping", pl_shape_sphere(1), false, 4, 0);
    run_begin(&r);
    for (int k = 1; k <= 320; ++k) {
        bool settled = k >= 96;
        r.state[0].velocity[0] = settled ? 0 : 1 / (96 * H);
        r.state[0].position[0] = settled ? 1 : k / 96.0;
        r.state[1].velocity[1] = settled ? 1e-5 : 0;
        r.state[1].position[1] = settled ? 1e-5 * (k - 96) * H : 0;
        run_step_many(&r, 1);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_DRIFT), 1e-5 * 3.5, 1e-15, 0);
    assert_close(run_value(&r, PL_METRIC_CREEP), 1e-5, 0, 1e-9);
    assert_int_equal(run_metric(&r, PL_METRIC_REFERENCE_ERROR)->state, PL_METRIC_ABSENT);
    run_end(&r);
}

static void test_without_expectations_moving_bodies_have_no_drift(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 2);
    run_add_body(&r, "ball", pl_shape_sphere(1), false, 0, 0);
    run_begin(&r);
    for (int k = 1; k <= 128; ++k) {
        r.state[0].velocity[0] = 0.01;
        r.state[0].position[0] = 0.01 * k * H;
        run_step_many(&r, 1);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_int_equal(run_metric(&r, PL_METRIC_DRIFT)->state, PL_METRIC_FAILED);
    assert_int_equal(run_metric(&r, PL_METRIC_CREEP)->state, PL_METRIC_FAILED);
    assert_contains(run_metric(&r, PL_METRIC_DRIFT)->reason, "did not come to rest");
    run_end(&r);
}

/* What is expected of a body's path says nothing of rest. */
static void test_expected_value_alone_makes_no_drift(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 2);
    run_add_body(&r, "ball", pl_shape_sphere(1), false, 0, 0);
    pl_expect_value velocity = pl_expect_value_default(&r.scene);
    velocity.quantity = PL_QUANTITY_VELOCITY;
    assert_int_equal(pl_scene_add_value(&r.scene, &velocity, &r.error), PL_OK);
    run_begin(&r);
    run_step_many(&r, 128);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_int_equal(run_metric(&r, PL_METRIC_DRIFT)->state, PL_METRIC_ABSENT);
    assert_int_equal(run_metric(&r, PL_METRIC_CREEP)->state, PL_METRIC_ABSENT);
    run_end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_final_pose_errors_are_distance_and_angle),
        cmocka_unit_test(test_sphere_has_no_rotation_error),
        cmocka_unit_test(test_body_beyond_collapse_distance_is_named),
        cmocka_unit_test(test_travel_errors_are_relative_to_their_own_references),
        cmocka_unit_test(test_drift_to_the_side_is_a_travel_error),
        cmocka_unit_test(test_penetration_statistics_of_a_known_ramp),
        cmocka_unit_test(test_overlap_of_the_first_frame_is_ignored),
        cmocka_unit_test(test_overlapping_static_bodies_do_not_count),
        cmocka_unit_test(test_static_body_stays_where_the_scene_has_it),
        cmocka_unit_test(test_settle_time_of_a_decaying_motion),
        cmocka_unit_test(test_quiet_below_half_a_second_does_not_settle),
        cmocka_unit_test(test_drift_and_creep_of_a_steady_motion),
        cmocka_unit_test(test_drift_counts_from_the_settled_pose),
        cmocka_unit_test(test_drift_leaves_out_the_direction_of_travel),
        cmocka_unit_test(test_lift_is_the_height_over_the_floor),
        cmocka_unit_test(test_without_expectations_all_settled_bodies_drift),
        cmocka_unit_test(test_without_expectations_moving_bodies_have_no_drift),
        cmocka_unit_test(test_expected_value_alone_makes_no_drift),
    };
    return cmocka_run_group_tests_name("referee motion", tests, NULL, NULL);
}
