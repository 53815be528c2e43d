/* The residual of a problem, and the velocities of its impulses, against independent formulas and
 * dense matrices. */
#include "check.h"
#include "factor_setting.h"

#include <math.h>
#include <stdlib.h>

static void test_residual_of_closed_form_solution_is_zero(void **state)
{
    (void)state;
    for (int i = 0; i < 4; ++i) {
        test_memory memory;
        double mass = pow(10, i - 1), friction = 0.25 * i;
        pe_contact_problem *source = problem_of_box_on_floor(mass, friction);
        for (int j = 0; j < 4; ++j) {
            source->points[j].impulse[0] = 0.25 * mass * GRAVITY * STEP;
        }
        pe_problem problem = solver_problem(source, test_memory_begin(&memory));
        pe_residual residual = pe_problem_residual(&problem);
        assert_at_most(residual.max, 1e-15);
        /* With half the impulse the residual is the missing velocity, u_n = -g h/2. */
        for (int j = 0; j < 4; ++j) {
            problem.impulse[j][0] *= 0.5;
        }
        pe_problem_rebuild_velocity(&problem);
        residual = pe_problem_residual(&problem);
        assert_close(residual.max, 0.5 * GRAVITY * STEP, 0, 1e-12);
        assert_close(residual.rms, 0.5 * GRAVITY * STEP, 0, 1e-12);
        pe_contact_problem_destroy(source);
        test_memory_end(&memory);
    }
}

/* The sign of the derivative of the product with z along the circle of unit generators. */
static double product_slope(const double z[3], double angle)
{
    return z[2] * cos(angle) - z[1] * sin(angle);
}

/* The point of the cone nearest to z: z itself, or the nearest on any of its generators, found by a
 * sweep of all directions and bisection next to the best. */
static void nearest_in_cone(double mu, const double z[3], double nearest[3])
{
    enum { DIRECTIONS = 64 };
    const double width = 2 * 3.14159265358979323846 / DIRECTIONS;
    double best = -HUGE_VAL, angle = 0;
    for (int i = 0; i < DIRECTIONS; ++i) {
        double product = z[1] * cos(i * width) + z[2] * sin(i * width);
        if (product > best) {
            best = product;
            angle = i * width;
        }
    }
    double low = angle - width, high = angle + width;
    for (int i = 0; i < 60; ++i) {
        angle = 0.5 * (low + high);
        *(product_slope(z, angle) > 0 ? &low : &high) = angle;
    }
    const double generator[3] = {1, mu * cos(angle), mu * sin(angle)};
    double along = fmax(0, pe_dot3(z, generator) / pe_dot3(generator, generator));
    bool inside = z[0] >= 0 && hypot(z[1], z[2]) <= mu * z[0];
    for (int k = 0; k < 3; ++k) {
        nearest[k] = inside ? z[k] : along * generator[k];
    }
}

static void test_residual_equals_distance_to_searched_projection(void **state)
{
    (void)state;
    check_random random = {11};
    int moved[3] = {0};
    for (int i = 0; i < 20000; ++i) {
        double mu = i % 10 == 0 ? 0 : check_uniform(&random, 0, 1.5);
        double scale = pow(10, check_uniform(&random, -3, 3)), p[3], u[3], z[3], nearest[3];
        for (int k = 0; k < 3; ++k) {
            u[k] = check_uniform(&random, -1, 1);
            p[k] = check_uniform(&random, -1, 1) / scale;
        }
        p[1] = mu == 0 ? 0 : p[1];
        p[2] = mu == 0 ? 0 : p[2];
        double lifted = u[0] + mu * hypot(u[1], u[2]);
        z[0] = p[0] - lifted / scale;
        z[1] = mu == 0 ? 0 : p[1] - u[1] / scale;
        z[2] = mu == 0 ? 0 : p[2] - u[2] / scale;
        nearest_in_cone(mu, z, nearest);
        const double off[3] = {p[0] - nearest[0], p[1] - nearest[1], p[2] - nearest[2]};
        double found = pe_point_residual(mu, scale, p, u);
        assert_close(found, scale * sqrt(pe_dot3(off, off)), 1e-13, 1e-12);
        moved[nearest[0] == z[0] ? 0 : nearest[0] == 0 ? 1 : 2] += 1;
    }
    assert_true(moved[0] > 500 && moved[1] > 500 && moved[2] > 500);
}

