/* Who meets whom: the scenes and engines of a command that takes several of both. */
#ifndef PLUMB_COMPARISON_H
#define PLUMB_COMPARISON_H

#include "comparison_options.h"

/* Adds the problems of all suites (pl_suite_find), then those of the names. PL_BAD_INPUT: there is
 * no such suite, scenario or parameter. */
pl_status pl_comparison_add_problems(const pl_comparison *comparison, pl_plan *plan,
                                     pl_error *error);

/* Adds the engines asked for, or, when there are none, all profiles that engines put up for
 * comparison. One that this build lacks is said so on standard error, in the name of `command`, and
 * left out. */
pl_status pl_comparison_add_engines(const char *command, const pl_comparison *comparison,
                                    pl_plan *plan, pl_error *error);

#endif
