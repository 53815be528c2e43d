/* The detected integrator, and the errors against the discrete reference of each integrator, on
 * motions that are computed here by either rule. */
#include "check.h"
#include "synthetic_run.h"

#include <math.h>
#include <string.h>

enum { STEPS = 64 };

/* The velocity that moves the position: the new one, or the mean of old and new. */
typedef enum motion_rule { NEW_VELOCITY, MEAN_VELOCITY } motion_rule;

static const char *const names[] = {"semi-implicit Euler",
                                    "second order, exact for constant force"};

static void move(run *r, int body, motion_rule rule, const double velocity[3])
{
    pl_body_state *s = &r->state[body];
    for (int k = 0; k < 3; ++k) {
        double mean = (s->velocity[k] + velocity[k]) / 2;
        s->position[k] += H * (rule == MEAN_VELOCITY ? mean : velocity[k]);
        s->velocity[k] = velocity[k];
    }
}

static const char *integrator_of(const run *r)
{
    const pl_metric *metric = run_metric(r, PL_METRIC_INTEGRATOR);
    return metric->state == PL_METRIC_TEXT ? metric->text : "";
}

static void assert_no_discrete_error(const run *r, const char *reason)
{
    const pl_metric *metric = run_metric(r, PL_METRIC_DISCRETE_ERROR);
    assert_int_equal(metric->state, PL_METRIC_FAILED);
    assert_contains(metric->reason, reason);
}

/* A ball with an upward velocity, with its references of the continuous problem and of
 * semi-implicit Euler. */
static void prepare_fall(run *r, double speed)
{
    const double g = 9.81, t = STEPS * H;
    run_prepare(r, t);
    run_add_body(r, "ball", pl_shape_sphere(0.5), false, 0, 100);
    r->scene.bodies[0].velocity[2] = speed;
    pl_expect_value height = pl_expect_value_default(&r->scene);
    height.value = speed * t - g * t * t / 2;
    height.discrete = height.value - g * t * H / 2;
    height.scale = 1;
    assert_int_equal(pl_scene_add_value(&r->scene, &height, NULL), PL_OK);
}

/* The ball falls by one rule under gravity `g`, to the end of the run. */
static void fall(run *r, motion_rule rule, double g)
{
    const double speed = r->scene.bodies[0].velocity[2];
    run_begin(r);
    for (int i = 1; i <= STEPS; ++i) {
        const double velocity[3] = {0, 0, speed - g * i * H};
        move(r, 0, rule, velocity);
        run_step_many(r, 1);
    }
    run_finish(r);
}

static void test_each_integrator_is_detected_without_discrete_error(void **state)
{
    (void)state;
    for (motion_rule rule = NEW_VELOCITY; rule <= MEAN_VELOCITY; ++rule) {
        run r;
        prepare_fall(&r, 3);
        fall(&r, rule, 9.81);
        assert_string_equal(integrator_of(&r), names[rule]);
        double stepping = rule == NEW_VELOCITY ? 9.81 * STEPS * H * H / 2 : 0;
        assert_close(run_value(&r, PL_METRIC_VALUE_ERROR), stepping, 1e-12, 0);
        assert_close(run_value(&r, PL_METRIC_DISCRETE_ERROR), 0, 1e-12, 0);
        run_end(&r);
    }
}

/* An impulse slows a block from `speed` to `end` evenly over `time`, in `substeps` of a step. */
static double slowed(double speed, double end, double time, int substeps)
{
    const double k = H / substeps, braking = (speed - end) / time;
    double sum = 0;
    for (int i = 1; i <= STEPS * substeps; ++i) {
        sum += k * (i * k <= time ? speed - braking * i * k : end);
    }
    return sum;
}

