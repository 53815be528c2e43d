/* What rests in the catalogue: scenes whose answer is that nothing moves stand by a limit analysis
 * that knows none of them, and are placed as they say; and formulas of statics by other ways. */
#include "check.h"
#include "referee/geometry/gap.h"
#include "scenario_scene.h"
#include "statics.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static double gap_between(const pl_scene *scene, int a, int b)
{
    pl_placed_shape placed[2];
    const int bodies[2] = {a, b};
    for (int i = 0; i < 2; ++i) {
        const pl_body *body = &scene->bodies[bodies[i]];
        placed[i] = (pl_placed_shape){.shape = &body->shape};
        memcpy(placed[i].position, body->position, sizeof body->position);
        memcpy(placed[i].orientation, body->orientation, sizeof body->orientation);
    }
    double gap = 0;
    assert_int_equal(pl_gap(&placed[0], &placed[1], (double)INFINITY, &gap), PL_OK);
    return gap;
}

/* Puts every body where it is expected to rest. */
static void settle(pl_scene *scene)
{
    for (int i = 0; i < scene->rest_count; ++i) {
        pl_body *body = &scene->bodies[scene->rests[i].body];
        memcpy(body->position, scene->rests[i].position, sizeof body->position);
        memcpy(body->orientation, scene->rests[i].orientation, sizeof body->orientation);
    }
}

/* Forces of equilibrium by linear programming, with no more friction than there is. */
static void test_what_rests_has_forces_that_hold_it(void **state)
{
    (void)state;
    static const char *const names[] = {
        "tower",    "tower",       "mass-ratio",    "wall",
        "wall",     "slope-stick", "large-step",    "initial-overlap",
        "thin-rod", "multi-tower", "needle-in-gap", "pyramid"};
    static const char *const settings[][4] = {{"n=8", "friction=0", NULL},
                                              {"n=8", "rising_mass=1e6", "friction=0", NULL},
                                              {"k=6", "friction=0", NULL},
                                              {"rows=4", "columns=3", "friction=0", NULL},
                                              {"rows=5", "columns=2", NULL},
                                              {"angle=0.46", NULL},
                                              {"n=8", "friction=0", NULL},
                                              {"n=8", "friction=0", NULL},
                                              {"slenderness=50", "friction=0", NULL},
                                              {"k=1", "n=8", "friction=0", NULL},
                                              {NULL},
                                              {"n=4", "gap=0.7", "friction=0", NULL}};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        pl_scene scene = scenario_scene(names[i], settings[i]);
        settle(&scene);
        if (!is_in_balance(&scene)) {
            fail_msg("%s (%zu) does not stand", names[i], i);
        }
        pl_scene_free(&scene);
    }
}

/* Shows that the test above can fail. */
static void test_displaced_cube_is_not_in_balance(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=8", "friction=0", NULL};
    pl_scene scene = scenario_scene("tower", settings);
    scene.bodies[5].position[0] += 0.51;
    assert_false(is_in_balance(&scene));
    pl_scene_free(&scene);
}

static void test_towers_of_a_field_are_towers_apart(void **state)
{
    (void)state;
    static const char *const settings[] = {"k=3", "n=4", NULL}, *const one[] = {"n=4", NULL};
    pl_scene field = scenario_scene("multi-tower", settings), tower = scenario_scene("tower", one);
    assert_int_equal(field.body_count, 1 + 9 * 4);
    assert_int_equal(field.rest_count, 9 * 4);
    for (int i = 1; i < field.body_count; ++i) {
        const pl_body *cube = &field.bodies[i], *like = &tower.bodies[1 + (i - 1) % 4];
        assert_close(cube->position[2], like->position[2], 0, 0);
        assert_close(cube->mass, like->mass, 0, 0);
        assert_memory_equal(&cube->shape.half_extents, &like->shape.half_extents,
                            sizeof like->shape.half_extents);
        for (int j = 1; j < i; ++j) {
            const double gap = gap_between(&field, i, j);
            assert_close(gap, (i - 1) / 4 != (j - 1) / 4 ? fmax(gap, 1) : i - j - 1, 1e-15, 0);
        }
    }
    pl_scene_free(&field);
    pl_scene_free(&tower);
}

