/* Energy and momentum of a run: what an engine made or lost of them beside what the scene put in.
 */
#ifndef PLUMB_MECHANICS_H
#define PLUMB_MECHANICS_H

#include "plumb/engine_abi.h"
#include "referee/scale.h"

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

/* Of the last state: (E - E0 - work) / scale.energy. */
double pl_mechanics_energy_gain(const pl_mechanics *mechanics, const pl_scale *scale);

/* Of the last state: the larger of |p - p0 - J| / scale.momentum and |L - L0 - K| /
 * scale.angular_momentum, with J and K the impulses of gravity, of the scene's forces and of the
 * reported contacts with static bodies. Without reported contacts it has meaning only while nothing
 * has touched a static body. */
double pl_mechanics_momentum_error(const pl_mechanics *mechanics, const pl_scale *scale);

#endif
