#include "solve.h"

/* Parts of the tolerance. Impulses that are kept without a sweep leave the same error at every
 * step, and bodies creep by it: a warm start must be far better than a solve. */
static const double ACCEPT_WARM = 0.01;
static const double ACCEPT_SOLVED = 0.1;

/* Sweeps between two looks at the residual, at most: a look costs about a sweep. */
enum { MAX_LOOK_INTERVAL = 16 };

static void update(const pe_row *row, double *restrict p, double *restrict ya, double *restrict yb)
{
    double un = pe_row_velocity(row, 0, ya, yb) + row->bias;
    double n = pe_max(0, p[0] - un * row->inverse_wnn);
    double dn = n - p[0];
    if (n == 0 && dn == 0) {
        return; /* open, and was: no friction either */
    }
    p[0] = n;
    if (row->friction > 0) {
        /* The slip as the new normal impulse leaves it. */
        double u1 = pe_row_velocity(row, 1, ya, yb) + row->wn1 * dn;
        double u2 = pe_row_velocity(row, 2, ya, yb) + row->wn2 * dn;
        double t1 = p[1] - u1 * row->inverse_wtt, t2 = p[2] - u2 * row->inverse_wtt;
        double square = t1 * t1 + t2 * t2, radius = row->friction * n;
        if (square > radius * radius) {
            double shrink = radius / sqrt(square);
            t1 *= shrink;
            t2 *= shrink;
        }
        double d1 = t1 - p[1], d2 = t2 - p[2];
        p[1] = t1;
        p[2] = t2;
        for (int k = 0; k < 6; ++k) {
            ya[k] += dn * row->ja[0][k] + (d1 * row->ja[1][k] + d2 * row->ja[2][k]);
            yb[k] += dn * row->jb[0][k] + (d1 * row->jb[1][k] + d2 * row->jb[2][k]);
        }
    } else if (dn != 0) {
        pe_row_add(ya, dn, row->ja[0]);
        pe_row_add(yb, dn, row->jb[0]);
    }
}

/* Sweeping damps the slowest mode of a chain of N bodies by a factor 1 - O(1/N^2) a sweep, so that
 * what has not converged after a multiple of N^2 sweeps will not: an island of few points stops
 * there, a large one at the bound on work, but not before it has had a fair number of sweeps. */
static const double SWEEPS_PER_SQUARED_COUNT = 50;
static const double LEAST_BOUND = 50;

static int sweep_limit(const pe_problem *problem, const pe_solve_limits *limits)
{
    double n = problem->count;
    double most = pe_max(LEAST_BOUND, limits->max_updates / n);
    return (int)pe_min(limits->max_iterations, pe_min(SWEEPS_PER_SQUARED_COUNT * n * n, most));
}

void pe_solve_gauss_seidel(const pe_problem *problem, const pe_solve_limits *limits,
                           pe_solve_report *report)
{
    *report = (pe_solve_report){0};
    pe_problem_rebuild_velocity(problem);
    report->residual = pe_problem_residual(problem);
    double target = ACCEPT_WARM * limits->tolerance;
    int most = sweep_limit(problem, limits), interval = 1, next_look = 1;
    while (report->residual > target && report->iterations < most) {
        for (int i = 0; i < problem->count; ++i) {
            const pe_row *row = &problem->rows[i];
            update(row, problem->impulse[i], problem->velocity[row->a], problem->velocity[row->b]);
        }
        report->iterations += 1;
        target = ACCEPT_SOLVED * limits->tolerance;
        if (report->iterations == next_look || report->iterations == most) {
            report->residual = pe_problem_residual(problem);
            interval = interval < MAX_LOOK_INTERVAL ? 2 * interval : MAX_LOOK_INTERVAL;
            next_look = report->iterations + interval;
        }
    }
    if (report->iterations > 0) {
        /* Rounding has gathered in the velocities: what is reported is what the impulses give. */
        pe_problem_rebuild_velocity(problem);
        report->residual = pe_problem_residual(problem);
    }
    report->converged = report->residual <= limits->tolerance;
}
