/* The proximal augmented Lagrangian method with semismooth Newton steps; the formulas are in
 * solve_newton.h. */
#include "solve_newton.h"

#include "base/vec3.h"

#include <math.h>
#include <string.h>

typedef double vec3[3];
typedef double vec6[6];

typedef struct newton {
    const pe_problem *problem;
    pe_newton_form form;
    pe_pattern pattern;
    pe_factor factor;
    pe_workspace work;
    double softness;
    vec3 *u, *du;     /* (points): J v + b at the iterate, and along the step */
    vec3 *lambda, *p; /* multipliers; projected, the impulses of the iterate */
    vec3 *best;       /* of least residual so far */
    double *bound;    /* (points): De Saxce's shift mu |u_t|, or the radius mu lambda_n */
    pe_gain *gain;
    bool *loaded;   /* (manifolds): whether a point has a gain */
    vec6 *momentum; /* (bodies + 1) M (v - v*) - J^T p, scratch */
    vec6 *step;     /* (bodies + 1) */
} newton;

/* ---- One point ---- */

/* y_i of the augmented Lagrangian at the velocity u. */
static inline void argument(const newton *n, int i, const double u[3], double y[3])
{
    double stiffness = 1 / (n->softness * n->problem->point[i].scale);
    double shift = n->form == PE_NEWTON_CONE ? n->bound[i] : 0;
    y[0] = n->lambda[i][0] - (u[0] + shift) * stiffness;
    y[1] = n->lambda[i][1] - u[1] * stiffness;
    y[2] = n->lambda[i][2] - u[2] * stiffness;
}

/* P(y): the projection on the cone of slope mu, or on the half-line times the disc. */
static inline void project(const newton *n, double mu, double bound, const double y[3], double p[3])
{
    if (mu == 0) {
        p[0] = y[0] > 0 ? y[0] : 0;
        p[1] = p[2] = 0;
        return;
    }
    double t = sqrt(y[1] * y[1] + y[2] * y[2]), radius;
    if (n->form == PE_NEWTON_TRESCA) {
        p[0] = y[0] > 0 ? y[0] : 0;
        radius = bound;
    } else {
        double inside = t <= mu * y[0], outside = mu * t <= -y[0];
        p[0] = inside != 0 ? y[0] : outside != 0 ? 0 : (y[0] + mu * t) / (1 + mu * mu);
        radius = mu * p[0];
    }
    double shrink = t <= radius ? 1 : radius / t;
    p[1] = shrink * y[1];
    p[2] = shrink * y[2];
}

/* From a warm start, impulses that change a velocity by less than this, in m/s, have no part in the
 * derivative: they are the rounding of contacts that touch and carry nothing, and would make the
 * factor more expensive. A contact that is needed exceeds it at the next iteration. */
static const double CARRIES_NOTHING = 1e-10;

/* dP/dy, symmetric: nn, n1, n2, 11, 12, 22; `least` is the smallest y_n that counts. */
static inline void derivative(const newton *n, double mu, double bound, double least,
                              const double y[3], pe_gain g)
{
    g[0] = y[0] >= least;
    g[1] = g[2] = g[3] = g[4] = g[5] = 0;
    if (mu == 0) {
        return;
    }
    double t = sqrt(y[1] * y[1] + y[2] * y[2]), ratio;
    bool sticks;
    double e1 = t > 0 ? y[1] / t : 0, e2 = t > 0 ? y[2] / t : 0, along = 0;
    if (n->form == PE_NEWTON_TRESCA) {
        if (bound <= mu * least) {
            return;
        }
        sticks = t <= bound;
        ratio = sticks ? 1 : bound / t;
    } else if (t <= mu * y[0]) {
        sticks = true;
        ratio = 1;
    } else if (mu * t <= -y[0]) {
        g[0] = 0;
        return;
    } else {
        double s = 1 / (1 + mu * mu);
        sticks = false;
        ratio = mu * s * (y[0] + mu * t) / t;
        g[0] = s;
        g[1] = s * mu * e1;
        g[2] = s * mu * e2;
        along = s * mu * mu;
    }
    if (sticks) {
        g[3] = g[5] = 1;
        return;
    }
    /* ratio (1 - e e^T) + along e e^T */
    g[3] = ratio + (along - ratio) * e1 * e1;
    g[4] = (along - ratio) * e1 * e2;
    g[5] = ratio + (along - ratio) * e2 * e2;
}

/* ---- The function minimised ---- */

/* At the iterate: impulses p, the gradient into n->momentum; returns the largest component of
 * M^-1 times it, a velocity in m/s (or rad/s). */
