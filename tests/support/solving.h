/* The solvers of islands on problems with known solutions. Every failure fails the test. */
#ifndef PLUMB_TEST_SOLVING_H
#define PLUMB_TEST_SOLVING_H

#include "contact_problem_for_tests.h"
#include "dense_problem.h"
#include "solver/solve_interior_point.h"
#include "solver/solve_island.h"

enum { SOLVING_ITERATIONS = 400 };

/* A problem, its pattern, and the report of its solver. */
typedef struct solving {
    test_memory memory;
    pe_workspace work;
    const pe_contact_problem *source;
    pe_problem problem;
    pe_pattern pattern;
    pe_solve_report report;
    double start; /* m/s, where the solver began */
} solving;

typedef pe_status (*island_solver)(solving *s, const pe_solve_limits *limits, pe_error *error);

typedef struct named_solver {
    const char *name;
    island_solver solve;
    double tolerance; /* m/s, to which it solves the closed forms */
    double close;     /* the error that follows: m/s of velocities, relative of impulses */
} named_solver;

/* CONVEX, the last one, solves another problem, which has the same solution where nothing slides.
 * Its own limit of accuracy is near 1e-8. */
enum { COULOMB_SOLVERS = 3, ALL_SOLVERS = 4, CONVEX = 3 };
extern const named_solver SOLVERS[ALL_SOLVERS];

pe_status solve_by_newton(solving *s, pe_newton_form form, const pe_solve_limits *limits,
                          pe_error *error);

/* As the engine solves an island; the report is that of the solver which it chose. */
pe_status solve_by_island(solving *s, const pe_solve_limits *limits, pe_error *error);

/* The problem and its pattern, with the warm start of `source`. */
void solving_begin(solving *s, const pe_contact_problem *source);
void solving_end(solving *s);

/* Begins, and solves to the tolerance, in m/s. */
void solve_to(solving *s, const pe_contact_problem *source, const named_solver *by,
              double tolerance);

/* The velocity of body i that follows from the impulses. */
const double *solving_velocity(const solving *s, int i);

/* Gravity at an angle from the floor's normal: downhill is x. */
void tilt_gravity(pe_contact_problem *problem, double angle);

/* The box on the floor, with gravity tilted. */
pe_contact_problem *problem_of_box_on_slope(double mass, double friction, double angle);

/* Cubes of 1 kg, at most 100. */
pe_contact_problem *problem_of_uniform_tower(int count, double friction);

#endif
