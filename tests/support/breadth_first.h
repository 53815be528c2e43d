/* The pattern of a factor as the engine finds it where it is built without SuiteSparse's AMD. */
#ifndef PLUMB_TEST_BREADTH_FIRST_H
#define PLUMB_TEST_BREADTH_FIRST_H

#include "sparse/pattern.h"

pe_status breadth_first_pattern(const pe_problem *problem, const bool *counted, pe_workspace work,
                                pe_pattern *pattern, pe_error *error);

#endif
