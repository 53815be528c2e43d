/* Checks of numbers that a scene has: each complains of the field `key` of the object where the
 * path now stands, or at the path itself where key is NULL, and returns false, unless they are
 * right. */
#ifndef PLUMB_CHECK_NUMBER_H
#define PLUMB_CHECK_NUMBER_H

#include "diagnostic.h"

/* How far the norm of a normal, direction or quaternion may be from 1. */
#define PL_UNIT_TOLERANCE 1e-9

/* sqrt of the sum of squares of n numbers. */
double pl_norm(const double *vector, int n);

/* `right` says whether it is; `expected` what it should be. */
bool pl_check_number(pl_diagnostic *diagnostic, const char *key, double value, bool right,
                     const char *expected);
bool pl_check_is_finite(pl_diagnostic *diagnostic, const char *key, double value);
bool pl_check_positive(pl_diagnostic *diagnostic, const char *key, double value);
bool pl_check_vector(pl_diagnostic *diagnostic, const char *key, const double vector[3]);
bool pl_check_unit(pl_diagnostic *diagnostic, const char *key, const double *vector, int n,
                   const char *expected);

#endif
