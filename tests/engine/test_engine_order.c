/* Of what order free motion is: errors against closed forms, quadrature, or Runge and Kutta's
 * fourth order at a step of 1e-5 s. */
#include "check.h"
#include "motion_order.h"
#include "motion_vectors.h"

#include <stdio.h>

/* ---- Flying bodies ---- */

/* A single body under gravity and a constant force in its own axes. */
typedef struct flight {
    pe_vec3 inertia, gravity, force, offset; /* force and offset: body's axes */
    double mass;
    pe_body_state start;
} flight;

static pe_body_state derivative(const flight *f, const pe_body_state *s)
{
    pe_quat q = s->orientation;
    pe_vec3 w = turn(inverse(q), s->angular_velocity), momentum = by_components(f->inertia, w);
    pe_vec3 torque = add(cross(f->offset, f->force), -1, cross(w, momentum)),
            a = {torque.x / f->inertia.x, torque.y / f->inertia.y, torque.z / f->inertia.z};
    pe_vec3 v = s->angular_velocity;
    pe_quat spin = times((pe_quat){0, 0.5 * v.x, 0.5 * v.y, 0.5 * v.z}, q);
    /* (R w)' = R w' + w x R w, and the latter is 0. */
    return (pe_body_state){s->velocity, spin, add(f->gravity, 1 / f->mass, turn(q, f->force)),
                           turn(q, a)};
}

/* s + h d, component by component. */
static pe_body_state moved(const pe_body_state *s, double h, const pe_body_state *d)
{
    pe_quat q = s->orientation, r = d->orientation;
    return (pe_body_state){add(s->position, h, d->position),
                           {q.w + h * r.w, q.x + h * r.x, q.y + h * r.y, q.z + h * r.z},
                           add(s->velocity, h, d->velocity),
                           add(s->angular_velocity, h, d->angular_velocity)};
}

static pe_body_state solve_ode(const flight *f, double seconds)
{
    enum { STEPS_A_SECOND = 20000 };
    const double h = 1.0 / STEPS_A_SECOND;
    pe_body_state s = f->start;
    for (int i = 0; i < seconds * STEPS_A_SECOND; ++i) {
        pe_body_state k1 = derivative(f, &s), at = moved(&s, 0.5 * h, &k1);
        pe_body_state k2 = derivative(f, &at);
        at = moved(&s, 0.5 * h, &k2);
        pe_body_state k3 = derivative(f, &at);
        at = moved(&s, h, &k3);
        pe_body_state k4 = derivative(f, &at);
        s = moved(&s, h / 6, &k1);
        s = moved(&s, h / 3, &k2);
        s = moved(&s, h / 3, &k3);
        s = moved(&s, h / 6, &k4);
        pe_quat q = s.orientation;
        double scale = 1 / sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
        s.orientation = (pe_quat){q.w * scale, q.x * scale, q.y * scale, q.z * scale};
    }
    return s;
}

static pe_body_state fly(const flight *f, double h, int steps)
{
    pe_world *world = accurate_world(f->gravity);
    pe_body_def def = box_def(0.5, 0.5, 0.5, f->start.position);
    def.mass = f->mass;
    def.inertia = f->inertia;
    def.orientation = f->start.orientation;
    def.velocity = f->start.velocity;
    def.angular_velocity = f->start.angular_velocity;
    pe_body_id body = add_body(world, &def);
    for (int i = 0; i < steps; ++i) {
        if (dot(f->force, f->force) > 0) {
            assert_int_equal(
                pe_body_apply_force(world, body, f->force, f->offset, PE_FRAME_BODY, NULL), PE_OK);
        }
        step(world, h);
    }
    pe_body_state s = state_of(world, body);
    pe_world_destroy(world);
    return s;
}

