/* Convex shapes as libccd takes them. */
#ifndef PLUMB_TEST_CCD_SOLID_H
#define PLUMB_TEST_CCD_SOLID_H

#include "shape_pairs.h"

#include <ccd/ccd.h>

/* A box, cylinder, hull, sphere or capsule. Positions are relative to the origin, so that digits are not
 * lost far out, and in units of the pair's size: libccd compares squares of lengths with absolute numbers,
 * and misses overlaps of small shapes whose centres nearly coincide. */
typedef struct ccd_solid {
    const placed *p;
    pe_vec3 origin;
    double unit; /* m */
} ccd_solid;

/* The support function, of a ccd_solid. */
void ccd_support(const void *object, const ccd_vec3_t *dir, ccd_vec3_t *out);

#endif
