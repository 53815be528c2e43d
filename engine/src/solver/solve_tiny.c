/* Newton's method with Coulomb friction for problems of one or two bodies. */
#include "base/vec3.h"
#include "solve.h"

#include <math.h>
#include <string.h>

enum { ROWS = 6 * PE_TINY_BODIES };

/* The compliance at first, in units of a point's scale: less where a light body may carry a heavy
 * one. It falls by tens, to a tenth of that at the least. */
static const double MOST_SOFTNESS = 1e-4, LEAST_SOFTNESS = 1e-8, RATIO_SOFTNESS = 1e-3;

static double first_softness(const pe_problem *problem)
{
    double ratio = 1;
    if (problem->body_count == 2) {
        const double a = problem->inertia[0].mass, b = problem->inertia[1].mass;
        ratio = pe_min(a, b) / pe_max(a, b);
    }
    return pe_max(LEAST_SOFTNESS, pe_min(MOST_SOFTNESS, RATIO_SOFTNESS * ratio));
}

/* The inner solve is exact to this part of the residual, at most to ROUNDING (m/s). */
static const double INNER_PART = 1e-2, ROUNDING = 1e-12;

/* The aim, in units of the tolerance: impulses that later steps keep must not drift. */
static const double DEEPER = 1e-3;

enum { MOST_INNER = 8, MOST_OUTER = 8, CYCLE = 5 };

typedef struct tiny {
    const pe_problem *problem;
    double softness;
    const double (*lambda)[3];              /* (points): multipliers */
    double (*p)[3];                         /* (points): impulses of the iterate */
    double (*gain)[9];                      /* (points): -dp/du */
    double gradient[PE_TINY_BODIES + 1][6]; /* M (v - v*) - J^T p */
    double matrix[ROWS][ROWS + 1];          /* its derivative, and the gradient */
} tiny;

/* ---- One point ---- */

/* The impulse at the argument y, and minus its derivative by the velocity. */
static void respond(double friction, double stiffness, const double y[3], double p[3],
                    double gain[9])
{
    memset(gain, 0, 9 * sizeof *gain);
    p[0] = y[0] > 0 ? y[0] : 0;
    p[1] = p[2] = 0;
    if (!(y[0] > 0)) {
        return;
    }
    gain[0] = stiffness;
    const double t = sqrt(y[1] * y[1] + y[2] * y[2]), radius = friction * p[0];
    if (t <= radius) {
        p[1] = y[1];
        p[2] = y[2];
        gain[4] = gain[8] = stiffness;
    } else if (radius > 0) {
        const double e1 = y[1] / t, e2 = y[2] / t, ratio = stiffness * radius / t;
        p[1] = radius * e1;
        p[2] = radius * e2;
        gain[3] = stiffness * friction * e1;
        gain[6] = stiffness * friction * e2;
        gain[4] = ratio * e2 * e2;
        gain[8] = ratio * e1 * e1;
        gain[5] = gain[7] = -ratio * e1 * e2;
    }
}

/* ---- The iterate ---- */

/* The impulses, gains and gradient at the problem's velocities. Returns the largest component of
 * M^-1 times the gradient, m/s or rad/s. */
static double evaluate(tiny *t)
{
    const pe_problem *problem = t->problem;
    memset(t->gradient, 0, sizeof t->gradient);
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *m = &problem->manifold[i];
        double q[6], wrench[6] = {0};
        pe_solver_manifold_twist(m, (const double(*)[6])problem->velocity, q);
        for (int j = m->first; j < m->first + m->count; ++j) {
            const pe_solver_point *point = &problem->point[j];
            const double stiffness = 1 / (t->softness * point->scale);
            double u[3], y[3];
            pe_point_velocity(point, q, u);
            for (int k = 0; k < 3; ++k) {
                y[k] = t->lambda[j][k] - stiffness * u[k];
            }
            respond(m->friction, stiffness, y, t->p[j], t->gain[j]);
            pe_wrench_add(point, t->p[j], wrench);
        }
        pe_solver_manifold_push(m, wrench, t->gradient);
    }
    double worst = 0;
    for (int i = 0; i < problem->body_count; ++i) {
        double kept[6], off[6];
        pe_problem_momentum(problem, (const double(*)[6])problem->velocity, i, kept);
        for (int k = 0; k < 6; ++k) {
            t->gradient[i][k] = kept[k] - t->gradient[i][k];
        }
        pe_inverse_mass_times(&problem->inertia[i], t->gradient[i], off);
        for (int k = 0; k < 6; ++k) {
            worst = pe_max(worst, fabs(off[k]));
        }
    }
    return worst;
}