static double evaluate(newton *n)
{
    const pe_problem *problem = n->problem;
    memset(n->momentum, 0, ((size_t)problem->body_count + 1) * sizeof *n->momentum);
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        double q[6], wrench[6] = {0};
        pe_solver_manifold_twist(manifold, (const vec6 *)problem->velocity, q);
        n->loaded[i] = false;
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            double y[3];
            pe_point_velocity(&problem->point[j], q, n->u[j]);
            argument(n, j, n->u[j], y);
            project(n, manifold->friction, n->bound[j], y, n->p[j]);
            pe_wrench_add(&problem->point[j], n->p[j], wrench);
            double stiffness = 1 / (n->softness * problem->point[j].scale);
            /* Without a warm start every contact may carry: bodies that start to fall together do
             * not approach each other yet. */
            double least =
                n->form == PE_NEWTON_CONE ? 0 : CARRIES_NOTHING / problem->point[j].scale;
            derivative(n, manifold->friction, n->bound[j], least, y, n->gain[j]);
            for (int k = 0; k < 6; ++k) {
                n->gain[j][k] *= stiffness;
            }
            n->loaded[i] |= n->gain[j][0] != 0 || n->gain[j][3] != 0;
        }
        pe_solver_manifold_push(manifold, wrench, n->momentum);
    }
    double worst = 0;
    for (int i = 0; i < problem->body_count; ++i) {
        double kept[6], off[6];
        pe_problem_momentum(problem, (const vec6 *)problem->velocity, i, kept);
        for (int k = 0; k < 6; ++k) {
            n->momentum[i][k] = kept[k] - n->momentum[i][k];
        }
        pe_inverse_mass_times(&problem->inertia[i], n->momentum[i], off);
        for (int k = 0; k < 6; ++k) {
            double size = fabs(off[k]);
            worst = size > worst || size != size ? size : worst;
        }
    }
    return worst;
}

/* The function's slope at the fraction a of the step: constant + a curvature - sum P(y) . du. */
typedef struct ray {
    double constant, curvature;
} ray;

static double slope(const newton *n, ray along, double a)
{
    const pe_problem *problem = n->problem;
    double sum = along.constant + a * along.curvature;
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            double u[3], y[3], p[3];
            for (int k = 0; k < 3; ++k) {
                u[k] = n->u[j][k] + a * n->du[j][k];
            }
            argument(n, j, u, y);
            project(n, manifold->friction, n->bound[j], y, p);
            sum -= pe_dot3(p, n->du[j]);
        }
    }
    return sum;
}

/* Of the first slope: the whole step is taken if the slope at its end climbs by no more than this
 * part, and the search ends when the slope is this small. */
static const double CLIMB = 0.1, FLAT = 0.05;
enum { MAX_TRIALS = 30 };

/* Fraction of the step at which the slope, which rises along it, is near 0; 1 if it does not climb.
 * `start` is the slope at 0, negative. (Illinois variant of regula falsi.) */
static double search(const newton *n, ray along, double start)
{
    double low = 0, at_low = start, high = 1, at_high = slope(n, along, 1);
    if (at_high <= CLIMB * -start) {
        return 1;
    }
    double a = 1;
    for (int i = 0; i < MAX_TRIALS; ++i) {
        a = low - at_low * (high - low) / (at_high - at_low);
        if (!(a > low + 0.02 * (high - low) && a < high - 0.02 * (high - low))) {
            a = 0.5 * (low + high);
        }
        double here = slope(n, along, a);
        if (fabs(here) < FLAT * -start) {
            break;
        }
        if (here > 0) {
            high = a, at_high = here;
            at_low *= 0.5;
        } else {
            low = a, at_low = here;
            at_high *= 0.5;
        }
    }
    return a;
}

/* Finds the pattern again if a loaded manifold is not in it. *affordable: whether its factor is. */
static pe_status renew_pattern(newton *n, const pe_solve_report *report, bool *affordable,
                               pe_error *error)
{
    bool fits = true;
    for (int i = 0; i < n->problem->manifold_count; ++i) {
        fits &= !n->loaded[i] | n->pattern.counted[i];
        n->loaded[i] |= n->pattern.counted[i];
    }
    pe_status status =
        fits ? PE_OK : pe_pattern_find(n->problem, n->loaded, n->work, &n->pattern, error);
    *affordable = status == PE_OK && pe_solve_may_factor(report, n->pattern.flops);
    return fits || !*affordable ? status
                                : pe_factor_create(&n->pattern, n->work, &n->factor, error);
}

