/* The direct solvers on problems with closed forms. */
#include "check.h"
#include "solving.h"

#include <math.h>

static void solved(solving *s, const pe_contact_problem *source, const named_solver *by)
{
    solve_to(s, source, by, by->tolerance);
}

/* Component k of the impulse of a manifold. */
static double impulse_of(const solving *s, int index, int k)
{
    const pe_solver_manifold *manifold = &s->problem.manifold[index];
    double sum = 0;
    for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
        sum += s->problem.impulse[j][k];
    }
    return sum;
}

static void test_resting_box_impulse_equals_its_weight(void **state)
{
    (void)state;
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        for (int i = 0; i < 6; ++i) {
            solving s;
            double mass = pow(10, 2 * i - 5), friction = 0.2 * i;
            pe_contact_problem *source = problem_of_box_on_floor(mass, friction);
            solved(&s, source, &SOLVERS[k]);
            assert_close(impulse_of(&s, 0, 0), mass * GRAVITY * STEP, 0, 10 * SOLVERS[k].close);
            assert_at_most(s.report.iterations, 20);
            for (int c = 0; c < 6; ++c) {
                assert_close(solving_velocity(&s, 0)[c], 0, SOLVERS[k].close, 0);
            }
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
    }
}

static void test_tower_contact_carries_the_weight_above(void **state)
{
    (void)state;
    static const int heights[] = {2, 5, 10, 25};
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        for (int h = 0; h < 4; ++h) {
            solving s;
            int n = heights[h];
            pe_contact_problem *source = problem_of_uniform_tower(n, 0.5);
            solved(&s, source, &SOLVERS[k]);
            for (int i = 0; i < n; ++i) {
                assert_close(impulse_of(&s, i, 0), (n - i) * GRAVITY * STEP, 0,
                             10 * SOLVERS[k].close);
            }
            print_message("tower of %d: %s: %d iterations\n", n, SOLVERS[k].name,
                          s.report.iterations);
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
    }
}

static void test_box_sticks_below_the_friction_angle(void **state)
{
    (void)state;
    static const double below[] = {0.3, 1e-2, 1e-4, 1e-6};
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        for (int i = 0; i < 4; ++i) {
            solving s;
            double mass = 3, friction = 0.6, angle = atan(friction) - below[i];
            pe_contact_problem *source = problem_of_box_on_slope(mass, friction, angle);
            solved(&s, source, &SOLVERS[k]);
            for (int c = 0; c < 6; ++c) {
                assert_close(solving_velocity(&s, 0)[c], 0, SOLVERS[k].close, 0);
            }
            assert_close(impulse_of(&s, 0, 0), mass * GRAVITY * STEP * cos(angle), 0,
                         10 * SOLVERS[k].close);
            assert_close(impulse_of(&s, 0, 1), -mass * GRAVITY * STEP * sin(angle), 0,
                         10 * SOLVERS[k].close);
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
    }
}

static void test_box_slides_above_the_friction_angle_without_lift(void **state)
{
    (void)state;
    static const double above[] = {0.5, 0.1, 1e-2, 1e-4, 1e-6};
    for (int k = 0; k < COULOMB_SOLVERS; ++k) {
        for (int i = 0; i < 5; ++i) {
            solving s;
            double mass = 3, friction = 0.4, angle = atan(friction) + above[i];
            double slip = GRAVITY * STEP * (sin(angle) - friction * cos(angle));
            pe_contact_problem *source = problem_of_box_on_slope(mass, friction, angle);
            solved(&s, source, &SOLVERS[k]);
            const double *v = solving_velocity(&s, 0);
            assert_close(v[0], slip, 1e-9, 0);
            for (int c = 1; c < 6; ++c) {
                assert_close(v[c], 0, SOLVERS[k].close, 0);
            }
            assert_close(impulse_of(&s, 0, 0), mass * GRAVITY * STEP * cos(angle), 0,
                         10 * SOLVERS[k].close);
            for (int j = 0; j < 4; ++j) {
                const double *p = s.problem.impulse[j];
                assert_close(p[1], -friction * p[0], 1e-9, 0);
                assert_close(p[2], 0, 1e-9, 0);
            }
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
    }
}

/* Sliding freely, u_n = mu |u_t|, and p perpendicular to u: all of p_n lies on the cone's edge.
 * With n the normal velocity given by p_n and p_t = -mu p_n, v_x = g h sin - mu P, v_z = P - g h
 * cos with P = p_n/m: P (1 + mu^2) = g h (cos + mu sin). */
static void test_convex_problem_shift_removes_lift_of_sliding_bodies(void **state)
{
    (void)state;
    solving s;
    double mass = 3, mu = 0.4, angle = atan(mu) + 0.2, fall = GRAVITY * STEP;
    pe_contact_problem *source = problem_of_box_on_slope(mass, mu, angle);
    solve_to(&s, source, &SOLVERS[CONVEX], 1e-10);
    double push = fall * (cos(angle) + mu * sin(angle)) / (1 + mu * mu);
    const double *v = solving_velocity(&s, 0);
    assert_close(v[0], fall * sin(angle) - mu * push, 1e-8, 0);
    assert_close(v[2], push - fall * cos(angle), 1e-8, 0);
    assert_close(v[2], mu * v[0], 1e-8, 0);
    solving_end(&s);

    solving_begin(&s, source);
    double slip = fall * (sin(angle) - mu * cos(angle));
    const double shift[4] = {mu * slip, mu * slip, mu * slip, mu * slip};
    const pe_solve_limits limits = {1e-10, SOLVING_ITERATIONS};
    assert_int_equal(pe_interior_point(&s.problem, &(pe_convex_form){NULL, shift}, &limits, s.work,
                                       &s.report, NULL),
                     PE_OK);
    assert_int_equal(s.report.stop, PE_STOP_CONVERGED);
    v = solving_velocity(&s, 0);
    assert_close(v[0], slip, 1e-8, 0);
    assert_close(v[2], 0, 1e-8, 0);
    assert_at_most(s.report.residual.max, 1e-8);
    pe_contact_problem_destroy(source);
    solving_end(&s);
}

static void test_frictionless_tower_slides_whole_without_tangential_impulse(void **state)
{
    (void)state;
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        solving s;
        double angle = 0.3;
        pe_contact_problem *source = problem_of_uniform_tower(6, 0);
        tilt_gravity(source, angle);
        solved(&s, source, &SOLVERS[k]);
        for (int i = 0; i < 6; ++i) {
            assert_close(solving_velocity(&s, i)[0], GRAVITY * STEP * sin(angle), SOLVERS[k].close,
                         0);
            assert_close(solving_velocity(&s, i)[2], 0, SOLVERS[k].close, 0);
            assert_close(impulse_of(&s, i, 0), (6 - i) * GRAVITY * STEP * cos(angle), 0,
                         10 * SOLVERS[k].close);
        }
        for (int j = 0; j < s.problem.point_count; ++j) {
            assert_true(s.problem.impulse[j][1] == 0 && s.problem.impulse[j][2] == 0);
        }
        pe_contact_problem_destroy(source);
        solving_end(&s);
    }
}

