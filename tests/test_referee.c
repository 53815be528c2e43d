/* The referee against synthetic motions whose metrics are known in closed form. */
#include "referee/referee.h"

#include "referee/broad_phase.h"
#include "referee/gap.h"
#include "referee/mechanics.h"
#include "referee/series.h"

#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double H = 1.0 / 64; /* a step whose multiples are exact */

enum { MOST_BODIES = 8 };

/* A run in the making: the scene, its referee, and the frame that the test moves. */
typedef struct run {
    pl_scene scene;
    pl_referee *referee;
    pl_body_state state[MOST_BODIES];
    pl_step_stats stats;
    pl_metrics metrics;
    pl_error error;
} run;

static void add_body(run *r, const char *name, pl_shape shape, bool is_static, double x, double z)
{
    pl_body body = pl_body_default();
    (void)snprintf(body.name, sizeof body.name, "%s", name);
    body.is_static = is_static;
    body.shape = shape;
    body.mass = 2;
    body.position[0] = x;
    body.position[2] = z;
    assert_int_equal(pl_scene_add_body(&r->scene, &body, NULL, NULL), PL_OK);
}

static void prepare(run *r, double duration)
{
    memset(r, 0, sizeof *r);
    r->scene = pl_scene_default();
    r->scene.dt = H;
    r->scene.duration = duration;
    r->stats.iterations = r->stats.residual = r->stats.contacts = nan("");
}

static void expect_rest(run *r, int body)
{
    pl_expect_rest rest = {.body = body, .orientation = {1, 0, 0, 0}, .has_orientation = true};
    memcpy(rest.position, r->scene.bodies[body].position, sizeof rest.position);
    assert_int_equal(pl_scene_add_rest(&r->scene, &rest, NULL), PL_OK);
}

static void expect_travel(run *r, int body, double distance, double discrete)
{
    pl_expect_travel travel = {
        .body = body, .direction = {1, 0, 0}, .distance = distance, .discrete = discrete};
    assert_int_equal(pl_scene_add_travel(&r->scene, &travel, NULL), PL_OK);
}

static pl_frame frame_of(run *r)
{
    return (pl_frame){.body_count = r->scene.body_count, .bodies = r->state};
}

static void begin(run *r)
{
    for (int i = 0; i < r->scene.body_count; ++i) {
        const pl_body *body = &r->scene.bodies[i];
        memcpy(r->state[i].position, body->position, sizeof body->position);
        memcpy(r->state[i].orientation, body->orientation, sizeof body->orientation);
        memcpy(r->state[i].velocity, body->velocity, sizeof body->velocity);
        memcpy(r->state[i].angular_velocity, body->angular_velocity, sizeof body->angular_velocity);
    }
    assert_int_equal(pl_referee_create(&r->scene, &r->referee, &r->error), PL_OK);
    pl_frame frame = frame_of(r);
    assert_int_equal(pl_referee_start(r->referee, &frame), PL_VERDICT_OK);
}

static pl_verdict step_with(run *r, const pl_contact *contacts, int count)
{
    pl_frame frame = frame_of(r);
    return pl_referee_step(r->referee, &frame, &r->stats, contacts, count, 1e-3, &r->error);
}

static pl_verdict step(run *r)
{
    return step_with(r, NULL, -1);
}

static void step_many(run *r, long count)
{
    for (long i = 0; i < count; ++i) {
        assert_int_equal(step(r), PL_VERDICT_OK);
    }
}

static pl_verdict finish(run *r)
{
    return pl_referee_finish(r->referee, "m/s", &r->metrics, &r->error);
}

static void end(run *r)
{
    pl_referee_destroy(r->referee);
    pl_scene_free(&r->scene);
}

static const pl_metric *metric(const run *r, pl_metric_id id)
{
    return &r->metrics.item[id];
}

static double value(const run *r, pl_metric_id id)
{
    const pl_metric *m = metric(r, id);
    if (m->state != PL_METRIC_VALUE) {
        print_error("%s has no value: %s\n", pl_metric_table[id].name, m->reason);
        fail();
    }
    return m->value;
}

static void prepare_box_on_floor(run *r, double duration)
{
    prepare(r, duration);
    add_body(r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    add_body(r, "box", pl_shape_box(0.5, 0.5, 0.5), false, 0, 0.5);
    expect_rest(r, 1);
    (void)snprintf(r->scene.primary_error, sizeof r->scene.primary_error, "rest_position_error");
}

static void test_every_metric_has_a_name_a_unit_and_a_definition(void **state)
{
    (void)state;
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        const pl_metric_info *info = &pl_metric_table[i];
        assert_non_null(info->name);
        assert_true(strlen(info->unit) > 0 && strlen(info->definition) > 0);
        assert_int_equal(pl_metric_by_name(info->name), i);
        bool measured_by_clock = i == PL_METRIC_TIME_PER_STEP || i == PL_METRIC_MEMORY_PEAK;
        assert_int_equal(info->deterministic, !measured_by_clock);
    }
    assert_int_equal(pl_metric_by_name("penetration"), -1);
    assert_int_equal(pl_metric_by_name(""), -1);
}

