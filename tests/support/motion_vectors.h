/* Vectors and rotations of the engine's public types, written out once more, so that the tests of
 * its motion do not lean on what it uses. */
#ifndef PLUMB_TEST_MOTION_VECTORS_H
#define PLUMB_TEST_MOTION_VECTORS_H

#include "plumb/engine.h"

#include <math.h>

/* a + s b */
static inline pe_vec3 add(pe_vec3 a, double s, pe_vec3 b)
{
    return (pe_vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline pe_vec3 cross(pe_vec3 a, pe_vec3 b)
{
    return (pe_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double dot(pe_vec3 a, pe_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline double length(pe_vec3 a)
{
    return sqrt(dot(a, a));
}

static inline double distance(pe_vec3 a, pe_vec3 b)
{
    return length(add(a, -1, b));
}

static inline pe_vec3 by_components(pe_vec3 a, pe_vec3 b)
{
    return (pe_vec3){a.x * b.x, a.y * b.y, a.z * b.z};
}

static inline pe_quat times(pe_quat a, pe_quat b)
{
    return (pe_quat){a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
                     a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                     a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                     a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

static inline pe_quat inverse(pe_quat q)
{
    return (pe_quat){q.w, -q.x, -q.y, -q.z};
}

/* q v q^-1: from the body's axes to the world's. */
static inline pe_vec3 turn(pe_quat q, pe_vec3 v)
{
    pe_quat r = times(times(q, (pe_quat){0, v.x, v.y, v.z}), inverse(q));
    return (pe_vec3){r.x, r.y, r.z};
}

/* By the angle |v|, in rad, about v. */
static inline pe_quat rotation_of(pe_vec3 v)
{
    double angle = length(v), s = angle > 0 ? sin(0.5 * angle) / angle : 0.5;
    return (pe_quat){cos(0.5 * angle), s * v.x, s * v.y, s * v.z};
}

/* The angle between two orientations. */
static inline double angle_between(pe_quat a, pe_quat b)
{
    pe_quat d = times(inverse(a), b);
    return 2 * atan2(sqrt(d.x * d.x + d.y * d.y + d.z * d.z), fabs(d.w));
}

#endif