/* Uniform motion, braking to rest and slowing down to a known speed, each with sub-steps. */
static void test_substeps_have_discrete_answers(void **state)
{
    (void)state;
    const double speed = 2, ends[] = {0.5, 0, 1}, times[] = {STEPS * H, 0.417, 0.417};
    for (int kind = 0; kind < 3; ++kind) {
        for (int substeps = 1; substeps <= 4; substeps *= 2) {
            const double end = ends[kind], time = times[kind];
            run r;
            run_prepare(&r, STEPS * H);
            run_add_body(&r, "block", pl_shape_box(1, 1, 1), false, 0, 0);
            r.scene.bodies[0].velocity[0] = speed;
            pl_expect_value moved = pl_expect_value_default(&r.scene), velocity = moved;
            moved.direction[0] = velocity.direction[0] = 1;
            moved.direction[2] = velocity.direction[2] = 0;
            moved.value = (speed + end) / 2 * time + end * (STEPS * H - time);
            moved.discrete = slowed(speed, end, time, 1);
            velocity.quantity = PL_QUANTITY_VELOCITY;
            velocity.value = velocity.discrete = end;
            assert_int_equal(pl_scene_add_value(&r.scene, &moved, NULL), PL_OK);
            if (kind == 2) {
                assert_int_equal(pl_scene_add_value(&r.scene, &velocity, NULL), PL_OK);
            }
            r.engine.substeps = substeps;
            run_begin(&r);
            for (int i = 1; i <= STEPS; ++i) {
                for (int part = 1; part <= substeps; ++part) {
                    const double t = ((i - 1) * substeps + part) * H / substeps;
                    const double now = t <= time ? speed - (speed - end) / time * t : end;
                    r.state[0].velocity[0] = now;
                    r.state[0].position[0] += H / substeps * now;
                }
                run_step_many(&r, 1);
            }
            run_finish(&r);
            assert_string_equal(integrator_of(&r), names[NEW_VELOCITY]);
            assert_close(run_value(&r, PL_METRIC_DISCRETE_ERROR), 0, 1e-12, 0);
            assert_true(run_value(&r, PL_METRIC_VALUE_ERROR) > 1e-4);
            run_end(&r);
        }
    }
}

/* Gravity that is too weak by 1 % is no time-stepping error. */
static void test_wrong_force_shows_in_both_errors(void **state)
{
    (void)state;
    for (motion_rule rule = NEW_VELOCITY; rule <= MEAN_VELOCITY; ++rule) {
        run r;
        prepare_fall(&r, 3);
        fall(&r, rule, 0.99 * 9.81);
        double n = STEPS + (rule == NEW_VELOCITY ? 1 : 0);
        assert_string_equal(integrator_of(&r), names[rule]);
        assert_close(run_value(&r, PL_METRIC_DISCRETE_ERROR), 0.0981 * H * H * STEPS * n / 2, 1e-12,
                     0);
        run_end(&r);
    }
}

/* Friction stops a block within a step. The second-order rule has a time-stepping error too. */
static void test_stop_within_a_step_is_a_stepping_error(void **state)
{
    (void)state;
    const double braking = 4.905, speed = 2;
    const double moving = floor(speed / (braking * H));
    const double distance = speed * speed / (2 * braking);
    const double sum = moving * H * speed - braking * H * H * moving * (moving + 1) / 2;
    for (motion_rule rule = NEW_VELOCITY; rule <= MEAN_VELOCITY; ++rule) {
        run r;
        run_prepare(&r, STEPS * H);
        run_add_body(&r, "block", pl_shape_box(1, 1, 1), false, 0, 0);
        r.scene.bodies[0].velocity[0] = speed;
        run_expect_travel(&r, 0, distance, sum);
        run_begin(&r);
        for (int i = 1; i <= STEPS; ++i) {
            const double velocity[3] = {fmax(0, speed - braking * i * H), 0, 0};
            move(&r, 0, rule, velocity);
            run_step_many(&r, 1);
        }
        run_finish(&r);
        assert_true(run_value(&r, PL_METRIC_TRAVEL_ERROR) > 1e-5);
        assert_close(run_value(&r, PL_METRIC_DISCRETE_ERROR), 0, 1e-12, 0);
        run_end(&r);
    }
}

