/* How an engine takes velocities to displacements, told from its frames. The energy that it keeps
 * in free flight depends on it. */
#ifndef PLUMB_INTEGRATOR_H
#define PLUMB_INTEGRATOR_H

#include "plumb/engine_abi.h"

typedef enum pl_integrator {
    PL_SEMI_IMPLICIT, /* x' = x + h v', with v' = v + h g + J/m: keeps E + (h/2) m g.v */
    PL_SECOND_ORDER,  /* exact under constant gravity: keeps E */
    PL_INTEGRATOR_COUNT
} pl_integrator;

/* Steps of bodies that fit one rule and not the other. Starts as {0}. */
typedef struct pl_integrator_votes {
    long flying[PL_INTEGRATOR_COUNT]; /* in steps in which gravity alone acted */
    long pushed[PL_INTEGRATOR_COUNT]; /* in others */
} pl_integrator_votes;

/* One step of the dynamic bodies. States have scene->body_count items. */
void pl_integrator_see(pl_integrator_votes *votes, const pl_scene *scene,
                       const pl_body_state *before, const pl_body_state *after);

/* The rule that more steps in free flight fit, or if there are none, more of the others: an engine
 * may well move bodies otherwise where they collide. PL_SEMI_IMPLICIT where nothing tells, as when
 * nothing accelerates: both energies then grow alike. */
pl_integrator pl_integrator_of(const pl_integrator_votes *votes);

#endif
