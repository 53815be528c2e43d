/* The direct solver and what it combines, on problems with closed forms, and where it must give up.
 */
#include "check.h"
#include "contact_problem_for_tests.h"
#include "dense_problem.h"
#include "solve/solve_direct.h"
#include "solve/solve_interior_point.h"
#include "solve/solve_island.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ITERATIONS = 400 };
/* ---- Solvers -----------------------------------------------------------------------------------
 */

typedef struct solving {
    test_memory memory;
    pe_workspace work;
    const pe_contact_problem *source;
    pe_problem problem;
    pe_pattern pattern;
    pe_solve_report report;
    double start; /* m/s, where the solver began */
} solving;

typedef pe_status (*solver)(solving *s, const pe_solve_limits *limits, pe_error *error);

static pe_status newton(solving *s, pe_newton_form form, const pe_solve_limits *limits,
                        pe_error *error)
{
    pe_newton_settings settings = pe_newton_settings_for(&s->pattern, form, limits->tolerance);
    s->start = pe_problem_residual(&s->problem).max;
    return pe_newton(&s->problem, &s->pattern, &settings, limits, s->work, &s->report, error);
}

static pe_status solve_cone(solving *s, const pe_solve_limits *limits, pe_error *error)
{
    return newton(s, PE_NEWTON_CONE, limits, error);
}

static pe_status solve_direct(solving *s, const pe_solve_limits *limits, pe_error *error)
{
    s->start = pe_problem_residual(&s->problem).max;
    return pe_solve_direct(&s->problem, &s->pattern, !pe_has_impulse(&s->problem), limits, s->work,
                           &s->report, error);
}

/* The convex problem without a shift. */
static pe_status solve_convex(solving *s, const pe_solve_limits *limits, pe_error *error)
{
    double *shift = calloc((size_t)s->problem.point_count + 1, sizeof *shift);
    assert_non_null(shift);
    pe_status status =
        pe_interior_point(&s->problem, NULL, shift, limits, s->work, &s->report, error);
    free(shift);
    return status;
}

/* Friction is bounded by impulses, so that some are needed, near the answer: those of the convex
 * problem, as the engine has it. */
static pe_status solve_tresca(solving *s, const pe_solve_limits *limits, pe_error *error)
{
    pe_status status = PE_OK;
    if (!pe_has_impulse(&s->problem)) {
        const pe_solve_limits rough = {1e-4, MOST_ITERATIONS};
        status = solve_convex(s, &rough, error);
        s->report.iterations = 0;
        s->report.factor_flops = 0;
    }
    return status == PE_OK ? newton(s, PE_NEWTON_TRESCA, limits, error) : status;
}

static pe_status solve_island(solving *s, const pe_solve_limits *limits, pe_error *error)
{
    const pe_island_limits island = {.tolerance = limits->tolerance,
                                     .swept_tolerance = 5e-5,
                                     .max_updates = 1e6,
                                     .max_iterations = 100000,
                                     .patience = 4};
    pe_island_report report = {.path = PE_PATH_NONE};
    pe_status status = pe_solve_island(&s->problem, &island, s->work, &report, error);
    s->report = report.solve;
    return status;
}

typedef struct named_solver {
    const char *name;
    solver solve;
    double tolerance; /* m/s, to which it solves the closed forms */
    double close;     /* of velocities in m/s, of impulses in parts, that then follow */
} named_solver;

/* The last one solves another problem, with the same answer where nothing slides; its own floor is
 * near 1e-8. */
static const named_solver SOLVERS[] = {{"newton, cone", solve_cone, 1e-11, 1e-9},
                                       {"newton, tresca", solve_tresca, 1e-11, 1e-9},
                                       {"direct", solve_direct, 1e-11, 1e-9},
                                       {"interior point", solve_convex, 1e-8, 1e-6}};
enum { COULOMB_SOLVERS = 3, ALL_SOLVERS = 4, CONVEX = 3 };

