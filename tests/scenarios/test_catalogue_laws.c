/* The laws of the catalogue for impacts, rolling, thrust and stuck friction, in addition to the
 * numbers that it expects of an engine, derived by other methods: small systems of equations, sums
 * and quadratures. */
#include "check.h"
#include "scenario_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double g = 9.81; /* m/s^2 */

/* Three equal spheres that touch, of which the first comes at v = 1. All contacts at once: each
 * pushes by an impulse p >= 0, and parts, where it pushes, at what it approached by: Newton's
 * restitution 1. By sweeps over the two contacts. */
static void strike_at_once(double v[3])
{
    const double before[3] = {1, 0, 0};
    double p[2] = {0, 0};
    memcpy(v, before, sizeof before);
    for (int sweep = 0; sweep < 200; ++sweep) {
        for (int c = 0; c < 2; ++c) {
            const double apart = v[c + 1] - v[c] + (before[c + 1] - before[c]);
            const double more = fmax(-p[c], -apart / 2);
            p[c] += more;
            v[c] -= more;
            v[c + 1] += more;
        }
    }
}

/* One contact after the other, by the impulse of two equal masses: they change their speeds. */
static void strike_in_sequence(double v[3])
{
    v[0] = 1, v[1] = v[2] = 0;
    for (int sweep = 0; sweep < 10; ++sweep) {
        for (int c = 0; c < 2; ++c) {
            const double impulse = fmax(0, v[c] - v[c + 1]);
            v[c] -= impulse;
            v[c + 1] += impulse;
        }
    }
}

static void test_cradle_names_results_of_both_impact_laws(void **state)
{
    (void)state;
    const char *reference = pl_scenario_find("cradle", NULL)->reference;
    for (int law = 0; law < 2; ++law) {
        double v[3];
        char text[64];
        (law == 0 ? strike_in_sequence : strike_at_once)(v);
        assert_close(v[0] + v[1] + v[2], 1, 1e-14, 0);
        assert_close(v[0] * v[0] + v[1] * v[1] + v[2] * v[2], 1, 1e-14, 0);
        if (law == 0) {
            snprintf(text, sizeof text, "v (%.0f, %.0f, %.0f) in sequence", v[0], v[1], v[2]);
        } else {
            snprintf(text, sizeof text, "v (%.0f/3, %.0f/3, %.0f/3) all at once", 3 * v[0],
                     3 * v[1], 3 * v[2]);
        }
        assert_contains(reference, text);
    }
}

/* The flights of a ball that bounces, added up: it lies from then on, and not before. */
static void test_bounces_end_when_their_flights_add_up(void **state)
{
    (void)state;
    double end = sqrt(2 / g);
    for (double flight = end; flight > 1e-12;) {
        flight *= 0.5;
        end += 2 * flight;
    }
    assert_close(end, sqrt(2 / g) * 1.5 / 0.5, 0, 1e-10);
    static const double parts[] = {0.97, 1.03};
    for (int i = 0; i < 2; ++i) {
        char duration[48];
        snprintf(duration, sizeof duration, "duration=%.17g", parts[i] * end);
        char dt[48];
        snprintf(dt, sizeof dt, "dt=%.17g", parts[i] * end / 10);
        const char *const settings[] = {"restitution=0.5", duration, dt, NULL};
        pl_scene scene = scenario_scene("bounce", settings);
        assert_int_equal(scene.value_count, 6); /* no way aside, no spin */
        assert_int_equal(scene.values[0].quantity, PL_QUANTITY_POSITION);
        assert_true((scene.values[0].value > -1) == (i == 0));
        assert_close(scene.values[0].value, -1, 0.01, 0);
        pl_scene_free(&scene);
    }
}

