/* Numbers of one frame that are drawn as curves over time. */
#ifndef PLUMB_CURVES_H
#define PLUMB_CURVES_H

#include "plumb/scene.h"

#include "plumb/engine_abi.h"

/* The curves of a run. */
typedef enum pl_curve {
    PL_CURVE_REST_ERROR,  /* m: the largest distance of a body from where it is expected to rest */
    PL_CURVE_PENETRATION, /* m: the deepest overlap of the frame */
    PL_CURVE_KINETIC_ENERGY, /* J: of all dynamic bodies */
    PL_CURVE_ENERGY,         /* J: kinetic, and potential in gravity from that of the start on */
    PL_CURVE_ITERATIONS,     /* as the engine reports them */
    PL_CURVE_RESIDUAL,       /* as the engine reports it */
    PL_CURVE_CONTACT_FORCE,  /* N: the sum of |impulse| / dt over the contacts */
    PL_CURVE_COUNT
} pl_curve;

/* The name of a curve in recordings, such as "rest_error". */
const char *pl_curve_name(pl_curve curve);

/* Sets the curves of a frame that follow from the states of the bodies, (scene->body_count), and from
 * the contacts of the step before it (count < 0: the engine reports no impulses). NAN where a curve
 * does not apply; penetration, iterations and residual are left as they are. */
void pl_curves_of(const pl_scene *scene, const pl_body_state *bodies, const pl_contact *contacts,
                  int contact_count, double value[PL_CURVE_COUNT]);

#endif
