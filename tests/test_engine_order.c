/* Of what order the engine's motion is, by its public interface alone: errors at h = 1/60 .. 1/480
 * against closed forms, quadrature, or Runge and Kutta's fourth order at a step of 1e-5 s. */
#include "check.h"
#include "world_for_tests.h"

#include <math.h>
#include <stdio.h>

enum { STEP_SIZES = 4 };
static const double G = 9.81;
static const double EXACT = 1e-10; /* what counts as no error, in m or rad */

/* ---- Small vectors -----------------------------------------------------------------------------
 */

static pe_vec3 add(pe_vec3 a, double s, pe_vec3 b)
{
    return (pe_vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static pe_vec3 cross(pe_vec3 a, pe_vec3 b)
{
    return (pe_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static double dot(pe_vec3 a, pe_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static double length(pe_vec3 a)
{
    return sqrt(dot(a, a));
}

static double distance(pe_vec3 a, pe_vec3 b)
{
    return length(add(a, -1, b));
}

static pe_vec3 by_components(pe_vec3 a, pe_vec3 b)
{
    return (pe_vec3){a.x * b.x, a.y * b.y, a.z * b.z};
}

static pe_quat times(pe_quat a, pe_quat b)
{
    return (pe_quat){a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
                     a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                     a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                     a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

static pe_quat inverse(pe_quat q)
{
    return (pe_quat){q.w, -q.x, -q.y, -q.z};
}

/* q v q^-1: from the body's axes to the world's. */
static pe_vec3 turn(pe_quat q, pe_vec3 v)
{
    pe_quat r = times(times(q, (pe_quat){0, v.x, v.y, v.z}), inverse(q));
    return (pe_vec3){r.x, r.y, r.z};
}

static pe_quat rotation_of(pe_vec3 v)
{
    double angle = length(v), s = angle > 0 ? sin(0.5 * angle) / angle : 0.5;
    return (pe_quat){cos(0.5 * angle), s * v.x, s * v.y, s * v.z};
}

/* The angle between two orientations. */
static double angle_between(pe_quat a, pe_quat b)
{
    pe_quat d = times(inverse(a), b);
    return 2 * atan2(sqrt(d.x * d.x + d.y * d.y + d.z * d.z), fabs(d.w));
}

/* ---- Orders ------------------------------------------------------------------------------------
 */

static double step_size(int k)
{
    return 1.0 / (60 << k);
}

/* Prints the errors and the order between neighbours, and returns that from the first to the last;
 * infinite where there is no error. */
static double order_of(const char *name, const double error[STEP_SIZES])
{
    double most = 0;
    for (int k = 0; k < STEP_SIZES; ++k) {
        most = fmax(most, error[k]);
    }
    if (most < EXACT) {
        print_message("%-44s exact: %.1e at most\n", name, most);
        return HUGE_VAL;
    }
    double order = log2(error[0] / error[STEP_SIZES - 1]) / (STEP_SIZES - 1);
    print_message("%-44s order %.3f: errors", name, order);
    for (int k = 0; k < STEP_SIZES; ++k) {
        print_message(" %.3e", error[k]);
    }
    print_message(", orders");
    for (int k = 0; k + 1 < STEP_SIZES; ++k) {
        print_message(" %.2f", log2(error[k] / error[k + 1]));
    }
    print_message("\n");
    return order;
}

static void assert_order(const char *name, const double error[STEP_SIZES], double least)
{
    double order = order_of(name, error);
    if (!(order >= least)) {
        fail_msg("%s: of order %.3f, expected at least %.2f", name, order, least);
    }
}

static pe_world *accurate_world(pe_vec3 gravity)
{
    pe_world_def def = pe_world_def_default();
    def.profile = PE_PROFILE_ACCURATE;
    def.gravity = gravity;
    def.restitution_threshold = 0;
    return make_world(&def);
}

/* Also of a step of a scene without contacts. */
static void step_times(pe_world *world, double h, int count)
{
    for (int i = 0; i < count; ++i) {
        step(world, h);
    }
}

/* ---- Flying bodies -----------------------------------------------------------------------------
 */

/* A body alone under gravity and a constant force in its own axes. */
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
        pe_body_state s = fly(f, step_size(k), 60 << k);
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
    flight f = flight_of((pe_vec3){0.5, 0, -G});
    fly_in_order("projectile", &f, HUGE_VAL);
}

static void test_projectile_with_spin_is_second_order(void **state)
{
    (void)state;
    flight f = flight_of((pe_vec3){0.5, 0, -G});
    f.start.angular_velocity = (pe_vec3){1, -2, 3};
    fly_in_order("spinning projectile", &f, 1.9);
}

/* About a principal axis nothing changes, and the angle is exact. */
static void test_steady_spin_is_exact(void **state)
{
    (void)state;
    flight f = flight_of((pe_vec3){0, 0, -G});
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

static void test_rocket_off_its_centre_follows_the_fresnel_integrals_in_second_order(void **state)
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
        pe_body_state s = fly(&f, step_size(k), 120 << k);
        error[k] = distance(s.position, exact);
        turned[k] = angle_between(s.orientation, rotation_of((pe_vec3){0, 0.5 * angular * 4, 0}));
    }
    assert_order("rocket in the plane: position", error, 1.9);
    assert_order("rocket in the plane: angle", turned, 1.9);
}

static void test_rocket_in_space_is_second_order(void **state)
{
    (void)state;
    flight f = flight_of((pe_vec3){0, 0, -G});
    f.force = (pe_vec3){3, 10, 1};
    f.offset = (pe_vec3){0.1, 0, -0.2};
    f.start.angular_velocity = (pe_vec3){2, 1, -1};
    fly_in_order("rocket in space", &f, 1.9);
}

/* ---- Free rotation -----------------------------------------------------------------------------
 */

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
        error[k] = fabs(flip_period(step_size(k)) - FLIP_PERIOD);
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
    pe_world *world = accurate_world((pe_vec3){0, 0, -G});
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

/* ---- The heavy top -----------------------------------------------------------------------------
 */

/* A symmetric top at its pivot: a body with the inertia about the pivot, no gravity, and its torque
 * l a x (0, 0, -m g) as a couple of world forces. The engine holds them over the step, so that the
 * caller takes the axis a where it will be half a step on. Steady precession at the rate P and the
 * angle c from the vertical: (I1 cos c) P^2 - I3 w3 P + m g l = 0, and the axis is that of the
 * start turned by P t about z. */
static double top_error(double h, double seconds)
{
    const double i1 = 0.5, i3 = 0.3, weight = 2 * G, arm = 0.4, rate = 1.5, tilt = 0.6;
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
        error[k] = top_error(step_size(k), 4);
    }
    assert_order("heavy top: axis after 4 s", error, 1.9);
}

/* ---- Contacts that last ------------------------------------------------------------------------
 */

typedef struct on_plane {
    pe_world *world;
    pe_body_id body;
} on_plane;

/* `gravity` holds the slope; the plane is z = 0. */
static on_plane put_on_plane(pe_vec3 gravity, double friction, double restitution, pe_body_def def)
{
    on_plane p = {.world = accurate_world(gravity)};
    def.material = add_material(p.world, friction, restitution);
    add_plane(p.world, (pe_vec3){0, 0, 1}, def.material);
    p.body = add_body(p.world, &def);
    return p;
}

static pe_vec3 slope_gravity(double angle)
{
    return (pe_vec3){G * sin(angle), 0, -G * cos(angle)};
}

static pe_body_def sphere_def(double radius, double height)
{
    pe_body_def def = pe_body_def_default();
    def.shape = (pe_shape){.kind = PE_SHAPE_SPHERE, .radius = radius};
    def.position = (pe_vec3){0, 0, height};
    return def;
}

static void test_a_sliding_block_is_exact_until_it_stops(void **state)
{
    (void)state;
    static const double slopes[] = {0, 0.2, 0.6};
    for (int i = 0; i < 3; ++i) {
        double error[STEP_SIZES], speed_error[STEP_SIZES], sunk = 0;
        double friction = 0.3, down = G * (sin(slopes[i]) - friction * cos(slopes[i]));
        for (int k = 0; k < STEP_SIZES; ++k) {
            double h = step_size(k);
            pe_body_def def = box_def(0.5, 0.5, 0.2, (pe_vec3){0, 0, 0.2});
            def.velocity = (pe_vec3){4, 0, 0};
            on_plane p = put_on_plane(slope_gravity(slopes[i]), friction, 0, def);
            step_times(p.world, h, 60 << k);
            pe_body_state s = state_of(p.world, p.body);
            error[k] = fabs(s.position.x - (4 + 0.5 * down));
            speed_error[k] = fabs(s.velocity.x - (4 + down));
            sunk = fmax(sunk, fabs(s.position.z - 0.2));
            pe_world_destroy(p.world);
        }
        char name[60];
        snprintf(name, sizeof name, "block sliding at %g rad: position", slopes[i]);
        order_of(name, error);
        order_of("  velocity", speed_error);
        for (int k = 0; k < STEP_SIZES; ++k) {
            assert_at_most(error[k], 1e-8);
            assert_at_most(speed_error[k], 1e-8);
        }
        assert_at_most(sunk, 1e-8);
    }
}

/* In the step in which friction ends after the part s of it, the mean velocity puts it
 * a s (h - s)/2 <= a h^2/8 too far, a = mu g, and all other steps are exact. */
static void assert_within_the_last_step(const char *name, const double error[STEP_SIZES],
                                        double deceleration)
{
    double size[STEP_SIZES];
    for (int k = 0; k < STEP_SIZES; ++k) {
        size[k] = fabs(error[k]);
    }
    order_of(name, size);
    for (int k = 0; k < STEP_SIZES; ++k) {
        double h = step_size(k);
        assert_at_most(error[k], deceleration * h * h / 8 + 1e-8);
        assert_at_most(-error[k], 1e-8);
    }
}

static void test_a_sliding_block_stops_where_it_should_but_for_h_squared(void **state)
{
    (void)state;
    static const double speeds[] = {2, 3, 3.7};
    for (int i = 0; i < 3; ++i) {
        double error[STEP_SIZES], v = speeds[i], friction = 0.4;
        for (int k = 0; k < STEP_SIZES; ++k) {
            pe_body_def def = box_def(0.5, 0.5, 0.2, (pe_vec3){0, 0, 0.2});
            def.velocity = (pe_vec3){v, 0, 0};
            on_plane p = put_on_plane(slope_gravity(0), friction, 0, def);
            step_times(p.world, step_size(k), 90 << k);
            pe_body_state s = state_of(p.world, p.body);
            error[k] = s.position.x - v * v / (2 * friction * G);
            assert_at_most(length(s.velocity), 1e-9);
            pe_world_destroy(p.world);
        }
        char name[60];
        snprintf(name, sizeof name, "block from %g m/s: stopping distance", v);
        assert_within_the_last_step(name, error, friction * G);
    }
}

static void test_a_sphere_rolls_down_a_slope_at_five_sevenths_of_its_pull(void **state)
{
    (void)state;
    double error[STEP_SIZES], spin_error[STEP_SIZES], angle = 0.3, radius = 0.25;
    for (int k = 0; k < STEP_SIZES; ++k) {
        on_plane p = put_on_plane(slope_gravity(angle), 0.8, 0, sphere_def(radius, radius));
        step_times(p.world, step_size(k), 120 << k);
        pe_body_state s = state_of(p.world, p.body);
        double a = 5 * G * sin(angle) / 7;
        error[k] = fabs(s.position.x - 0.5 * a * 4);
        spin_error[k] = fabs(s.angular_velocity.y - 2 * a / radius);
        assert_close(s.position.z, radius, 1e-9, 0);
        pe_world_destroy(p.world);
    }
    order_of("sphere rolling down: position after 2 s", error);
    order_of("  angular velocity", spin_error);
    for (int k = 0; k < STEP_SIZES; ++k) {
        assert_at_most(error[k], 1e-8);
        assert_at_most(spin_error[k], 1e-8);
    }
}

static void test_a_bowling_ball_skids_then_rolls_at_five_sevenths_of_its_speed(void **state)
{
    (void)state;
    static const double speeds[] = {2, 3, 4.3};
    for (int i = 0; i < 3; ++i) {
        double error[STEP_SIZES], v = speeds[i], friction = 0.2, radius = 0.11;
        double skids = 2 * v / (7 * friction * G);
        double exact = v * skids - 0.5 * friction * G * skids * skids + 5 * v / 7 * (2 - skids);
        for (int k = 0; k < STEP_SIZES; ++k) {
            pe_body_def def = sphere_def(radius, radius);
            def.velocity = (pe_vec3){v, 0, 0};
            on_plane p = put_on_plane(slope_gravity(0), friction, 0, def);
            step_times(p.world, step_size(k), 120 << k);
            pe_body_state s = state_of(p.world, p.body);
            error[k] = s.position.x - exact;
            assert_close(s.velocity.x, 5 * v / 7, 1e-8, 0);
            assert_close(s.angular_velocity.y, 5 * v / 7 / radius, 1e-7, 0);
            pe_world_destroy(p.world);
        }
        char name[60];
        snprintf(name, sizeof name, "bowling from %g m/s: position after 2 s", v);
        assert_within_the_last_step(name, error, friction * G);
    }
}

/* ---- Impacts -----------------------------------------------------------------------------------
 */

/* Height of the lowest point of a box, or of a sphere. */
static double lowest(const pe_body_state *s, const pe_shape *shape)
{
    if (shape->kind == PE_SHAPE_SPHERE) {
        return s->position.z - shape->radius;
    }
    double down = 0;
    for (int k = 0; k < 3; ++k) {
        pe_vec3 axis = turn(s->orientation, (pe_vec3){k == 0, k == 1, k == 2});
        const pe_vec3 h = shape->half_extents;
        down += (k == 0 ? h.x : k == 1 ? h.y : h.z) * fabs(axis.z);
    }
    return s->position.z - down;
}

/* What a drop came to, at the worst of all steps. */
typedef struct landing {
    double sunk, off, speed, crept; /* m below the plane ever, m from it at rest, m/s, m or rad */
} landing;

static landing drop(const char *name, pe_body_def def)
{
    static const double steps[] = {1.0 / 30, 1.0 / 60, 0.013, 1.0 / 120, 1.0 / 240, 1.0 / 480};
    landing worst = {0};
    for (int k = 0; k < 6; ++k) {
        double h = steps[k], sunk = 0, crept = 0;
        on_plane p = put_on_plane(slope_gravity(0), 0.5, 0, def);
        int settle = (int)(8 / h);
        for (int i = 0; i < settle; ++i) {
            step(p.world, h);
            pe_body_state s = state_of(p.world, p.body);
            sunk = fmax(sunk, -lowest(&s, &def.shape));
        }
        pe_body_state rest = state_of(p.world, p.body);
        double off = lowest(&rest, &def.shape);
        double speed = fmax(length(rest.velocity), length(rest.angular_velocity));
        for (int i = 0; i < 200; ++i) {
            step(p.world, h);
            pe_body_state s = state_of(p.world, p.body);
            crept = fmax(crept, distance(s.position, rest.position));
            crept = fmax(crept, angle_between(s.orientation, rest.orientation));
        }
        print_message("%s, h = 1/%.0f: sinks in by %.1e m, comes to rest at %.1e m with %.1e m/s, "
                      "then creeps by %.1e\n",
                      name, 1 / h, sunk, off, speed, crept);
        worst = (landing){fmax(worst.sunk, sunk), fmax(worst.off, fabs(off)),
                          fmax(worst.speed, speed), fmax(worst.crept, crept)};
        pe_world_destroy(p.world);
    }
    return worst;
}

/* The bound on speed is the tolerance of the solver. */
static void assert_soft_landing(landing l)
{
    assert_at_most(l.sunk, 1e-6);
    assert_at_most(l.off, 1e-6);
    assert_at_most(l.speed, 1e-8);
    assert_at_most(l.crept, 1e-10);
}

static void test_what_drops_does_not_sink_in_and_rests(void **state)
{
    (void)state;
    assert_soft_landing(drop("sphere", sphere_def(0.5, 1.7)));
    assert_soft_landing(drop("box, flat", box_def(0.5, 0.3, 0.2, (pe_vec3){0, 0, 1.3})));
}

static void test_a_box_dropped_on_its_corner_does_not_sink_in_and_rests(void **state)
{
    (void)state;
    pe_body_def tilted = box_def(0.5, 0.3, 0.2, (pe_vec3){0, 0, 1.3});
    tilted.orientation = rotation_of((pe_vec3){0.4, 0.3, 0.1});
    assert_soft_landing(drop("box, on its corner", tilted));
}

/* The first apex after a fall from `height`: z + v^2/2g of the flight, the integrator being exact
 * between impacts. */
static double apex_after_bounce(double height, double restitution, double h)
{
    double radius = 0.1;
    on_plane p =
        put_on_plane(slope_gravity(0), 0, restitution, sphere_def(radius, radius + height));
    double apex = 0;
    for (int i = 0; i * h < 5; ++i) {
        step(p.world, h);
        pe_body_state s = state_of(p.world, p.body);
        if (s.velocity.z > 0) {
            apex = s.position.z - radius + s.velocity.z * s.velocity.z / (2 * G);
            break;
        }
    }
    pe_world_destroy(p.world);
    return apex;
}

/* Where within the step the impact falls is chance: the largest error of many heights. */
static void test_the_apex_of_a_bounce_is_first_order(void **state)
{
    (void)state;
    enum { HEIGHTS = 41 };
    double error[STEP_SIZES] = {0}, e = 0.5;
    for (int k = 0; k < STEP_SIZES; ++k) {
        for (int i = 0; i < HEIGHTS; ++i) {
            double height = 1 + 0.01 * i;
            double apex = apex_after_bounce(height, e, step_size(k));
            error[k] = fmax(error[k], fabs(apex - e * e * height));
        }
    }
    assert_order("bounce with e = 0.5: apex, worst of 41", error, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_projectile_is_exact),
        cmocka_unit_test(test_projectile_with_spin_is_second_order),
        cmocka_unit_test(test_steady_spin_is_exact),
        cmocka_unit_test(test_rocket_off_its_centre_follows_the_fresnel_integrals_in_second_order),
        cmocka_unit_test(test_rocket_in_space_is_second_order),
        cmocka_unit_test(test_period_of_the_tumbling_box_is_fourth_order),
        cmocka_unit_test(test_tumbling_box_is_fourth_order),
        cmocka_unit_test(test_free_rotation_keeps_momentum_and_energy_to_rounding),
        cmocka_unit_test(test_heavy_top_precesses_steadily_in_second_order),
        cmocka_unit_test(test_a_sliding_block_is_exact_until_it_stops),
        cmocka_unit_test(test_a_sliding_block_stops_where_it_should_but_for_h_squared),
        cmocka_unit_test(test_a_sphere_rolls_down_a_slope_at_five_sevenths_of_its_pull),
        cmocka_unit_test(test_a_bowling_ball_skids_then_rolls_at_five_sevenths_of_its_speed),
        cmocka_unit_test(test_what_drops_does_not_sink_in_and_rests),
        cmocka_unit_test(test_a_box_dropped_on_its_corner_does_not_sink_in_and_rests),
        cmocka_unit_test(test_the_apex_of_a_bounce_is_first_order),
    };
    return cmocka_run_group_tests_name("engine_order", tests, NULL, NULL);
}
