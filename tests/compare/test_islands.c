/* Islands against a flood fill, and the energy that an island gains in a step, of motions that are
 * defined here. */
#include "referee/metrics/modules.h"

#include "check.h"
#include "synthetic_run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COUNT = 60 };

/* Spreads a label over everything that `joined` reaches from `body`. */
static void flood(bool joined[COUNT][COUNT], int label[COUNT], int body, int mark)
{
    label[body] = mark;
    for (int other = 0; other < COUNT; ++other) {
        if (joined[body][other] && label[other] < 0) {
            flood(joined, label, other, mark);
        }
    }
}

static void join_at_random(check_random *random, bool joined[COUNT][COUNT], pl_touching *touching)
{
    memset(joined, 0, sizeof(bool[COUNT][COUNT]));
    for (int i = 0; i < COUNT / 3; ++i) {
        int a = (int)check_uniform(random, 0, COUNT), b = (int)check_uniform(random, 0, COUNT);
        joined[a][b] = joined[b][a] = true;
        const pl_near_pair pair = {.a = a, .b = b, .gap = 1};
        pl_touching_see(touching, &pair);
    }
}

static void test_islands_are_joined_over_two_frames(void **state)
{
    (void)state;
    check_random random = {UINT64_C(88172645463325252)};
    pl_scene scene = pl_scene_default();
    for (int i = 0; i < COUNT; ++i) {
        pl_body body = pl_body_default();
        body.shape = pl_shape_sphere(1);
        body.name[0] = (char)('0' + i);
        assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
    }
    pl_arena arena = {0};
    pl_series depths;
    pl_series_init(&depths, &arena);
    pl_touching *touching = pl_touching_create(&scene, &depths, &arena);
    static bool frames[2][COUNT][COUNT];
    static bool joined[COUNT][COUNT];
    for (int frame = 0; frame < 200; ++frame) {
        pl_touching_begin(touching, frame);
        join_at_random(&random, frames[frame % 2], touching);
        pl_touching_end(touching);
        double growth[COUNT], sum[COUNT] = {0}, largest = -HUGE_VAL;
        int label[COUNT];
        for (int i = 0; i < COUNT; ++i) {
            growth[i] = check_uniform(&random, -1, 1);
            label[i] = -1;
            for (int k = 0; k < COUNT; ++k) {
                joined[i][k] = frames[0][i][k] || frames[1][i][k];
            }
        }
        for (int i = 0; i < COUNT; ++i) {
            if (label[i] < 0) {
                flood(joined, label, i, i);
            }
            sum[label[i]] += growth[i];
        }
        for (int i = 0; i < COUNT; ++i) {
            largest = label[i] == i ? fmax(largest, sum[i]) : largest;
        }
        assert_close(pl_touching_island_max(touching, growth), largest, 0, 0);
    }
    pl_arena_free(&arena);
    pl_scene_free(&scene);
}

/* The gap is unknown from step `first` on; step 0 is the start. */
static void test_unknown_gap_fails_penetration_from_any_step(void **state)
{
    (void)state;
    for (long first = 0; first < 3; ++first) {
        pl_scene scene = pl_scene_default();
        for (int i = 0; i < 2; ++i) {
            pl_body body = pl_body_default();
            body.shape = pl_shape_sphere(1);
            body.name[0] = (char)('a' + i);
            assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
        }
        pl_arena arena = {0};
        pl_metric item[PL_METRIC_COUNT];
        char reason[64];
        pl_series depths;
        pl_series_init(&depths, &arena);
        pl_touching *touching = pl_touching_create(&scene, &depths, &arena);
        for (long step = 0; step < 4; ++step) {
            const pl_near_pair pair = {
                .a = 0, .b = 1, .status = step < first ? PL_OK : PL_FAILED, .gap = -1};
            pl_touching_begin(touching, step);
            pl_touching_see(touching, &pair);
            pl_touching_end(touching);
        }
        const pl_run_view view = {.scene = &scene};
        pl_touching_module.collect(touching, &view, item);
        snprintf(reason, sizeof reason, "no gap found for \"a\" and \"b\" at step %ld", first);
        assert_int_equal(item[PL_METRIC_PENETRATION_MAX].state, PL_METRIC_FAILED);
        assert_int_equal(item[PL_METRIC_PENETRATION_REST].state, PL_METRIC_FAILED);
        assert_string_equal(item[PL_METRIC_PENETRATION_MAX].reason, reason);
        pl_arena_free(&arena);
        pl_scene_free(&scene);
    }
}

