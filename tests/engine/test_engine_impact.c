/* Impacts at their own time within the step, against closed forms. */
#include "base/vec3.h"
#include "check.h"
#include "world_for_tests.h"

#include <math.h>

static const double H = 1.0 / 60;
static const double G = 9.81;

static pe_world *accurate_world(double gravity)
{
    pe_world_def def = pe_world_def_default();
    def.profile = PE_PROFILE_ACCURATE;
    def.gravity = (pe_vec3){0, 0, -gravity};
    return make_world(&def);
}

static pe_body_def ball_def(double radius, pe_vec3 position, pe_vec3 velocity,
                            pe_material_id material)
{
    pe_body_def def = pe_body_def_default();
    def.shape.radius = radius;
    def.position = position;
    def.velocity = velocity;
    def.material = material;
    return def;
}

/* Height of the lowest point and speed of a ball dropped from rest at `height`, after `time`. */
static void bounced(double height, double e, double time, double *z, double *v)
{
    double speed = sqrt(2 * G * height), start = speed / G;
    *z = height - 0.5 * G * time * time;
    *v = -G * time;
    for (; start < time && speed > 1e-12; start += 2 * speed / G) {
        speed *= e;
        double t = time - start;
        *z = speed * t - 0.5 * G * t * t;
        *v = speed - G * t;
    }
}

static void test_ball_follows_parabolas_at_any_step(void **state)
{
    (void)state;
    const double steps[] = {1.0 / 60, 1.0 / 97, 1.0 / 240};
    for (int k = 1; k <= 10; ++k) {
        for (int i = 0; i < 3; ++i) {
            double e = 0.1 * k, h = steps[i], z, v;
            pe_world *world = accurate_world(G);
            pe_material_id material = add_material(world, 0, e);
            add_plane(world, pe_v3(0, 0, 1), material);
            pe_body_def def = ball_def(0.1, pe_v3(0, 0, 1.1), pe_v3(0, 0, 0), material);
            pe_body_id ball = add_body(world, &def);
            for (int n = 1; n * h < 1.5; ++n) {
                step(world, h);
                bounced(1, e, n * h, &z, &v);
                pe_body_state s = state_of(world, ball);
                /* Bounces at the speed that gravity takes in a step or two count as rest. */
                if (2 * G * z + v * v > 4 * G * h * G * h) {
                    assert_close(s.position.z - 0.1, z, 1e-7, 0);
                    assert_close(s.velocity.z, v, 1e-6, 0);
                }
            }
            pe_world_destroy(world);
        }
    }
}

/* Newton's restitution with friction may gain energy near 1, of which the guard takes momentum. */
static void test_step_impulse_is_the_momentum_change(void **state)
{
    (void)state;
    check_random random = {5};
    int guards = 0;
    for (int i = 0; i < 300; ++i) {
        pe_world *world = accurate_world(G);
        pe_material_id material = add_material(world, 0.3, 0.1 * (1 + i % 7));
        add_plane(world, pe_v3(0, 0, 1), material);
        pe_body_def def = box_def(0.1, 0.2, 0.15, pe_v3(0, 0, check_uniform(&random, 0.3, 0.5)));
        double q[4];
        check_quaternion(&random, q);
        def.orientation = (pe_quat){q[0], q[1], q[2], q[3]};
        def.velocity = (pe_vec3){check_uniform(&random, -2, 2), 0, -4};
        def.angular_velocity = (pe_vec3){check_uniform(&random, -5, 5), 2, 1};
        def.material = material;
        pe_body_id box = add_body(world, &def);
        for (int n = 0; n < 20; ++n) {
            pe_body_state before = state_of(world, box);
            bool guarded = step(world, H).guarded_islands > 0;
            pe_body_state after = state_of(world, box);
            pe_contact contacts[64];
            int count = pe_world_get_contacts(world, contacts, 64);
            assert_true(count <= 64);
            pe_vec3 sum = {0, 0, -G * H};
            for (int c = 0; c < count; ++c) {
                sum = pe_add(sum, contacts[c].impulse);
            }
            double off = pe_length(pe_sub(sum, pe_sub(after.velocity, before.velocity)));
            assert_at_most(off, guarded ? 1e-3 : 1e-11);
            guards += guarded;
        }
        pe_world_destroy(world);
    }
    print_message("    guarded: %d of 6000 steps\n", guards);
}

/* Slides or sticks as in the closed form, whatever the gap at the step's start. The impulse is
 * reported at the ball's lowest point, when it is on the ground. */
