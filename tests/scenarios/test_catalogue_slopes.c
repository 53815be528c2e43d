/* Blocks on slopes and on the floor of the catalogue: every scene is what its reference says of it,
 * worked out here by another way. */
#include "check.h"
#include "scenario_scene.h"

#include <math.h>
#include <string.h>

/* The block's lowest corners, turned by its quaternion, all lie on the plane. */
static void check_block_lies_on_plane(const pl_scene *scene, double angle)
{
    const pl_shape *plane = &scene->bodies[0].shape;
    const pl_body *block = &scene->bodies[1];
    const double *q = block->orientation, *h = block->shape.half_extents;
    assert_close(plane->normal[0], sin(angle), 4e-16, 0);
    assert_close(plane->normal[2], cos(angle), 4e-16, 0);
    for (int corner = 0; corner < 4; ++corner) {
        const double v[3] = {corner % 2 == 0 ? h[0] : -h[0], corner / 2 == 0 ? h[1] : -h[1], -h[2]};
        /* v + 2 w (u x v) + 2 u x (u x v) with q = (w, u). */
        const double c[3] = {q[2] * v[2] - q[3] * v[1], q[3] * v[0] - q[1] * v[2],
                             q[1] * v[1] - q[2] * v[0]};
        const double d[3] = {q[2] * c[2] - q[3] * c[1], q[3] * c[0] - q[1] * c[2],
                             q[1] * c[1] - q[2] * c[0]};
        double height = -plane->offset;
        for (int k = 0; k < 3; ++k) {
            height += plane->normal[k] * (block->position[k] + v[k] + 2 * (q[0] * c[k] + d[k]));
        }
        assert_close(height, 0, 3e-16, 0);
    }
}

static void test_slope_blocks_lie_on_the_plane(void **state)
{
    (void)state;
    static const char *const settings[][2] = {
        {"angle=0", "friction=0.1"}, {"angle=0.44", "friction=0.5"}, {"angle=1", "friction=1.6"}};
    static const double angles[] = {0, 0.44, 1};
    pl_scene scene;
    for (int i = 0; i < 3; ++i) {
        build_scenario("slope-stick", settings[i], 2, 0, &scene);
        check_block_lies_on_plane(&scene, angles[i]);
        check_all_rest(&scene);
        pl_scene_free(&scene);
    }
    build_scenario("slope-slide", NULL, 0, 0, &scene);
    check_block_lies_on_plane(&scene, 0.6);
    pl_scene_free(&scene);
}

static void test_slope_threshold_is_the_angle_of_friction(void **state)
{
    (void)state;
    /* atan 0.5 = 0.46364760900080612 (OEIS A073000). */
    pl_scene scene;
    static const char *const below[] = {"angle=0.463647609"}, *const above[] = {"angle=0.46364761"};
    build_scenario("slope-stick", below, 1, 0, &scene);
    pl_scene_free(&scene);
    build_scenario("slope-slide", above, 1, 0, &scene);
    pl_scene_free(&scene);
    assert_setting_refused("slope-stick", above[0], "use slope-slide");
    assert_setting_refused("slope-slide", below[0], "use slope-stick");
    assert_setting_refused("slope-stick", "friction=0", "slope-slide");
}

static void test_slide_direction_is_downhill_along_the_plane(void **state)
{
    (void)state;
    pl_scene scene;
    build_scenario("slope-slide", NULL, 0, 0, &scene);
    assert_int_equal(scene.travel_count, 1);
    const pl_expect_travel *travel = &scene.travels[0];
    const double *normal = scene.bodies[0].shape.normal;
    double along = 0, with_gravity = 0;
    for (int k = 0; k < 3; ++k) {
        along += travel->direction[k] * normal[k];
        with_gravity += travel->direction[k] * scene.gravity[k];
    }
    assert_close(along, 0, 1e-16, 0);
    assert_close(with_gravity, 9.81 * sin(0.6), 0, 1e-15);
    pl_scene_free(&scene);
}

/* Coulomb's law step by step, from gravity and the plane alone: the tangential speed loses at most
 * mu times what the normal one gains. */