static void test_a_body_at_rest_in_its_reference_has_no_error(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 2);
    begin(&r);
    step_many(&r, 128);
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    const pl_metric_id zero[] = {
        PL_METRIC_REFERENCE_ERROR, PL_METRIC_REST_POSITION_ERROR, PL_METRIC_REST_ROTATION_ERROR,
        PL_METRIC_PENETRATION_MAX, PL_METRIC_PENETRATION_REST,    PL_METRIC_DRIFT,
        PL_METRIC_CREEP,           PL_METRIC_ENERGY_GAIN,         PL_METRIC_SETTLE_TIME};
    for (size_t i = 0; i < sizeof zero / sizeof zero[0]; ++i) {
        assert_close(value(&r, zero[i]), 0, 0, 0);
    }
    assert_string_equal(metric(&r, PL_METRIC_REFERENCE_ERROR)->unit, "m");
    assert_int_equal(metric(&r, PL_METRIC_TRAVEL_ERROR)->state, PL_METRIC_ABSENT);
    assert_int_equal(metric(&r, PL_METRIC_DISCRETE_ERROR)->state, PL_METRIC_ABSENT);
    assert_int_equal(metric(&r, PL_METRIC_MEMORY_PEAK)->state, PL_METRIC_ABSENT);
    /* It stands on a static body, and nothing is known of the force. */
    assert_int_equal(metric(&r, PL_METRIC_MOMENTUM_ERROR)->state, PL_METRIC_FAILED);
    assert_contains(metric(&r, PL_METRIC_MOMENTUM_ERROR)->reason, "no contacts");
    end(&r);
}

static void test_final_pose_errors_are_the_distance_and_the_angle(void **state)
{
    (void)state;
    run r;
    for (int sign = -1; sign <= 1; sign += 2) {
        prepare_box_on_floor(&r, 1);
        begin(&r);
        step_many(&r, 63);
        double angle = 1e-9;
        r.state[1].position[0] += 3e-3;
        r.state[1].position[1] -= 4e-3;
        /* q and -q are the same orientation. */
        r.state[1].orientation[0] = sign * cos(angle / 2);
        r.state[1].orientation[2] = sign * sin(angle / 2);
        step_many(&r, 1);
        assert_int_equal(finish(&r), PL_VERDICT_OK);
        assert_close(value(&r, PL_METRIC_REST_POSITION_ERROR), 5e-3, 0, 1e-12);
        assert_close(value(&r, PL_METRIC_REST_ROTATION_ERROR), angle, 0, 1e-12);
        assert_close(value(&r, PL_METRIC_REFERENCE_ERROR), 5e-3, 0, 1e-12);
        end(&r);
    }
}

static void test_a_sphere_has_no_rotation_error(void **state)
{
    (void)state;
    run r;
    prepare(&r, 1);
    add_body(&r, "ball", pl_shape_sphere(1), false, 0, 0);
    expect_rest(&r, 0);
    begin(&r);
    step_many(&r, 64);
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_int_equal(metric(&r, PL_METRIC_REST_ROTATION_ERROR)->state, PL_METRIC_ABSENT);
    assert_int_equal(metric(&r, PL_METRIC_PENETRATION_MAX)->state, PL_METRIC_ABSENT);
    end(&r);
}

static void test_a_body_beyond_collapse_distance_has_collapsed_and_is_named(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 1);
    r.scene.collapse_distance = 0.25;
    begin(&r);
    r.state[1].position[2] += 0.25;
    step_many(&r, 64);
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    end(&r);

    prepare_box_on_floor(&r, 1);
    r.scene.collapse_distance = 0.25;
    begin(&r);
    r.state[1].position[2] += 0.2500001;
    step_many(&r, 64);
    assert_int_equal(finish(&r), PL_VERDICT_COLLAPSED);
    assert_contains(r.error.message, "\"box\"");
    assert_contains(r.error.message, "0.25 m");
    assert_close(value(&r, PL_METRIC_REST_POSITION_ERROR), 0.2500001, 0, 1e-12);
    end(&r);
}

static void test_travel_errors_are_relative_to_their_own_references(void **state)
{
    (void)state;
    run r;
    prepare(&r, 1);
    add_body(&r, "block", pl_shape_box(1, 1, 1), false, 10, 0);
    expect_travel(&r, 0, 4, 5);
    begin(&r);
    for (int i = 1; i <= 64; ++i) {
        r.state[0].position[0] = 10 + 4.4 * i / 64;
        step_many(&r, 1);
    }
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_close(value(&r, PL_METRIC_TRAVEL_ERROR), 0.1, 1e-14, 0);
    assert_close(value(&r, PL_METRIC_DISCRETE_ERROR), 0.12, 1e-14, 0);
    assert_int_equal(metric(&r, PL_METRIC_SETTLE_TIME)->state, PL_METRIC_ABSENT);
    end(&r);
}

/* Depth 1e-6 k at step k: the maximum, its step, the percentiles and the last second all follow. */
static void test_penetration_statistics_of_a_known_ramp(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 200 * H);
    begin(&r);
    for (int k = 1; k <= 200; ++k) {
        int up_and_down = k <= 150 ? k : 300 - k;
        r.state[1].position[2] = 0.5 - 1e-6 * up_and_down;
        step_many(&r, 1);
    }
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    const pl_metric *m = metric(&r, PL_METRIC_PENETRATION_MAX);
    assert_close(value(&r, PL_METRIC_PENETRATION_MAX), 150e-6, 1e-15, 0);
    assert_int_equal(m->worst_step, 150);
    assert_true(m->has_percentiles);
    /* 1 .. 99 and 150 occur once, 100 .. 149 twice: ranks 100, 190 and 198 of 200. */
    assert_close(m->p50, 100e-6, 0, 1.0 / 128);
    assert_close(m->p95, 145e-6, 0, 1.0 / 128);
    assert_close(m->p99, 149e-6, 0, 1.0 / 128);
    double sum = 0;
    for (int k = 200 - 64 + 1; k <= 200; ++k) {
        sum += 1e-6 * (k <= 150 ? k : 300 - k);
    }
    assert_close(value(&r, PL_METRIC_PENETRATION_REST), sum / 64, 1e-15, 0);
    end(&r);
}

