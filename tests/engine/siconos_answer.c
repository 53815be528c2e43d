/* Siconos' solvers on our problems. */
#include "siconos_answer.h"

#include "contact_problem_for_tests.h"

#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <stdlib.h>
#include <string.h>

/* What it is asked for: relative. */
static const double TOLERANCE = 1e-12;

/* Computes q, and W column by column: the velocities of all points after a unit impulse. */
static bool assemble(const pe_contact_problem *problem, double *w, double *q)
{
    int points = problem->point_count;
    size_t count = (size_t)points;
    double(*p)[3] = calloc(count, sizeof *p), (*u)[3] = calloc(count, sizeof *u);
    double(*free_u)[3] = calloc(count, sizeof *free_u);
    double(*v)[6] = calloc((size_t)problem->body_count, sizeof *v);
    const bool enough = p != NULL && u != NULL && free_u != NULL && v != NULL;
    if (!enough) {
        goto cleanup;
    }
    reference_velocities(problem, (const double(*)[3])p, v);
    reference_contact_velocities(problem, (const double(*)[6])v, free_u);
    memcpy(q, free_u, count * sizeof *free_u);
    for (int j = 0; j < 3 * points; ++j) {
        p[j / 3][j % 3] = 1;
        reference_velocities(problem, (const double(*)[3])p, v);
        reference_contact_velocities(problem, (const double(*)[6])v, u);
        p[j / 3][j % 3] = 0;
        for (int i = 0; i < 3 * points; ++i) {
            w[i + 3 * points * j] = u[i / 3][i % 3] - free_u[i / 3][i % 3];
        }
    }
cleanup:
    free(p);
    free(u);
    free(free_u);
    free(v);
    return enough;
}

bool siconos_answer(pe_contact_problem *problem, int solver)
{
    int points = problem->point_count;
    size_t size = 3 * (size_t)points;
    NumericsMatrix *w = NM_create(NM_DENSE, 3 * points, 3 * points);
    double *q = malloc(size * sizeof *q), *mu = malloc((size_t)points * sizeof *mu);
    double *reaction = calloc(size, sizeof *reaction), *velocity = calloc(size, sizeof *velocity);
    if (q == NULL || mu == NULL || reaction == NULL || velocity == NULL ||
        !assemble(problem, w->matrix0, q)) {
        NM_clear(w);
        free(w);
        free(q);
        free(mu);
        free(reaction);
        free(velocity);
        return false;
    }
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_problem_manifold *m = &problem->manifolds[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            mu[j] = m->friction;
        }
    }
    FrictionContactProblem *theirs = frictionContactProblem_new_with_data(3, points, w, q, mu);
    SolverOptions *options = solver_options_create(solver);
    options->dparam[SICONOS_DPARAM_TOL] = TOLERANCE;
    options->iparam[SICONOS_IPARAM_MAX_ITER] = 20000;
    fc3d_driver(theirs, reaction, velocity, options);
    for (int j = 0; j < points; ++j) {
        memcpy(problem->points[j].impulse, &reaction[3 * j], sizeof problem->points[j].impulse);
    }
    solver_options_delete(options);
    free(options);
    frictionContactProblem_free(theirs); /* with w, q and mu */
    free(reaction);
    free(velocity);
    return true;
}

/* Siconos does not free all that it allocates. The leak checker reads this. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libsiconos_numerics";
}
