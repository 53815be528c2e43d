/* When a run counts as diverged or not finite, and when bodies count as meeting: bounds in closed
 * form. */
#include "referee/referee.h"

#include "check.h"
#include "synthetic_run.h"

#include <math.h>
#include <string.h>

static const double G = 9.81;

/* A ball (0) of radius 1 m, 2 kg, and one (1) so heavy that its 1 m/s, or 1 rad/s, is the energy of
 * the scene. */
static void prepare(run *r, double gravity, bool spins)
{
    run_prepare(r, 1);
    r->scene.gravity[2] = -gravity;
    run_add_body(r, "light", pl_shape_sphere(1), false, 0, 5);
    run_add_body(r, "heavy", pl_shape_sphere(1), false, 10, 7);
    pl_body *heavy = &r->scene.bodies[1];
    heavy->mass = 1e8;
    heavy->inertia[0] = heavy->inertia[1] = heavy->inertia[2] = 0.4e8;
    *(spins ? &heavy->angular_velocity[1] : &heavy->velocity[1]) = 1;
    run_begin(r);
}

static pl_ending verdict_at_speed(double gravity, bool spins, double speed, double spin)
{
    run r;
    prepare(&r, gravity, spins);
    r.state[0].velocity[0] = speed;
    r.state[0].angular_velocity[0] = spin;
    pl_ending verdict = run_step(&r);
    if (verdict != PL_ENDING_OK) {
        (void)run_finish(&r);
        assert_contains(r.error.message, "body \"light\" moves at");
    }
    run_end(&r);
    return verdict;
}

/* 100 v + 100 m/s, of the fastest point, and with gravity 100 sqrt(v^2 + 2 g (H + D)) + 100 + g T.
 * The bounding spheres span 12 x 2 x 4 m, and the duration is 1 s. */
static void test_speed_bound_is_a_hundredfold(void **state)
{
    (void)state;
    const double fall = 2 * G * (4 + sqrt(12 * 12 + 2 * 2 + 4 * 4));
    const double bounds[] = {200, 100 * sqrt(1 + fall) + 100 + G};
    for (int k = 0; k < 2; ++k) {
        const double gravity = k == 0 ? 0 : G;
        for (int spins = 0; spins < 2; ++spins) {
            assert_int_equal(verdict_at_speed(gravity, spins, 0.999 * bounds[k], 0), PL_ENDING_OK);
            assert_int_equal(verdict_at_speed(gravity, spins, 1.001 * bounds[k], 0),
                             PL_ENDING_DIVERGED);
            /* The speed of the surface counts. */
            assert_int_equal(verdict_at_speed(gravity, spins, 0.5 * bounds[k], 0.501 * bounds[k]),
                             PL_ENDING_DIVERGED);
        }
    }
}

/* A ball of 2 kg at 1 m/s has 1 J, and in a scene without gravity that is all. */
static pl_ending verdict_at_energy(double joule)
{
    run r;
    run_prepare(&r, 1);
    memset(r.scene.gravity, 0, sizeof r.scene.gravity);
    run_add_body(&r, "ball", pl_shape_sphere(1), false, 0, 0);
    r.scene.bodies[0].velocity[0] = 1;
    run_begin(&r);
    r.state[0].velocity[0] = sqrt(joule);
    pl_ending verdict = run_step(&r);
    run_end(&r);
    return verdict;
}

static void test_ten_times_the_energy_gained_is_divergence(void **state)
{
    (void)state;
    assert_int_equal(verdict_at_energy(1 + 9.9), PL_ENDING_OK);
    assert_int_equal(verdict_at_energy(1 + 10.1), PL_ENDING_DIVERGED);
}

static void test_quaternion_far_from_unit_is_no_rotation(void **state)
{
    (void)state;
    static const double squares[] = {0.49, 0.51, 1.99, 2.01};
    for (int i = 0; i < 4; ++i) {
        run r;
        prepare(&r, 0, false);
        r.state[0].orientation[0] = sqrt(squares[i] / 2);
        r.state[0].orientation[2] = -sqrt(squares[i] / 2);
        bool ok = i == 1 || i == 2;
        assert_int_equal(run_step(&r), ok ? PL_ENDING_OK : PL_ENDING_NONFINITE);
        run_end(&r);
    }
}

static const double SPEED = 1e-3; /* m/s */

/* Two balls of radius 1 m and 3 m, `gap` apart, of which one passes its speed on to the other: by
 * how much an island grows, in units of what was passed on. `spins`: rad/s, of each. */
static double gained(double gap, const double spins[2], int from)
{
    run r;
    run_prepare(&r, 1);
    memset(r.scene.gravity, 0, sizeof r.scene.gravity);
    run_add_body(&r, "small", pl_shape_sphere(1), false, 0, 0);
    run_add_body(&r, "large", pl_shape_sphere(3), false, 4 + gap, 0);
    double energy = SPEED * SPEED; /* of 2 kg */
    for (int i = 0; i < 2; ++i) {
        r.scene.bodies[i].angular_velocity[1] = spins[i];
        energy += 0.5 * r.scene.bodies[i].inertia[1] * spins[i] * spins[i];
    }
    r.scene.bodies[from].velocity[2] = SPEED;
    run_begin(&r);
    run_step_many(&r, 3);
    r.state[from].velocity[2] = 0;
    r.state[!from].velocity[2] = SPEED;
    run_step_many(&r, 61);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    double gain = run_value(&r, PL_METRIC_ENERGY_STEP_GAIN) * energy / (SPEED * SPEED);
    run_end(&r);
    return gain;
}

/* A thousandth of the smaller radius, and as far as the surfaces move in a step. */
static void test_bodies_meet_within_reach_of_a_step(void **state)
{
    (void)state;
    static const double spins[][2] = {{0, 0}, {0.1, 0}, {0, 0.1}, {0.1, 0.2}};
    for (int k = 0; k < 4; ++k) {
        double reach = 1e-3 * 1 + H * (SPEED + 1 * spins[k][0] + 3 * spins[k][1]);
        for (int from = 0; from < 2; ++from) {
            assert_close(gained(0.98 * reach, spins[k], from), 0, 1e-9, 0);
            assert_close(gained(1.02 * reach, spins[k], from), 1, 1e-9, 0);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_speed_bound_is_a_hundredfold),
        cmocka_unit_test(test_ten_times_the_energy_gained_is_divergence),
        cmocka_unit_test(test_quaternion_far_from_unit_is_no_rotation),
        cmocka_unit_test(test_bodies_meet_within_reach_of_a_step),
    };
    return cmocka_run_group_tests_name("referee bounds", tests, NULL, NULL);
}
