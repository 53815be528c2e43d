/* Metrics of contact impulses that the test chooses, against closed forms. */
#include "check.h"
#include "synthetic_run.h"

#include <math.h>
#include <string.h>

static const double g = 9.81, mu = 0.5, mass = 2; /* of synthetic runs */

static const pl_metric_id of_force[] = {PL_METRIC_FORCE_BALANCE, PL_METRIC_CONE_VIOLATION,
                                        PL_METRIC_FRICTION_EFFECTIVE, PL_METRIC_SIGNORINI,
                                        PL_METRIC_NATURAL_MAP};
enum { FLOOR, BOX, CORNERS = 4, COUNT = sizeof of_force / sizeof *of_force };

/* A contact of the floor (A) with body B at (x, y, 0). */
static pl_contact on_floor(int body, double x, double y, double rx, double ry, double rz)
{
    return (pl_contact){.body_a = FLOOR,
                        .body_b = body,
                        .point = {x, y, 0},
                        .normal = {0, 0, 1},
                        .impulse = {rx, ry, rz}};
}

/* The same contact with the bodies in the other order. */
static pl_contact swapped(pl_contact c)
{
    pl_contact s = c;
    s.body_a = c.body_b;
    s.body_b = c.body_a;
    for (int k = 0; k < 3; ++k) {
        s.normal[k] = -c.normal[k];
        s.impulse[k] = -c.impulse[k];
    }
    return s;
}

/* A floor and a cube of side 1 on it that moves with this velocity. */
static void begin_box(run *r, double vx, double vy, double vz)
{
    run_prepare_box_on_floor(r, 1);
    const double velocity[3] = {vx, vy, vz};
    memcpy(r->scene.bodies[BOX].velocity, velocity, sizeof velocity);
    run_begin(r);
}

/* Impulses at the four corners, each a quarter of the given sum in units of the weight. */
static void corners(pl_contact out[CORNERS], double x, double y, double rx, double ry, double rz)
{
    double quarter = mass * g * H / 4;
    for (int i = 0; i < CORNERS; ++i) {
        out[i] = on_floor(BOX, x + (i & 1 ? 0.5 : -0.5), y + (i & 2 ? 0.5 : -0.5), quarter * rx,
                          quarter * ry, quarter * rz);
    }
}

/* One step with these contacts, which is the last. */
static void finish_with(run *r, const pl_contact *contacts, int count)
{
    (void)run_step_with(r, contacts, count);
    (void)run_finish(r);
}

/* One step with impulses at the corners of a box at the origin, which is the last. */
static void finish_on_corners(run *r, double rx, double ry, double rz)
{
    pl_contact c[CORNERS];
    corners(c, 0, 0, rx, ry, rz);
    finish_with(r, c, CORNERS);
}

