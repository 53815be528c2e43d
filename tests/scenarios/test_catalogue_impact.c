/* The references of the catalogue's impacts, by another way than the builders', and how near
 * plumb:accurate comes to them. */
#include "check.h"
#include "scenario_scene.h"

#include <math.h>
#include <string.h>

static const double g = 9.81; /* m/s^2 */

/* y = (height, speed). */
static void fall_rate(const void *context, double t, const double *y, double *rate)
{
    (void)context, (void)t;
    rate[0] = y[1];
    rate[1] = -g;
}

/* Bisects the time at which a fall from (height, speed) comes to `level`, and goes there. */
static void fall_to(double level, double *y)
{
    double low = 0, high = 100, begin[2] = {y[0], y[1]};
    for (int i = 0; i < 100; ++i) {
        const double middle = (low + high) / 2;
        memcpy(y, begin, sizeof begin);
        integrate(fall_rate, NULL, 0, middle, 4, 2, y);
        *(y[0] > level ? &low : &high) = middle;
    }
}

static void test_bounce_heights_follow_the_reversed_speed(void **state)
{
    (void)state;
    static const char *const settings[][4] = {{"restitution=0.8", "height=1", "bounces=3", NULL},
                                              {"restitution=1", "height=0.2", "bounces=5", NULL},
                                              {"restitution=0.3", "height=5", "bounces=2", NULL}};
    static const double restitutions[] = {0.8, 1, 0.3}, heights[] = {1, 0.2, 5};
    static const int bounces[] = {3, 5, 2};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = scenario_scene("bounce", settings[i]);
        assert_int_equal(scene.value_count, bounces[i] + 5); /* no way aside, no spin */
        double y[2] = {heights[i], 0}, time = sqrt(2 * heights[i] / g);
        for (int k = 0; k < bounces[i]; ++k) {
            const pl_expect_value *apex = &scene.values[k];
            fall_to(0, y);
            y[0] = 0;
            y[1] *= -restitutions[i];
            const double rise = y[1] / g; /* the time */
            integrate(fall_rate, NULL, 0, rise, 4, 2, y);
            assert_int_equal(apex->quantity, PL_QUANTITY_APEX);
            assert_close(apex->value, y[0] - heights[i], 1e-10, 0);
            assert_close(apex->scale, y[0], 0, 1e-9);
            assert_close(apex->from, time + rise / 2, 1e-9, 0);
            assert_close(apex->until, time + rise * 3 / 2, 1e-9, 0);
            time += 2 * rise;
        }
        pl_scene_free(&scene);
    }
}

static void test_unfinished_flight_expects_the_final_height(void **state)
{
    (void)state;
    static const char *const settings[][4] = {{"restitution=0.8", "duration=0.4", NULL},
                                              {"restitution=0.5", "duration=0.5", "dt=0.01", NULL},
                                              {"restitution=0.5", "duration=1", "dt=0.1", NULL},
                                              {"restitution=0", "duration=2", NULL}};
    static const double restitutions[] = {0.8, 0.5, 0.5, 0};
    for (int i = 0; i < 4; ++i) {
        pl_scene scene = scenario_scene("bounce", settings[i]);
        assert_int_equal(scene.value_count, 6);
        double y[2] = {1, 0}, left = scene.values[0].until, flight = sqrt(2 / g);
        while (flight > 0 && left > flight) {
            integrate(fall_rate, NULL, 0, flight, 4, 2, y);
            left -= flight;
            y[0] = 0;
            y[1] *= -restitutions[i];
            flight = 2 * y[1] / g;
        }
        integrate(fall_rate, NULL, 0, flight > 0 ? left : 0, 4, 2, y);
        assert_close(scene.values[0].value, y[0] - 1, 1e-12, 0);
        pl_scene_free(&scene);
    }
}

/* The centres of two neighbours are never nearer than their radii and gap, whatever the difference
 * of their heights, and each has the apexes of a ball that is alone. */
