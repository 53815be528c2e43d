/* Sub-stepped soft contact: the solver for islands that move much and must be cheap.
 *
 * The step is cut into n sub-steps of length h = dt/n. In each, with contact frames frozen at the
 * poses of the step's start and separations s = s_0 + J_n d, where d is the displacement so far:
 *
 *   v += h M^-1 f + M^-1 J^T p       applied forces; the last sub-step's impulses as a warm start
 *   bias sweep, normals:             v_n + b(s) = 0, soft where s < 0:
 *                                    dp = -m (a_m (v_n + a_b s)) - a_p p,   p + dp >= 0
 *   d += h v
 *   relaxing sweep:                  v_n = -max(0, s_0)/dt by normals, then friction, so that the
 *                                    velocity that corrected the separation does not stay
 *
 * a_b, a_m and a_p make the contact an implicitly integrated, overdamped spring (Catto 2011, "Soft
 * constraints"; 2024, "Solver2D", which calls this scheme Soft Step). Many sub-steps with one sweep
 * each converge better than one step with as many sweeps (Macklin et al. 2019, "Small steps in
 * physics simulation"). Nothing rebounds: an island in which a contact rebounds needs another
 * solver.
 *
 * The number of sub-steps goes by the root of dt, so that springs are the stiffer the shorter the
 * step is, and penetration falls with it.
 *
 * Limits: contacts are soft. A cube on the ground sinks by g/w^2, with w the angular
 * frequency of its springs, and every joint of a column by what it carries, so that high columns sag
 * and sway. One sweep a sub-step does not converge where a light body is jammed between a heavy one
 * and the ground; some of the push then stays as energy, which the caller has to bound. */
#ifndef PE_SOFT_H
#define PE_SOFT_H

#include "solver_body.h"

/* Settings of the soft contact solver. */
typedef struct pe_soft_settings {
    double substeps; /* of a step of 1/60 s; their number goes by the root of the step's length */
    int least_substeps, most_substeps; /* bounds on their number */

    /* Stiffness of a contact: the frequency of its spring in cycles per sub-step. Higher values
     * penetrate less; from a quarter on a collapse gains energy from it. */
    double cycles;
    double damping;    /* ratio to critical; below 1 contacts bounce */
    double push_speed; /* m/s: the highest speed at which a penetration is pushed out */

    /* Manifolds solved at once: 1, 4 (AVX2) or 8 (AVX-512), at most what the processor has. 0: all
     * it has. The result is the same bits. */
    int lanes;
} pe_soft_settings;

/* 10 sub-steps of 1/60 s, 6 to 12 of any step; a fifth of a cycle, damping 5, 0.5 m/s, the widest
 * lanes. */
pe_soft_settings pe_soft_settings_default(void);

/* Counts of a step of the soft contact solver. */
typedef struct pe_soft_report {
    int substeps;
    int lanes;
    int bodies, manifolds, points; /* that were solved */
    int colours;                   /* groups of manifolds that share no body */
    double penetration;            /* m, deepest at the step's start */
} pe_soft_report;

/* Steps the bodies of the chosen islands by dt (s) with the contacts in world->contacts, which must
 * have been found at the present poses and matched to those of the last step. Afterwards poses and
 * velocities are those of the step's end, and every manifold point of the chosen islands has the
 * impulse of the whole step. Other bodies are not touched. Four points a manifold are enough and
 * cheapest; more are solved as well.
 *
 * `given` NULL: the default settings. `report` may be NULL. Memory comes from the step's arena. On
 * PE_NO_MEMORY nothing has changed. The result is the same bits for all lanes. */
pe_status pe_soft_step(pe_world *world, const pe_chosen_islands *islands, double dt,
                       const pe_soft_settings *given, pe_soft_report *report, pe_error *error);

#endif