static void test_overlap_of_the_first_frame_is_not_the_engines(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 1);
    r.scene.bodies[1].position[2] = 0.4;
    begin(&r);
    r.state[1].position[2] = 0.51;
    step_many(&r, 64);
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_close(value(&r, PL_METRIC_PENETRATION_MAX), 0, 0, 0);
    end(&r);
}

static void test_overlapping_static_bodies_do_not_count(void **state)
{
    (void)state;
    run r;
    prepare(&r, 1);
    add_body(&r, "step", pl_shape_box(1, 1, 1), true, 0, 0);
    add_body(&r, "next", pl_shape_box(1, 1, 1), true, 0.5, 0);
    add_body(&r, "ball", pl_shape_sphere(1), false, 0, 2 - 1e-3);
    begin(&r);
    step_many(&r, 64);
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_close(value(&r, PL_METRIC_PENETRATION_MAX), 1e-3, 1e-15, 0);
    end(&r);
}

/* v = 0.1 exp(-t) falls below 1 mm/s at t = ln 100. */
static void test_settle_time_of_a_decaying_motion(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 6);
    begin(&r);
    for (int k = 1; k <= 384; ++k) {
        r.state[1].velocity[0] = 0.1 * exp(-k * H);
        step_many(&r, 1);
    }
    /* The scene starts at rest, but not for half a second. */
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_close(value(&r, PL_METRIC_SETTLE_TIME), ceil(log(100) / H) * H, 0, 0);
    end(&r);
}

static void test_a_quiet_shorter_than_half_a_second_does_not_settle(void **state)
{
    (void)state;
    const int lengths[2] = {32, 33};
    for (int c = 0; c < 2; ++c) {
        run r;
        prepare_box_on_floor(&r, 2);
        begin(&r);
        for (int k = 1; k <= 128; ++k) {
            r.state[1].angular_velocity[1] = k >= 10 && k < 10 + lengths[c] ? 0.9e-3 : 1e-3;
            step_many(&r, 1);
        }
        assert_int_equal(finish(&r), PL_VERDICT_OK);
        if (c == 0) {
            assert_int_equal(metric(&r, PL_METRIC_SETTLE_TIME)->state, PL_METRIC_FAILED);
            assert_contains(metric(&r, PL_METRIC_SETTLE_TIME)->reason, "never below");
        } else {
            assert_close(value(&r, PL_METRIC_SETTLE_TIME), 10 * H, 0, 0);
        }
        end(&r);
    }
}

/* Unsettled, x = 0.03 t and z = 0.04 t: from 1 s on, drift = 0.05 (T - 1) and creep = 0.05. */
static void test_drift_and_creep_of_a_steady_motion(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 4);
    begin(&r);
    for (int k = 1; k <= 256; ++k) {
        r.state[1].position[0] = 0.03 * k * H;
        r.state[1].position[2] = 0.5 + 0.04 * k * H;
        r.state[1].velocity[0] = 0.03;
        step_many(&r, 1);
    }
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_close(value(&r, PL_METRIC_DRIFT), 0.15, 1e-14, 0);
    assert_close(value(&r, PL_METRIC_CREEP), 0.05, 0, 1e-12);
    end(&r);
}

/* It falls into place by 1 m during the first second, settles, and then creeps by 1e-5 m/s. */
static void test_drift_counts_from_the_settled_pose(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 5);
    begin(&r);
    for (int k = 1; k <= 320; ++k) {
        bool settled = k >= 96;
        r.state[1].position[0] = settled ? 1 + 1e-5 * (k - 96) * H : k / 96.0;
        r.state[1].velocity[0] = settled ? 1e-5 : 1 / (96 * H);
        step_many(&r, 1);
    }
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_close(value(&r, PL_METRIC_SETTLE_TIME), 1.5, 0, 0);
    assert_close(value(&r, PL_METRIC_DRIFT), 1e-5 * 3.5, 1e-15, 0);
    assert_close(value(&r, PL_METRIC_CREEP), 1e-5, 0, 1e-9);
    end(&r);
}

static void test_drift_leaves_out_the_direction_of_travel(void **state)
{
    (void)state;
    run r;
    prepare(&r, 2);
    add_body(&r, "block", pl_shape_box(1, 1, 1), false, 0, 0);
    expect_travel(&r, 0, 1, nan(""));
    begin(&r);
    for (int k = 1; k <= 128; ++k) {
        r.state[0].position[0] = k * H;
        r.state[0].position[1] = 1e-3 * k * H;
        r.state[0].velocity[0] = 1;
        step_many(&r, 1);
    }
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_close(value(&r, PL_METRIC_DRIFT), 1e-3, 1e-15, 0);
    assert_close(value(&r, PL_METRIC_CREEP), 1e-3, 0, 1e-10);
    assert_int_equal(metric(&r, PL_METRIC_DISCRETE_ERROR)->state, PL_METRIC_ABSENT);
    end(&r);
}

