/* Contact problems as the engine's solvers take them, and the same problems as dense matrices, made
 * from their definition. Every failure fails the test. */
#ifndef PLUMB_TEST_DENSE_PROBLEM_H
#define PLUMB_TEST_DENSE_PROBLEM_H

#include "plumb/contact_problem.h"
#include "problem/problem.h"

#include "base/memory.h"

/* Memory of a test; `fail_at` is the allocation, from 1, that fails (0: none). Every block is
 * filled with NaN, so that memory that was never written shows. */
typedef struct test_memory {
    pe_arena arena;
    pe_allocator allocator;
    long made, fail_at;
} test_memory;

/* `memory` must stay where it is. */
pe_workspace test_memory_begin(test_memory *memory);
void test_memory_end(test_memory *memory);

/* The problem with its warm start in memory of `work`; velocities are in step with it. */
pe_problem solver_problem(const pe_contact_problem *from, pe_workspace work);

/* By the formulas of contact_problem_for_tests.h: the largest violation of Signorini's and
 * Coulomb's laws at the problem's impulses, m/s. */
double solver_problem_fault(const pe_contact_problem *from, const pe_problem *problem);

/* Row-major matrices that the caller frees: J (3 point_count x 6 body_count), whose rows are n, t1,
 * t2 of each point; M and M^-1 (6 body_count square). */
double *dense_jacobian(const pe_contact_problem *problem);
double *dense_mass(const pe_contact_problem *problem);
double *dense_inverse_mass(const pe_contact_problem *problem);

/* Replaces the lower triangle of a positive definite matrix (n x n) by its Cholesky factor. */
void dense_cholesky(double *a, int n);

/* x := (L L^T)^-1 x */
void dense_solve(const double *l, int n, double *x);

#endif
