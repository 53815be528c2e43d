/* Vectors, quaternions and rotation matrices as values: the harness's own arithmetic, from which no
 * engine takes its geometry.
 *
 * Quaternions are (w, x, y, z), body to world. They need not be exactly unit: every function
 * divides by the norm, so that an engine's rounding does not scale the geometry. */
#ifndef PLUMB_VEC_H
#define PLUMB_VEC_H

#include <math.h>

/* A vector; the unit and the frame are those of its use. */
typedef struct pl_vec {
    double x; /* along the first axis */
    double y; /* along the second axis */
    double z; /* along the third axis */
} pl_vec;

/* A rotation matrix by columns. */
typedef struct pl_axes {
    pl_vec axis[3]; /* the axes of the body in the world, unit */
} pl_axes;

/* The vector with these three components. */
static inline pl_vec pl_vec_of(const double v[3])
{
    return (pl_vec){v[0], v[1], v[2]};
}

/* Writes the three components of v. */
static inline void pl_vec_store(pl_vec v, double out[3])
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

/* a + b. */
static inline pl_vec pl_vec_add(pl_vec a, pl_vec b)
{
    return (pl_vec){a.x + b.x, a.y + b.y, a.z + b.z};
}

/* a - b. */
static inline pl_vec pl_vec_sub(pl_vec a, pl_vec b)
{
    return (pl_vec){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* s a. */
static inline pl_vec pl_vec_scale(pl_vec a, double s)
{
    return (pl_vec){a.x * s, a.y * s, a.z * s};
}

/* a + s b */
static inline pl_vec pl_vec_mad(pl_vec a, double s, pl_vec b)
{
    return (pl_vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

/* The scalar product a . b. */
static inline double pl_vec_dot(pl_vec a, pl_vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* The cross product a x b. */
static inline pl_vec pl_vec_cross(pl_vec a, pl_vec b)
{
    return (pl_vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* |a|. */
static inline double pl_vec_length(pl_vec a)
{
    return sqrt(pl_vec_dot(a, a));
}

/* The part of `v` that is normal to the unit vector `n`. */
static inline pl_vec pl_vec_reject(pl_vec v, pl_vec n)
{
    return pl_vec_mad(v, -pl_vec_dot(v, n), n);
}

/* The rotation matrix of the quaternion q = (w, x, y, z), which need not be unit. */
static inline pl_axes pl_axes_of(const double q[4])
{
    double w = q[0], x = q[1], y = q[2], z = q[3];
    double s = 2 / (w * w + x * x + y * y + z * z);
    return (pl_axes){{{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
                      {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
                      {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}}};
}

/* Rotates a vector from the axes of the body to those of the world. */
static inline pl_vec pl_to_world(const pl_axes *axes, pl_vec local)
{
    pl_vec sum = pl_vec_scale(axes->axis[0], local.x);
    sum = pl_vec_mad(sum, local.y, axes->axis[1]);
    return pl_vec_mad(sum, local.z, axes->axis[2]);
}

/* Rotates a vector from the axes of the world to those of the body. */
static inline pl_vec pl_to_local(const pl_axes *axes, pl_vec world)
{
    return (pl_vec){pl_vec_dot(axes->axis[0], world), pl_vec_dot(axes->axis[1], world),
                    pl_vec_dot(axes->axis[2], world)};
}

/* The angle of the rotation from a to b, 0 .. pi. The vector part of the relative quaternion and
 * its scalar part go through atan2, which is accurate near 0 where acos is not, and needs no unit
 * norm. */
static inline double pl_angle_between(const double a[4], const double b[4])
{
    pl_vec va = pl_vec_of(a + 1), vb = pl_vec_of(b + 1);
    double w = a[0] * b[0] + pl_vec_dot(va, vb);
    pl_vec v = pl_vec_sub(pl_vec_scale(vb, a[0]), pl_vec_scale(va, b[0]));
    v = pl_vec_sub(v, pl_vec_cross(va, vb));
    return 2 * atan2(pl_vec_length(v), fabs(w));
}

#endif