static bool rolls(const char *shape, double angle, double friction)
{
    char angle_is[48], friction_is[48];
    snprintf(angle_is, sizeof angle_is, "angle=%.17g", angle);
    snprintf(friction_is, sizeof friction_is, "friction=%.17g", friction);
    const char *const settings[] = {shape, angle_is, friction_is};
    const pl_scenario *s = pl_scenario_find("roll-slope", NULL);
    double values[PL_MAX_PARAMS];
    pl_scene scene;
    assert_int_equal(pl_scenario_values(s, settings, 3, values, NULL), PL_OK);
    const bool builds = pl_scenario_build(s, values, 0, &scene, NULL) == PL_OK;
    pl_scene_free(&scene);
    return builds;
}

/* The slip of a roller of the scene's inertia after one step from rest, when friction gives all it
 * has: none is left where it has enough. */
static double slip_left(const pl_body *body, int axis, double angle, double friction)
{
    const double r = body->shape.radius, most = friction * g * cos(angle);
    const double speed = g * sin(angle) - most,
                 rim = most * body->mass * r * r / body->inertia[axis];
    return speed - rim;
}

static void test_rollers_are_refused_where_they_would_slip(void **state)
{
    (void)state;
    static const char *const shapes[] = {"shape=0", "shape=1"};
    static const double angles[] = {0.1, 0.7, 1.4};
    for (int i = 0; i < 6; ++i) {
        const char *const settings[] = {shapes[i % 2], NULL};
        pl_scene scene = scenario_scene("roll-slope", settings);
        double low = 0, high = 10, slips = 0, sticks = 10;
        while (high - low > 1e-13) {
            const double middle = (low + high) / 2;
            *(rolls(shapes[i % 2], angles[i / 2], middle) ? &high : &low) = middle;
        }
        while (sticks - slips > 1e-13) {
            const double middle = (slips + sticks) / 2;
            const bool slides =
                slip_left(&scene.bodies[1], i % 2 == 0 ? 0 : 2, angles[i / 2], middle) > 0;
            *(slides ? &slips : &sticks) = middle;
        }
        assert_close(high, sticks, 0, 1e-11);
        pl_scene_free(&scene);
    }
    static const char *const level[] = {"angle=0", NULL};
    assert_scenario_refuses("roll-slope", level, "expected an angle above 0");
}

/* A rocket on its axis, step by step. */
static void test_straight_rocket_is_the_sum_of_speeds(void **state)
{
    (void)state;
    static const char *const settings[][3] = {{"thrust=30", NULL},
                                              {"thrust=0", "dt=0.01", NULL},
                                              {"thrust=9", "dt=0.1", NULL},
                                              {"thrust=1e4", "duration=0.5", NULL}};
    static const double thrusts[] = {30, 0, 9, 1e4};
    for (int i = 0; i < 4; ++i) {
        pl_scene scene = scenario_scene("rocket", settings[i]);
        const pl_expect_travel *travel = &scene.travels[0];
        double speed = 0, way = 0, t = (double)pl_scene_steps(&scene) * scene.dt;
        for (long n = pl_scene_steps(&scene); n > 0; --n) {
            speed += (thrusts[i] - g) * scene.dt;
            way += speed * scene.dt;
        }
        assert_close(travel->discrete * travel->direction[2], way, 0, 1e-12);
        assert_close(travel->distance * travel->direction[2], speed * t / 2, 0, 1e-12);
        pl_scene_free(&scene);
    }
}

/* y = (x, z, lean, and their rates). */
static void fly_rate(const void *context, double t, const double *y, double *rate)
{
    (void)t;
    const pl_scene *scene = context;
    const pl_force *f = &scene->forces[0];
    for (int k = 0; k < 3; ++k) {
        rate[k] = y[3 + k];
    }
    rate[3] = f->force[2] * sin(y[2]) / scene->bodies[0].mass;
    rate[4] = f->force[2] * cos(y[2]) / scene->bodies[0].mass - g;
    rate[5] = (f->at[2] * f->force[0] - f->at[0] * f->force[2]) / scene->bodies[0].inertia[1];
}

