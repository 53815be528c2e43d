/* Towers and walls of the catalogue: every scene is what its reference says of it, worked out here
 * by another way. */
#include "check.h"
#include "scenario_scene.h"

#include <math.h>

/* Axis-aligned boxes: gaps along x, y and z. They touch where all three are at most zero. */
static void gaps_of(const pl_body *a, const pl_body *b, double gaps[3])
{
    for (int k = 0; k < 3; ++k) {
        gaps[k] = fabs(a->position[k] - b->position[k]) - a->shape.half_extents[k] -
                  b->shape.half_extents[k];
    }
}

static double bottom_of(const pl_body *body)
{
    return body->position[2] - body->shape.half_extents[2];
}

/* No two boxes overlap; each stands on the floor or exactly on others, and its centre of mass lies
 * over the hull of what it stands on along x. Returns the total mass. */
static double check_stacked(const pl_scene *scene)
{
    double mass = 0;
    for (int i = 1; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        double left = HUGE_VAL, right = -HUGE_VAL;
        mass += body->mass;
        if (bottom_of(body) == 0) {
            left = -HUGE_VAL;
            right = HUGE_VAL;
        }
        for (int j = 1; j < scene->body_count; ++j) {
            const pl_body *other = &scene->bodies[j];
            double gaps[3];
            gaps_of(body, other, gaps);
            bool apart = gaps[0] >= 0 || gaps[1] >= 0 || gaps[2] >= 0;
            assert_true(i == j || apart);
            bool below = other->position[2] < body->position[2] && gaps[2] == 0;
            if (i != j && below && gaps[0] < 0 && gaps[1] < 0) {
                left = fmin(left, other->position[0] - other->shape.half_extents[0]);
                right = fmax(right, other->position[0] + other->shape.half_extents[0]);
            }
        }
        assert_true(left < body->position[0] && body->position[0] < right);
        assert_true(bottom_of(body) >= 0);
    }
    return mass;
}

static void test_tower_cubes_touch_and_stand(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=25"};
    pl_scene scene;
    build_scenario("tower", settings, 1, 0, &scene);
    assert_int_equal(scene.body_count, 26);
    assert_close(check_stacked(&scene), 25, 0, 0);
    check_all_rest(&scene);
    const pl_body *top = &scene.bodies[25];
    assert_close(top->position[2] + top->shape.half_extents[2], 25, 0, 0);
    assert_close(top->inertia[0], 1.0 / 6, 0, 1e-15);
    pl_scene_free(&scene);
}

/* The centre of mass of all cubes above a joint lies over the face that its two cubes share. */
static void test_displaced_tower_stands_for_every_seed(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=100", "offset=0.2"};
    double largest = 0;
    for (uint64_t seed = 0; seed < 100; ++seed) {
        pl_scene scene;
        build_scenario("tower", settings, 2, seed, &scene);
        check_stacked(&scene);
        double mass = 0, moment[2] = {0, 0};
        for (int i = scene.body_count - 1; i >= 2; --i) {
            const pl_body *cube = &scene.bodies[i];
            mass += cube->mass;
            for (int k = 0; k < 2; ++k) {
                double below = cube[-1].position[k];
                moment[k] += cube->mass * cube->position[k];
                double low = fmax(below, cube->position[k]) - 0.5;
                double high = fmin(below, cube->position[k]) + 0.5;
                assert_true(low < moment[k] / mass && moment[k] / mass < high);
                largest = fmax(largest, fabs(below));
            }
        }
        pl_scene_free(&scene);
    }
    assert_true(largest > 0.199 && largest <= 0.2);
}

/* The centre of mass of all slabs above a joint lies within half a side of both slabs at it, and so
 * over both faces whatever their turns. */
