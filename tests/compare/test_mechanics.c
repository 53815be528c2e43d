/* Energy and momentum, against motions integrated here by semi-implicit Euler and by a second-order
 * rule. */
#include "referee/metrics/mechanics.h"

#include "check.h"
#include "polyhedra.h"
#include "synthetic_run.h"

#include <math.h>
#include <string.h>

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; ++k) {
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
}

/* One step of a sphere, whose inertia is isotropic: x' = x + h v' or x' = x + h (v + v')/2. */
static void integrate(run *r, pl_position_rule integrator, int body, const double force[3],
                      const double arm[3])
{
    pl_body_state *s = &r->state[body];
    const pl_body *b = &r->scene.bodies[body];
    double torque[3];
    cross(arm, force, torque);
    for (int k = 0; k < 3; ++k) {
        double change = H * (r->scene.gravity[k] + force[k] / b->mass);
        s->velocity[k] += change;
        s->angular_velocity[k] += H * torque[k] / b->inertia[0];
        s->position[k] += H * (s->velocity[k] - (integrator == PL_SECOND_ORDER ? change / 2 : 0));
    }
}

static void prepare_projectile(run *r)
{
    run_prepare(r, 4);
    run_add_body(r, "ball", pl_shape_sphere(0.5), false, 3, 10);
    pl_body *ball = &r->scene.bodies[0];
    const double velocity[3] = {3, -2, 8}, spin[3] = {1, 5, -2};
    memcpy(ball->velocity, velocity, sizeof velocity);
    memcpy(ball->angular_velocity, spin, sizeof spin);
}

/* Moves the only body for 256 steps under a force over part of the time. The metric does not show
 * losses, so the signed energy is checked at each step too. */
static void fly_by(run *r, pl_position_rule integrator, const double force[3], const double arm[3],
                   double from, double until)
{
    const double none[3] = {0, 0, 0};
    pl_scale scale = pl_scale_of(&r->scene);
    pl_arena arena = {0};
    pl_mechanics *mechanics = pl_mechanics_create(&r->scene, &arena);
    assert_non_null(mechanics);
    run_begin(r);
    pl_mechanics_start(mechanics, r->state);
    for (int k = 0; k < 256; ++k) {
        const pl_body_state before = r->state[0];
        integrate(r, integrator, 0, k * H >= from && k * H < until ? force : none, arm);
        run_step_many(r, 1);
        pl_mechanics_step(mechanics,
                          &(pl_step){.number = k + 1, .before = &before, .after = r->state});
        assert_int_equal(pl_integrator_of(pl_mechanics_votes(mechanics)), integrator);
        assert_close(pl_mechanics_energy_gain(mechanics, &scale, integrator), 0, 1e-13, 0);
    }
    pl_arena_free(&arena);
    assert_int_equal(run_finish(r), PL_ENDING_OK);
    assert_close(run_value(r, PL_METRIC_ENERGY_GAIN), 0, 1e-13, 0);
    assert_close(run_value(r, PL_METRIC_ENERGY_STEP_GAIN), 0, 1e-14, 0);
    assert_close(run_value(r, PL_METRIC_MOMENTUM_ERROR), 0, 1e-13, 0);
    run_end(r);
}

/* The same body, as it was prepared, by either integrator. */
static void fly(void (*prepare)(run *r), const double force[3], const double arm[3], double from,
                double until)
{
    for (pl_position_rule k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        run r;
        prepare(&r);
        fly_by(&r, k, force, arm, from, until);
    }
}

static const pl_force world_push = {
    .body = 0, .force = {5, 7, -3}, .at = {0.1, -0.3, 0.2}, .from = 0.5, .until = 2};

static void prepare_pushed(run *r)
{
    prepare_projectile(r);
    assert_int_equal(pl_scene_add_force(&r->scene, &world_push, NULL), PL_OK);
}

/* A quarter turn about z takes the body's x to the world's y. The arm is along the force, so that
 * the constant orientation of these motions is consistent with the spin. */
static void prepare_turned(run *r)
{
    const double quarter[4] = {0.70710678118654752, 0, 0, 0.70710678118654752};
    const pl_force push = {.body = 0,
                           .force = {6, 0, 0},
                           .at = {0.25, 0, 0},
                           .frame = PL_FRAME_BODY,
                           .until = HUGE_VAL};
    prepare_projectile(r);
    memcpy(r->scene.bodies[0].orientation, quarter, sizeof quarter);
    assert_int_equal(pl_scene_add_force(&r->scene, &push, NULL), PL_OK);
}

