/* Our solvers against solvers that we have no part in: Siconos' friction-contact solvers (Acary and
 * others, INRIA), on the very same problems. Both get the same W = J M^-1 J^T and q = J v* + b,
 * worked out here by formulas of the test's own. Impulses need not be unique, velocities are
 * compared. */
#include "check.h"

#include <stdio.h>

#ifndef PLUMB_HAVE_SICONOS

int main(void)
{
    fputs("skipped: this build has no Siconos (Debian package libsiconos-numerics-dev)\n", stderr);
    return 77;
}

#else

#include "contact_problem_for_tests.h"
#include "plumb_process.h"
#include "problem_file.h"
#include "siconos_answer.h"

#include <Friction_cst.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What ours are asked for; what counts as an answer, by our residual; and how near velocities must
 * then be. All in m/s. */
static const double TOLERANCE = 1e-12, SOLVED = 1e-8, SAME_VELOCITY = 1e-6;

/* Our solution from zero impulses. */
static pe_contact_solution solve_by_ours(const pe_contact_problem *problem, const char *solver)
{
    const pe_solve_limits limits = {.tolerance = TOLERANCE, .max_iterations = 20000};
    pe_contact_solution solution;
    pe_error error;
    if (pe_contact_problem_solve(problem, solver, &limits, NULL, &solution, &error) != PE_OK) {
        fail_msg("%s", error.message);
    }
    return solution;
}

/* Our residual of the impulses that the problem carries. */
static double own_residual(const pe_contact_problem *problem)
{
    pe_contact_solution s;
    const pe_solve_limits look = {.tolerance = HUGE_VAL};
    assert_int_equal(pe_contact_problem_solve(problem, pe_solver(0).name, &look, NULL, &s, NULL),
                     PE_OK);
    double residual = s.start.max;
    pe_contact_solution_free(&s);
    return residual;
}

static void drop_impulses(pe_contact_problem *problem)
{
    for (int j = 0; j < problem->point_count; ++j) {
        memset(problem->points[j].impulse, 0, sizeof problem->points[j].impulse);
    }
}

/* Coulomb friction in three dimensions may have several answers (Klarbring 1990): of problems in
 * which it does, those count where both found the same. */
typedef enum answers { ONE_ANSWER, MAYBE_SEVERAL } answers;

static bool compare_velocities(const pe_contact_problem *problem, const char *name,
                               const char *ours, const pe_contact_solution *solution,
                               const double (*theirs)[6], double residual, answers expected)
{
    double worst = 0;
    for (int i = 0; i < problem->body_count; ++i) {
        for (int k = 0; k < 6; ++k) {
            worst = fmax(worst, fabs(solution->velocities[i][k] - theirs[i][k]));
        }
    }
    if (worst <= SAME_VELOCITY) {
        return true;
    }
    if (expected == ONE_ANSWER || !isfinite(worst)) {
        fail_msg("%s: %s (residual %g) and Siconos (residual %g) differ by %g m/s", name, ours,
                 solution->residual.max, residual, worst);
    }
    print_message("%s: %s and Siconos found two answers, %g m/s apart\n", name, ours, worst);
    return false;
}

/* Every solver of ours that gets to an answer gives Siconos' velocities. Whether there was anything
 * to compare: Siconos has an answer by our residual, and so has `must`. Destroys the problem. */
static bool agrees(const char *name, pe_contact_problem *problem, int siconos, const char *must,
                   answers expected)
{
    double(*theirs)[6] = calloc((size_t)problem->body_count, sizeof *theirs);
    double(*p)[3] = calloc((size_t)problem->point_count, sizeof *p);
    assert_true(theirs != NULL && p != NULL);
    assert_true(siconos_answer(problem, siconos));
    for (int j = 0; j < problem->point_count; ++j) {
        memcpy(p[j], problem->points[j].impulse, sizeof p[j]);
    }
    reference_velocities(problem, (const double(*)[3])p, theirs);
    double residual = own_residual(problem);
    bool compared = false;
    drop_impulses(problem);
    for (int i = 0; i < pe_solver_count() && residual <= SOLVED; ++i) {
        const char *ours = pe_solver(i).name;
        pe_contact_solution solution = solve_by_ours(problem, ours);
        if (solution.residual.max <= SOLVED) {
            bool same = compare_velocities(problem, name, ours, &solution,
                                           (const double(*)[6])theirs, residual, expected);
            compared = compared || (same && strcmp(ours, must) == 0);
        }
        pe_contact_solution_free(&solution);
    }
    free(theirs);
    free(p);
    pe_contact_problem_destroy(problem);
    return compared;
}

