/* Rebounds in the fast profile, at 1/60 s: Newton's law, energy, and the impulses that are reported. */
#include "base/vec3.h"
#include "check.h"
#include "world_for_tests.h"

#include <math.h>

static const double H = 1.0 / 60, G = 9.81;

static pe_world *fast_world(double restitution, pe_material_id *material)
{
    pe_world_def def = pe_world_def_default();
    def.profile = PE_PROFILE_FAST;
    pe_world *world = make_world(&def);
    *material = add_material(world, 0, restitution);
    return world;
}

/* A ball of radius 0.5 m over the plane z = 0. */
static pe_body_id add_ball(pe_world *world, pe_material_id material, double height)
{
    add_plane(world, pe_v3(0, 0, 1), material);
    pe_body_def def = pe_body_def_default();
    def.position.z = 0.5 + height;
    def.material = material;
    return add_body(world, &def);
}

/* The kinetic and potential energy of a ball of 1 kg, J. */
static double energy_of(const pe_body_state *s)
{
    return 0.5 * pe_dot(s->velocity, s->velocity) + G * (s->position.z - 0.5);
}

static void test_rebound_speed_is_e_times_v(void **state)
{
    (void)state;
    for (int k = 0; k <= 10; ++k) {
        const double e = 0.1 * k;
        pe_material_id material;
        pe_world *world = fast_world(e, &material);
        const pe_body_id ball = add_ball(world, material, 2);
        pe_body_state before, now = state_of(world, ball);
        do {
            before = now;
            step(world, H);
            now = state_of(world, ball);
        } while (now.velocity.z < before.velocity.z);
        step(world, H); /* without a rebound, soft contact ends the fall in the next step */
        now = state_of(world, ball);
        const double v = sqrt(2 * energy_of(&before)), rise = sqrt(2 * fmax(0, energy_of(&now)));
        assert_close(rise, e * v, 1e-3, 0.01);
        pe_world_destroy(world);
    }
}

static void test_elastic_ball_keeps_its_height(void **state)
{
    (void)state;
    pe_material_id material;
    pe_world *world = fast_world(1, &material);
    const pe_body_id ball = add_ball(world, material, 5);
    for (int n = 0; n < 1212; ++n) { /* ten bounces of 2.019 s */
        step(world, H);
        const pe_body_state now = state_of(world, ball);
        assert_at_most(energy_of(&now), 5 * G * (1 + 1e-9));
        assert_at_most(0.999 * 5 * G, energy_of(&now));
    }
    pe_world_destroy(world);
}

/* An elastic cube falls flat on a smaller pedestal, at several phases of a step. */
static void test_points_of_a_cube_rebound_together(void **state)
{
    (void)state;
    for (int k = 0; k < 12; ++k) {
        pe_material_id material;
        pe_world *world = fast_world(1, &material);
        pe_body_def pedestal = box_def(0.15, 0.2, 0.5, pe_v3(0.05, 0.02, -0.5));
        pedestal.is_static = true;
        pedestal.material = material;
        add_body(world, &pedestal);
        pe_body_def def = box_def(0.25, 0.25, 0.25, pe_v3(0, 0, 1.25 + 0.004 * k));
        def.material = material;
        const pe_body_id cube = add_body(world, &def);
        for (int n = 0; n < 50; ++n) {
            step(world, H);
        }
        const pe_body_state now = state_of(world, cube);
        assert_true(now.position.z > 0.6);
        assert_at_most(pe_length(now.angular_velocity), 1e-6);
        assert_at_most(hypot(now.position.x, now.position.y), 1e-6);
        pe_world_destroy(world);
    }
}

/* In each step the reported impulses and gravity give the change of momentum. */
static void test_reported_impulses_match_the_motion(void **state)
{
    (void)state;
    for (int k = 0; k <= 4; ++k) {
        pe_material_id material;
        pe_world *world = fast_world(0.25 * k, &material);
        const pe_body_id ball = add_ball(world, material, 1);
        double before = 0;
        for (int n = 0; n < 240; ++n) {
            step(world, H);
            pe_contact contacts[16];
            const int count = pe_world_get_contacts(world, contacts, 16);
            double impulse = -G * H;
            for (int i = 0; i < count; ++i) {
                impulse += contacts[i].impulse.z;
            }
            const double now = state_of(world, ball).velocity.z;
            assert_close(impulse, now - before, 1e-2 * G * H, 0);
            before = now;
        }
        pe_world_destroy(world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rebound_speed_is_e_times_v),
        cmocka_unit_test(test_elastic_ball_keeps_its_height),
        cmocka_unit_test(test_points_of_a_cube_rebound_together),
        cmocka_unit_test(test_reported_impulses_match_the_motion),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
