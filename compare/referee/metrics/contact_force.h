/* What the contact forces that an engine reports say of it: whether they are those that moved the
 * bodies, whether they lie in Coulomb's cone, and by how much they and the velocities after the
 * step miss the law of contact.
 *
 * The metrics are force_balance, cone_violation, friction_effective, signorini and natural_map;
 * their formulas are at the head of contact_force.c. */
#ifndef PLUMB_CONTACT_FORCE_H
#define PLUMB_CONTACT_FORCE_H

#include "integrator.h"
#include "metrics.h"
#include "plumb/engine_abi.h"
#include "plumb/vec.h"

typedef struct pl_contact_force pl_contact_force;

/* Allocates all that it will ever need. `scene` must outlive it. NULL when out of memory. Freed by
 * pl_contact_force_destroy (NULL allowed). */
pl_contact_force *pl_contact_force_create(const pl_scene *scene);
void pl_contact_force_destroy(pl_contact_force *force);

/* The state before the first step; (scene->body_count). */
void pl_contact_force_start(pl_contact_force *force, const pl_body_state *bodies);

/* The state after step number `step` (from 1), with the contacts of that step, which are between
 * bodies of the scene. contact_count < 0: the engine reports none, and no metric applies to the
 * run. */
void pl_contact_force_step(pl_contact_force *force, long step, const pl_body_state *bodies,
                           const pl_contact *contacts, int contact_count);

/* Sets the five metrics in item (PL_METRIC_COUNT); PL_METRIC_ABSENT where one does not apply:
 * nothing reported; nothing touched; no friction, or nothing slid; no gravity to measure by. */
void pl_contact_force_metrics(const pl_contact_force *force, pl_integrator integrator,
                              pl_metric *item);

/* The force on body b of the contacts between a and b, mean over a step of dt seconds: N, world. */
pl_vec pl_contact_force_between(const pl_contact *contacts, int count, int a, int b, double dt);

#endif
