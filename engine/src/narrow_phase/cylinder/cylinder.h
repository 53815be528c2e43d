/* A solid cylinder as the colliders of curved shapes see it: its reach, and the directions in which
 * its rim and a straight line are farthest apart.
 *
 * The separation of two convex shapes along a unit direction d, from the first to the second, is
 * what lies between the last point of the first and the first point of the second; the largest one
 * over all d is their signed distance. It is found as the largest of its local maxima, which come
 * in families, by the features that meet:
 *
 *     along a face's normal or a cap's; along the cross product of two straight lines (edges, or
 *     the lines on a side); from a side, or a rim, to a corner; from a rim to a straight line; from
 *     a rim to a rim.
 *
 * Of shapes that overlap, a smooth local maximum must also be as round as it is deep, which leaves
 * out a corner in a rim. */
#ifndef PE_CYLINDER_H
#define PE_CYLINDER_H

#include "narrow_phase/collide.h"

typedef struct pe_cylinder {
    pe_vec3 centre, axis; /* m; unit */
    double radius, half_height;
} pe_cylinder;

/* A cylinder in the axes of `pose`. */
pe_cylinder pe_cylinder_seen(pe_placed cylinder, const pe_pose *pose);

/* A point farthest along d: of the lower cap or of the side's lower end where there are many. */
pe_vec3 pe_cylinder_support(const pe_cylinder *c, pe_vec3 d);

/* Part of v across the unit vector `axis`. */
static inline pe_vec3 pe_across(pe_vec3 axis, pe_vec3 v)
{
    return pe_madd(v, -pe_dot(v, axis), axis);
}

/* The same made a unit vector, across the axis to all digits; zero if v is along the axis, to
 * rounding. *length: of what it was made from. */
pe_vec3 pe_outward(pe_vec3 axis, pe_vec3 v, double *length);

/* How far it reaches from its centre along the unit direction d: H |a.d| + R |a x d|. */
static inline double pe_cylinder_reach(const pe_cylinder *c, pe_vec3 d)
{
    return c->half_height * fabs(pe_dot(c->axis, d)) + c->radius * pe_length(pe_cross(c->axis, d));
}

/* Radius of the largest ball in the solid that touches the surface at x, where its outward normal
 * is n: 0 on the rim, less where x is outside. */
double pe_cylinder_inner_ball(const pe_cylinder *c, pe_vec3 x, pe_vec3 n);

/* The point of the solid nearest to x. */
pe_vec3 pe_cylinder_nearest(const pe_cylinder *c, pe_vec3 x);

/* Where the line x + t d enters the side, at entry, and leaves it again, at exit, however long the
 * cylinder is; false where it misses it or is near the silhouette: farther than half the radius
 * from the axis. */
bool pe_cylinder_pierce(const pe_cylinder *c, pe_vec3 x, pe_vec3 d, double *entry, double *exit);

/* The directions across the unit vector e, as a cylinder lies to them: x u + y t, with t = e x u
 * and the axis a in the plane of e and u, a.u >= 0. */
typedef struct pe_circle {
    pe_vec3 u, t;
    double sine, cosine2; /* of the angle between a and e; the cosine squared */
} pe_circle;

/* False when the axis is along e to rounding. */
bool pe_circle_make(const pe_cylinder *c, pe_vec3 e, pe_circle *circle);

/* A direction across e, in the coordinates of its circle. */
typedef struct pe_turn {
    double x, y;
} pe_turn;

/* Largest value along the directions d across e, with side * (a.d) > 0, of
 *
 *     w.d - H |a.d| - R |a x d|,
 *
 * the separation of a line along e from the cylinder whose centre lies at w from it: a local
 * maximum of it, where the rim is nearest to the line. There is one at most. `from` and `to` bound
 * the directions, counter-clockwise about e, less than half a turn apart; NULL: all of them. False
 * when there is none between, or when it does not exceed `least`. */
bool pe_circle_peak(const pe_circle *circle, const pe_cylinder *c, pe_vec3 w, double side,
                    const pe_turn *from, const pe_turn *to, double least, pe_vec3 *d,
                    double *value);

#endif
