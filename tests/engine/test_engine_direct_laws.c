/* The direct solvers on problems without a closed form: laws that their solutions obey. */
#include "check.h"
#include "solving.h"

#include <math.h>
#include <string.h>

/* A random problem that v = 0 satisfies: no gap is negative. */
static pe_contact_problem *feasible_problem(uint64_t seed, int bodies, int manifolds)
{
    pe_contact_problem *problem = problem_at_random(seed, bodies, manifolds);
    for (int j = 0; j < problem->point_count; ++j) {
        problem->points[j].bias = fabs(problem->points[j].bias);
        memset(problem->points[j].impulse, 0, sizeof problem->points[j].impulse);
    }
    return problem;
}

/* Coulomb's laws by independent formulas, where the solver reports convergence. */
static void test_solved_impulses_obey_coulomb_and_give_the_residual(void **state)
{
    (void)state;
    for (int k = 0; k < COULOMB_SOLVERS; ++k) {
        int solved_count = 0;
        for (uint64_t seed = 1; seed <= 40; ++seed) {
            solving s;
            pe_contact_problem *source = feasible_problem(seed, 5, 7);
            solving_begin(&s, source);
            const pe_solve_limits limits = {1e-9, SOLVING_ITERATIONS};
            assert_int_equal(SOLVERS[k].solve(&s, &limits, NULL), PE_OK);
            pe_problem_rebuild_velocity(&s.problem);
            pe_residual left = pe_problem_residual(&s.problem);
            assert_close(s.report.residual.max, left.max, 1e-15, 1e-9);
            assert_close(s.report.residual.rms, left.rms, 1e-15, 1e-9);
            assert_at_most(left.max, s.start);
            assert_int_equal(s.report.stop == PE_STOP_CONVERGED, left.max <= 1e-9);
            if (s.report.stop == PE_STOP_CONVERGED) {
                solved_count += 1;
                assert_at_most(solver_problem_fault(source, &s.problem), 1e-7);
            }
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
        print_message("%s: %d of 40 random problems solved to 1e-9\n", SOLVERS[k].name,
                      solved_count);
        assert_true(solved_count > 0);
    }
}

/* Karush, Kuhn and Tucker of min 1/2 |v - v*|_M^2 with z = u + shift n in K*: p in K, z in K*, p
 * and z perpendicular, and v the velocities of p, which `reference_` computes again. */
static double convex_fault(const pe_contact_problem *source, const pe_problem *problem,
                           const double *shift)
{
    double v[16][6], u[200][3], worst = 0;
    reference_velocities(source, (const double(*)[3])problem->impulse, v);
    reference_contact_velocities(source, (const double(*)[6])v, u);
    for (int i = 0; i < source->manifold_count; ++i) {
        const pe_problem_manifold *m = &source->manifolds[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            const double *p = problem->impulse[j], w = problem->point[j].scale;
            double z = u[j][0] + shift[j], product = p[0] * z + p[1] * u[j][1] + p[2] * u[j][2];
            double size = fmax(1, w * fabs(p[0]) + fabs(z) + hypot(u[j][1], u[j][2]));
            worst = fmax(worst, m->friction * hypot(u[j][1], u[j][2]) - z);
            worst = fmax(worst, w * (hypot(p[1], p[2]) - m->friction * p[0]));
            worst = fmax(worst, w * fabs(product) / size);
        }
    }
    return worst;
}

static void test_interior_point_is_optimal_to_its_tolerance(void **state)
{
    (void)state;
    static const double tolerances[] = {1e-3, 1e-4}; /* below 1e-5 it may fail: see its header */
    for (int t = 0; t < 2; ++t) {
        double worst = 0;
        for (uint64_t seed = 1; seed <= 40; ++seed) {
            solving s;
            pe_contact_problem *source = feasible_problem(seed, 8, 12);
            check_random random = {seed};
            double shift[200];
            solving_begin(&s, source);
            for (int j = 0; j < source->point_count; ++j) {
                shift[j] = seed % 2 == 0 ? 0 : check_uniform(&random, 0, 1);
            }
            const pe_solve_limits limits = {tolerances[t], 60};
            assert_int_equal(pe_interior_point(&s.problem, &(pe_convex_form){NULL, shift}, &limits,
                                               s.work, &s.report, NULL),
                             PE_OK);
            if (s.report.stop != PE_STOP_CONVERGED) {
                fail_msg("seed %d: stopped by %d after %d iterations", (int)seed,
                         (int)s.report.stop, s.report.iterations);
            }
            /* The natural map bounds these up to a factor of the cone and the sizes. */
            double fault = convex_fault(source, &s.problem, shift);
            assert_at_most(fault, 10 * tolerances[t]);
            worst = fmax(worst, fault);
            assert_close(s.report.residual.max, pe_problem_residual(&s.problem).max, 1e-15, 1e-9);
            pe_contact_problem_destroy(source);
            solving_end(&s);
        }
        print_message("interior point to %g m/s: optimal to %g\n", tolerances[t], worst);
    }
}

static void test_manifolds_left_out_get_no_impulse(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        solving whole, part;
        pe_contact_problem *source = feasible_problem(seed, 8, 12);
        bool loaded[12];
        double shift[200] = {0};
        int points = 0;
        solving_begin(&part, source);
        for (int i = 0; i < 12; ++i) {
            loaded[i] = i % 3 != 0;
        }
        const pe_solve_limits limits = {1e-4, SOLVING_ITERATIONS};
        assert_int_equal(pe_interior_point(&part.problem, &(pe_convex_form){loaded, shift}, &limits,
                                           part.work, &part.report, NULL),
                         PE_OK);
        /* The same without them in the problem: the same velocities. */
        pe_contact_problem *rest = feasible_problem(seed, 8, 12);
        rest->manifold_count = 0;
        for (int i = 0; i < 12; ++i) {
            pe_problem_manifold m = source->manifolds[i];
            if (loaded[i]) {
                memcpy(&rest->points[points], &source->points[m.first],
                       (size_t)m.count * sizeof *rest->points);
                m.first = points;
                points += m.count;
                rest->manifolds[rest->manifold_count++] = m;
            } else {
                for (int j = m.first; j < m.first + m.count; ++j) {
                    const double *p = part.problem.impulse[j];
                    assert_true(p[0] == 0 && p[1] == 0 && p[2] == 0);
                }
            }
        }
        rest->point_count = points;
        solve_to(&whole, rest, &SOLVERS[CONVEX], 1e-4);
        for (int i = 0; i < 8; ++i) {
            for (int c = 0; c < 6; ++c) {
                assert_close(solving_velocity(&part, i)[c], solving_velocity(&whole, i)[c], 1e-12,
                             0);
            }
        }
        pe_contact_problem_destroy(rest);
        pe_contact_problem_destroy(source);
        solving_end(&whole);
        solving_end(&part);
    }
}

static void test_shifts_are_mu_times_the_slip(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        solving s;
        pe_contact_problem *source = problem_at_random(seed, 5, 8);
        double shift[100], u[100][3];
        solving_begin(&s, source);
        pe_problem_find_shifts(&s.problem, shift);
        reference_contact_velocities(source, (const double(*)[6])s.problem.velocity, u);
        for (int i = 0; i < source->manifold_count; ++i) {
            const pe_problem_manifold *m = &source->manifolds[i];
            for (int j = m->first; j < m->first + m->count; ++j) {
                assert_close(shift[j], m->friction * hypot(u[j][1], u[j][2]), 1e-13, 1e-12);
            }
        }
        pe_contact_problem_destroy(source);
        solving_end(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solved_impulses_obey_coulomb_and_give_the_residual),
        cmocka_unit_test(test_interior_point_is_optimal_to_its_tolerance),
        cmocka_unit_test(test_manifolds_left_out_get_no_impulse),
        cmocka_unit_test(test_shifts_are_mu_times_the_slip),
    };
    return cmocka_run_group_tests_name("engine_direct_laws", tests, NULL, NULL);
}