static void prepare(solving *s, const pe_contact_problem *source)
{
    *s = (solving){.source = source};
    s->work = test_memory_begin(&s->memory);
    s->problem = solver_problem(source, s->work);
    assert_int_equal(pe_pattern_find(&s->problem, NULL, s->work, &s->pattern, NULL), PE_OK);
}

static void solve_to(solving *s, const pe_contact_problem *source, const named_solver *by,
                     double tolerance)
{
    prepare(s, source);
    pe_solve_limits limits = {tolerance, MOST_ITERATIONS};
    assert_int_equal(by->solve(s, &limits, NULL), PE_OK);
    if (s->report.stop != PE_STOP_CONVERGED) {
        fail_msg("%s: stopped by %d at %g m/s after %d iterations", by->name, (int)s->report.stop,
                 s->report.residual.max, s->report.iterations);
    }
}

static void solved(solving *s, const pe_contact_problem *source, const named_solver *by)
{
    solve_to(s, source, by, by->tolerance);
}

static void finish(solving *s)
{
    test_memory_end(&s->memory);
}

/* ---- Problems ----------------------------------------------------------------------------------
 */

/* Gravity at an angle from the floor's normal: downhill is x. */
static void tilt(pe_contact_problem *problem, double angle)
{
    for (int i = 0; i < problem->body_count; ++i) {
        problem->bodies[i].free_velocity[0] = STEP * GRAVITY * sin(angle);
        problem->bodies[i].free_velocity[2] = -STEP * GRAVITY * cos(angle);
    }
}

static pe_contact_problem *box_on_slope(double mass, double friction, double angle)
{
    pe_contact_problem *problem = problem_of_box_on_floor(mass, friction);
    tilt(problem, angle);
    return problem;
}

static pe_contact_problem *uniform_tower(int count, double friction)
{
    double masses[100];
    for (int i = 0; i < count; ++i) {
        masses[i] = 1;
    }
    return problem_of_tower(masses, count, friction);
}

/* At random, but with v = 0 allowed: no gap is negative. */
static pe_contact_problem *feasible_problem(uint64_t seed, int bodies, int manifolds)
{
    pe_contact_problem *problem = problem_at_random(seed, bodies, manifolds);
    for (int j = 0; j < problem->point_count; ++j) {
        problem->points[j].bias = fabs(problem->points[j].bias);
        memset(problem->points[j].impulse, 0, sizeof problem->points[j].impulse);
    }
    return problem;
}

/* Component k of the impulse of a manifold. */
static double impulse_of(const solving *s, int manifold, int k)
{
    const pe_patch *patch = &s->problem.patch[manifold];
    double sum = 0;
    for (int j = patch->first; j < patch->first + patch->count; ++j) {
        sum += s->problem.impulse[j][k];
    }
    return sum;
}

/* Velocity of body i as the impulses make it. */
static const double *velocity_of(const solving *s, int i)
{
    pe_problem_rebuild_velocity(&s->problem);
    return s->problem.velocity[i];
}

/* ---- Closed forms ------------------------------------------------------------------------------
 */

static void test_a_resting_box_is_carried_by_its_weight(void **state)
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
                assert_close(velocity_of(&s, 0)[c], 0, SOLVERS[k].close, 0);
            }
            pe_contact_problem_destroy(source);
            finish(&s);
        }
    }
}

static void test_contact_k_of_a_tower_carries_all_that_stands_on_it(void **state)
{
    (void)state;
    static const int heights[] = {2, 5, 10, 25};
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        for (int h = 0; h < 4; ++h) {
            solving s;
            int n = heights[h];
            pe_contact_problem *source = uniform_tower(n, 0.5);
            solved(&s, source, &SOLVERS[k]);
            for (int i = 0; i < n; ++i) {
                assert_close(impulse_of(&s, i, 0), (n - i) * GRAVITY * STEP, 0,
                             10 * SOLVERS[k].close);
            }
            print_message("tower of %d: %s: %d iterations\n", n, SOLVERS[k].name,
                          s.report.iterations);
            pe_contact_problem_destroy(source);
            finish(&s);
        }
    }
}