/* A floor and a ball of radius 1/2 over it by `height`. */
static void prepare_ball(run *r, double height)
{
    run_prepare(r, 1);
    run_add_body(r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    run_add_body(r, "ball", pl_shape_sphere(0.5), false, 0, 0.5 + height);
}

static void assert_absent_metric(const run *r, pl_metric_id id)
{
    if (run_metric(r, id)->state != PL_METRIC_ABSENT) {
        fail_msg("%s is there: %g %s", pl_metric_table[id].name, run_metric(r, id)->value,
                 run_metric(r, id)->reason);
    }
}

/* The box slides by v' = v - mu g h, Coulomb's law. */
static void slide(run *r, bool swap, double rx, double ry)
{
    begin_box(r, 3, 0, 0);
    for (int n = 0; n < 16; ++n) {
        pl_contact c[CORNERS];
        corners(c, r->state[BOX].position[0], 0, rx, ry, 1);
        r->state[BOX].velocity[0] += rx * g * H;
        r->state[BOX].velocity[1] += ry * g * H;
        r->state[BOX].position[0] += H * r->state[BOX].velocity[0];
        for (int i = 0; i < CORNERS && swap; ++i) {
            c[i] = swapped(c[i]);
        }
        assert_int_equal(run_step_with(r, c, CORNERS), PL_ENDING_OK);
    }
    (void)run_finish(r);
}

static void test_sliding_box_by_coulombs_law_has_no_error(void **state)
{
    (void)state;
    for (int swap = 0; swap < 2; ++swap) {
        run r;
        slide(&r, swap == 1, -mu, 0);
        assert_close(run_value(&r, PL_METRIC_FRICTION_EFFECTIVE), mu, 1e-15, 0);
        assert_close(run_value(&r, PL_METRIC_CONE_VIOLATION), 0, 1e-15, 0);
        assert_close(run_value(&r, PL_METRIC_FORCE_BALANCE), 0, 1e-14, 0);
        assert_close(run_value(&r, PL_METRIC_SIGNORINI), 0, 0, 0);
        assert_close(run_value(&r, PL_METRIC_NATURAL_MAP), 0, 1e-14, 0);
        run_end(&r);
    }
}

static void test_friction_pyramid_violates_the_cone_at_its_corners(void **state)
{
    (void)state;
    run r;
    slide(&r, false, -mu, -mu);
    assert_close(run_value(&r, PL_METRIC_CONE_VIOLATION), sqrt(2) - 1, 1e-15, 0);
    assert_close(run_value(&r, PL_METRIC_FRICTION_EFFECTIVE), sqrt(2) * mu, 1e-15, 0);
    assert_close(run_value(&r, PL_METRIC_FORCE_BALANCE), 0, 1e-14, 0);
    run_end(&r);
}

static void test_friction_effective_is_the_mean_over_contacts(void **state)
{
    (void)state;
    run r;
    begin_box(&r, 3, 0, 0);
    pl_contact c[CORNERS];
    corners(c, 0, 0, 0, 0, 1);
    c[0].impulse[0] = -0.1 * c[0].impulse[2];
    c[1].impulse[1] = 0.2 * c[1].impulse[2];
    c[2].impulse[0] = -0.3 * c[2].impulse[2];
    finish_with(&r, c, CORNERS);
    assert_close(run_value(&r, PL_METRIC_FRICTION_EFFECTIVE), 0.15, 1e-15, 0);
    run_end(&r);
}

static void test_sticking_or_creeping_contact_has_no_effective_friction(void **state)
{
    (void)state;
    const double speeds[] = {0, 0.99 * H * 9.81, 1.01 * H * 9.81};
    for (int i = 0; i < 3; ++i) {
        run r;
        begin_box(&r, speeds[i], 0, 0);
        finish_on_corners(&r, -0.3, 0, 1);
        assert_close(run_value(&r, PL_METRIC_CONE_VIOLATION), 0, 0, 0);
        if (i < 2) {
            assert_absent_metric(&r, PL_METRIC_FRICTION_EFFECTIVE);
        } else {
            assert_close(run_value(&r, PL_METRIC_FRICTION_EFFECTIVE), 0.3, 1e-15, 0);
        }
        run_end(&r);
    }
}

static void test_friction_of_unloaded_contacts_is_not_measured(void **state)
{
    (void)state;
    run r;
    begin_box(&r, 3, 0, 0);
    pl_contact c[2] = {on_floor(BOX, 0.5, 0, -mu * mass * g * H, 0, mass * g * H),
                       on_floor(BOX, -0.5, 0, -1e-2 * mass * g * H, 0, 0.9e-3 * mass * g * H)};
    finish_with(&r, c, 2);
    assert_close(run_value(&r, PL_METRIC_CONE_VIOLATION), 0, 1e-15, 0);
    assert_close(run_value(&r, PL_METRIC_FRICTION_EFFECTIVE), mu, 1e-15, 0);
    /* The law of contact applies to all contacts: it shows that the cone was violated. */
    assert_true(run_value(&r, PL_METRIC_NATURAL_MAP) > 1e-3);
    run_end(&r);
}

/* A box of 2 kg under or on one of 2000 kg, which slides with too much friction at a load of a
 * hundredth of the lighter one's weight. */
static void test_load_is_in_units_of_the_lighter_weight(void **state)
{
    (void)state;
    for (int light = 1; light < 3; ++light) {
        run r;
        run_prepare_box_on_floor(&r, 1);
        run_add_body(&r, "top", pl_shape_box(0.5, 0.5, 0.5), false, 0, 1.5);
        r.scene.bodies[3 - light].mass *= 1000;
        r.scene.bodies[2].velocity[0] = 3;
        run_begin(&r);
        const double load = 1e-2 * mass * g * H;
        pl_contact c = on_floor(2, 0, 0, -2 * mu * load, 0, load);
        c.body_a = 1;
        c.point[2] = 1;
        finish_with(&r, &c, 1);
        assert_close(run_value(&r, PL_METRIC_CONE_VIOLATION), 1, 1e-14, 0);
        assert_close(run_value(&r, PL_METRIC_FRICTION_EFFECTIVE), 2 * mu, 1e-14, 0);
        run_end(&r);
    }
}

static void test_force_balance_is_in_units_of_weight(void **state)
{
    (void)state;
    run r;
    begin_box(&r, 0, 0, 0);
    for (int n = 1; n <= 9; ++n) {
        pl_contact c[CORNERS];
        corners(c, 0, 0, n == 4 ? 0.3 : 0, n == 6 ? -0.1 : 0, n == 4 ? 0.6 : 1);
        assert_int_equal(run_step_with(&r, c, CORNERS), PL_ENDING_OK);
    }
    (void)run_finish(&r);
    assert_close(run_value(&r, PL_METRIC_FORCE_BALANCE), 0.5, 1e-15, 0);
    assert_int_equal(run_metric(&r, PL_METRIC_FORCE_BALANCE)->worst_step, 4);
    assert_close(run_metric(&r, PL_METRIC_FORCE_BALANCE)->p50, 0, 1e-15, 0);
    run_end(&r);
}

static void test_motion_without_a_force_is_unbalanced(void **state)
{
    (void)state;
    run r;
    begin_box(&r, 0, 0, 0);
    r.state[BOX].velocity[1] = 0.25 * g * H;
    finish_on_corners(&r, 0, 0, 1);
    assert_close(run_value(&r, PL_METRIC_FORCE_BALANCE), 0.25, 1e-15, 0);
    run_end(&r);
}

/* Two balls on each other: the force that supports the upper one presses the lower one down. */
static void test_a_contact_acts_on_both_bodies(void **state)
{
    (void)state;
    run r;
    prepare_ball(&r, 0);
    run_add_body(&r, "high", pl_shape_sphere(0.5), false, 0, 1.5);
    run_begin(&r);
    double weight = mass * g * H;
    pl_contact c[2] = {on_floor(1, 0, 0, 0, 0, 2 * weight), on_floor(2, 0, 0, 0, 0, weight)};
    c[1].body_a = 1;
    c[1].point[2] = 1;
    (void)run_step_with(&r, c, 2);
    c[1] = swapped(c[1]);
    finish_with(&r, c, 2);
    assert_close(run_value(&r, PL_METRIC_FORCE_BALANCE), 0, 1e-15, 0);
    assert_close(run_value(&r, PL_METRIC_NATURAL_MAP), 0, 1e-15, 0);
    run_end(&r);
}

/* A ball turns about z by 0.8 rad a step under a force in its own frame along x, by semi-implicit
 * Euler or a rule of second order; the impulse of the latter is F (sin, 1 - cos)/w. */
static void turning_force(pl_position_rule integrator, bool rule_is_kept)
{
    run r;
    const double spin = 0.8 / H, thrust = 30;
    run_prepare(&r, 16 * H);
    run_add_body(&r, "ball", pl_shape_sphere(0.5), false, 0, 10);
    r.scene.bodies[0].angular_velocity[2] = spin;
    const pl_force force = {
        .force = {thrust, 0, 0}, .frame = PL_FRAME_BODY, .from = 0, .until = 8 * H};
    assert_int_equal(pl_scene_add_force(&r.scene, &force, NULL), PL_OK);
    run_begin(&r);
    for (int n = 0; n < 16; ++n) {
        double a = spin * H * n, b = spin * H * (n + 1), on = n < 8 ? thrust / mass : 0;
        double ax = on * H * cos(a), ay = on * H * sin(a);
        if ((integrator == PL_SECOND_ORDER) == rule_is_kept) {
            ax = on / spin * (sin(b) - sin(a));
            ay = on / spin * (cos(a) - cos(b));
        }
        pl_body_state *s = &r.state[0];
        const double change[3] = {ax, ay, -g * H};
        for (int k = 0; k < 3; ++k) {
            s->velocity[k] += change[k];
            double late = integrator == PL_SECOND_ORDER ? change[k] / 2 : 0;
            s->position[k] += H * (s->velocity[k] - late);
        }
        s->orientation[0] = cos(b / 2);
        s->orientation[3] = sin(b / 2);
        assert_int_equal(run_step_with(&r, NULL, 0), PL_ENDING_OK);
    }
    (void)run_finish(&r);
    double balance = run_value(&r, PL_METRIC_FORCE_BALANCE);
    if (!rule_is_kept) {
        assert_true(balance > 0.1);
    } else if (integrator == PL_SECOND_ORDER) {
        /* Simpson's rule errs by (w h)^4/2880. */
        assert_at_most(balance, 2e-4 * thrust / (mass * g));
    } else {
        assert_close(balance, 0, 1e-13, 0);
    }
    run_end(&r);
}

static void test_turning_forces_are_integrated_by_the_engines_rule(void **state)
{
    (void)state;
    for (int k = 0; k < PL_POSITION_RULE_COUNT; ++k) {
        turning_force((pl_position_rule)k, true);
        turning_force((pl_position_rule)k, false);
    }
}

static void test_free_fall_has_only_the_force_balance(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    r.scene.bodies[BOX].position[2] = 9;
    run_begin(&r);
    for (int n = 0; n < 8; ++n) {
        r.state[BOX].velocity[2] -= g * H;
        r.state[BOX].position[2] += H * r.state[BOX].velocity[2];
        assert_int_equal(run_step_with(&r, NULL, 0), PL_ENDING_OK);
    }
    (void)run_finish(&r);
    assert_close(run_value(&r, PL_METRIC_FORCE_BALANCE), 0, 1e-14, 0);
    for (int i = 1; i < COUNT; ++i) {
        assert_absent_metric(&r, of_force[i]);
    }
    run_end(&r);
}

static void test_engine_without_contact_reports_has_no_force_metrics(void **state)
{
    (void)state;
    run r;
    begin_box(&r, 0, 0, 0);
    pl_contact c[CORNERS];
    corners(c, 0, 0, 0, 0, 1);
    (void)run_step_with(&r, c, CORNERS);
    (void)run_step_with(&r, NULL, -1);
    (void)run_step_with(&r, c, CORNERS);
    (void)run_finish(&r);
    for (int i = 0; i < COUNT; ++i) {
        assert_absent_metric(&r, of_force[i]);
    }
    run_end(&r);
}

static void test_without_gravity_only_the_contact_law_is_measured(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    r.scene.gravity[2] = 0;
    r.scene.bodies[BOX].velocity[2] = -1;
    run_begin(&r);
    r.state[BOX].velocity[2] = 0.25;
    finish_on_corners(&r, 0, 0, 1.25 / (g * H));
    assert_absent_metric(&r, PL_METRIC_FORCE_BALANCE);
    assert_absent_metric(&r, PL_METRIC_CONE_VIOLATION);
    assert_absent_metric(&r, PL_METRIC_FRICTION_EFFECTIVE);
    assert_close(run_value(&r, PL_METRIC_SIGNORINI), 1.25 * mass / 4 * 0.25 / H, 1e-13, 0);
    assert_true(run_value(&r, PL_METRIC_NATURAL_MAP) > 0);
    run_end(&r);
}

static void test_without_friction_there_are_no_cone_metrics(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    r.scene.materials[0].friction = 0;
    r.scene.bodies[BOX].velocity[0] = 3;
    run_begin(&r);
    finish_on_corners(&r, 0, 0, 1);
    assert_absent_metric(&r, PL_METRIC_CONE_VIOLATION);
    assert_absent_metric(&r, PL_METRIC_FRICTION_EFFECTIVE);
    assert_close(run_value(&r, PL_METRIC_NATURAL_MAP), 0, 0, 0);
    run_end(&r);
}

/* One contact under the centre of a ball of radius 1/2: 1/rho = (3 + 2 r^2 m/I) / 3 m = 8 / 3 m. */
typedef struct ball_case {
    double friction, restitution, separation;
    double vx, vz; /* after the step */
    double rx, rz; /* in units of rho m/s */
} ball_case;

static void judge_ball(const ball_case *b, run *r)
{
    const double rho = 3 * mass / 8;
    prepare_ball(r, b->separation);
    r->scene.materials[0].friction = b->friction;
    r->scene.materials[0].restitution = b->restitution;
    run_begin(r);
    r->state[1].velocity[0] = b->vx;
    r->state[1].velocity[2] = b->vz;
    /* At the ball's own end of the gap, where the arm is its radius. */
    pl_contact c = on_floor(1, 0, 0, rho * b->rx, 0, rho * b->rz);
    c.point[2] = c.separation = b->separation;
    finish_with(r, &c, 1);
}

static void test_natural_map_and_signorini_of_one_contact(void **state)
{
    (void)state;
    const struct {
        ball_case ball;
        double natural_map, power; /* the latter in units of rho m^2/s^2 */
    } cases[] = {
        /* Without impulse: separating, approaching. */
        {{mu, 0, 0, 0.1, 0.2, 0, 0}, 0, 0},
        {{mu, 0, 0, 0, -0.3, 0, 0}, 0.3, 0},
        /* Pushed while separating, by more and by less than the impulse that stops it. */
        {{0, 0, 0, 0, 0.2, 0, 5}, 0.2, 1},
        {{0, 0, 0, 0, 0.2, 0, 0.1}, 0.1, 0.02},
        /* A negative normal impulse. */
        {{0, 0, 0, 0, 0, 0, -0.4}, 0.4, 0},
        /* Sticking. */
        {{1, 0, 0, 0, 0, 0.9, 1}, 0, 0},
        /* Slides without friction: r - rho u^ = (1 - s, -s) is within the cone; for s = 1 it is
         * outside, and its projection is (1/2, -1/2). */
        {{1, 0, 0, 0.25, 0, 0, 1}, 0.25 * 1.4142135623730951, 0},
        {{1, 0, 0, 1, 0, 0, 1}, 0.70710678118654757, 0},
        /* Slides with full friction. */
        {{1, 0, 0, 0.7, 0, -1, 1}, 0, 0},
        /* Outside the cone and at rest: the projection of (1, 2) is (3/2, 3/2). */
        {{1, 0, 0, 0, 0, 2, 1}, 0.70710678118654757, 0},
        /* A gap that stays open in the step; one that closes; one that is closed by an impulse. */
        {{mu, 0, 1.0 / 64, 0, -0.5, 0, 0}, 0, 0},
        {{mu, 0, 1.0 / 64, 0, -1.5, 0, 0}, 0.5, 0},
        {{mu, 0, 1.0 / 64, 0, -1, 0, 3}, 0, 0},
        /* Penetration requires no impulse. */
        {{mu, 0, -1.0 / 64, 0, 0, 0, 3}, 0, 0},
        {{0, 0, -1.0 / 64, 0, 0.5, 0, 3}, 0.5, 1.5},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        run r;
        judge_ball(&cases[i].ball, &r);
        print_message("    case %zu\n", i);
        assert_close(run_value(&r, PL_METRIC_NATURAL_MAP), cases[i].natural_map, 1e-14, 0);
        assert_close(run_value(&r, PL_METRIC_SIGNORINI), cases[i].power * 3 * mass / 8 / H, 1e-12,
                     0);
        run_end(&r);
    }
}

static void test_bounce_has_no_contact_law_error(void **state)
{
    (void)state;
    run r;
    judge_ball(&(ball_case){mu, 0.5, 0, 0, 1, 0, 5}, &r);
    assert_absent_metric(&r, PL_METRIC_SIGNORINI);
    assert_absent_metric(&r, PL_METRIC_NATURAL_MAP);
    run_end(&r);
}

/* A bar of 2 x 1/5 x 1/5 m lies along x and rotates about z by a right angle in the step. The one
 * contact is off its centre by 1/2 m along x, with its corner's arm before the step: 1/rho = 1/m +
 * (a_z^2/I_y + a_x^2/I_z + ...)/3. An impulse too many that is less than what stops the bar counts
 * as r/rho. */
static void test_mobility_is_that_before_the_step(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    run_add_body(&r, "bar", pl_shape_box(1, 0.1, 0.1), false, 0, 0.1);
    r.scene.materials[0].friction = 0;
    run_begin(&r);
    r.state[1].orientation[0] = r.state[1].orientation[3] = sqrt(0.5);
    r.state[1].velocity[2] = 1;
    const double impulse = 1e-3, *inertia = r.scene.bodies[1].inertia, ax = 0.5, az = -0.1;
    pl_contact c = on_floor(1, ax, 0, 0, 0, impulse);
    finish_with(&r, &c, 1);
    double turning = az * az / inertia[0] + (ax * ax + az * az) / inertia[1] + ax * ax / inertia[2];
    assert_close(run_value(&r, PL_METRIC_NATURAL_MAP), impulse * (1 / mass + turning / 3), 1e-15,
                 0);
    run_end(&r);
}

/* The velocity that counts is that of the contact point. */
static void test_rolling_ball_does_not_slide(void **state)
{
    (void)state;
    run r;
    prepare_ball(&r, 0);
    r.scene.bodies[1].velocity[0] = 3;
    r.scene.bodies[1].angular_velocity[1] = 6;
    run_begin(&r);
    pl_contact c = on_floor(1, 0, 0, 0, 0, mass * g * H);
    finish_with(&r, &c, 1);
    assert_absent_metric(&r, PL_METRIC_FRICTION_EFFECTIVE);
    assert_close(run_value(&r, PL_METRIC_NATURAL_MAP), 0, 0, 0);
    run_end(&r);
}

/* A box slides for two steps. In the second, the contact `index` is replaced. */
static void slide_into(run *r, int index, const pl_contact *replacement)
{
    begin_box(r, 3, 0, 0);
    pl_contact c[CORNERS];
    corners(c, 0, 0, -mu, 0, 1);
    (void)run_step_with(r, c, CORNERS);
    c[index] = *replacement;
    finish_with(r, c, CORNERS);
}

static void assert_failed_at_step_2(const run *r, pl_metric_id id)
{
    assert_int_equal(run_metric(r, id)->state, PL_METRIC_FAILED);
    assert_contains(run_metric(r, id)->reason, "step 2");
}

static void test_nan_impulses_fail_the_force_metrics(void **state)
{
    (void)state;
    run r;
    pl_contact c[CORNERS];
    corners(c, 0, 0, -mu, 0, 1);
    c[2].impulse[0] = nan("");
    slide_into(&r, 2, &c[2]);
    assert_failed_at_step_2(&r, PL_METRIC_FORCE_BALANCE);
    assert_failed_at_step_2(&r, PL_METRIC_SIGNORINI);
    assert_failed_at_step_2(&r, PL_METRIC_NATURAL_MAP);
    run_end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sliding_box_by_coulombs_law_has_no_error),
        cmocka_unit_test(test_friction_pyramid_violates_the_cone_at_its_corners),
        cmocka_unit_test(test_friction_effective_is_the_mean_over_contacts),
        cmocka_unit_test(test_sticking_or_creeping_contact_has_no_effective_friction),
        cmocka_unit_test(test_friction_of_unloaded_contacts_is_not_measured),
        cmocka_unit_test(test_load_is_in_units_of_the_lighter_weight),
        cmocka_unit_test(test_force_balance_is_in_units_of_weight),
        cmocka_unit_test(test_motion_without_a_force_is_unbalanced),
        cmocka_unit_test(test_a_contact_acts_on_both_bodies),
        cmocka_unit_test(test_turning_forces_are_integrated_by_the_engines_rule),
        cmocka_unit_test(test_free_fall_has_only_the_force_balance),
        cmocka_unit_test(test_engine_without_contact_reports_has_no_force_metrics),
        cmocka_unit_test(test_without_gravity_only_the_contact_law_is_measured),
        cmocka_unit_test(test_without_friction_there_are_no_cone_metrics),
        cmocka_unit_test(test_natural_map_and_signorini_of_one_contact),
        cmocka_unit_test(test_bounce_has_no_contact_law_error),
        cmocka_unit_test(test_mobility_is_that_before_the_step),
        cmocka_unit_test(test_rolling_ball_does_not_slide),
        cmocka_unit_test(test_nan_impulses_fail_the_force_metrics),
    };
    return cmocka_run_group_tests_name("contact force", tests, NULL, NULL);
}