static void test_a_rocket_that_whirls_is_still_integrated(void **state)
{
    (void)state;
    static const char *const settings[][4] = {{"thrust=1e4", "offset=0.2", "duration=1.3", NULL},
                                              {"thrust=30", "offset=-0.2", "duration=12", NULL}};
    for (int i = 0; i < 2; ++i) {
        pl_scene scene = scenario_scene("rocket", settings[i]);
        const pl_expect_travel *travel = &scene.travels[0];
        double y[6] = {0};
        integrate(fly_rate, &scene, 0, scene.duration, 400000, 6, y);
        assert_true(fabs(y[2]) > 1000);
        assert_close(travel->distance * travel->direction[0], y[0], 0, 1e-8);
        assert_close(travel->distance * travel->direction[2], y[1], 0, 1e-8);
        pl_scene_free(&scene);
    }
}

/* The hardest push that is let: a ball then needs all of its friction, 0.8 of its weight. */
static void test_carried_balls_are_refused_where_they_would_slip(void **state)
{
    (void)state;
    double low = 100, high = 300, force = 0;
    while (high - low > 1e-10) {
        const double middle = (low + high) / 2;
        char push[48];
        snprintf(push, sizeof push, "push=%.17g", middle);
        const char *const settings[] = {"rows=1", "friction=0", "azimuth=0", "duration=0.05", push};
        const pl_scenario *s = pl_scenario_find("carried-balls", NULL);
        double values[PL_MAX_PARAMS];
        pl_scene scene;
        assert_int_equal(pl_scenario_values(s, settings, 5, values, NULL), PL_OK);
        if (pl_scenario_build(s, values, 0, &scene, NULL) == PL_OK) {
            const double t = (double)pl_scene_steps(&scene) * scene.dt;
            const pl_expect_value *way = expected_value(&scene, 2, PL_QUANTITY_POSITION, 0);
            force = scene.bodies[2].mass * way->value * 2 / (t * t);
            low = middle;
        } else {
            high = middle;
        }
        pl_scene_free(&scene);
    }
    assert_close(force, 0.8 * g, 0, 1e-9);
}

/* Of a row four times as large all lengths are fourfold, all speeds twofold, spins half. */
static void test_fourfold_dominoes_start_twice_as_fast(void **state)
{
    (void)state;
    static const char *const small[] = {"n=5", "size=0.5", NULL}, *const large[] = {"n=5", "size=2",
                                                                                    NULL};
    pl_scene a = scenario_scene("dominoes", small), b = scenario_scene("dominoes", large);
    assert_int_equal(a.body_count, 6);
    for (int i = 1; i < 6; ++i) {
        const pl_body *p = &a.bodies[i], *q = &b.bodies[i];
        for (int k = 0; k < 3; ++k) {
            assert_close(q->position[k], 4 * p->position[k], 0, 1e-15);
            assert_close(q->shape.half_extents[k], 4 * p->shape.half_extents[k], 0, 1e-15);
            assert_close(q->velocity[k], 2 * p->velocity[k], 0, 1e-14);
            assert_close(q->angular_velocity[k], p->angular_velocity[k] / 2, 0, 1e-14);
        }
        assert_true((q->velocity[0] > 0) == (i == 1));
    }
    pl_scene_free(&a);
    pl_scene_free(&b);
}

/* Above the critical friction, a force at the lower end of a rod moves that end down. It is found
 * by bisection, from Newton's and Euler's laws for a rod without thickness, and compared with the
 * formula at every angle. */
static double end_acceleration(double angle, double friction)
{
    const double half = 0.5, mass = 1, inertia = mass * half * half / 3;
    const double x = half * cos(angle), z = -half * sin(angle);  /* of the end, from the centre */
    const double force[2] = {-friction, 1};                      /* against the slip along +x; up */
    const double spin = (z * force[0] - x * force[1]) / inertia; /* about y: moves the end by -x */
    return force[1] / mass - spin * x;
}

