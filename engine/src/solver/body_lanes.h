/* Vectors and solver bodies, one a lane: what the kernels of soft contact and of Gauss-Seidel
 * share. */
#ifndef PE_BODY_LANES_H
#define PE_BODY_LANES_H

#include "base/lanes.h"
#include "solver_body.h"

/* Kernels are one function each: otherwise lanes would travel through memory. */
#if defined(__GNUC__)
#define PE_INLINE static inline __attribute__((always_inline))
#else
#define PE_INLINE static inline
#endif

/* ---- Vectors ---- */

PE_INLINE wide wide_dot(const wide a[3], const wide b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

PE_INLINE void wide_cross(const wide a[3], const wide b[3], wide c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* 1/a, and 0 where a is not above 0, as in lanes without a manifold. */
PE_INLINE wide wide_inverse(wide a)
{
    return wide_select(a, wide_of(0), wide_of(1) / a, wide_of(0));
}

/* ---- Solver bodies ---- */

/* One solver body a lane. */
typedef struct wide_body {
    wide linear[3], inverse_mass, angular[3];
} wide_body;

static inline wide_body wide_load(const pe_solver_body *bodies, const int index[PE_WIDTH])
{
    const double *from[PE_WIDTH];
    wide c[8];
    for (int l = 0; l < PE_WIDTH; ++l) {
        from[l] = bodies[index[l]].linear;
    }
    wide_columns(from, c);
    return (wide_body){{c[0], c[1], c[2]}, c[3], {c[4], c[5], c[6]}};
}

static inline void wide_save(pe_solver_body *bodies, const int index[PE_WIDTH], const wide_body *x)
{
#if PE_WIDTH == 1
    for (int k = 0; k < 3; ++k) {
        bodies[index[0]].linear[k] = x->linear[k];
        bodies[index[0]].angular[k] = x->angular[k];
    }
#elif PE_WIDTH == 4
    wide r[4] = {x->linear[0], x->linear[1], x->linear[2], x->inverse_mass};
    wide s[4] = {x->angular[0], x->angular[1], x->angular[2], _mm256_setzero_pd()};
    transpose4(r);
    transpose4(s);
    for (int i = 0; i < 4; ++i) {
        _mm256_store_pd(bodies[index[i]].linear, r[i]);
        _mm256_store_pd(bodies[index[i]].angular, s[i]);
    }
#else
    wide r[8] = {x->linear[0],  x->linear[1],  x->linear[2],  x->inverse_mass,
                 x->angular[0], x->angular[1], x->angular[2], _mm512_setzero_pd()};
    transpose8(r);
    for (int i = 0; i < 8; ++i) {
        _mm512_store_pd(bodies[index[i]].linear, r[i]);
    }
#endif
}

#endif
