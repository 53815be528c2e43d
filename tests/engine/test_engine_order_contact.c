/* Of what order motion in lasting contact is, against closed forms. */
#include "check.h"
#include "motion_order.h"
#include "motion_vectors.h"

#include <stdio.h>

static void test_a_sliding_block_is_exact_until_it_stops(void **state)
{
    (void)state;
    static const double slopes[] = {0, 0.2, 0.6};
    for (int i = 0; i < 3; ++i) {
        double error[STEP_SIZES], speed_error[STEP_SIZES], sunk = 0;
        double friction = 0.3, down = GRAVITY * (sin(slopes[i]) - friction * cos(slopes[i]));
        for (int k = 0; k < STEP_SIZES; ++k) {
            double h = order_step(k);
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
        double h = order_step(k);
        assert_at_most(error[k], deceleration * h * h / 8 + 1e-8);
        assert_at_most(-error[k], 1e-8);
    }
}

static void test_sliding_block_stop_is_second_order(void **state)
{
    (void)state;
    static const double speeds[] = {2, 3, 3.7};
    for (int i = 0; i < 3; ++i) {
        double error[STEP_SIZES], v = speeds[i], friction = 0.4;
        for (int k = 0; k < STEP_SIZES; ++k) {
            pe_body_def def = box_def(0.5, 0.5, 0.2, (pe_vec3){0, 0, 0.2});
            def.velocity = (pe_vec3){v, 0, 0};
            on_plane p = put_on_plane(slope_gravity(0), friction, 0, def);
            step_times(p.world, order_step(k), 90 << k);
            pe_body_state s = state_of(p.world, p.body);
            error[k] = s.position.x - v * v / (2 * friction * GRAVITY);
            assert_at_most(length(s.velocity), 1e-9);
            pe_world_destroy(p.world);
        }
        char name[60];
        snprintf(name, sizeof name, "block from %g m/s: stopping distance", v);
        assert_within_the_last_step(name, error, friction * GRAVITY);
    }
}

static void test_rolling_sphere_accelerates_by_five_sevenths(void **state)
{
    (void)state;
    double error[STEP_SIZES], spin_error[STEP_SIZES], angle = 0.3, radius = 0.25;
    for (int k = 0; k < STEP_SIZES; ++k) {
        on_plane p = put_on_plane(slope_gravity(angle), 0.8, 0, sphere_def(radius, radius));
        step_times(p.world, order_step(k), 120 << k);
        pe_body_state s = state_of(p.world, p.body);
        double a = 5 * GRAVITY * sin(angle) / 7;
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

static void test_bowling_ball_rolls_at_five_sevenths_speed(void **state)
{
    (void)state;
    static const double speeds[] = {2, 3, 4.3};
    for (int i = 0; i < 3; ++i) {
        double error[STEP_SIZES], v = speeds[i], friction = 0.2, radius = 0.11;
        double skids = 2 * v / (7 * friction * GRAVITY);
        double exact =
            v * skids - 0.5 * friction * GRAVITY * skids * skids + 5 * v / 7 * (2 - skids);
        for (int k = 0; k < STEP_SIZES; ++k) {
            pe_body_def def = sphere_def(radius, radius);
            def.velocity = (pe_vec3){v, 0, 0};
            on_plane p = put_on_plane(slope_gravity(0), friction, 0, def);
            step_times(p.world, order_step(k), 120 << k);
            pe_body_state s = state_of(p.world, p.body);
            error[k] = s.position.x - exact;
            assert_close(s.velocity.x, 5 * v / 7, 1e-8, 0);
            assert_close(s.angular_velocity.y, 5 * v / 7 / radius, 1e-7, 0);
            pe_world_destroy(p.world);
        }
        char name[60];
        snprintf(name, sizeof name, "bowling from %g m/s: position after 2 s", v);
        assert_within_the_last_step(name, error, friction * GRAVITY);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_sliding_block_is_exact_until_it_stops),
        cmocka_unit_test(test_sliding_block_stop_is_second_order),
        cmocka_unit_test(test_rolling_sphere_accelerates_by_five_sevenths),
        cmocka_unit_test(test_bowling_ball_rolls_at_five_sevenths_speed),
    };
    return cmocka_run_group_tests_name("engine_order_contact", tests, NULL, NULL);
}
