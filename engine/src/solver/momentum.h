/* How much momentum the next sweep gets. A sweep begins at y = z + beta (z - z_before), with z what
 * the last one left (heavy ball; Polyak 1964). What beta is good is not known beforehand, and
 * contact problems have no objective to descend on, so that beta follows the residual e, looked at
 * every few sweeps:
 *
 *   no gain of a tenth in 100 sweeps, or e > 30 times the best: 20 sweeps with beta = 0. If e then
 *   fell to less than half, it was momentum that kept it up: 1 - beta grows by 1.7, to 0.5 at most.
 *   If it fell by less than a fifth, momentum is not to blame: 1 - beta shrinks by 0.7, to 0.02.
 *
 * Measured on piles, towers and walls against Gauss-Seidel, Nesterov's sequence with restarts,
 * nonsmooth nonlinear conjugate gradients (Silcowitz, Niebe, Erleben 2010) and fixed betas. */
#ifndef PE_MOMENTUM_H
#define PE_MOMENTUM_H

#include <stdbool.h>

typedef struct pe_momentum {
    double beta;
    int sweeps; /* made so far */
    double best, before_probe;
    int since_gain; /* sweeps */
    int probe_left; /* sweeps without momentum still to make; 0: no probe is on */
} pe_momentum;

static inline pe_momentum pe_momentum_begin(double residual)
{
    return (pe_momentum){.beta = 0.9, .best = residual};
}

/* The beta of the next sweep. It grows from 0 as Nesterov's sequence does. */
static inline double pe_momentum_next(pe_momentum *m)
{
    double first = (double)m->sweeps / (m->sweeps + 3);
    m->sweeps += 1;
    return m->probe_left > 0 ? 0 : first < m->beta ? first : m->beta;
}

static inline void pe_momentum_end_probe(pe_momentum *m, double residual)
{
    if (residual < 0.5 * m->before_probe) {
        double rest = 1.7 * (1 - m->beta);
        m->beta = 1 - (rest < 0.5 ? rest : 0.5);
    } else if (residual > 0.8 * m->before_probe) {
        double rest = 0.7 * (1 - m->beta);
        m->beta = 1 - (rest > 0.02 ? rest : 0.02);
    }
    m->best = residual;
    m->since_gain = 0;
}

/* To be told the residual after every `sweeps` more. */
static inline void pe_momentum_look(pe_momentum *m, int sweeps, double residual)
{
    if (m->probe_left > 0) {
        m->probe_left -= sweeps;
        if (m->probe_left <= 0) {
            m->probe_left = 0;
            pe_momentum_end_probe(m, residual);
        }
    } else if (residual < 0.9 * m->best) {
        m->best = residual;
        m->since_gain = 0;
    } else {
        m->since_gain += sweeps;
        if (m->since_gain >= 100 || residual > 30 * m->best) {
            m->probe_left = 20;
            m->before_probe = residual;
        }
    }
}

#endif
