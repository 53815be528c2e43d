/* What the referee holds of a run: filled by referee.c, made into metrics by referee_metrics.c. */
#ifndef PLUMB_REFEREE_STATE_H
#define PLUMB_REFEREE_STATE_H

#include "referee.h"
#include "referee/geometry/candidate_pairs.h"
#include "referee/metrics/contact_force.h"
#include "referee/metrics/contact_groups.h"
#include "referee/metrics/drift.h"
#include "referee/metrics/mechanics.h"
#include "referee/metrics/path.h"
#include "referee/metrics/penetration.h"
#include "referee/metrics/scale.h"
#include "referee/metrics/series.h"
#include "referee/metrics/settle.h"
#include "referee/metrics/spread.h"
#include "referee/metrics/value.h"

/* The first three have one for each integrator. */
typedef enum series_id {
    OF_ENERGY,
    OF_STEP_GAIN = OF_ENERGY + PL_INTEGRATOR_COUNT,
    OF_MOMENTUM = OF_STEP_GAIN + PL_INTEGRATOR_COUNT,
    OF_LIFT = OF_MOMENTUM + PL_INTEGRATOR_COUNT,
    OF_DEVIATION,
    OF_ITERATIONS,
    OF_RESIDUAL,
    OF_CONTACTS,
    OF_TIME,
    SERIES_COUNT
} series_id;

struct pl_referee {
    const pl_scene *scene;
    pl_scale scale;
    long asked, done; /* steps */
    pl_verdict ended; /* what ended the run early, with its reason */
    pl_error reason;
    pl_candidate_pairs *nearby;
    pl_penetration *penetration;
    pl_mechanics *mechanics;
    pl_contact_force *force;
    pl_islands *islands;
    pl_path *path;
    pl_values *values;
    pl_spread *spread;
    pl_settle settle;
    pl_drift *since_quiet, *since_fixed;
    long fixed_step; /* where since_fixed begins */
    pl_series series[SERIES_COUNT];
    long no_contacts_step;     /* first step whose contacts the engine did not report; 0: none */
    long foreign_contact_step; /* first step with a contact of no body of the scene; 0: none */
    pl_body_state *last;       /* (body_count): the last good frame */
};

#endif
