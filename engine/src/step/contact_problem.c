/* Contact problems as data: made, checked, and solved by any of the solvers. */
#include "plumb/contact_problem.h"

#include "solver/solve.h"

#include <limits.h>
#include <math.h>
#include <string.h>

/* ---- Memory ------------------------------------------------------------------------------------
 */

/* `count` items, all zero; room for one when there are none. */
static void *allocate_zero(const pe_allocator *allocator, size_t count, size_t stride)
{
    size_t items = count == 0 ? 1 : count;
    void *memory = items > SIZE_MAX / 2 / stride
                       ? NULL
                       : allocator->allocate(allocator->context, items * stride);
    if (memory != NULL) {
        memset(memory, 0, items * stride);
    }
    return memory;
}

static void release(const pe_allocator *allocator, void *memory)
{
    if (memory != NULL) {
        allocator->release(allocator->context, memory);
    }
}

pe_status pe_contact_problem_create(int body_count, int manifold_count, int point_count,
                                    const pe_allocator *allocator, pe_contact_problem **problem,
                                    pe_error *error)
{
    if (body_count < 0 || manifold_count < 0 || point_count < 0) {
        return pe_fail(error, PE_BAD_ARGUMENT,
                       "contact problem: expected counts of at least 0, found %d bodies, %d "
                       "manifolds, %d points",
                       body_count, manifold_count, point_count);
    }
    pe_allocator chosen = allocator != NULL ? *allocator : pe_allocator_default();
    pe_contact_problem *made = allocate_zero(&chosen, 1, sizeof *made);
    if (made != NULL) {
        made->body_count = body_count;
        made->manifold_count = manifold_count;
        made->point_count = point_count;
        made->allocator = chosen;
        made->bodies = allocate_zero(&chosen, (size_t)body_count, sizeof *made->bodies);
        made->manifolds = allocate_zero(&chosen, (size_t)manifold_count, sizeof *made->manifolds);
        made->points = allocate_zero(&chosen, (size_t)point_count, sizeof *made->points);
    }
    if (made == NULL || made->bodies == NULL || made->manifolds == NULL || made->points == NULL) {
        pe_contact_problem_destroy(made);
        return pe_fail(error, PE_NO_MEMORY,
                       "no memory for a contact problem of %d bodies and %d points", body_count,
                       point_count);
    }
    *problem = made;
    return PE_OK;
}

void pe_contact_problem_destroy(pe_contact_problem *problem)
{
    if (problem != NULL) {
        pe_allocator allocator = problem->allocator;
        release(&allocator, problem->bodies);
        release(&allocator, problem->manifolds);
        release(&allocator, problem->points);
        release(&allocator, problem);
    }
}

/* ---- As the solvers see it ---------------------------------------------------------------------
 */

/* The inverse of a symmetric matrix by its cofactors. */
static void invert_symmetric(const double m[6], double inverse[6])
{
    double xx = m[0], xy = m[1], xz = m[2], yy = m[3], yz = m[4], zz = m[5];
    double c[6] = {yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy,
                   xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy};
    double determinant = xx * c[0] + xy * c[1] + xz * c[2];
    for (int k = 0; k < 6; ++k) {
        inverse[k] = c[k] / determinant;
    }
}

static void view_bodies(const pe_contact_problem *problem, pe_inertia *inertia,
                        double (*free_velocity)[6])
{
    for (int i = 0; i < problem->body_count; ++i) {
        const pe_problem_body *body = &problem->bodies[i];
        inertia[i] = (pe_inertia){.mass = body->mass, .inverse_mass = 1 / body->mass};
        memcpy(inertia[i].tensor, body->inertia, sizeof inertia[i].tensor);
        invert_symmetric(body->inertia, inertia[i].inverse_tensor);
        memcpy(free_velocity[i], body->free_velocity, sizeof free_velocity[i]);
    }
    inertia[problem->body_count] = (pe_inertia){0};
    memset(free_velocity[problem->body_count], 0, sizeof free_velocity[0]);
}