static void test_yawed_tower_of_slabs_stands_for_every_seed(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=24", "offset=0.17", "yaw=0.8", "height=0.2"};
    double largest = 0;
    for (uint64_t seed = 0; seed < 50; ++seed) {
        pl_scene scene;
        build_scenario("tower", settings, 4, seed, &scene);
        check_all_rest(&scene);
        double sum[2] = {0, 0};
        for (int i = scene.body_count - 1; i >= 1; --i) {
            const pl_body *slab = &scene.bodies[i];
            const double *q = slab->orientation;
            assert_close(q[0] * q[0] + q[3] * q[3], 1, 1e-15, 0);
            assert_true(q[1] == 0 && q[2] == 0);
            assert_close(slab->position[2], 0.2 * (i - 0.5), 1e-14, 0);
            largest = fmax(largest, fabs(2 * atan2(q[3], q[0])));
            sum[0] += slab->position[0];
            sum[1] += slab->position[1];
            for (int k = i; k >= i - 1 && i > 1; --k) {
                const double *x = scene.bodies[k].position;
                const double mean = scene.body_count - i;
                assert_true(hypot(sum[0] / mean - x[0], sum[1] / mean - x[1]) < 0.5);
            }
        }
        pl_scene_free(&scene);
    }
    assert_true(largest > 0.79 && largest <= 0.8);
}

static void test_far_displaced_yawed_tower_is_refused(void **state)
{
    (void)state;
    static const char *const settings[] = {"offset=0.18", "yaw=0.1", NULL};
    assert_scenario_refuses("tower", settings, "expected an offset up to 0.17");
}

/* Masses as their definition says, by the C library's pow, and the scene otherwise that of the
 * plain tower. */
static void test_tower_masses_rise_in_equal_ratios(void **state)
{
    (void)state;
    static const char *const settings[][3] = {{"n=100", "top_mass=1000", "rising_mass=1"},
                                              {"n=100", "top_mass=1", "rising_mass=1000"},
                                              {"n=3", "top_mass=7", "rising_mass=1e6"},
                                              {"n=1", "top_mass=5", "rising_mass=1000"},
                                              {"n=2", "top_mass=1", "rising_mass=1"}};
    static const double top[] = {1000, 1, 7, 5, 1}, rising[] = {1, 1000, 1e6, 1000, 1};
    for (int i = 0; i < 5; ++i) {
        pl_scene scene;
        build_scenario("tower", settings[i], 3, 0, &scene);
        int n = scene.body_count - 1;
        for (int k = 1; k <= n; ++k) {
            const pl_body *cube = &scene.bodies[k];
            double mass = n > 1 ? pow(rising[i], (k - 1.0) / (n - 1)) : 1;
            mass *= k == n ? top[i] : 1;
            assert_close(cube->mass, mass, 0, 1e-12);
            assert_close(cube->inertia[2], mass / 6, 0, 1e-12);
        }
        check_stacked(&scene);
        check_all_rest(&scene);
        pl_scene_free(&scene);
    }
}

static void test_displaced_tower_of_any_masses_stands_by_statics(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=30", "offset=0.2", "top_mass=1e6", "rising_mass=1e6"};
    for (uint64_t seed = 0; seed < 50; ++seed) {
        pl_scene scene;
        build_scenario("tower", settings, 4, seed, &scene);
        check_all_rest(&scene);
        double mass = 0, moment[2] = {0, 0};
        for (int i = scene.body_count - 1; i >= 2; --i) {
            const pl_body *cube = &scene.bodies[i];
            mass += cube->mass;
            for (int k = 0; k < 2; ++k) {
                moment[k] += cube->mass * cube->position[k];
                assert_true(fabs(moment[k] / mass - cube[-1].position[k]) < 0.5);
                assert_true(fabs(moment[k] / mass - cube->position[k]) < 0.5);
            }
        }
        pl_scene_free(&scene);
    }
}

static void test_mass_ratio_is_ten_to_the_k(void **state)
{
    (void)state;
    static const char *const settings[] = {"k=0", "k=1", "k=2", "k=3", "k=4", "k=5", "k=6"};
    static const double ratios[] = {1, 10, 100, 1e3, 1e4, 1e5, 1e6};
    for (int i = 0; i < 7; ++i) {
        pl_scene scene;
        build_scenario("mass-ratio", &settings[i], 1, 0, &scene);
        assert_int_equal(scene.body_count, 3);
        assert_close(scene.bodies[1].mass, 1, 0, 0);
        assert_close(scene.bodies[2].mass, ratios[i], 0, 0);
        check_stacked(&scene);
        check_all_rest(&scene);
        assert_close(scene.bodies[2].position[2], 1.5, 0, 0);
        assert_close(scene.collapse_distance, 0.5, 0, 0);
        pl_scene_free(&scene);
    }
}