static void test_a_box_stays_on_a_slope_below_the_angle_of_friction(void **state)
{
    (void)state;
    static const double below[] = {0.3, 1e-2, 1e-4, 1e-6};
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        for (int i = 0; i < 4; ++i) {
            solving s;
            double mass = 3, friction = 0.6, angle = atan(friction) - below[i];
            pe_contact_problem *source = box_on_slope(mass, friction, angle);
            solved(&s, source, &SOLVERS[k]);
            for (int c = 0; c < 6; ++c) {
                assert_close(velocity_of(&s, 0)[c], 0, SOLVERS[k].close, 0);
            }
            assert_close(impulse_of(&s, 0, 0), mass * GRAVITY * STEP * cos(angle), 0,
                         10 * SOLVERS[k].close);
            assert_close(impulse_of(&s, 0, 1), -mass * GRAVITY * STEP * sin(angle), 0,
                         10 * SOLVERS[k].close);
            pe_contact_problem_destroy(source);
            finish(&s);
        }
    }
}

static void test_a_box_slides_down_a_steeper_slope_without_lift_on_the_cone(void **state)
{
    (void)state;
    static const double above[] = {0.5, 0.1, 1e-2, 1e-4, 1e-6};
    for (int k = 0; k < COULOMB_SOLVERS; ++k) {
        for (int i = 0; i < 5; ++i) {
            solving s;
            double mass = 3, friction = 0.4, angle = atan(friction) + above[i];
            double slip = GRAVITY * STEP * (sin(angle) - friction * cos(angle));
            pe_contact_problem *source = box_on_slope(mass, friction, angle);
            solved(&s, source, &SOLVERS[k]);
            const double *v = velocity_of(&s, 0);
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
            finish(&s);
        }
    }
}

/* Sliding freely, u_n = mu |u_t|, and p perpendicular to u: all of p_n lies on the cone's edge.
 * With n the normal velocity given by p_n and p_t = -mu p_n, v_x = g h sin - mu P, v_z = P - g h
 * cos with P = p_n/m: P (1 + mu^2) = g h (cos + mu sin). */
static void
test_the_convex_problem_lifts_what_slides_and_its_shift_takes_the_lift_away(void **state)
{
    (void)state;
    solving s;
    double mass = 3, mu = 0.4, angle = atan(mu) + 0.2, fall = GRAVITY * STEP;
    pe_contact_problem *source = box_on_slope(mass, mu, angle);
    solve_to(&s, source, &SOLVERS[CONVEX], 1e-10);
    double push = fall * (cos(angle) + mu * sin(angle)) / (1 + mu * mu);
    const double *v = velocity_of(&s, 0);
    assert_close(v[0], fall * sin(angle) - mu * push, 1e-8, 0);
    assert_close(v[2], push - fall * cos(angle), 1e-8, 0);
    assert_close(v[2], mu * v[0], 1e-8, 0);
    finish(&s);

    prepare(&s, source);
    double slip = fall * (sin(angle) - mu * cos(angle));
    const double shift[4] = {mu * slip, mu * slip, mu * slip, mu * slip};
    const pe_solve_limits limits = {1e-10, MOST_ITERATIONS};
    assert_int_equal(pe_interior_point(&s.problem, NULL, shift, &limits, s.work, &s.report, NULL),
                     PE_OK);
    assert_int_equal(s.report.stop, PE_STOP_CONVERGED);
    v = velocity_of(&s, 0);
    assert_close(v[0], slip, 1e-8, 0);
    assert_close(v[2], 0, 1e-8, 0);
    assert_at_most(s.report.residual.max, 1e-8);
    pe_contact_problem_destroy(source);
    finish(&s);
}

