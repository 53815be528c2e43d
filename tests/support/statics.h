/* Whether bodies at rest can stay so: contact forces within Coulomb's cones that carry every
 * weight, found by linear programming. Knows no engine and no formula of the catalogue. */
#ifndef PLUMB_TEST_STATICS_H
#define PLUMB_TEST_STATICS_H

#include "plumb/scene.h"

/* Whether A x = b has a solution with x >= 0, to 1e-9 of the largest |b|; `a` is rows x columns,
 * row by row. By the simplex method's first phase. */
bool has_nonnegative_solution(const double *a, const double *b, int rows, int columns);

/* Whether a scene in the plane of x and z has forces of equilibrium. Boxes and hulls stand for the
 * polygon of their corners, cylinders and spheres for a circle; all are turned about y alone, but
 * for cylinders, whose axis is along y. */
bool is_in_balance(const pl_scene *scene);

#endif
