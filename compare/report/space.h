/* Vectors and body axes, as far as drawing needs them. */
#ifndef PLUMB_SPACE_H
#define PLUMB_SPACE_H

#include <math.h>

typedef struct pl_vec3 {
    double x, y, z;
} pl_vec3;

static inline pl_vec3 pl_vec3_of(const double v[3])
{
    return (pl_vec3){v[0], v[1], v[2]};
}

static inline pl_vec3 pl_vec3_scale(pl_vec3 a, double s)
{
    return (pl_vec3){a.x * s, a.y * s, a.z * s};
}

/* a + s b */
static inline pl_vec3 pl_vec3_mad(pl_vec3 a, double s, pl_vec3 b)
{
    return (pl_vec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline double pl_vec3_dot(pl_vec3 a, pl_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline pl_vec3 pl_vec3_cross(pl_vec3 a, pl_vec3 b)
{
    return (pl_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double pl_vec3_length(pl_vec3 a)
{
    return sqrt(pl_vec3_dot(a, a));
}

/* The part of `v` that is normal to the unit vector `n`. */
static inline pl_vec3 pl_vec3_reject(pl_vec3 v, pl_vec3 n)
{
    return pl_vec3_mad(v, -pl_vec3_dot(v, n), n);
}

/* The axes of a body in the world: the columns of the rotation matrix of the quaternion (w, x, y,
 * z), which need not be exactly unit. */
static inline void pl_body_axes(const double q[4], pl_vec3 axes[3])
{
    double w = q[0], x = q[1], y = q[2], z = q[3];
    double s = 2 / (w * w + x * x + y * y + z * z);
    axes[0] = (pl_vec3){1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)};
    axes[1] = (pl_vec3){s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)};
    axes[2] = (pl_vec3){s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)};
}

#endif
