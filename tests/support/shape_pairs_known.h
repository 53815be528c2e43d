/* How often the laws of contact are known to fail: faults of the colliders that are not mended yet,
 * so that no new one hides among them. */
#ifndef PLUMB_TEST_SHAPE_PAIRS_KNOWN_H
#define PLUMB_TEST_SHAPE_PAIRS_KNOWN_H

#include "plumb/engine.h"

/* Of the poses of the slow test, which those of the quick one begin. */
int known_failures(const char *law, pe_shape_kind a, pe_shape_kind b);

#endif
