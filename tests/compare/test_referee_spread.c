/* Spread metrics of frames for which they are known. */
#include "check.h"
#include "synthetic_run.h"

#include <math.h>

/* Three cubes of 2 kg in a row over a floor. */
static void prepare(run *r)
{
    run_prepare(r, 4 * H);
    run_add_body(r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    run_add_body(r, "a", pl_shape_box(0.5, 0.5, 0.5), false, 0, 5);
    run_add_body(r, "b", pl_shape_box(0.5, 0.5, 0.5), false, 3, 5);
    run_add_body(r, "c", pl_shape_box(0.5, 0.5, 0.5), false, 6, 5);
}

static void put(run *r, int body, double x, double y, double z)
{
    r->state[body].position[0] = x;
    r->state[body].position[1] = y;
    r->state[body].position[2] = z;
}

static void test_spread_metrics_are_of_the_last_frame(void **state)
{
    (void)state;
    run r;
    prepare(&r);
    r.scene.bodies[1].mass = 6;
    run_begin(&r);
    run_step_many(&r, 3);
    put(&r, 1, -3, 4, 2); /* 5 m across gravity from its start */
    put(&r, 2, 3, 0, 1);
    put(&r, 3, 9, -1, 0.5);
    run_step_many(&r, 1);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_SPREAD_X), sqrt(24), 1e-14, 0);
    assert_close(run_value(&r, PL_METRIC_SPREAD_Y), sqrt(14.0 / 3), 1e-14, 0);
    assert_close(run_value(&r, PL_METRIC_MASS_HEIGHT), (6 * 2 + 2 * 1 + 2 * 0.5) / 10, 1e-14, 0);
    /* Displacements 0, sqrt(10) and 5: position 0.95 x 2 of the order. */
    double second = sqrt(10);
    assert_close(run_value(&r, PL_METRIC_RUN_OUT_P95), second + 0.9 * (5 - second), 1e-14, 0);
    /* Nothing moves in the last frame: all potential energy of the fall is lost. */
    double fallen = 6 * 3 + 2 * 4 + 2 * 4.5;
    assert_close(run_value(&r, PL_METRIC_ENERGY_LOST), fallen * 9.81, 1e-12, 1e-12);
    run_end(&r);
}

static void test_up_is_against_gravity(void **state)
{
    (void)state;
    run r;
    prepare(&r);
    r.scene.gravity[0] = 2;
    r.scene.gravity[2] = 0;
    run_begin(&r);
    put(&r, 1, 100, 0, 5 + 7);
    put(&r, 2, 100, 0, 5 + 7);
    put(&r, 3, 100, 0, 5 + 7);
    run_step_many(&r, 4);
    run_finish(&r);
    assert_close(run_value(&r, PL_METRIC_MASS_HEIGHT), -100, 1e-12, 0);
    assert_close(run_value(&r, PL_METRIC_RUN_OUT_P95), 7, 1e-12, 0);
    run_end(&r);
}

static void test_without_gravity_there_is_no_mass_height(void **state)
{
    (void)state;
    run r;
    prepare(&r);
    r.scene.gravity[2] = 0;
    run_begin(&r);
    for (int i = 1; i <= 3; ++i) {
        put(&r, i, 3 * (i - 1) + 3, 0, 5 + 4);
    }
    run_step_many(&r, 4);
    run_finish(&r);
    assert_int_equal(run_metric(&r, PL_METRIC_MASS_HEIGHT)->state, PL_METRIC_ABSENT);
    assert_close(run_value(&r, PL_METRIC_RUN_OUT_P95), 5, 1e-12, 0);
    run_end(&r);
}

static const pl_metric_id all[] = {PL_METRIC_SPREAD_X, PL_METRIC_SPREAD_Y, PL_METRIC_MASS_HEIGHT,
                                   PL_METRIC_RUN_OUT_P95, PL_METRIC_ENERGY_LOST};
enum { ALL_COUNT = sizeof all / sizeof all[0] };

static void test_one_body_cannot_spread(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 4 * H);
    run_begin(&r);
    run_step_many(&r, 4);
    run_finish(&r);
    for (int i = 0; i < ALL_COUNT; ++i) {
        const bool is_spread = all[i] == PL_METRIC_SPREAD_X || all[i] == PL_METRIC_SPREAD_Y;
        assert_int_equal(run_metric(&r, all[i])->state,
                         is_spread ? PL_METRIC_ABSENT : PL_METRIC_VALUE);
    }
    run_end(&r);
}

static void test_early_end_leaves_no_spread_metrics(void **state)
{
    (void)state;
    run r;
    prepare(&r);
    run_begin(&r);
    run_step_many(&r, 3);
    run_finish(&r);
    for (int i = 0; i < ALL_COUNT; ++i) {
        assert_int_equal(run_metric(&r, all[i])->state, PL_METRIC_FAILED);
        assert_contains(run_metric(&r, all[i])->reason, "step 3 of 4");
    }
    run_end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spread_metrics_are_of_the_last_frame),
        cmocka_unit_test(test_up_is_against_gravity),
        cmocka_unit_test(test_without_gravity_there_is_no_mass_height),
        cmocka_unit_test(test_one_body_cannot_spread),
        cmocka_unit_test(test_early_end_leaves_no_spread_metrics),
    };
    return cmocka_run_group_tests_name("referee spread", tests, NULL, NULL);
}
