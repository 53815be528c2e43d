/* Projected Gauss-Seidel with a round friction cone (Jourdan, Alart, Jean 1998), plain and with
 * momentum: with momentum a sweep starts at a point extrapolated from the last two. */
#include "solve.h"

#include "kernels.h"

/* ---- Momentum ---- */

/* Momentum at the start, and the rates and bounds at which 1 - beta adapts. */
static const double FIRST_BETA = 0.9;
static const double REST_GROWTH = 1.7, REST_DECAY = 0.7, MOST_REST = 0.5, LEAST_REST = 0.02;

/* A probe is a run of sweeps without momentum. It starts after so many sweeps without a gain, or
 * when the residual is so many times the best. */
enum { PROBE_SWEEPS = 20, PATIENCE_SWEEPS = 100 };
static const double GAIN = 0.9, DIVERGED = 30;

/* A probe shows that momentum was to blame if the residual falls below the first part of what it
 * was, and not to blame if it stays above the second. */
static const double TO_BLAME = 0.5, NOT_TO_BLAME = 0.8;

pe_momentum pe_momentum_begin(double residual)
{
    return (pe_momentum){.beta = FIRST_BETA, .best = residual};
}

double pe_momentum_next(pe_momentum *m)
{
    double nesterov = (double)m->sweeps / (m->sweeps + 3);
    m->sweeps += 1;
    return m->probe_left > 0 ? 0 : nesterov < m->beta ? nesterov : m->beta;
}

static void end_probe(pe_momentum *m, double residual)
{
    if (residual < TO_BLAME * m->before_probe) {
        double rest = REST_GROWTH * (1 - m->beta);
        m->beta = 1 - (rest < MOST_REST ? rest : MOST_REST);
    } else if (residual > NOT_TO_BLAME * m->before_probe) {
        double rest = REST_DECAY * (1 - m->beta);
        m->beta = 1 - (rest > LEAST_REST ? rest : LEAST_REST);
    }
    m->best = residual;
    m->since_gain = 0;
}

void pe_momentum_look(pe_momentum *m, int sweeps, double residual)
{
    if (m->probe_left > 0) {
        m->probe_left -= sweeps;
        if (m->probe_left <= 0) {
            m->probe_left = 0;
            end_probe(m, residual);
        }
    } else if (residual < GAIN * m->best) {
        m->best = residual;
        m->since_gain = 0;
    } else {
        m->since_gain += sweeps;
        if (m->since_gain >= PATIENCE_SWEEPS || residual > DIVERGED * m->best) {
            m->probe_left = PROBE_SWEEPS;
            m->before_probe = residual;
        }
    }
}

/* ---- The solvers ---- */

/* Sweeps between two evaluations of the residual, which costs half a sweep. The first ones come
 * sooner, so that problems which a few sweeps solve stop early. */
enum { LOOK_INTERVAL = 10 };

static bool is_look(int sweeps)
{
    return sweeps % LOOK_INTERVAL == 0 || sweeps == 1 || sweeps == LOOK_INTERVAL / 2;
}

/* Problems that are swept together: parts of a joint one. */
typedef struct sweeping {
    pe_sweep sweep;
    int count;
    pe_sweep_part *parts; /* (count) */
    double *residuals;    /* (count): at the last look, m/s */
    double *best;         /* (count): the least so far; what had it is stored */
    pe_momentum *momenta; /* (count) */
    bool *done;           /* (count) */
} sweeping;

static pe_status take_memory(const pe_problem *const *problems, int count, pe_workspace work,
                             sweeping *s, pe_error *error)
{
    const size_t parts = (size_t)count;
    int points = 0;
    for (int k = 0; k < count; ++k) {
        points += problems[k]->point_count;
    }
    *s = (sweeping){
        .count = count,
        .parts = pe_take(work, parts, sizeof *s->parts),
        .residuals = pe_take(work, parts, sizeof *s->residuals),
        .best = pe_take(work, parts, sizeof *s->best),
        .momenta = pe_take(work, parts, sizeof *s->momenta),
        .done = pe_take(work, parts, sizeof *s->done),
    };
    return s->parts != NULL && s->residuals != NULL && s->best != NULL && s->momenta != NULL &&
                   s->done != NULL
               ? PE_OK
               : pe_fail(error, PE_NO_MEMORY, "no memory to sweep %d contact points", points);
}

