/* Expected values, read from paths of known form. */
#include "check.h"
#include "synthetic_run.h"

#include <math.h>

enum { STEPS = 128 };

static const double pi = 3.14159265358979323846;

/* A scene of one body that is expected to reach `value`; lasts STEPS steps. */
static void prepare(run *r, pl_quantity quantity, double value)
{
    run_prepare(r, STEPS * H);
    run_add_body(r, "body", pl_shape_box(1, 2, 3), false, 10, 0);
    pl_expect_value expected = pl_expect_value_default(&r->scene);
    expected.quantity = quantity;
    expected.value = value;
    expected.scale = 2;
    assert_int_equal(pl_scene_add_value(&r->scene, &expected, NULL), PL_OK);
    r->scene.gravity[2] = 0;
}

static double error_of(run *r)
{
    assert_int_equal(run_finish(r), PL_ENDING_OK);
    double error = run_value(r, PL_METRIC_VALUE_ERROR);
    run_end(r);
    return error;
}

static void turn_about_z(pl_body_state *s, double angle)
{
    s->orientation[0] = cos(angle / 2);
    s->orientation[3] = sin(angle / 2);
}

static void test_position_error_is_relative_to_the_scale(void **state)
{
    (void)state;
    run r;
    prepare(&r, PL_QUANTITY_POSITION, 3);
    run_begin(&r);
    r.state[0].position[2] = 3.5;
    run_step_many(&r, STEPS);
    assert_close(error_of(&r), 0.25, 1e-15, 0);
}

static void test_time_between_frames_is_interpolated(void **state)
{
    (void)state;
    run r;
    prepare(&r, PL_QUANTITY_VELOCITY, 0);
    r.scene.values[0].until = 10.25 * H;
    run_begin(&r);
    for (int i = 1; i <= STEPS; ++i) {
        r.state[0].velocity[2] = i * H;
        run_step_many(&r, 1);
    }
    assert_close(error_of(&r), 10.25 * H / 2, 1e-14, 0);
}

static void test_spin_is_read_at_its_time(void **state)
{
    (void)state;
    run r;
    prepare(&r, PL_QUANTITY_SPIN, 1);
    r.scene.values[0].until = 20 * H;
    run_begin(&r);
    for (int i = 1; i <= STEPS; ++i) {
        r.state[0].angular_velocity[2] = i <= 20 ? 2 : 2.1;
        run_step_many(&r, 1);
    }
    assert_close(error_of(&r), 0.5, 1e-15, 0);
}

static void test_whole_turns_count(void **state)
{
    (void)state;
    run r;
    const double angle = 7.3 * 2 * pi;
    prepare(&r, PL_QUANTITY_TURN, -angle);
    run_begin(&r);
    for (int i = 1; i <= STEPS; ++i) {
        turn_about_z(&r.state[0], -angle * i / STEPS);
        /* The same orientation has two quaternions. */
        for (int k = 0; k < 4; ++k) {
            r.state[0].orientation[k] *= i % 2 == 0 ? 1 : -1;
        }
        run_step_many(&r, 1);
    }
    assert_close(error_of(&r), 0, 1e-12, 0);
}

static void test_apex_between_frames_is_that_of_the_parabola(void **state)
{
    (void)state;
    run r;
    const double v = 4, g = 10; /* the apex is at 0.4 s, 25.6 steps */
    prepare(&r, PL_QUANTITY_APEX, v * v / (2 * g));
    run_begin(&r);
    for (int i = 1; i <= STEPS; ++i) {
        double t = i * H;
        r.state[0].position[2] = v * t - 0.5 * g * t * t;
        run_step_many(&r, 1);
    }
    assert_close(error_of(&r), 0, 1e-14, 0);
}

static void test_apex_is_searched_in_its_window_only(void **state)
{
    (void)state;
    run r;
    prepare(&r, PL_QUANTITY_APEX, 1);
    r.scene.values[0].from = 30 * H;
    r.scene.values[0].until = 60 * H;
    run_begin(&r);
    for (int i = 1; i <= STEPS; ++i) {
        r.state[0].position[2] = i < 30    ? 50
                                 : i == 45 ? 1
                                 : i > 60  ? 70
                                           : 1 - 1e-3 * fabs(i - 45.0);
        run_step_many(&r, 1);
    }
    /* The parabola through a kink exceeds it by at most a quarter of the difference next to it. */
    assert_at_most(error_of(&r), 0.5 * 1e-3);
}