/* Each cube of a row is centred over the gap between two cubes of the row below. */
static void test_pyramid_rows_lie_over_gaps_below(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=5", "gap=0.3", NULL};
    pl_scene scene = scenario_scene("pyramid", settings);
    assert_int_equal(scene.body_count, 1 + 15);
    int below = 1;
    for (int row = 1, count = 4; count > 0; ++row, --count) {
        for (int i = 0; i < count; ++i) {
            const pl_body *cube = &scene.bodies[below + count + 1 + i];
            const double *left = scene.bodies[below + i].position;
            const double *right = scene.bodies[below + i + 1].position;
            assert_close(cube->position[2], row + 0.5, 0, 0);
            assert_close(cube->position[0] - left[0], 0.65, 1e-15, 0);
            assert_close(right[0] - cube->position[0], 0.65, 1e-15, 0);
        }
        below += count + 1;
    }
    pl_scene_free(&scene);
}

/* The tower far away is the tower at the origin, moved and turned: the offset is the same for all
 * its cubes, the turn is 30 degrees about the vertical, and neighbours touch. */
static void test_the_tower_far_away_is_the_tower_moved(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=6", NULL};
    pl_scene far = scenario_scene("far-from-origin", settings);
    pl_scene step = scenario_scene("large-step", settings),
             tower = scenario_scene("tower", settings);
    for (int i = 1; i < tower.body_count; ++i) {
        const pl_body *cube = &far.bodies[i], *like = &tower.bodies[i];
        assert_close(hypot(cube->position[0], cube->position[1]), 1e4, 0, 1e-15);
        assert_close(atan2(cube->position[1], cube->position[0]), acos(-1) / 6, 1e-15, 0);
        assert_close(2 * atan2(cube->orientation[3], cube->orientation[0]), acos(-1) / 6, 1e-15, 0);
        assert_true(cube->orientation[1] == 0 && cube->orientation[2] == 0);
        assert_close(cube->position[2], like->position[2], 0, 0);
        assert_close(gap_between(&far, i, i - 1), 0, 1e-12, 0);
        assert_memory_equal(step.bodies[i].position, like->position, sizeof like->position);
    }
    assert_close(step.dt, 0.1, 0, 0);
    pl_scene_free(&far);
    pl_scene_free(&step);
    pl_scene_free(&tower);
}

/* Half a million is (slenderness^2 + 1) / 2, by the moments of a solid box. */
static void test_thin_rod_has_its_slenderness_and_falls(void **state)
{
    (void)state;
    static const char *const settings[] = {"slenderness=1000", "drop=0.25", NULL};
    pl_scene scene = scenario_scene("thin-rod", settings);
    const pl_body *rod = &scene.bodies[1];
    assert_close(rod->inertia[2] / rod->inertia[0], 500000.5, 0, 1e-12);
    assert_close(gap_between(&scene, 0, 1), 0.25, 1e-15, 0);
    settle(&scene);
    assert_close(gap_between(&scene, 0, 1), 0, 1e-16, 0);
    pl_scene_free(&scene);
}