static void test_spinning_ball_strikes_at_its_own_surface(void **state)
{
    (void)state;
    check_random random = {9};
    for (int i = 0; i < 200; ++i) {
        double mu = check_uniform(&random, 0, 0.6), e = check_uniform(&random, 0, 1), r = 0.1;
        pe_world *world = accurate_world(0);
        pe_material_id material = add_material(world, mu, e);
        add_plane(world, pe_v3(0, 0, 1), material);
        double along = check_uniform(&random, -5, 5), into = check_uniform(&random, 1, 8);
        double spin = check_uniform(&random, -30, 30);
        int struck = 0;
        pe_body_def def = ball_def(r, pe_v3(0, 0, r + check_uniform(&random, 0.01, 0.2)),
                                   pe_v3(along, 0, -into), material);
        def.angular_velocity = (pe_vec3){0, spin, 0};
        pe_body_id ball = add_body(world, &def);
        for (int n = 0; n < 20; ++n) {
            pe_vec3 before = state_of(world, ball).position;
            pe_contact contacts[64];
            step(world, H);
            for (int k = pe_world_get_contacts(world, contacts, 64) - 1; k >= 0; --k) {
                const pe_contact *c = &contacts[k];
                if (c->impulse.z != 0) {
                    pe_vec3 lowest = pe_v3(before.x + along * c->begin, 0, 0);
                    assert_true(c->begin == c->end);
                    assert_close(into * c->begin, before.z - r, 1e-8, 0);
                    assert_close(pe_length(pe_sub(c->point, lowest)), 0, 1e-8, 0);
                    assert_close(pe_length(pe_sub(c->acts.arm_b, pe_v3(0, 0, -r))), 0, 1e-8, 0);
                    struck += 1;
                }
            }
        }
        assert_int_equal(struck, 1);
        double slip = along - r * spin, most = mu * (1 + e) * into;
        double push = fmax(-most, fmin(most, 2.0 / 7 * slip));
        pe_body_state s = state_of(world, ball);
        assert_close(s.velocity.x, along - push, 1e-8, 0);
        assert_close(s.velocity.z, e * into, 1e-8, 0);
        assert_close(r * s.angular_velocity.y, r * spin + 2.5 * push, 1e-8, 0);
        pe_world_destroy(world);
    }
}

/* Two balls of any masses meet in flight: where and how fast they are at the end of the step. */
static void test_two_balls_meet_within_the_step(void **state)
{
    (void)state;
    check_random random = {12};
    for (int i = 0; i < 200; ++i) {
        double e = check_uniform(&random, 0, 1), r = 0.1, mass[2], v[2], x[2], end[2];
        pe_world *world = accurate_world(0);
        pe_material_id material = add_material(world, 0.5, e);
        pe_body_id ids[2];
        for (int k = 0; k < 2; ++k) {
            mass[k] = pow(10, check_uniform(&random, -2, 2));
            v[k] = (k ? -1 : 1) * check_uniform(&random, 1, 20);
            x[k] = (k ? 1 : -1) * check_uniform(&random, 0.15, 0.2);
            pe_body_def def = ball_def(r, pe_v3(x[k], 0, 0), pe_v3(v[k], 0, 0), material);
            def.mass = mass[k];
            ids[k] = add_body(world, &def);
        }
        double meet = (x[1] - x[0] - 2 * r) / (v[0] - v[1]), total = 10 * H;
        double push = (1 + e) * (v[1] - v[0]) / (1 / mass[0] + 1 / mass[1]);
        for (int n = 0; n < 10; ++n) {
            step(world, H);
        }
        for (int k = 0; k < 2; ++k) {
            end[k] = v[k] + (k ? -1 : 1) * push / mass[k];
            pe_body_state s = state_of(world, ids[k]);
            assert_close(s.velocity.x, end[k], 1e-9, 1e-9);
            assert_close(s.position.x, x[k] + v[k] * meet + end[k] * (total - meet), 1e-8, 1e-8);
        }
        pe_world_destroy(world);
    }
}

/* Total angular momentum about the origin, kg m^2/s, of bodies of mass 1 and inertia 0.1. */
static pe_vec3 momentum_of(pe_world *world, const pe_body_id ids[2])
{
    pe_vec3 sum = {0};
    for (int k = 0; k < 2; ++k) {
        pe_body_state s = state_of(world, ids[k]);
        sum = pe_add(sum, pe_madd(pe_cross(s.position, s.velocity), 0.1, s.angular_velocity));
    }
    return sum;
}

