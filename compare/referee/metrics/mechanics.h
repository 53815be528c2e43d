/* Energy and momentum of a run: what the engine gained or lost of them, apart from the work and the
 * impulses of the scene. Both depend on the engine's integrator, which is detected from the frames.
 *
 * Arrays of states have scene->body_count items. */
#ifndef PLUMB_MECHANICS_H
#define PLUMB_MECHANICS_H

#include "base/arena.h"
#include "integrator.h"
#include "plumb/contact_times.h"
#include "plumb/vec.h"
#include "scale.h"

/* The energy and momentum of a run so far. */
typedef struct pl_mechanics pl_mechanics;

/* `scene` must outlive it. Memory of the arena. */
pl_mechanics *pl_mechanics_create(const pl_scene *scene, pl_arena *arena);

/* Takes the state before the first step. */
void pl_mechanics_start(pl_mechanics *mechanics, const pl_body_state *bodies);

/* A step as the referee sees it. */
typedef struct pl_step {
    long number;                         /* from 1 */
    const pl_body_state *before, *after; /* (scene->body_count) */
    const pl_contact *contacts;          /* between bodies of the scene */
    const pl_contact_time *times;        /* of the contacts; NULL: all are of the whole step */
    int contact_count;                   /* < 0: the engine reports no contacts */
    bool repeats; /* the states, contacts and times are those of the last step */
} pl_step;

/* Takes a step, whose contacts may be unreported. */
void pl_mechanics_step(pl_mechanics *mechanics, const pl_step *step);

/* The steps so far by the integrator that they fit. Borrowed. What the engine declares is set there
 * before pl_mechanics_start. */
pl_integrator_votes *pl_mechanics_votes(pl_mechanics *mechanics);

/* Of the last state: (E - E0 - work) / scale.energy, where E is the energy that the integrator
 * conserves. */
double pl_mechanics_energy_gain(const pl_mechanics *mechanics, const pl_scale *scale,
                                pl_position_rule integrator);

/* Of the last state: the larger of |p - p0 - J| / scale.momentum and |L - L0 - K| /
 * scale.angular_momentum, where J and K are the impulses of gravity, of the scene's forces and of
 * the reported contacts with static bodies; each without what rounding of the declared precision
 * explains. If the engine reports no contacts, the result is valid
 * only while nothing has touched a static body. With sub-steps, L counts only while no contact with
 * a static body was reported: its arms are those of sub-steps that are not known. */
double pl_mechanics_momentum_error(const pl_mechanics *mechanics, const pl_scale *scale,
                                   pl_position_rule integrator);

#endif
