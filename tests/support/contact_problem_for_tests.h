/* Contact problems made by hand, whose solutions are known. Every failure fails the test. */
#ifndef PLUMB_TEST_CONTACT_PROBLEM_H
#define PLUMB_TEST_CONTACT_PROBLEM_H

#include "plumb/contact_problem.h"

static const double STEP = 1.0 / 60; /* s */
static const double GRAVITY = 9.81;  /* m/s^2 */

pe_contact_problem *make_problem(int bodies, int manifolds, int points);

/* A cube of side 1, at rest except for one step of gravity, on a floor with normal (0, 0, 1): body
 * 0, four points at its lower corners. */
pe_contact_problem *problem_of_box_on_floor(double mass, double friction);

/* Cubes of these masses on one another; body 0 is the lowest. */
pe_contact_problem *problem_of_tower(const double *masses, int count, double friction);

/* Bodies of random inertia and velocity, with manifolds of 1 to 4 points in random frames between
 * random pairs of them and the ground: no geometry, but every number is there, biases and warm
 * starts too. */
pe_contact_problem *problem_at_random(uint64_t seed, int bodies, int manifolds);

/* The same with manifolds of 1 to 8 points between these pairs (a, b), a may be PE_STATIC. */
pe_contact_problem *problem_of_pairs(uint64_t seed, int bodies, const int (*pairs)[2], int count);

/* The velocities by independent formulas: the velocity J v + b of every point, world arithmetic
 * point by point, and v* + M^-1 J^T p by elimination. `u` is (point_count), `v` (body_count). */
void reference_velocities(const pe_contact_problem *problem, const double (*p)[3], double (*v)[6]);
void reference_contact_velocities(const pe_contact_problem *problem, const double (*v)[6],
                                  double (*u)[3]);

/* The largest violation of Signorini's and Coulomb's laws at the points, each in m/s: approach,
 * pull and friction beyond the cone, a gap that pushes, slip without full friction against it. Zero
 * in a solution; no natural map is in it. */
double coulomb_fault(const pe_contact_problem *problem, const double (*p)[3], const double (*v)[6]);

#endif
