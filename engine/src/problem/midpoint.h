/* The contact problem of a step at its midpoint, which makes smooth motion second order.
 *
 * In the mean over the step a contact's force acts where its arms are at the midpoint; with the
 * arms of the start the step is first order. A manifold whose points are fixed in one body, and
 * whose normal is fixed in one, since the contacts of the last step (corners on a face), is
 * transported to the midpoint by the mean velocities of both, as the warm start has them, and
 * so is one on the rim of a cylinder, whose lowest point runs round the rim. Then
 *
 *   b = (J_end - J_mid) v' + part of the gap / h
 *   b_t = J_mid (v - v')/2                           where sliding goes on
 *
 * because approach is bounded at the end of the step, and because friction opposes the mean slip,
 * while a contact that sticks stops the slip at the end.
 *
 * Impulses of the warm start are rotated with the slip. These stay at the step's start:
 * - islands of more than two bodies, and those with an impact, whose impulse acts at the start of
 *   the step;
 * - manifolds that wander over both bodies in another way, as those of spheres do;
 * - manifolds whose v does not fit, as after a step without transport.
 *
 * Where the impulses of the last step do not fit, as after an impact, or where points roll on a rim,
 * the caller solves the problem as it is and builds it again with these impulses. */
#ifndef PE_MIDPOINT_H
#define PE_MIDPOINT_H

#include "problem_build.h"

/* Transports the manifolds of `built`, whose velocities are in step with its impulses, and are
 * afterwards. `free` (slots) is the motion without contacts; `dt` in s. The impulses are those of
 * the last step, or, with `solved`, those that solve the problem as it is. Sets built->unsettled. */
pe_status pe_problem_to_midpoint(pe_world *world, pe_island_problem *built,
                                 const pe_free_motion *free, double dt, bool solved,
                                 pe_error *error);

#endif
