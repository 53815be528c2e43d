/* Metrics of the contact impulses that an engine reports: whether they account for the motion of
 * the bodies, whether they lie in Coulomb's cone, and how far they and the velocities after the
 * step are from the law of contact.
 *
 * The metrics are force_balance, cone_violation, friction_effective, signorini and natural_map;
 * their formulas are at the head of contact_force.c. */
#ifndef PLUMB_CONTACT_FORCE_H
#define PLUMB_CONTACT_FORCE_H

#include "mechanics.h"

/* The state of these metrics over a run. */
typedef struct pl_contact_force pl_contact_force;

/* `scene` must outlive it. Memory of the arena; NULL when out of memory. */
pl_contact_force *pl_contact_force_create(const pl_scene *scene, pl_arena *arena);

/* Takes a step. After a step whose contacts are not reported, none of the metrics applies. */
void pl_contact_force_step(pl_contact_force *force, const pl_step *step);

/* Sets the five metrics in item (PL_METRIC_COUNT). A metric is PL_METRIC_ABSENT when it does not
 * apply: no contacts reported, nothing touched, no friction, nothing slid, or no gravity as the
 * unit of force. */
void pl_contact_force_metrics(const pl_contact_force *force, pl_position_rule integrator,
                              pl_metric *item);

/* The force on body b of the contacts between a and b, mean over a step of dt seconds: N, world
 * frame. */
pl_vec pl_contact_force_between(const pl_contact *contacts, int count, int a, int b, double dt);

#endif