/* The trace of one point's J M^-1 J^T. */
static double dense_trace(const double *jacobian, const double *inverse_mass, int n, int point)
{
    double trace = 0;
    for (int row = 3 * point; row < 3 * point + 3; ++row) {
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                trace += jacobian[row * n + i] * inverse_mass[i * n + j] * jacobian[row * n + j];
            }
        }
    }
    return trace;
}

static void test_scale_is_a_third_of_dense_trace(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 30; ++seed) {
        test_memory memory;
        pe_contact_problem *source = problem_of_random_pairs(seed);
        pe_problem problem = solver_problem(source, test_memory_begin(&memory));
        double *jacobian = dense_jacobian(source), *inverse_mass = dense_inverse_mass(source);
        for (int j = 0; j < source->point_count; ++j) {
            double trace = dense_trace(jacobian, inverse_mass, 6 * source->body_count, j);
            assert_close(problem.point[j].scale, trace / 3, 0, 1e-13);
        }
        free(jacobian);
        free(inverse_mass);
        pe_contact_problem_destroy(source);
        test_memory_end(&memory);
    }
}

/* v - v* = M^-1 J^T p, and u = J v + b, by matrices. */
static void test_rebuilt_velocities_equal_dense_matrices(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 30; ++seed) {
        test_memory memory;
        pe_contact_problem *source = problem_of_random_pairs(seed);
        pe_problem problem = solver_problem(source, test_memory_begin(&memory));
        int n = 6 * source->body_count;
        double *jacobian = dense_jacobian(source), *inverse_mass = dense_inverse_mass(source);
        double *push = draw_vector(1, n), *change = draw_vector(1, n);
        for (int i = 0; i < n; ++i) {
            push[i] = change[i] = 0;
            for (int row = 0; row < 3 * source->point_count; ++row) {
                push[i] += jacobian[row * n + i] * source->points[row / 3].impulse[row % 3];
            }
        }
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                change[i] += inverse_mass[i * n + j] * push[j];
            }
            assert_close(problem.velocity[i / 6][i % 6],
                         source->bodies[i / 6].free_velocity[i % 6] + change[i], 1e-12, 1e-13);
        }
        for (int i = 0; i < problem.manifold_count; ++i) {
            const pe_solver_manifold *manifold = &problem.manifold[i];
            double q[6], u[3];
            pe_solver_manifold_twist(manifold, (const double(*)[6])problem.velocity, q);
            for (int row = 3 * manifold->first; row < 3 * (manifold->first + manifold->count);
                 ++row) {
                double expected = row % 3 == 0 ? problem.point[row / 3].bias : 0;
                for (int k = 0; k < n; ++k) {
                    expected += jacobian[row * n + k] * problem.velocity[k / 6][k % 6];
                }
                pe_point_velocity(&problem.point[row / 3], q, u);
                assert_close(u[row % 3], expected, 1e-12, 1e-13);
            }
        }
        free(jacobian);
        free(inverse_mass);
        free(push);
        free(change);
        pe_contact_problem_destroy(source);
        test_memory_end(&memory);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_residual_of_closed_form_solution_is_zero),
        cmocka_unit_test(test_residual_equals_distance_to_searched_projection),
        cmocka_unit_test(test_scale_is_a_third_of_dense_trace),
        cmocka_unit_test(test_rebuilt_velocities_equal_dense_matrices),
    };
    return cmocka_run_group_tests_name("engine_residual", tests, NULL, NULL);
}