static void test_balls_in_a_row_bounce_like_single_ones(void **state)
{
    (void)state;
    static const char *const row[] = {"n=4", "gap=0.01", "stagger=0.25", "restitution=0.7", NULL};
    static const char *const heights[] = {"height=1", "height=1.25", "height=1.5", "height=1.75"};
    pl_scene scene = scenario_scene("bounce-row", row);
    int next = 0;
    for (int i = 0; i < 4; ++i) {
        const char *const settings[] = {heights[i], "restitution=0.7", NULL};
        pl_scene single = scenario_scene("bounce", settings);
        for (int k = 0; k < single.value_count; ++k, ++next) {
            const pl_expect_value *value = &scene.values[next], *alone = &single.values[k];
            assert_int_equal(value->body, i + 1);
            assert_int_equal(value->quantity, alone->quantity);
            assert_memory_equal(value->direction, alone->direction, sizeof alone->direction);
            assert_close(value->value, alone->value, 0, 0);
            assert_close(value->from, alone->from, 0, 0);
            assert_close(value->until, alone->until, 0, 0);
        }
        const pl_body *ball = &scene.bodies[i + 1];
        assert_close(ball->position[2] - ball->shape.radius, 1 + 0.25 * i, 0, 0);
        assert_close(ball->position[0], i * 0.26, 1e-15, 0);
        pl_scene_free(&single);
    }
    assert_int_equal(scene.value_count, next);
    pl_scene_free(&scene);
}

/* Routh's way: the normal impulse grows by little, and with it friction against the slip of the
 * moment, never by more than stops it. v, rim (r w) and up, in m/s, of a sphere of 1 kg. */
static void strike(double friction, double e, double *v, double *rim, double *up)
{
    enum { PARTS = 100000 };
    const double part = -*up * (1 + e) / PARTS;
    for (int i = 0; i < PARTS; ++i) {
        const double most = friction * part, need = (*v - *rim) / 3.5;
        const double impulse = fmax(-most, fmin(most, need));
        *v -= impulse;
        *rim += 2.5 * impulse;
        *up += part;
    }
}

static void test_oblique_impacts_equal_incremental_impulses(void **state)
{
    (void)state;
    static const char *const frictions[] = {"friction=0", "friction=0.05", "friction=0.1",
                                            "friction=0.6"};
    /* At 17.8 and 17.4 the friction 0.1 just stops the slip, and just does not, for e = 0.5. */
    static const char *const spins[] = {"spin=-80",  "spin=0",   "spin=35",
                                        "spin=17.8", "spin=200", "spin=17.4"};
    static const char *const restitutions[] = {"restitution=0", "restitution=0.5", "restitution=1"};
    int sticks = 0, slides = 0;
    for (int i = 0; i < 4 * 6 * 3; ++i) {
        const char *settings[] = {frictions[i % 4], spins[i / 4 % 6], restitutions[i / 24], NULL};
        pl_scene scene = scenario_scene("oblique-impact", settings);
        const pl_body *ball = &scene.bodies[1];
        double v = ball->velocity[0], up = ball->velocity[2];
        double rim = ball->shape.radius * ball->angular_velocity[1];
        strike(scene.materials[0].friction, scene.materials[0].restitution, &v, &rim, &up);
        assert_close(expected_value(&scene, 1, PL_QUANTITY_VELOCITY, 0)->value, v, 1e-9, 0);
        assert_close(expected_value(&scene, 1, PL_QUANTITY_VELOCITY, 2)->value, up, 1e-9, 0);
        assert_close(expected_value(&scene, 1, PL_QUANTITY_SPIN, 1)->value, rim / 0.1, 1e-8, 0);
        sticks += fabs(v - rim) < 1e-9;
        slides += fabs(v - rim) > 1e-3;
        pl_scene_free(&scene);
    }
    assert_true(sticks > 10 && slides > 10);
    static const char *const missed[] = {"duration=0.1", NULL};
    pl_scene scene = scenario_scene("oblique-impact", missed);
    assert_close(expected_value(&scene, 1, PL_QUANTITY_VELOCITY, 2)->value,
                 scene.bodies[1].velocity[2], 0, 0);
    pl_scene_free(&scene);
}