/* Balls of radius 0.5 m and 2 kg along x, without gravity; the first moves at 1 m/s, and so E_ref
 * is 1 J. */
static void prepare_balls(run *r, const double *places, int count)
{
    static const char *const names[] = {"a", "b", "c", "d"};
    run_prepare(r, 1);
    memset(r->scene.gravity, 0, sizeof r->scene.gravity);
    for (int i = 0; i < count; ++i) {
        run_add_body(r, names[i], pl_shape_sphere(0.5), false, places[i], 0);
    }
    r->scene.bodies[0].velocity[0] = 1;
}

static double step_gain(run *r)
{
    assert_int_equal(run_finish(r), PL_ENDING_OK);
    double gain = run_value(r, PL_METRIC_ENERGY_STEP_GAIN);
    run_end(r);
    return gain;
}

/* The first ball passes all its speed to the last in one step. */
static double gain_of_a_handed_over_speed(const double *places, int count)
{
    run r;
    prepare_balls(&r, places, count);
    run_begin(&r);
    run_step_many(&r, 3);
    r.state[0].velocity[0] = 0;
    r.state[count - 1].velocity[0] = 1;
    run_step_many(&r, 61);
    return step_gain(&r);
}

static void test_energy_between_touching_bodies_is_no_gain(void **state)
{
    (void)state;
    const double touching[] = {0, 1}, chain[] = {0, 1, 2}, closing[] = {0, 1 + 0.9 * H};
    assert_close(gain_of_a_handed_over_speed(touching, 2), 0, 0, 0);
    assert_close(gain_of_a_handed_over_speed(chain, 3), 0, 0, 0);
    /* Apart, but not by more than they close in a step. */
    assert_close(gain_of_a_handed_over_speed(closing, 2), 0, 0, 0);
}

/* Both continue at half the speed. Only their gap shows in the frame after that they have met. */
static void test_inelastic_impact_within_a_step_is_no_gain(void **state)
{
    (void)state;
    const double places[] = {0, 1 + 0.9 * H};
    run r;
    prepare_balls(&r, places, 2);
    run_begin(&r);
    run_step_many(&r, 3);
    r.state[0].velocity[0] = r.state[1].velocity[0] = 0.5;
    run_step_many(&r, 61);
    assert_close(step_gain(&r), 0, 0, 0);
}

static void test_energy_between_separate_bodies_is_a_gain(void **state)
{
    (void)state;
    const double apart[] = {0, 1.1}, broken[] = {0, 1, 2.1};
    assert_close(gain_of_a_handed_over_speed(apart, 2), 1, 1e-15, 0);
    assert_close(gain_of_a_handed_over_speed(broken, 3), 1, 1e-15, 0);
}

/* They touch in the frame before the exchange and are far apart in the frame after it, or the
 * reverse. */
static void test_parting_or_joining_bodies_are_one_island(void **state)
{
    (void)state;
    for (int order = 0; order < 2; ++order) {
        const double places[] = {0, order == 0 ? 1 : 3};
        run r;
        prepare_balls(&r, places, 2);
        run_begin(&r);
        run_step_many(&r, 3);
        r.state[0].velocity[0] = 0;
        r.state[1].velocity[0] = 1;
        r.state[1].position[0] = order == 0 ? 3 : 1;
        run_step_many(&r, 61);
        assert_close(step_gain(&r), 0, 0, 0);
    }
}

