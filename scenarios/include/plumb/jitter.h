/* The members of an ensemble: one scene, each time displaced by very little. */
#ifndef PLUMB_JITTER_H
#define PLUMB_JITTER_H

#include "plumb/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The largest displacement of a body relative to its size, and its largest rotation, rad. */
static const double pl_jitter_amplitude = 1e-4;

/* Displaces every dynamic body by up to 1e-4 of its size (its smallest dimension) along each axis
 * of the world, and turns it about its centre of mass, about any axis, by up to 1e-4 rad. The same
 * seed and member (from 0) give the same scene, bit for bit, on every machine. The expectations of
 * the scene do not change.
 *
 * No point of a body moves by more than 1e-4 (sqrt(3) size + radius), the radius that of its
 * bounding sphere; so bodies that touched may overlap by twice that. */
void pl_scene_jitter(pl_scene *scene, uint64_t seed, int member);

/* The size of the smallest dynamic body, m; INFINITY where no body is dynamic. */
double pl_scene_least_size(const pl_scene *scene);

#ifdef __cplusplus
}
#endif
#endif
