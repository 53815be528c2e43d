/* Islands that start from the impulses of the last step. */
#include "check.h"
#include "solving.h"

#include <math.h>
#include <string.h>

static void started_at_its_answer(pe_contact_problem *source, const char *name)
{
    solving s;
    solving_begin(&s, source);
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
    assert_int_equal(solve_by_newton(&s, PE_NEWTON_TRESCA, &deep, NULL), PE_OK);
    assert_int_equal(s.report.stop, PE_STOP_CONVERGED);
    for (int j = 0; j < source->point_count; ++j) {
        memcpy(source->points[j].impulse, s.problem.impulse[j], sizeof source->points[j].impulse);
    }
    solving_end(&s);

    solving_begin(&s, source);
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
    solving_end(&s);
}

static void test_island_started_at_its_solution_needs_no_iteration(void **state)
{
    (void)state;
    started_at_its_answer(problem_of_box_on_floor(5, 0.5), "box");
    started_at_its_answer(problem_of_box_on_slope(5, 0.5, 0.3), "box that holds on a slope");
    started_at_its_answer(problem_of_box_on_slope(5, 0.5, 0.7), "box that slides");
    started_at_its_answer(problem_of_uniform_tower(10, 0.5), "tower of 10");
    started_at_its_answer(problem_of_uniform_tower(100, 0.5), "tower of 100");
}

static void test_warm_start_exists_where_an_impulse_pushes(void **state)
{
    (void)state;
    solving s;
    pe_contact_problem *source = problem_of_uniform_tower(3, 0.5);
    solving_begin(&s, source);
    assert_false(pe_problem_has_impulse(&s.problem));
    s.problem.impulse[5][1] = 1;
    s.problem.impulse[6][0] = -1;
    assert_false(pe_problem_has_impulse(&s.problem));
    s.problem.impulse[11][0] = 1e-300;
    assert_true(pe_problem_has_impulse(&s.problem));
    pe_contact_problem_destroy(source);
    solving_end(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_island_started_at_its_solution_needs_no_iteration),
        cmocka_unit_test(test_warm_start_exists_where_an_impulse_pushes),
    };
    return cmocka_run_group_tests_name("engine_warm_start", tests, NULL, NULL);
}
