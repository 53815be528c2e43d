/* Random numbers and orientations of scenes; they need no function but the square root. */
#ifndef PLUMB_DRAW_H
#define PLUMB_DRAW_H

#include "base/random.h"

/* Uniform in low .. high. */
double pl_draw_uniform(pl_random *random, double low, double high);

/* A unit quaternion, uniform over all orientations: a point of the unit ball of four dimensions,
 * normalised. */
void pl_draw_orientation(pl_random *random, double q[4]);

#endif
