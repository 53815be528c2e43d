/* The catalogue's dominoes and falling cubes: properties that hold before and during the fall. */
#include "check.h"
#include "plumb_process.h"
#include "run_result.h"
#include "scenario_scene.h"

#include <math.h>
#include <string.h>

static const double g = 9.81; /* m/s^2 */

/* Kinetic energy of the first domino against the height to which its centre must rise, and its
 * leading edge at rest. */
static void test_first_domino_has_its_multiple_of_tipping_energy(void **state)
{
    (void)state;
    static const char *const settings[][4] = {{"push=1", NULL}, {"push=2", "size=0.05", NULL}};
    static const double pushes[] = {1, 2}, sizes[] = {1, 0.05};
    for (int i = 0; i < 2; ++i) {
        pl_scene scene = scenario_scene("dominoes", settings[i]);
        const pl_body *first = &scene.bodies[1];
        const double *half = first->shape.half_extents, *v = first->velocity;
        const double w = first->angular_velocity[1];
        const double energy = (v[0] * v[0] + v[2] * v[2] + first->inertia[1] * w * w) / 2;
        const double rise = hypot(half[0], half[2]) - half[2];
        assert_close(half[2], sizes[i] / 2, 0, 1e-15);
        assert_close(energy, pushes[i] * pushes[i] * g * rise, 0, 1e-12);
        /* v + w y x r at r = (half_x, 0, -half_z) */
        assert_close(v[0] - w * half[2], 0, 1e-15, 0);
        assert_close(v[2] - w * half[0], 0, 1e-15, 0);
        pl_scene_free(&scene);
    }
}

/* Along the spiral each domino faces the next; across it turns are farther apart than dominoes are
 * wide. The first one turns about its leading edge. */
static void test_dominoes_of_a_spiral_face_the_next(void **state)
{
    (void)state;
    pl_scene scene = scenario_scene("domino-spiral", NULL);
    assert_int_equal(scene.body_count, 151);
    for (int i = 1; i < 150; ++i) {
        const double *x = scene.bodies[i].position, *next = scene.bodies[i + 1].position;
        const double *q = scene.bodies[i].orientation;
        const double facing[2] = {1 - 2 * q[3] * q[3], 2 * q[0] * q[3]};
        const double way[2] = {next[0] - x[0], next[1] - x[1]};
        const double distance = hypot(way[0], way[1]);
        assert_true(distance > 0.48 && distance < 0.51);
        assert_true((facing[0] * way[0] + facing[1] * way[1]) / distance > cos(0.15));
        assert_close(q[0] * q[0] + q[3] * q[3], 1, 1e-15, 0);
        for (int k = i + 3; k <= 150; ++k) {
            const double *other = scene.bodies[k].position;
            assert_true(hypot(other[0] - x[0], other[1] - x[1]) > 0.9);
        }
    }
    const pl_body *first = &scene.bodies[1];
    const double *q = first->orientation, *v = first->velocity, *w = first->angular_velocity;
    const double facing[2] = {1 - 2 * q[3] * q[3], 2 * q[0] * q[3]};
    const double edge[3] = {0.075 * facing[0], 0.075 * facing[1], -0.5};
    assert_close(v[0] + w[1] * edge[2] - w[2] * edge[1], 0, 1e-12, 0);
    assert_close(v[1] + w[2] * edge[0] - w[0] * edge[2], 0, 1e-12, 0);
    assert_close(v[2] + w[0] * edge[1] - w[1] * edge[0], 0, 1e-12, 0);
    assert_true(w[1] * facing[0] - w[0] * facing[1] > 0);
    pl_scene_free(&scene);
}

