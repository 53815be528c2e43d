/* Small random worlds, and the laws of a step that hold in any of them.
 *
 * A world has 1 to 10 bodies of all shapes, among them static ones and planes, which may oppose each
 * other. Bodies may overlap, and their masses differ by up to 1e4. */
#ifndef PLUMB_TEST_RANDOM_WORLDS_H
#define PLUMB_TEST_RANDOM_WORLDS_H

#include "plumb/engine.h"

#include <stdint.h>

/* What was found; lengths in units of the least extent of the body. */
typedef struct random_worlds_found {
    double moved;   /* farthest in a step beyond what speed and gravity explain */
    double rotated; /* the same of a point at the bounding radius, by rotation */
    double
        gained; /* most kinetic energy beyond the law, in units of that before and gravity's work */
    int runs;   /* worlds x profiles */
    int too_far;    /* runs in which a body moved or rotated by more than the law allows */
    int not_finite; /* runs in which a number became infinite or NaN */
    int too_fast;   /* runs that gained energy */
    int failed;     /* runs of which a step failed */
    int unparted;   /* runs with bodies that the engine counted as impossible to part */
} random_worlds_found;

/* Makes the worlds of these seeds, on every profile, and takes some steps. Where a law does not hold,
 * prints the seed, the profile, what was found, and the world as it was before that step. The law of
 * each body's motion is that of step_laws.h. All numbers are finite. The kinetic energy of all bodies
 * grows by no more than gravity gives to those that fall, and 2 % of both. */
random_worlds_found random_worlds_run(uint64_t first, int count);

#endif