/* The train in small steps of time: pairs that overlap and approach get the impulse of their
 * reduced mass. */
static void march(const pl_scene *scene, double e, double *speed)
{
    double place[10], h = 1e-5;
    for (int i = 0; i < scene->body_count; ++i) {
        place[i] = scene->bodies[i].position[0];
        speed[i] = scene->bodies[i].velocity[0];
    }
    for (long n = lround(scene->duration / h); n > 0; --n) {
        for (int i = 0; i < scene->body_count; ++i) {
            place[i] += h * speed[i];
        }
        for (int i = 0; i + 1 < scene->body_count; ++i) {
            const double approach = speed[i] - speed[i + 1];
            if (place[i + 1] - place[i] < 0.2 && approach > 0) {
                const double a = scene->bodies[i].mass, b = scene->bodies[i + 1].mass;
                const double impulse = (1 + e) * approach * a * b / (a + b);
                speed[i] -= impulse / a;
                speed[i + 1] += impulse / b;
            }
        }
    }
}

static void test_collision_trains_equal_small_time_steps(void **state)
{
    (void)state;
    static const char *const settings[][5] = {
        {"n=4", "ratio=2", "restitution=0.8", "duration=2", NULL},
        {"n=2", "ratio=0.1", "restitution=1", "duration=1", NULL},
        {"n=5", "ratio=1", "restitution=1", "duration=1", NULL},
        {"n=3", "ratio=0.5", "restitution=0.9", "duration=3", NULL},
        {"n=4", "ratio=1", "restitution=0", "duration=3", NULL},
        {"n=3", "ratio=5", "restitution=0.5", "duration=6", NULL},
        /* Here the first catches up again with what it has pushed off. */
        {"n=3", "ratio=0.5", "restitution=0.1", "duration=6", NULL},
        {"n=5", "ratio=0.7", "restitution=0.3", "duration=8", NULL}};
    static const double restitutions[] = {0.8, 1, 1, 0.9, 0, 0.5, 0.1, 0.3};
    for (int i = 0; i < 8; ++i) {
        pl_scene scene = scenario_scene("collision-train", settings[i]);
        double speed[10], momentum = 0;
        march(&scene, restitutions[i], speed);
        for (int k = 0; k < scene.body_count; ++k) {
            const pl_expect_value *value = expected_value(&scene, k, PL_QUANTITY_VELOCITY, 0);
            assert_close(value->value, speed[k], 1e-9, 0);
            momentum += scene.bodies[k].mass * value->value;
        }
        assert_close(momentum, 3, 1e-13, 0);
        pl_scene_free(&scene);
    }
}

static void test_equal_train_passes_all_momentum(void **state)
{
    (void)state;
    static const char *const equal[] = {"n=6", "ratio=1", "restitution=1", NULL};
    pl_scene scene = scenario_scene("collision-train", equal);
    for (int k = 0; k < 6; ++k) {
        assert_close(scene.values[k].value, k == 5 ? 3 : 0, 1e-15, 0);
    }
    pl_scene_free(&scene);
    static const char *const two[] = {"n=2", "ratio=4", "restitution=0.6", NULL};
    scene = scenario_scene("collision-train", two);
    assert_close(scene.values[0].value, (1 - 0.6 * 4) / 5 * 3, 0, 1e-14);
    assert_close(scene.values[1].value, 1.6 / 5 * 3, 0, 1e-14);
    pl_scene_free(&scene);
}

typedef struct pendulum {
    double alpha, square; /* rad; p^2 */
} pendulum;

/* y = (tilt, its rate). */
static void rock_rate(const void *context, double t, const double *y, double *rate)
{
    (void)t;
    const pendulum *p = context;
    rate[0] = y[1];
    rate[1] = -p->square * sin(p->alpha - y[0]);
}

/* Spin after the impact of the corner at x = width / 2, from the angular momentum about that
 * corner. Before it, the centre turned about the other corner. */
