/* Siconos' friction-contact solvers (Acary and others, INRIA), which we have no part in, on our problems.
 * They get W = J M^-1 J^T and q = J v* + b, worked out by the tests' own formulas. */
#ifndef PLUMB_TEST_SICONOS_ANSWER_H
#define PLUMB_TEST_SICONOS_ANSWER_H

#include "plumb/contact_problem.h"

/* Puts the answer of one of its solvers, a number of Friction_cst.h, into the warm start of the problem,
 * whether or not it is solved. Returns whether there was memory. */
bool siconos_answer(pe_contact_problem *problem, int solver);

#endif
