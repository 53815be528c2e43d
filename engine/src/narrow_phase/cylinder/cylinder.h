/* A solid cylinder as the narrow phase sees it: its reach, and the directions in which its rim and
 * a straight line are farthest apart.
 *
 * The separation of two convex shapes along a unit direction d, from the first to the second, is
 * the distance along d from the last point of the first to the first point of the second. The
 * largest separation over all d is their signed distance. It is found as the largest of its local
 * maxima. These come in families, by the features that meet:
 *
 *   - along a face's normal or a cap's;
 *   - along the cross product of two straight lines (edges, or the lines on a side);
 *   - from a side, or a rim, to a corner;
 *   - from a rim to a straight line;
 *   - from a rim to a rim.
 *
 * For shapes that overlap, a smooth local maximum must also be at least as round as it is deep.
 * This rules out a corner in a rim. */
#ifndef PE_CYLINDER_H
#define PE_CYLINDER_H

#include "narrow_phase/collide.h"

/* A solid cylinder: its centre, axis, radius (m) and half height (m). */
typedef struct pe_cylinder {
    pe_vec3 centre, axis; /* m; unit */
    double radius, half_height;
} pe_cylinder;

/* A cylinder in the axes of `pose`. */
pe_cylinder pe_cylinder_in_axes(pe_placed cylinder, const pe_pose *pose);

/* A point farthest along d. If there are many, one of the lower cap or of the side's lower end. */
pe_vec3 pe_cylinder_support(const pe_cylinder *c, pe_vec3 d);

/* The part of v across the unit vector `axis`. */
static inline pe_vec3 pe_across(pe_vec3 axis, pe_vec3 v)
{
    return pe_madd(v, -pe_dot(v, axis), axis);
}

/* The same, normalised, and across the axis to all digits. Zero if v is along the axis, to
 * rounding. *length: that of the part before it was normalised. */
pe_vec3 pe_outward(pe_vec3 axis, pe_vec3 v, double *length);

/* Four points of a rim, from its centre, a quarter turn apart. The first lies in the direction of
 * `reference`, so that the points stay with it while the cylinder spins. */
void pe_cylinder_rim(const pe_cylinder *c, pe_vec3 reference, pe_vec3 arm[4]);

/* The extent from the centre along the unit direction d: H |a.d| + R |a x d|. */
static inline double pe_cylinder_reach(const pe_cylinder *c, pe_vec3 d)
{
    return c->half_height * fabs(pe_dot(c->axis, d)) + c->radius * pe_length(pe_cross(c->axis, d));
}

/* The radius of the largest ball in the solid that touches the surface at x, where its outward
 * normal is n: 0 on the rim, negative where x is outside. */
double pe_cylinder_inner_ball(const pe_cylinder *c, pe_vec3 x, pe_vec3 n);

/* The point of the solid nearest to x. */
pe_vec3 pe_cylinder_nearest(const pe_cylinder *c, pe_vec3 x);

/* The parameters where the line x + t d enters and leaves the side of the infinite cylinder. False
 * if it misses the side or is near the silhouette: farther than half the radius from the axis. */
bool pe_cylinder_pierce(const pe_cylinder *c, pe_vec3 x, pe_vec3 d, double *entry, double *exit);

/* A direction across a line, in the coordinates of its pe_rim_query. */
typedef struct pe_turn {
    double x, y;
} pe_turn;

/* A straight line along the unit vector e, against the rim of a cylinder with the axis a.
 * Directions across the line are x u + y t, with t = e x u, a in the plane of e and u, and a.u >=
 * 0. */
typedef struct pe_rim_query {
    const pe_cylinder *cylinder;
    pe_vec3 to_centre; /* w: from a point of the line to the cylinder's centre */
    pe_vec3 u, t;
    double sine, cosine2; /* of the angle between a and e; the cosine squared */
    bool bounded;     /* only directions from bound[0] to bound[1] count, counter-clockwise about */
    pe_turn bound[2]; /* e, less than half a turn apart; else all do */
} pe_rim_query;

/* Describes an unbounded query. False: the axis is along e to rounding. */
bool pe_rim_query_make(const pe_cylinder *c, pe_vec3 e, pe_vec3 to_centre, pe_rim_query *query);

/* Finds the local maximum, over the directions d across the line with side * (a.d) > 0, of
 *
 *     w.d - H |a.d| - R |a x d|,
 *
 * the separation of the line from the cylinder, where the rim is nearest to the line. There is at
 * most one. False if there is none within the bounds, or if it does not exceed `least`. */
bool pe_rim_peak(const pe_rim_query *query, double side, double least, pe_vec3 *d, double *value);

#endif