static double spin_left(const pl_body *block, double spin)
{
    const double b = block->shape.half_extents[0], a = block->shape.half_extents[2];
    const double about_centre = block->mass * (a * a + b * b) / 3;
    /* From the corner that held, (b, a) in x and z; spin about y moves the centre by (a, -b) w. */
    const double v[2] = {a * spin, -b * spin};
    /* From the corner that strikes the centre is at (-b, a); y of r x v is z v_x - x v_z. */
    const double momentum = about_centre * spin + block->mass * (a * v[0] + b * v[1]);
    return momentum / (about_centre + block->mass * (a * a + b * b));
}

static void test_rocking_follows_the_pendulum_and_impact_loss(void **state)
{
    (void)state;
    static const char *const settings[][4] = {{"slenderness=4", "tilt=0.6", "duration=5", NULL},
                                              {"slenderness=2", "tilt=0.9", "duration=9", NULL},
                                              {"slenderness=12", "tilt=0.1", "duration=5", NULL},
                                              {"slenderness=20", "tilt=0.95", "duration=20", NULL},
                                              {"slenderness=2", "tilt=0.05", "duration=5", NULL}};
    static const double slendernesses[] = {4, 2, 12, 20, 2}, tilts[] = {0.6, 0.9, 0.1, 0.95, 0.05};
    for (int i = 0; i < 5; ++i) {
        pl_scene scene = scenario_scene("rocking-block", settings[i]);
        const pl_body *block = &scene.bodies[1];
        const double radius = 0.25 * sqrt(1 + slendernesses[i] * slendernesses[i]);
        const pendulum p = {atan(1 / slendernesses[i]), 0.75 * g / radius};
        const pl_expect_value *spin = expected_value(&scene, 1, PL_QUANTITY_SPIN, 1);
        double y[2] = {tilts[i] * p.alpha, 0};
        assert_close(2 * acos(block->orientation[0]), y[0], 1e-12, 0);
        assert_close(block->position[2], radius * cos(p.alpha - y[0]), 1e-14, 0);
        integrate(rock_rate, &p, 0, spin->until, 20000, 2, y);
        assert_close(spin->value, y[1], 0, 1e-10);
        /* Integrates on to the impact, which is where the search for the apex begins. */
        const pl_expect_value *apex = expected_value(&scene, 1, PL_QUANTITY_APEX, 2);
        integrate(rock_rate, &p, spin->until, apex->from, 20000, 2, y);
        assert_close(y[0], 0, 1e-10, 0);
        /* The mirror image, after the impact, until it stops. */
        double after[2] = {0, -spin_left(block, y[1])}, time = apex->from;
        while (after[1] > 0) {
            integrate(rock_rate, &p, 0, 1e-4, 1, 2, after);
            time += 1e-4;
        }
        const double height = radius * cos(p.alpha - after[0]) - block->position[2];
        assert_close(apex->value, height, 1e-7, 0);
        assert_true(apex->from < time && time < apex->until);
        pl_scene_free(&scene);
    }
}

static void test_slender_blocks_fall_in_housners_time(void **state)
{
    (void)state;
    static const char *const settings[] = {"slenderness=20", "tilt=0.5", "duration=10", NULL};
    pl_scene scene = scenario_scene("rocking-block", settings);
    const double radius = 0.25 * sqrt(401), p = sqrt(0.75 * g / radius);
    assert_close(expected_value(&scene, 1, PL_QUANTITY_APEX, 2)->from, acosh(2) / p, 0, 1e-3);
    pl_scene_free(&scene);
}

static void test_cradle_spheres_touch_and_are_hit(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=5", "moving=3", NULL};
    pl_scene scene = scenario_scene("cradle", settings);
    assert_int_equal(scene.body_count, 8);
    for (int i = 1; i < 8; ++i) {
        const double distance = scene.bodies[i].position[0] - scene.bodies[i - 1].position[0];
        assert_close(distance, i == 3 ? 0.45 : 0.2, 1e-15, 0);
        assert_close(scene.bodies[i].velocity[0], i < 3 ? 1 : 0, 0, 0);
    }
    assert_true(0.25 / 1 < scene.duration);
    pl_scene_free(&scene);
}

