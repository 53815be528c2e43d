/* A cylinder's support, nearest points, and the peak of a line against its rim.
 *
 * With d = x u + y t, x > 0 on the side that is asked for, the separation of line and rim is
 *
 *     s = A x + B y - R sqrt(c^2 x^2 + y^2),    A = w.u - H q,  B = w.t,
 *
 * where q and c are the sine and cosine of the angle between the axis and the line. In the slope
 * k = y/x its derivative along the circle of directions is x times
 *
 *     G(k) = B - A k - R q^2 k / sqrt(c^2 + k^2),
 *
 * a straight line minus a sigmoid, whose curvature changes at k = 0 only. A maximum is a root where
 * G falls. It lies on the side of k = 0 that the sign of B shows, and from k = 0 on G is convex
 * there: Newton's iterates grow towards the root and never pass it. If there is no root, G stops
 * falling. */
#include "cylinder.h"

pe_cylinder pe_cylinder_in_axes(pe_placed cylinder, const pe_pose *pose)
{
    return (pe_cylinder){
        .centre = pe_pose_to_body(pose, cylinder.pose->position),
        .axis = pe_unrotate(&pose->rotation, pe_axis(&cylinder.pose->rotation, 2)),
        .radius = cylinder.shape->radius,
        .half_height = cylinder.shape->half_height,
    };
}

pe_vec3 pe_outward(pe_vec3 axis, pe_vec3 v, double *length)
{
    pe_vec3 out = pe_across(axis, v);
    *length = pe_length(out);
    if (*length > 1e-15 * pe_length(v)) {
        /* The part along the axis that rounding left has grown as much as the vector. */
        out = pe_across(axis, pe_scale(1 / *length, out));
        const double across = pe_length(out);
        if (across > 0.5) {
            return pe_scale(1 / across, out);
        }
    }
    *length = 0; /* only rounding is left, of the vector or of the axis's length */
    return pe_v3(0, 0, 0);
}

void pe_cylinder_rim(const pe_cylinder *c, pe_vec3 reference, pe_vec3 arm[4])
{
    double length;
    arm[0] = pe_scale(c->radius, pe_outward(c->axis, reference, &length));
    arm[1] = pe_cross(c->axis, arm[0]);
    arm[2] = pe_scale(-1, arm[0]);
    arm[3] = pe_scale(-1, arm[1]);
}

pe_vec3 pe_cylinder_support(const pe_cylinder *c, pe_vec3 d)
{
    double height = pe_dot(d, c->axis) > 0 ? c->half_height : -c->half_height, length;
    pe_vec3 x = pe_madd(c->centre, height, c->axis);
    return pe_madd(x, c->radius, pe_outward(c->axis, d, &length));
}

double pe_cylinder_inner_ball(const pe_cylinder *c, pe_vec3 x, pe_vec3 n)
{
    pe_vec3 from = pe_sub(x, c->centre);
    double z = fabs(pe_dot(from, c->axis)), rise = fabs(pe_dot(n, c->axis));
    double to_rim = c->radius - pe_length(pe_across(c->axis, from)), to_cap = c->half_height - z;
    if (rise < 1e-14) {
        return pe_min(c->radius, to_cap);
    }
    return 1 - rise < 1e-15 ? pe_min(c->half_height, to_rim) : pe_min(0, pe_min(to_rim, to_cap));
}

pe_vec3 pe_cylinder_nearest(const pe_cylinder *c, pe_vec3 x)
{
    double z = pe_dot(pe_sub(x, c->centre), c->axis), from_axis;
    pe_vec3 across = pe_across(c->axis, pe_sub(x, c->centre));
    pe_vec3 out = pe_outward(c->axis, across, &from_axis);
    z = pe_max(-c->half_height, pe_min(c->half_height, z));
    pe_vec3 on_axis = pe_madd(c->centre, z, c->axis);
    return from_axis > c->radius ? pe_madd(on_axis, c->radius, out) : pe_add(on_axis, across);
}

