/* Scenes of many bodies: their largest sizes, the houses of a city, and the stones of an
 * avalanche. */
#include "check.h"
#include "plumb_process.h"
#include "run_result.h"
#include "scenario_scene.h"
#include "scene_equal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int moving_bodies(const pl_scene *scene)
{
    int count = 0;
    for (int i = 0; i < scene->body_count; ++i) {
        count += scene->bodies[i].is_static ? 0 : 1;
    }
    return count;
}

static void test_scenes_reach_a_hundred_thousand_bodies(void **state)
{
    (void)state;
    static const char *const names[] = {"blocks",      "pile", "multi-tower",
                                        "multi-tower", "city", "avalanche"};
    static const char *const settings[][4] = {{"n=100000", NULL},
                                              {"n=100000", NULL},
                                              {"k=100", "n=10", NULL},
                                              {"k=31", "n=100", NULL},
                                              {"houses=25000", "rows=1", "columns=1", NULL},
                                              {"n=100000", NULL}};
    static const int counts[] = {100000, 100000, 100000, 96100, 100000, 100000};
    for (int i = 0; i < 6; ++i) {
        pl_scene scene = scenario_scene(names[i], settings[i]);
        assert_int_equal(moving_bodies(&scene), counts[i]);
        pl_scene_free(&scene);
    }
}

static void test_fields_of_more_bodies_are_refused(void **state)
{
    (void)state;
    static const char *const towers[] = {"k=100", "n=11", NULL};
    static const char *const houses[] = {"houses=251", "rows=10", "columns=10", NULL};
    assert_scenario_refuses("multi-tower", towers,
                            "expected at most 100000 cubes, found k * k * n = 110000");
    assert_scenario_refuses("city", houses, "expected at most 100000 bricks, found 4 * houses");
}

/* ---- City ---- */

/* Length that two boxes share along x or y; negative where they are apart. */
static double shared_length(const pl_body *a, const pl_body *b, int axis)
{
    const double reach = a->shape.half_extents[axis] + b->shape.half_extents[axis];
    const double most = 2 * fmin(a->shape.half_extents[axis], b->shape.half_extents[axis]);
    return fmin(reach - fabs(a->position[axis] - b->position[axis]), most);
}

/* The area, m^2, that two bricks share seen from above. */
static double shared_area(const pl_body *a, const pl_body *b)
{
    return fmax(shared_length(a, b, 0), 0) * fmax(shared_length(a, b, 1), 0);
}

/* Bricks of a row share no area. Each brick of a higher row lies on the row below with all of its
 * own 1/2 m^2. All rows of a house then cover the same area, and an even pressure on every face is
 * in balance with the weights, whatever the friction. */
static void test_city_bricks_lie_on_bricks_all_over(void **state)
{
    (void)state;
    static const char *const settings[][4] = {{"houses=1", "rows=4", "columns=1", NULL},
                                              {"houses=1", "rows=5", "columns=4", NULL},
                                              {"houses=5", "rows=3", "columns=2", NULL}};
    static const int counts[] = {16, 80, 120};
    for (int s = 0; s < 3; ++s) {
        pl_scene scene = scenario_scene("city", settings[s]);
        check_all_rest(&scene);
        assert_int_equal(moving_bodies(&scene), counts[s]);
        for (int i = 1; i < scene.body_count; ++i) {
            const pl_body *brick = &scene.bodies[i];
            double support = 0;
            for (int j = 1; j < scene.body_count; ++j) {
                const double rise = brick->position[2] - scene.bodies[j].position[2];
                const double area = shared_area(brick, &scene.bodies[j]);
                support += rise == 0.5 ? area : 0;
                assert_true(i == j || rise != 0 || area == 0);
            }
            assert_close(brick->mass, 1, 0, 0);
            assert_close(support, brick->position[2] == 0.25 ? 0 : 0.5, 1e-15, 0);
        }
        pl_scene_free(&scene);
    }
}

static bool is_along_x(const pl_body *brick)
{
    return brick->shape.half_extents[0] > brick->shape.half_extents[1];
}

