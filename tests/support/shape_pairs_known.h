/* How often the laws of contact are known to fail: known faults of the colliders, so that a new one
 * is noticed. */
#ifndef PLUMB_TEST_SHAPE_PAIRS_KNOWN_H
#define PLUMB_TEST_SHAPE_PAIRS_KNOWN_H

#include "plumb/engine.h"

/* The number of failures in the slow test. The poses of the quick test are the first of the slow
 * one. */
int known_failures(const char *law, pe_shape_kind a, pe_shape_kind b);

#endif