static void
test_without_friction_a_tower_slides_off_whole_and_no_impulse_is_tangential(void **state)
{
    (void)state;
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        solving s;
        double angle = 0.3;
        pe_contact_problem *source = uniform_tower(6, 0);
        tilt(source, angle);
        solved(&s, source, &SOLVERS[k]);
        for (int i = 0; i < 6; ++i) {
            assert_close(velocity_of(&s, i)[0], GRAVITY * STEP * sin(angle), SOLVERS[k].close, 0);
            assert_close(velocity_of(&s, i)[2], 0, SOLVERS[k].close, 0);
            assert_close(impulse_of(&s, i, 0), (6 - i) * GRAVITY * STEP * cos(angle), 0,
                         10 * SOLVERS[k].close);
        }
        for (int j = 0; j < s.problem.point_count; ++j) {
            assert_true(s.problem.impulse[j][1] == 0 && s.problem.impulse[j][2] == 0);
        }
        pe_contact_problem_destroy(source);
        finish(&s);
    }
}

static void test_a_mass_ratio_of_a_million_is_carried_like_any_other(void **state)
{
    (void)state;
    static const double towers[][3] = {{1, 1e6, 1}, {1e6, 1, 1e6}, {1, 1, 1e6}, {1e6, 1e3, 1}};
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        for (int t = 0; t < 4; ++t) {
            solving s;
            pe_contact_problem *source = problem_of_tower(towers[t], 3, 0.5);
            /* What a million kilograms push with is known to a rounding that moves a kilogram by
             * 4e-11 m/s. */
            solve_to(&s, source, &SOLVERS[k], fmax(SOLVERS[k].tolerance, 1e-9));
            double above = 0;
            for (int i = 2; i >= 0; --i) {
                above += towers[t][i];
                assert_close(impulse_of(&s, i, 0), above * GRAVITY * STEP, 0,
                             10 * SOLVERS[k].close);
                assert_close(velocity_of(&s, i)[2], 0, fmax(SOLVERS[k].close, 1e-8), 0);
            }
            pe_contact_problem_destroy(source);
            finish(&s);
        }
    }
}

/* A box whose corners at +x have a gap that closes at the speed `b`: it turns about its corners at
 * -x. With a cube's inertia m/6 the turning alone closes it at 1.2 g h; up to there both sides
 * touch and share the impulse as the velocities -b/2 and -b of the two sides ask for. */
static void test_a_gap_on_one_side_closes_as_far_as_the_box_can_turn(void **state)
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
            assert_close(velocity_of(&s, 0)[2], meets ? -0.5 * b : -0.6 * fall, SOLVERS[k].close,
                         0);
            assert_close(velocity_of(&s, 0)[4], meets ? b : 1.2 * fall, 10 * SOLVERS[k].close, 0);
            pe_contact_problem_destroy(source);
            finish(&s);
        }
    }
}

static void test_a_gap_that_stays_open_carries_nothing_and_one_that_closes_stops_at_it(void **state)
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
            assert_close(velocity_of(&s, 0)[2], i == 0 ? -fall : -b, SOLVERS[k].close, 0);
            assert_close(impulse_of(&s, 0, 0), i == 0 ? 0 : 2 * (fall - b), 10 * SOLVERS[k].close,
                         0);
            pe_contact_problem_destroy(source);
            finish(&s);
        }
    }
}

/* ---- Laws without a closed form ----------------------------------------------------------------
 */

/* Coulomb's laws by other formulas, where the solver says that it has solved it. */
static void
test_what_is_called_solved_obeys_coulomb_and_the_residual_is_that_of_the_impulses(void **state)
{
    (void)state;
    for (int k = 0; k < COULOMB_SOLVERS; ++k) {
        int solved_count = 0;
        for (uint64_t seed = 1; seed <= 40; ++seed) {
            solving s;
            pe_contact_problem *source = feasible_problem(seed, 5, 7);
            prepare(&s, source);
            const pe_solve_limits limits = {1e-9, MOST_ITERATIONS};
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
            finish(&s);
        }
        print_message("%s: %d of 40 random problems solved to 1e-9\n", SOLVERS[k].name,
                      solved_count);
        assert_true(solved_count > 0);
    }
}

/* Karush, Kuhn and Tucker of min 1/2 |v - v*|_M^2 with z = u + shift n in K*: p in K, z in K*, p
 * and z perpendicular, and v the velocities of p, which `reference_` works out anew. */
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