/* At each of the four corners, a brick of every row but the lowest lies on one of the other wall. */
static void test_walls_of_a_house_are_bonded(void **state)
{
    (void)state;
    static const char *const settings[] = {"houses=1", "rows=6", "columns=3", NULL};
    pl_scene scene = scenario_scene("city", settings);
    int bonds[6] = {0};
    for (int i = 1; i < scene.body_count; ++i) {
        const pl_body *brick = &scene.bodies[i];
        for (int j = 1; j < scene.body_count; ++j) {
            const pl_body *below = &scene.bodies[j];
            if (brick->position[2] - below->position[2] == 0.5 && shared_area(brick, below) > 0 &&
                is_along_x(brick) != is_along_x(below)) {
                ++bonds[(int)(2 * brick->position[2])];
            }
        }
    }
    assert_int_equal(bonds[0], 0);
    for (int row = 1; row < 6; ++row) {
        assert_int_equal(bonds[row], 4);
    }
    pl_scene_free(&scene);
}

/* Houses of a city have the bricks of one house each, and a street of 2 m between them. */
static void test_houses_are_alike_and_streets_apart(void **state)
{
    (void)state;
    static const char *const settings[] = {"houses=6", "rows=2", "columns=2", NULL};
    enum { BRICKS = 16 };
    pl_scene scene = scenario_scene("city", settings);
    for (int i = 1; i < scene.body_count; ++i) {
        const pl_body *brick = &scene.bodies[i], *like = &scene.bodies[1 + (i - 1) % BRICKS];
        const pl_body *first = &scene.bodies[1 + (i - 1) / BRICKS * BRICKS];
        for (int k = 0; k < 3; ++k) {
            assert_close(brick->position[k] - first->position[k],
                         like->position[k] - scene.bodies[1].position[k], 1e-14, 0);
        }
        for (int j = 1; j < i; ++j) {
            const pl_body *other = &scene.bodies[j];
            const double shared =
                fmin(shared_length(brick, other, 0), shared_length(brick, other, 1));
            assert_true((i - 1) / BRICKS == (j - 1) / BRICKS || shared <= -2 + 1e-12);
        }
    }
    pl_scene_free(&scene);
}

static void test_accurate_profile_keeps_city_at_rest(void **state)
{
    (void)state;
    static const char *const settings[] = {"houses=2", "rows=3", "columns=2", "duration=1", NULL};
    assert_at_most(accurate_metric("city", settings, "1/60", "rest_position_error"), 1e-9);
}

/* ---- Avalanche ---- */

enum { FLOOR, SLOPE, FIRST_STONE };

static double height_over(const pl_body *plane, const double place[3])
{
    const double *n = plane->shape.normal;
    return n[0] * place[0] + n[1] * place[1] + n[2] * place[2] - plane->shape.offset;
}

