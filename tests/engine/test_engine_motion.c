/* Motion without contact: the integrator against closed forms. */
#include "base/vec3.h"
#include "check.h"
#include "model/integrate.h"
#include "random_pose.h"
#include "world_for_tests.h"

#include <math.h>

static const double H = 1.0 / 60;

static void test_sine_and_cosine_equal_those_of_libm(void **state)
{
    (void)state;
    check_random random = {1};
    for (int i = 0; i < 100000; ++i) {
        double x = check_uniform(&random, -100, 100), s, c;
        pe_sincos(i % 2 ? x : 0.01 * x, &s, &c);
        assert_close(s, sin(i % 2 ? x : 0.01 * x), 4e-16, 0);
        assert_close(c, cos(i % 2 ? x : 0.01 * x), 4e-16, 0);
    }
}

static void test_projectile_follows_the_parabola(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_def def = box_def(0.1, 0.2, 0.3, (pe_vec3){1, 2, 3});
    def.velocity = (pe_vec3){4, 5, 6};
    pe_body_id body = add_body(world, &def);
    for (int n = 1; n <= 600; ++n) {
        step(world, H);
        pe_body_state s = state_of(world, body);
        assert_close(s.position.x, 1 + 4 * n * H, 1e-11, 0);
        assert_close(s.position.z, 3 + 6 * n * H - 9.81 * H * H * n * n / 2, 1e-10, 0);
    }
    pe_world_destroy(world);
}

static pe_vec3 body_spin(const pe_body_state *s)
{
    pe_mat3 r = pe_matrix_of(s->orientation);
    return pe_unrotate(&r, s->angular_velocity);
}

static void test_free_spin_conserves_energy_and_angular_momentum(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_def def = box_def(0.5, 2, 4.5, (pe_vec3){0, 0, 0});
    def.angular_velocity = (pe_vec3){0.1, 5, 0.1}; /* about the middle axis: it flips */
    pe_body_id body = add_body(world, &def);
    double mass, least = 5;
    pe_vec3 inertia;
    pe_body_get_mass(world, body, &mass, &inertia, NULL);
    pe_vec3 l0 = pe_mul(inertia, def.angular_velocity);
    for (int n = 0; n < 3600; ++n) {
        step(world, H);
        pe_body_state s = state_of(world, body);
        pe_vec3 w = body_spin(&s), l = pe_mul(inertia, w);
        assert_close(pe_dot(w, l), pe_dot(def.angular_velocity, l0), 0, 1e-10);
        assert_close(pe_length(l), pe_length(l0), 0, 1e-10);
        least = pe_min(least, w.y);
    }
    assert_close(least, -5, 0.05, 0);
    pe_world_destroy(world);
}

static pe_vec3 momentum_of(const pe_world *world, int slot)
{
    const pe_mat3 *r = &pe_poses(world)[slot].rotation;
    pe_vec3 w = pe_unrotate(r, pe_twists(world)[slot].angular_velocity);
    return pe_rotate(r, pe_mul(pe_masses(world)[slot].inertia, w));
}

/* One step from a random state, by `angle` in all; relative errors of energy and momentum. */
static void rotate_once(check_random *random, double angle, double *energy_error,
                        double *momentum_error)
{
    static const pe_vec3 none[2] = {{0, 0, 0}, {0, 0, 0}};
    pe_world *world = make_world(NULL);
    pe_body_def def = box_def(0.1, 0.3, 0.5, pe_v3(0, 0, 0));
    def.orientation = random_turn(random);
    def.angular_velocity = random_vector(random, 10);
    int slot = (int)add_body(world, &def).index;
    pe_vec3 before = momentum_of(world, slot), spin = pe_twists(world)[slot].angular_velocity;
    double dt = angle / pe_length(spin), begun = pe_dot(before, spin);
    pe_vec3 end, mean;
    pe_rotate_freely(world, slot, dt, none, &end, &mean);
    pe_pose_move(&pe_poses(world)[slot], none[0], pe_scale(dt, mean));
    pe_twists(world)[slot].angular_velocity = end;
    pe_vec3 after = momentum_of(world, slot);
    *energy_error = fabs(pe_dot(after, end) - begun) / begun;
    *momentum_error = pe_length(pe_sub(after, before)) / pe_length(before);
    pe_world_destroy(world);
}

