/* The paths of all dynamic bodies of a run in memory, read from its positions file
 * (runner/positions.h). All runs of a scene start alike, so that the distance of two bodies is that
 * of their displacements. */
#ifndef PLUMB_BODY_PATHS_H
#define PLUMB_BODY_PATHS_H

#include "plumb/scene.h"

/* The paths of one run. Starts as {0}, which is a run without a path. */
typedef struct pl_body_paths {
    int bodies;     /* dynamic ones, in scene order */
    long samples;   /* the first is the start; 0: there is no path */
    double *moved;  /* (samples x bodies x 3): displacement of the centre of mass, m, world */
    bool completed; /* the last sample is the last that a whole run has */
} pl_body_paths;

/* Reads the positions of the run with the hash `run` in `folder`: a run of `scene`, with a sample
 * every `stride` steps (> 0). No file, or one that does not fit, gives no path. Samples from the
 * first number that is not finite on are left out. The caller frees the paths. */
pl_body_paths pl_body_paths_read(const char *folder, const char *run, const pl_scene *scene,
                                 long stride);

/* Frees the paths and makes them {0}. */
void pl_body_paths_free(pl_body_paths *paths);

/* How far apart a body is in two runs at a sample that both have, m. */
double pl_body_paths_distance(const pl_body_paths *a, const pl_body_paths *b, int body,
                              long sample);

/* ---- The error that halvings of the step leave ---- */

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
