/* The references of the catalogue's smooth motions, by another way than the builders', and how near
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

/* The sum of h v_k. */
static double stepped_height(double speed, double h, long steps)
{
    double height = 0;
    for (long n = 0; n < steps; ++n) {
        speed -= g * h;
        height += h * speed;
    }
    return height;
}

static void test_free_fall_is_the_integral_of_speed(void **state)
{
    (void)state;
    static const char *const settings[][4] = {{"speed=0", "dt=1/60", "duration=2", NULL},
                                              {"speed=7", "dt=0.01", "duration=0.7", NULL},
                                              {"speed=-40", "dt=0.25", "duration=3", NULL}};
    static const double speeds[] = {0, 7, -40};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = scenario_scene("free-fall", settings[i]);
        const pl_expect_value *place = expected_value(&scene, 0, PL_QUANTITY_POSITION, 2);
        const pl_expect_value *speed = expected_value(&scene, 0, PL_QUANTITY_VELOCITY, 2);
        double y[2] = {0, speeds[i]};
        integrate(fall_rate, NULL, 0, scene.duration, 10, 2, y);
        assert_close(place->value, y[0], 1e-13, 1e-13);
        assert_close(place->discrete, stepped_height(speeds[i], scene.dt, pl_scene_steps(&scene)),
                     1e-12, 1e-12);
        assert_close(speed->value, y[1], 1e-13, 1e-13);
        assert_close(speed->discrete, y[1], 1e-12, 1e-12);
        assert_true(place->scale >= fabs(place->value) && speed->scale >= fabs(speed->value));
        pl_scene_free(&scene);
    }
}

static void test_projectile_apex_is_the_highest_dense_point(void **state)
{
    (void)state;
    static const char *const settings[] = {"speed=12", "angle=1.1", "dt=1/50", "duration=3", NULL};
    pl_scene scene = scenario_scene("projectile", settings);
    const double rise = 12 * sin(1.1);
    double y[2] = {0, rise}, highest = 0, stepped = 0, speed = rise, low = 0, high = 0;
    for (int n = 0; n < 30000; ++n) {
        integrate(fall_rate, NULL, 0, 1e-4, 1, 2, y);
        highest = fmax(highest, y[0]);
    }
    assert_close(expected_value(&scene, 0, PL_QUANTITY_POSITION, 0)->value, 36 * cos(1.1), 0,
                 1e-14);
    assert_close(expected_value(&scene, 0, PL_QUANTITY_POSITION, 2)->value, y[0], 1e-9, 0);
    const pl_expect_value *apex = expected_value(&scene, 0, PL_QUANTITY_APEX, 2);
    assert_close(apex->value, highest, 2e-8, 0);
    /* The discrete heights lie on a parabola, whose top is at most g h^2 / 8 above the highest. */
    for (int n = 0; n < 150; ++n) {
        speed -= g * scene.dt;
        stepped += scene.dt * speed;
        low = fmax(low, stepped);
    }
    high = low + g * scene.dt * scene.dt / 8;
    assert_true(low <= apex->discrete && apex->discrete <= high);
    pl_scene_free(&scene);
    static const char *const flat[] = {"angle=0", NULL};
    scene = scenario_scene("projectile", flat);
    assert_int_equal(scene.value_count, 6); /* the place, no spin, and no apex */
    pl_scene_free(&scene);
}

/* Step by step by Coulomb's law: the friction of a step is what stops the slip, if it can. Returns
 * the way; *speed and *rim are r w. */
static double skid(double friction, double h, double steps, double *speed, double *rim)
{
    double way = 0;
    for (double n = 0; n < steps; ++n) {
        double slip = *speed - *rim, most = friction * g * h;
        double change = fmax(-most, fmin(most, slip / 3.5));
        *speed -= change;
        *rim += 2.5 * change;
        way += h * *speed;
    }
    return way;
}

