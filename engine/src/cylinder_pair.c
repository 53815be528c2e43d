/* All local maxima of the separation
 *
 *     s(d) = D.d - H_A |a.d| - R_A |a x d| - H_B |b.d| - R_B |b x d|,    D from centre to centre,
 *
 * as named in cylinder.h. All but that of two rims are in closed form or peaks of a circle. Two rims
 * meet where s is smooth: Newton's method on the sphere finds such a maximum, from starts that
 * branch and bound leaves over. Its cells are squares on the faces of a cube around the sphere. With
 * g(d) = ds/dd, s being concave, s(d') <= g(d).d' everywhere, which bounds s over a cell; and over
 * a cell of radius r the tangential part of g changes by at most r (R_A/|a x d| + R_B/|b x d| + |s|),
 * so that one which is larger at the middle leaves no maximum inside. */
#include "cylinder_pair.h"

static const double BIAS = 4e-10; /* in units of the smaller cylinder */

typedef struct search {
    const pe_cylinder *a, *b;
    pe_vec3 offset; /* D */
    double bias;
    pe_cylinder_gap best;
} search;

static void offer(search *s, double distance, pe_vec3 d, pe_cylinder_meeting kind)
{
    if (distance > s->best.distance + s->bias) {
        s->best = (pe_cylinder_gap){distance, d, kind};
    }
}

static double separation_along(const search *s, pe_vec3 d)
{
    return pe_dot(s->offset, d) - pe_cylinder_reach(s->a, d) - pe_cylinder_reach(s->b, d);
}

/* The cylinders being symmetric, of d and -d that along the offset is better. */
static pe_vec3 along_offset(const search *s, pe_vec3 d)
{
    return pe_dot(s->offset, d) < 0 ? pe_scale(-1, d) : d;
}

static void offer_direction(search *s, pe_vec3 d, pe_cylinder_meeting kind)
{
    d = along_offset(s, d);
    offer(s, separation_along(s, d), d, kind);
}

/* Across both axes; of parallel ones, along the offset. */
static void test_sides(search *s)
{
    double length;
    pe_vec3 d = pe_cylinder_outward(s->a, pe_cross(s->a->axis, s->b->axis), &length);
    if (length < 1e-15) {
        d = pe_cylinder_outward(s->a, s->offset, &length);
    }
    if (!(length > 0)) {
        pe_vec3 other;
        pe_tangents(s->a->axis, &d, &other);
    }
    offer_direction(s, d, PE_SIDES);
}

static void test_side_and_rim(search *s, const pe_cylinder *side, const pe_cylinder *rim,
                              pe_cylinder_meeting kind)
{
    pe_circle circle;
    if (!pe_circle_make(rim, side->axis, &circle)) {
        return;
    }
    for (double half = -1; half < 2; half += 2) {
        pe_vec3 d;
        double value, least = s->best.distance + s->bias + side->radius;
        if (pe_circle_peak(&circle, rim, s->offset, half, NULL, NULL, least, &d, &value)) {
            offer(s, value - side->radius, d, kind);
        }
    }
}

/* A direction's place between the axes. */
typedef struct view {
    pe_vec3 d;
    double rise_a, rise_b; /* a.d, b.d */
    double sine_a, sine_b; /* |a x d|, |b x d| */
    pe_vec3 out_a, out_b;  /* unit, from each axis towards the nearest point of its rim */
    pe_vec3 rims;          /* D less both rims' radii: g but for the half heights */
} view;

static view look(const search *s, pe_vec3 d)
{
    view v = {.d = d, .rise_a = pe_dot(s->a->axis, d), .rise_b = pe_dot(s->b->axis, d)};
    v.out_a = pe_madd(d, -v.rise_a, s->a->axis);
    v.out_b = pe_madd(d, -v.rise_b, s->b->axis);
    v.sine_a = pe_max(pe_length(v.out_a), 1e-300);
    v.sine_b = pe_max(pe_length(v.out_b), 1e-300);
    v.out_a = pe_scale(1 / v.sine_a, v.out_a);
    v.out_b = pe_scale(1 / v.sine_b, v.out_b);
    v.rims = pe_madd(s->offset, -s->a->radius, v.out_a);
    v.rims = pe_madd(v.rims, -s->b->radius, v.out_b);
    return v;
}

/* g on the side of a.d = 0 and of b.d = 0 that the signs tell. */
static pe_vec3 gradient(const search *s, const view *v, double sign_a, double sign_b)
{
    pe_vec3 g = pe_madd(v->rims, -sign_a * s->a->half_height, s->a->axis);
    return pe_madd(g, -sign_b * s->b->half_height, s->b->axis);
}