static void test_mass_ratio_of_a_million_converges(void **state)
{
    (void)state;
    static const double towers[][3] = {{1, 1e6, 1}, {1e6, 1, 1e6}, {1, 1, 1e6}, {1e6, 1e3, 1}};
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        for (int t = 0; t < 4; ++t) {
            solving s;
            pe_contact_problem *source = problem_of_tower(towers[t], 3, 0.5);
            /* The impulse of a million kilograms is known to a rounding that moves a kilogram by
             * 4e-11 m/s. */
            solve_to(&s, source, &SOLVERS[k], fmax(SOLVERS[k].tolerance, 1e-9));
            double above = 0;
            for (int i = 2; i >= 0; --i) {
                above += towers[t][i];
                assert_close(impulse_of(&s, i, 0), above * GRAVITY * STEP, 0,
                             10 * SOLVERS[k].close);
                assert_close(solving_velocity(&s, i)[2], 0, fmax(SOLVERS[k].close, 1e-8), 0);
            }
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
    }
}

/* A box whose corners at +x have a gap that closes at the speed `b`: it rotates about its corners
 * at -x. With a cube's inertia m/6 the rotation alone closes it at 1.2 g h; up to there both sides
 * touch and share the impulse as the velocities -b/2 and -b of the two sides ask for. */
static void test_one_sided_gap_closes_as_rotation_allows(void **state)
{
    (void)state;
    const double fall = GRAVITY * STEP, mass = 2;
    static const double part[] = {0.2, 0.7, 1.1, 1.3, 3};
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        for (int i = 0; i < 5; ++i) {
            solving s;
            double b = part[i] * fall;
            bool meets = part[i] < 1.2;
            pe_contact_problem *source = problem_of_box_on_floor(mass, 0);
            source->points[2].bias = source->points[3].bias = b;
            assert_true(source->points[2].offset[1] > 0 && source->points[3].offset[1] > 0);
            solved(&s, source, &SOLVERS[k]);
            double near = s.problem.impulse[0][0] + s.problem.impulse[1][0];
            double far = s.problem.impulse[2][0] + s.problem.impulse[3][0];
            double sum = mass * (fall - 0.5 * b), difference = mass * b / 3;
            assert_close(near, meets ? 0.5 * (sum + difference) : 0.4 * mass * fall,
                         SOLVERS[k].close, 0);
            assert_close(far, meets ? 0.5 * (sum - difference) : 0, SOLVERS[k].close, 0);
            assert_close(solving_velocity(&s, 0)[2], meets ? -0.5 * b : -0.6 * fall,
                         SOLVERS[k].close, 0);
            assert_close(solving_velocity(&s, 0)[4], meets ? b : 1.2 * fall, 10 * SOLVERS[k].close,
                         0);
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
    }
}

static void test_open_gap_carries_nothing_closing_gap_stops(void **state)
{
    (void)state;
    const double fall = GRAVITY * STEP;
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        for (int i = 0; i < 2; ++i) {
            solving s;
            double b = (i == 0 ? 1.5 : 0.5) * fall;
            pe_contact_problem *source = problem_of_box_on_floor(2, 0.5);
            for (int j = 0; j < 4; ++j) {
                source->points[j].bias = b;
            }
            solved(&s, source, &SOLVERS[k]);
            assert_close(solving_velocity(&s, 0)[2], i == 0 ? -fall : -b, SOLVERS[k].close, 0);
            assert_close(impulse_of(&s, 0, 0), i == 0 ? 0 : 2 * (fall - b), 10 * SOLVERS[k].close,
                         0);
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_resting_box_impulse_equals_its_weight),
        cmocka_unit_test(test_tower_contact_carries_the_weight_above),
        cmocka_unit_test(test_box_sticks_below_the_friction_angle),
        cmocka_unit_test(test_box_slides_above_the_friction_angle_without_lift),
        cmocka_unit_test(test_convex_problem_shift_removes_lift_of_sliding_bodies),
        cmocka_unit_test(test_frictionless_tower_slides_whole_without_tangential_impulse),
        cmocka_unit_test(test_mass_ratio_of_a_million_converges),
        cmocka_unit_test(test_one_sided_gap_closes_as_rotation_allows),
        cmocka_unit_test(test_open_gap_carries_nothing_closing_gap_stops),
    };
    return cmocka_run_group_tests_name("engine_direct", tests, NULL, NULL);
}