static void test_bowling_is_the_limit_of_small_steps(void **state)
{
    (void)state;
    static const char *const settings[][5] = {
        {"speed=5", "spin=0", "friction=0.2", "duration=2", NULL},
        {"speed=2", "spin=-60", "friction=0.4", "duration=1.5", NULL},
        {"speed=1", "spin=50", "friction=0.3", "duration=2", NULL},
        {"speed=8", "spin=0", "friction=0.05", "duration=1", NULL}};
    static const double speeds[] = {5, 2, 1, 8}, spins[] = {0, -60, 50, 0};
    for (int i = 0; i < 4; ++i) {
        pl_scene scene = scenario_scene("bowling", settings[i]);
        const double friction = scene.materials[0].friction;
        const pl_expect_value *way = expected_value(&scene, 1, PL_QUANTITY_POSITION, 0);
        double v = speeds[i], rim = 0.1 * spins[i];
        assert_close(way->discrete,
                     skid(friction, scene.dt, (double)pl_scene_steps(&scene), &v, &rim), 1e-12, 0);
        v = speeds[i], rim = 0.1 * spins[i];
        assert_close(way->value, skid(friction, 1e-6, scene.duration * 1e6, &v, &rim), 0, 1e-5);
        assert_close(expected_value(&scene, 1, PL_QUANTITY_VELOCITY, 0)->value, v, 1e-8, 0);
        assert_close(expected_value(&scene, 1, PL_QUANTITY_SPIN, 1)->value, rim / 0.1, 1e-7, 0);
        pl_scene_free(&scene);
    }
}

static void test_bowling_skids_by_the_textbook_formula(void **state)
{
    (void)state;
    /* At the default, friction 0.2 and 5 m/s: t_s = 2 v / (7 mu g), d_s = 12 v^2 / (49 mu g). */
    const double time = 10 / (7 * 0.2 * g), distance = 300 / (49 * 0.2 * g);
    pl_scene scene = scenario_scene("bowling", NULL);
    const pl_expect_value *way = expected_value(&scene, 1, PL_QUANTITY_POSITION, 0);
    assert_close(way->value, distance + 25.0 / 7 * (2 - time), 0, 1e-14);
    assert_close(way->scale, way->value, 0, 0);
    pl_scene_free(&scene);
}

/* Euler's equations; the context is the principal inertia. */
static void euler_rate(const void *context, double t, const double *w, double *rate)
{
    (void)t;
    const double *i = context;
    rate[0] = (i[1] - i[2]) * w[1] * w[2] / i[0];
    rate[1] = (i[2] - i[0]) * w[2] * w[0] / i[1];
    rate[2] = (i[0] - i[1]) * w[0] * w[1] / i[2];
}

static void test_free_box_returns_after_its_period(void **state)
{
    (void)state;
    static const char *const settings[][4] = {{"wobble_x=0.1", "wobble_z=0.1", "spin=5", NULL},
                                              {"wobble_x=0.5", "wobble_z=0.01", "spin=3", NULL},
                                              {"wobble_x=0.02", "wobble_z=0.3", "spin=4", NULL},
                                              {"wobble_x=0", "wobble_z=0.4", "spin=4", NULL}};
    for (int i = 0; i < 4; ++i) {
        pl_scene scene = scenario_scene("torque-free", settings[i]);
        const pl_body *box = &scene.bodies[0];
        const double period = expected_value(&scene, 0, PL_QUANTITY_PERIOD, 1)->value;
        double w[3];
        memcpy(w, box->angular_velocity, sizeof w);
        integrate(euler_rate, box->inertia, 0, period / 2, 20000, 3, w);
        assert_close(w[1], -box->angular_velocity[1], 1e-10, 0);
        integrate(euler_rate, box->inertia, 0, period / 2, 20000, 3, w);
        for (int k = 0; k < 3; ++k) {
            assert_close(w[k], box->angular_velocity[k], 1e-9, 0);
        }
        assert_close(box->inertia[0], 10 * (0.16 + 0.81) / 12, 0, 1e-15);
        assert_true(i > 0 || fabs(period - 6.056844) < 5e-7);
        pl_scene_free(&scene);
    }
    static const char *const still[] = {"wobble_x=0", "wobble_z=0", NULL};
    assert_scenario_refuses("torque-free", still, "expected a wobble");
}

