/* What a step did to a body, as the laws of a step see it. */
#ifndef PLUMB_TEST_STEP_LAWS_H
#define PLUMB_TEST_STEP_LAWS_H

#include "plumb/engine.h"

/* No number of a state is NaN or infinite. */
bool is_finite_state(const pe_body_state *state);

/* The centre of mass of a body in this state: m, world. */
pe_vec3 centre_of(const pe_world *world, pe_body_id body, const pe_body_state *state);

/* The kinetic energy of a body in this state, J; 0 of a static one. */
double kinetic_energy_of(const pe_world *world, pe_body_id body, const pe_body_state *state);

/* A body's way in a step beyond what its velocities explain, in units of its least extent: of its
 * centre, and by rotation of a point at its bounding radius. */
typedef struct unexplained_motion {
    double moved, rotated;
} unexplained_motion;

/* At most MOST_UNEXPLAINED, a quarter and rounding: the law of each step of dt and each body is
 *
 *   |x' - x|     <= dt max(|v|, |v'|) + dt^2 |a| + size/4,
 *   R |rotation| <= dt (v + R w + R dt w^2) + size/4,    v = max(|v|, |v'|), w = max(|w|, |w'|),
 *
 * with R the bounding radius, a the acceleration by forces (m/s^2), and `size` the least extent: twice
 * the least half extent, or radius. Between the velocities at the ends of the step lies what a step
 * moves by. dt |a| is what a solver may take back from it in the step. dt w^2 is what w may gain in
 * between without a torque. What is left is position correction: a fifth of the least extent at most,
 * and a twentieth for several of its rounds. A force off the centre of mass rotates by more. */
unexplained_motion unexplained_motion_of(const pe_world *world, pe_body_id body,
                                         const pe_body_state *before, const pe_body_state *after,
                                         double dt, double acceleration);

extern const double MOST_UNEXPLAINED;

#endif