/* From the origin of the stone's frame to its farthest vertex. */
static double reach_of(const pl_shape *stone)
{
    double most = 0;
    for (int i = 0; i < stone->polyhedron->vertex_count; ++i) {
        const double *v = stone->polyhedron->vertices[i];
        most = fmax(most, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
    return most;
}

static double distance_between(const double *a, const double *b)
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

static void test_stones_start_apart_on_their_slope(void **state)
{
    (void)state;
    static const char *const settings[][4] = {
        {NULL}, {"angle=80", "distance=0", "n=50", NULL}, {"angle=5", "distance=7", "n=50", NULL}};
    static const double distances[] = {4, 0, 7}, degrees[] = {40, 80, 5};
    for (int s = 0; s < 3; ++s) {
        pl_scene scene = scenario_scene("avalanche", settings[s]);
        const double angle = degrees[s] * acos(-1) / 180;
        double lowest = HUGE_VAL;
        assert_close(scene.bodies[SLOPE].shape.normal[0], sin(angle), 1e-15, 0);
        for (int i = FIRST_STONE; i < scene.body_count; ++i) {
            const pl_body *stone = &scene.bodies[i];
            const double *x = stone->position, reach = reach_of(&stone->shape);
            assert_true(height_over(&scene.bodies[SLOPE], x) > reach);
            assert_close(stone->mass, pl_shape_volume(&stone->shape), 0, 1e-15);
            assert_true(stone->velocity[0] == 0 && stone->velocity[2] == 0);
            lowest = fmin(lowest, x[2] * sin(angle) - x[0] * cos(angle));
            for (int j = FIRST_STONE; j < i; ++j) {
                const pl_body *other = &scene.bodies[j];
                assert_true(distance_between(x, other->position) > reach + reach_of(&other->shape));
            }
        }
        assert_close(lowest, distances[s] + 0.425, 1e-12, 0);
        pl_scene_free(&scene);
    }
}

static void test_stones_differ_and_repeat_in_large_scenes(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=700", NULL};
    pl_scene scene = scenario_scene("avalanche", settings);
    for (int i = FIRST_STONE; i < scene.body_count; ++i) {
        const pl_body *stone = &scene.bodies[i];
        assert_int_equal(stone->shape.kind, PL_SHAPE_HULL);
        for (int j = FIRST_STONE; j < i; ++j) {
            const pl_body *other = &scene.bodies[j];
            const bool same = stone->shape.polyhedron == other->shape.polyhedron;
            assert_true(same == ((i - j) % 300 == 0));
            assert_true(same == (stone->mass == other->mass));
            assert_memory_not_equal(stone->orientation, other->orientation,
                                    sizeof stone->orientation);
        }
    }
    pl_scene_free(&scene);
}

static void test_avalanche_depends_only_on_the_seed(void **state)
{
    (void)state;
    pl_scene first, again, other;
    char hash[2][17];
    build_scenario("avalanche", NULL, 0, 3, &first);
    build_scenario("avalanche", NULL, 0, 3, &again);
    build_scenario("avalanche", NULL, 0, 4, &other);
    assert_same_scene(&again, &first);
    assert_int_equal(pl_scene_hash(&first, hash[0], NULL), PL_OK);
    assert_int_equal(pl_scene_hash(&other, hash[1], NULL), PL_OK);
    assert_string_not_equal(hash[0], hash[1]);
    pl_scene_free(&first);
    pl_scene_free(&again);
    pl_scene_free(&other);
}

/* The least height over the plane of a stone's vertices, at the pose [x, y, z, qw, qx, qy, qz]. */
static double clearance(const pl_body *plane, const pl_shape *stone, const double pose[7])
{
    const double *q = &pose[3];
    double least = HUGE_VAL;
    for (int i = 0; i < stone->polyhedron->vertex_count; ++i) {
        const double *v = stone->polyhedron->vertices[i];
        /* v + 2 w (u x v) + 2 u x (u x v), u the vector part of q */
        double turned[3], first[3];
        for (int k = 0; k < 3; ++k) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            first[k] = q[1 + a] * v[b] - q[1 + b] * v[a];
        }
        for (int k = 0; k < 3; ++k) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            const double second = q[1 + a] * first[b] - q[1 + b] * first[a];
            turned[k] = pose[k] + v[k] + 2 * q[0] * first[k] + 2 * second;
        }
        least = fmin(least, height_over(plane, turned));
    }
    return least;
}

/* Released, the stones end lower and farther out than they start, above the ground, and have lost
 * no more energy than they had over the floor. */
static void test_avalanche_runs_down_and_stays_above_ground(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=40", "duration=3", NULL};
    static const char *const arguments[] = {"run",    "avalanche",  "--set",    "n=40",
                                            "--set",  "duration=3", "--engine", "plumb:accurate",
                                            "--json", "-",          NULL};
    pl_scene scene = scenario_scene("avalanche", settings);
    json_t *result = run_to_json(arguments);
    const json_t *poses = json_object_get(result, "final_poses");
    assert_string_equal(result_text(result, "outcome"), "ok");
    assert_at_most(metric(result, "chaotic_error"), 0.1);
    double energy = 0;
    for (int i = FIRST_STONE; i < scene.body_count; ++i) {
        const pl_body *stone = &scene.bodies[i];
        double x[7];
        for (size_t k = 0; k < 7; ++k) {
            x[k] = json_number_value(json_array_get(json_array_get(poses, (size_t)i), k));
        }
        energy += stone->mass * 9.81 * stone->position[2];
        assert_true(x[0] > stone->position[0] && x[2] < stone->position[2]);
        assert_true(clearance(&scene.bodies[FLOOR], &stone->shape, x) > -1e-3);
        assert_true(clearance(&scene.bodies[SLOPE], &stone->shape, x) > -1e-3);
    }
    assert_at_most(metric(result, "energy_lost"), energy);
    assert_true(metric(result, "energy_lost") > 0);
    json_decref(result);
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scenes_reach_a_hundred_thousand_bodies),
        cmocka_unit_test(test_fields_of_more_bodies_are_refused),
        cmocka_unit_test(test_city_bricks_lie_on_bricks_all_over),
        cmocka_unit_test(test_walls_of_a_house_are_bonded),
        cmocka_unit_test(test_houses_are_alike_and_streets_apart),
        cmocka_unit_test(test_accurate_profile_keeps_city_at_rest),
        cmocka_unit_test(test_stones_start_apart_on_their_slope),
        cmocka_unit_test(test_stones_differ_and_repeat_in_large_scenes),
        cmocka_unit_test(test_avalanche_depends_only_on_the_seed),
        cmocka_unit_test(test_avalanche_runs_down_and_stays_above_ground),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