static void test_isotropic_blocks_travel_as_slide_to_stop(void **state)
{
    (void)state;
    static const char *const settings[] = {"speed=30", "friction=0.1", "duration=40", NULL};
    pl_scene all = scenario_scene("isotropy", settings);
    pl_scene one = scenario_scene("slide-to-stop", settings);
    assert_int_equal(all.travel_count, 19);
    for (int i = 0; i < 19; ++i) {
        const pl_expect_travel *travel = &all.travels[i];
        const double *d = travel->direction, angle = i * 5 * atan(1) / 45;
        assert_close(travel->distance, one.travels[0].distance, 0, 1e-15);
        assert_close(travel->discrete, one.travels[0].discrete, 0, 1e-15);
        assert_close(d[0], cos(angle), 3e-16, 0);
        assert_close(d[1], sin(angle), 3e-16, 0);
        /* Neighbours drift apart at every time. */
        const pl_body *body = &all.bodies[travel->body];
        for (int j = 0; j < i; ++j) {
            const pl_body *other = &all.bodies[all.travels[j].body];
            double along = 0;
            for (int k = 0; k < 2; ++k) {
                along += (body->position[k] - other->position[k]) *
                         (body->velocity[k] - other->velocity[k]);
            }
            assert_true(along >= 0);
            assert_true(hypot(body->position[0] - other->position[0],
                              body->position[1] - other->position[1]) > 4.9);
        }
    }
    pl_scene_free(&all);
    pl_scene_free(&one);
}

/* Newton's and Euler's laws of the box and one of its balls, with the condition of no slip, as a
 * linear system in (a_box, a_ball, angular acceleration times r, f2). */
static void test_carried_balls_solve_the_equations_of_motion(void **state)
{
    (void)state;
    static const char *const settings[][5] = {
        {"rows=3", "push=50", "friction=0.1", "azimuth=30", NULL},
        {"rows=1", "push=20", "friction=0", "azimuth=0", NULL},
        {"rows=5", "push=100", "friction=0.2", "azimuth=90", NULL}};
    static const double counts[] = {9, 1, 25}, pushes[] = {50, 20, 100},
                        frictions[] = {0.1, 0, 0.2};
    for (int i = 0; i < 3; ++i) {
        pl_scene scene = scenario_scene("carried-balls", settings[i]);
        const double braking = frictions[i] * (10 + counts[i]) * g;
        assert_int_equal(scene.body_count, 2 + (int)counts[i]);
        /* Bisect the acceleration of the box: the force that it leaves for the balls, against the
         * one that they ask for. A ball: f = m b, 2/5 m r^2 w' = f r, b + r w' = a. */
        double low = 0, high = pushes[i] / 10;
        for (int k = 0; k < 200; ++k) {
            const double a = (low + high) / 2, b = a / (1 + 1 / 0.4);
            const double left = pushes[i] - braking - 10 * a;
            *(left > counts[i] * b ? &low : &high) = a;
        }
        const double *push = scene.forces[0].force;
        assert_close(hypot(push[0], push[1]), pushes[i], 0, 1e-14);
        assert_int_equal(scene.value_count, 6 + 4 * (int)counts[i]);
        for (int v = 0; v < scene.value_count; ++v) {
            const pl_expect_value *value = &scene.values[v];
            const double a = low * (value->body == 1 ? 1 : 2.0 / 7);
            const double along = value->direction[0] * push[0] + value->direction[1] * push[1];
            const bool is_place = value->quantity == PL_QUANTITY_POSITION;
            if (value->quantity == PL_QUANTITY_TURN || (is_place && along < 1)) {
                assert_close(value->value, 0, 0, 0);
            } else if (is_place) {
                assert_close(value->value, a / 2, 0, 1e-13);
                assert_close(value->discrete, a / 2 * (1 + 1.0 / 60), 0, 1e-13);
            } else {
                /* Backwards: the point of contact gains on the centre. */
                assert_close(value->value, -(low - a) / 0.1, 0, 1e-13);
                assert_close(value->direction[0] * push[0] + value->direction[1] * push[1], 0,
                             1e-13, 0);
                assert_true(push[0] * value->direction[1] - push[1] * value->direction[0] > 0);
            }
        }
        pl_scene_free(&scene);
    }
    static const char *const weak[] = {"push=10", NULL}, *const strong[] = {"push=300", NULL};
    assert_scenario_refuses("carried-balls", weak, "more than the floor's friction");
    assert_scenario_refuses("carried-balls", strong, "stay on the box");
}

static void test_tall_blocks_slide_until_they_would_tip(void **state)
{
    (void)state;
    static const char *const settings[] = {"height=2", "friction=0.49", "duration=2", NULL};
    pl_scene scene = scenario_scene("reaction-split", settings);
    const pl_expect_value *way = expected_value(&scene, 1, PL_QUANTITY_POSITION, 0);
    assert_close(way->value, 25 / (2 * 0.49 * g), 0, 1e-14);
    double discrete = 0, speed = 5;
    for (long n = pl_scene_steps(&scene); n > 0; --n) {
        speed = fmax(0, speed - 0.49 * g * scene.dt);
        discrete += scene.dt * speed;
    }
    assert_close(way->discrete, discrete, 1e-12, 0);
    assert_close(expected_value(&scene, 1, PL_QUANTITY_VELOCITY, 0)->value, 0, 0, 0);
    assert_close(expected_value(&scene, 1, PL_QUANTITY_TURN, 1)->value, 0, 0, 0);
    pl_scene_free(&scene);
    static const char *const tips[] = {"height=2", "friction=0.5", NULL};
    assert_scenario_refuses("reaction-split", tips, "expected a friction below");
}