/* A ball that skids and then rolls: the velocity at the end is expected too. */
static void test_expected_velocity_gives_the_second_order_reference(void **state)
{
    (void)state;
    const double braking = 2, speed = 1, skid = 10;
    const double end = speed - braking * skid * H;
    double sums[2] = {0, 0};
    run r;
    run_prepare(&r, STEPS * H);
    run_add_body(&r, "ball", pl_shape_sphere(0.5), false, 0, 0);
    r.scene.bodies[0].velocity[0] = speed;
    double before = speed;
    for (int i = 1; i <= STEPS; ++i) {
        double after = fmax(end, speed - braking * i * H);
        sums[0] += H * after;
        sums[1] += H * (before + after) / 2;
        before = after;
    }
    pl_expect_value moved = pl_expect_value_default(&r.scene), velocity = moved;
    moved.direction[0] = velocity.direction[0] = 1;
    moved.direction[2] = velocity.direction[2] = 0;
    moved.value = 0.9 * sums[1];
    moved.discrete = sums[0];
    velocity.quantity = PL_QUANTITY_VELOCITY;
    velocity.value = velocity.discrete = end;
    assert_int_equal(pl_scene_add_value(&r.scene, &moved, NULL), PL_OK);
    assert_int_equal(pl_scene_add_value(&r.scene, &velocity, NULL), PL_OK);
    run_begin(&r);
    for (int i = 1; i <= STEPS; ++i) {
        const double after[3] = {fmax(end, speed - braking * i * H), 0, 0};
        move(&r, 0, MEAN_VELOCITY, after);
        run_step_many(&r, 1);
    }
    run_finish(&r);
    assert_close(run_value(&r, PL_METRIC_DISCRETE_ERROR), 0, 1e-12, 0);
    run_end(&r);
}

/* The final velocity is neither expected nor determined by the kind of motion. */
static void test_unknown_discrete_reference_is_absent(void **state)
{
    (void)state;
    run r;
    prepare_fall(&r, 3);
    r.scene.values[0].discrete += 0.1;
    fall(&r, MEAN_VELOCITY, 9.81);
    assert_no_discrete_error(&r, "no exact answer of the integrator with 1 sub-step is known");
    run_end(&r);
}

static void test_one_unknown_reference_leaves_no_discrete_error(void **state)
{
    (void)state;
    run r;
    prepare_fall(&r, 0);
    pl_expect_value other = pl_expect_value_default(&r.scene);
    assert_int_equal(pl_scene_add_value(&r.scene, &other, NULL), PL_OK);
    fall(&r, NEW_VELOCITY, 9.81);
    assert_string_equal(integrator_of(&r), names[NEW_VELOCITY]);
    assert_int_equal(run_metric(&r, PL_METRIC_DISCRETE_ERROR)->state, PL_METRIC_ABSENT);
    run_end(&r);
}

/* Both rules move a body without acceleration equally, and also one with an impulse before the
 * flight if there is no gravity. A value that has the same reference by both still has a discrete
 * error. */
static void test_without_acceleration_no_integrator_is_detected(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, STEPS * H);
    run_add_body(&r, "ball", pl_shape_sphere(0.5), false, 0, 0);
    r.scene.bodies[0].velocity[2] = 1;
    r.scene.gravity[2] = 0;
    pl_expect_value velocity = pl_expect_value_default(&r.scene);
    velocity.quantity = PL_QUANTITY_VELOCITY;
    velocity.value = velocity.discrete = -0.5;
    assert_int_equal(pl_scene_add_value(&r.scene, &velocity, NULL), PL_OK);
    run_begin(&r);
    for (int i = 1; i <= STEPS; ++i) {
        const double now[3] = {0, 0, i < 32 ? 1 : -0.25};
        move(&r, 0, NEW_VELOCITY, now);
        run_step_many(&r, 1);
    }
    run_finish(&r);
    assert_int_equal(run_metric(&r, PL_METRIC_INTEGRATOR)->state, PL_METRIC_ABSENT);
    assert_close(run_value(&r, PL_METRIC_DISCRETE_ERROR), 0.25, 1e-12, 0);
    run_end(&r);
}

static void test_alternating_integrators_are_mixed(void **state)
{
    (void)state;
    run r;
    prepare_fall(&r, 3);
    run_begin(&r);
    for (int i = 1; i <= STEPS; ++i) {
        const double velocity[3] = {0, 0, 3 - 9.81 * i * H};
        move(&r, 0, i % 3 == 0 ? MEAN_VELOCITY : NEW_VELOCITY, velocity);
        run_step_many(&r, 1);
    }
    run_finish(&r);
    assert_string_equal(integrator_of(&r), "mixed");
    assert_no_discrete_error(&r, "integrator was not detected");
    run_end(&r);
}