static void test_falling_cubes_start_apart_by_the_seed(void **state)
{
    (void)state;
    pl_scene scene = scenario_scene("falling-cubes", NULL);
    assert_int_equal(scene.body_count, 28);
    for (int i = 1; i < scene.body_count; ++i) {
        const double *p = scene.bodies[i].position, *q = scene.bodies[i].orientation;
        assert_close(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-15, 0);
        assert_true(p[2] > 1 + sqrt(0.75));
        for (int j = 1; j < i; ++j) {
            const double *other = scene.bodies[j].position;
            const double distance =
                sqrt(pow(p[0] - other[0], 2) + pow(p[1] - other[1], 2) + pow(p[2] - other[2], 2));
            assert_true(distance > sqrt(3));
            assert_memory_not_equal(q, scene.bodies[j].orientation,
                                    sizeof scene.bodies[j].orientation);
        }
    }
    pl_scene_free(&scene);
}

/* Every cube of a stack carries the centre of what is above it; stacks and dominoes are apart; the
 * last domino reaches the pile. */
static void test_the_pile_before_the_dominoes_stands_by_itself(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=4", "layers=5", NULL};
    pl_scene scene = scenario_scene("domino-into-pile", settings);
    const int first = 1 + 4;
    const pl_body *last_domino = &scene.bodies[4];
    assert_int_equal(scene.body_count, first + 45);
    double nearest = HUGE_VAL;
    for (int i = first; i < scene.body_count; ++i) {
        const pl_body *cube = &scene.bodies[i];
        nearest = fmin(nearest, cube->position[0] - 0.15);
        const int layer = (i - first) / 9;
        assert_close(cube->position[2], 0.3 * layer + 0.15, 1e-15, 0);
        double sum[2] = {0, 0};
        int above = 0;
        for (int j = i + 9; j < scene.body_count; j += 9, ++above) {
            sum[0] += scene.bodies[j].position[0];
            sum[1] += scene.bodies[j].position[1];
        }
        for (int k = 0; k < 2 && above > 0; ++k) {
            assert_true(fabs(sum[k] / above - cube->position[k]) < 0.1);
        }
        for (int j = first + layer * 9; j < i; ++j) {
            const double *p = scene.bodies[j].position;
            assert_true(fabs(p[0] - cube->position[0]) > 0.3 ||
                        fabs(p[1] - cube->position[1]) > 0.3);
        }
    }
    assert_true(nearest > last_domino->position[0] + 0.075);
    assert_true(nearest < last_domino->position[0] + 0.075 + 1);
    pl_scene_free(&scene);
}

static void test_accurate_profile_topples_all_dominoes_without_overlap(void **state)
{
    (void)state;
    static const char *const arguments[] = {
        "run", "dominoes", "--engine", "plumb:accurate", "--dt", "1/240", "--json", "-", NULL};
    json_t *result = run_to_json(arguments);
    assert_string_equal(result_text(result, "outcome"), "ok");
    assert_at_most(metric(result, "penetration_max"), 1e-3);
    const json_t *poses = json_object_get(result, "final_poses");
    assert_int_equal(json_array_size(poses), 21);
    for (size_t i = 1; i < 21; ++i) {
        /* Fallen: the centre is far below the half height at which it stood. */
        assert_true(json_number_value(json_array_get(json_array_get(poses, i), 2)) < 0.4);
    }
    json_decref(result);
}

static void test_accurate_lets_no_cube_overlap(void **state)
{
    (void)state;
    static const char *const small[] = {"n=8", "columns=2", "duration=2", NULL};
    assert_at_most(accurate_metric("falling-cubes", small, "1/240", "penetration_max"), 1e-3);
    static const char *const few[] = {"n=4", "layers=2", "duration=3", NULL};
    assert_at_most(accurate_metric("domino-into-pile", few, "1/240", "penetration_max"), 1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_first_domino_has_its_multiple_of_tipping_energy),
        cmocka_unit_test(test_dominoes_of_a_spiral_face_the_next),
        cmocka_unit_test(test_falling_cubes_start_apart_by_the_seed),
        cmocka_unit_test(test_the_pile_before_the_dominoes_stands_by_itself),
        cmocka_unit_test(test_accurate_profile_topples_all_dominoes_without_overlap),
        cmocka_unit_test(test_accurate_lets_no_cube_overlap),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