/* The moment of friction over contact points that share the weight, each against its own slip. */
static double corner_moment(const pl_body *box, double friction)
{
    double moment = 0;
    for (int corner = 0; corner < 4; ++corner) {
        const double x = (corner % 2 == 0 ? 1 : -1) * box->shape.half_extents[0];
        const double y = (corner < 2 ? 1 : -1) * box->shape.half_extents[1];
        const double speed = hypot(x, y);
        moment += friction * box->mass * g / 4 * (x * x + y * y) / speed;
    }
    return moment;
}

/* Midpoint quadrature of mu p r over a disc that presses evenly. */
static double disc_moment(const pl_body *disc, double friction)
{
    const double radius = disc->shape.radius;
    double moment = 0;
    for (int ring = 0; ring < 20000; ++ring) {
        const double r = radius * (ring + 0.5) / 20000;
        moment += friction * disc->mass * g * 2 * r * r / (radius * radius) * radius / 20000;
    }
    return moment;
}

static void test_spin_stops_by_the_friction_moment(void **state)
{
    (void)state;
    static const char *const settings[][4] = {{"shape=0", "friction=0.3", "duration=5", NULL},
                                              {"shape=1", "friction=0.4", "duration=5", NULL}};
    for (int i = 0; i < 2; ++i) {
        pl_scene scene = scenario_scene("spin-stop", settings[i]);
        const pl_body *body = &scene.bodies[1];
        const double friction = scene.materials[0].friction;
        const double moment = i == 0 ? corner_moment(body, friction) : disc_moment(body, friction);
        const double braking = moment / body->inertia[2];
        const pl_expect_value *turn = expected_value(&scene, 1, PL_QUANTITY_TURN, 2);
        assert_close(turn->value, 100 / (2 * braking), 0, 1e-8);
        double discrete = 0, spin = 10;
        for (long n = pl_scene_steps(&scene); n > 0; --n) {
            spin = fmax(0, spin - braking * scene.dt);
            discrete += scene.dt * spin;
        }
        assert_close(turn->discrete, discrete, 0, 1e-8);
        assert_close(expected_value(&scene, 1, PL_QUANTITY_SPIN, 2)->value, 0, 0, 0);
        pl_scene_free(&scene);
    }
}

static void test_accurate_meets_smooth_motion_to_a_ten_thousandth(void **state)
{
    (void)state;
    static const char *const names[] = {"free-fall",     "projectile",     "bowling",
                                        "carried-balls", "reaction-split", "spin-stop"};
    for (int i = 0; i < 6; ++i) {
        assert_at_most(accurate_metric(names[i], NULL, "1/240", "value_error"), 1e-4);
    }
    assert_at_most(accurate_metric("isotropy", NULL, "1/240", "travel_error"), 1e-4);
}

static void test_accurate_profile_conserves_free_box_momentum(void **state)
{
    (void)state;
    assert_at_most(accurate_metric("torque-free", NULL, "1/240", "momentum_error"), 1e-9);
    assert_at_most(accurate_metric("torque-free", NULL, "1/240", "value_error"), 1e-7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_free_fall_is_the_integral_of_speed),
        cmocka_unit_test(test_projectile_apex_is_the_highest_dense_point),
        cmocka_unit_test(test_bowling_is_the_limit_of_small_steps),
        cmocka_unit_test(test_bowling_skids_by_the_textbook_formula),
        cmocka_unit_test(test_free_box_returns_after_its_period),
        cmocka_unit_test(test_isotropic_blocks_travel_as_slide_to_stop),
        cmocka_unit_test(test_carried_balls_solve_the_equations_of_motion),
        cmocka_unit_test(test_tall_blocks_slide_until_they_would_tip),
        cmocka_unit_test(test_spin_stops_by_the_friction_moment),
        cmocka_unit_test(test_accurate_meets_smooth_motion_to_a_ten_thousandth),
        cmocka_unit_test(test_accurate_profile_conserves_free_box_momentum),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
