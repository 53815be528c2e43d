/* Vectors and solver bodies, one a lane: what the kernels of soft contact and of Gauss-Seidel
 * share.
 *
 * Names in both: vA, wA the linear and angular velocity of body A, mA its inverse mass, iA its
 * inverse inertia, rA the arm from its centre of mass to the contact; vB and so on for body B. */
#ifndef PE_BODY_LANES_H
#define PE_BODY_LANES_H

#include "base/lanes.h"
#include "solver_body.h"

/* Each kernel is compiled to one function: calls would pass the lanes through memory. */
#if defined(__GNUC__)
#define PE_INLINE static inline __attribute__((always_inline))
#else
#define PE_INLINE static inline
#endif

/* a.b */
PE_INLINE wide wide_dot(const wide a[3], const wide b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* c = a x b */
PE_INLINE void wide_cross(const wide a[3], const wide b[3], wide c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* x += s a */
PE_INLINE void wide_add(wide x[3], wide s, const wide a[3])
{
    for (int k = 0; k < 3; ++k) {
        x[k] += s * a[k];
    }
}

/* 1/a, and 0 where a is not above 0, as in lanes without a manifold. */
PE_INLINE wide wide_inverse(wide a)
{
    return wide_select(a, wide_of(0), wide_of(1) / a, wide_of(0));
}

/* The two bodies of a contact, in each lane. */
typedef struct wide_pair {
    wide vA[3], wA[3], mA;
    wide vB[3], wB[3], mB;
} wide_pair;

/* One body per lane: bodies[index[lane]]. */
PE_INLINE void wide_load_body(const pe_solver_body *bodies, const int index[PE_WIDTH], wide v[3],
                              wide w[3], wide *m)
{
    const double *from[PE_WIDTH];
    wide column[8];
    for (int l = 0; l < PE_WIDTH; ++l) {
        from[l] = bodies[index[l]].linear;
    }
    wide_columns(from, column);
    for (int k = 0; k < 3; ++k) {
        v[k] = column[k];
        w[k] = column[4 + k];
    }
    *m = column[3];
}

/* The inverse of wide_load_body, except that body `fixed`, which several lanes and threads may share,
 * is not written. No other body is in two lanes. */
PE_INLINE void wide_store_body(pe_solver_body *bodies, const int index[PE_WIDTH], int fixed,
                               const wide v[3], const wide w[3], wide m)
{
    _Alignas(64) pe_solver_body nowhere;
    pe_solver_body *to[PE_WIDTH];
    for (int l = 0; l < PE_WIDTH; ++l) {
        to[l] = index[l] != fixed ? &bodies[index[l]] : &nowhere;
    }
#if PE_WIDTH == 1
    (void)m;
    for (int k = 0; k < 3; ++k) {
        to[0]->linear[k] = v[k];
        to[0]->angular[k] = w[k];
    }
#elif PE_WIDTH == 4
    wide linear[4] = {v[0], v[1], v[2], m}, angular[4] = {w[0], w[1], w[2], wide_of(0)};
    transpose4(linear);
    transpose4(angular);
    for (int i = 0; i < 4; ++i) {
        _mm256_store_pd(to[i]->linear, linear[i]);
        _mm256_store_pd(to[i]->angular, angular[i]);
    }
#else
    wide row[8] = {v[0], v[1], v[2], m, w[0], w[1], w[2], wide_of(0)};
    transpose8(row);
    for (int i = 0; i < 8; ++i) {
        _mm512_store_pd(to[i]->linear, row[i]);
    }
#endif
}

/* The bodies a and b of each lane. */
PE_INLINE void wide_load_pair(const pe_solver_body *bodies, const int a[PE_WIDTH],
                              const int b[PE_WIDTH], wide_pair *p)
{
    wide_load_body(bodies, a, p->vA, p->wA, &p->mA);
    wide_load_body(bodies, b, p->vB, p->wB, &p->mB);
}

/* Stores the velocities of the pair, except those of body `fixed`. */
PE_INLINE void wide_store_pair(pe_solver_body *bodies, const int a[PE_WIDTH], const int b[PE_WIDTH],
                               int fixed, const wide_pair *p)
{
    wide_store_body(bodies, a, fixed, p->vA, p->wA, p->mA);
    wide_store_body(bodies, b, fixed, p->vB, p->wB, p->mB);
}

#endif