/* J */
static double kinetic_of(pe_world *world, const pe_body_id ids[2])
{
    double sum = 0;
    for (int k = 0; k < 2; ++k) {
        pe_body_state s = state_of(world, ids[k]);
        sum += pe_dot(s.velocity, s.velocity) / 2;
        sum += 0.1 * pe_dot(s.angular_velocity, s.angular_velocity) / 2;
    }
    return sum;
}

static void test_flying_box_collision_conserves_angular_momentum(void **state)
{
    (void)state;
    check_random random = {21};
    int collided = 0, exact = 0;
    for (int i = 0; i < 200; ++i) {
        pe_world *world = accurate_world(0);
        pe_material_id material = add_material(world, 0.3, check_uniform(&random, 0.3, 0.8));
        pe_body_id ids[2];
        for (int k = 0; k < 2; ++k) {
            pe_body_def def = box_def(0.4, 0.6, 0.5, (pe_vec3){k * 1.7, 0.3 * k, 0.1 * k});
            double q[4];
            check_quaternion(&random, q);
            def.orientation = (pe_quat){q[0], q[1], q[2], q[3]};
            def.velocity = (pe_vec3){k ? -2 : 2, check_uniform(&random, -1, 1), 0};
            def.angular_velocity = (pe_vec3){check_uniform(&random, -1, 1), 0, 1};
            def.inertia = (pe_vec3){0.1, 0.1, 0.1};
            def.material = material;
            ids[k] = add_body(world, &def);
        }
        pe_vec3 begun = momentum_of(world, ids);
        double kinetic = kinetic_of(world, ids), now = kinetic;
        for (int n = 0; n < 60 && fabs(now - kinetic) < 1e-6; ++n) {
            step(world, H);
            now = kinetic_of(world, ids);
        }
        collided += fabs(now - kinetic) >= 1e-6;
        assert_at_most(now, kinetic * (1 + 1e-9));
        double off = pe_length(pe_sub(momentum_of(world, ids), begun));
        /* A later impact at less than a thousandth of the first one's speed acts over its gap. */
        assert_at_most(off, 1e-3);
        exact += off < 1e-11;
        pe_world_destroy(world);
    }
    assert_true(collided > 150);
    assert_true(exact > 190);
}

/* Three equal elastic balls in a row exchange their velocities, pair by pair: each velocity goes on
 * along its own line, offset by the balls that it passed. Blows at one time would reverse both
 * relative velocities instead. */
static void test_impacts_apart_in_time_are_separate(void **state)
{
    (void)state;
    static const double delays[] = {2e-3, 5e-3, 0.02, 0.05, 0.2}; /* in units of the step */
    const double r = 0.1, left = 1, right = -2;                   /* m, m/s */
    for (int k = 0; k < 5; ++k) {
        pe_world_def world_def = pe_world_def_default();
        world_def.gravity = pe_v3(0, 0, 0);
        world_def.impact_bodies = 3;
        pe_world *world = make_world(&world_def);
        pe_material_id material = add_material(world, 0, 1);
        /* The left ball comes at a third of the step, the right one when the middle one, which then
         * flies towards it, has been on its way for the delay. */
        double first = H / 3, delay = delays[k] * H, v[] = {left, 0, right};
        double x[] = {-2 * r - left * first, 0, 2 * r - right * first + (left - right) * delay};
        pe_body_id ids[3];
        for (int i = 0; i < 3; ++i) {
            pe_body_def def = ball_def(r, pe_v3(x[i], 0, 0), pe_v3(v[i], 0, 0), material);
            ids[i] = add_body(world, &def);
        }
        step(world, H);
        static const int comes_from[] = {2, 1, 0};
        for (int i = 0; i < 3; ++i) {
            int of = comes_from[i];
            pe_body_state s = state_of(world, ids[i]);
            assert_close(s.velocity.x, v[of], 1e-9, 0);
            assert_close(s.position.x, x[of] + v[of] * H + 2 * r * (i - of), 1e-9, 0);
        }
        pe_world_destroy(world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ball_follows_parabolas_at_any_step),
        cmocka_unit_test(test_step_impulse_is_the_momentum_change),
        cmocka_unit_test(test_spinning_ball_strikes_at_its_own_surface),
        cmocka_unit_test(test_two_balls_meet_within_the_step),
        cmocka_unit_test(test_flying_box_collision_conserves_angular_momentum),
        cmocka_unit_test(test_impacts_apart_in_time_are_separate),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
