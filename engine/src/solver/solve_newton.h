/* Proximal augmented Lagrangian method with semismooth Newton steps.
 *
 * For multipliers lambda held fixed it minimises
 *
 *   1/2 |v - v*|_M^2 + sum (R_i/2) |P(y_i)|^2,  y_i = lambda_i - (u_i + s_i n)/R_i,  R_i = r w_i
 *
 * by Newton's method with an exact line search, then sets lambda = P(y), and repeats until the
 * residual of the true problem is met. P projects on the friction cone or on the Tresca cylinder.
 * (Rockafellar 1976; Alart and Curnier 1991; Qi and Sun 1993.) */
#ifndef PE_SOLVE_NEWTON_H
#define PE_SOLVE_NEWTON_H

#include "solve.h"
#include "sparse/factor.h"

/* The friction law of the inner problem. */
typedef enum pe_newton_form {
    /* The round cone with De Saxce's shift renewed between inner solves. It needs no impulse to
       start from. */
    PE_NEWTON_CONE,
    /* Friction bounded by mu times the last normal impulse (Tresca), renewed between inner solves:
     * true Coulomb friction without the shift, from a start near the answer. */
    PE_NEWTON_TRESCA
} pe_newton_form;

enum { PE_NEWTON_UPDATES = 60 }; /* the default bound */

/* The compliance r starts at `softness` and falls by tens to `least_softness`. */
typedef struct pe_newton_settings {
    const pe_pattern *pattern; /* found again when a manifold outside it begins to carry */
    pe_newton_form form;
    double softness, least_softness;
    int most_updates; /* of the multipliers */
    double enough; /* m/s: the method ends below this residual when an update does not halve it */
} pe_newton_settings;

/* The compliance with which a problem of this pattern converges in a few updates of the
 * multipliers. */
pe_newton_settings pe_newton_settings_for(const pe_pattern *pattern, pe_newton_form form,
                                          double enough);

/* The pattern of all manifolds and the settings for it: the Tresca form, or the cone form if there
 * is no impulse to start from. */
pe_status pe_newton_prepare(const pe_problem *problem, const pe_solve_limits *limits,
                            pe_workspace work, pe_pattern *pattern, pe_newton_settings *settings,
                            pe_error *error);

/* Solves from problem->impulse. Iterations are factorisations. An inner solve that did not converge
 * never changes the multipliers. */
pe_status pe_newton(const pe_problem *problem, const pe_newton_settings *settings,
                    const pe_solve_limits *limits, pe_workspace work, pe_solve_report *report,
                    pe_error *error);

#endif
