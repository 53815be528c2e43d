/* What the referee makes of contact forces that the test makes up: closed forms. */
#include "referee/metrics/contact_force.h"

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

static void assert_absent_metric(const run *r, pl_metric_id id)
{
    if (run_metric(r, id)->state != PL_METRIC_ABSENT) {
        fail_msg("%s is there: %g %s", pl_metric_table[id].name, run_metric(r, id)->value,
                 run_metric(r, id)->reason);
    }
}

/* Slides by v' = v - mu g h, as Coulomb has it. */
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
        assert_int_equal(run_step_with(r, c, CORNERS), PL_VERDICT_OK);
    }
    (void)run_finish(r);
}

static void test_a_box_that_slides_by_coulombs_law_has_that_friction_and_no_error(void **state)
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

static void test_a_pyramids_corner_leaves_the_cone_by_root_two_less_one(void **state)
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
    (void)run_step_with(&r, c, CORNERS);
    (void)run_finish(&r);
    assert_close(run_value(&r, PL_METRIC_FRICTION_EFFECTIVE), 0.15, 1e-15, 0);
    run_end(&r);
}

static void test_a_contact_that_holds_or_creeps_has_no_effective_friction(void **state)
{
    (void)state;
    const double speeds[] = {0, 0.99 * H * 9.81, 1.01 * H * 9.81};
    for (int i = 0; i < 3; ++i) {
        run r;
        begin_box(&r, speeds[i], 0, 0);
        pl_contact c[CORNERS];
        corners(c, 0, 0, -0.3, 0, 1);
        (void)run_step_with(&r, c, CORNERS);
        (void)run_finish(&r);
        assert_close(run_value(&r, PL_METRIC_CONE_VIOLATION), 0, 0, 0);
        if (i < 2) {
            assert_absent_metric(&r, PL_METRIC_FRICTION_EFFECTIVE);
        } else {
            assert_close(run_value(&r, PL_METRIC_FRICTION_EFFECTIVE), 0.3, 1e-15, 0);
        }
        run_end(&r);
    }
}

static void test_what_bears_next_to_nothing_says_nothing_of_friction(void **state)
{
    (void)state;
    run r;
    begin_box(&r, 3, 0, 0);
    pl_contact c[2] = {on_floor(BOX, 0.5, 0, -mu * mass * g * H, 0, mass * g * H),
                       on_floor(BOX, -0.5, 0, -1e-2 * mass * g * H, 0, 0.9e-3 * mass * g * H)};
    (void)run_step_with(&r, c, 2);
    (void)run_finish(&r);
    assert_close(run_value(&r, PL_METRIC_CONE_VIOLATION), 0, 1e-15, 0);
    assert_close(run_value(&r, PL_METRIC_FRICTION_EFFECTIVE), mu, 1e-15, 0);
    /* The law of contact is for all: it sees that the cone was left. */
    assert_true(run_value(&r, PL_METRIC_NATURAL_MAP) > 1e-3);
    run_end(&r);
}

static void test_force_balance_is_what_is_missing_in_units_of_the_weight(void **state)
{
    (void)state;
    run r;
    begin_box(&r, 0, 0, 0);
    for (int n = 1; n <= 9; ++n) {
        pl_contact c[CORNERS];
        corners(c, 0, 0, n == 4 ? 0.3 : 0, n == 6 ? -0.1 : 0, n == 4 ? 0.6 : 1);
        assert_int_equal(run_step_with(&r, c, CORNERS), PL_VERDICT_OK);
    }
    (void)run_finish(&r);
    assert_close(run_value(&r, PL_METRIC_FORCE_BALANCE), 0.5, 1e-15, 0);
    assert_int_equal(run_metric(&r, PL_METRIC_FORCE_BALANCE)->worst_step, 4);
    assert_close(run_metric(&r, PL_METRIC_FORCE_BALANCE)->p50, 0, 1e-15, 0);
    run_end(&r);
}