/* Newton's step on the sphere: solves (R_A/s_A p p^T + R_B/s_B q q^T + s I) x = g across d, where p
 * and q are the rims' tangents; s is raised where the matrix would not be positive. */
static pe_vec3 newton_step(const search *s, const view *v, pe_vec3 g)
{
    pe_vec3 t1, t2;
    pe_tangents(v->d, &t1, &t2);
    pe_vec3 p = pe_cross(v->out_a, s->a->axis), q = pe_cross(v->out_b, s->b->axis);
    double ka = s->a->radius / v->sine_a, kb = s->b->radius / v->sine_b, along = pe_dot(g, v->d);
    double p1 = pe_dot(p, t1), p2 = pe_dot(p, t2), q1 = pe_dot(q, t1), q2 = pe_dot(q, t2);
    double m11 = ka * p1 * p1 + kb * q1 * q1, m12 = ka * p1 * p2 + kb * q1 * q2,
           m22 = ka * p2 * p2 + kb * q2 * q2;
    double middle = 0.5 * (m11 + m22), spread = 0.5 * (m11 - m22);
    double lowest = middle - sqrt(spread * spread + m12 * m12);
    double shift = pe_max(along, 1e-3 * (ka + kb) - lowest);
    m11 += shift;
    m22 += shift;
    double g1 = pe_dot(g, t1), g2 = pe_dot(g, t2), det = m11 * m22 - m12 * m12;
    double x1 = (m22 * g1 - m12 * g2) / det, x2 = (m11 * g2 - m12 * g1) / det;
    return pe_madd(pe_scale(x1, t1), x2, t2);
}

/* Climbs from d to a maximum of two rims. */
static void climb(search *s, pe_vec3 d)
{
    enum { MOST = 40, HALVINGS = 30 };
    double value = separation_along(s, d);
    for (int i = 0; i < MOST; ++i) {
        view v = look(s, d);
        pe_vec3 g = gradient(s, &v, v.rise_a < 0 ? -1 : 1, v.rise_b < 0 ? -1 : 1);
        pe_vec3 step = newton_step(s, &v, g);
        double size2 = pe_dot(step, step), scale = size2 > 0.25 ? 0.5 / sqrt(size2) : 1;
        bool better = false;
        for (int k = 0; k < HALVINGS && !better; ++k, scale *= 0.5) {
            pe_vec3 next = pe_madd(d, scale, step);
            next = pe_scale(1 / pe_length(next), next);
            double there = separation_along(s, next);
            better = there > value;
            if (better) {
                d = next;
                value = there;
            } else if (size2 < 1e-12) {
                /* Too near for the value to tell; the gradient does, once. */
                d = k == 0 ? next : d;
                break;
            }
        }
        if (!better) {
            break;
        }
    }
    offer(s, separation_along(s, d), d, PE_RIMS);
}

/* A square on a face of the cube: its middle. */
typedef struct cell {
    int face;
    double x, y;
} cell;

static pe_vec3 direction(const cell *c)
{
    double scale = (c->face & 1 ? 1 : -1) / sqrt(1 + c->x * c->x + c->y * c->y);
    double x = c->x * scale, y = c->y * scale;
    return c->face < 2   ? pe_v3(scale, x, y)
           : c->face < 4 ? pe_v3(y, scale, x)
                         : pe_v3(x, y, scale);
}

/* Whether some maximum of two rims, better than the best known, may lie within the angle whose
 * cosine and sine are given. */
static bool may_hold(const search *s, pe_vec3 d, double cosine, double sine)
{
    view v = look(s, d);
    pe_vec3 g = gradient(s, &v, v.rise_a < 0 ? -1 : 1, v.rise_b < 0 ? -1 : 1);
    double along = pe_dot(g, d), length2 = pe_dot(g, g);
    double tangential = sqrt(pe_max(0, length2 - along * along));
    double bound =
        tangential * cosine > along * sine ? along * cosine + tangential * sine : sqrt(length2);
    if (bound <= s->best.distance + s->bias) {
        return false;
    }
    /* The least sines within the cell. */
    double sa = v.sine_a * cosine - fabs(v.rise_a) * sine;
    double sb = v.sine_b * cosine - fabs(v.rise_b) * sine, angle = sine / cosine;
    if (!(sa > 0 && sb > 0)) {
        return true;
    }
    double change = angle * (s->a->radius / sa + s->b->radius / sb + fabs(along) +
                             angle * sqrt(length2));
    for (double i = -1; i < 2; i += 2) {
        for (double j = -1; j < 2; j += 2) {
            if (i * v.rise_a < -sine || j * v.rise_b < -sine) {
                continue; /* the cell has no part on that side */
            }
            pe_vec3 h = gradient(s, &v, i, j);
            h = pe_madd(h, -pe_dot(h, d), d);
            if (pe_dot(h, h) <= change * change) {
                return true;
            }
        }
    }
    return false;
}