/* It neither starts in a side of the gap nor has more room than it is said to have. */
static void test_needle_starts_in_gap_and_reaches_floor(void **state)
{
    (void)state;
    static const char *const settings[][3] = {{"clearance=0.01", "tilt=0.9", NULL},
                                              {"clearance=1", "tilt=0.9", NULL},
                                              {"clearance=1e-4", "tilt=0", NULL}};
    static const double clearances[] = {0.01, 1, 1e-4};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = scenario_scene("needle-in-gap", settings[i]);
        assert_true(gap_between(&scene, 1, 3) > 0 && gap_between(&scene, 2, 3) > 0);
        assert_close(gap_between(&scene, 1, 2), 0.01 * (1 + clearances[i]), 1e-14, 0);
        settle(&scene);
        assert_close(gap_between(&scene, 0, 3), 0, 1e-15, 0);
        assert_close(gap_between(&scene, 1, 3), 0.005 * clearances[i], 1e-14, 0);
        assert_close(gap_between(&scene, 2, 3), 0.005 * clearances[i], 1e-14, 0);
        pl_scene_free(&scene);
    }
}

/* Of a box turned about y. */
static void corner_of(const pl_body *body, int corner, double at[2])
{
    const double *q = body->orientation, *h = body->shape.half_extents;
    const double c = q[0] * q[0] - q[2] * q[2], s = 2 * q[0] * q[2];
    const double x = corner & 1 ? h[0] : -h[0], z = corner & 2 ? h[2] : -h[2];
    at[0] = body->position[0] + c * x + s * z;
    at[1] = body->position[2] - s * x + c * z;
}

/* The level push of its partner, over the card's weight, by moments about the edge it stands on,
 * from where its corners are; and what the reference says of it. */
static void test_card_pair_needs_its_corner_friction(void **state)
{
    (void)state;
    static const char *const settings[][3] = {{"storeys=1", "lean=20", NULL},
                                              {"storeys=1", "lean=45", NULL},
                                              {"storeys=1", "lean=5", NULL}};
    static const double leans[] = {20, 45, 5};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = scenario_scene("card-house", settings[i]);
        const pl_body *card = &scene.bodies[1];
        double foot[2] = {0, HUGE_VAL}, head[2] = {-HUGE_VAL, 0};
        for (int k = 0; k < 4; ++k) {
            double at[2];
            corner_of(card, k, at);
            memcpy(foot, at[1] < foot[1] ? at : foot, sizeof foot);
            memcpy(head, at[0] > head[0] ? at : head, sizeof head);
        }
        const double push = (card->position[0] - foot[0]) / (head[1] - foot[1]);
        const double tangent = tan(leans[i] * acos(-1) / 180);
        assert_close(foot[1], 0, 1e-15, 0);
        assert_close(head[0], 0, 1e-15, 0);
        assert_close(push, (tangent - 0.01 / 0.5) / 2, 1e-14, 0);
        /* The face's normal against the level push. */
        const double *q = card->orientation;
        const double c = q[0] * q[0] - q[2] * q[2], s = 2 * q[0] * q[2];
        assert_close(fabs(s / c), tangent, 0, 1e-14);
        scene.materials[0].friction = push * (1 + 1e-6);
        assert_true(is_in_balance(&scene));
        scene.materials[0].friction = push * (1 - 1e-6);
        assert_false(is_in_balance(&scene));
        pl_scene_free(&scene);
    }
}

/* A block that friction brakes tips, in its own frame, where the same block at rest tips on a slope
 * as steep as friction: d'Alembert. */
static void test_tall_blocks_that_would_tip_are_refused(void **state)
{
    (void)state;
    static const double heights[] = {0.7, 2, 8};
    for (int i = 0; i < 3; ++i) {
        char height[32], friction[48], slenderness[48], angle[48];
        snprintf(height, sizeof height, "height=%.17g", heights[i]);
        snprintf(slenderness, sizeof slenderness, "slenderness=%.17g", 1 / heights[i]);
        double low = 0, high = 80, refused = 10, built = 1e-3;
        while (high - low > 1e-10) {
            const double middle = (low + high) / 2;
            snprintf(angle, sizeof angle, "angle=%.17g", middle);
            const char *const tips[] = {slenderness, angle, "friction=10", NULL};
            pl_scene scene = scenario_scene("slope-tip", tips);
            *(is_in_balance(&scene) ? &low : &high) = middle;
            pl_scene_free(&scene);
        }
        const pl_scenario *s = pl_scenario_find("reaction-split", NULL);
        while (refused - built > 1e-12) {
            const double middle = (refused + built) / 2;
            double values[PL_MAX_PARAMS];
            pl_scene scene;
            snprintf(friction, sizeof friction, "friction=%.17g", middle);
            const char *const slides[] = {height, friction};
            assert_int_equal(pl_scenario_values(s, slides, 2, values, NULL), PL_OK);
            const bool builds = pl_scenario_build(s, values, 0, &scene, NULL) == PL_OK;
            pl_scene_free(&scene);
            *(builds ? &built : &refused) = middle;
        }
        assert_close(built, tan(low * acos(-1) / 180), 0, 1e-7); /* the program's */
    }
}