/* Position, orientation and both velocities after a second against the ODE. */
static void fly_in_order(const char *name, const flight *f, double least)
{
    static const char *const parts[] = {"position", "orientation", "velocity", "angular velocity"};
    double error[4][STEP_SIZES];
    pe_body_state exact = solve_ode(f, 1);
    for (int k = 0; k < STEP_SIZES; ++k) {
        pe_body_state s = fly(f, order_step(k), 60 << k);
        error[0][k] = distance(s.position, exact.position);
        error[1][k] = angle_between(s.orientation, exact.orientation);
        error[2][k] = distance(s.velocity, exact.velocity);
        error[3][k] = distance(s.angular_velocity, exact.angular_velocity);
    }
    for (int i = 0; i < 4; ++i) {
        char text[80];
        snprintf(text, sizeof text, "%s: %s", name, parts[i]);
        assert_order(text, error[i], least);
    }
}

static flight flight_of(pe_vec3 gravity)
{
    return (flight){.mass = 2,
                    .inertia = {0.3, 0.5, 0.7},
                    .gravity = gravity,
                    .start = {.position = {1, 2, 3},
                              .orientation = {0.5, -0.5, 0.5, 0.5},
                              .velocity = {4, 5, 6}}};
}

static void test_projectile_is_exact(void **state)
{
    (void)state;
    flight f = flight_of((pe_vec3){0.5, 0, -GRAVITY});
    fly_in_order("projectile", &f, HUGE_VAL);
}

static void test_projectile_with_spin_is_second_order(void **state)
{
    (void)state;
    flight f = flight_of((pe_vec3){0.5, 0, -GRAVITY});
    f.start.angular_velocity = (pe_vec3){1, -2, 3};
    fly_in_order("spinning projectile", &f, 1.9);
}

/* About a principal axis nothing changes, and the angle is exact. */
static void test_steady_spin_is_exact(void **state)
{
    (void)state;
    flight f = flight_of((pe_vec3){0, 0, -GRAVITY});
    f.start.orientation = (pe_quat){.w = 1};
    f.start.angular_velocity = (pe_vec3){0, 7, 0};
    fly_in_order("spin about a principal axis", &f, HUGE_VAL);
}

/* Thrust F along the body's x, at an offset across it: angle a t^2/2 about y, and the velocity is
 * F/m times Fresnel's integrals, here by Simpson's rule. */
static pe_vec3 rocket_position(double acceleration, double angular, double seconds)
{
    enum { PANELS = 20000 };
    const double h = seconds / PANELS;
    double x = 0, z = 0; /* x(T) = integral of (T - t) a(t) */
    for (int i = 0; i <= PANELS; ++i) {
        double t = i * h, weight = i == 0 || i == PANELS ? 1 : i % 2 == 1 ? 4 : 2;
        double angle = 0.5 * angular * t * t;
        x += weight * (seconds - t) * cos(angle);
        z -= weight * (seconds - t) * sin(angle);
    }
    return (pe_vec3){acceleration * x * h / 3, 0, acceleration * z * h / 3};
}

static void test_off_centre_rocket_converges_to_fresnel_integrals(void **state)
{
    (void)state;
    flight f = {.mass = 2,
                .inertia = {0.3, 0.5, 0.7},
                .force = {20, 0, 0},
                .offset = {-0.4, 0, 0.1},
                .start = {.orientation = {.w = 1}}};
    double angular = 0.1 * 20 / 0.5, error[STEP_SIZES], turned[STEP_SIZES];
    pe_vec3 exact = rocket_position(10, angular, 2);
    for (int k = 0; k < STEP_SIZES; ++k) {
        pe_body_state s = fly(&f, order_step(k), 120 << k);
        error[k] = distance(s.position, exact);
        turned[k] = angle_between(s.orientation, rotation_of((pe_vec3){0, 0.5 * angular * 4, 0}));
    }
    assert_order("rocket in the plane: position", error, 3.8);
    assert_order("rocket in the plane: angle", turned, 1.9);
}

static void test_rocket_in_space_is_second_order(void **state)
{
    (void)state;
    flight f = flight_of((pe_vec3){0, 0, -GRAVITY});
    f.force = (pe_vec3){3, 10, 1};
    f.offset = (pe_vec3){0.1, 0, -0.2};
    f.start.angular_velocity = (pe_vec3){2, 1, -1};
    fly_in_order("rocket in space", &f, 1.9);
}

/* ---- Free rotation ---- */