static void test_the_interior_point_answer_is_optimal_to_its_tolerance(void **state)
{
    (void)state;
    static const double tolerances[] = {1e-3,
                                        1e-4}; /* below 1e-5 it loses its way: see its header */
    for (int t = 0; t < 2; ++t) {
        double worst = 0;
        for (uint64_t seed = 1; seed <= 40; ++seed) {
            solving s;
            pe_contact_problem *source = feasible_problem(seed, 8, 12);
            check_random random = {seed};
            double shift[200];
            prepare(&s, source);
            for (int j = 0; j < source->point_count; ++j) {
                shift[j] = seed % 2 == 0 ? 0 : check_uniform(&random, 0, 1);
            }
            const pe_solve_limits limits = {tolerances[t], 60};
            assert_int_equal(
                pe_interior_point(&s.problem, NULL, shift, &limits, s.work, &s.report, NULL),
                PE_OK);
            if (s.report.stop != PE_STOP_CONVERGED) {
                fail_msg("seed %d: stopped by %d after %d iterations", (int)seed,
                         (int)s.report.stop, s.report.iterations);
            }
            /* Natural maps bound these to within a factor of the cone and of the sizes. */
            double fault = convex_fault(source, &s.problem, shift);
            assert_at_most(fault, 10 * tolerances[t]);
            worst = fmax(worst, fault);
            assert_close(s.report.residual.max, pe_problem_residual(&s.problem).max, 1e-15, 1e-9);
            pe_contact_problem_destroy(source);
            finish(&s);
        }
        print_message("interior point to %g m/s: optimal to %g\n", tolerances[t], worst);
    }
}

static void test_patches_left_out_of_the_interior_point_method_get_no_impulse(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        solving whole, part;
        pe_contact_problem *source = feasible_problem(seed, 8, 12);
        bool loaded[12];
        double shift[200] = {0};
        int points = 0;
        prepare(&part, source);
        for (int i = 0; i < 12; ++i) {
            loaded[i] = i % 3 != 0;
        }
        const pe_solve_limits limits = {1e-4, MOST_ITERATIONS};
        assert_int_equal(
            pe_interior_point(&part.problem, loaded, shift, &limits, part.work, &part.report, NULL),
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
                assert_close(velocity_of(&part, i)[c], velocity_of(&whole, i)[c], 1e-12, 0);
            }
        }
        pe_contact_problem_destroy(rest);
        pe_contact_problem_destroy(source);
        finish(&whole);
        finish(&part);
    }
}

static void test_shifts_are_mu_times_the_slip(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        solving s;
        pe_contact_problem *source = problem_at_random(seed, 5, 8);
        double shift[100], u[100][3];
        prepare(&s, source);
        pe_solve_shifts(&s.problem, shift);
        reference_contact_velocities(source, (const double(*)[6])s.problem.velocity, u);
        for (int i = 0; i < source->manifold_count; ++i) {
            const pe_problem_manifold *m = &source->manifolds[i];
            for (int j = m->first; j < m->first + m->count; ++j) {
                assert_close(shift[j], m->friction * hypot(u[j][1], u[j][2]), 1e-13, 1e-12);
            }
        }
        pe_contact_problem_destroy(source);
        finish(&s);
    }
}

/* ---- Giving up ---------------------------------------------------------------------------------
 */

/* A problem that takes many iterations: a tower of heavy on light, pushed. */
static pe_contact_problem *hard_problem(void)
{
    double masses[20];
    for (int i = 0; i < 20; ++i) {
        masses[i] = 1 + 10 * i;
    }
    pe_contact_problem *problem = problem_of_tower(masses, 20, 0.3);
    problem->bodies[10].free_velocity[0] = 0.5;
    problem->bodies[3].free_velocity[5] = 2;
    return problem;
}