/* Two boxes 5 m apart on one floor: no energy passes between them through the floor. */
static void test_static_body_joins_nothing(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    run_add_body(&r, "other", pl_shape_box(0.5, 0.5, 0.5), false, 5, 0.5);
    r.scene.bodies[1].velocity[0] = 1;
    run_begin(&r);
    run_step_many(&r, 3);
    r.state[1].velocity[0] = 0;
    r.state[2].velocity[0] = 1;
    run_step_many(&r, 61);
    /* E_ref: 1 J + 4 kg g x the height of the bounding spheres, sqrt(3) m. */
    assert_close(step_gain(&r), 1 / (1 + 4 * 9.81 * sqrt(3)), 1e-15, 0);
}

/* A gain counts even if the scene as a whole loses energy at the same time, and even if it is lost
 * again; energy_gain shows neither. */
static void test_gain_is_not_hidden_by_a_loss(void **state)
{
    (void)state;
    run r;
    const double places[] = {0, 10};
    prepare_balls(&r, places, 2);
    run_begin(&r);
    run_step_many(&r, 9);
    r.state[0].velocity[0] = 0;
    run_step_many(&r, 1);
    r.state[1].velocity[1] = 0.5;
    run_step_many(&r, 1);
    r.state[1].velocity[1] = 0;
    run_step_many(&r, 53);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_ENERGY_GAIN), 0, 0, 0);
    assert_close(run_value(&r, PL_METRIC_ENERGY_STEP_GAIN), 0.25, 1e-15, 0);
    assert_int_equal(run_metric(&r, PL_METRIC_ENERGY_STEP_GAIN)->worst_step, 11);
    run_end(&r);
}

/* A box is moved up by 1 mm without a velocity: it gains potential energy without a cause. */
static void test_displacement_without_velocity_is_a_gain(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    run_begin(&r);
    run_step_many(&r, 3);
    r.state[1].position[2] += 1e-3;
    run_step_many(&r, 61);
    assert_close(step_gain(&r), 1e-3 / sqrt(3), 0, 1e-12);
}

static void test_loss_in_every_step_is_no_gain(void **state)
{
    (void)state;
    run r;
    const double places[] = {0};
    prepare_balls(&r, places, 1);
    run_begin(&r);
    for (int k = 1; k <= 64; ++k) {
        r.state[0].velocity[0] = 1 - k / 65.0;
        run_step_many(&r, 1);
    }
    assert_close(step_gain(&r), 0, 0, 0);
}

static void test_work_of_scene_forces_is_no_step_gain(void **state)
{
    (void)state;
    run r;
    const double places[] = {0, 10};
    prepare_balls(&r, places, 2);
    const pl_force push = {.body = 1, .force = {0, 0, 6}, .from = 0, .until = HUGE_VAL};
    assert_int_equal(pl_scene_add_force(&r.scene, &push, NULL), PL_OK);
    run_begin(&r);
    for (int k = 1; k <= 64; ++k) {
        r.state[0].position[0] += H;
        r.state[1].velocity[2] += 3 * H;
        r.state[1].position[2] += H * r.state[1].velocity[2];
        run_step_many(&r, 1);
    }
    assert_close(step_gain(&r), 0, 1e-14, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_islands_are_joined_over_two_frames),
        cmocka_unit_test(test_unknown_gap_fails_penetration_from_any_step),
        cmocka_unit_test(test_energy_between_touching_bodies_is_no_gain),
        cmocka_unit_test(test_inelastic_impact_within_a_step_is_no_gain),
        cmocka_unit_test(test_energy_between_separate_bodies_is_a_gain),
        cmocka_unit_test(test_parting_or_joining_bodies_are_one_island),
        cmocka_unit_test(test_static_body_joins_nothing),
        cmocka_unit_test(test_gain_is_not_hidden_by_a_loss),
        cmocka_unit_test(test_displacement_without_velocity_is_a_gain),
        cmocka_unit_test(test_loss_in_every_step_is_no_gain),
        cmocka_unit_test(test_work_of_scene_forces_is_no_step_gain),
    };
    return cmocka_run_group_tests_name("islands", tests, NULL, NULL);
}
