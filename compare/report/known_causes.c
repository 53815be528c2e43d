/* The causes known so far. Each was found by an experiment: an option of the engine, the time step
 * or the scene was varied, or the adapter changed for the purpose. h is the scenario's step.
 *
 * ODE's two bounded directions and its implicit gyroscopic torque are in its manual; that dantzig
 * takes the bounds from the frictionless normal forces is inferred from the angle of ladder. */
#include "known_causes.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

const char pl_causes_versions[] = "ODE 0.16.2 and Bullet 3.24, at the scenarios' own parameters";

#define EULER "semi-implicit Euler moves by the velocity at the step's end: first order in the step"
#define PYRAMID                                                                                    \
    "friction is a box: two directions bounded each for itself, up to 1.41 times the cone's"
#define FRICTIONLESS_BOUND                                                                         \
    "friction is bounded by the normal force that would act without friction, not by the one "     \
    "that "                                                                                        \
    "acts"
#define FEW_SWEEPS "the fixed number of sweeps ends far from the solution"
#define ONE_POINT                                                                                  \
    "one contact point is sought a step against a plane, and points that have slid by 2 cm are "   \
    "forgotten: fewer bear the body than it has corners"
#define ONE_DIRECTION                                                                              \
    "friction acts in one direction a contact point, at rest an arbitrary one: across it nothing " \
    "holds"
#define PUSH_OUT "the push-out (erp2) of the overlap at the impact is added to the rebound"
#define NNCG_STEP                                                                                  \
    "nncg ends a sweep by a step along its search direction that is not bounded again, so that a " \
    "contact may pull"
#define NO_SWEEPING "no continuous collision detection: between two frames it passes the wall"
#define LATE_IMPACT                                                                                \
    "an impact is seen only once bodies overlap, and answered a step late, with a push-out that "  \
    "depends on the depth"