/* Of an arch without joints' number: weight and moment between the crown and the joint at angle f
 * as integrals over the ring, bounds on the thrust's moment at 20000 joints. */
static double room_of_ring(double thickness, double thrust)
{
    enum { JOINTS = 20000 };
    const double inner = 1 - thickness / 2, outer = 1 + thickness / 2, h = acos(0) / JOINTS;
    double weight = 0, moment = 0, least = -HUGE_VAL, most = HUGE_VAL;
    for (int i = 0; i <= JOINTS; ++i) {
        const double f = i * h, across = thrust * cos(f) + weight * sin(f);
        least = fmax(least, inner * across - moment);
        most = fmin(most, outer * across - moment);
        /* int r dr and int r^2 dr sin f of the slice beyond, at its middle. */
        weight += h * (outer * outer - inner * inner) / 2;
        moment += h * sin(f + h / 2) * (pow(outer, 3) - pow(inner, 3)) / 3;
    }
    return most - least;
}

static double most_room(double thickness)
{
    double low = 0, high = 0.3;
    for (int i = 0; i < 60; ++i) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        const bool rises = room_of_ring(thickness, a) < room_of_ring(thickness, b);
        low = rises ? a : low;
        high = rises ? high : b;
    }
    return room_of_ring(thickness, low);
}

static void test_arch_stands_from_thickness_0_107478(void **state)
{
    (void)state;
    assert_true(most_room(0.107478 + 1e-6) > 0);
    assert_true(most_room(0.107478 - 1e-6) < 0);
    const pl_scenario *arch = pl_scenario_find("arch", NULL);
    assert_contains(arch->reference, "0.107478");
    double values[PL_MAX_PARAMS];
    char limit[32];
    static const char *const counts[] = {"n=5", "n=6", "n=7", "n=10", "n=15", "n=51", "n=200"};
    for (int i = 0; i < 7; ++i) {
        assert_int_equal(pl_scenario_values(arch, &counts[i], 1, values, NULL), PL_OK);
        assert_at_most(arch->threshold->critical(values), 0.107478 + 1e-6);
    }
    assert_int_equal(pl_scenario_values(arch, NULL, 0, values, NULL), PL_OK);
    snprintf(limit, sizeof limit, "%.6f for 20", arch->threshold->critical(values));
    assert_contains(arch->reference, limit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_rests_has_forces_that_hold_it),
        cmocka_unit_test(test_displaced_cube_is_not_in_balance),
        cmocka_unit_test(test_towers_of_a_field_are_towers_apart),
        cmocka_unit_test(test_pyramid_rows_lie_over_gaps_below),
        cmocka_unit_test(test_the_tower_far_away_is_the_tower_moved),
        cmocka_unit_test(test_thin_rod_has_its_slenderness_and_falls),
        cmocka_unit_test(test_needle_starts_in_gap_and_reaches_floor),
        cmocka_unit_test(test_card_pair_needs_its_corner_friction),
        cmocka_unit_test(test_tall_blocks_that_would_tip_are_refused),
        cmocka_unit_test(test_arch_stands_from_thickness_0_107478),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