static void test_free_rotation_keeps_energy_and_momentum_to_rounding(void **state)
{
    (void)state;
    check_random random = {3};
    double worst[2] = {0};
    for (int k = -6; k <= 0; ++k) {
        for (int i = 0; i < 500; ++i) {
            double energy, momentum;
            rotate_once(&random, pow(10, k), &energy, &momentum);
            worst[0] = fmax(worst[0], energy);
            worst[1] = fmax(worst[1], momentum);
        }
    }
    print_message("    energy kept to %g, momentum to %g\n", worst[0], worst[1]);
    assert_at_most(worst[0], 5e-15);
    assert_at_most(worst[1], 5e-15);
}

static void test_flip_period_equals_the_elliptic_integral(void **state)
{
    (void)state;
    /* I = (0.80833, 0.68333, 0.141667), w0 = (0.1, 5, 0.1): w_y has the period 6.056844 s. */
    pe_world *world = make_world(NULL);
    pe_body_def def = box_def(0.5, 2, 4.5, (pe_vec3){0, 0, 0});
    def.inertia = (pe_vec3){0.80833, 0.68333, 0.141667};
    def.angular_velocity = (pe_vec3){0.1, 5, 0.1};
    pe_body_id body = add_body(world, &def);
    const double h = 1e-3;
    double crossing[3], before = 5;
    int found = 0;
    for (int n = 1; found < 3 && n < 12000; ++n) {
        step(world, h);
        pe_body_state s = state_of(world, body);
        double now = body_spin(&s).y;
        if ((before > 0) != (now > 0)) {
            crossing[found++] = h * (n - 1 + before / (before - now));
        }
        before = now;
    }
    assert_int_equal(found, 3);
    assert_close(crossing[2] - crossing[0], 6.056844, 0, 1e-4);
    pe_world_destroy(world);
}

static void test_point_force_gives_acceleration_and_torque(void **state)
{
    (void)state;
    for (int frame = 0; frame < 2; ++frame) {
        pe_world_def world_def = pe_world_def_default();
        world_def.gravity = (pe_vec3){0, 0, 0};
        pe_world *world = make_world(&world_def);
        pe_body_def def = box_def(0.3, 0.3, 0.3, (pe_vec3){0, 0, 0});
        def.mass = 2;
        def.orientation =
            (pe_quat){sqrt(0.5), 0, 0, sqrt(0.5)}; /* x of the body is y of the world */
        pe_body_id body = add_body(world, &def);
        assert_int_equal(pe_body_apply_force(world, body, (pe_vec3){3, 0, 0},
                                             (pe_vec3){0.1, 0, 0.3},
                                             frame ? PE_FRAME_BODY : PE_FRAME_WORLD, NULL),
                         PE_OK);
        step(world, H);
        double v = 3.0 / 2 * H, w = 0.9 / (2 * (0.36 + 0.36) / 12) * H, turn = 0.5 * H * w;
        double part = (1 + 4 * cos(0.25 * turn) + cos(turn)) / 6; /* of a force that turns */
        pe_body_state s = state_of(world, body);
        assert_close(s.velocity.x, frame ? 0 : v, 1e-15, 0);
        assert_close(s.velocity.y, frame ? v * part : 0, 1e-15, 0);
        /* r x F: (0.1, 0, 0.3) x (3, 0, 0) = (0, 0.9, 0), and turned by a quarter about z. */
        assert_close(s.angular_velocity.x, frame ? -w : 0, 1e-14, 0);
        assert_close(s.angular_velocity.y, frame ? 0 : w, 1e-14, 0);
        assert_close(s.angular_velocity.z, 0, 1e-14, 0);
        /* The force was for one step. */
        step(world, H);
        assert_close(state_of(world, body).velocity.x, frame ? 0 : v, 1e-15, 0);
        pe_world_destroy(world);
    }
}

