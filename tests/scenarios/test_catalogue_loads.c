/* The catalogue's loads on light cubes: what is expected at rest stands by statics, and the load falls
 * straight to it. Its bodies that start in overlap, and where they belong. */
#include "check.h"
#include "scenario_scene.h"

#include <math.h>
#include <string.h>

static const char *const scenes[][6] = {
    {"dropped-load", NULL},
    {"dropped-load", "n=8", "ratio=1000", "offset=0.4", "height=5", NULL},
    {"lid", NULL},
    {"lid", "k=2", "layers=1", "gap=0", "height=0.5", NULL},
    {"raft", NULL},
    {"raft", "k=4", "layers=3", "height=1", "size=1", NULL},
    {"raft", "k=9", "size=12", "gap=0.1", NULL},
};
enum { SCENES = sizeof scenes / sizeof scenes[0] };

static double side_of(const pl_scene *scene, int body, int axis)
{
    return scene->bodies[body].shape.half_extents[axis];
}

/* How far two bodies are apart at their places of rest, along an axis; below 0 they overlap in it. */
static double gap_of(const pl_scene *scene, int a, int b, int axis)
{
    const double distance = scene->rests[a - 1].position[axis] - scene->rests[b - 1].position[axis];
    return fabs(distance) - side_of(scene, a, axis) - side_of(scene, b, axis);
}

/* The place of rest of each body: on the floor or flush on others, and apart from all. The load's
 * centre is within the rectangle around what carries it, and there it is symmetric or one cube. */
static void check_standing(const pl_scene *scene)
{
    for (int i = 1; i < scene->body_count; ++i) {
        double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
        const double *place = scene->rests[i - 1].position;
        bool carried = place[2] == side_of(scene, i, 2);
        for (int j = 1; j < scene->body_count; ++j) {
            const double *other = scene->rests[j - 1].position;
            const double x = gap_of(scene, i, j, 0), y = gap_of(scene, i, j, 1);
            const double z = gap_of(scene, i, j, 2);
            assert_true(i == j || fmax(fmax(x, y), z) > -1e-14);
            const bool below = i != j && fabs(z) < 1e-14 && other[2] < place[2];
            for (int k = 0; k < 2 && below && x < -1e-9 && y < -1e-9; ++k) {
                low[k] = fmin(low[k], other[k] - side_of(scene, j, k));
                high[k] = fmax(high[k], other[k] + side_of(scene, j, k));
                carried = true;
            }
        }
        assert_true(carried);
        const bool on_floor = low[0] > high[0];
        for (int k = 0; k < 2; ++k) {
            assert_true(on_floor || (low[k] < place[k] && place[k] < high[k]));
        }
    }
}

static void test_loads_rest_flush_on_what_carries_them(void **state)
{
    (void)state;
    for (int i = 0; i < SCENES; ++i) {
        pl_scene scene = scenario_scene(scenes[i][0], scenes[i] + 1);
        assert_int_equal(scene.rest_count, scene.body_count - 1);
        check_standing(&scene);
        pl_scene_free(&scene);
    }
}

/* Only the load starts elsewhere: straight above its place. */
static void test_loads_start_above_their_place(void **state)
{
    (void)state;
    static const double heights[SCENES] = {1, 5, 0, 0.5, 0, 1, 0};
    static const double ratios[SCENES] = {100, 1000, 1000, 1000, 1000, 1000, 1000};
    for (int i = 0; i < SCENES; ++i) {
        pl_scene scene = scenario_scene(scenes[i][0], scenes[i] + 1);
        for (int j = 1; j < scene.body_count; ++j) {
            const double *place = scene.rests[j - 1].position, *start = scene.bodies[j].position;
            const bool load = j == scene.body_count - 1;
            assert_close(start[2] - place[2], load ? heights[i] : 0, 1e-15, 0);
            assert_close(start[0], place[0], 0, 0);
            assert_close(start[1], place[1], 0, 0);
            assert_close(scene.bodies[j].mass, load ? ratios[i] : 1, 0, 0);
        }
        pl_scene_free(&scene);
    }
}