/* One Newton step from the evaluated iterate; false when the factorisation failed. */
static bool take_step(newton *n)
{
    const pe_problem *problem = n->problem;
    pe_factor_assemble(&n->factor, problem, (const pe_gain *)n->gain);
    if (!pe_factor_compute(&n->factor)) {
        return false;
    }
    pe_factor_solve(&n->factor, (const vec6 *)n->momentum, n->step);
    double start = 0;
    ray along = {0};
    for (int i = 0; i < problem->body_count; ++i) {
        double kept[6], moved[6];
        for (int k = 0; k < 6; ++k) {
            n->step[i][k] = -n->step[i][k];
            start += n->momentum[i][k] * n->step[i][k];
        }
        pe_problem_momentum(problem, (const vec6 *)problem->velocity, i, kept);
        pe_mass_times(&problem->inertia[i], n->step[i], moved);
        for (int k = 0; k < 6; ++k) {
            along.constant += kept[k] * n->step[i][k];
            along.curvature += moved[k] * n->step[i][k];
        }
    }
    memset(n->step[problem->body_count], 0, sizeof *n->step);
    pe_problem_point_velocities(problem, (const vec6 *)n->step, false, n->du);
    double a = search(n, along, start);
    for (int i = 0; i < problem->body_count; ++i) {
        for (int k = 0; k < 6; ++k) {
            problem->velocity[i][k] += a * n->step[i][k];
        }
    }
    return true;
}

/* ---- The two loops ---- */

/* Sets what the next inner solve holds fixed: the shift of the cone, or the radius of the disc. */
static void renew_bounds(newton *n, bool first)
{
    const pe_problem *problem = n->problem;
    if (n->form == PE_NEWTON_CONE) {
        pe_problem_point_velocities(problem, (const vec6 *)problem->velocity, true, n->u);
    }
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            const double *u = n->u[j];
            if (n->form == PE_NEWTON_TRESCA) {
                n->bound[j] = manifold->friction * n->lambda[j][0];
            } else {
                n->bound[j] = first ? 0 : manifold->friction * sqrt(u[1] * u[1] + u[2] * u[2]);
            }
        }
    }
}

/* An inner solve whose error is below this, in m/s, and does not halve in a step is at its
 * rounding. */
static const double ROUNDING = 1e-9;

/* The residual that rounding of velocities leaves at this compliance, m/s, since the residual has
 * u/R in it. */
static double rounding_floor(const newton *n)
{
    const pe_problem *problem = n->problem;
    double fastest = 0;
    for (int i = 0; i < problem->body_count; ++i) {
        for (int k = 0; k < 6; ++k) {
            fastest = pe_max(fastest, fabs(problem->velocity[i][k]));
        }
    }
    return 0x1p-50 * fastest / n->softness;
}

/* An inner solve that takes more iterations than this does not end. */
enum { MAX_INNER = 60 };

typedef enum inner_end { INNER_SOLVED, INNER_ITERATIONS, INNER_BROKEN } inner_end;

/* Minimises until M^-1 times the gradient is below `enough` (m/s), with at most `most` iterations
 * in all. */
static pe_status minimise(newton *n, double enough, int most, pe_solve_report *report,
                          inner_end *end, pe_error *error)
{
    double previous = HUGE_VAL;
    for (int stalls = 0, begun = report->iterations;;) {
        double off = evaluate(n);
        stalls += off > 0.5 * previous && off < ROUNDING;
        previous = off;
        if (off < enough || stalls > 2) {
            *end = INNER_SOLVED;
            return PE_OK;
        }
        if (report->iterations >= most || report->iterations - begun >= MAX_INNER) {
            *end = INNER_ITERATIONS;
            return PE_OK;
        }
        bool affordable;
        pe_status status = renew_pattern(n, report, &affordable, error);
        if (status != PE_OK || !affordable) {
            *end = INNER_ITERATIONS;
            return status;
        }
        if (!take_step(n)) {
            *end = INNER_BROKEN;
            return PE_OK;
        }
        report->iterations += 1;
        report->factor_flops += n->factor.pattern->flops;
    }
}

static pe_status create(const pe_problem *problem, const pe_pattern *pattern, pe_workspace work,
                        newton *n, pe_error *error)
{
    size_t points = (size_t)problem->point_count + 1, bodies = (size_t)problem->body_count + 1;
    *n = (newton){
        .problem = problem,
        .pattern = *pattern,
        .work = work,
        .loaded = pe_take(work, (size_t)problem->manifold_count + 1, sizeof *n->loaded),
        .u = pe_take(work, points, sizeof *n->u),
        .du = pe_take(work, points, sizeof *n->du),
        .lambda = problem->impulse,
        .p = pe_take(work, points, sizeof *n->p),
        .best = pe_take(work, points, sizeof *n->best),
        .bound = pe_take(work, points, sizeof *n->bound),
        .gain = pe_take(work, points, sizeof *n->gain),
        .momentum = pe_take(work, bodies, sizeof *n->momentum),
        .step = pe_take(work, bodies, sizeof *n->step),
    };
    if (n->u == NULL || n->du == NULL || n->p == NULL || n->best == NULL || n->bound == NULL ||
        n->gain == NULL || n->loaded == NULL || n->momentum == NULL || n->step == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to solve %d contact points",
                       problem->point_count);
    }
    return pe_factor_create(&n->pattern, work, &n->factor, error);
}

