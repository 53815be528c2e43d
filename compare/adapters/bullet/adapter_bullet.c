/* Bullet 3.24 in double precision, through bullet_c.cpp.
 *
 * si and nncg are Bullet's iterative solvers, with 10 iterations by default; dantzig and lemke give
 * each group of islands to a dense solver, which falls back to sequential impulse where it fails
 * (reported on standard error at the end of the run). `recommended` is si as Bullet's own
 * documentation and tools set it up for accuracy; why each value, its sources say. It leaves the
 * margins as they are ("It is best not to modify the default collision margin", Bullet 2.83 Physics
 * SDK Manual, Collision Margin), also that of hulls and meshes, which Bullet would have grow by
 * 0.04 m. Everything else has Bullet's defaults: one
 * friction direction a contact point along its sliding velocity, islands gathered into groups of
 * 128 constraints, contact points kept over steps. Sleeping is off. The callbacks for a pair's
 * friction and restitution, asked when a contact point is made, are 1 % of the instructions of a
 * step of si on the wall of 10 x 10.
 *
 * nncg ends every sweep by a step along its search direction that is not bounded again (3.24,
 * btNNCGConstraintSolver.cpp), so that of several contact points one may be left pulling. */
#include "bullet_c.h"

#include "adapters/native.h"

#include <bullet_description.h>

PL_ENGINE(pl_engine_bullet, bullet)