static void test_rod_jams_above_the_formula_friction(void **state)
{
    (void)state;
    double least = HUGE_VAL;
    for (double degrees = 5; degrees < 86; degrees += 0.5) {
        const double angle = degrees * acos(-1) / 180, c = cos(angle), s = sin(angle);
        double low = 0, high = 100;
        while (high - low > 1e-12) {
            const double middle = (low + high) / 2;
            *(end_acceleration(angle, middle) > 0 ? &low : &high) = middle;
        }
        assert_close(low, (1 + 3 * c * c) / (3 * s * c), 0, 1e-12);
        least = fmin(least, low);
    }
    assert_close(least, 4.0 / 3, 0, 1e-4);
    const pl_scenario *s = pl_scenario_find("painleve", NULL);
    assert_contains(s->reference, "(1 + 3 cos^2) / (3 sin cos) of the angle, at least 4/3");
    double values[PL_MAX_PARAMS];
    assert_int_equal(pl_scenario_values(s, NULL, 0, values, NULL), PL_OK);
    for (int i = 0; i < s->param_count; ++i) {
        if (strcmp(s->params[i].name, "angle") == 0) {
            assert_close(tan(values[i] * acos(-1) / 180), 2, 0, 1e-14);
        }
    }
}

/* Force and torque of friction on an even disc of radius 1 whose centre moves at e times the speed
 * of its rim, over those of its weight; by the midpoint rule in rings and sectors. */
static void disc_friction(double e, double *force, double *torque)
{
    enum { RINGS = 300, SECTORS = 300 };
    *force = *torque = 0;
    for (int i = 0; i < RINGS * SECTORS; ++i) {
        const double r = (i / SECTORS + 0.5) / RINGS;
        const double angle = 2 * acos(-1) * (i % SECTORS + 0.5) / SECTORS;
        const double slip[2] = {e - r * sin(angle), r * cos(angle)};
        const double share = 2 * r / RINGS / SECTORS / hypot(slip[0], slip[1]);
        *force += share * slip[0];
        *torque += share * r * (cos(angle) * slip[1] - sin(angle) * slip[0]);
    }
}

/* The ratio of speed to rim speed stays where both fall at the same rate: F / (m v) = T / (I w),
 * I = m R^2 / 2. */
static void test_sliding_disc_ends_at_published_speed_ratio(void **state)
{
    (void)state;
    double low = 0.3, high = 1;
    while (high - low > 1e-6) {
        const double middle = (low + high) / 2;
        double force, torque;
        disc_friction(middle, &force, &torque);
        *(force / middle > 2 * torque ? &high : &low) = middle;
    }
    assert_close(low, 0.653, 5e-4, 0);
}

/* The area under a speed that falls by `braking` until nothing is left, by trapezia: good to
 * braking h^2. */
static double braked_way(double speed, double braking, double time)
{
    enum { PARTS = 1000000 };
    const double h = time / PARTS;
    double way = 0;
    for (int i = 0; i < PARTS; ++i) {
        const double before = fmax(0, speed - braking * h * i);
        way += h * (before + fmax(0, speed - braking * h * (i + 1))) / 2;
    }
    return way;
}