static void test_projectile_conserves_energy_and_momentum_to_rounding(void **state)
{
    (void)state;
    const double none[3] = {0, 0, 0};
    fly(prepare_projectile, none, none, 0, 0);
}

static void test_scene_forces_are_accounted_to_rounding(void **state)
{
    (void)state;
    fly(prepare_pushed, world_push.force, world_push.at, world_push.from, world_push.until);
}

static void test_body_frame_force_turns_with_the_body(void **state)
{
    (void)state;
    const double force[3] = {0, 6, 0}, arm[3] = {0, 0.25, 0};
    fly(prepare_turned, force, arm, 0, 4);
}

/* A box whose vertices lie off its frame's origin flies up and spins about a principal axis. Its
 * centre moves like a point and the frame rotates around it, which must not change energy, momentum
 * or the detected integrator. */
static void fly_off_frame(pl_position_rule rule)
{
    const double half[3] = {0.5, 0.3, 0.1}, middle[3] = {2, -1, 0.5}, none[3] = {0, 0, 0};
    const double throw_up[3] = {1, 2, 9};
    run r;
    run_prepare(&r, 4);
    run_add_body(&r, "box", pl_shape_of(box_mesh(&r.scene, half, middle, 1)), false, 3, 10);
    memcpy(r.scene.bodies[0].velocity, throw_up, sizeof throw_up);
    r.scene.bodies[0].angular_velocity[2] = 7;
    run_begin(&r);
    pl_arena arena = {0};
    pl_mechanics *mechanics = pl_mechanics_create(&r.scene, &arena);
    assert_non_null(mechanics);
    pl_scale scale = pl_scale_of(&r.scene);
    pl_mechanics_start(mechanics, r.state);
    pl_body_state *s = &r.state[0];
    double centre[3] = {3 + middle[0], middle[1], 10 + middle[2]};
    for (int k = 0; k < 256; ++k) {
        const pl_body_state before = r.state[0];
        double angle = 7 * H * (k + 1);
        memcpy(s->position, centre, sizeof centre);
        integrate(&r, rule, 0, none, none);
        memcpy(centre, s->position, sizeof centre);
        s->orientation[0] = cos(angle / 2);
        s->orientation[3] = sin(angle / 2);
        s->position[0] -= middle[0] * cos(angle) - middle[1] * sin(angle);
        s->position[1] -= middle[0] * sin(angle) + middle[1] * cos(angle);
        s->position[2] -= middle[2];
        run_step_many(&r, 1);
        pl_mechanics_step(mechanics,
                          &(pl_step){.number = k + 1, .before = &before, .after = r.state});
        assert_int_equal(pl_integrator_of(pl_mechanics_votes(mechanics)), rule);
        assert_close(pl_mechanics_energy_gain(mechanics, &scale, rule), 0, 1e-13, 0);
    }
    pl_arena_free(&arena);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_ENERGY_GAIN), 0, 1e-13, 0);
    assert_close(run_value(&r, PL_METRIC_MOMENTUM_ERROR), 0, 1e-13, 0);
    run_end(&r);
}

static void test_body_off_its_frame_conserves_energy_and_momentum(void **state)
{
    (void)state;
    for (pl_position_rule rule = 0; rule < PL_POSITION_RULE_COUNT; ++rule) {
        fly_off_frame(rule);
    }
}

/* The second-order rule that applies an impulse before the flight: v + J/m moves x too. */
static void test_impulse_before_the_flight_shows_second_order(void **state)
{
    (void)state;
    pl_integrator_votes votes = {.flying = {0}};
    run r;
    prepare_projectile(&r);
    run_begin(&r);
    pl_body_state before = r.state[0];
    for (int k = 0; k < 3; ++k) {
        pl_body_state *s = &r.state[0];
        s->velocity[k] += (k + 1) + H * r.scene.gravity[k];
        s->position[k] += H * (s->velocity[k] - H * r.scene.gravity[k] / 2);
    }
    pl_integrator_see(&votes, &r.scene, &before, &r.state[0], &(pl_vec){0, 0, 0});
    assert_int_equal(votes.pushed[PL_SECOND_ORDER], 1);
    assert_int_equal(votes.pushed[PL_SEMI_IMPLICIT], 0);
    run_end(&r);
}

