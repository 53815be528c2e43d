/* What should stand, and does not or only just: towers of synthetic poses that fall, slide, sink and
 * lean, and bodies that jump. */
#include "referee/referee.h"

#include "check.h"
#include "synthetic_run.h"

#include <math.h>
#include <stdio.h>

enum { CUBES = 5 };

/* Five unit cubes on a floor, which may move by half a side; 1 cm is accurate. */
static void begin_tower(run *r)
{
    run_prepare(r, 1);
    run_add_body(r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    for (int k = 1; k <= CUBES; ++k) {
        char name[16];
        (void)snprintf(name, sizeof name, "cube %d", k);
        run_add_body(r, name, pl_shape_box(0.5, 0.5, 0.5), false, 0, k - 0.5);
        run_expect_rest(r, k);
    }
    (void)snprintf(r->scene.primary_error, sizeof r->scene.primary_error, "rest_position_error");
    r->scene.collapse_distance = 0.5;
    r->scene.acceptance = 0.01;
    run_begin(r);
}

/* Moves each cube by its height in the tower times these distances, m, and ends the run. */
static pl_ending end_tower(run *r, double aside, double down)
{
    for (int k = 1; k <= CUBES; ++k) {
        r->state[k].position[0] = aside * k;
        r->state[k].position[2] = k - 0.5 - down * k;
    }
    run_step_many(r, 64);
    return run_finish(r);
}

static void test_leaning_tower_stands_and_leans(void **state)
{
    (void)state;
    run r;
    begin_tower(&r);
    assert_int_equal(end_tower(&r, 0.15, 0), PL_ENDING_OK); /* the top by 0.75 m */
    assert_contains(r.note.text, "leans");
    assert_contains(r.note.text, "\"cube 5\" ended 0.75 m aside");
    run_end(&r);
}

static void test_squashed_tower_stands_and_is_squashed(void **state)
{
    (void)state;
    run r;
    begin_tower(&r);
    assert_int_equal(end_tower(&r, 0, 0.12), PL_ENDING_OK); /* the top by 0.6 m */
    assert_contains(r.note.text, "squashed");
    assert_contains(r.note.text, "0.6 m too low");
    run_end(&r);
}

static void test_cube_that_left_its_support_has_collapsed(void **state)
{
    (void)state;
    run r;
    begin_tower(&r);
    r.state[CUBES].position[0] = 0.51;
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_COLLAPSED);
    assert_contains(r.error.message, "\"cube 5\" ended 0.51 m");
    assert_string_equal(r.note.text, "");
    run_end(&r);
}

static void test_whole_tower_that_slid_has_collapsed(void **state)
{
    (void)state;
    run r;
    begin_tower(&r);
    for (int k = 1; k <= CUBES; ++k) {
        r.state[k].position[0] = 0.6;
    }
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_COLLAPSED);
    run_end(&r);
}

static void test_tower_that_still_falls_has_collapsed(void **state)
{
    (void)state;
    run r;
    begin_tower(&r);
    r.state[CUBES].velocity[0] = 0.5; /* m/s */
    assert_int_equal(end_tower(&r, 0.15, 0), PL_ENDING_COLLAPSED);
    run_end(&r);
}

static void test_small_error_is_noted_beyond_acceptance(void **state)
{
    (void)state;
    const double aside[] = {0.0019, 0.0021};
    for (int i = 0; i < 2; ++i) {
        run r;
        begin_tower(&r);
        assert_int_equal(end_tower(&r, aside[i], 0), PL_ENDING_OK);
        assert_int_equal(r.note.text[0] != '\0', i == 1);
        run_end(&r);
    }
}

/* Nothing must stand in a scene without a distance of collapse. A body that has fallen off does not
 * stand all the same. */
static void test_body_that_fell_off_does_not_stand(void **state)
{
    (void)state;
    const double down[] = {0.3, 5};
    for (int i = 0; i < 2; ++i) {
        run r;
        run_prepare(&r, 1);
        run_add_body(&r, "table", pl_shape_box(1, 1, 0.5), true, 0, -0.5);
        run_add_body(&r, "cube", pl_shape_box(0.5, 0.5, 0.5), false, 0, 0.5);
        run_expect_rest(&r, 1);
        (void)snprintf(r.scene.primary_error, sizeof r.scene.primary_error, "rest_position_error");
        r.scene.collapse_distance = (double)INFINITY;
        r.scene.acceptance = 0.01;
        run_begin(&r);
        r.state[1].position[2] -= down[i];
        run_step_many(&r, 64);
        assert_int_equal(run_finish(&r), PL_ENDING_OK);
        assert_contains(r.note.text, i == 0 ? "stands, but is squashed: body \"cube\" ended 0.3 m"
                                            : "has left its place: body \"cube\" ended 5 m away");
        run_end(&r);
    }
}

