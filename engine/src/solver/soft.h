/* Substepped soft contact: the solver for what moves much and must be cheap.
 *
 * The step is cut into n substeps of length h = dt/n. In each, with contact frames frozen at the
 * poses of the step's start and separations s = s_0 + J_n d, d the displacement so far:
 *
 *   v += h M^-1 f + M^-1 J^T p       the loads, and the last substep's impulses as a first guess
 *   bias sweep, normals:             v_n + b(s) = 0, soft where s < 0:
 *                                    dp = -m (a_m (v_n + a_b s) ) - a_p p,   p + dp >= 0
 *   d += h v
 *   relaxing sweep:                  v_n = -max(0, s_0)/dt by normals, then friction, so that the
 *                                    push that mended the separation does not stay in the velocity
 *
 * a_b, a_m and a_p make the contact an implicitly integrated, overdamped spring (Catto 2011, "Soft
 * constraints"; 2024, "Solver2D", which calls this scheme Soft Step); many substeps with one sweep
 * converge better than one step with as many sweeps (Macklin et al. 2019, "Small steps in physics
 * simulation"). Contacts at a restitution above 0 get one sweep more at the end.
 *
 * It is soft: a cube on the ground sinks by g/w^2, w the angular frequency of its springs, and
 * every joint of a column by what it carries, so that high ones sag and sway. One sweep a substep
 * does not converge where a light body is jammed between a heavy one and the ground: what is pushed
 * out there keeps some of the push as energy, which the caller has to bound. */
#ifndef PE_SOFT_H
#define PE_SOFT_H

#include "model/island.h"

typedef struct pe_soft_settings {
    double longest_substep; /* s; the step is cut into at least dt over this many */
    int max_substeps;       /* but not into more than these */

    /* Stiffness of a contact, as the frequency of its spring in cycles a substep. Higher penetrates
     * less; from a quarter on a collapse gains energy from it. */
    double cycles;
    double damping;    /* ratio to critical; below 1 contacts bounce */
    double push_speed; /* m/s, at most, with which a penetration is pushed out */

    /* Manifolds solved at once: 1, 4 (AVX2) or 8 (AVX-512), and not more than the processor has. 0:
     * all it has. The result is the same bits. */
    int lanes;
} pe_soft_settings;

/* Substeps of 1/480 s, at most 12, an eighth of a cycle, damping 10, 0.5 m/s, the widest lanes. */
pe_soft_settings pe_soft_settings_default(void);

typedef struct pe_soft_report {
    int substeps;
    int lanes;
    int bodies, manifolds, points; /* that were solved */
    int colours;                   /* groups of manifolds that share no body */
    double penetration;            /* m, deepest at the step's start */
} pe_soft_report;

/* Advances the bodies of the chosen islands by dt, in s, from the contacts in world->contacts,
 * which must have been found at the poses as they stand and matched to the last step's. Poses and
 * velocities are afterwards those of the step's end, and every point of the chosen islands has the
 * impulse of the whole step. Bodies elsewhere are not touched. Four points a manifold are enough
 * and cheapest; more are solved as well. `chosen` is (islands->count); `report` may be NULL.
 *
 * All it needs is in the step's arena. On PE_NO_MEMORY nothing has changed. The same bits follow
 * whatever the lanes. */
pe_status pe_soft_step(pe_world *world, const pe_islands *islands, const bool *chosen, double dt,
                       pe_soft_report *report, pe_error *error);

/* The same with other settings than the default. */
pe_status pe_soft_step_with(pe_world *world, const pe_islands *islands, const bool *chosen,
                            double dt, const pe_soft_settings *settings, pe_soft_report *report,
                            pe_error *error);

#endif