/* A ball that rolls, pushed by 5 N along its x: r (m r^2 + I)/r^2 a'' = F cos a. */
static void test_force_that_turns_with_a_rolling_ball_gains_its_work(void **state)
{
    (void)state;
    enum { STEPS = 120, PARTS = 1000 };
    const double radius = 0.2, force = 5, factor = force / (1.4 * radius), h = H / PARTS;
    pe_world *world = make_world(NULL);
    pe_material_id material = add_material(world, 1, 0);
    add_plane(world, (pe_vec3){0, 0, 1}, material);
    pe_body_def ball = pe_body_def_default();
    ball.shape.kind = PE_SHAPE_SPHERE;
    ball.shape.radius = radius;
    ball.mass = 1;
    ball.material = material;
    ball.position.z = radius;
    ball.velocity.x = 1;
    ball.angular_velocity.y = 1 / radius;
    pe_body_id body = add_body(world, &ball);
    double angle = 0, spin = 1 / radius, most = 0;
    for (int n = 0; n < STEPS; ++n) {
        pe_body_apply_force(world, body, (pe_vec3){force, 0, 0}, (pe_vec3){0, 0, 0}, PE_FRAME_BODY,
                            NULL);
        pe_step_stats stats;
        assert_int_equal(pe_world_step(world, H, &stats, NULL), PE_OK);
        assert_int_equal(stats.guarded_islands, 0);
        for (int i = 0; i < PARTS; ++i) { /* leapfrog */
            angle += 0.5 * h * spin;
            spin += h * factor * cos(angle);
            angle += 0.5 * h * spin;
        }
        pe_body_state s = state_of(world, body);
        most = pe_max(most, fabs(s.velocity.x - radius * spin));
    }
    print_message("    velocity off by %g m/s at most\n", most);
    assert_at_most(most, 1e-2);
    pe_world_destroy(world);
}

static void test_rotation_is_the_exponential_map(void **state)
{
    (void)state;
    check_random random = {8};
    for (int i = 0; i < 1000; ++i) {
        double q[4];
        check_quaternion(&random, q);
        pe_quat start = {q[0], q[1], q[2], q[3]};
        pe_vec3 v;
        v.z = check_uniform(&random, -2, 2);
        v.y = check_uniform(&random, -2, 2);
        v.x = check_uniform(&random, -2, 2);
        /* One turn equals many small ones about the same axis, and the axis stays. */
        pe_quat one = pe_quat_rotated(start, v), many = start;
        for (int k = 0; k < 64; ++k) {
            many = pe_quat_rotated(many, pe_scale(1.0 / 64, v));
        }
        assert_close(fabs(one.w * many.w + one.x * many.x + one.y * many.y + one.z * many.z), 1,
                     1e-13, 0);
        pe_quat identity = {.w = 1};
        pe_mat3 turn = pe_matrix_of(pe_quat_rotated(identity, v));
        assert_at_most(pe_length(pe_sub(pe_rotate(&turn, v), v)), 1e-13);
        assert_close(turn.r0.x + turn.r1.y + turn.r2.z, 1 + 2 * cos(pe_length(v)), 1e-13, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sine_and_cosine_equal_those_of_libm),
        cmocka_unit_test(test_projectile_follows_the_parabola),
        cmocka_unit_test(test_free_spin_conserves_energy_and_angular_momentum),
        cmocka_unit_test(test_free_rotation_keeps_energy_and_momentum_to_rounding),
        cmocka_unit_test(test_flip_period_equals_the_elliptic_integral),
        cmocka_unit_test(test_point_force_gives_acceleration_and_torque),
        cmocka_unit_test(test_force_that_turns_with_a_rolling_ball_gains_its_work),
        cmocka_unit_test(test_rotation_is_the_exponential_map),
    };
    return cmocka_run_group_tests_name("engine_motion", tests, NULL, NULL);
}