/* A turn of the whole world with everything in it moves no body against its support. */
static void test_cube_that_turns_with_its_support_stands(void **state)
{
    (void)state;
    run r;
    begin_tower(&r);
    const double angle = 0.2;
    r.state[CUBES - 1].orientation[0] = r.state[CUBES].orientation[0] = cos(angle / 2);
    r.state[CUBES - 1].orientation[2] = r.state[CUBES].orientation[2] = sin(angle / 2);
    r.state[CUBES].position[0] = r.state[CUBES - 1].position[0] + sin(angle);
    r.state[CUBES].position[2] = r.state[CUBES - 1].position[2] + cos(angle);
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_contains(r.note.text, "0.2 m aside");
    run_end(&r);
}

/* ---- Jumps ---- */

/* A ball at height z above a floor, with a speed along x, moved by `jump` along x in the first step. */
static double unexplained(double z, double jump, double speed)
{
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    run_add_body(&r, "ball", pl_shape_sphere(1), false, 0, z);
    r.scene.bodies[1].velocity[0] = speed;
    run_begin(&r);
    r.state[1].position[0] += jump;
    run_step_many(&r, 64);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    const double found = run_value(&r, PL_METRIC_UNEXPLAINED_MOTION);
    run_end(&r);
    return found;
}

static void test_jump_beyond_speed_and_gravity_is_unexplained(void **state)
{
    (void)state;
    assert_close(unexplained(5, 3, 0), 3 - 9.81 * H * H, 1e-12, 0);
    assert_close(unexplained(5, 3, 64), 2 - 9.81 * H * H, 1e-12, 0);
    assert_close(unexplained(5, 3, 192), 0, 0, 0);
}

static void test_push_out_of_an_overlap_is_explained(void **state)
{
    (void)state;
    assert_close(unexplained(0.9, 0.2, 0), 0, 0, 0); /* 0.1 m deep before and after */
    assert_close(unexplained(0.9, 0.3, 0), 0.1 - 9.81 * H * H, 1e-12, 0);
}

/* A ball that is hit moves with the speed of the one that hits it. */
static void test_motion_with_the_speed_of_the_island_is_explained(void **state)
{
    (void)state;
    for (int apart = 0; apart < 2; ++apart) {
        run r;
        run_prepare(&r, 1);
        run_add_body(&r, "fast", pl_shape_sphere(1), false, 0, 5);
        run_add_body(&r, "slow", pl_shape_sphere(1), false, 2 + 50 * apart, 5);
        r.scene.bodies[0].velocity[0] = 32;
        run_begin(&r);
        r.state[0].velocity[0] = 0;
        r.state[1].position[0] += 0.5;
        run_step_many(&r, 64);
        assert_int_equal(run_finish(&r), PL_ENDING_OK);
        assert_close(run_value(&r, PL_METRIC_UNEXPLAINED_MOTION),
                     apart == 1 ? 0.5 - 9.81 * H * H : 0, 1e-12, 0);
        run_end(&r);
    }
}

/* ---- Free flight ---- */

/* A ball at height z whose velocity changes by `share` of what gravity gives it in a step. */
static const pl_metric *fall(run *r, double z, double share)
{
    run_prepare(r, 1);
    run_add_body(r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    run_add_body(r, "ball", pl_shape_sphere(1), false, 0, z);
    run_begin(r);
    for (int i = 0; i < 64; ++i) {
        r->state[1].velocity[2] -= share * 9.81 * H;
        run_step_many(r, 1);
    }
    assert_int_equal(run_finish(r), PL_ENDING_OK);
    return run_metric(r, PL_METRIC_FREE_FLIGHT_ERROR);
}

static void test_free_flight_takes_the_whole_of_gravity(void **state)
{
    (void)state;
    const double shares[] = {1, 0.75, 0, 1.5};
    for (int i = 0; i < 4; ++i) {
        run r;
        const pl_metric *error = fall(&r, 100, shares[i]);
        assert_int_equal(error->state, PL_METRIC_VALUE);
        assert_close(error->value, fabs(shares[i] - 1), 1e-12, 1e-12);
        run_end(&r);
    }
}

static void test_body_that_may_touch_does_not_fly(void **state)
{
    (void)state;
    const double heights[] = {1, 1.0005}; /* on the floor, and within rounding of it */
    for (int i = 0; i < 2; ++i) {
        run r;
        assert_int_equal(fall(&r, heights[i], 0)->state, PL_METRIC_ABSENT);
        run_end(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_leaning_tower_stands_and_leans),
        cmocka_unit_test(test_squashed_tower_stands_and_is_squashed),
        cmocka_unit_test(test_cube_that_left_its_support_has_collapsed),
        cmocka_unit_test(test_whole_tower_that_slid_has_collapsed),
        cmocka_unit_test(test_tower_that_still_falls_has_collapsed),
        cmocka_unit_test(test_small_error_is_noted_beyond_acceptance),
        cmocka_unit_test(test_body_that_fell_off_does_not_stand),
        cmocka_unit_test(test_cube_that_turns_with_its_support_stands),
        cmocka_unit_test(test_jump_beyond_speed_and_gravity_is_unexplained),
        cmocka_unit_test(test_push_out_of_an_overlap_is_explained),
        cmocka_unit_test(test_motion_with_the_speed_of_the_island_is_explained),
        cmocka_unit_test(test_free_flight_takes_the_whole_of_gravity),
        cmocka_unit_test(test_body_that_may_touch_does_not_fly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