/* The expected velocities of one law, along the row; returns how many there are. */
static int speeds_of(const pl_scene *scene, int answer, double *speed)
{
    int count = 0;
    for (int i = 0; i < scene->value_count; ++i) {
        if (scene->values[i].answer == answer) {
            assert_int_equal(scene->values[i].body, count);
            speed[count++] = scene->values[i].value;
        }
    }
    return count;
}

static void test_both_laws_of_the_cradle_keep_momentum_and_energy(void **state)
{
    (void)state;
    static const char *const settings[][3] = {{NULL}, {"n=4", NULL}, {"n=3", "moving=2", NULL}};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = scenario_scene("cradle", settings[i]);
        for (int law = 1; law <= 2; ++law) {
            double speed[8], momentum = 0, energy = 0;
            assert_int_equal(speeds_of(&scene, law, speed), scene.body_count);
            for (int k = 0; k < scene.body_count; ++k) {
                momentum += speed[k] - scene.bodies[k].velocity[0];
                energy +=
                    speed[k] * speed[k] - scene.bodies[k].velocity[0] * scene.bodies[k].velocity[0];
                assert_true(k == 0 || speed[k - 1] <= speed[k] + 1e-15);
            }
            assert_close(momentum, 0, 1e-14, 0);
            assert_close(energy, 0, 1e-14, 0);
            assert_close(speed[scene.body_count - 1], law == 1 ? 1 : speed[scene.body_count - 2],
                         1e-15, 0);
        }
        pl_scene_free(&scene);
    }
}

/* Restitution e between the spheres that meet, 0 within the two groups. */
static void test_cradle_groups_part_by_newtons_restitution(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=3", "moving=2", "restitution=0.5", "speed=3", NULL};
    pl_scene scene = scenario_scene("cradle", settings);
    double speed[8];
    assert_int_equal(speeds_of(&scene, 2, speed), 5);
    assert_close(speed[2] - speed[1], 0.5 * 3, 1e-14, 0);
    assert_close(speed[1] - speed[0], 0, 0, 0);
    assert_close(speed[4] - speed[2], 0, 0, 0);
    pl_scene_free(&scene);
}

/* With gaps the impacts come one after the other, and nothing else is right. */
static void test_cradle_with_gaps_equals_small_time_steps(void **state)
{
    (void)state;
    static const char *const settings[][6] = {
        {"gap=0.05", NULL},
        {"gap=0.02", "n=3", "moving=2", "restitution=0.6", NULL},
        {"gap=0.1", "n=4", "moving=1", "restitution=0.9", "duration=2", NULL}};
    static const double restitutions[] = {1, 0.6, 0.9};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = scenario_scene("cradle", settings[i]);
        double speed[10], expected[10];
        march(&scene, restitutions[i], speed);
        assert_int_equal(speeds_of(&scene, 1, expected) + speeds_of(&scene, 2, expected), 0);
        for (int k = 0; k < scene.body_count; ++k) {
            assert_close(scene.values[k].value, speed[k], 1e-9, 0);
        }
        pl_scene_free(&scene);
    }
    static const char *const endless[] = {"gap=0.01", "n=20", "restitution=0.1", "duration=100",
                                          NULL};
    assert_scenario_refuses("cradle", endless, "expected fewer than");
}

/* At the expected pose the end is where it was, and by the energy since the impulse, which keeps
 * the angular momentum about the end, the time to get there is the expected one. */