static void test_braked_distance_is_the_speed_integral(void **state)
{
    (void)state;
    static const char *const names[] = {"slide-to-stop", "slide-to-stop",  "isotropy",
                                        "isotropy",      "reaction-split", "reaction-split"};
    static const char *const settings[][5] = {
        {"speed=5", "friction=0.5", "duration=3", NULL},
        {"speed=7", "friction=0.2", "duration=1", NULL},
        {"speed=4", "friction=1.9", "duration=2", NULL},
        {"speed=9", "friction=0.1", "duration=3", NULL},
        {"speed=5", "friction=0.3", "duration=3", NULL},
        {"speed=8", "friction=1.9", "height=0.5", "duration=0.2", NULL}};
    static const double speeds[] = {5, 7, 4, 9, 5, 8}, frictions[] = {0.5, 0.2, 1.9, 0.1, 0.3, 1.9};
    for (int i = 0; i < 6; ++i) {
        pl_scene scene = scenario_scene(names[i], settings[i]);
        const double way = braked_way(speeds[i], frictions[i] * g, scene.duration);
        for (int k = 0; k < scene.travel_count; ++k) {
            assert_close(scene.travels[k].distance, way, 0, 1e-10);
        }
        for (int k = 0; k < scene.value_count; ++k) {
            if (scene.values[k].quantity == PL_QUANTITY_POSITION &&
                scene.values[k].direction[0] > 0.5) {
                assert_close(scene.values[k].value, way, 0, 1e-10);
            }
        }
        assert_true(scene.travel_count + scene.value_count > 0);
        pl_scene_free(&scene);
    }
    static const char *const shapes[] = {"shape=0", "shape=1"};
    for (int i = 0; i < 2; ++i) {
        const char *const spun[] = {shapes[i], "spin=12", "friction=0.25", "duration=4", NULL};
        pl_scene scene = scenario_scene("spin-stop", spun);
        const pl_expect_value *turn = expected_value(&scene, 1, PL_QUANTITY_TURN, 2);
        const double *half = scene.bodies[1].shape.half_extents;
        const double braking =
            i == 0 ? 3 * 0.25 * g / hypot(half[0], half[1]) : 0.25 * g / (0.75 * 0.5);
        assert_close(turn->value, braked_way(12, braking, 4), 0, 1e-10);
        pl_scene_free(&scene);
    }
}

/* The sum of d d' over the directions d of a body's expected places has the determinant 1 if they
 * are three axes at right angles. A place of rest counts as three axes. */
static double covered(const pl_scene *scene, int body)
{
    double m[3][3] = {{0}};
    for (int i = 0; i < scene->rest_count; ++i) {
        for (int k = 0; k < 3 && scene->rests[i].body == body; ++k) {
            m[k][k] += 1;
        }
    }
    for (int i = 0; i < scene->value_count; ++i) {
        const pl_expect_value *v = &scene->values[i];
        const bool is_place =
            v->quantity == PL_QUANTITY_POSITION || v->quantity == PL_QUANTITY_APEX;
        for (int k = 0; v->body == body && is_place && k < 9; ++k) {
            m[k / 3][k % 3] += v->direction[k / 3] * v->direction[k % 3];
        }
    }
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* So that no engine may let a body drift where the reference does not look. A bound leaves the place
 * open. How far a rocking block
 * has come along x at the end has no closed form. */
static void test_places_are_expected_in_all_directions(void **state)
{
    (void)state;
    int count = 0, judged = 0;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; ++i) {
        pl_scene scene = scenario_scene(scenarios[i]->name, NULL);
        for (int k = 0; k < scene.value_count; ++k) {
            const pl_quantity quantity = scene.values[k].quantity;
            if ((quantity == PL_QUANTITY_POSITION || quantity == PL_QUANTITY_APEX) &&
                scene.values[k].bound == PL_BOUND_EQUAL &&
                strcmp(scene.name, "rocking-block") != 0) {
                assert_true(covered(&scene, scene.values[k].body) > 0.99);
                judged += 1;
            }
        }
        pl_scene_free(&scene);
    }
    assert_true(judged > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_places_are_expected_in_all_directions),
        cmocka_unit_test(test_braked_distance_is_the_speed_integral),
        cmocka_unit_test(test_cradle_names_results_of_both_impact_laws),
        cmocka_unit_test(test_bounces_end_when_their_flights_add_up),
        cmocka_unit_test(test_rollers_are_refused_where_they_would_slip),
        cmocka_unit_test(test_straight_rocket_is_the_sum_of_speeds),
        cmocka_unit_test(test_a_rocket_that_whirls_is_still_integrated),
        cmocka_unit_test(test_carried_balls_are_refused_where_they_would_slip),
        cmocka_unit_test(test_fourfold_dominoes_start_twice_as_fast),
        cmocka_unit_test(test_rod_jams_above_the_formula_friction),
        cmocka_unit_test(test_sliding_disc_ends_at_published_speed_ratio),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