/* From a body's centre of mass to a point. */
static void point_arm(const pe_solver_manifold *manifold, const double arm[3], const double s[3],
                      double r[3])
{
    for (int k = 0; k < 3; ++k) {
        r[k] = arm[k] + (manifold->frame[0][k] * s[0] + manifold->frame[1][k] * s[1] +
                         manifold->frame[2][k] * s[2]);
    }
}

static void view_manifolds(const pe_contact_problem *problem, const pe_inertia *inertia,
                           pe_solver_manifold *manifolds, pe_solver_point *points)
{
    const int fixed = problem->body_count;
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_problem_manifold *m = &problem->manifolds[i];
        pe_solver_manifold *manifold = &manifolds[i];
        *manifold = (pe_solver_manifold){.a = m->a == PE_STATIC ? fixed : m->a,
                                         .b = m->b == PE_STATIC ? fixed : m->b,
                                         .first = m->first,
                                         .count = m->count,
                                         .friction = m->friction};
        memcpy(manifold->frame, m->frame, sizeof manifold->frame);
        memcpy(manifold->arm_a, m->arm_a, sizeof manifold->arm_a);
        memcpy(manifold->arm_b, m->arm_b, sizeof manifold->arm_b);
        for (int j = m->first; j < m->first + m->count; ++j) {
            const pe_problem_manifold_point *from = &problem->points[j];
            double ra[3], rb[3];
            point_arm(manifold, manifold->arm_a, from->offset, ra);
            point_arm(manifold, manifold->arm_b, from->offset, rb);
            points[j] = (pe_solver_point){
                .bias = from->bias,
                .scale = pe_point_scale(&inertia[manifold->a], &inertia[manifold->b], ra, rb)};
            memcpy(points[j].s, from->offset, sizeof points[j].s);
            memcpy(points[j].slip, from->slip, sizeof points[j].slip);
        }
    }
}

/* The problem as solvers take it, in the workspace; velocities in step with the warm start. */
static pe_status make_view(const pe_contact_problem *problem, pe_workspace work, pe_problem *view,
                           pe_error *error)
{
    size_t bodies = (size_t)problem->body_count + 1, points = (size_t)problem->point_count;
    pe_inertia *inertia = pe_take(work, bodies, sizeof *inertia);
    double(*free_velocity)[6] = pe_take(work, bodies, sizeof *free_velocity);
    double(*velocity)[6] = pe_take(work, bodies, sizeof *velocity);
    pe_solver_manifold *manifold =
        pe_take(work, (size_t)problem->manifold_count + 1, sizeof *manifold);
    pe_solver_point *point = pe_take(work, points + 1, sizeof *point);
    double(*impulse)[3] = pe_take(work, points + 1, sizeof *impulse);
    if (inertia == NULL || free_velocity == NULL || velocity == NULL || manifold == NULL ||
        point == NULL || impulse == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to solve %zu contact points", points);
    }
    view_bodies(problem, inertia, free_velocity);
    view_manifolds(problem, inertia, manifold, point);
    for (size_t j = 0; j < points; ++j) {
        memcpy(impulse[j], problem->points[j].impulse, sizeof impulse[j]);
    }
    *view = (pe_problem){.body_count = problem->body_count,
                         .manifold_count = problem->manifold_count,
                         .point_count = problem->point_count,
                         .inertia = inertia,
                         .free_velocity = (const double(*)[6])free_velocity,
                         .velocity = velocity,
                         .manifold = manifold,
                         .point = point,
                         .impulse = impulse};
    pe_problem_rebuild_velocity(view);
    return PE_OK;
}

/* ---- Solvers -----------------------------------------------------------------------------------
 */

typedef pe_status (*solve_function)(const pe_problem *problem, const pe_solve_limits *limits,
                                    pe_workspace work, pe_solve_report *report, pe_error *error);