static void test_painleve_rod_turns_about_its_end(void **state)
{
    (void)state;
    enum { PARTS = 20000 };
    static const char *const settings[][3] = {
        {NULL}, {"speed=1.5", NULL}, {"angle=55", "friction=3", NULL}};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = scenario_scene("painleve", settings[i]);
        const pl_body *rod = &scene.bodies[1];
        const double *q = rod->orientation, *h = rod->shape.half_extents;
        const double c = q[0] * q[0] - q[2] * q[2], s = 2 * q[0] * q[2];
        const double end[2] = {c * h[0] - s * h[2], -s * h[0] - c * h[2]};
        const double square = end[0] * end[0] + end[1] * end[1];
        const pl_expect_value *turn = expected_value(&scene, 1, PL_QUANTITY_TURN, 1);
        const double inertia = rod->inertia[1] + rod->mass * square;
        const double first = -rod->mass * rod->velocity[0] * end[1] / inertia;
        double time = 0;
        for (int k = 0; k < PARTS; ++k) {
            const double t = turn->value * (k + 0.5) / PARTS;
            const double rise = -(cos(t) * end[1] - sin(t) * end[0]) + end[1];
            time += turn->value / PARTS / sqrt(first * first - 2 * rod->mass * g * rise / inertia);
        }
        assert_close(time, turn->until, 1e-6, 0);
        const double t = turn->value;
        const double x = expected_value(&scene, 1, PL_QUANTITY_POSITION, 0)->value;
        const double z = expected_value(&scene, 1, PL_QUANTITY_POSITION, 2)->value;
        assert_close(x + cos(t) * end[0] + sin(t) * end[1], end[0], 1e-12, 0);
        assert_close(z - sin(t) * end[0] + cos(t) * end[1], end[1], 1e-12, 0);
        pl_scene_free(&scene);
    }
}

static void test_painleve_below_its_friction_is_not_judged(void **state)
{
    (void)state;
    static const char *const settings[] = {"friction=1.3", NULL};
    pl_scene scene = scenario_scene("painleve", settings);
    assert_int_equal(scene.value_count, 0);
    assert_true(isinf(scene.acceptance));
    pl_scene_free(&scene);
}

static void test_accurate_meets_collision_trains_of_any_masses(void **state)
{
    (void)state;
    static const char *const settings[][4] = {{NULL},
                                              {"ratio=0.1", NULL},
                                              {"ratio=10", "n=3", "restitution=0.5", NULL},
                                              {"restitution=0", NULL},
                                              {"restitution=1", "ratio=1", "n=10", NULL}};
    for (int i = 0; i < 5; ++i) {
        assert_at_most(accurate_metric("collision-train", settings[i], "1/240", "value_error"),
                       1e-3);
    }
}

static void test_accurate_keeps_momentum_and_energy_through_a_cradle(void **state)
{
    (void)state;
    static const char *const settings[][3] = {{NULL}, {"n=4", NULL}, {"n=3", "moving=2", NULL}};
    for (int i = 0; i < 3; ++i) {
        assert_at_most(accurate_metric("cradle", settings[i], "1/240", "momentum_error"), 1e-9);
        assert_at_most(fabs(accurate_metric("cradle", settings[i], "1/240", "energy_lost")), 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bounce_heights_follow_the_reversed_speed),
        cmocka_unit_test(test_unfinished_flight_expects_the_final_height),
        cmocka_unit_test(test_balls_in_a_row_bounce_like_single_ones),
        cmocka_unit_test(test_oblique_impacts_equal_incremental_impulses),
        cmocka_unit_test(test_collision_trains_equal_small_time_steps),
        cmocka_unit_test(test_equal_train_passes_all_momentum),
        cmocka_unit_test(test_rocking_follows_the_pendulum_and_impact_loss),
        cmocka_unit_test(test_slender_blocks_fall_in_housners_time),
        cmocka_unit_test(test_cradle_spheres_touch_and_are_hit),
        cmocka_unit_test(test_both_laws_of_the_cradle_keep_momentum_and_energy),
        cmocka_unit_test(test_cradle_groups_part_by_newtons_restitution),
        cmocka_unit_test(test_cradle_with_gaps_equals_small_time_steps),
        cmocka_unit_test(test_painleve_rod_turns_about_its_end),
        cmocka_unit_test(test_painleve_below_its_friction_is_not_judged),
        cmocka_unit_test(test_accurate_meets_collision_trains_of_any_masses),
        cmocka_unit_test(test_accurate_keeps_momentum_and_energy_through_a_cradle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