/* Looks at the start. Returns whether any problem goes on. */
static bool begin(sweeping *s, double tolerance, pe_solve_report *reports)
{
    bool goes_on = false;
    pe_sweep_residuals(&s->sweep, s->parts, s->count, s->residuals);
    for (int k = 0; k < s->count; ++k) {
        s->best[k] = s->residuals[k];
        s->momenta[k] = pe_momentum_begin(s->best[k]);
        s->done[k] = !(s->best[k] > tolerance);
        reports[k].iterations = 0;
        reports[k].factor_flops = 0;
        goes_on |= !s->done[k];
    }
    return goes_on;
}

/* Looks after so many sweeps, of which `more` since the last look, and keeps what is better. Returns
 * whether any problem goes on. */
static bool look(sweeping *s, double tolerance, int sweeps, int more, pe_solve_report *reports)
{
    bool goes_on = false;
    pe_sweep_residuals(&s->sweep, s->parts, s->count, s->residuals);
    for (int k = 0; k < s->count; ++k) {
        if (s->done[k]) {
            continue;
        }
        reports[k].iterations = sweeps;
        pe_solve_note(&reports[k], sweeps, s->residuals[k]);
        pe_momentum_look(&s->momenta[k], more, s->residuals[k]);
        if (s->residuals[k] < s->best[k]) {
            s->best[k] = s->residuals[k];
            pe_sweep_store(&s->sweep, &s->parts[k]);
        }
        s->done[k] = !(s->best[k] > tolerance);
        goes_on |= !s->done[k];
    }
    return goes_on;
}

/* The best iterates that were evaluated are left, the start included. */
pe_status pe_solve_together(const pe_problem *const *problems, int count,
                            const pe_solve_limits *limits, bool with_momentum, pe_workspace work,
                            pe_solve_report *reports, pe_error *error)
{
    sweeping s;
    pe_problem joint;
    pe_status status = take_memory(problems, count, work, &s, error);
    if (status != PE_OK ||
        (status = pe_sweep_join(problems, count, work, &joint, s.parts, error)) != PE_OK ||
        (status = pe_sweep_create(&joint, pe_kernels_for(0)->sweep, work, &s.sweep, error)) !=
            PE_OK) {
        return status;
    }
    bool goes_on = begin(&s, limits->tolerance, reports);
    for (int sweeps = 1, seen = 0; goes_on && sweeps <= limits->max_iterations; ++sweeps) {
        for (int k = 0; k < count && with_momentum; ++k) {
            pe_sweep_set_beta(&s.sweep, &s.parts[k], pe_momentum_next(&s.momenta[k]));
        }
        pe_sweep_cones(&s.sweep);
        if (is_look(sweeps) || sweeps == limits->max_iterations) {
            goes_on = look(&s, limits->tolerance, sweeps, sweeps - seen, reports);
            seen = sweeps;
        }
    }
    pe_sweep_part_from(&joint, problems, count);
    for (int k = 0; k < count; ++k) {
        /* The sweeps add up rounding errors in the velocities. The impulses give them afresh. */
        pe_problem_rebuild_velocity(problems[k]);
        reports[k].residual = pe_problem_residual(problems[k]);
        reports[k].stop =
            reports[k].residual.max <= limits->tolerance ? PE_STOP_CONVERGED : PE_STOP_ITERATIONS;
    }
    return PE_OK;
}

pe_status pe_solve_gauss_seidel(const pe_problem *problem, const pe_solve_limits *limits,
                                pe_workspace work, pe_solve_report *report, pe_error *error)
{
    return pe_solve_together(&problem, 1, limits, false, work, report, error);
}

pe_status pe_solve_momentum(const pe_problem *problem, const pe_solve_limits *limits,
                            pe_workspace work, pe_solve_report *report, pe_error *error)
{
    return pe_solve_together(&problem, 1, limits, true, work, report, error);
}