static void test_without_a_reference_there_is_no_drift(void **state)
{
    (void)state;
    run r;
    prepare(&r, 2);
    add_body(&r, "ball", pl_shape_sphere(1), false, 0, 0);
    begin(&r);
    step_many(&r, 128);
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_int_equal(metric(&r, PL_METRIC_DRIFT)->state, PL_METRIC_ABSENT);
    assert_int_equal(metric(&r, PL_METRIC_CREEP)->state, PL_METRIC_ABSENT);
    assert_int_equal(metric(&r, PL_METRIC_REFERENCE_ERROR)->state, PL_METRIC_ABSENT);
    end(&r);
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; ++k) {
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
}

/* One step of semi-implicit Euler of a sphere, whose inertia no rotation changes. */
static void euler_step(run *r, int body, const double force[3], const double arm[3])
{
    pl_body_state *s = &r->state[body];
    const pl_body *b = &r->scene.bodies[body];
    double torque[3];
    cross(arm, force, torque);
    for (int k = 0; k < 3; ++k) {
        s->velocity[k] += H * (r->scene.gravity[k] + force[k] / b->mass);
        s->angular_velocity[k] += H * torque[k] / b->inertia[0];
        s->position[k] += H * s->velocity[k];
    }
}

static void prepare_projectile(run *r)
{
    prepare(r, 4);
    add_body(r, "ball", pl_shape_sphere(0.5), false, 3, 10);
    pl_body *ball = &r->scene.bodies[0];
    const double velocity[3] = {3, -2, 8}, spin[3] = {1, 5, -2};
    memcpy(ball->velocity, velocity, sizeof velocity);
    memcpy(ball->angular_velocity, spin, sizeof spin);
}

/* Flies the only body for 256 steps under a force over part of the time. The metric hides what is
 * lost, so the signed energy is checked at each step too. */
static void fly(run *r, const double force[3], const double arm[3], double from, double until)
{
    const double none[3] = {0, 0, 0};
    pl_scale scale = pl_scale_of(&r->scene);
    pl_mechanics *mechanics = pl_mechanics_create(&r->scene);
    assert_non_null(mechanics);
    begin(r);
    pl_mechanics_start(mechanics, r->state);
    for (int k = 0; k < 256; ++k) {
        euler_step(r, 0, k * H >= from && k * H < until ? force : none, arm);
        step_many(r, 1);
        pl_mechanics_step(mechanics, k + 1, r->state, NULL, 0);
        assert_close(pl_mechanics_energy_gain(mechanics, &scale), 0, 1e-13, 0);
    }
    pl_mechanics_destroy(mechanics);
    assert_int_equal(finish(r), PL_VERDICT_OK);
    assert_close(value(r, PL_METRIC_ENERGY_GAIN), 0, 1e-13, 0);
    assert_close(value(r, PL_METRIC_MOMENTUM_ERROR), 0, 1e-13, 0);
    end(r);
}

static void test_a_projectile_keeps_energy_and_momentum_to_rounding(void **state)
{
    (void)state;
    const double none[3] = {0, 0, 0};
    run r;
    prepare_projectile(&r);
    fly(&r, none, none, 0, 0);
}

static void test_work_and_impulse_of_scene_forces_are_accounted_to_rounding(void **state)
{
    (void)state;
    run r;
    prepare_projectile(&r);
    const pl_force push = {
        .body = 0, .force = {5, 7, -3}, .at = {0.1, -0.3, 0.2}, .from = 0.5, .until = 2};
    assert_int_equal(pl_scene_add_force(&r.scene, &push, NULL), PL_OK);
    fly(&r, push.force, push.at, push.from, push.until);
}

static void test_a_body_frame_force_turns_with_the_body(void **state)
{
    (void)state;
    run r;
    prepare_projectile(&r);
    /* A quarter turn about z takes the body's x to the world's y. */
    const double quarter[4] = {0.70710678118654752, 0, 0, 0.70710678118654752};
    memcpy(r.scene.bodies[0].orientation, quarter, sizeof quarter);
    const pl_force push = {.body = 0,
                           .force = {6, 0, 0},
                           .at = {0, 0.25, 0},
                           .frame = PL_FRAME_BODY,
                           .until = HUGE_VAL};
    assert_int_equal(pl_scene_add_force(&r.scene, &push, NULL), PL_OK);
    const double force[3] = {0, 6, 0}, arm[3] = {-0.25, 0, 0};
    fly(&r, force, arm, 0, 4);
}

/* A ball of 2 kg in no gravity is given 1 m/s out of nowhere at step 10 and loses it at step 20. */
static void test_a_kick_out_of_nowhere_shows_in_energy_and_momentum(void **state)
{
    (void)state;
    run r;
    prepare(&r, 1);
    memset(r.scene.gravity, 0, sizeof r.scene.gravity);
    add_body(&r, "ball", pl_shape_sphere(0.5), false, 0, 0);
    r.scene.bodies[0].velocity[0] = 1;
    begin(&r);
    for (int k = 1; k <= 64; ++k) {
        r.state[0].velocity[0] = k >= 10 && k < 20 ? 2 : 1;
        step_many(&r, 1);
    }
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    /* E: 1 J -> 4 J; p: 2 -> 4 kg m/s. */
    assert_close(value(&r, PL_METRIC_ENERGY_GAIN), 3, 1e-14, 0);
    assert_close(value(&r, PL_METRIC_MOMENTUM_ERROR), 1, 1e-14, 0);
    assert_int_equal(metric(&r, PL_METRIC_ENERGY_GAIN)->worst_step, 10);
    assert_int_equal(metric(&r, PL_METRIC_MOMENTUM_ERROR)->worst_step, 10);
    end(&r);
}