static void test_wall_bricks_touch_and_stand(void **state)
{
    (void)state;
    static const char *const sizes[][2] = {{"rows=10", "columns=10"},
                                           {"rows=1", "columns=1"},
                                           {"rows=6", "columns=1"},
                                           {"rows=7", "columns=12"}};
    static const double rows[] = {10, 1, 6, 7}, columns[] = {10, 1, 1, 12};
    for (int i = 0; i < 4; ++i) {
        pl_scene scene;
        build_scenario("wall", sizes[i], 2, 0, &scene);
        double bricks = rows[i] * columns[i] + floor(rows[i] / 2);
        assert_close(scene.body_count - 1, bricks, 0, 0);
        assert_close(check_stacked(&scene), rows[i] * columns[i], 0, 0);
        check_all_rest(&scene);
        /* The bricks fill the wall: their volume is that of the whole. */
        double volume = 0;
        for (int b = 1; b < scene.body_count; ++b) {
            volume += pl_shape_volume(&scene.bodies[b].shape);
        }
        assert_close(volume, columns[i] * 0.5 * rows[i] * 0.5, 0, 1e-14);
        pl_scene_free(&scene);
    }
}

static void test_wall_collapse_is_the_wall_with_ball(void **state)
{
    (void)state;
    pl_scene scene, wall;
    static const char *const settings[] = {"rows=25", "columns=40"};
    build_scenario("wall-collapse", settings, 2, 0, &scene);
    build_scenario("wall", settings, 2, 0, &wall);
    assert_int_equal(pl_scene_steps(&scene), 300);
    assert_int_equal(scene.rest_count, 0);
    assert_true(isinf(scene.collapse_distance));
    assert_int_equal(scene.body_count, wall.body_count + 1);
    for (int i = 0; i < wall.body_count; ++i) {
        const pl_body *brick = &scene.bodies[i], *expected = &wall.bodies[i];
        assert_string_equal(brick->name, expected->name);
        assert_memory_equal(brick->position, expected->position, sizeof brick->position);
        assert_memory_equal(&brick->shape.half_extents, &expected->shape.half_extents,
                            sizeof brick->shape.half_extents);
    }
    const pl_body *ball = &scene.bodies[wall.body_count];
    const double position[3] = {20, -3, 6.55}, velocity[3] = {0, 20, 0};
    for (int k = 0; k < 3; ++k) {
        assert_close(ball->position[k], position[k], 1e-15, 0);
        assert_close(ball->velocity[k], velocity[k], 0, 0);
    }
    assert_close(ball->mass, 100, 0, 0);
    /* It reaches the wall at the height of the bricks: free fall over 1.75 m at 20 m/s. */
    double time = (3 - 0.25 - 1) / 20.0;
    double height = ball->position[2] - 9.81 * time * time / 2;
    assert_true(height > 0 && height < 12.5);
    pl_scene_free(&scene);
    pl_scene_free(&wall);
}

static void test_ball_never_starts_overlapping(void **state)
{
    (void)state;
    static const char *const settings[] = {"rows=1", "columns=1"};
    pl_scene scene;
    build_scenario("wall-collapse", settings, 2, 0, &scene);
    const pl_body *ball = &scene.bodies[scene.body_count - 1];
    assert_true(ball->position[2] >= ball->shape.radius);
    assert_true(ball->position[1] + ball->shape.radius < -0.25);
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tower_cubes_touch_and_stand),
        cmocka_unit_test(test_displaced_tower_stands_for_every_seed),
        cmocka_unit_test(test_yawed_tower_of_slabs_stands_for_every_seed),
        cmocka_unit_test(test_far_displaced_yawed_tower_is_refused),
        cmocka_unit_test(test_tower_masses_rise_in_equal_ratios),
        cmocka_unit_test(test_displaced_tower_of_any_masses_stands_by_statics),
        cmocka_unit_test(test_mass_ratio_is_ten_to_the_k),
        cmocka_unit_test(test_wall_bricks_touch_and_stand),
        cmocka_unit_test(test_wall_collapse_is_the_wall_with_ball),
        cmocka_unit_test(test_ball_never_starts_overlapping),
    };
    return cmocka_run_group_tests_name("catalogue_stacks", tests, NULL, NULL);
}