typedef struct named_solver {
    pe_solver_info info;
    solve_function solve;
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
    {{"direct", "newton, then interior_point polished by it, as the engine combines them", true},
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

/* Marks kept, at most. */
enum { MOST_MARKS = 100000 };

static pe_status make_solution(const pe_contact_problem *problem, const pe_solve_limits *limits,
                               int *mark_capacity, pe_contact_solution *made, pe_error *error)
{
    const pe_allocator *allocator = &problem->allocator;
    int marks = limits->max_iterations < MOST_MARKS ? limits->max_iterations : MOST_MARKS;
    *mark_capacity = marks + 2; /* with the start and the end */
    *made = (pe_contact_solution){.allocator = *allocator};
    made->impulses = allocate_zero(allocator, (size_t)problem->point_count, sizeof *made->impulses);
    made->velocities =
        allocate_zero(allocator, (size_t)problem->body_count, sizeof *made->velocities);
    made->history = allocate_zero(allocator, (size_t)*mark_capacity, sizeof *made->history);
    if (made->impulses == NULL || made->velocities == NULL || made->history == NULL) {
        pe_contact_solution_free(made);
        return pe_fail(error, PE_NO_MEMORY, "no memory for a solution of %d contact points",
                       problem->point_count);
    }
    return PE_OK;
}

/* The start and the end are always in the history; what the solver noted lies between them. */
static void close_history(const pe_solve_history *history, pe_contact_solution *made)
{
    const pe_solve_mark end = {made->iterations, made->residual.max, made->seconds};
    made->history_count = history->count;
    bool ends = history->marks[history->count - 1].iterations == made->iterations;
    made->history[ends ? history->count - 1 : made->history_count++] = end;
}

static pe_status run_solver(const named_solver *chosen, const pe_problem *view,
                            const pe_solve_limits *limits, pe_workspace work,
                            pe_solve_history *history, pe_contact_solution *made, pe_error *error)
{
    pe_solve_report report = {.history = history};
    made->start = pe_problem_residual(view);
    history->began = history->clock != NULL ? history->clock() : 0;
    history->marks[history->count++] = (pe_solve_mark){.residual = made->start.max};
    if (!(made->start.max <= limits->tolerance)) {
        pe_status status = chosen->solve(view, limits, work, &report, error);
        if (status != PE_OK) {
            return status;
        }
    }
    made->seconds = history->clock != NULL ? history->clock() - history->began : 0;
    pe_problem_rebuild_velocity(view);
    made->residual = pe_problem_residual(view);
    made->iterations = report.iterations;
    made->factor_flops = report.factor_flops;
    bool solved = made->residual.max <= limits->tolerance;
    made->stop = solved                              ? PE_STOP_CONVERGED
                 : report.stop == PE_STOP_ITERATIONS ? PE_STOP_ITERATIONS
                                                     : PE_STOP_STALLED;
    close_history(history, made);
    return PE_OK;
}

pe_status pe_contact_problem_solve(const pe_contact_problem *problem, const char *solver,
                                   const pe_solve_limits *limits, double (*clock)(void),
                                   pe_contact_solution *solution, pe_error *error)
{
    pe_arena arena = {0};
    const pe_workspace work = {.arena = &arena, .allocator = &problem->allocator};
    pe_contact_solution made;
    pe_problem view;
    pe_solve_history history = {.clock = clock};
    pe_status status = check_call(problem, solver, limits, error);
    if (status != PE_OK) {
        return status;
    }
    status = make_solution(problem, limits, &history.capacity, &made, error);
    if (status != PE_OK) {
        return status;
    }
    history.marks = made.history;
    history.capacity -= 1; /* the end's place */
    status = make_view(problem, work, &view, error);
    if (status == PE_OK) {
        status = run_solver(find_solver(solver), &view, limits, work, &history, &made, error);
    }
    if (status == PE_OK) {
        memcpy(made.impulses, view.impulse, (size_t)view.point_count * sizeof *made.impulses);
        memcpy(made.velocities, view.velocity, (size_t)view.body_count * sizeof *made.velocities);
        *solution = made;
    } else {
        pe_contact_solution_free(&made);
    }
    pe_arena_free(&arena, &problem->allocator);
    return status;
}

void pe_contact_solution_free(pe_contact_solution *solution)
{
    const pe_allocator allocator = solution->allocator;
    release(&allocator, solution->impulses);
    release(&allocator, solution->velocities);
    release(&allocator, solution->history);
    *solution = (pe_contact_solution){0};
}
