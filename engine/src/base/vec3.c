/* The exponential map, with a sine and cosine of its own: libm's may differ from one version to the
 * next in the last bit, which would make results differ between machines.
 *
 * x = k pi/2 + r with |r| <= pi/4; pi/2 in three parts of which the first two have zeros at their
 * ends, so that k times them is exact (Cody and Waite 1980); then the Taylor series of sin r and
 * cos r, whose first omitted terms are below 1e-17 at pi/4. */
#include "vec3.h"

void pe_sincos(double x, double *sine, double *cosine)
{
    if (!(fabs(x) < 1e9)) { /* no digit of the angle is left: 0, and NaN stays NaN */
        *sine = 0 * x;
        *cosine = 1 + 0 * x;
        return;
    }
    double k = x * 0.63661977236758134308; /* 2/pi */
    k = (double)(long)(k < 0 ? k - 0.5 : k + 0.5);
    double r = x - k * 1.57079632673412561417; /* 33 bits of pi/2 */
    r -= k * 6.07710050630396597660e-11;       /* the next 33 */
    r -= k * 2.02226624879595063154e-21;

    double z = r * r;
    double s = 1.0 / 355687428096000.0;
    s = -1.0 / 1307674368000.0 + z * s;
    s = 1.0 / 6227020800.0 + z * s;
    s = -1.0 / 39916800.0 + z * s;
    s = 1.0 / 362880.0 + z * s;
    s = -1.0 / 5040.0 + z * s;
    s = 1.0 / 120.0 + z * s;
    s = -1.0 / 6.0 + z * s;
    s = r + r * z * s;

    double c = 1.0 / 20922789888000.0;
    c = -1.0 / 87178291200.0 + z * c;
    c = 1.0 / 479001600.0 + z * c;
    c = -1.0 / 3628800.0 + z * c;
    c = 1.0 / 40320.0 + z * c;
    c = -1.0 / 720.0 + z * c;
    c = 1.0 / 24.0 + z * c;
    c = 1 + z * (-0.5 + z * c);

    switch ((long)k & 3) {
    case 0:
        *sine = s, *cosine = c;
        break;
    case 1:
        *sine = c, *cosine = -s;
        break;
    case 2:
        *sine = -s, *cosine = -c;
        break;
    default:
        *sine = -c, *cosine = s;
        break;
    }
}

pe_quat pe_quat_rotated(pe_quat q, pe_vec3 v)
{
    double angle = pe_length(v);
    double s, c;
    pe_sincos(0.5 * angle, &s, &c);
    /* sin(a/2)/a tends to 1/2; below 1e-8 the next term is lost in rounding. */
    double f = angle > 1e-8 ? s / angle : 0.5;
    pe_quat rotation = {c, f * v.x, f * v.y, f * v.z};
    return pe_quat_unit(pe_quat_product(rotation, q));
}