static void test_lost_energy_is_no_gain(void **state)
{
    (void)state;
    run r;
    prepare_projectile(&r);
    begin(&r);
    memset(r.state[0].velocity, 0, sizeof r.state[0].velocity);
    step_many(&r, 256);
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_close(value(&r, PL_METRIC_ENERGY_GAIN), 0, 0, 0);
    end(&r);
}

/* A box held up by the floor with exactly m g h a step, whichever body comes first in the contact.
 */
static void test_contact_impulses_of_static_bodies_balance_the_weight(void **state)
{
    (void)state;
    for (int order = 0; order < 2; ++order) {
        for (int wrong = 0; wrong < 2; ++wrong) {
            run r;
            prepare_box_on_floor(&r, 1);
            r.scene.bodies[1].position[0] = 7;
            begin(&r);
            double up = 2 * 9.81 * H * (order == 0 ? 1 : -1) * (wrong != 0 ? 0.5 : 1);
            const pl_contact contact = {
                .body_a = order, .body_b = 1 - order, .point = {7, 0, 0}, .impulse = {0, 0, up}};
            for (int k = 0; k < 64; ++k) {
                assert_int_equal(step_with(&r, &contact, 1), PL_VERDICT_OK);
            }
            assert_int_equal(finish(&r), PL_VERDICT_OK);
            /* p_ref is M g T, so half the support leaves half of it unexplained. */
            assert_close(value(&r, PL_METRIC_MOMENTUM_ERROR), wrong != 0 ? 0.5 : 0, 1e-13, 0);
            end(&r);
        }
    }
}

static void test_a_contact_of_no_body_fails_the_momentum_alone(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 1);
    begin(&r);
    const pl_contact contact = {.body_a = 0, .body_b = 2};
    assert_int_equal(step_with(&r, &contact, 1), PL_VERDICT_OK);
    step_many(&r, 63);
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_int_equal(metric(&r, PL_METRIC_MOMENTUM_ERROR)->state, PL_METRIC_FAILED);
    assert_contains(metric(&r, PL_METRIC_MOMENTUM_ERROR)->reason, "step 1");
    assert_close(value(&r, PL_METRIC_ENERGY_GAIN), 0, 0, 0);
    end(&r);
}

static void test_an_impulse_that_is_nan_is_not_taken_for_zero(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 1);
    begin(&r);
    const pl_contact contact = {.body_a = 0, .body_b = 1, .impulse = {nan(""), 0, 0}};
    for (int k = 0; k < 64; ++k) {
        assert_int_equal(step_with(&r, &contact, 1), PL_VERDICT_OK);
    }
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_int_equal(metric(&r, PL_METRIC_MOMENTUM_ERROR)->state, PL_METRIC_FAILED);
    assert_contains(metric(&r, PL_METRIC_MOMENTUM_ERROR)->reason, "not finite at step 1");
    end(&r);
}

static void test_the_first_number_that_is_not_finite_ends_the_run(void **state)
{
    (void)state;
    const double bad[3] = {nan(""), HUGE_VAL, -HUGE_VAL};
    for (size_t number = 0; number < sizeof(pl_body_state) / sizeof(double); ++number) {
        run r;
        prepare_box_on_floor(&r, 1);
        begin(&r);
        step_many(&r, 9);
        double wrong = bad[number % 3];
        memcpy((char *)&r.state[1] + number * sizeof wrong, &wrong, sizeof wrong);
        assert_int_equal(step(&r), PL_VERDICT_NONFINITE);
        assert_contains(r.error.message, "\"box\"");
        assert_contains(r.error.message, "step 10");
        assert_int_equal(step(&r), PL_VERDICT_NONFINITE);
        assert_int_equal(finish(&r), PL_VERDICT_NONFINITE);
        const pl_metric *rest = metric(&r, PL_METRIC_REST_POSITION_ERROR);
        assert_int_equal(rest->state, PL_METRIC_FAILED);
        assert_string_equal(rest->reason, "the run ended at step 9 of 64");
        end(&r);
    }
}

static void test_a_null_quaternion_is_no_rotation(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 1);
    begin(&r);
    memset(r.state[1].orientation, 0, sizeof r.state[1].orientation);
    assert_int_equal(step(&r), PL_VERDICT_NONFINITE);
    assert_contains(r.error.message, "no rotation");
    end(&r);
}

static void test_a_run_that_starts_with_nan_has_no_metrics(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 1);
    begin(&r);
    r.state[1].position[0] = nan("");
    pl_frame frame = frame_of(&r);
    assert_int_equal(pl_referee_start(r.referee, &frame), PL_VERDICT_NONFINITE);
    assert_int_equal(finish(&r), PL_VERDICT_NONFINITE);
    assert_contains(r.error.message, "step 0");
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        assert_true(metric(&r, (pl_metric_id)i)->state == PL_METRIC_FAILED ||
                    metric(&r, (pl_metric_id)i)->state == PL_METRIC_ABSENT);
    }
    end(&r);
}

