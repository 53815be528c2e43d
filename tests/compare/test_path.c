/* Lift-off height and path deviation of motions that are known in closed form. */
#include "referee/referee.h"

#include "check.h"
#include "synthetic_run.h"

#include <math.h>
#include <stdio.h>

/* A block on a plane that falls by 3 in 5, travelling downhill. n and t are the plane's normal and
 * downhill. */
static const double n[3] = {0.6, 0, 0.8}, t[3] = {0.8, 0, -0.6};

static void prepare_slope(run *r)
{
    run_prepare(r, 1);
    run_add_body(r, "slope", pl_shape_plane(n[0], n[1], n[2], 0), true, 0, 0);
    run_add_body(r, "wall", pl_shape_plane(0, 1, 0, -9), true, 0, 0);
    run_add_body(r, "block", pl_shape_box(0.5, 0.5, 0.5), false, 3, 7);
    const pl_expect_travel travel = {.body = 2, .direction = {0.8, 0, -0.6}, .distance = 2};
    assert_int_equal(pl_scene_add_travel(&r->scene, &travel, NULL), PL_OK);
}

static void move(run *r, double along, double across, double above)
{
    const double *start = r->scene.bodies[2].position;
    for (int k = 0; k < 3; ++k) {
        r->state[2].position[k] = start[k] + along * t[k] + above * n[k] + (k == 1 ? across : 0);
    }
}

static void test_lift_and_deviation_are_separate(void **state)
{
    (void)state;
    run r;
    prepare_slope(&r);
    run_begin(&r);
    for (int k = 1; k <= 64; ++k) {
        move(&r, k * H, k == 20 ? -3e-3 : 1e-3, k == 30 ? 2e-3 : -5e-3);
        run_step_many(&r, 1);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_LIFT), 2e-3, 1e-14, 0);
    assert_close(run_value(&r, PL_METRIC_PATH_DEVIATION), 3e-3, 1e-14, 0);
    assert_int_equal(run_metric(&r, PL_METRIC_LIFT)->worst_step, 30);
    assert_int_equal(run_metric(&r, PL_METRIC_PATH_DEVIATION)->worst_step, 20);
    run_end(&r);
}

static void test_sinking_body_has_no_lift(void **state)
{
    (void)state;
    run r;
    prepare_slope(&r);
    run_begin(&r);
    move(&r, 1, 0, -1e-3);
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_LIFT), 0, 0, 0);
    assert_close(run_value(&r, PL_METRIC_PATH_DEVIATION), 0, 1e-15, 0);
    run_end(&r);
}

/* The height is above the expected rest, not above the start, and it is vertical. */
static void test_lift_of_a_resting_body_starts_at_rest(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    r.scene.bodies[1].position[2] = 0.75;
    run_begin(&r);
    r.state[1].position[0] = 4;
    r.state[1].position[2] = 0.625;
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_LIFT), 0.125, 0, 0);
    assert_int_equal(run_metric(&r, PL_METRIC_PATH_DEVIATION)->state, PL_METRIC_ABSENT);
    run_end(&r);
}

/* A projectile over a floor has no supporting plane: it has no lift, and its whole distance from
 * the line counts. */
static void test_travel_off_the_plane_has_no_lift(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    run_add_body(&r, "ball", pl_shape_sphere(0.5), false, 0, 5);
    const pl_expect_travel travel = {.body = 1, .direction = {0.6, 0, 0.8}, .distance = 2};
    assert_int_equal(pl_scene_add_travel(&r.scene, &travel, NULL), PL_OK);
    run_begin(&r);
    r.state[1].position[0] = 0.6 - 0.8e-2;
    r.state[1].position[2] = 5.8 + 0.6e-2;
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_int_equal(run_metric(&r, PL_METRIC_LIFT)->state, PL_METRIC_ABSENT);
    assert_close(run_value(&r, PL_METRIC_PATH_DEVIATION), 1e-2, 1e-14, 0);
    run_end(&r);
}

static void test_without_a_reference_there_is_no_lift(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    run_add_body(&r, "ball", pl_shape_sphere(0.5), false, 0, 5);
    run_begin(&r);
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_int_equal(run_metric(&r, PL_METRIC_LIFT)->state, PL_METRIC_ABSENT);
    assert_int_equal(run_metric(&r, PL_METRIC_PATH_DEVIATION)->state, PL_METRIC_ABSENT);
    run_end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lift_and_deviation_are_separate),
        cmocka_unit_test(test_sinking_body_has_no_lift),
        cmocka_unit_test(test_lift_of_a_resting_body_starts_at_rest),
        cmocka_unit_test(test_travel_off_the_plane_has_no_lift),
        cmocka_unit_test(test_without_a_reference_there_is_no_lift),
    };
    return cmocka_run_group_tests_name("path", tests, NULL, NULL);
}