static void test_one_iteration_is_reported_as_too_few_and_leaves_the_best(void **state)
{
    (void)state;
    for (int k = 0; k < ALL_SOLVERS; ++k) {
        solving s;
        pe_contact_problem *source = hard_problem();
        prepare(&s, source);
        const pe_solve_limits limits = {1e-10, 1};
        assert_int_equal(SOLVERS[k].solve(&s, &limits, NULL), PE_OK);
        assert_int_equal(s.report.stop, PE_STOP_ITERATIONS);
        assert_int_equal(s.report.iterations, 1);
        assert_true(s.report.factor_flops > 0);
        const double *last = s.problem.velocity[19];
        double before[6];
        memcpy(before, last, sizeof before);
        pe_problem_rebuild_velocity(&s.problem);
        assert_memory_equal(before, last, sizeof before); /* in step with the impulses */
        assert_close(s.report.residual.max, pe_problem_residual(&s.problem).max, 1e-15, 1e-9);
        assert_true(s.report.residual.max > 1e-10);
        if (k < COULOMB_SOLVERS) {
            assert_at_most(s.report.residual.max, s.start);
        }
        pe_contact_problem_destroy(source);
        finish(&s);
    }
}

static void test_no_limit_is_passed_and_none_leaves_worse_than_the_start(void **state)
{
    (void)state;
    for (int k = 0; k < COULOMB_SOLVERS; ++k) {
        for (int most = 0; most <= 60; ++most) {
            solving s;
            pe_contact_problem *source = hard_problem();
            for (int j = 0; j < source->point_count; ++j) {
                source->points[j].impulse[0] = 1; /* something to start from, for every form */
            }
            prepare(&s, source);
            const pe_solve_limits limits = {1e-10, most};
            assert_int_equal(SOLVERS[k].solve(&s, &limits, NULL), PE_OK);
            assert_at_most(s.report.iterations, most);
            pe_problem_rebuild_velocity(&s.problem);
            double left = pe_problem_residual(&s.problem).max;
            assert_at_most(left, s.start);
            assert_close(s.report.residual.max, left, 1e-15, 1e-9);
            assert_int_equal(s.report.stop == PE_STOP_CONVERGED, left <= 1e-10);
            pe_contact_problem_destroy(source);
            finish(&s);
        }
    }
}

/* Where a NaN may come from. */
static void poison(pe_contact_problem *problem, int place)
{
    const double nan = (double)NAN;
    if (place == 0) {
        problem->bodies[1].free_velocity[0] = nan;
    } else if (place == 1) {
        problem->points[6].bias = nan;
    } else if (place == 2) {
        problem->manifolds[1].friction = nan;
    } else if (place == 3) {
        problem->bodies[1].inertia[0] = nan;
    } else {
        problem->points[6].impulse[0] = nan;
    }
}

static void test_a_problem_with_nan_ends_and_is_not_called_solved(void **state)
{
    (void)state;
    static const named_solver island = {.name = "island", .solve = solve_island};
    for (int k = 0; k <= ALL_SOLVERS; ++k) {
        const named_solver *by = k < ALL_SOLVERS ? &SOLVERS[k] : &island;
        for (int place = 0; place < 5; ++place) {
            for (int warm = 0; warm < 2; ++warm) {
                solving s;
                pe_contact_problem *source = uniform_tower(4, 0.5);
                for (int j = 0; j < source->point_count; ++j) {
                    source->points[j].impulse[0] = warm ? 0.03 : 0;
                }
                poison(source, place);
                prepare(&s, source);
                const pe_solve_limits limits = {1e-8, MOST_ITERATIONS};
                assert_int_equal(by->solve(&s, &limits, NULL), PE_OK);
                pe_problem_rebuild_velocity(&s.problem);
                bool is_solved = pe_problem_residual(&s.problem).max <= 1e-8;
                if (is_solved != (s.report.stop == PE_STOP_CONVERGED) ||
                    is_solved != (s.report.residual.max <= 1e-8)) {
                    fail_msg("%s, NaN %d: said to stop by %d at %g, it is %g", by->name, place,
                             (int)s.report.stop, s.report.residual.max,
                             pe_problem_residual(&s.problem).max);
                }
                pe_contact_problem_destroy(source);
                finish(&s);
            }
        }
    }
}