static void test_a_static_body_is_where_the_scene_has_it(void **state)
{
    (void)state;
    run r;
    prepare(&r, 1);
    add_body(&r, "floor", pl_shape_box(5, 5, 1), true, 0, -1);
    add_body(&r, "box", pl_shape_box(0.5, 0.5, 0.5), false, 0, 0.5 - 1e-3);
    begin(&r);
    memset(&r.state[0], 0, sizeof r.state[0]);
    step_many(&r, 64);
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_close(value(&r, PL_METRIC_PENETRATION_MAX), 1e-3, 1e-15, 0);
    end(&r);
}

static void test_an_exploding_body_has_diverged_and_maxima_are_kept(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 1);
    begin(&r);
    r.state[1].position[2] = 0.49;
    step_many(&r, 5);
    r.state[1].velocity[0] = 1e5;
    assert_int_equal(step(&r), PL_VERDICT_DIVERGED);
    assert_contains(r.error.message, "\"box\"");
    assert_contains(r.error.message, "step 6");
    assert_int_equal(finish(&r), PL_VERDICT_DIVERGED);
    assert_close(value(&r, PL_METRIC_PENETRATION_MAX), 0.01, 1e-15, 0);
    assert_int_equal(metric(&r, PL_METRIC_PENETRATION_REST)->state, PL_METRIC_FAILED);
    assert_int_equal(metric(&r, PL_METRIC_STATE_HASH)->state, PL_METRIC_FAILED);
    assert_int_equal(metric(&r, PL_METRIC_REFERENCE_ERROR)->state, PL_METRIC_FAILED);
    end(&r);
}

static void test_energy_from_nowhere_diverges_below_the_bound_of_speed(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 1);
    begin(&r);
    /* E_ref = 2 kg x 9.81 x sqrt(3) m = 34 J, so that 300 m/s (9e4 J) is 2600 times as much. */
    r.state[1].velocity[0] = 300;
    assert_int_equal(step(&r), PL_VERDICT_DIVERGED);
    assert_contains(r.error.message, "energy");
    end(&r);
}

static void test_a_long_fall_is_no_divergence(void **state)
{
    (void)state;
    const double none[3] = {0, 0, 0};
    run r;
    prepare(&r, 600);
    add_body(&r, "ball", pl_shape_sphere(0.01), false, 0, 0);
    begin(&r);
    for (int k = 0; k < 600 * 64; ++k) {
        euler_step(&r, 0, none, none);
        step_many(&r, 1);
    }
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    end(&r);
}

static void test_an_engine_that_stops_early_leaves_its_maxima(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 1);
    begin(&r);
    r.stats.iterations = 7;
    step_many(&r, 10);
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_close(value(&r, PL_METRIC_ITERATIONS_MAX), 7, 0, 0);
    assert_close(value(&r, PL_METRIC_PENETRATION_MAX), 0, 0, 0);
    assert_string_equal(metric(&r, PL_METRIC_CREEP)->reason, "the run has no frame after step 32");
    assert_string_equal(metric(&r, PL_METRIC_STATE_HASH)->reason, "the run ended at step 10 of 64");
    end(&r);
}

static void test_statistics_of_steps(void **state)
{
    (void)state;
    run r;
    prepare_box_on_floor(&r, 200 * H);
    begin(&r);
    for (int k = 1; k <= 200; ++k) {
        r.stats.iterations = k == 77 ? 500 : k % 100;
        r.stats.contacts = k <= 100 ? 4 : nan("");
        step_many(&r, 1);
    }
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    const pl_metric *iterations = metric(&r, PL_METRIC_ITERATIONS_MEAN);
    assert_close(iterations->value, (2 * 4950 + 500 - 77) / 200.0, 1e-12, 0);
    assert_int_equal(iterations->worst_step, 77);
    /* Whole numbers below 256 have a bin each. */
    assert_close(iterations->p50, 49, 0, 0);
    assert_close(iterations->p95, 95, 0, 0);
    assert_close(value(&r, PL_METRIC_ITERATIONS_MAX), 500, 0, 0);
    assert_close(value(&r, PL_METRIC_CONTACTS_MEAN), 4, 0, 0);
    assert_close(value(&r, PL_METRIC_TIME_PER_STEP), 1e-3, 0, 1e-12);
    assert_int_equal(metric(&r, PL_METRIC_RESIDUAL_MAX)->state, PL_METRIC_FAILED);
    assert_string_equal(metric(&r, PL_METRIC_RESIDUAL_MAX)->reason, "the engine reports none");
    assert_string_equal(metric(&r, PL_METRIC_RESIDUAL_MAX)->unit, "m/s");
    pl_metrics other;
    assert_int_equal(pl_referee_finish(r.referee, NULL, &other, NULL), PL_VERDICT_OK);
    assert_int_equal(other.item[PL_METRIC_RESIDUAL_MAX].state, PL_METRIC_ABSENT);
    end(&r);
}

static void hash_with(double x, char text[24])
{
    run r;
    prepare_box_on_floor(&r, 1);
    begin(&r);
    r.state[1].position[0] = x;
    step_many(&r, 64);
    assert_int_equal(finish(&r), PL_VERDICT_OK);
    assert_int_equal(metric(&r, PL_METRIC_STATE_HASH)->state, PL_METRIC_TEXT);
    memcpy(text, metric(&r, PL_METRIC_STATE_HASH)->text, 24);
    end(&r);
}