/* ---- The derivative ---- */

/* The velocity of a point by the velocity of a body with this arm: rows n, t1, t2. */
static void point_rows(const pe_solver_manifold *m, const double arm[3], const double s[3],
                       double sign, double rows[3][6])
{
    double at[3];
    for (int k = 0; k < 3; ++k) {
        at[k] = arm[k] + m->frame[0][k] * s[0] + m->frame[1][k] * s[1] + m->frame[2][k] * s[2];
    }
    for (int r = 0; r < 3; ++r) {
        double moment[3];
        pe_cross3(at, m->frame[r], moment);
        for (int k = 0; k < 3; ++k) {
            rows[r][k] = sign * m->frame[r][k];
            rows[r][3 + k] = sign * moment[k];
        }
    }
}

/* Adds left^T gain right to the block of bodies a and b. */
static void add_block(tiny *t, int a, int b, double left[3][6], const double gain[9],
                      double right[3][6])
{
    double scaled[3][6];
    for (int r = 0; r < 3; ++r) {
        for (int k = 0; k < 6; ++k) {
            scaled[r][k] = gain[3 * r] * right[0][k] + gain[3 * r + 1] * right[1][k] +
                           gain[3 * r + 2] * right[2][k];
        }
    }
    for (int i = 0; i < 6; ++i) {
        double *row = &t->matrix[6 * a + i][6 * b];
        for (int k = 0; k < 6; ++k) {
            row[k] +=
                left[0][i] * scaled[0][k] + left[1][i] * scaled[1][k] + left[2][i] * scaled[2][k];
        }
    }
}

static void add_mass(tiny *t, int body)
{
    static const int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const pe_inertia *inertia = &t->problem->inertia[body];
    for (int i = 0; i < 3; ++i) {
        t->matrix[6 * body + i][6 * body + i] += inertia->mass;
        for (int k = 0; k < 3; ++k) {
            t->matrix[6 * body + 3 + i][6 * body + 3 + k] += inertia->tensor[place[i][k]];
        }
    }
}

/* Fills the matrix with M + J^T G J and the gradient. */
static void assemble(tiny *t)
{
    const pe_problem *problem = t->problem;
    const int n = problem->body_count;
    memset(t->matrix, 0, sizeof t->matrix);
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *m = &problem->manifold[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            const double *gain = t->gain[j];
            double rows_a[3][6], rows_b[3][6];
            if (gain[0] == 0) {
                continue;
            }
            point_rows(m, m->arm_a, problem->point[j].s, -1, rows_a);
            point_rows(m, m->arm_b, problem->point[j].s, 1, rows_b);
            if (m->a < n) {
                add_block(t, m->a, m->a, rows_a, gain, rows_a);
            }
            if (m->b < n) {
                add_block(t, m->b, m->b, rows_b, gain, rows_b);
            }
            if (m->a < n && m->b < n) {
                add_block(t, m->a, m->b, rows_a, gain, rows_b);
                add_block(t, m->b, m->a, rows_b, gain, rows_a);
            }
        }
    }
    for (int i = 0; i < n; ++i) {
        add_mass(t, i);
        for (int k = 0; k < 6; ++k) {
            t->matrix[6 * i + k][6 * n] = t->gradient[i][k];
        }
    }
}

/* Solves for the Newton step, by elimination with row pivots; false if the matrix is singular. To
 * inline it for each number of rows lets the compiler unroll the loops. */