/* No iterate was better than the start, so that the start is what is left. */
static void test_a_problem_with_nan_leaves_the_impulses_that_it_began_with(void **state)
{
    (void)state;
    for (int k = 0; k < COULOMB_SOLVERS; ++k) {
        for (int place = 0; place < 4; ++place) {
            solving s;
            pe_contact_problem *source = uniform_tower(4, 0.5);
            for (int j = 0; j < source->point_count; ++j) {
                source->points[j].impulse[0] = 0.03 + 0.001 * j;
            }
            poison(source, place);
            prepare(&s, source);
            const pe_solve_limits limits = {1e-8, MOST_ITERATIONS};
            assert_int_equal(SOLVERS[k].solve(&s, &limits, NULL), PE_OK);
            for (int j = 0; j < source->point_count; ++j) {
                if (!(s.problem.impulse[j][0] == source->points[j].impulse[0])) {
                    fail_msg("%s, NaN %d: impulse %d began as %g and was left as %g",
                             SOLVERS[k].name, place, j, source->points[j].impulse[0],
                             s.problem.impulse[j][0]);
                }
            }
            pe_contact_problem_destroy(source);
            finish(&s);
        }
    }
}

static void test_every_failed_allocation_is_reported(void **state)
{
    (void)state;
    const named_solver by[] = {
        SOLVERS[0], SOLVERS[1], SOLVERS[2], SOLVERS[3], {.name = "island", .solve = solve_island}};
    for (int i = 0; i < 5; ++i) {
        pe_contact_problem *source = hard_problem();
        /* Tighter than any solver gets, so that it tries all that it has. */
        const pe_solve_limits limits = {1e-30, 60};
        long total = 0;
        for (long k = 0; k == 0 || k <= total; ++k) {
            solving s;
            pe_error error = {0};
            prepare(&s, source);
            long before = s.memory.made;
            s.memory.fail_at = k == 0 ? 0 : before + k;
            pe_status status = by[i].solve(&s, &limits, &error);
            if (k == 0) {
                assert_int_equal(status, PE_OK);
                total = s.memory.made - before;
                assert_true(total >= 10);
                print_message("%s: %ld allocations failed in turn\n", by[i].name, total);
            } else if (status != PE_NO_MEMORY || error.status != PE_NO_MEMORY) {
                fail_msg("%s: allocation %ld of %ld failed: status %d", by[i].name, k, total,
                         (int)status);
            }
            finish(&s);
        }
        pe_contact_problem_destroy(source);
    }
}

/* ---- Warm starts -------------------------------------------------------------------------------
 */

static void started_at_its_answer(pe_contact_problem *source, const char *name)
{
    solving s;
    prepare(&s, source);
    const pe_island_limits limits = {.tolerance = 1e-8,
                                     .swept_tolerance = 5e-5,
                                     .max_updates = 1e6,
                                     .max_iterations = 100000,
                                     .patience = 4};
    pe_island_report report = {.path = PE_PATH_NONE};
    assert_int_equal(pe_solve_island(&s.problem, &limits, s.work, &report, NULL), PE_OK);
    print_message("%s: %d iterations to %g m/s, then none\n", name, report.solve.iterations,
                  report.solve.residual.max);
    assert_int_equal(report.path, PE_PATH_DIRECT);
    assert_int_equal(report.solve.stop, PE_STOP_CONVERGED);
    assert_true(report.solve.iterations > 0);
    /* A solve ends at the tolerance, the answer is deeper. */
    const pe_solve_limits deep = {1e-12, 60};
    assert_int_equal(newton(&s, PE_NEWTON_TRESCA, &deep, NULL), PE_OK);
    assert_int_equal(s.report.stop, PE_STOP_CONVERGED);
    for (int j = 0; j < source->point_count; ++j) {
        memcpy(source->points[j].impulse, s.problem.impulse[j], sizeof source->points[j].impulse);
    }
    finish(&s);

    prepare(&s, source);
    report = (pe_island_report){.path = PE_PATH_NONE};
    assert_int_equal(pe_solve_island(&s.problem, &limits, s.work, &report, NULL), PE_OK);
    assert_int_equal(report.path, PE_PATH_WARM);
    assert_int_equal(report.solve.iterations, 0);
    assert_int_equal(report.solve.stop, PE_STOP_CONVERGED);
    assert_true(report.solve.factor_flops == 0);
    for (int j = 0; j < source->point_count; ++j) {
        assert_memory_equal(source->points[j].impulse, s.problem.impulse[j],
                            sizeof s.problem.impulse[j]);
    }
    pe_contact_problem_destroy(source);
    finish(&s);
}

