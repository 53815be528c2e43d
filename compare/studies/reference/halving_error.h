/* The error of a computation at the finest of several steps, each half of the one before, estimated
 * from how much the halvings changed it.
 *
 * Notation: x_k is the position of a body at the step dt / 2^k, D_k = |x_k - x_(k-1)| the change by
 * the k-th halving, r = D_K / D_(K-1) the rate. Where the error falls by the rate r with each further
 * halving, that of x_K is D_K (r + r^2 + ...) = D_K r / (1 - r): Richardson's deferred approach to
 * the limit (1911), with the order of convergence p = -log2(r) observed rather than presumed (Roache
 * 1998, section 5.7). For p = 1 it is D_K, for p = 2 a third of D_K.
 *
 * Each change is the largest within pl_halving_window of the time in question: the changes of two
 * paths that cross vanish for a moment, and the time of an impact moves from one sample to the
 * next. No halving is trusted to gain more than order 2: the rate is held within [1/4, 1/sqrt(2)],
 * orders 2 to 1/2, and D_K counts as at least D_(K-1) / 4, since one lucky change would otherwise
 * claim any accuracy. Where the changes do not shrink at all, there is no limit that the
 * estimate could hold for, and it only says how much still changes. */
#ifndef PLUMB_HALVING_ERROR_H
#define PLUMB_HALVING_ERROR_H

#include "body_paths.h"

/* s: half the width of the window. */
extern const double pl_halving_window;

/* Estimates the error of the paths `levels[count - 1]`, m, into error (samples x bodies, allocated
 * by the caller), for the samples that all levels have. count >= 2; with 2 the order is taken as
 * 1. `interval` is the time from one sample to the next, s. Allocates and frees a work array:
 * O(samples x bodies x window). */
void pl_halving_error(const pl_body_paths *levels, int count, double interval, double *error);

/* The number of samples that all levels have. */
long pl_halving_samples(const pl_body_paths *levels, int count);

#endif