static const pl_cause causes[] = {
    /* Free motion. */
    {"ode", NULL, "projectile free-fall rocket", NULL, EULER,
     "at h, h/4, h/16 the error is 0.0227, 0.0057, 0.0014; against the rule's own answer 1e-15"},
    {"bullet", NULL, "projectile free-fall rocket", NULL, EULER,
     "at h, h/4, h/16 the error is 0.0227, 0.0057, 0.0014; against the rule's own answer 1e-15"},
    {"ode", NULL, "torque-free", NULL,
     "the implicit gyroscopic torque damps: the spin drifts to the axis of the largest inertia",
     "with an explicit torque in its place the error is 0.007 and not 0.74; at h/16 still 0.70"},
    {"ode", NULL, "top", NULL,
     "the implicit gyroscopic torque damps, and rotation is of first order in the step",
     "with an explicit torque in its place 0.25 and not 1.24; at h/4, h/16 0.28, 0.065"},
    {"bullet", NULL, "top torque-free", NULL, "rotation is of first order in the step",
     "top: at h, h/4, h/16 the error is 0.65, 0.14, 0.033"},

    /* Friction. */
    {"ode", "dantzig", "slope-slide", NULL,
     "only points that overlap are contacts: in the first step rounding leaves out some of the "
     "four "
     "corners, and the block tips",
     "it spins by 0.2 rad/s after a step; at 0.55 and 0.65 rad the contact error is 3e-11"},
    {"bullet", NULL, "slope-slide slide-to-stop isotropy", NULL, ONE_POINT,
     "with plane_multipoint=8 the contact error falls below 3e-5"},
    {"bullet", "si", "reaction-split", NULL, ONE_POINT,
     "with plane_multipoint=8 the contact error falls from 0.007 to 7e-4"},
    {"bullet", NULL, "spin-stop slide-and-spin", NULL,
     "contact points that have slid by 2 cm are forgotten, and friction is of first order in the "
     "step",
     "with plane_multipoint=8 0.025 and 0.034 is left; at h/4 0.006 and 0.011, at h/16 0.0016 and "
     "0.0025"},
    {"ode", NULL, "slide-to-stop isotropy spin-stop carried-balls", NULL, PYRAMID,
     "with the directions turned into the slip 0.014 to 0.026 is left; along x 0.016 in "
     "slide-to-stop, 0.02 in carried-balls"},
    {"ode", NULL, "slide-and-spin", NULL,
     "friction is a box: it also holds each corner across its slip, by up to the full bound",
     "friction over normal force is 0.36 to 0.39 for 0.3, down to h/16; directions turned into "
     "the slip leave 0.33"},
    {"bullet", NULL, "carried-balls", NULL,
     "of first order in the step; and one contact point a step against the plane", "at h/4 0.0045"},
    {"ode", "quick", "slope-threshold slope-tip ladder", NULL, FEW_SWEEPS,
     "with 1000 sweeps it holds: slope-threshold and slope-tip 4e-9, ladder 2e-4 m off"},
    {"bullet", NULL, "slope-threshold slope-tip", NULL, ONE_POINT ", in few sweeps",
     "with plane_multipoint=3 and 1000 sweeps it holds, 5e-14 m off"},
    {"ode", "dantzig", "ladder", NULL, FRICTIONLESS_BOUND,
     "it falls at 52.9 and holds at 53.2 degrees; by that bound it must be 53.0, by the true one "
     "44.4"},
    {"bullet", NULL, "ladder", NULL, ONE_DIRECTION,
     "with two friction directions it holds, 0.7 mm (si) and 20 mm (nncg) off; more sweeps change "
     "nothing"},

    /* Impact. */
    {"ode", NULL, "bounce", NULL,
     "the impact is taken at a frame, with the velocity there, and not when the surface is reached",
     "at h, h/2, h/4, h/8, h/16 the error is 0.011, 0.022, 0.012, 0.009, 0.002"},
    {"bullet", NULL, "bounce", NULL, PUSH_OUT,
     "with erp2=0 the error is that of ODE, 0.011 and not 0.21; with erp2=0.4 it is 1.97"},
    {"bullet", NULL, "oblique-impact collision-train cradle", NULL, PUSH_OUT,
     "with erp2=0 the error is 1e-15, with erp2=0.4 it is twice as large; the cradle then gains no "
     "energy, as shipped 29 %"},
    {"ode", NULL, "rocking-block", NULL, LATE_IMPACT,
     "with erp=0 0.07 (quick) and 0.16 (dantzig); no order in the step: dantzig has 0.044, 0.035, "
     "0.009, 0.017, 0.005 at h .. h/16"},
    {"bullet", NULL, "rocking-block", NULL, LATE_IMPACT,
     "with erp2=0 0.19; no order in the step: si has 0.047, 0.13, 0.009, 0.020, 0.026 at h .. "
     "h/16"},
    {"ode", NULL, "thin-wall", NULL, NO_SWEEPING,
     "it flies 3.3 m a step, and no frame has a contact"},
    {"bullet", NULL, "thin-wall", NULL, NO_SWEEPING " (its motion clamping is off as shipped)",
     "it flies 3.3 m a step, and no frame has a contact; at 1/20000 s it stops"},

    /* At rest. */
    {"ode", "dantzig", "multi-tower pile", "timeout",
     "a dense matrix an island: the time of a step grows with the cube of its contacts",
     "a pile of 20 ends within the limit, one of 100 does not"},
    {"ode", "dantzig", "tower wall pyramid multi-tower far-from-origin large-step", NULL, NULL,
     "not friction: without it a tower of 10 falls too, and gains 104 % of energy; nor cfm from "
     "1e-10 to 0.01; with erp=0 it gains none, and falls; a tower of 5 stands"},
    {"ode", "quick", "tower multi-tower", NULL, FEW_SWEEPS,
     "with 200 sweeps 25 towers of 25 stand, 0.15 m off; of 100 cubes 1000 sweeps are not enough"},
    {"bullet", NULL, "tower multi-tower", NULL, FEW_SWEEPS,
     "a tower of 10 stands with 100 sweeps of si, 25 towers of 25 with 200; of 100 cubes 1000 are "
     "not enough"},
    {"bullet", NULL, "mass-ratio", NULL, FEW_SWEEPS ", and the more so the larger the ratio",
     "at 100 : 1 with 1000 sweeps it stands, 8 mm (si) and 5 mm (nncg) off; at 1e6 : 1 it falls"},
    {"ode", "quick", "mass-ratio", NULL, FEW_SWEEPS ", and the more so the larger the ratio",
     "at 1e6 : 1 with 100,000 sweeps it ends 2 m off in place of 38 m; dantzig, which needs none, "
     "stands"},
    {"ode", "quick", "large-step", NULL,
     "no contact before there is overlap: in a step of 0.1 s bodies fall into each other by g h^2, "
     "a tenth of a cube",
     "at 1/60 s the same tower stands on quick, at 1/30 s it falls; 1000 sweeps change nothing"},
    {"bullet", NULL, "large-step", NULL,
     "in a step of 0.1 s bodies fall into each other by up to g h^2, a tenth of a cube",
     "at 1/60 s the same tower stands on nncg, at 1/30 s it falls; 1000 sweeps change nothing"},
    {"bullet", NULL, "overhang", NULL, ONE_DIRECTION ", and the sweeps are few",
     "with two friction directions and 1000 sweeps of si it stands, 0.1 mm off; with either alone "
     "it "
     "falls"},
    {"ode", NULL, "overhang", NULL, NULL,
     "neither friction nor sweeps: 1000 change nothing; at 0.9 of the largest overhang it stands, "
     "at h/4 too, but dantzig falls again at h/8"},
    {"ode", NULL, "arch", "crashed",
     "two hulls that just touch get a contact whose normal is (0, 0, 0); ODE's own assertion stops "
     "it when it turns the body",
     "two such contacts in step 1, at depths of 1e-16 m; the same with 8 voussoirs, or thicker "
     "ones"},
    {"bullet", NULL, "arch", NULL, NULL,
     "neither sweeps (1000), nor the step (h/16), the margin, two friction directions or an arch "
     "3.5 times as thick change it"},
    {"ode", "quick", "sphere-pyramid", NULL, FEW_SWEEPS, "with 1000 sweeps it stands, 1e-9 m off"},
    {"bullet", NULL, "sphere-pyramid", NULL, ONE_DIRECTION,
     "with two friction directions it stands, 17 mm off; more sweeps and a smaller step change "
     "nothing"},
    {"bullet", NULL, "cylinder-pyramid card-house", NULL, ONE_DIRECTION ", and the sweeps are few",
     "with two friction directions and 1000 sweeps of si it stands, 1 and 4 mm off; with either "
     "alone it falls"},
    {"ode", NULL, "cylinder-pyramid", NULL,
     "likely that parallel cylinders touch in one point (libccd), where a line bears",
     "5 contact points a step at first, of 8; with 1000 sweeps, and dantzig at h/4, it falls too; "
     "the pyramid of spheres stands with 1000 sweeps"},
    {"ode", "dantzig", "card-house", NULL, FRICTIONLESS_BOUND,
     "inferred from ladder; with a friction of 2 in place of 0.5 it stands, 5 mm off"},
    {"ode", "quick", "card-house", NULL, NULL,
     "neither sweeps (1000), nor the step (h/4) or turned friction directions change it; with a "
     "friction of 5 it stands"},
    {"ode", "quick", "needle-in-gap", NULL, FEW_SWEEPS, "with 1000 sweeps it is 8e-7 m off"},
    {"bullet", "nncg", "needle-in-gap pile domino-into-pile", "diverged", NNCG_STEP,
     "si, with the same contacts, ends; needle-in-gap: with 1000 sweeps it no longer diverges"},
    {"bullet", NULL, "needle-in-gap", NULL, NULL,
     "neither sweeps (1000) nor the margin change it; with plane_multipoint=3, with erp2=0 and at "
     "h/4 it is 0.25 m off in place of 1.2"},
    {"bullet", "nncg", "thin-rod", NULL, NNCG_STEP,
     "with 1000 sweeps it rests, 22 mm off, as si does with 10"},
};
enum { CAUSE_COUNT = sizeof causes / sizeof causes[0] };

const pl_cause *pl_causes(int *count)
{
    *count = CAUSE_COUNT;
    return causes;
}

/* `name` is one of the words of `names`. */
static bool is_among(const char *names, const char *name)
{
    size_t length = strlen(name);
    for (const char *word = names; *word != '\0' && length > 0;) {
        size_t size = strcspn(word, " ");
        if (size == length && strncmp(word, name, size) == 0)
            return true;
        word += size + strspn(word + size, " ");
    }
    return false;
}

const pl_cause *pl_cause_find(const char *engine, const char *profile, const char *scenario,
                              const char *outcome)
{
    bool broken = strcmp(outcome, "crashed") == 0 || strcmp(outcome, "timeout") == 0;
    for (int i = 0; i < CAUSE_COUNT; i++) {
        const pl_cause *cause = &causes[i];
        if (strcmp(cause->engine, engine) == 0 &&
            (cause->profile == NULL || strcmp(cause->profile, profile) == 0) &&
            (cause->outcome == NULL ? !broken : strcmp(cause->outcome, outcome) == 0) &&
            is_among(cause->scenarios, scenario))
            return cause;
    }
    return NULL;
}