/* By Gauss-Seidel over the points, with exact local solves. */
static void check_by_sweeps(const char *name, pe_contact_problem *problem)
{
    if (!agrees(name, problem, SICONOS_FRICTION_3D_NSGS, "direct", ONE_ANSWER)) {
        fail_msg("%s: one of the two has no answer", name);
    }
}

/* The problem of the largest island in this step, from 1. The scenario's name can be followed by
 * options of plumb run. */
static pe_contact_problem *capture(const char *scenario, int step)
{
    workspace w = make_workspace();
    char words[256], message[PROBLEM_MESSAGE_SIZE];
    snprintf(words, sizeof words, "run %s --engine plumb:accurate --capture %d:#", scenario, step);
    plumb_output output = wait_plumb(w.directory, start_plumb_words(&w, words));
    pe_contact_problem *problem = problem_read_file(w.out, message);
    if (problem == NULL) {
        fail_msg("%s: %s; %s", scenario, message, output.err);
    }
    free_output(&output);
    remove_workspace(&w);
    return problem;
}

static void check_captured(const char *scenario, int step)
{
    check_by_sweeps(scenario, capture(scenario, step));
}

/* On three points: on four, slipping in different directions, how they share the load is open, and
 * with it the friction and the motion. */
static pe_contact_problem *sliding_box(void)
{
    pe_contact_problem *problem = problem_of_box_on_floor(2, 0.4);
    problem->manifolds[0].count = problem->point_count = 3;
    problem->bodies[0].free_velocity[0] = 1;
    problem->bodies[0].free_velocity[1] = -0.5;
    problem->bodies[0].free_velocity[5] = 0.3; /* spinning too */
    return problem;
}

static void test_sliding_spinning_box_agrees_with_siconos(void **state)
{
    (void)state;
    check_by_sweeps("sliding box", sliding_box());
    assert_true(
        agrees("sliding box", sliding_box(), SICONOS_FRICTION_3D_NSN_AC, "direct", ONE_ANSWER));
}

static pe_contact_problem *struck_tower(void)
{
    const double masses[] = {1, 4, 0.5, 2};
    pe_contact_problem *problem = problem_of_tower(masses, 4, 0.6);
    problem->bodies[2].free_velocity[0] = 0.7;
    problem->bodies[3].free_velocity[4] = -0.2;
    return problem;
}

static void test_struck_tower_agrees_with_siconos(void **state)
{
    (void)state;
    check_by_sweeps("struck tower", struck_tower());
}

static void test_standing_tower_agrees_with_siconos(void **state)
{
    (void)state;
    check_captured("tower --set n=5", 1);
}

static void test_slopes_agree_with_siconos(void **state)
{
    (void)state;
    check_captured("slope-stick", 10);
    check_captured("slope-slide", 10);
}

static void test_mass_ratio_of_a_hundred_agrees_with_siconos(void **state)
{
    (void)state;
    check_captured("mass-ratio --set k=2", 1);
}

static void test_small_wall_agrees_with_siconos(void **state)
{
    (void)state;
    check_captured("wall --set rows=3 --set columns=3", 1);
}

/* How many of several small piles in mid-fall could be compared. A loose pile is for sweeps with
 * momentum: no direct method, Siconos' neither, promises to solve every one. */
static int count_piles(const char *shape, int siconos)
{
    int compared = 0;
    for (int seed = 1; seed <= 6; ++seed) {
        char scenario[64];
        snprintf(scenario, sizeof scenario, "pile --set n=5 --set shape=%s --seed %d", shape, seed);
        compared += agrees("pile", capture(scenario, 50), siconos, "momentum", MAYBE_SEVERAL);
    }
    return compared;
}

static void test_small_piles_agree_with_siconos(void **state)
{
    (void)state;
    assert_true(count_piles("2", SICONOS_FRICTION_3D_NSGS) >= 3);
}

/* Newton on Alart and Curnier's function factorises W, so that no contact may be redundant. */
static void test_piles_of_spheres_agree_with_siconos_by_newton(void **state)
{
    (void)state;
    assert_true(count_piles("0", SICONOS_FRICTION_3D_NSN_AC) >= 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sliding_spinning_box_agrees_with_siconos),
        cmocka_unit_test(test_struck_tower_agrees_with_siconos),
        cmocka_unit_test(test_standing_tower_agrees_with_siconos),
        cmocka_unit_test(test_slopes_agree_with_siconos),
        cmocka_unit_test(test_mass_ratio_of_a_hundred_agrees_with_siconos),
        cmocka_unit_test(test_small_wall_agrees_with_siconos),
        cmocka_unit_test(test_small_piles_agree_with_siconos),
        cmocka_unit_test(test_piles_of_spheres_agree_with_siconos_by_newton),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#endif