static inline __attribute__((always_inline)) bool eliminate(double (*matrix)[ROWS + 1], int rows,
                                                            double step[ROWS])
{
    for (int c = 0; c < rows; ++c) {
        int pivot = c;
        for (int r = c + 1; r < rows; ++r) {
            pivot = fabs(matrix[r][c]) > fabs(matrix[pivot][c]) ? r : pivot;
        }
        if (!(fabs(matrix[pivot][c]) > 0)) {
            return false;
        }
        if (pivot != c) {
            for (int k = c; k <= rows; ++k) {
                const double kept = matrix[c][k];
                matrix[c][k] = matrix[pivot][k];
                matrix[pivot][k] = kept;
            }
        }
        const double inverse = 1 / matrix[c][c];
        for (int r = c + 1; r < rows; ++r) {
            const double factor = inverse * matrix[r][c];
            for (int k = c + 1; k <= rows; ++k) {
                matrix[r][k] -= factor * matrix[c][k];
            }
        }
    }
    for (int c = rows - 1; c >= 0; --c) {
        double sum = matrix[c][rows];
        for (int k = c + 1; k < rows; ++k) {
            sum -= matrix[c][k] * step[k];
        }
        step[c] = sum / matrix[c][c];
    }
    return true;
}

static bool find_step(tiny *t, double step[ROWS])
{
    return t->problem->body_count == 1 ? eliminate(t->matrix, 6, step)
                                       : eliminate(t->matrix, 12, step);
}

/* v = from - part step */
static void move(const pe_problem *problem, double (*from)[6], const double step[ROWS], double part)
{
    for (int i = 0; i < problem->body_count; ++i) {
        for (int k = 0; k < 6; ++k) {
            problem->velocity[i][k] = from[i][k] - part * step[6 * i + k];
        }
    }
}

/* Newton steps with the multipliers held, until the gradient is below `enough` (m/s). */
static bool minimise(tiny *t, double enough, int most, pe_solve_report *report)
{
    const pe_problem *problem = t->problem;
    double off = evaluate(t);
    for (int n = 0; n < MOST_INNER && off > enough; ++n) {
        double step[ROWS], from[PE_TINY_BODIES][6];
        if (report->iterations >= most) {
            return false;
        }
        assemble(t);
        if (!find_step(t, step)) {
            return false;
        }
        report->iterations += 1;
        memcpy(from, problem->velocity, (size_t)problem->body_count * sizeof *from);
        double part = n % CYCLE == CYCLE - 1 ? 0.5 : 1;
        move(problem, from, step, part);
        double now = evaluate(t);
        if (!(now < off) && off < 1e-9) {
            return true;
        }
        off = now;
    }
    return off <= enough;
}

pe_status pe_solve_tiny(const pe_problem *problem, const pe_solve_limits *limits, pe_workspace work,
                        pe_solve_report *report, pe_error *error)
{
    const size_t points = (size_t)problem->point_count + 1;
    tiny t = {
        .problem = problem,
        .softness = first_softness(problem),
        .lambda = (const double(*)[3])problem->impulse,
        .p = pe_take(work, points, sizeof *t.p),
        .gain = pe_take(work, points, sizeof *t.gain),
    };
    const double least_softness = pe_max(LEAST_SOFTNESS, 0.1 * t.softness);
    double(*best)[3] = pe_take(work, points, sizeof *best);
    if (t.p == NULL || t.gain == NULL || best == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to solve %d contact points",
                       problem->point_count);
    }
    const size_t impulses = (points - 1) * sizeof *best;
    pe_residual now = pe_problem_residual(problem), least = now;
    memcpy(best, problem->impulse, impulses);
    bool goes_on = true;
    for (int outer = 0; outer < MOST_OUTER && goes_on; ++outer) {
        const double before = now.max;
        const double enough = pe_max(ROUNDING, INNER_PART * pe_min(now.max, 1e-4));
        goes_on = minimise(&t, enough, limits->max_iterations, report);
        memcpy(problem->impulse, t.p, impulses);
        pe_problem_rebuild_velocity(problem);
        now = pe_problem_residual(problem);
        pe_solve_note(report, report->iterations, now.max);
        if (now.max < least.max) {
            least = now;
            memcpy(best, problem->impulse, impulses);
        }
        goes_on &= now.max > DEEPER * limits->tolerance &&
                   !(now.max <= limits->tolerance && now.max > 0.5 * before);
        t.softness = pe_max(least_softness, 0.1 * t.softness);
    }
    if (now.max != least.max) {
        memcpy(problem->impulse, best, impulses);
        pe_problem_rebuild_velocity(problem);
    }
    report->residual = least;
    report->stop = least.max <= limits->tolerance ? PE_STOP_CONVERGED : PE_STOP_STALLED;
    return PE_OK;
}