static void test_period_is_that_of_the_body_frame_spin(void **state)
{
    (void)state;
    run r;
    const double period = 0.4;
    prepare(&r, PL_QUANTITY_PERIOD, period);
    r.scene.values[0].direction[0] = 1; /* the body's x, which rotates about z with it */
    r.scene.values[0].direction[2] = 0;
    run_begin(&r);
    for (int i = 1; i <= STEPS; ++i) {
        double t = i * H, along = -cos(2 * pi * t / period), angle = 3 * t;
        turn_about_z(&r.state[0], angle);
        r.state[0].angular_velocity[0] = along * cos(angle);
        r.state[0].angular_velocity[1] = along * sin(angle);
        run_step_many(&r, 1);
    }
    assert_close(error_of(&r), 0, 1e-4, 0);
}

/* Of a scene that lasts two periods or more, a right engine shows one. */
static void test_unseen_period_is_an_error_of_itself(void **state)
{
    (void)state;
    run r;
    prepare(&r, PL_QUANTITY_PERIOD, STEPS * H / 2);
    r.scene.values[0].scale = STEPS * H / 2;
    run_begin(&r);
    run_step_many(&r, STEPS);
    assert_close(error_of(&r), 1, 1e-12, 0);
}

/* Adds a second position to be reached, of that answer. */
static void add_position(run *r, double value, double answer)
{
    pl_expect_value expected = r->scene.values[0];
    expected.value = value;
    expected.answer = answer;
    assert_int_equal(pl_scene_add_value(&r->scene, &expected, NULL), PL_OK);
}

static void test_nearest_of_several_answers_counts(void **state)
{
    (void)state;
    static const struct {
        double reached, error; /* over the scale of 2 */
        int answer;
    } cases[] = {{3, 0.5, 1}, {4, 0, 1}, {7, 0.5, 2}, {8, 0, 2}, {20, 6, 2}};
    for (int i = 0; i < 5; ++i) {
        run r;
        prepare(&r, PL_QUANTITY_POSITION, 4);
        r.scene.values[0].answer = 1;
        add_position(&r, 8, 2);
        run_begin(&r);
        r.state[0].position[2] = cases[i].reached;
        run_step_many(&r, STEPS);
        assert_int_equal(run_finish(&r), PL_ENDING_OK);
        assert_close(run_value(&r, PL_METRIC_VALUE_ERROR), cases[i].error, 1e-12, 0);
        assert_int_equal(r.metrics.item[PL_METRIC_VALUE_ERROR].answer, cases[i].answer);
        run_end(&r);
    }
}

static void test_values_of_all_answers_always_count(void **state)
{
    (void)state;
    run r;
    prepare(&r, PL_QUANTITY_POSITION, 4);
    add_position(&r, 8, 1);
    add_position(&r, 5, 2);
    run_begin(&r);
    r.state[0].position[2] = 8;
    run_step_many(&r, STEPS);
    assert_close(error_of(&r), 2, 1e-12, 0);
}

static void test_unseen_period_fails_the_value_error(void **state)
{
    (void)state;
    run r;
    prepare(&r, PL_QUANTITY_PERIOD, STEPS * H);
    run_begin(&r);
    run_step_many(&r, STEPS);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    const pl_metric *error = run_metric(&r, PL_METRIC_VALUE_ERROR);
    assert_int_equal(error->state, PL_METRIC_FAILED);
    assert_contains(error->reason, "no whole period");
    run_end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_position_error_is_relative_to_the_scale),
        cmocka_unit_test(test_time_between_frames_is_interpolated),
        cmocka_unit_test(test_spin_is_read_at_its_time),
        cmocka_unit_test(test_whole_turns_count),
        cmocka_unit_test(test_apex_between_frames_is_that_of_the_parabola),
        cmocka_unit_test(test_apex_is_searched_in_its_window_only),
        cmocka_unit_test(test_period_is_that_of_the_body_frame_spin),
        cmocka_unit_test(test_unseen_period_fails_the_value_error),
        cmocka_unit_test(test_unseen_period_is_an_error_of_itself),
        cmocka_unit_test(test_nearest_of_several_answers_counts),
        cmocka_unit_test(test_values_of_all_answers_always_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