/* A step that fits neither rule, as when a body is pushed out of another, does not count. */
static void test_pushed_body_does_not_show_the_integrator(void **state)
{
    (void)state;
    const double none[3] = {0, 0, 0};
    pl_integrator_votes votes = {.flying = {0}};
    run r;
    prepare_projectile(&r);
    run_begin(&r);
    for (int k = 0; k < 10; ++k) {
        pl_body_state before = r.state[0];
        integrate(&r, PL_SEMI_IMPLICIT, 0, none, none);
        r.state[0].position[2] += 1e-4;
        pl_integrator_see(&votes, &r.scene, &before, &r.state[0], &(pl_vec){0, 0, 0});
    }
    for (pl_position_rule k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        assert_true(votes.flying[k] == 0 && votes.pushed[k] == 0);
    }
    /* One step in free flight outweighs many other steps. */
    votes.pushed[PL_SEMI_IMPLICIT] = 100;
    pl_body_state before = r.state[0];
    integrate(&r, PL_SECOND_ORDER, 0, none, none);
    pl_integrator_see(&votes, &r.scene, &before, &r.state[0], &(pl_vec){0, 0, 0});
    assert_int_equal(pl_integrator_of(&votes), PL_SECOND_ORDER);
    run_end(&r);
}

/* An engine of second order may move colliding bodies by their new velocities. Free flight decides
 * if there is any. */
static void test_few_second_order_steps_show_the_integrator(void **state)
{
    (void)state;
    pl_integrator_votes votes = {.pushed = {[PL_SEMI_IMPLICIT] = 1000, [PL_SECOND_ORDER] = 2}};
    assert_int_equal(pl_integrator_of(&votes), PL_SECOND_ORDER);
    assert_int_equal(pl_integrator_certain(&votes), PL_INTEGRATOR_MIXED);
    votes.pushed[PL_SECOND_ORDER] = 1;
    assert_int_equal(pl_integrator_of(&votes), PL_SEMI_IMPLICIT);
    votes = (pl_integrator_votes){.flying = {[PL_SEMI_IMPLICIT] = 1}, .pushed = {2, 1000}};
    assert_int_equal(pl_integrator_of(&votes), PL_SEMI_IMPLICIT);
}

