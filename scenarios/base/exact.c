/* A sum is an integer in units of 2^-3222, of so many words that nothing is rounded or lost (a long
 * accumulator: Kulisch, Computer Arithmetic and Validity, 2008). Signs of determinants are first
 * computed in doubles, with the bounds of the error of Shewchuk, Adaptive Precision Floating-Point
 * Arithmetic and Fast Robust Geometric Predicates, 1997; only a sign that the bound leaves open
 * needs the sum. The bounds hold with contracted multiply-adds too. */
#include "exact.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

__extension__ typedef unsigned __int128 wide;

/* Half of DBL_EPSILON, in which Shewchuk's bounds are. */
#define UNIT (DBL_EPSILON / 2)
/* Where products may have lost digits below the smallest double, no bound holds. */
#define LEAST_BOUNDED 1e-230

/* |x| = mantissa 2^(place - 1074); place is at least 0. */
static uint64_t mantissa_of(double x, int *place)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    const int exponent = (int)(bits >> 52 & 0x7ff);
    const uint64_t fraction = bits & ((UINT64_C(1) << 52) - 1);
    *place = exponent > 0 ? exponent - 1 : 0;
    return exponent > 0 ? fraction | UINT64_C(1) << 52 : fraction;
}

void pl_exact_add(pl_exact_sum *sum, double a, double b, double c)
{
    int place[3];
    const wide ab = (wide)mantissa_of(a, &place[0]) * mantissa_of(b, &place[1]);
    const uint64_t third = mantissa_of(c, &place[2]);
    const wide low = (wide)(uint64_t)ab * third, high = (wide)(uint64_t)(ab >> 64) * third;
    const wide upper = high + (low >> 64);
    const uint64_t product[3] = {(uint64_t)low, (uint64_t)upper, (uint64_t)(upper >> 64)};
    const bool is_negative = (signbit(a) != 0) ^ (signbit(b) != 0) ^ (signbit(c) != 0);
    uint64_t *words = is_negative ? sum->negative : sum->positive;
    const int at = place[0] + place[1] + place[2], shift = at % 64;
    uint64_t carry = 0, shifted_out = 0;
    for (int k = 0, i = at / 64; i < PL_EXACT_WORDS && (k < 4 || carry > 0); ++k, ++i) {
        const uint64_t word = k < 3 ? product[k] : 0;
        const wide next = (wide)words[i] + (word << shift | shifted_out) + carry;
        words[i] = (uint64_t)next;
        carry = (uint64_t)(next >> 64);
        shifted_out = shift > 0 ? word >> (64 - shift) : 0;
    }
}

void pl_exact_add_determinant(pl_exact_sum *sum, double sign, const double a[3], const double b[3],
                              const double c[3])
{
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        pl_exact_add(sum, sign * a[i], b[j], c[k]);
        pl_exact_add(sum, -sign * a[i], b[k], c[j]);
    }
}

int pl_exact_sign(const pl_exact_sum *sum)
{
    int i = PL_EXACT_WORDS - 1;
    while (i > 0 && sum->positive[i] == sum->negative[i]) {
        --i;
    }
    return (sum->positive[i] > sum->negative[i]) - (sum->positive[i] < sum->negative[i]);
}

double pl_exact_value(const pl_exact_sum *sum)
{
    const int sign = pl_exact_sign(sum);
    const uint64_t *larger = sign < 0 ? sum->negative : sum->positive;
    const uint64_t *smaller = sign < 0 ? sum->positive : sum->negative;
    uint64_t rest[PL_EXACT_WORDS], borrow = 0;
    int top = 0;
    for (int i = 0; i < PL_EXACT_WORDS; ++i) {
        const wide taken = (wide)smaller[i] + borrow;
        borrow = larger[i] < taken;
        rest[i] = larger[i] - (uint64_t)taken;
        top = rest[i] != 0 ? i : top;
    }
    if (sign == 0) {
        return 0;
    }
    /* The 64 bits from the highest on; the lowest of them stands for all that follow. */
    int shift = 0;
    while ((rest[top] << shift) >> 63 == 0) {
        ++shift;
    }
    uint64_t bits = rest[top] << shift;
    uint64_t below = 0;
    if (top > 0) {
        bits |= shift > 0 ? rest[top - 1] >> (64 - shift) : 0;
        below = rest[top - 1] << shift;
    }
    for (int i = 0; i < top - 1; ++i) {
        below |= rest[i];
    }
    return sign * ldexp((double)(bits | (below != 0 ? 1 : 0)), 64 * top - shift - 3222);
}

int pl_side_of_plane(const double a[3], const double b[3], const double c[3], const double d[3])
{
    double u[3], v[3], w[3], value = 0, size = 0;
    for (int k = 0; k < 3; ++k) {
        u[k] = a[k] - d[k];
        v[k] = b[k] - d[k];
        w[k] = c[k] - d[k];
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double left = v[j] * w[k], right = v[k] * w[j];
        value -= u[i] * (left - right);
        size += fabs(u[i]) * (fabs(left) + fabs(right));
    }
    if (size > LEAST_BOUNDED && fabs(value) > (8 + 64 * UNIT) * UNIT * size) {
        return value > 0 ? 1 : -1;
    }
    pl_exact_sum sum = {{0}, {0}};
    pl_exact_add_determinant(&sum, 1, b, c, d);
    pl_exact_add_determinant(&sum, -1, a, c, d);
    pl_exact_add_determinant(&sum, 1, a, b, d);
    pl_exact_add_determinant(&sum, -1, a, b, c);
    return pl_exact_sign(&sum);
}

int pl_turn_about(int axis, const double a[3], const double b[3], const double c[3])
{
    const int x = (axis + 1) % 3, y = (axis + 2) % 3;
    const double left = (a[x] - c[x]) * (b[y] - c[y]), right = (a[y] - c[y]) * (b[x] - c[x]);
    const double value = left - right, size = fabs(left) + fabs(right);
    if (size > LEAST_BOUNDED && fabs(value) > 4 * UNIT * size) {
        return value > 0 ? 1 : -1;
    }
    pl_exact_sum sum = {{0}, {0}};
    const double *const points[3] = {a, b, c};
    for (int i = 0; i < 3; ++i) {
        const double *from = points[i], *to = points[(i + 1) % 3];
        pl_exact_add(&sum, from[x], to[y], 1);
        pl_exact_add(&sum, -from[y], to[x], 1);
    }
    return pl_exact_sign(&sum);
}
