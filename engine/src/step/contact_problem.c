/* The solvers by name, run on contact problems given as data. */
#include "plumb/contact_problem.h"

#include "solver/solve.h"

#include <string.h>

typedef struct named_solver {
    pe_solver_info info;
    pe_solve_function solve;
} named_solver;

static const named_solver SOLVERS[] = {
    {{"gauss_seidel", "projected Gauss-Seidel sweeps with a round friction cone", false},
     pe_solve_gauss_seidel},
    {{"momentum", "the same sweeps at extrapolated impulses, with restarts", false},
     pe_solve_momentum},
    {{"newton", "proximal augmented Lagrangian with semismooth Newton steps", true},
     pe_solve_newton},
    {{"interior_point", "primal-dual interior point, De Saxce's shift renewed", true},
     pe_solve_interior_point},
    {{"direct", "newton, then interior_point refined by it, as the engine combines them", true},
     pe_solve_combined},
};
enum { SOLVER_COUNT = sizeof SOLVERS / sizeof SOLVERS[0] };

int pe_solver_count(void)
{
    return SOLVER_COUNT;
}

pe_solver_info pe_solver(int index)
{
    return index >= 0 && index < SOLVER_COUNT ? SOLVERS[index].info : (pe_solver_info){0};
}

static const named_solver *find_solver(const char *name)
{
    for (int i = 0; i < SOLVER_COUNT; ++i) {
        if (strcmp(SOLVERS[i].info.name, name) == 0) {
            return &SOLVERS[i];
        }
    }
    return NULL;
}

static pe_status check_call(const pe_contact_problem *problem, const char *name,
                            const pe_solve_limits *limits, pe_error *error)
{
    if (find_solver(name) == NULL) {
        return pe_fail(error, PE_BAD_ARGUMENT, "there is no solver \"%s\"", name);
    }
    if (!(limits->tolerance > 0)) {
        return pe_fail(error, PE_BAD_ARGUMENT, "tolerance: expected a number above 0, found %g",
                       limits->tolerance);
    }
    if (limits->max_iterations < 0) {
        return pe_fail(error, PE_BAD_ARGUMENT, "max_iterations: expected at least 0, found %d",
                       limits->max_iterations);
    }
    pe_problem_fault fault;
    if (!pe_contact_problem_is_valid(problem, &fault)) {
        return pe_fail(error, PE_BAD_ARGUMENT, "%s[%d].%s: %s", fault.list, fault.index,
                       fault.field, fault.text);
    }
    return PE_OK;
}

/* Most marks that are kept. */
enum { MOST_MARKS = 100000 };

/* Adds the end to the history, which holds the start and then the solver's marks. */
static void close_history(const pe_solve_history *history, pe_contact_solution *made)
{
    const pe_solve_mark end = {made->iterations, made->residual.max, made->seconds};
    made->history_count = history->count;
    bool ends = history->marks[history->count - 1].iterations == made->iterations;
    made->history[ends ? history->count - 1 : made->history_count++] = end;
}

/* Fills `made` with the impulses that the solver left, and the velocities and residual that follow
 * from them. */
static void store_results(const pe_problem *view, const pe_solve_limits *limits,
                          const pe_solve_report *report, pe_contact_solution *made)
{
    pe_problem_rebuild_velocity(view);
    made->residual = pe_problem_residual(view);
    made->iterations = report->iterations;
    made->factor_flops = report->factor_flops;
    bool solved = made->residual.max <= limits->tolerance;
    made->stop = solved                               ? PE_STOP_CONVERGED
                 : report->stop == PE_STOP_ITERATIONS ? PE_STOP_ITERATIONS
                                                      : PE_STOP_STALLED;
    close_history(report->history, made);
    memcpy(made->impulses, view->impulse, (size_t)view->point_count * sizeof *made->impulses);
    memcpy(made->velocities, view->velocity, (size_t)view->body_count * sizeof *made->velocities);
}

pe_status pe_contact_problem_solve(const pe_contact_problem *problem, const char *solver,
                                   const pe_solve_limits *limits, double (*clock)(void),
                                   pe_contact_solution *solution, pe_error *error)
{
    pe_arena arena = {0};
    const pe_workspace work = {.arena = &arena, .allocator = &problem->allocator};
    pe_contact_solution made;
    pe_problem view;
    pe_status status = check_call(problem, solver, limits, error);
    if (status != PE_OK) {
        return status;
    }
    int marks = limits->max_iterations < MOST_MARKS ? limits->max_iterations : MOST_MARKS;
    status = pe_contact_solution_take(problem, marks + 2, &made, error); /* the start and the end */
    if (status != PE_OK) {
        return status;
    }
    pe_solve_history history = {.marks = made.history, .capacity = marks + 1, .clock = clock};
    pe_solve_report report = {.history = &history};
    status = pe_problem_of_data(problem, work, &view, error);
    if (status != PE_OK) {
        goto cleanup;
    }
    made.start = pe_problem_residual(&view);
    history.began = clock != NULL ? clock() : 0;
    history.marks[history.count++] = (pe_solve_mark){.residual = made.start.max};
    if (!(made.start.max <= limits->tolerance)) {
        status = find_solver(solver)->solve(&view, limits, work, &report, error);
        if (status != PE_OK) {
            goto cleanup;
        }
    }
    made.seconds = clock != NULL ? clock() - history.began : 0;
    store_results(&view, limits, &report, &made);
    *solution = made;

cleanup:
    if (status != PE_OK) {
        pe_contact_solution_free(&made);
    }
    pe_arena_free(&arena, &problem->allocator);
    return status;
}