/* Outer iterations at the least softness that do not halve the residual, before the method has
 * stalled. */
enum { MAX_STALLS = 3 };
static const double INNER_ENOUGH = 1e-6; /* m/s: the loosest tolerance of an inner solve */

/* A tenth of (pi/2D)^2 for a chain of D bodies on each other, and less where a light body carries a
 * heavy one. Below the least, rounding shows. */
static const double MOST_SOFTNESS = 1e-4, LEAST_SOFTNESS = 1e-8, CHAIN_SOFTNESS = 1e-3;

pe_newton_settings pe_newton_settings_for(const pe_pattern *pattern, pe_newton_form form,
                                          double enough)
{
    double depth = pattern->depth;
    double softness =
        pe_max(LEAST_SOFTNESS,
               pe_min(MOST_SOFTNESS, CHAIN_SOFTNESS * pattern->mass_ratio / (depth * depth)));
    return (pe_newton_settings){
        .pattern = pattern,
        .form = form,
        .softness = softness,
        .least_softness = pe_max(LEAST_SOFTNESS, 0.1 * softness),
        .most_updates = PE_NEWTON_UPDATES,
        .enough = enough,
    };
}

pe_status pe_newton_prepare(const pe_problem *problem, const pe_solve_limits *limits,
                            pe_workspace work, pe_pattern *pattern, pe_newton_settings *settings,
                            pe_error *error)
{
    pe_status status = pe_pattern_find(problem, NULL, work, pattern, error);
    if (status == PE_OK) {
        bool warm = pe_problem_has_impulse(problem);
        *settings = pe_newton_settings_for(pattern, warm ? PE_NEWTON_TRESCA : PE_NEWTON_CONE,
                                           limits->tolerance);
    }
    return status;
}

pe_status pe_newton(const pe_problem *problem, const pe_newton_settings *settings,
                    const pe_solve_limits *limits, pe_workspace work, pe_solve_report *report,
                    pe_error *error)
{
    newton n;
    pe_status status = create(problem, settings->pattern, work, &n, error);
    if (status != PE_OK) {
        return status;
    }
    size_t impulses = (size_t)problem->point_count * sizeof *n.best;
    n.form = settings->form;
    n.softness = settings->softness;
    pe_problem_rebuild_velocity(problem);
    pe_residual least = pe_problem_residual(problem), now = least;
    memcpy(n.best, n.lambda, impulses);
    double previous = HUGE_VAL;
    report->stop = PE_STOP_STALLED;
    for (int outer = 0, stalls = 0; outer < settings->most_updates; ++outer) {
        renew_bounds(&n, outer == 0);
        double floor = rounding_floor(&n);
        double enough = pe_max(pe_min(INNER_ENOUGH, 0.1 * now.max), 0.1 * limits->tolerance);
        enough = pe_max(enough, floor);
        inner_end end;
        status = minimise(&n, enough, limits->max_iterations, report, &end, error);
        if (status != PE_OK) {
            return status;
        }
        memcpy(n.lambda, n.p, impulses);
        pe_problem_rebuild_velocity(problem);
        now = pe_problem_residual(problem);
        pe_solve_note(report, report->iterations, now.max);
        if (now.max < least.max) {
            least = now;
            memcpy(n.best, n.lambda, impulses);
        }
        bool stalled = now.max > 0.5 * previous;
        bool floored = now.max <= floor || stalled;
        if (now.max <= limits->tolerance || (floored && now.max <= settings->enough)) {
            report->stop = PE_STOP_CONVERGED;
            break;
        }
        if (end != INNER_SOLVED) {
            report->stop = end == INNER_BROKEN ? PE_STOP_STALLED : PE_STOP_ITERATIONS;
            break;
        }
        bool softest = n.softness <= settings->least_softness;
        stalls = stalled ? stalls + 1 : 0;
        if (stalls >= MAX_STALLS && softest) {
            break;
        }
        previous = now.max;
        n.softness = pe_max(settings->least_softness, 0.1 * n.softness);
    }
    memcpy(n.lambda, n.best, impulses);
    pe_problem_rebuild_velocity(problem);
    report->residual = least;
    return PE_OK;
}

pe_status pe_solve_newton(const pe_problem *problem, const pe_solve_limits *limits,
                          pe_workspace work, pe_solve_report *report, pe_error *error)
{
    pe_pattern pattern;
    pe_newton_settings settings;
    pe_status status = pe_newton_prepare(problem, limits, work, &pattern, &settings, error);
    return status != PE_OK ? status : pe_newton(problem, &settings, limits, work, report, error);
}