/* The fit is judged to a thousandth of h |v' - v|: a step beyond that is of another integrator. */
static void test_nearly_fitting_steps_are_not_detected(void **state)
{
    (void)state;
    for (motion_rule rule = NEW_VELOCITY; rule <= MEAN_VELOCITY; ++rule) {
        for (int misses = 0; misses < 2; ++misses) {
            run r;
            prepare_fall(&r, 3);
            run_begin(&r);
            for (int i = 1; i <= STEPS; ++i) {
                const double velocity[3] = {0, 0, 3 - 9.81 * i * H};
                move(&r, 0, rule, velocity);
                r.state[0].position[2] += (misses ? 2e-3 : 5e-4) * 9.81 * H * H;
                run_step_many(&r, 1);
            }
            run_finish(&r);
            assert_string_equal(integrator_of(&r), misses ? "" : names[rule]);
            run_end(&r);
        }
    }
}

/* x' = x + h v: neither of the two integrators, even if a few steps fit one by chance. */
static void test_another_integrator_is_not_detected(void **state)
{
    (void)state;
    for (int by_chance = 0; by_chance <= STEPS / 4; by_chance += STEPS / 4) {
        run r;
        prepare_fall(&r, 3);
        run_begin(&r);
        for (int i = 1; i <= STEPS; ++i) {
            const double velocity[3] = {0, 0, 3 - 9.81 * i * H};
            double before = r.state[0].velocity[2];
            move(&r, 0, NEW_VELOCITY, velocity);
            r.state[0].position[2] += i > by_chance ? H * (before - velocity[2]) : 0;
            run_step_many(&r, 1);
        }
        run_finish(&r);
        assert_int_equal(run_metric(&r, PL_METRIC_INTEGRATOR)->state, PL_METRIC_ABSENT);
        assert_no_discrete_error(&r, "integrator was not detected");
        run_end(&r);
    }
}

/* A ball thrown sideways by semi-implicit Euler with four sub-steps: its energy and momentum are kept
 * when the referee knows of them, and the energy is not when it does not. */
static void test_substeps_gain_no_energy(void **state)
{
    (void)state;
    enum { SUBSTEPS = 4 };
    for (int substeps = 1; substeps <= SUBSTEPS; substeps += SUBSTEPS - 1) {
        run r;
        prepare_fall(&r, 3);
        r.scene.bodies[0].velocity[0] = 2;
        r.engine.substeps = substeps;
        run_begin(&r);
        for (int i = 0; i < STEPS; ++i) {
            for (int k = 0; k < SUBSTEPS; ++k) {
                r.state[0].velocity[2] -= 9.81 * H / SUBSTEPS;
                for (int axis = 0; axis < 3; ++axis) {
                    r.state[0].position[axis] += H / SUBSTEPS * r.state[0].velocity[axis];
                }
            }
            run_step_many(&r, 1);
        }
        run_finish(&r);
        if (substeps == SUBSTEPS) {
            assert_string_equal(integrator_of(&r), names[NEW_VELOCITY]);
            assert_close(run_value(&r, PL_METRIC_ENERGY_GAIN), 0, 1e-12, 0);
            assert_close(run_value(&r, PL_METRIC_MOMENTUM_ERROR), 0, 1e-12, 0);
            assert_close(run_value(&r, PL_METRIC_DISCRETE_ERROR), 0, 1e-12, 0);
        } else {
            assert_string_equal(integrator_of(&r), "");
            assert_true(run_value(&r, PL_METRIC_ENERGY_GAIN) > 1e-4);
        }
        run_end(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_integrator_is_detected_without_discrete_error),
        cmocka_unit_test(test_substeps_have_discrete_answers),
        cmocka_unit_test(test_wrong_force_shows_in_both_errors),
        cmocka_unit_test(test_stop_within_a_step_is_a_stepping_error),
        cmocka_unit_test(test_expected_velocity_gives_the_second_order_reference),
        cmocka_unit_test(test_unknown_discrete_reference_is_absent),
        cmocka_unit_test(test_one_unknown_reference_leaves_no_discrete_error),
        cmocka_unit_test(test_without_acceleration_no_integrator_is_detected),
        cmocka_unit_test(test_alternating_integrators_are_mixed),
        cmocka_unit_test(test_nearly_fitting_steps_are_not_detected),
        cmocka_unit_test(test_another_integrator_is_not_detected),
        cmocka_unit_test(test_substeps_gain_no_energy),
    };
    return cmocka_run_group_tests_name("referee_integrator", tests, NULL, NULL);
}
