/* All local maxima of the separation
 *
 *     s(d) = D.d - H_A |a.d| - R_A |a x d| - H_B |b.d| - R_B |b x d|,    D from centre to centre,
 *
 * as named in cylinder.h. All but that of two rims are in closed form or peaks of a circle. Two
 * rims meet where s is smooth: Newton's method on the sphere finds such a maximum, from starts that
 * branch and bound leaves over. Its cells are squares on the faces of a cube around the sphere.
 * With g(d) = ds/dd, s being concave, s(d') <= g(d).d' everywhere, which bounds s over a cell; and
 * over a cell of radius r the tangential part of g changes by at most r (R_A/|a x d| + R_B/|b x d|
 * + |s|), so that one which is larger at the middle leaves no maximum inside. */
#include "cylinder_pair.h"

/* In units of the smaller cylinder: a meeting is better than another by more than rounding. */
static const double ROUNDING = 1e-14;

typedef struct search {
    const pe_cylinder *a, *b;
    pe_vec3 offset;        /* D */
    double bias, rounding; /* m */
    pe_cylinder_gap best;
} search;

static bool is_flat(const search *s)
{
    return s->best.kind == PE_CAP_A || s->best.kind == PE_CAP_B;
}

/* What another meeting must exceed to be the best. */
static double to_beat(const search *s)
{
    return s->best.distance + (is_flat(s) ? s->bias : s->rounding);
}

