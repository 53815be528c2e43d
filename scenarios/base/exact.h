/* Arithmetic without rounding, for signs that decide: sums of products of three numbers, and on
 * which side of a plane or of a line a point lies. Numbers are finite, products at most 1e255,
 * coordinates at most 1e80. The answers are the same for every compiler and order of the terms. */
#ifndef PLUMB_EXACT_H
#define PLUMB_EXACT_H

#include <stdint.h>

/* Bits from 2^-3222, the product of the three smallest doubles, up to 2^873. */
enum { PL_EXACT_WORDS = 64 };

/* A sum of products, as two sums of positive numbers. Starts as {0}. */
typedef struct pl_exact_sum {
    uint64_t positive[PL_EXACT_WORDS]; /* lowest word first */
    uint64_t negative[PL_EXACT_WORDS];
} pl_exact_sum;

/* Adds a b c. */
void pl_exact_add(pl_exact_sum *sum, double a, double b, double c);

/* Adds the determinant of the matrix with these rows, times `sign`, which is 1 or -1. */
void pl_exact_add_determinant(pl_exact_sum *sum, double sign, const double a[3], const double b[3],
                              const double c[3]);

/* -1, 0 or 1. */
int pl_exact_sign(const pl_exact_sum *sum);

/* The double nearest to the sum. */
double pl_exact_value(const pl_exact_sum *sum);

/* The side of the plane through a, b and c on which d lies: 1 where a, b, c are counter-clockwise
 * seen from d, -1 on the other side, 0 in the plane or where a, b and c are on one line. */
int pl_side_of_plane(const double a[3], const double b[3], const double c[3], const double d[3]);

/* Seen against the axis 0, 1 or 2: 1 where a, b, c are counter-clockwise, -1 where they are
 * clockwise, 0 on one line. */
int pl_turn_about(int axis, const double a[3], const double b[3], const double c[3]);

#endif