static void test_accurate_holds_loads_where_they_rest(void **state)
{
    (void)state;
    static const char *const few[] = {"k=3", "height=0.5", "duration=1.5", NULL};
    static const char *const heavy[] = {"ratio=1000", "offset=0.3", NULL};
    static const char *const lid[] = {"height=0.1", "duration=1", NULL};
    assert_at_most(accurate_metric("raft", few, "1/60", "rest_position_error"), 1e-3);
    assert_at_most(accurate_metric("dropped-load", heavy, "1/60", "rest_position_error"), 1e-6);
    assert_at_most(accurate_metric("lid", lid, "1/60", "rest_position_error"), 1e-6);
}

/* How deep two bodies are in each other along their least axis, as boxes; at their start, or at rest. A
 * ball overlaps along z alone, where it is as high as its box. */
static double depth_of(const pl_scene *scene, int a, int b, bool at_rest)
{
    double depth = HUGE_VAL;
    const pl_body *body[2] = {&scene->bodies[a], &scene->bodies[b]};
    double x[2][3], half[2][3];
    for (int i = 0; i < 2; ++i) {
        memcpy(x[i], body[i]->position, sizeof x[i]);
        for (int k = 0; k < 3; ++k) {
            const bool ball = body[i]->shape.kind == PL_SHAPE_SPHERE;
            half[i][k] = ball ? body[i]->shape.radius : body[i]->shape.half_extents[k];
        }
        for (int r = 0; r < scene->rest_count && at_rest; ++r) {
            if (scene->rests[r].body == (i == 0 ? a : b)) {
                memcpy(x[i], scene->rests[r].position, sizeof x[i]);
            }
        }
    }
    for (int k = 0; k < 3; ++k) {
        depth = fmin(depth, half[0][k] + half[1][k] - fabs(x[0][k] - x[1][k]));
    }
    return depth;
}

static void test_overlapping_bodies_end_apart_or_stay(void **state)
{
    (void)state;
    static const char *const settings[] = {"overlap=0.2", NULL};
    pl_scene scene = scenario_scene("overlapping-start", settings);
    int stay = 0, part = 0;
    for (int i = 0; i < scene.rest_count; ++i) {
        const int body = scene.rests[i].body;
        const double *start = scene.bodies[body].position, *end = scene.rests[i].position;
        double way = 0, deepest = 0.5 - start[2], left = 0.5 - end[2];
        for (int k = 0; k < 3; ++k) {
            way += fabs(end[k] - start[k]);
        }
        for (int j = 1; j < scene.body_count; ++j) {
            deepest = fmax(deepest, j == body ? 0 : depth_of(&scene, body, j, false));
            left = fmax(left, j == body ? 0 : depth_of(&scene, body, j, true));
        }
        assert_close(deepest, 0.2, 1e-14, 0);
        assert_close(left, way > 0 ? 0 : 0.2, 1e-14, 0);
        stay += way == 0;
        part += way > 0;
        assert_true(way == 0 || fabs(way - 0.2) < 1e-14 || fabs(way - 0.1) < 1e-14);
    }
    assert_int_equal(stay, 2);
    assert_int_equal(part, 6);
    pl_scene_free(&scene);
}

static void test_accurate_parts_what_can_be_parted(void **state)
{
    (void)state;
    assert_at_most(accurate_metric("overlapping-start", NULL, "1/60", "rest_position_error"), 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_loads_rest_flush_on_what_carries_them),
        cmocka_unit_test(test_loads_start_above_their_place),
        cmocka_unit_test(test_accurate_holds_loads_where_they_rest),
        cmocka_unit_test(test_overlapping_bodies_end_apart_or_stay),
        cmocka_unit_test(test_accurate_parts_what_can_be_parted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