static void test_a_motion_that_no_force_made_is_unbalanced(void **state)
{
    (void)state;
    run r;
    begin_box(&r, 0, 0, 0);
    pl_contact c[CORNERS];
    corners(c, 0, 0, 0, 0, 1);
    r.state[BOX].velocity[1] = 0.25 * g * H;
    (void)run_step_with(&r, c, CORNERS);
    (void)run_finish(&r);
    assert_close(run_value(&r, PL_METRIC_FORCE_BALANCE), 0.25, 1e-15, 0);
    run_end(&r);
}

/* Two balls on each other: what presses the lower one down bears the upper one. */
static void test_a_contact_acts_on_both_bodies(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    run_add_body(&r, "low", pl_shape_sphere(0.5), false, 0, 0.5);
    run_add_body(&r, "high", pl_shape_sphere(0.5), false, 0, 1.5);
    run_begin(&r);
    double weight = mass * g * H;
    pl_contact c[2] = {on_floor(1, 0, 0, 0, 0, 2 * weight), on_floor(2, 0, 0, 0, 0, weight)};
    c[1].body_a = 1;
    c[1].point[2] = 1;
    (void)run_step_with(&r, c, 2);
    c[1] = swapped(c[1]);
    (void)run_step_with(&r, c, 2);
    (void)run_finish(&r);
    assert_close(run_value(&r, PL_METRIC_FORCE_BALANCE), 0, 1e-15, 0);
    assert_close(run_value(&r, PL_METRIC_NATURAL_MAP), 0, 1e-15, 0);
    pl_vec up = pl_contact_force_between(c, 2, 1, 2, H);
    pl_vec down = pl_contact_force_between(c, 2, 2, 1, H);
    pl_vec ground = pl_contact_force_between(c, 2, FLOOR, 1, H);
    assert_close(up.z, mass * g, 1e-13, 0);
    assert_close(down.z, -mass * g, 1e-13, 0);
    assert_close(ground.z, 2 * mass * g, 1e-13, 0);
    assert_close(pl_contact_force_between(c, 2, FLOOR, 2, H).z, 0, 0, 0);
    run_end(&r);
}

/* A ball turns about z by 0.8 rad a step under a force in its own frame along x, by semi-implicit
 * Euler or a rule of second order; the impulse of the latter is F (sin, 1 - cos)/w. */
static void turning_force(pl_integrator integrator, bool rule_is_kept)
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
        assert_int_equal(run_step_with(&r, NULL, 0), PL_VERDICT_OK);
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

static void test_forces_count_as_the_engines_own_rule_has_them(void **state)
{
    (void)state;
    for (int k = 0; k < PL_INTEGRATOR_COUNT; ++k) {
        turning_force((pl_integrator)k, true);
        turning_force((pl_integrator)k, false);
    }
}

static void test_nothing_that_touches_leaves_a_balance_and_no_nan(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    r.scene.bodies[BOX].position[2] = 9;
    run_begin(&r);
    for (int n = 0; n < 8; ++n) {
        r.state[BOX].velocity[2] -= g * H;
        r.state[BOX].position[2] += H * r.state[BOX].velocity[2];
        assert_int_equal(run_step_with(&r, NULL, 0), PL_VERDICT_OK);
    }
    (void)run_finish(&r);
    assert_close(run_value(&r, PL_METRIC_FORCE_BALANCE), 0, 1e-14, 0);
    for (int i = 1; i < COUNT; ++i) {
        assert_absent_metric(&r, of_force[i]);
    }
    run_end(&r);
}

static void test_an_engine_that_reports_no_contacts_has_none_of_it(void **state)
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

static void test_without_gravity_only_the_law_of_contact_is_measured(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    r.scene.gravity[2] = 0;
    r.scene.bodies[BOX].velocity[2] = -1;
    run_begin(&r);
    r.state[BOX].velocity[2] = 0.25;
    pl_contact c[CORNERS];
    corners(c, 0, 0, 0, 0, 1.25 / (g * H));
    (void)run_step_with(&r, c, CORNERS);
    (void)run_finish(&r);
    assert_absent_metric(&r, PL_METRIC_FORCE_BALANCE);
    assert_absent_metric(&r, PL_METRIC_CONE_VIOLATION);
    assert_absent_metric(&r, PL_METRIC_FRICTION_EFFECTIVE);
    assert_close(run_value(&r, PL_METRIC_SIGNORINI), 1.25 * mass / 4 * 0.25 / H, 1e-13, 0);
    assert_true(run_value(&r, PL_METRIC_NATURAL_MAP) > 0);
    run_end(&r);
}

