/* Vectors, quaternions and rotation matrices by value. */
#ifndef PE_VEC_H
#define PE_VEC_H

#include "plumb/engine.h"

#include <math.h>

/* Row-major: the rows of a body's rotation matrix; its columns are the body's axes in the world. */
typedef struct pe_mat3 {
    pe_vec3 r0, r1, r2;
} pe_mat3;

/* The vector (x, y, z). */
static inline pe_vec3 pe_v3(double x, double y, double z)
{
    return (pe_vec3){x, y, z};
}

/* A vector from an array, and back. */
static inline pe_vec3 pe_v3_load(const double v[3])
{
    return pe_v3(v[0], v[1], v[2]);
}

static inline void pe_v3_store(double to[3], pe_vec3 v)
{
    to[0] = v.x, to[1] = v.y, to[2] = v.z;
}

/* a + b */
static inline pe_vec3 pe_add(pe_vec3 a, pe_vec3 b)
{
    return pe_v3(a.x + b.x, a.y + b.y, a.z + b.z);
}

/* a - b */
static inline pe_vec3 pe_sub(pe_vec3 a, pe_vec3 b)
{
    return pe_v3(a.x - b.x, a.y - b.y, a.z - b.z);
}

/* s a */
static inline pe_vec3 pe_scale(double s, pe_vec3 a)
{
    return pe_v3(s * a.x, s * a.y, s * a.z);
}

/* a + s b */
static inline pe_vec3 pe_madd(pe_vec3 a, double s, pe_vec3 b)
{
    return pe_v3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}

/* a . b */
static inline double pe_dot(pe_vec3 a, pe_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* a x b */
static inline pe_vec3 pe_cross(pe_vec3 a, pe_vec3 b)
{
    return pe_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/* |a| */
static inline double pe_length(pe_vec3 a)
{
    return sqrt(pe_dot(a, a));
}

/* No component is infinite or NaN. */
static inline bool pe_is_finite(pe_vec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

/* Componentwise product. */
static inline pe_vec3 pe_mul(pe_vec3 a, pe_vec3 b)
{
    return pe_v3(a.x * b.x, a.y * b.y, a.z * b.z);
}

/* Smaller and larger of two numbers: one instruction each. NaN gives the same on every machine. */
static inline double pe_min(double a, double b)
{
    return a < b ? a : b;
}

static inline double pe_max(double a, double b)
{
    return a > b ? a : b;
}

/* m a: body to world. */
static inline pe_vec3 pe_rotate(const pe_mat3 *m, pe_vec3 a)
{
    return pe_v3(pe_dot(m->r0, a), pe_dot(m->r1, a), pe_dot(m->r2, a));
}

/* The transpose of m times a: world to body. */
static inline pe_vec3 pe_unrotate(const pe_mat3 *m, pe_vec3 a)
{
    return pe_madd(pe_madd(pe_scale(a.x, m->r0), a.y, m->r1), a.z, m->r2);
}

/* The body's k-th axis, in world coordinates. */
static inline pe_vec3 pe_axis(const pe_mat3 *m, int k)
{
    return k == 0   ? pe_v3(m->r0.x, m->r1.x, m->r2.x)
           : k == 1 ? pe_v3(m->r0.y, m->r1.y, m->r2.y)
                    : pe_v3(m->r0.z, m->r1.z, m->r2.z);
}

/* The k-th component, k = 0 .. 2. */
static inline double pe_component(pe_vec3 a, int k)
{
    return k == 0 ? a.x : k == 1 ? a.y : a.z;
}

/* The rotation matrix of a quaternion, which need not be exactly unit. */
static inline pe_mat3 pe_matrix_of(pe_quat q)
{
    double w = q.w, x = q.x, y = q.y, z = q.z;
    double f = 2 / (w * w + x * x + y * y + z * z); /* 2 except for rounding, which would add up */
    return (pe_mat3){
        .r0 = {1 - f * (y * y + z * z), f * (x * y - w * z), f * (x * z + w * y)},
        .r1 = {f * (x * y + w * z), 1 - f * (x * x + z * z), f * (y * z - w * x)},
        .r2 = {f * (x * z - w * y), f * (y * z + w * x), 1 - f * (x * x + y * y)},
    };
}

/* The rotation b, followed by a. */
static inline pe_quat pe_quat_product(pe_quat a, pe_quat b)
{
    return (pe_quat){
        .w = a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
        .x = a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        .y = a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        .z = a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
    };
}

/* The inverse rotation of a unit quaternion. */
static inline pe_quat pe_quat_conjugate(pe_quat q)
{
    return (pe_quat){q.w, -q.x, -q.y, -q.z};
}

/* q scaled to length 1. */
static inline pe_quat pe_quat_unit(pe_quat q)
{
    double s = 1 / sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return (pe_quat){q.w * s, q.x * s, q.y * s, q.z * s};
}

/* Solves the 3 x 3 system with these rows by Cramer's rule. */
static inline pe_vec3 pe_solve3(pe_vec3 r0, pe_vec3 r1, pe_vec3 r2, pe_vec3 right)
{
    pe_vec3 c12 = pe_cross(r1, r2), c20 = pe_cross(r2, r0), c01 = pe_cross(r0, r1);
    pe_vec3 sum = pe_madd(pe_madd(pe_scale(right.x, c12), right.y, c20), right.z, c01);
    return pe_scale(1 / pe_dot(r0, c12), sum);
}

/* exp(v) q, renormalised: the orientation q rotated by the world-frame rotation vector v, in rad.
 * Exponential map, Rodrigues 1840. */
pe_quat pe_quat_rotated(pe_quat q, pe_vec3 v);

/* Sine and cosine of x, in rad, to 1e-15 for |x| < 1e5. */
void pe_sincos(double x, double *sine, double *cosine);

/* Two unit tangents that make a right-handed frame (n, t1, t2) with the unit vector n. */
static inline void pe_tangents(pe_vec3 n, pe_vec3 *t1, pe_vec3 *t2)
{
    /* The world axis least along n, so that the cross product is far from zero. */
    double ax = fabs(n.x), ay = fabs(n.y), az = fabs(n.z);
    pe_vec3 e = ax <= ay && ax <= az ? pe_v3(1, 0, 0) : ay <= az ? pe_v3(0, 1, 0) : pe_v3(0, 0, 1);
    pe_vec3 t = pe_cross(n, e);
    *t1 = pe_scale(1 / pe_length(t), t);
    *t2 = pe_cross(n, *t1);
}

#endif
