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

/* Steps of bodies that tell the rules apart, by the rule that they fit; the last item counts those
 * that fit neither. Starts as {0}. */
typedef struct pl_integrator_votes {
    long flying[PL_INTEGRATOR_COUNT + 1]; /* in steps in which gravity alone acted */
    long pushed[PL_INTEGRATOR_COUNT + 1]; /* in others */
} pl_integrator_votes;

/* One step of the dynamic bodies. States have scene->body_count items. */
void pl_integrator_see(pl_integrator_votes *votes, const pl_scene *scene,
                       const pl_body_state *before, const pl_body_state *after);

/* The rule that more steps in free flight fit, or if there are none, more of the others: an engine
 * may well move bodies otherwise where they collide. PL_SEMI_IMPLICIT where nothing tells, as when
 * nothing accelerates: both energies then grow alike. */
pl_integrator pl_integrator_of(const pl_integrator_votes *votes);

/* How sure that is. */
typedef enum pl_integrator_certainty {
    PL_INTEGRATOR_UNTOLD, /* nothing tells, or more steps fit neither rule than either */
    PL_INTEGRATOR_MIXED,  /* one rule here, the other there */
    PL_INTEGRATOR_TOLD    /* nine in ten of the steps that fit either fit it */
} pl_integrator_certainty;
pl_integrator_certainty pl_integrator_certain(const pl_integrator_votes *votes);

/* "semi-implicit Euler", "second order, exact for constant force" or "mixed"; NULL where it is
 * untold. */
const char *pl_integrator_name(const pl_integrator_votes *votes);

#endif