/* A ball of 2 kg without gravity gains 1 m/s without a cause at step 10 and loses it at step 20. */
static void test_spontaneous_velocity_shows_in_energy_and_momentum(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    memset(r.scene.gravity, 0, sizeof r.scene.gravity);
    run_add_body(&r, "ball", pl_shape_sphere(0.5), false, 0, 0);
    r.scene.bodies[0].velocity[0] = 1;
    run_begin(&r);
    for (int k = 1; k <= 64; ++k) {
        r.state[0].velocity[0] = k >= 10 && k < 20 ? 2 : 1;
        run_step_many(&r, 1);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    /* E: 1 J -> 4 J; p: 2 -> 4 kg m/s. */
    assert_close(run_value(&r, PL_METRIC_ENERGY_GAIN), 3, 1e-14, 0);
    assert_close(run_value(&r, PL_METRIC_MOMENTUM_ERROR), 1, 1e-14, 0);
    assert_int_equal(run_metric(&r, PL_METRIC_ENERGY_GAIN)->worst_step, 10);
    assert_int_equal(run_metric(&r, PL_METRIC_MOMENTUM_ERROR)->worst_step, 10);
    run_end(&r);
}

static void test_lost_energy_is_no_gain(void **state)
{
    (void)state;
    run r;
    prepare_projectile(&r);
    run_begin(&r);
    memset(r.state[0].velocity, 0, sizeof r.state[0].velocity);
    run_step_many(&r, 256);
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_close(run_value(&r, PL_METRIC_ENERGY_GAIN), 0, 0, 0);
    run_end(&r);
}

/* The floor supports a box with exactly m g h a step. Either body may come first in the contact. */
static void test_contact_impulses_of_static_bodies_balance_the_weight(void **state)
{
    (void)state;
    for (int order = 0; order < 2; ++order) {
        for (int wrong = 0; wrong < 2; ++wrong) {
            run r;
            run_prepare_box_on_floor(&r, 1);
            r.scene.bodies[1].position[0] = 7;
            run_begin(&r);
            double up = 2 * 9.81 * H * (order == 0 ? 1 : -1) * (wrong != 0 ? 0.5 : 1);
            const pl_contact contact = {
                .body_a = order, .body_b = 1 - order, .point = {7, 0, 0}, .impulse = {0, 0, up}};
            for (int k = 0; k < 64; ++k) {
                assert_int_equal(run_step_with(&r, &contact, 1), PL_ENDING_OK);
            }
            assert_int_equal(run_finish(&r), PL_ENDING_OK);
            /* p_ref is M g T, so half the support leaves half of it unexplained. */
            assert_close(run_value(&r, PL_METRIC_MOMENTUM_ERROR), wrong != 0 ? 0.5 : 0, 1e-13, 0);
            run_end(&r);
        }
    }
}

/* A ball that spins on the floor is slowed by a torque about the vertical, which its contact reports.
 * Either body may come first in the contact; a torque that is not reported is unexplained. */
static void test_contact_torques_of_static_bodies_slow_a_spin(void **state)
{
    (void)state;
    for (int order = 0; order < 2; ++order) {
        for (int silent = 0; silent < 2; ++silent) {
            run r;
            run_prepare(&r, 1);
            run_add_body(&r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
            run_add_body(&r, "ball", pl_shape_sphere(0.5), false, 7, 0.5);
            r.scene.bodies[1].angular_velocity[2] = 64;
            run_begin(&r);
            const double sign = order == 0 ? 1 : -1, inertia = r.scene.bodies[1].inertia[2];
            const pl_contact contact = {.body_a = order,
                                        .body_b = 1 - order,
                                        .point = {7, 0, 0},
                                        .impulse = {0, 0, sign * 2 * 9.81 * H},
                                        .torque = {0, 0, silent != 0 ? 0 : -sign * inertia}};
            for (int k = 0; k < 64; ++k) {
                r.state[1].angular_velocity[2] -= 1;
                assert_int_equal(run_step_with(&r, &contact, 1), PL_ENDING_OK);
            }
            assert_int_equal(run_finish(&r), PL_ENDING_OK);
            const double error = run_value(&r, PL_METRIC_MOMENTUM_ERROR);
            assert_true(silent != 0 ? error > 1e-2 : error < 1e-13);
            run_end(&r);
        }
    }
}

static void test_nan_impulse_fails_the_momentum_error(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    run_begin(&r);
    const pl_contact contact = {.body_a = 0, .body_b = 1, .impulse = {nan(""), 0, 0}};
    for (int k = 0; k < 64; ++k) {
        assert_int_equal(run_step_with(&r, &contact, 1), PL_ENDING_OK);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    assert_int_equal(run_metric(&r, PL_METRIC_MOMENTUM_ERROR)->state, PL_METRIC_FAILED);
    assert_contains(run_metric(&r, PL_METRIC_MOMENTUM_ERROR)->reason, "not finite at step 1");
    run_end(&r);
}

static void test_long_fall_is_no_divergence(void **state)
{
    (void)state;
    const double none[3] = {0, 0, 0};
    run r;
    run_prepare(&r, 600);
    run_add_body(&r, "ball", pl_shape_sphere(0.01), false, 0, 0);
    run_begin(&r);
    for (int k = 0; k < 600 * 64; ++k) {
        integrate(&r, PL_SEMI_IMPLICIT, 0, none, none);
        run_step_many(&r, 1);
    }
    assert_int_equal(run_finish(&r), PL_ENDING_OK);
    run_end(&r);
}

/* The exact flight of a ball under a force that is fixed in its frame, along z and at arm x: it
 * turns about y as w0 t + a t^2 / 2. The midpoint rule in a thousand parts of the step. */
static void turn_and_push(run *r, double thrust, double arm)
{
    enum { PARTS = 1000 };
    pl_body_state *s = &r->state[0];
    const pl_body *b = &r->scene.bodies[0];
    double h = H / PARTS, alpha = -arm * thrust / b->inertia[1];
    double angle = 2 * atan2(s->orientation[2], s->orientation[0]);
    for (int i = 0; i < PARTS; ++i) {
        double middle = angle + h * s->angular_velocity[1] / 2 + h * h * alpha / 8;
        const double change[3] = {h * thrust * sin(middle) / b->mass, 0,
                                  h * (thrust * cos(middle) / b->mass + r->scene.gravity[2])};
        for (int k = 0; k < 3; ++k) {
            s->position[k] += h * (s->velocity[k] + change[k] / 2);
            s->velocity[k] += change[k];
        }
        angle += h * s->angular_velocity[1] + h * h * alpha / 2;
        s->angular_velocity[1] += h * alpha;
    }
    s->orientation[0] = cos(angle / 2);
    s->orientation[2] = sin(angle / 2);
}

static void test_turning_force_is_integrated_over_the_step(void **state)
{
    (void)state;
    static const double thrust = 50, arm = 0.1; /* N, m */
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "rocket", pl_shape_sphere(0.5), false, 3, 10);
    const pl_force force = {.force = {0, 0, thrust},
                            .at = {arm, 0, -0.3},
                            .frame = PL_FRAME_BODY,
                            .until = (double)INFINITY};
    assert_int_equal(pl_scene_add_force(&r.scene, &force, NULL), PL_OK);
    pl_scale scale = pl_scale_of(&r.scene);
    pl_arena arena = {0};
    pl_mechanics *mechanics = pl_mechanics_create(&r.scene, &arena);
    run_begin(&r);
    pl_mechanics_start(mechanics, r.state);
    for (int k = 0; k < 60; ++k) {
        const pl_body_state before = r.state[0];
        turn_and_push(&r, thrust, arm);
        pl_mechanics_step(mechanics,
                          &(pl_step){.number = k + 1, .before = &before, .after = r.state});
    }
    /* It turns by up to a third of a radian a step. Simpson's rule is of fourth order; with the
     * force as it began each step a tenth would be missing. */
    assert_close(pl_mechanics_energy_gain(mechanics, &scale, PL_SECOND_ORDER), 0, 1e-5, 0);
    assert_at_most(pl_mechanics_momentum_error(mechanics, &scale, PL_SECOND_ORDER), 1e-6);
    assert_true(pl_mechanics_momentum_error(mechanics, &scale, PL_SEMI_IMPLICIT) > 1e-3);
    const pl_integrator_votes *votes = pl_mechanics_votes(mechanics);
    assert_int_equal(pl_integrator_of(votes), PL_SECOND_ORDER);
    assert_int_equal(pl_integrator_certain(votes), PL_INTEGRATOR_DETECTED);
    pl_arena_free(&arena);
    run_end(&r);
}

/* An impulse at any time of a step stops a flying ball in one direction. The ball's place says when
 * the impulse acted, and so what its arm was. */
static void test_impulse_within_a_step_keeps_angular_momentum(void **state)
{
    (void)state;
    const double speed = 3;
    for (int part = 0; part <= 8; ++part) {
        run r;
        run_prepare(&r, 1);
        memset(r.scene.gravity, 0, sizeof r.scene.gravity);
        run_add_body(&r, "wall", pl_shape_plane(-1, 0, 0, -100), true, 0, 0);
        run_add_body(&r, "ball", pl_shape_sphere(0.5), false, 7, 5);
        r.scene.bodies[1].velocity[0] = r.scene.bodies[1].velocity[2] = speed;
        pl_scale scale = pl_scale_of(&r.scene);
        pl_arena arena = {0};
        pl_mechanics *mechanics = pl_mechanics_create(&r.scene, &arena);
        run_begin(&r);
        pl_mechanics_start(mechanics, r.state);
        const pl_body_state before[2] = {r.state[0], r.state[1]};
        const pl_contact contact = {.body_a = 0,
                                    .body_b = 1,
                                    .point = {7.5, 0, 5},
                                    .impulse = {-r.scene.bodies[1].mass * speed, 0, 0}};
        r.state[1].position[0] += part / 8.0 * H * speed;
        r.state[1].position[2] += H * speed;
        r.state[1].velocity[0] = 0;
        pl_mechanics_step(mechanics, &(pl_step){.number = 1,
                                                .before = before,
                                                .after = r.state,
                                                .contacts = &contact,
                                                .contact_count = 1});
        assert_at_most(pl_mechanics_momentum_error(mechanics, &scale, PL_SECOND_ORDER), 1e-14);
        pl_arena_free(&arena);
        run_end(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_projectile_conserves_energy_and_momentum_to_rounding),
        cmocka_unit_test(test_scene_forces_are_accounted_to_rounding),
        cmocka_unit_test(test_body_frame_force_turns_with_the_body),
        cmocka_unit_test(test_turning_force_is_integrated_over_the_step),
        cmocka_unit_test(test_body_off_its_frame_conserves_energy_and_momentum),
        cmocka_unit_test(test_impulse_before_the_flight_shows_second_order),
        cmocka_unit_test(test_pushed_body_does_not_show_the_integrator),
        cmocka_unit_test(test_few_second_order_steps_show_the_integrator),
        cmocka_unit_test(test_spontaneous_velocity_shows_in_energy_and_momentum),
        cmocka_unit_test(test_lost_energy_is_no_gain),
        cmocka_unit_test(test_contact_impulses_of_static_bodies_balance_the_weight),
        cmocka_unit_test(test_contact_torques_of_static_bodies_slow_a_spin),
        cmocka_unit_test(test_impulse_within_a_step_keeps_angular_momentum),
        cmocka_unit_test(test_nan_impulse_fails_the_momentum_error),
        cmocka_unit_test(test_long_fall_is_no_divergence),
    };
    return cmocka_run_group_tests_name("mechanics", tests, NULL, NULL);
}