static void test_the_hash_changes_with_one_bit_and_only_then(void **state)
{
    (void)state;
    char first[24], again[24], next[24], zero[24], minus_zero[24];
    hash_with(0.1, first);
    hash_with(0.1, again);
    hash_with(nextafter(0.1, 1), next);
    hash_with(0, zero);
    hash_with(-0.0, minus_zero);
    assert_int_equal(strlen(first), 16);
    assert_string_equal(first, again);
    assert_string_not_equal(first, next);
    assert_string_not_equal(zero, minus_zero);
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static void test_percentiles_are_within_the_histograms_resolution(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    check_random random = {UINT64_C(2463534242)};
    double *sorted = malloc(COUNT * sizeof *sorted);
    pl_series series;
    assert_non_null(sorted);
    assert_true(pl_series_init(&series));
    for (int i = 0; i < COUNT; ++i) {
        sorted[i] = pow(10, check_uniform(&random, -20, 12));
        pl_series_add(&series, sorted[i], i + 1);
        pl_series_add(&series, nan(""), i + 1);
    }
    qsort(sorted, COUNT, sizeof *sorted, ascending);
    for (int percent = 1; percent <= 100; ++percent) {
        double exact = sorted[COUNT / 100 * percent - 1];
        assert_close(pl_series_percentile(&series, percent / 100.0), exact, 0, 1.0 / 128);
    }
    assert_close(series.max, sorted[COUNT - 1], 0, 0);
    pl_series_free(&series);
    free(sorted);
}

static void test_numbers_one_percent_apart_never_share_a_bin(void **state)
{
    (void)state;
    pl_series series;
    assert_true(pl_series_init(&series));
    for (int k = 1; k <= 1000; ++k) {
        pl_series_add(&series, 1e-6 * pow(1.01, k), k);
    }
    for (int k = 1; k <= 1000; ++k) {
        assert_close(pl_series_percentile(&series, k / 1000.0), 1e-6 * pow(1.01, k), 0, 0);
    }
    pl_series_free(&series);
}

static void test_percentiles_beyond_the_histograms_range(void **state)
{
    (void)state;
    pl_series series;
    assert_true(pl_series_init(&series));
    assert_close(pl_series_percentile(&series, 0.5), 0, 0, 0);
    for (int i = 1; i <= 98; ++i) {
        pl_series_add(&series, 0, i);
    }
    pl_series_add(&series, 1e200, 99);
    pl_series_add(&series, HUGE_VAL, 100);
    assert_close(pl_series_percentile(&series, 0.98), 0, 0, 0);
    assert_true(pl_series_percentile(&series, 0.99) > 1e199);
    pl_metric infinite = pl_series_metric(&series, series.max);
    assert_int_equal(infinite.state, PL_METRIC_FAILED);
    assert_contains(infinite.reason, "step 100");
    pl_series_free(&series);
}

enum { CROWD = 120 };

static void scatter(check_random *random, double position[3], double orientation[4])
{
    for (int k = 0; k < 3; ++k) {
        position[k] = check_uniform(random, -3, 3);
    }
    check_quaternion(random, orientation);
}

/* Random boxes and spheres, a fifth of them static, and two planes; the dynamic ones jump about at
 * random from frame to frame. Against all pairs by their gaps. */
static void test_the_broad_phase_finds_every_touching_pair_once(void **state)
{
    (void)state;
    check_random random = {UINT64_C(1442695040888963407)};
    pl_scene scene = pl_scene_default();
    static pl_body_state bodies[CROWD];
    static int seen[CROWD][CROWD];
    for (int i = 0; i < CROWD; ++i) {
        pl_body body = pl_body_default();
        (void)snprintf(body.name, sizeof body.name, "body %d", i);
        body.shape = i % 2 == 0 ? pl_shape_sphere(check_uniform(&random, 0.1, 0.6))
                                : pl_shape_box(check_uniform(&random, 0.1, 0.6), 0.2, 0.4);
        body.is_static = i % 5 == 0;
        if (i % 60 == 7) {
            body.shape = pl_shape_plane(0, 0, 1, -2);
            body.is_static = true;
        }
        scatter(&random, body.position, body.orientation);
        assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
        memcpy(bodies[i].position, body.position, sizeof body.position);
        memcpy(bodies[i].orientation, body.orientation, sizeof body.orientation);
    }
    pl_broad_phase *broad_phase = pl_broad_phase_create(&scene);
    assert_non_null(broad_phase);
    long found = 0;
    for (int frame = 0; frame < 50; ++frame) {
        memset(seen, 0, sizeof seen);
        pl_broad_phase_update(broad_phase, bodies);
        for (int a = 0, b = 0; pl_broad_phase_next(broad_phase, &a, &b);) {
            assert_int_not_equal(a, b);
            assert_false(scene.bodies[a].is_static && scene.bodies[b].is_static);
            seen[a < b ? a : b][a < b ? b : a] += 1;
        }
        for (int a = 0; a < CROWD; ++a) {
            for (int b = a + 1; b < CROWD; ++b) {
                assert_in_range(seen[a][b], 0, 1);
                pl_placed_shape pa = {.shape = &scene.bodies[a].shape};
                pl_placed_shape pb = {.shape = &scene.bodies[b].shape};
                memcpy(pa.position, bodies[a].position, sizeof pa.position);
                memcpy(pb.position, bodies[b].position, sizeof pb.position);
                memcpy(pa.orientation, bodies[a].orientation, sizeof pa.orientation);
                memcpy(pb.orientation, bodies[b].orientation, sizeof pb.orientation);
                double gap = HUGE_VAL;
                bool may_touch = !(scene.bodies[a].is_static && scene.bodies[b].is_static);
                if (may_touch && pl_gap(&pa, &pb, &gap) == PL_OK && gap <= 0) {
                    assert_int_equal(seen[a][b], 1);
                    found += 1;
                }
            }
        }
        for (int i = 0; i < CROWD; ++i) {
            if (!scene.bodies[i].is_static) {
                scatter(&random, bodies[i].position, bodies[i].orientation);
            }
        }
    }
    assert_true(found > 5000);
    pl_broad_phase_destroy(broad_phase);
    pl_scene_free(&scene);
}

/* Faces that touch exactly, as in every tower: rounding must not lose them. */
static void test_the_broad_phase_keeps_pairs_that_just_touch(void **state)
{
    (void)state;
    run r;
    prepare(&r, 1);
    for (int i = 0; i < MOST_BODIES; ++i) {
        char name[PL_NAME_SIZE];
        (void)snprintf(name, sizeof name, "cube %d", i);
        add_body(&r, name, pl_shape_box(0.05, 0.05, 0.05), false, 0, 0.1 * i);
    }
    begin(&r);
    pl_broad_phase *broad_phase = pl_broad_phase_create(&r.scene);
    assert_non_null(broad_phase);
    pl_broad_phase_update(broad_phase, r.state);
    int pairs = 0;
    for (int a = 0, b = 0; pl_broad_phase_next(broad_phase, &a, &b);) {
        assert_int_equal(abs(a - b), 1);
        pairs += 1;
    }
    assert_int_equal(pairs, MOST_BODIES - 1);
    pl_broad_phase_destroy(broad_phase);
    end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_metric_has_a_name_a_unit_and_a_definition),
        cmocka_unit_test(test_a_body_at_rest_in_its_reference_has_no_error),
        cmocka_unit_test(test_final_pose_errors_are_the_distance_and_the_angle),
        cmocka_unit_test(test_a_sphere_has_no_rotation_error),
        cmocka_unit_test(test_a_body_beyond_collapse_distance_has_collapsed_and_is_named),
        cmocka_unit_test(test_travel_errors_are_relative_to_their_own_references),
        cmocka_unit_test(test_penetration_statistics_of_a_known_ramp),
        cmocka_unit_test(test_overlap_of_the_first_frame_is_not_the_engines),
        cmocka_unit_test(test_overlapping_static_bodies_do_not_count),
        cmocka_unit_test(test_settle_time_of_a_decaying_motion),
        cmocka_unit_test(test_a_quiet_shorter_than_half_a_second_does_not_settle),
        cmocka_unit_test(test_drift_and_creep_of_a_steady_motion),
        cmocka_unit_test(test_drift_counts_from_the_settled_pose),
        cmocka_unit_test(test_drift_leaves_out_the_direction_of_travel),
        cmocka_unit_test(test_without_a_reference_there_is_no_drift),
        cmocka_unit_test(test_a_projectile_keeps_energy_and_momentum_to_rounding),
        cmocka_unit_test(test_work_and_impulse_of_scene_forces_are_accounted_to_rounding),
        cmocka_unit_test(test_a_body_frame_force_turns_with_the_body),
        cmocka_unit_test(test_a_kick_out_of_nowhere_shows_in_energy_and_momentum),
        cmocka_unit_test(test_lost_energy_is_no_gain),
        cmocka_unit_test(test_contact_impulses_of_static_bodies_balance_the_weight),
        cmocka_unit_test(test_a_contact_of_no_body_fails_the_momentum_alone),
        cmocka_unit_test(test_an_impulse_that_is_nan_is_not_taken_for_zero),
        cmocka_unit_test(test_the_first_number_that_is_not_finite_ends_the_run),
        cmocka_unit_test(test_a_null_quaternion_is_no_rotation),
        cmocka_unit_test(test_a_run_that_starts_with_nan_has_no_metrics),
        cmocka_unit_test(test_a_static_body_is_where_the_scene_has_it),
        cmocka_unit_test(test_an_exploding_body_has_diverged_and_maxima_are_kept),
        cmocka_unit_test(test_energy_from_nowhere_diverges_below_the_bound_of_speed),
        cmocka_unit_test(test_a_long_fall_is_no_divergence),
        cmocka_unit_test(test_an_engine_that_stops_early_leaves_its_maxima),
        cmocka_unit_test(test_statistics_of_steps),
        cmocka_unit_test(test_the_hash_changes_with_one_bit_and_only_then),
        cmocka_unit_test(test_percentiles_are_within_the_histograms_resolution),
        cmocka_unit_test(test_numbers_one_percent_apart_never_share_a_bin),
        cmocka_unit_test(test_percentiles_beyond_the_histograms_range),
        cmocka_unit_test(test_the_broad_phase_finds_every_touching_pair_once),
        cmocka_unit_test(test_the_broad_phase_keeps_pairs_that_just_touch),
    };
    return cmocka_run_group_tests_name("referee", tests, NULL, NULL);
}
