/* Who meets whom: the scenes and engines of a command that takes several of both. */
#ifndef PLUMB_CONTEST_H
#define PLUMB_CONTEST_H

#include "command/contest_options.h"

/* Adds the problems of all suites (pl_suite_find), then those of the names. PL_BAD_INPUT: there is
 * no such suite, scenario or parameter. */
pl_status pl_contest_add_problems(const pl_contest *contest, pl_plan *plan, pl_error *error);

/* Adds the engines asked for, or, when there are none, all profiles that engines put up for
 * comparison. One that this build lacks is said so on standard error, in the name of `command`, and
 * left out. */
pl_status pl_contest_add_engines(const char *command, const pl_contest *contest, pl_plan *plan,
                                 pl_error *error);

#endif
