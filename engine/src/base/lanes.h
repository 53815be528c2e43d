/* Arithmetic on PE_WIDTH numbers at once: 1, 4 (AVX2) or 8 (AVX-512), set by the file that includes
 * this. Every operation is IEEE's own, lane by lane, so that a lane's value does not depend on the
 * width. Sums, differences, products and quotients are the operators of C. */
#ifndef PE_LANES_H
#define PE_LANES_H

#include <math.h>

#if PE_WIDTH > 1
#include <immintrin.h>
#endif

#if PE_WIDTH == 1
/* PE_WIDTH numbers, one per lane. */
typedef double wide;
#elif PE_WIDTH == 4
/* PE_WIDTH numbers, one per lane. */
typedef __m256d wide;
#else
/* PE_WIDTH numbers, one per lane. */
typedef __m512d wide;
#endif

/* x in every lane. */
static inline wide wide_of(double x)
{
#if PE_WIDTH == 1
    return x;
#elif PE_WIDTH == 4
    return _mm256_set1_pd(x);
#else
    return _mm512_set1_pd(x);
#endif
}

/* a > b ? a : b */
static inline wide wide_max(wide a, wide b)
{
#if PE_WIDTH == 1
    return a > b ? a : b;
#elif PE_WIDTH == 4
    return _mm256_max_pd(a, b);
#else
    return _mm512_max_pd(a, b);
#endif
}

/* a > b ? x : y */
static inline wide wide_select(wide a, wide b, wide x, wide y)
{
#if PE_WIDTH == 1
    return a > b ? x : y;
#elif PE_WIDTH == 4
    return _mm256_blendv_pd(y, x, _mm256_cmp_pd(a, b, _CMP_GT_OQ));
#else
    return _mm512_mask_blend_pd(_mm512_cmp_pd_mask(a, b, _CMP_GT_OQ), y, x);
#endif
}

/* Square root, lane by lane. */
static inline wide wide_sqrt(wide a)
{
#if PE_WIDTH == 1
    return sqrt(a);
#elif PE_WIDTH == 4
    return _mm256_sqrt_pd(a);
#else
    return _mm512_sqrt_pd(a);
#endif
}

/* from[lane][k] for every lane. */
static inline wide wide_gather(const double *const from[PE_WIDTH], int k)
{
#if PE_WIDTH == 1
    return from[0][k];
#elif PE_WIDTH == 4
    return _mm256_setr_pd(from[0][k], from[1][k], from[2][k], from[3][k]);
#else
    return _mm512_setr_pd(from[0][k], from[1][k], from[2][k], from[3][k], from[4][k], from[5][k],
                          from[6][k], from[7][k]);
#endif
}

/* to[lane] = a. */
static inline void wide_store(double to[PE_WIDTH], wide a)
{
#if PE_WIDTH == 1
    to[0] = a;
#elif PE_WIDTH == 4
    _mm256_storeu_pd(to, a);
#else
    _mm512_storeu_pd(to, a);
#endif
}

/* Prefetches a cache line; no effect on results. */
static inline void wide_fetch(const void *memory)
{
#if PE_WIDTH > 1
    _mm_prefetch((const char *)memory, _MM_HINT_T0);
#else
    (void)memory;
#endif
}

#if PE_WIDTH == 4
/* Transposes a 4 x 4 matrix. */
static inline void transpose4(wide r[4])
{
    wide even01 = _mm256_unpacklo_pd(r[0], r[1]), odd01 = _mm256_unpackhi_pd(r[0], r[1]);
    wide even23 = _mm256_unpacklo_pd(r[2], r[3]), odd23 = _mm256_unpackhi_pd(r[2], r[3]);
    r[0] = _mm256_permute2f128_pd(even01, even23, 0x20);
    r[1] = _mm256_permute2f128_pd(odd01, odd23, 0x20);
    r[2] = _mm256_permute2f128_pd(even01, even23, 0x31);
    r[3] = _mm256_permute2f128_pd(odd01, odd23, 0x31);
}
#elif PE_WIDTH == 8
/* Columns q, q + 2, q + 4 and q + 6 from four pairs of interleaved rows. */
static inline void transpose_quarters(const wide pair[4], wide column[8], int q)
{
    wide low01 = _mm512_shuffle_f64x2(pair[0], pair[1], 0x44);
    wide high01 = _mm512_shuffle_f64x2(pair[0], pair[1], 0xee);
    wide low23 = _mm512_shuffle_f64x2(pair[2], pair[3], 0x44);
    wide high23 = _mm512_shuffle_f64x2(pair[2], pair[3], 0xee);
    column[q] = _mm512_shuffle_f64x2(low01, low23, 0x88);
    column[q + 2] = _mm512_shuffle_f64x2(low01, low23, 0xdd);
    column[q + 4] = _mm512_shuffle_f64x2(high01, high23, 0x88);
    column[q + 6] = _mm512_shuffle_f64x2(high01, high23, 0xdd);
}

/* Transposes an 8 x 8 matrix. */
static inline void transpose8(wide r[8])
{
    wide even[4], odd[4];
    for (int i = 0; i < 4; ++i) {
        even[i] = _mm512_unpacklo_pd(r[2 * i], r[2 * i + 1]);
        odd[i] = _mm512_unpackhi_pd(r[2 * i], r[2 * i + 1]);
    }
    transpose_quarters(even, r, 0);
    transpose_quarters(odd, r, 1);
}
#endif

/* Column k of eight numbers a lane: from[lane][k]. The lanes' numbers are aligned to 64 bytes. */
static inline void wide_columns(const double *const from[PE_WIDTH], wide column[8])
{
#if PE_WIDTH == 1
    for (int k = 0; k < 8; ++k) {
        column[k] = from[0][k];
    }
#elif PE_WIDTH == 4
    for (int i = 0; i < 4; ++i) {
        column[i] = _mm256_load_pd(from[i]);
        column[4 + i] = _mm256_load_pd(from[i] + 4);
    }
    transpose4(column);
    transpose4(column + 4);
#else
    for (int i = 0; i < 8; ++i) {
        column[i] = _mm512_load_pd(from[i]);
    }
    transpose8(column);
#endif
}

#endif
