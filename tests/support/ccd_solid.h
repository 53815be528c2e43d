/* Convex shapes as libccd takes them. */
#ifndef PLUMB_TEST_CCD_SOLID_H
#define PLUMB_TEST_CCD_SOLID_H

#include "shape_pairs.h"

#include <ccd/ccd.h>

/* A box, cylinder, hull, sphere or capsule; positions are relative to the origin, so that digits are not
 * lost far out. */
typedef struct ccd_solid {
    const placed *p;
    pe_vec3 origin;
} ccd_solid;

/* The support function, of a ccd_solid. */
void ccd_support(const void *object, const ccd_vec3_t *dir, ccd_vec3_t *out);

#endif