static const pe_vec3 LONG_BOX = {97.0 / 120, 82.0 / 120, 17.0 / 120}; /* of 1 x 4 x 9 */
/* s, 4 K(m) / p by the elliptic integral (Landau and Lifshitz, Mechanics, section 37). */
static const double FLIP_PERIOD = 6.056844158014422;

/* Time from one upward crossing of w_y in the body's axes to the next. */
static double flip_period(double h)
{
    pe_world *world = accurate_world((pe_vec3){0, 0, 0});
    pe_body_def def = box_def(0.5, 2, 4.5, (pe_vec3){0, 0, 0});
    def.inertia = LONG_BOX;
    def.angular_velocity = (pe_vec3){0.1, 5, 0.1};
    pe_body_id body = add_body(world, &def);
    double crossing[3] = {0}, before = 5;
    int found = 0;
    for (int n = 1; found < 3 && n * h < 12; ++n) {
        step(world, h);
        pe_body_state s = state_of(world, body);
        double now = turn(inverse(s.orientation), s.angular_velocity).y;
        if ((before > 0) != (now > 0)) {
            crossing[found++] = h * (n - 1 + before / (before - now));
        }
        before = now;
    }
    assert_int_equal(found, 3);
    pe_world_destroy(world);
    return crossing[2] - crossing[0];
}

static void test_period_of_the_tumbling_box_is_fourth_order(void **state)
{
    (void)state;
    double error[STEP_SIZES];
    for (int k = 0; k < STEP_SIZES; ++k) {
        error[k] = fabs(flip_period(order_step(k)) - FLIP_PERIOD);
    }
    assert_order("tumbling 1 x 4 x 9 box: period", error, 3.8);
}

static void test_tumbling_box_is_fourth_order(void **state)
{
    (void)state;
    flight f = {.mass = 1,
                .inertia = LONG_BOX,
                .start = {.orientation = {.w = 1}, .angular_velocity = {0.1, 5, 0.1}}};
    fly_in_order("tumbling 1 x 4 x 9 box", &f, 3.9);
}

static pe_vec3 momentum_of(const pe_body_state *s, pe_vec3 inertia)
{
    pe_vec3 w = turn(inverse(s->orientation), s->angular_velocity);
    return turn(s->orientation, by_components(inertia, w));
}

static double spin_energy(const pe_body_state *s, pe_vec3 inertia)
{
    return 0.5 * dot(s->angular_velocity, momentum_of(s, inertia));
}

/* Whether it does, and energy too: of I w' = exp(-h m) I w, m = (w + w')/2 is the axis, so that
 * m . I (w' - w) = 0, half of which is the change of energy. What an iteration cut short leaves
 * shows in the energy alone. */
static bool keeps_momentum(double turn_a_step, pe_vec3 inertia)
{
    enum { STEPS = 10000 };
    const double h = 1.0 / 60;
    pe_world *world = accurate_world((pe_vec3){0, 0, -GRAVITY});
    pe_body_def def = box_def(0.5, 2, 4.5, (pe_vec3){0, 0, 0});
    def.inertia = inertia;
    def.orientation = (pe_quat){0.5, -0.5, 0.5, 0.5};
    pe_vec3 direction = {0.36, 0.48, 0.8};
    def.angular_velocity = add((pe_vec3){0, 0, 0}, turn_a_step / h, direction);
    pe_body_id body = add_body(world, &def);
    pe_body_state s = state_of(world, body);
    pe_vec3 momentum = momentum_of(&s, inertia);
    double energy = spin_energy(&s, inertia), lost = 0, off[2] = {0};
    for (int i = 0; i < STEPS; ++i) {
        step(world, h);
        s = state_of(world, body);
        lost = fmax(lost, distance(momentum_of(&s, inertia), momentum) / length(momentum));
        double *most = &off[i >= STEPS / 2];
        *most = fmax(*most, fabs(spin_energy(&s, inertia) / energy - 1));
    }
    print_message("h |w| = %g, I = (%g, %g, %g): momentum off by %.1e, energy by %.1e, then %.1e\n",
                  turn_a_step, inertia.x, inertia.y, inertia.z, lost, off[0], off[1]);
    pe_world_destroy(world);
    return lost <= 1e-12 && off[0] <= 1e-10 && off[1] <= 1e-10;
}