/* Looks for maxima of two rims over the half of the sphere along the offset. */
static void test_rims(search *s, double limit)
{
    enum { ROOM = 256, LEVELS = 6 };
    cell cells[2][ROOM];
    int count = 0;
    for (int i = 0; i < 24; ++i) {
        cells[0][count++] = (cell){i / 4, i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5};
    }
    double reach = pe_length(s->offset), half = 0.5;
    for (int level = 0; level < LEVELS && count > 0; ++level, half *= 0.5) {
        /* A square of half width h is seen from the middle of the sphere within atan(sqrt(2) h). */
        double cosine = 1 / sqrt(1 + 2 * half * half), sine = sqrt(1 - cosine * cosine);
        const cell *from = cells[level & 1];
        cell *to = cells[~level & 1];
        int kept = 0;
        for (int i = 0; i < count; ++i) {
            pe_vec3 d = direction(&from[i]);
            if (pe_dot(d, s->offset) < -sine * reach || !may_hold(s, d, cosine, sine)) {
                continue;
            }
            if (level + 1 == LEVELS) {
                climb(s, d);
                if (s->best.distance > limit) {
                    return;
                }
            }
            for (int k = 0; k < 4 && kept < ROOM; ++k) {
                double h = 0.5 * half;
                to[kept++] = (cell){from[i].face, from[i].x + (k & 1 ? h : -h),
                                    from[i].y + (k & 2 ? h : -h)};
            }
        }
        count = kept;
    }
}

/* Whether the best direction, along the axis of `cap`, is proven to be best of all. The difference
 * of the shapes has a flat facet across it, which holds a disc of radius rho around the foot of the
 * perpendicular from the origin. Apart that is the nearest point. Overlapping by f, no direction
 * nearer than 2 atan(rho/f) is better, because the disc reaches as far along it; and the rest, close
 * to the opposite direction, is far. */
static bool cap_is_best(const search *s, const pe_cylinder *cap, const pe_cylinder *other,
                        double sign)
{
    pe_vec3 d = s->best.normal;
    pe_vec3 x = pe_sub(pe_cylinder_support(other, pe_scale(-sign, d)), cap->centre);
    double rho = cap->radius - pe_length(pe_cylinder_across(cap, x));
    double f = -s->best.distance;
    if (!(rho >= 0) || f <= 0) {
        return rho >= 0;
    }
    double back = f + 2 * pe_dot(s->offset, d); /* the overlap along -d */
    double span = pe_length(s->offset) + s->a->half_height + s->a->radius + s->b->half_height +
                  s->b->radius;
    double tangent = f / rho; /* of half the angle from -d */
    return tangent < 0.1 && back * (1 - 2 * tangent * tangent) - span * 2 * tangent > f;
}

/* Whether the best direction separates the cylinders and g is along it: then it is the one maximum.
 */
static bool rims_are_best(const search *s)
{
    view v = look(s, s->best.normal);
    pe_vec3 g = gradient(s, &v, v.rise_a < 0 ? -1 : 1, v.rise_b < 0 ? -1 : 1);
    double along = pe_dot(g, v.d);
    pe_vec3 across = pe_madd(g, -along, v.d);
    return s->best.distance > 0 && pe_length(across) <= 1e-9 * along;
}

bool pe_cylinder_pair_gap(const pe_cylinder *a, const pe_cylinder *b, double size, double limit,
                          pe_cylinder_gap *gap)
{
    search s = {.a = a, .b = b, .bias = BIAS * size, .best = {.distance = -HUGE_VAL}};
    s.offset = pe_sub(b->centre, a->centre);
    offer_direction(&s, a->axis, PE_CAP_A);
    offer_direction(&s, b->axis, PE_CAP_B);
    bool sure = s.best.kind == PE_CAP_A ? cap_is_best(&s, a, b, 1) : cap_is_best(&s, b, a, -1);
    if (!sure && s.best.distance <= limit) {
        test_sides(&s);
        test_side_and_rim(&s, a, b, PE_SIDE_A);
        test_side_and_rim(&s, b, a, PE_SIDE_B);
        if (s.best.distance > 0 && s.best.distance <= limit) {
            climb(&s, s.best.normal);
            sure = rims_are_best(&s);
        }
        if (!sure && s.best.distance <= limit) {
            test_rims(&s, limit);
        }
    }
    *gap = s.best;
    return s.best.distance <= limit;
}
