/* The signed distance of two cylinders: all local maxima of the separation
 *
 *     s(d) = D.d - H_A |a.d| - R_A |a x d| - H_B |b.d| - R_B |b x d|,    D from centre to centre,
 *
 * as listed in cylinder.h. All but that of two rims are in closed form or peaks of a circle of
 * directions (pe_rim_peak). Two rims meet where s is smooth. Newton's method on the sphere finds
 * such a maximum, from starts that a branch and bound search leaves. Its cells are squares on the
 * faces of a cube around the sphere. With g(d) = ds/dd, s being concave, s(d') <= g(d).d'
 * everywhere, which bounds s over a cell. Over a cell of radius r the tangential part of g changes
 * by at most r (R_A/|a x d| + R_B/|b x d| + |s|). If it is larger than that at the centre of the
 * cell, no maximum lies in the cell. */
#include "cylinder_gap.h"
#include "narrow_phase/tolerances.h"

typedef struct search {
    const pe_cylinder *a, *b;
    pe_vec3 offset; /* D */
    const pe_gap_query *query;
    double rounding; /* m */
    pe_cylinder_gap best;
} search;

static bool is_flat(const search *s)
{
    return s->best.kind == PE_CAP_A || s->best.kind == PE_CAP_B;
}

/* The separation that another meeting must exceed to become the best. */
static double to_beat(const search *s)
{
    return s->best.distance + (is_flat(s) ? s->query->bias : s->rounding);
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

/* The better of d and -d, that along the offset: cylinders are symmetric. */
static pe_vec3 along_offset(const search *s, pe_vec3 d)
{
    return pe_dot(s->offset, d) < 0 ? pe_scale(-1, d) : d;
}

static void offer_direction(search *s, pe_vec3 d, pe_cylinder_meeting kind)
{
    d = along_offset(s, d);
    offer(s, separation_along(s, d), d, kind);
}

/* Across both axes; if they are parallel, along the offset. */
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
    pe_rim_query query;
    if (!pe_rim_query_make(rim, side->axis, s->offset, &query)) {
        return;
    }
    for (double half = -1; half < 2; half += 2) {
        pe_vec3 d;
        double value;
        if (pe_rim_peak(&query, half, to_beat(s) + side->radius, &d, &value)) {
            offer(s, value - side->radius, d, kind);
        }
    }
}