static void test_free_rotation_keeps_momentum_and_energy_to_rounding(void **state)
{
    (void)state;
    static const double turns[] = {0.01, 0.1, 0.5, 1, 2};
    static const pe_vec3 inertias[] = {{0.80833, 0.68333, 0.141667}, {0.3, 0.5, 0.7}, {1, 1, 0.1}};
    bool kept = true;
    for (int i = 0; i < 5; ++i) {
        for (int j = 0; j < 3; ++j) {
            kept &= keeps_momentum(turns[i], inertias[j]);
        }
    }
    assert_true(kept);
}

/* ---- The heavy top ---- */

/* A symmetric top at its pivot: a body with the inertia about the pivot, no gravity, and its torque
 * l a x (0, 0, -m g) as a couple of world forces. The engine holds them over the step, so that the
 * caller takes the axis a where it will be half a step on. Steady precession at the rate P and the
 * angle c from the vertical: (I1 cos c) P^2 - I3 w3 P + m g l = 0, and the axis is that of the
 * start turned by P t about z. */
static double top_error(double h, double seconds)
{
    const double i1 = 0.5, i3 = 0.3, weight = 2 * GRAVITY, arm = 0.4, rate = 1.5, tilt = 0.6;
    const double w3 = (i1 * cos(tilt) * rate * rate + weight * arm) / (i3 * rate);
    pe_world *world = accurate_world((pe_vec3){0, 0, 0});
    pe_body_def def = box_def(0.5, 0.5, 0.5, (pe_vec3){0, 0, 0});
    def.mass = 2;
    def.inertia = (pe_vec3){i1, i1, i3};
    def.orientation = rotation_of((pe_vec3){0, tilt, 0});
    pe_vec3 axis = {sin(tilt), 0, cos(tilt)}, up = {0, 0, 1};
    /* w3 along the axis; across it the precession's own part. */
    def.angular_velocity = add(add((pe_vec3){0, 0, 0}, w3 - rate * cos(tilt), axis), rate, up);
    pe_body_id body = add_body(world, &def);
    for (int i = 0; i < (int)(seconds / h + 0.5); ++i) {
        pe_body_state s = state_of(world, body);
        pe_quat half = rotation_of(add((pe_vec3){0, 0, 0}, 0.5 * h, s.angular_velocity));
        pe_vec3 at = turn(half, turn(s.orientation, (pe_vec3){0, 0, arm})), none = {0, 0, 0};
        pe_vec3 pull = {0, 0, -weight}, hold = {0, 0, weight};
        assert_int_equal(pe_body_apply_force(world, body, pull, at, PE_FRAME_WORLD, NULL), PE_OK);
        assert_int_equal(pe_body_apply_force(world, body, hold, none, PE_FRAME_WORLD, NULL), PE_OK);
        step(world, h);
    }
    pe_body_state s = state_of(world, body);
    pe_vec3 found = turn(s.orientation, up);
    double angle = rate * seconds;
    pe_vec3 exact = {sin(tilt) * cos(angle), sin(tilt) * sin(angle), cos(tilt)};
    pe_world_destroy(world);
    return distance(found, exact);
}

static void test_heavy_top_precesses_steadily_in_second_order(void **state)
{
    (void)state;
    double error[STEP_SIZES];
    for (int k = 0; k < STEP_SIZES; ++k) {
        error[k] = top_error(order_step(k), 4);
    }
    assert_order("heavy top: axis after 4 s", error, 1.9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_projectile_is_exact),
        cmocka_unit_test(test_projectile_with_spin_is_second_order),
        cmocka_unit_test(test_steady_spin_is_exact),
        cmocka_unit_test(test_off_centre_rocket_converges_to_fresnel_integrals),
        cmocka_unit_test(test_rocket_in_space_is_second_order),
        cmocka_unit_test(test_period_of_the_tumbling_box_is_fourth_order),
        cmocka_unit_test(test_tumbling_box_is_fourth_order),
        cmocka_unit_test(test_free_rotation_keeps_momentum_and_energy_to_rounding),
        cmocka_unit_test(test_heavy_top_precesses_steadily_in_second_order),
    };
    return cmocka_run_group_tests_name("engine_order", tests, NULL, NULL);
}