static void test_slide_distances_equal_the_summed_recurrence(void **state)
{
    (void)state;
    static const char *const settings[][4] = {
        {"dt=1/60", "duration=2", "angle=0.6", "friction=0.5"},
        {"dt=0.01", "duration=0.505", "angle=1.2", "friction=1.5"},
        {"dt=0.25", "duration=1", "angle=0.3", "friction=0"}};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene;
        build_scenario("slope-slide", settings[i], 4, 0, &scene);
        const pl_expect_travel *travel = &scene.travels[0];
        const double *normal = scene.bodies[0].shape.normal;
        double friction = scene.materials[0].friction;
        double down = 0, into = 0;
        for (int k = 0; k < 3; ++k) {
            down += travel->direction[k] * scene.gravity[k];
            into -= normal[k] * scene.gravity[k];
        }
        long steps = pl_scene_steps(&scene);
        double speed = 0, discrete = 0;
        for (long n = 0; n < steps; ++n) {
            speed = fmax(0, speed + scene.dt * down - friction * scene.dt * into);
            discrete += scene.dt * speed;
        }
        assert_close(travel->discrete, discrete, 0, 1e-12);

        /* Continuous: the classical Runge-Kutta rule for s' = v, v' = a, exact for a parabola. */
        double place = 0, h = (double)steps * scene.dt / 16, a = down - friction * into;
        speed = 0;
        for (int n = 0; n < 16; ++n) {
            double k1 = speed, k2 = speed + h / 2 * a, k3 = k2, k4 = speed + h * a;
            place += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
            speed += h * a;
        }
        assert_close(travel->distance, place, 0, 1e-12);
        pl_scene_free(&scene);
    }
}

/* Coulomb's law step by step: a step takes friction g h from the speed, down to zero. */
static void test_stopping_distances_equal_the_summed_recurrence(void **state)
{
    (void)state;
    static const char *const settings[][4] = {
        {"speed=5", "friction=0.5", "dt=1/60", "duration=3"},
        {"speed=5", "friction=0.5", "dt=1e-5", "duration=1.5"},
        {"speed=2", "friction=1.9", "dt=0.01", "duration=0.05"},
        {"speed=3", "friction=0", "dt=0.01", "duration=2"},
        {"speed=0.05", "friction=0.5", "dt=1/60", "duration=1"}};
    static const double stops_at[] = {25 / 9.81, 25 / 9.81, 0, 0, 0.0025 / 9.81};
    for (int i = 0; i < 5; ++i) {
        pl_scene scene;
        build_scenario("slide-to-stop", settings[i], 4, 0, &scene);
        const pl_expect_travel *travel = &scene.travels[0];
        double braking = scene.materials[0].friction * 9.81, discrete = 0;
        const double *v = scene.bodies[1].velocity;
        double speed = sqrt(v[0] * v[0] + v[1] * v[1]);
        for (long n = pl_scene_steps(&scene); n > 0; --n) {
            speed = fmax(0, speed - braking * scene.dt);
            discrete += scene.dt * speed;
        }
        if (discrete > 0) {
            assert_close(travel->discrete, discrete, 0, 1e-10);
        } else {
            assert_true(isnan(travel->discrete));
        }
        if (stops_at[i] > 0) {
            assert_close(travel->distance, stops_at[i], 0, 1e-14);
        } else {
            assert_close(travel->distance, discrete, 0, 0.1);
        }
        pl_scene_free(&scene);
    }
}

static void test_push_follows_the_azimuth_and_mirrors(void **state)
{
    (void)state;
    static const char *const settings[] = {"azimuth=0", "azimuth=90", "azimuth=25", "azimuth=65",
                                           "azimuth=45"};
    static const double degrees[] = {0, 90, 25, 65, 45};
    double directions[5][3];
    for (int i = 0; i < 5; ++i) {
        pl_scene scene;
        build_scenario("slide-to-stop", &settings[i], 1, 0, &scene);
        double *d = directions[i];
        memcpy(d, scene.travels[0].direction, sizeof directions[i]);
        assert_close(d[0], cos(degrees[i] * 0.017453292519943295), 2e-16, 0);
        assert_close(d[1], sin(degrees[i] * 0.017453292519943295), 2e-16, 0);
        for (int k = 0; k < 3; ++k) {
            assert_close(scene.bodies[1].velocity[k], 5 * d[k], 0, 0);
        }
        check_block_lies_on_plane(&scene, 0);
        pl_scene_free(&scene);
    }
    assert_true(directions[0][1] == 0 && directions[1][0] == 0 && directions[1][1] == 1);
    assert_true(directions[2][0] == directions[3][1] && directions[2][1] == directions[3][0]);
    /* Beyond 2 the block tips. */
    assert_setting_refused("slide-to-stop", "friction=2", "expected 0 to 1.9");
    assert_setting_refused("slide-to-stop", "azimuth=91", "expected 0 to 90");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slope_blocks_lie_on_the_plane),
        cmocka_unit_test(test_slope_threshold_is_the_angle_of_friction),
        cmocka_unit_test(test_slide_direction_is_downhill_along_the_plane),
        cmocka_unit_test(test_slide_distances_equal_the_summed_recurrence),
        cmocka_unit_test(test_stopping_distances_equal_the_summed_recurrence),
        cmocka_unit_test(test_push_follows_the_azimuth_and_mirrors),
    };
    return cmocka_run_group_tests_name("catalogue_slopes", tests, NULL, NULL);
}
