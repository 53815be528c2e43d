/* The scene's forces as an adapter hands them to its engine at the start of a step. */
#ifndef PLUMB_FORCE_H
#define PLUMB_FORCE_H

#include "plumb/scene.h"

/* Whether `force` acts over the step of length dt that starts at `time`. Times of start and end are
 * met to a millionth of a step, so that the rounding of a summed time never adds or drops a step.
 */
bool pl_force_acts(const pl_force *force, double time, double dt);

/* The same; if so, its world components (N) and its point of attack as a world offset from the
 * centre of mass (m). `orientation` is the body's (w, x, y, z) at that time. */
bool pl_force_at(const pl_force *force, double time, double dt, const double orientation[4],
                 double world_force[3], double world_offset[3]);

#endif
