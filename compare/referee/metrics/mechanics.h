/* Energy and momentum of a run: what an engine made or lost of them beside what the scene put in.
 */
#ifndef PLUMB_MECHANICS_H
#define PLUMB_MECHANICS_H

#include "integrator.h"
#include "scale.h"

typedef struct pl_mechanics pl_mechanics;

/* `scene` must outlive it. NULL when out of memory. Freed by pl_mechanics_destroy (NULL allowed).
 */
pl_mechanics *pl_mechanics_create(const pl_scene *scene);
void pl_mechanics_destroy(pl_mechanics *mechanics);

/* The state before the first step. */
void pl_mechanics_start(pl_mechanics *mechanics, const pl_body_state *bodies);

/* The state after step number `step` (from 1), with the contacts of that step (contact_count <= 0:
 * none). */
void pl_mechanics_step(pl_mechanics *mechanics, long step, const pl_body_state *bodies,
                       const pl_contact *contacts, int contact_count);

/* The integrator that the steps so far show. */
pl_integrator pl_mechanics_integrator(const pl_mechanics *mechanics);
/* What it is told by. Borrowed. */
const pl_integrator_votes *pl_mechanics_votes(const pl_mechanics *mechanics);

/* Of the last state: (E - E0 - work) / scale.energy, E as the integrator keeps it. */
double pl_mechanics_energy_gain(const pl_mechanics *mechanics, const pl_scale *scale,
                                pl_integrator integrator);

/* By how much each body's E grew in the last step, without the work of the scene's forces on it:
 * (body_count), J. Borrowed until the next step. */
const double *pl_mechanics_growth(const pl_mechanics *mechanics, pl_integrator integrator);

/* Of the last state: the larger of |p - p0 - J| / scale.momentum and |L - L0 - K| /
 * scale.angular_momentum, with J and K the impulses of gravity, of the scene's forces and of the
 * reported contacts with static bodies. Without reported contacts it has meaning only while nothing
 * has touched a static body. */
double pl_mechanics_momentum_error(const pl_mechanics *mechanics, const pl_scale *scale,
                                   pl_integrator integrator);

#endif
