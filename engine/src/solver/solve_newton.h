/* Proximal augmented Lagrangian with semismooth Newton steps: the direct solver. */
#ifndef PE_SOLVE_NEWTON_H
#define PE_SOLVE_NEWTON_H

#include "solve.h"
#include "sparse/factor.h"

typedef enum pe_newton_form {
    /* The round cone with De Saxce's shift renewed between solves: needs no impulse to start from.
     */
    PE_NEWTON_CONE,
    /* Friction bounded by mu times the last normal impulse (Tresca), renewed between solves: true
     * Coulomb without lift, from a start near the answer. */
    PE_NEWTON_TRESCA
} pe_newton_form;

/* The compliance of point i is r w_i, from `softness` down by tens to `least_softness`. */
typedef struct pe_newton_settings {
    pe_newton_form form;
    double softness, least_softness;
    int most_updates; /* of the multipliers */
    double enough;    /* m/s: below this residual it ends when an update does not halve it */
} pe_newton_settings;

/* Minimises, for multipliers lambda held fixed,
 *
 *   1/2 |v - v*|_M^2 + sum (R_i/2) |P(y_i)|^2,  y_i = lambda_i - (u_i + s_i n)/R_i,  R_i = r w_i
 *
 * by Newton's method with an exact line search, sets lambda = P(y), and again, until the residual
 * of the true problem is met. `pattern` is what it begins with, and is found again when a manifold
 * that was not counted begins to carry. A solve that did not converge never touches the
 * multipliers. The number of iterations is that of factorisations. (Rockafellar 1976; Alart and
 * Curnier 1991; Qi and Sun 1993.)
 */
pe_status pe_newton(const pe_problem *problem, const pe_pattern *pattern,
                    const pe_newton_settings *settings, const pe_solve_limits *limits,
                    pe_workspace work, pe_solve_report *report, pe_error *error);

#endif