static void test_without_friction_there_is_no_cone_to_leave(void **state)
{
    (void)state;
    run r;
    run_prepare_box_on_floor(&r, 1);
    r.scene.materials[0].friction = 0;
    r.scene.bodies[BOX].velocity[0] = 3;
    run_begin(&r);
    pl_contact c[CORNERS];
    corners(c, 0, 0, 0, 0, 1);
    (void)run_step_with(&r, c, CORNERS);
    (void)run_finish(&r);
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
    run_prepare(r, 1);
    run_add_body(r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    run_add_body(r, "ball", pl_shape_sphere(0.5), false, 0, 0.5 + b->separation);
    r->scene.materials[0].friction = b->friction;
    r->scene.materials[0].restitution = b->restitution;
    run_begin(r);
    r->state[1].velocity[0] = b->vx;
    r->state[1].velocity[2] = b->vz;
    /* At the ball's own end of the gap, where the arm is its radius. */
    pl_contact c = on_floor(1, 0, 0, rho * b->rx, 0, rho * b->rz);
    c.point[2] = c.separation = b->separation;
    (void)run_step_with(r, &c, 1);
    (void)run_finish(r);
}

static void test_natural_map_and_signorini_of_one_contact(void **state)
{
    (void)state;
    const struct {
        ball_case ball;
        double natural_map, power; /* the latter in units of rho m^2/s^2 */
    } cases[] = {
        /* Open and parting; open and closing. */
        {{mu, 0, 0, 0.1, 0.2, 0, 0}, 0, 0},
        {{mu, 0, 0, 0, -0.3, 0, 0}, 0.3, 0},
        /* Pushed although it parts, by more and by less than would bring it back. */
        {{0, 0, 0, 0, 0.2, 0, 5}, 0.2, 1},
        {{0, 0, 0, 0, 0.2, 0, 0.1}, 0.1, 0.02},
        /* Pulled. */
        {{0, 0, 0, 0, 0, 0, -0.4}, 0.4, 0},
        /* Held. */
        {{1, 0, 0, 0, 0, 0.9, 1}, 0, 0},
        /* Slides and is not braked: r - rho u^ = (1 - s, -s), within the cone, and with s = 1 off
         * it, nearest to (1/2, -1/2). */
        {{1, 0, 0, 0.25, 0, 0, 1}, 0.25 * 1.4142135623730951, 0},
        {{1, 0, 0, 1, 0, 0, 1}, 0.70710678118654757, 0},
        /* Slides and is braked in full. */
        {{1, 0, 0, 0.7, 0, -1, 1}, 0, 0},
        /* Outside the cone and at rest: (1, 2) is nearest to (3/2, 3/2). */
        {{1, 0, 0, 0, 0, 2, 1}, 0.70710678118654757, 0},
        /* Open by more than it closes in the step; by less; and closed by an impulse. */
        {{mu, 0, 1.0 / 64, 0, -0.5, 0, 0}, 0, 0},
        {{mu, 0, 1.0 / 64, 0, -1.5, 0, 0}, 0.5, 0},
        {{mu, 0, 1.0 / 64, 0, -1, 0, 3}, 0, 0},
        /* Penetration asks for nothing. */
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

static void test_a_bounce_is_no_fault(void **state)
{
    (void)state;
    run r;
    judge_ball(&(ball_case){mu, 0.5, 0, 0, 1, 0, 5}, &r);
    assert_absent_metric(&r, PL_METRIC_SIGNORINI);
    assert_absent_metric(&r, PL_METRIC_NATURAL_MAP);
    run_end(&r);
}

/* The velocity of the point is meant: a ball that rolls does not slide. */
static void test_a_rolling_ball_does_not_slide(void **state)
{
    (void)state;
    run r;
    run_prepare(&r, 1);
    run_add_body(&r, "floor", pl_shape_plane(0, 0, 1, 0), true, 0, 0);
    run_add_body(&r, "ball", pl_shape_sphere(0.5), false, 0, 0.5);
    r.scene.bodies[1].velocity[0] = 3;
    r.scene.bodies[1].angular_velocity[1] = 6;
    run_begin(&r);
    pl_contact c = on_floor(1, 0, 0, 0, 0, mass * g * H);
    (void)run_step_with(&r, &c, 1);
    (void)run_finish(&r);
    assert_absent_metric(&r, PL_METRIC_FRICTION_EFFECTIVE);
    assert_close(run_value(&r, PL_METRIC_NATURAL_MAP), 0, 0, 0);
    run_end(&r);
}

static void test_numbers_that_are_none_are_told(void **state)
{
    (void)state;
    run r;
    begin_box(&r, 3, 0, 0);
    pl_contact c[CORNERS];
    corners(c, 0, 0, -mu, 0, 1);
    (void)run_step_with(&r, c, CORNERS);
    c[2].impulse[0] = nan("");
    (void)run_step_with(&r, c, CORNERS);
    (void)run_finish(&r);
    const pl_metric_id told[] = {PL_METRIC_FORCE_BALANCE, PL_METRIC_SIGNORINI,
                                 PL_METRIC_NATURAL_MAP};
    for (size_t i = 0; i < sizeof told / sizeof told[0]; ++i) {
        assert_int_equal(run_metric(&r, told[i])->state, PL_METRIC_FAILED);
        assert_contains(run_metric(&r, told[i])->reason, "step 2");
    }
    run_end(&r);
}

static void test_contacts_of_no_body_void_all(void **state)
{
    (void)state;
    run r;
    begin_box(&r, 3, 0, 0);
    pl_contact c[CORNERS];
    corners(c, 0, 0, -mu, 0, 1);
    (void)run_step_with(&r, c, CORNERS);
    c[1].body_a = 7;
    (void)run_step_with(&r, c, CORNERS);
    (void)run_finish(&r);
    for (int i = 0; i < COUNT; ++i) {
        assert_int_equal(run_metric(&r, of_force[i])->state, PL_METRIC_FAILED);
        assert_contains(run_metric(&r, of_force[i])->reason, "step 2");
    }
    run_end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_box_that_slides_by_coulombs_law_has_that_friction_and_no_error),
        cmocka_unit_test(test_a_pyramids_corner_leaves_the_cone_by_root_two_less_one),
        cmocka_unit_test(test_friction_effective_is_the_mean_over_contacts),
        cmocka_unit_test(test_a_contact_that_holds_or_creeps_has_no_effective_friction),
        cmocka_unit_test(test_what_bears_next_to_nothing_says_nothing_of_friction),
        cmocka_unit_test(test_force_balance_is_what_is_missing_in_units_of_the_weight),
        cmocka_unit_test(test_a_motion_that_no_force_made_is_unbalanced),
        cmocka_unit_test(test_a_contact_acts_on_both_bodies),
        cmocka_unit_test(test_forces_count_as_the_engines_own_rule_has_them),
        cmocka_unit_test(test_nothing_that_touches_leaves_a_balance_and_no_nan),
        cmocka_unit_test(test_an_engine_that_reports_no_contacts_has_none_of_it),
        cmocka_unit_test(test_without_gravity_only_the_law_of_contact_is_measured),
        cmocka_unit_test(test_without_friction_there_is_no_cone_to_leave),
        cmocka_unit_test(test_natural_map_and_signorini_of_one_contact),
        cmocka_unit_test(test_a_bounce_is_no_fault),
        cmocka_unit_test(test_a_rolling_ball_does_not_slide),
        cmocka_unit_test(test_numbers_that_are_none_are_told),
        cmocka_unit_test(test_contacts_of_no_body_void_all),
    };
    return cmocka_run_group_tests_name("contact force", tests, NULL, NULL);
}