bool pe_cylinder_pierce(const pe_cylinder *c, pe_vec3 x, pe_vec3 d, double *entry, double *exit)
{
    pe_vec3 p = pe_across(c->axis, pe_sub(x, c->centre)), e = pe_across(c->axis, d);
    double square = pe_dot(e, e), middle = -pe_dot(p, e) / square;
    p = pe_madd(p, middle, e); /* nearest to the axis */
    double chord2 = c->radius * c->radius - pe_dot(p, p);
    if (!(chord2 > 0.75 * c->radius * c->radius)) {
        return false;
    }
    double half = sqrt(chord2 / square);
    *entry = middle - half;
    *exit = middle + half;
    return true;
}

bool pe_rim_query_make(const pe_cylinder *c, pe_vec3 e, pe_vec3 to_centre, pe_rim_query *query)
{
    double cosine = pe_dot(c->axis, e);
    query->cylinder = c;
    query->to_centre = to_centre;
    query->cosine2 = cosine * cosine;
    query->u = pe_outward(e, c->axis, &query->sine);
    query->t = pe_cross(e, query->u);
    query->bounded = false;
    return query->sine >= 1e-15;
}

/* The function G: b - a k - rq2 k / sqrt(c2 + k^2), with b >= 0. */
typedef struct slope_function {
    double a, b, rq2, c2;
} slope_function;

/* The root of G where it falls, between the slopes low and high. */
static bool find_root(slope_function f, double low, double high, double *slope)
{
    enum { MOST = 64 };
    double k = pe_max(low, 0);
    if (high < k) {
        return false;
    }
    if (f.c2 < 1e-200) {
        /* The sigmoid is a step. At the step itself d is along the axis, which is the cap's. */
        *slope = (f.b - f.rq2) / f.a;
        return f.a > 0 && f.b > f.rq2 && *slope >= low && *slope <= high;
    }
    if (f.a >= 0 && high < HUGE_VAL && f.b > high * (f.a + f.rq2 / sqrt(f.c2 + high * high))) {
        return false;
    }
    for (int i = 0; i < MOST; ++i) {
        double g = 1 / sqrt(f.c2 + k * k);
        double value = f.b - k * (f.a + f.rq2 * g);
        if (value <= 0) {
            if (i == 0 && value < 0) {
                return false; /* G has fallen below 0 already */
            }
            break;
        }
        double fall = f.a + f.rq2 * f.c2 * g * g * g;
        double next = k + value / fall;
        if (!(fall > 0) || next > high || next > 1e100) {
            return false;
        }
        if (!(next > k)) {
            break;
        }
        k = next;
    }
    *slope = k;
    return true;
}

bool pe_rim_peak(const pe_rim_query *query, double side, double least, pe_vec3 *d, double *value)
{
    double low = -HUGE_VAL, high = HUGE_VAL;
    if (query->bounded) {
        double x0 = side * query->bound[0].x, x1 = side * query->bound[1].x;
        if (!(x0 > 0) && !(x1 > 0)) {
            return false;
        }
        low = x0 > 0 ? side * query->bound[0].y / x0 : low;
        high = x1 > 0 ? side * query->bound[1].y / x1 : high;
    }
    const pe_cylinder *c = query->cylinder;
    double q = query->sine, c2 = query->cosine2, r = c->radius;
    double a = side * pe_dot(query->to_centre, query->u) - c->half_height * q;
    double b = side * pe_dot(query->to_centre, query->t);
    double bound = least + r * sqrt(c2);
    if (bound > 0 && a * a + b * b <= bound * bound) {
        return false; /* s <= |(A, B)| - R c */
    }
    double k;
    slope_function f = {a, b < 0 ? -b : b, r * q * q, c2};
    if (!find_root(f, b < 0 ? -high : low, b < 0 ? -low : high, &k)) {
        return false;
    }
    k = b < 0 ? -k : k;
    double x = 1 / sqrt(1 + k * k), y = k * x;
    *value = a * x + b * y - r * sqrt(c2 * x * x + y * y);
    *d = pe_madd(pe_scale(side * x, query->u), side * y, query->t);
    return *value > least;
}
