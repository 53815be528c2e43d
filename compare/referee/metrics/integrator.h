/* The engine's integrator, which is detected from the frames: how positions follow velocities. What
 * the engine declares of itself, its sub-steps and its precision, is known beforehand.
 *
 * Arrays of states have scene->body_count items. */
#ifndef PLUMB_INTEGRATOR_H
#define PLUMB_INTEGRATOR_H

#include "plumb/engine_abi.h"
#include "plumb/scene.h"
#include "plumb/vec.h"

/* What an engine declares, by which its frames are judged. {0} is one sub-step, in doubles. */
typedef struct pl_referee_engine {
    int substeps;           /* that it makes in a step; 0: one */
    pl_precision precision; /* of its numbers */
} pl_referee_engine;

/* The sub-steps of a step, at least one. */
int pl_substeps_of(const pl_referee_engine *engine);

/* By how much rounding may change a number in a step, relative to the number: 0 for an engine in
 * doubles, whose rounding no metric resolves. An engine in floats rounds, by 2^-24 each, the number
 * and what it adds to it in each of n sub-steps, and both again where the frame is read: together
 * 2 (n + 1) 2^-24. Over many steps these add up, because rounding may go the same way each time. */
double pl_step_rounding(const pl_referee_engine *engine);

/* How an engine integrates positions over a step of length h. */
typedef enum pl_position_rule {
    PL_SEMI_IMPLICIT, /* x' = x + h v', with v' = v + h g + J/m: conserves E + (h/2) m g.v. With n
                         sub-steps h is h / n here. */
    PL_SECOND_ORDER,  /* exact under constant gravity: conserves E */
    PL_POSITION_RULE_COUNT
} pl_position_rule;

/* Steps of bodies in which the two integrators differ, counted by the integrator that they fit; the
 * last item counts those that fit neither. Starts as {0}, but for the engine. */
typedef struct pl_integrator_votes {
    long flying[PL_POSITION_RULE_COUNT + 1]; /* in steps in which gravity alone acted */
    long pushed[PL_POSITION_RULE_COUNT + 1]; /* in other steps */
    pl_referee_engine engine;
} pl_integrator_votes;

/* The part of a step's displacement by which n sub-steps of semi-implicit Euler differ from one, as
 * the second-order rule does by 1/2: (1 - 1/n) / 2. */
double pl_later_share(const pl_referee_engine *engine);

/* Counts one step of the dynamic bodies. `turned` (scene->body_count) is what forces that turn with
 * the bodies add to the displacements of a second-order integrator, m. */
void pl_integrator_see(pl_integrator_votes *votes, const pl_scene *scene,
                       const pl_body_state *before, const pl_body_state *after,
                       const pl_vec *turned);

/* The integrator that fits most steps in free flight. Without such steps it is that of second order
 * if more of the other steps fit it than chance explains: an engine of second order may move
 * colliding bodies differently, one of semi-implicit Euler has no such steps. PL_SEMI_IMPLICIT where
 * no step distinguishes the two, for example because nothing accelerates: both energies then grow
 * alike. */
pl_position_rule pl_integrator_of(const pl_integrator_votes *votes);

/* Whether the steps of a run agree on one integrator. */
typedef enum pl_integrator_certainty {
    PL_INTEGRATOR_UNDETECTED, /* no step distinguishes the two, or more steps fit neither */
    PL_INTEGRATOR_MIXED,      /* some steps fit the one, some the other */
    PL_INTEGRATOR_DETECTED    /* nine in ten of the steps that fit either integrator fit it */
} pl_integrator_certainty;

/* How certain pl_integrator_of is. */
pl_integrator_certainty pl_integrator_certain(const pl_integrator_votes *votes);

/* ---- The exact answers of an integrator at the scene's step, with any number of sub-steps ---- */

/* The distance of a travel, m; NAN if it is not known. */
double pl_discrete_travel(const pl_scene *scene, const pl_expect_travel *travel,
                          pl_position_rule rule, const pl_referee_engine *engine);

/* An expected value, in its unit; NAN if it is not known. */
double pl_discrete_value(const pl_scene *scene, const pl_expect_value *value, pl_position_rule rule,
                         const pl_referee_engine *engine);

#endif