static void offer(search *s, double distance, pe_vec3 d, pe_cylinder_meeting kind)
{
    if (distance > to_beat(s)) {
        s->best = (pe_cylinder_gap){.distance = distance, .normal = d, .kind = kind};
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
    pe_vec3 d = pe_outward(s->a->axis, pe_cross(s->a->axis, s->b->axis), &length);
    if (length < 1e-15) {
        d = pe_outward(s->a->axis, s->offset, &length);
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
        double value, least = to_beat(s) + side->radius;
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
 * and q are the rims' tangents. Either of its principal parts is at most `trust`, and as much
 * uphill where the matrix is not positive. Near an axis, or where the rims are nearly tangent, the
 * two curvatures differ by many powers of ten: the lesser comes from the product of both. */
static pe_vec3 newton_step(const search *s, const view *v, pe_vec3 g, double trust, bool *is_cut)
{
    pe_vec3 t1, t2;
    pe_tangents(v->d, &t1, &t2);
    pe_vec3 p = pe_cross(v->out_a, s->a->axis), q = pe_cross(v->out_b, s->b->axis);
    double ka = s->a->radius / v->sine_a, kb = s->b->radius / v->sine_b, along = pe_dot(g, v->d);
    double p1 = pe_dot(p, t1), p2 = pe_dot(p, t2), q1 = pe_dot(q, t1), q2 = pe_dot(q, t2);
    double m11 = ka * p1 * p1 + kb * q1 * q1, m12 = ka * p1 * p2 + kb * q1 * q2,
           m22 = ka * p2 * p2 + kb * q2 * q2, area = p1 * q2 - p2 * q1;
    double spread = 0.5 * (m11 - m22), root = sqrt(spread * spread + m12 * m12);
    double most = 0.5 * (m11 + m22) + root;
    pe_vec3 e1 = spread > 0 ? pe_madd(pe_scale(spread + root, t1), m12, t2)
                            : pe_madd(pe_scale(m12, t1), root - spread, t2);
    double length = pe_length(e1);
    e1 = length > 0 ? pe_scale(1 / length, e1) : t1;
    pe_vec3 e[2] = {e1, pe_cross(v->d, e1)}, step = pe_v3(0, 0, 0);
    const double curvature[2] = {most + along, ka * kb * area * area / most + along};
    *is_cut = false;
    for (int k = 0; k < 2; ++k) {
        double slope = pe_dot(g, e[k]);
        bool cut = !(fabs(slope) <= trust * curvature[k]);
        step = pe_madd(step, !cut ? slope / curvature[k] : slope < 0 ? -trust : trust, e[k]);
        *is_cut = *is_cut || cut;
    }
    return step;
}

/* The side of a.d = 0 where d is; on it, that on which s may grow. */
static double side_of(const view *v, double rise, pe_vec3 axis)
{
    double place = fabs(rise) > 1e-13 ? rise : pe_dot(v->rims, axis);
    return place < 0 ? -1 : 1;
}

static pe_vec3 gradient_there(const search *s, const view *v)
{
    return gradient(s, v, side_of(v, v->rise_a, s->a->axis), side_of(v, v->rise_b, s->b->axis));
}

static pe_vec3 moved(pe_vec3 d, double scale, pe_vec3 step)
{
    pe_vec3 next = pe_madd(d, scale, step);
    return pe_scale(1 / pe_length(next), next);
}

/* From an axis, where s has the shape of a cone's tip, the way in which it grows: some direction
 * there that is better. d itself if it is not along an axis, or none is. */
static pe_vec3 leave_axis(const search *s, pe_vec3 d)
{
    const double tip = 1e-12;
    view v = look(s, d);
    bool at_a = v.sine_a < tip, at_b = v.sine_b < tip;
    if (!at_a && !at_b) {
        return d;
    }
    pe_vec3 g = gradient_there(s, &v);
    g = at_a ? pe_madd(g, s->a->radius, v.out_a) : g;
    g = at_b ? pe_madd(g, s->b->radius, v.out_b) : g;
    double length, fall = (at_a ? s->a->radius : 0) + (at_b ? s->b->radius : 0);
    pe_vec3 uphill = pe_outward(d, g, &length);
    if (!(length > fall)) {
        return d;
    }
    double value = separation_along(s, d);
    for (double scale = 0.5; scale > tip; scale *= 0.5) {
        pe_vec3 next = moved(d, scale, uphill);
        if (separation_along(s, next) > value) {
            return next;
        }
    }
    return d;
}

/* How often a climb may have to step back. */
enum { FEW = 10, MANY = 60 };

/* Climbs from d to a maximum of two rims: while the value grows, then, where that is a matter of
 * rounding, as long as steps shrink. Gives up farther than `reach` (rad) from the start, and
 * where steps must be cut short again and again: on a ridge, which is no maximum of two rims. */
static pe_cylinder_gap climb(const search *s, pe_vec3 d, double reach, int most_failures)
{
    enum { MOST = 200 };
    pe_vec3 start = d;
    int failures = 0;
    double value = separation_along(s, d), last = HUGE_VAL, trust = 0.5;
    double rounding = 1e-16 * (pe_length(s->offset) + s->a->radius + s->b->radius);
    view v = look(s, d);
    pe_vec3 g = gradient_there(s, &v);
    for (int i = 0; i < MOST; ++i) {
        pe_vec3 away = pe_sub(d, start);
        double sine = pe_min(v.sine_a, v.sine_b);
        if (pe_dot(away, away) > reach * reach || sine < 1e-15) {
            break;
        }
        bool is_cut;
        pe_vec3 step = newton_step(s, &v, g, trust, &is_cut), next = moved(d, 1, step);
        double size = pe_length(step), there = separation_along(s, next);
        bool is_last = size < 1e-5 * sine || pe_dot(g, step) < rounding;
        if (!is_cut && is_last && size < last) {
            last = 0.5 * size;
        } else if (there > value) {
            trust = is_cut ? pe_min(0.5, 2 * trust) : trust;
        } else {
            failures += 1;
            trust = 0.25 * pe_min(trust, size);
            if (failures > most_failures || trust * pe_dot(g, step) < 0.1 * rounding * size) {
                break;
            }
            continue;
        }
        d = next;
        value = there;
        v = look(s, d);
        g = gradient_there(s, &v);
    }
    return (pe_cylinder_gap){.distance = value, .normal = d, .kind = PE_RIMS};
}

/* Climbs from the best direction, which separates the cylinders. True where g is along the
 * direction that this leads to: then it is the one maximum. */
static bool climb_apart(search *s)
{
    pe_cylinder_gap found = climb(s, leave_axis(s, s->best.normal), HUGE_VAL, MANY);
    view v = look(s, found.normal);
    pe_vec3 g = gradient_there(s, &v);
    double along = pe_dot(g, v.d);
    if (!(pe_length(pe_madd(g, -along, v.d)) <= 1e-12 * along)) {
        return false;
    }
    s->best = is_flat(s) && found.distance <= to_beat(s) ? s->best : found;
    return true;
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
    return c->face < 2 ? pe_v3(scale, x, y) : c->face < 4 ? pe_v3(y, scale, x) : pe_v3(x, y, scale);
}

/* Whether some maximum of two rims, better than the best known, may lie within the angle whose
 * cosine and sine are given. */
static bool may_hold(const search *s, pe_vec3 d, double cosine, double sine)
{
    view v = look(s, d);
    pe_vec3 g = gradient_there(s, &v);
    double along = pe_dot(g, d), length2 = pe_dot(g, g);
    double tangential = sqrt(pe_max(0, length2 - along * along));
    double bound =
        tangential * cosine > along * sine ? along * cosine + tangential * sine : sqrt(length2);
    if (bound <= to_beat(s)) {
        return false;
    }
    /* The least sines within the cell. */
    double sa = v.sine_a * cosine - fabs(v.rise_a) * sine;
    double sb = v.sine_b * cosine - fabs(v.rise_b) * sine, angle = sine / cosine;
    if (!(sa > 0 && sb > 0)) {
        return true;
    }
    double change =
        angle * (s->a->radius / sa + s->b->radius / sb + fabs(along) + angle * sqrt(length2));
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

/* Beside an axis cells are too coarse for maxima that nearly parallel axes may have there. */
static void climb_from_axis(search *s, pe_vec3 axis)
{
    pe_cylinder_gap found = climb(s, leave_axis(s, along_offset(s, axis)), HUGE_VAL, MANY);
    offer(s, found.distance, found.normal, PE_RIMS);
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
    climb_from_axis(s, s->a->axis);
    climb_from_axis(s, s->b->axis);
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
                pe_cylinder_gap found = climb(s, d, 16 * sine, FEW);
                offer(s, found.distance, found.normal, PE_RIMS);
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

static pe_vec3 point_on_a(const pe_cylinder *a, const pe_cylinder *b, const pe_cylinder_gap *gap)
{
    pe_vec3 d = gap->normal, to_a = pe_scale(-1, d);
    if (gap->kind == PE_CAP_B || gap->kind == PE_SIDE_B) {
        return pe_cylinder_support(a, d);
    }
    if (gap->kind != PE_SIDES) {
        return pe_madd(pe_cylinder_support(b, to_a), -gap->distance, d);
    }
    /* Where a's axis is nearest to b's; of parallel ones the middle of what they share. */
    pe_vec3 offset = pe_sub(b->centre, a->centre), across = pe_across(b->axis, a->axis);
    double square = pe_dot(across, across), middle = pe_dot(offset, a->axis);
    double low = pe_max(-a->half_height, middle - b->half_height);
    double high = pe_min(a->half_height, middle + b->half_height);
    double z = square > 1e-30 ? pe_dot(offset, across) / square : 0.5 * (low + high);
    z = pe_max(-a->half_height, pe_min(a->half_height, z));
    return pe_madd(pe_madd(a->centre, z, a->axis), a->radius, d);
}

/* How far the point x is from a, or the one that it meets from b, in m. */
static double off_both(const search *s, pe_vec3 x)
{
    pe_vec3 y = pe_madd(x, s->best.distance, s->best.normal);
    double off_a = pe_length(pe_sub(pe_cylinder_nearest(s->a, x), x));
    return pe_max(off_a, pe_length(pe_sub(pe_cylinder_nearest(s->b, y), y)));
}

/* Whether the best direction is proven to be the best of all. Its nearest points being in both
 * cylinders, it is if they are apart. Overlapping by f, either cylinder holds a ball that touches
 * its surface there; if their radii add up to f at least, the difference of the cylinders holds a
 * ball with the origin inside whose surface is nowhere nearer to it than at that point. */
static bool is_proven(const search *s, double size)
{
    const pe_cylinder_gap *best = &s->best;
    double tie = 1e-12 * size;
    pe_vec3 x = point_on_a(s->a, s->b, best), y = pe_madd(x, best->distance, best->normal);
    if (off_both(s, x) > tie) {
        return false;
    }
    return best->distance >= 0 ||
           pe_max(0, pe_cylinder_inner_ball(s->a, x, best->normal)) +
                   pe_max(0, pe_cylinder_inner_ball(s->b, y, best->normal)) >=
               -best->distance;
}

/* Moves x towards the points where a meets b once that is moved back by the gap: each cylinder's
 * nearest point to the other's in turn. Returns how far it still is outside b, in m. */
static double meet(const search *s, double enough, pe_vec3 *x)
{
    enum { MOST = 40 };
    pe_vec3 gap = pe_scale(s->best.distance, s->best.normal), on_b = *x;
    double aside = HUGE_VAL;
    for (int i = 0; i < MOST && aside > enough; ++i) {
        *x = pe_cylinder_nearest(s->a, on_b);
        on_b = pe_sub(pe_cylinder_nearest(s->b, pe_add(*x, gap)), gap);
        aside = pe_length(pe_sub(on_b, *x));
    }
    return aside;
}

/* The middle of the cap that is farther along d. */
static pe_vec3 cap_along(const pe_cylinder *c, pe_vec3 d)
{
    double height = pe_dot(d, c->axis) < 0 ? -c->half_height : c->half_height;
    return pe_madd(c->centre, height, c->axis);
}

/* Where the direction is along an axis, but for rounding, a whole cap is nearest, and what it
 * suggests may be anywhere on it: then the way from the middle of either cap is shorter. */
static void find_point(search *s, double size)
{
    pe_cylinder_gap *best = &s->best;
    pe_vec3 d = best->normal;
    const pe_vec3 starts[3] = {
        point_on_a(s->a, s->b, best),
        pe_madd(cap_along(s->b, pe_scale(-1, d)), -best->distance, d),
        cap_along(s->a, d),
    };
    double enough = 1e-12 * size;
    if (is_flat(s) && s->bias > 0) {
        /* The cap is kept for its bias only where it is what is suggested that it meets. */
        best->on_a = starts[0];
        best->aside = off_both(s, starts[0]);
        return;
    }
    best->aside = HUGE_VAL;
    for (int i = 0; i < 3 && best->aside > enough; ++i) {
        pe_vec3 x = starts[i];
        double aside = meet(s, enough, &x);
        if (aside < best->aside) {
            best->aside = aside;
            best->on_a = x;
        }
    }
}

/* Near where one meeting turns into another both are as good to rounding, with directions that are
 * only as exact as the root of that. Of cylinders that are apart nearest points give all digits. */
static void settle(search *s, double size)
{
    enum { MOST = 100 };
    pe_cylinder_gap *best = &s->best;
    find_point(s, size);
    if (best->distance < 1e-4 * size || is_flat(s)) {
        return;
    }
    pe_vec3 on_a = best->on_a;
    for (int i = 0; i < MOST; ++i) {
        on_a = pe_cylinder_nearest(s->a, on_a);
        pe_vec3 on_b = pe_cylinder_nearest(s->b, on_a), between = pe_sub(on_b, on_a);
        pe_vec3 d = pe_scale(1 / pe_length(between), between);
        if (separation_along(s, d) > best->distance - 1e-11 * size) {
            best->normal = d;
            best->on_a = on_a;
            return;
        }
        on_a = on_b; /* the nearest point to it is nearer still */
    }
}

bool pe_cylinder_pair_gap(const pe_cylinder *a, const pe_cylinder *b, double size, double bias,
                          double limit, pe_cylinder_gap *gap)
{
    search s = {
        .a = a, .b = b, .bias = bias, .rounding = ROUNDING * size, .best = {.distance = -HUGE_VAL}};
    s.offset = pe_sub(b->centre, a->centre);
    offer_direction(&s, a->axis, PE_CAP_A);
    offer_direction(&s, b->axis, PE_CAP_B);
    bool sure = s.best.distance <= limit && is_proven(&s, size);
    if (!sure && s.best.distance <= limit) {
        test_sides(&s);
        test_side_and_rim(&s, a, b, PE_SIDE_A);
        test_side_and_rim(&s, b, a, PE_SIDE_B);
        sure = s.best.distance <= limit &&
               (is_proven(&s, size) || (s.best.distance > 0 && climb_apart(&s)));
        if (!sure && s.best.distance <= limit) {
            test_rims(&s, limit);
            if (s.best.kind == PE_RIMS) {
                /* Rims nearly tangent to each other take long. */
                pe_cylinder_gap found = climb(&s, s.best.normal, HUGE_VAL, MANY);
                s.best = found.distance >= s.best.distance ? found : s.best;
            }
        }
    }
    if (s.best.distance <= limit) {
        settle(&s, size);
    }
    *gap = s.best;
    return s.best.distance <= limit;
}