static void test_an_island_that_starts_at_its_answer_takes_no_iteration(void **state)
{
    (void)state;
    started_at_its_answer(problem_of_box_on_floor(5, 0.5), "box");
    started_at_its_answer(box_on_slope(5, 0.5, 0.3), "box that holds on a slope");
    started_at_its_answer(box_on_slope(5, 0.5, 0.7), "box that slides");
    started_at_its_answer(uniform_tower(10, 0.5), "tower of 10");
    started_at_its_answer(uniform_tower(100, 0.5), "tower of 100");
}

static void test_there_is_an_impulse_to_start_from_where_one_pushes(void **state)
{
    (void)state;
    solving s;
    pe_contact_problem *source = uniform_tower(3, 0.5);
    prepare(&s, source);
    assert_false(pe_has_impulse(&s.problem));
    s.problem.impulse[5][1] = 1;
    s.problem.impulse[6][0] = -1;
    assert_false(pe_has_impulse(&s.problem));
    s.problem.impulse[11][0] = 1e-300;
    assert_true(pe_has_impulse(&s.problem));
    pe_contact_problem_destroy(source);
    finish(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_resting_box_is_carried_by_its_weight),
        cmocka_unit_test(test_contact_k_of_a_tower_carries_all_that_stands_on_it),
        cmocka_unit_test(test_a_box_stays_on_a_slope_below_the_angle_of_friction),
        cmocka_unit_test(test_a_box_slides_down_a_steeper_slope_without_lift_on_the_cone),
        cmocka_unit_test(
            test_the_convex_problem_lifts_what_slides_and_its_shift_takes_the_lift_away),
        cmocka_unit_test(
            test_without_friction_a_tower_slides_off_whole_and_no_impulse_is_tangential),
        cmocka_unit_test(test_a_mass_ratio_of_a_million_is_carried_like_any_other),
        cmocka_unit_test(test_a_gap_on_one_side_closes_as_far_as_the_box_can_turn),
        cmocka_unit_test(
            test_a_gap_that_stays_open_carries_nothing_and_one_that_closes_stops_at_it),
        cmocka_unit_test(
            test_what_is_called_solved_obeys_coulomb_and_the_residual_is_that_of_the_impulses),
        cmocka_unit_test(test_the_interior_point_answer_is_optimal_to_its_tolerance),
        cmocka_unit_test(test_patches_left_out_of_the_interior_point_method_get_no_impulse),
        cmocka_unit_test(test_shifts_are_mu_times_the_slip),
        cmocka_unit_test(test_one_iteration_is_reported_as_too_few_and_leaves_the_best),
        cmocka_unit_test(test_no_limit_is_passed_and_none_leaves_worse_than_the_start),
        cmocka_unit_test(test_a_problem_with_nan_ends_and_is_not_called_solved),
        cmocka_unit_test(test_a_problem_with_nan_leaves_the_impulses_that_it_began_with),
        cmocka_unit_test(test_every_failed_allocation_is_reported),
        cmocka_unit_test(test_an_island_that_starts_at_its_answer_takes_no_iteration),
        cmocka_unit_test(test_there_is_an_impulse_to_start_from_where_one_pushes),
    };
    return cmocka_run_group_tests_name("engine_direct", tests, NULL, NULL);
}