/* A direction, in relation to the axes. */
typedef struct view {
    pe_vec3 d;
    double rise_a, rise_b; /* a.d, b.d */
    double sine_a, sine_b; /* |a x d|, |b x d| */
    pe_vec3 out_a, out_b;  /* unit, from each axis towards the nearest point of its rim */
    pe_vec3 rims;          /* D minus both rims' radii: g without the half heights */
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

/* g on the sides of a.d = 0 and b.d = 0 that the signs give. */
static pe_vec3 gradient(const search *s, const view *v, double sign_a, double sign_b)
{
    pe_vec3 g = pe_madd(v->rims, -sign_a * s->a->half_height, s->a->axis);
    return pe_madd(g, -sign_b * s->b->half_height, s->b->axis);
}

/* Newton's step on the sphere: solves (R_A/s_A p p^T + R_B/s_B q q^T + s I) x = g across d, where p
 * and q are the rims' tangents. Either of its principal parts is at most `trust`, and as much
 * uphill where the matrix is not positive. Near an axis, or where the rims are nearly tangent, the
 * two curvatures differ by many powers of ten. The lesser one is computed from their product. */
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

/* The side of a.d = 0 where d lies. On the boundary, the side on which s may grow. */
static double side_of(const view *v, double rise, pe_vec3 axis)
{
    double place = fabs(rise) > 1e-13 ? rise : pe_dot(v->rims, axis);
    return place < 0 ? -1 : 1;
}

/* g at the direction itself. */
static pe_vec3 gradient_at(const search *s, const view *v)
{
    return gradient(s, v, side_of(v, v->rise_a, s->a->axis), side_of(v, v->rise_b, s->b->axis));
}

/* The unit direction after a step. */
static pe_vec3 moved(pe_vec3 d, double scale, pe_vec3 step)
{
    pe_vec3 next = pe_madd(d, scale, step);
    return pe_scale(1 / pe_length(next), next);
}

/* From an axis, where s has the shape of a cone's tip: a better direction, on the line along which
 * s grows. Returns d itself if it is not along an axis or no direction is better. */
static pe_vec3 leave_axis(const search *s, pe_vec3 d)
{
    const double tip = 1e-12;
    view v = look(s, d);
    bool at_a = v.sine_a < tip, at_b = v.sine_b < tip;
    if (!at_a && !at_b) {
        return d;
    }
    pe_vec3 g = gradient_at(s, &v);
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

/* How often a climb may step back. */
enum { FEW = 10, MANY = 60 };

/* Climbs from d to a maximum of two rims: while the value grows, then, where growth is within
 * rounding, as long as the steps shrink. Gives up farther than `reach` (rad) from the start, and
 * where steps must be cut short repeatedly: on a ridge, which is not a maximum of two rims. */
static pe_cylinder_gap climb(const search *s, pe_vec3 d, double reach, int most_failures)
{
    enum { MOST = 200 };
    pe_vec3 start = d;
    int failures = 0;
    double value = separation_along(s, d), last = HUGE_VAL, trust = 0.5;
    double rounding = 1e-16 * (pe_length(s->offset) + s->a->radius + s->b->radius);
    view v = look(s, d);
    pe_vec3 g = gradient_at(s, &v);
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
        g = gradient_at(s, &v);
    }
    return (pe_cylinder_gap){.distance = value, .normal = d, .kind = PE_RIMS};
}

/* Climbs from the best direction, which separates the cylinders, and from one away from the axes:
 * next to an axis, rounding may hide growth. True if g is along the direction that was reached: then
 * that is the only maximum. */
static bool climb_apart(search *s)
{
    double length;
    const pe_vec3 best = s->best.normal, across = pe_outward(s->a->axis, s->offset, &length);
    const pe_vec3 starts[2] = {leave_axis(s, best), moved(best, 1, across)};
    for (int k = 0; k < 2; ++k) {
        pe_cylinder_gap found = climb(s, starts[k], HUGE_VAL, MANY);
        view v = look(s, found.normal);
        pe_vec3 g = gradient_at(s, &v);
        double along = pe_dot(g, v.d);
        if (pe_length(pe_madd(g, -along, v.d)) <= 1e-12 * along) {
            s->best = is_flat(s) && found.distance <= to_beat(s) ? s->best : found;
            return true;
        }
        offer(s, found.distance, found.normal, PE_RIMS);
    }
    return false;
}

/* A square on a face of the cube: its centre. */
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

/* Whether a maximum of two rims, better than the best known, may lie within the angle from d whose
 * cosine and sine are given. */
static bool may_hold(const search *s, pe_vec3 d, double cosine, double sine)
{
    view v = look(s, d);
    pe_vec3 g = gradient_at(s, &v);
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

/* Next to an axis, cells are too coarse for the maxima that nearly parallel axes may have there. */
static void climb_from_axis(search *s, pe_vec3 axis)
{
    pe_cylinder_gap found = climb(s, leave_axis(s, along_offset(s, axis)), HUGE_VAL, MANY);
    offer(s, found.distance, found.normal, PE_RIMS);
}

/* Searches maxima of two rims over the half of the sphere along the offset. */
static void test_rims(search *s)
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
        /* From the centre of the sphere, a square of half width h lies within atan(sqrt(2) h). */
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
                if (s->best.distance > s->query->limit) {
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

/* A point of a that may realise the gap. */
static pe_vec3 point_on_a(const pe_cylinder *a, const pe_cylinder *b, const pe_cylinder_gap *gap)
{
    pe_vec3 d = gap->normal, to_a = pe_scale(-1, d);
    if (gap->kind == PE_CAP_B || gap->kind == PE_SIDE_B) {
        return pe_cylinder_support(a, d);
    }
    if (gap->kind != PE_SIDES) {
        return pe_madd(pe_cylinder_support(b, to_a), -gap->distance, d);
    }
    /* Where a's axis is nearest to b's; of parallel ones the midpoint of the part they share. */
    pe_vec3 offset = pe_sub(b->centre, a->centre), across = pe_across(b->axis, a->axis);
    double square = pe_dot(across, across), middle = pe_dot(offset, a->axis);
    double low = pe_max(-a->half_height, middle - b->half_height);
    double high = pe_min(a->half_height, middle + b->half_height);
    double z = square > 1e-30 ? pe_dot(offset, across) / square : 0.5 * (low + high);
    z = pe_max(-a->half_height, pe_min(a->half_height, z));
    return pe_madd(pe_madd(a->centre, z, a->axis), a->radius, d);
}

/* The distance (m) of the point x from a, or of the opposite point from b if that is larger. */
static double distance_outside(const search *s, pe_vec3 x)
{
    pe_vec3 y = pe_madd(x, s->best.distance, s->best.normal);
    double off_a = pe_length(pe_sub(pe_cylinder_nearest(s->a, x), x));
    return pe_max(off_a, pe_length(pe_sub(pe_cylinder_nearest(s->b, y), y)));
}

/* Whether the best direction is proven to be the best of all. If its nearest points lie in both
 * cylinders, it is when they are apart. If they overlap by f, either cylinder holds a ball that
 * touches its surface there. If the radii of the balls add up to at least f, the difference of the
 * cylinders holds a ball around the origin whose surface is nearest to the origin at that point. */
static bool is_proven(const search *s)
{
    const pe_cylinder_gap *best = &s->best;
    double tie = 1e-12 * s->query->size;
    pe_vec3 x = point_on_a(s->a, s->b, best), y = pe_madd(x, best->distance, best->normal);
    if (distance_outside(s, x) > tie) {
        return false;
    }
    return best->distance >= 0 ||
           pe_max(0, pe_cylinder_inner_ball(s->a, x, best->normal)) +
                   pe_max(0, pe_cylinder_inner_ball(s->b, y, best->normal)) >=
               -best->distance;
}

/* Moves x towards the intersection of a with b moved back by the gap, by alternate projection: the
 * nearest point in each cylinder in turn. Returns how far x is still outside b, in m. */
static double meet(const search *s, double enough, pe_vec3 *x)
{
    enum { MOST = 40 };
    pe_vec3 gap = pe_scale(s->best.distance, s->best.normal), on_b = *x;
    double outside = HUGE_VAL;
    for (int i = 0; i < MOST && outside > enough; ++i) {
        *x = pe_cylinder_nearest(s->a, on_b);
        on_b = pe_sub(pe_cylinder_nearest(s->b, pe_add(*x, gap)), gap);
        outside = pe_length(pe_sub(on_b, *x));
    }
    return outside;
}

/* The centre of the cap that is farther along d. */
static pe_vec3 cap_along(const pe_cylinder *c, pe_vec3 d)
{
    double height = pe_dot(d, c->axis) < 0 ? -c->half_height : c->half_height;
    return pe_madd(c->centre, height, c->axis);
}

/* Finds on_a and `outside`. If the direction is along an axis, except for rounding, a whole cap is
 * nearest, and the suggested point may lie anywhere on it. Then the projection from the centre of
 * either cap converges faster. */
static void find_point(search *s)
{
    pe_cylinder_gap *best = &s->best;
    pe_vec3 d = best->normal;
    const pe_vec3 starts[3] = {
        point_on_a(s->a, s->b, best),
        pe_madd(cap_along(s->b, pe_scale(-1, d)), -best->distance, d),
        cap_along(s->a, d),
    };
    double enough = 1e-12 * s->query->size;
    if (is_flat(s) && s->query->bias > 0) {
        /* The bias keeps the cap only if the suggested points meet. */
        best->on_a = starts[0];
        best->outside = distance_outside(s, starts[0]);
        return;
    }
    best->outside = HUGE_VAL;
    for (int i = 0; i < 3 && best->outside > enough; ++i) {
        pe_vec3 x = starts[i];
        double outside = meet(s, enough, &x);
        if (outside < best->outside) {
            best->outside = outside;
            best->on_a = x;
        }
    }
}

/* Makes the direction exact. Near the transition from one meeting to another both are equally good
 * to rounding, with directions that are only as exact as the root of that. For cylinders that are
 * apart, the nearest points give all digits. */
static void refine(search *s)
{
    enum { MOST = 100 };
    double size = s->query->size;
    pe_cylinder_gap *best = &s->best;
    find_point(s);
    if (best->distance < PE_NEAREST_POINT_GAP * size || is_flat(s)) {
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

bool pe_cylinder_pair_gap(const pe_cylinder *a, const pe_cylinder *b, const pe_gap_query *query,
                          pe_cylinder_gap *gap)
{
    double limit = query->limit;
    search s = {.a = a,
                .b = b,
                .query = query,
                .rounding = PE_MAXIMUM_ROUNDING * query->size,
                .best = {.distance = -HUGE_VAL}};
    s.offset = pe_sub(b->centre, a->centre);
    offer_direction(&s, a->axis, PE_CAP_A);
    offer_direction(&s, b->axis, PE_CAP_B);
    bool sure = s.best.distance <= limit && is_proven(&s);
    if (!sure && s.best.distance <= limit) {
        test_sides(&s);
        test_side_and_rim(&s, a, b, PE_SIDE_A);
        test_side_and_rim(&s, b, a, PE_SIDE_B);
        sure =
            s.best.distance <= limit && (is_proven(&s) || (s.best.distance > 0 && climb_apart(&s)));
        if (!sure && s.best.distance <= limit) {
            test_rims(&s);
            if (s.best.kind == PE_RIMS) {
                /* Rims that are nearly tangent to each other need many steps. */
                pe_cylinder_gap found = climb(&s, s.best.normal, HUGE_VAL, MANY);
                s.best = found.distance >= s.best.distance ? found : s.best;
            }
        }
    }
    if (s.best.distance <= limit) {
        refine(&s);
    }
    *gap = s.best;
    return s.best.distance <= limit;
}
