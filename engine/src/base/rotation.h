/* Turning a body by a rotation vector. */
#ifndef PE_ROTATION_H
#define PE_ROTATION_H

#include "vec3.h"

/* exp(v) q, renormalised: the orientation q turned by the world-frame rotation vector v, in rad.
 * Exponential map, Rodrigues 1840. */
pe_quat pe_quat_turned(pe_quat q, pe_vec3 v);

/* Sine and cosine of x, in rad, to 1e-15 for |x| < 1e5. libm's may differ from one version to the
 * next in the last bit, which would make results differ between machines. */
void pe_sincos(double x, double *sine, double *cosine);

#endif
