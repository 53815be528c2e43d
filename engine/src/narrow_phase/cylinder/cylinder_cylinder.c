/* A cylinder against a cylinder.
 *
 * The direction comes from pe_cylinder_pair_gap. Each cylinder faces the other with a cap or with
 * the lowest line of its side. The points bound the overlap of the two, seen along the direction.
 * Of two caps they are: points of either rim within the other cap, in directions that stay with the
 * first cylinder's cap when both are nearly parallel; the lowest point of each rim; and the points
 * where the rims cross. For a line they are its ends. */
#include "cylinder_gap.h"
#include "narrow_phase/feature_id.h"
#include "narrow_phase/points.h"
#include "narrow_phase/tolerances.h"

/* Kinds of points, for their feature ids. */
enum { RIM_A = 1, RIM_B, LOWEST_A, LOWEST_B, CROSSING, LINE_END, NEAREST };

static uint64_t feature_of(uint64_t kind, int point)
{
    return pe_cylinder_feature(kind, 0, point);
}

/* A cylinder and its features that face the other one. */
typedef struct side {
    pe_cylinder c;
    pe_vec3 toward;    /* unit: the direction to the other one */
    double rise;       /* axis . toward */
    pe_vec3 cap, line; /* centre of the facing cap, midpoint of the lowest line */
} side;

static side make_side(const pe_cylinder *c, pe_vec3 toward)
{
    side s = {.c = *c, .toward = toward, .rise = pe_dot(c->axis, toward)};
    s.cap = pe_madd(c->centre, s.rise < 0 ? -c->half_height : c->half_height, c->axis);
    double sine;
    s.line = pe_madd(c->centre, c->radius, pe_outward(c->axis, toward, &sine));
    return s;
}

/* The distance along `toward` from x to the cap's plane. */
static double to_cap(const side *s, pe_vec3 x)
{
    return pe_dot(pe_sub(s->cap, x), s->c.axis) / s->rise;
}

/* The two sides and the points found so far. */
typedef struct contact {
    side a, b;
    double slack;
    pe_point_list list;
} contact;

/* Adds a point of one side. The list wants points of b: those of a are moved by the gap. */
static void add(contact *s, const side *of, pe_vec3 x, double gap, uint64_t feature)
{
    bool second = of == &s->b;
    pe_point_list_add(&s->list, second ? x : pe_madd(x, gap, s->list.normal), gap, feature);
}

/* Adds a point of one cap's rim if it lies in the other cap. A point just outside is moved onto the
 * rim of the other cap. */
static void add_rim_point(contact *s, const side *of, const side *in, pe_vec3 x, uint64_t feature)
{
    double gap = -to_cap(in, x), r = in->c.radius;
    pe_vec3 from = pe_sub(pe_madd(x, -gap, in->toward), in->cap);
    double beyond = pe_length(from) - r;
    if (beyond > s->slack) {
        return;
    }
    if (beyond > 0) {
        x = pe_madd(x, -beyond / (r + beyond), from);
        x = pe_madd(x, to_cap(of, x), of->toward);
        gap = -to_cap(in, x);
        if (pe_length(pe_sub(x, of->cap)) > of->c.radius + PE_CYLINDER_TIE * s->list.size) {
            return;
        }
    }
    add(s, of, x, gap, feature);
}

/* Adds four points of one rim, in directions of the first cylinder's axes, and the lowest one over
 * the other cap. */
static void add_rim(contact *s, const side *of, const side *in, uint64_t kind, uint64_t lowest)
{
    const pe_cylinder *c = &of->c;
    double sine;
    pe_vec3 x = pe_v3(1, 0, 0), arm[4];
    pe_outward(c->axis, x, &sine);
    pe_cylinder_rim(c, sine > 0.5 ? x : pe_v3(0, 1, 0), arm);
    for (int k = 0; k < 4; ++k) {
        add_rim_point(s, of, in, pe_add(of->cap, arm[k]), feature_of(kind, k));
    }
    pe_vec3 out = pe_outward(c->axis, in->c.axis, &sine);
    if (2 * c->radius * sine > PE_LEVEL_CAP * s->list.size) {
        double sign = in->rise < 0 ? 1 : -1; /* against the other cap's outward normal */
        add_rim_point(s, of, in, pe_madd(of->cap, sign * c->radius, out), feature_of(lowest, 0));
    }
}

/* Moves x, which is on a's rim, along that rim to where it crosses b's, by Newton's method. */
static void slide_to_crossing(const contact *s, pe_vec3 *x)
{
    enum { MOST = 4 };
    const side *a = &s->a, *b = &s->b;
    for (int i = 0; i < MOST; ++i) {
        pe_vec3 arm = pe_sub(*x, a->cap), along = pe_cross(a->c.axis, arm);
        pe_vec3 from = pe_sub(pe_madd(*x, to_cap(b, *x), b->toward), b->cap);
        double distance = pe_length(from), beyond = distance - b->c.radius;
        /* Half of how fast the squared distance grows along the rim. */
        double growth =
            pe_dot(pe_madd(along, -pe_dot(along, b->c.axis) / b->rise, b->toward), from);
        if (fabs(beyond) <= PE_CYLINDER_EXACT * s->list.size || growth == 0) {
            return;
        }
        arm = pe_madd(arm, -beyond * distance / growth, along);
        *x = pe_madd(a->cap, a->c.radius / pe_length(arm), arm);
    }
}

/* Adds the points where the rims cross, seen along the direction. Of parallel caps they are those
 * of two circles. A point is left out if the caps are so tilted that it is not near both rims. */
static void add_crossings(contact *s)
{
    const side *a = &s->a, *b = &s->b;
    pe_vec3 between = pe_sub(b->cap, a->cap);
    between = pe_madd(between, -pe_dot(between, a->c.axis) / a->rise, a->toward);
    double ra = a->c.radius, rb = b->c.radius, d2 = pe_dot(between, between);
    double t = 0.5 * (d2 + ra * ra - rb * rb); /* d times the distance to the common chord */
    double chord2 = ra * ra * d2 - t * t;
    if (!(d2 > s->slack * s->slack) || !(chord2 > 2 * s->slack * ra * d2)) {
        return;
    }
    pe_vec3 middle = pe_madd(a->cap, t / d2, between);
    pe_vec3 half = pe_scale(sqrt(chord2) / d2, pe_cross(a->c.axis, between));
    for (int k = 0; k < 2; ++k) {
        pe_vec3 x = pe_madd(middle, k == 0 ? 1 : -1, half);
        slide_to_crossing(s, &x);
        add_rim_point(s, a, b, x, feature_of(CROSSING, k));
    }
}

/* Adds the ends of the part of one cylinder's lowest line that lies in the other's cap. */
static void add_line_in_cap(contact *s, const side *line, const side *cap)
{
    /* In the cap's plane, from its centre: x + z u. */
    pe_vec3 x = pe_sub(line->line, cap->cap), u = line->c.axis;
    x = pe_madd(x, -pe_dot(x, cap->c.axis) / cap->rise, cap->toward);
    u = pe_madd(u, -pe_dot(u, cap->c.axis) / cap->rise, cap->toward);
    double r = cap->c.radius, half = line->c.half_height;
    double u2 = pe_dot(u, u), middle = -pe_dot(x, u) / u2;
    double past = pe_length(pe_madd(x, middle, u)) - r; /* of the point nearest to the centre */
    if (past > PE_CYLINDER_TIE * s->list.size) {
        return;
    }
    double root = sqrt(pe_max(0, -past * (2 * r + past)) / u2);
    double low = pe_max(-half, middle - root), high = pe_min(half, middle + root);
    if (low <= high) {
        pe_vec3 p = pe_madd(line->line, low, line->c.axis);
        pe_vec3 q = pe_madd(line->line, high, line->c.axis);
        add(s, line, p, -to_cap(cap, p), feature_of(LINE_END, 0));
        add(s, line, q, -to_cap(cap, q), feature_of(LINE_END, 1));
    }
}

/* *t is the distance along `toward` from x, near the axis, to the side's surface. False near its
 * silhouette or beyond its ends. */
static bool to_side(const side *s, double rounding, pe_vec3 x, double *t)
{
    double unused;
    if (!pe_cylinder_pierce(&s->c, x, s->toward, &unused, t)) {
        return false;
    }
    double z = pe_dot(pe_sub(pe_madd(x, *t, s->toward), s->c.centre), s->c.axis);
    return fabs(z) <= s->c.half_height + rounding;
}

/* The coordinate along a's axis, from its centre, where the line along the direction from the point
 * at z of that axis meets the plane of b's axis. */
static double opposite(const contact *s, double z)
{
    pe_vec3 offset = pe_sub(s->b.c.centre, s->a.c.centre);
    return z + pe_dot(offset, s->list.normal) * s->a.rise;
}

/* The part of a's axis, in m from its centre, from which lines along the direction pass through
 * both sides: from end[0] to end[1] if not empty. */
static void common_part(const contact *s, double end[2])
{
    const pe_cylinder *a = &s->a.c, *b = &s->b.c;
    double cosine = pe_dot(a->axis, b->axis), shift = opposite(s, 0);
    double middle = pe_dot(pe_sub(b->centre, a->centre), a->axis) - shift;
    /* The surfaces are farther along either axis than the points of the axes below them. */
    double on_a = a->radius * s->a.rise, on_b = b->radius * s->b.rise;
    double b0 = middle + (-b->half_height - on_b) * cosine;
    double b1 = middle + (b->half_height - on_b) * cosine;
    end[0] = pe_max(-a->half_height - on_a, pe_min(b0, b1));
    end[1] = pe_min(a->half_height - on_a, pe_max(b0, b1));
}

/* Adds the ends of the part of b's side that lies along a's. */
static void add_sides(contact *s)
{
    const pe_cylinder *a = &s->a.c, *b = &s->b.c;
    pe_vec3 d = s->list.normal, offset = pe_sub(b->centre, a->centre);
    pe_vec3 lateral = pe_cross(a->axis, d);
    double cosine = pe_dot(a->axis, b->axis), middle = pe_dot(offset, a->axis), end[2];
    double rounding = PE_CYLINDER_TIE * s->list.size;
    common_part(s, end);
    for (int k = 0; k < 2 && end[0] <= end[1] && cosine != 0; ++k) {
        pe_vec3 x = pe_madd(a->centre, end[k], a->axis);
        pe_vec3 y = pe_madd(b->centre, (opposite(s, end[k]) - middle) / cosine, b->axis);
        /* Between the two axes, nearer to the thinner cylinder's. */
        double lateral_gap = pe_dot(pe_sub(y, x), lateral),
               share = a->radius / (a->radius + b->radius);
        double from_x, from_y;
        x = pe_madd(x, lateral_gap * share, lateral);
        y = pe_madd(x, pe_dot(pe_sub(y, x), d), d);
        if (to_side(&s->a, rounding, x, &from_x) && to_side(&s->b, rounding, y, &from_y)) {
            double gap = pe_dot(pe_sub(y, x), d) - from_x - from_y;
            add(s, &s->a, pe_madd(x, from_x, d), gap, feature_of(LINE_END, k));
        }
    }
}

/* Adds the point that realises the gap if none of the others does. False if the point is not in
 * both cylinders, because of the bias towards caps. Then it is added only `at_any_rate`. */
static bool add_nearest(contact *s, const pe_cylinder_gap *gap, bool at_any_rate)
{
    if (pe_point_list_has_nearest(&s->list)) {
        return true;
    }
    bool sound = gap->outside <= PE_CYLINDER_TIE * s->list.size;
    if (sound || at_any_rate) {
        pe_vec3 x = pe_madd(gap->on_a, gap->distance, s->list.normal);
        pe_point_list_add(&s->list, x, gap->distance, feature_of(NEAREST, 0));
    }
    return sound;
}

static void add_points(contact *s)
{
    bool cap_a = fabs(s->a.rise) >= PE_CAP_FACING, cap_b = fabs(s->b.rise) >= PE_CAP_FACING;
    if (cap_a && cap_b) {
        add_rim(s, &s->a, &s->b, RIM_A, LOWEST_A);
        add_rim(s, &s->b, &s->a, RIM_B, LOWEST_B);
        add_crossings(s);
    } else if (cap_a) {
        add_line_in_cap(s, &s->b, &s->a);
    } else if (cap_b) {
        add_line_in_cap(s, &s->a, &s->b);
    } else {
        add_sides(s);
    }
}

void pe_collide_cylinder_cylinder(pe_placed a, pe_placed b, double margin,
                                  pe_pair_manifold *manifold)
{
    pe_cylinder ca = pe_cylinder_in_axes(a, a.pose), cb = pe_cylinder_in_axes(b, a.pose);
    double size = pe_min(a.size, b.size);
    pe_gap_query query = {.size = size, .bias = PE_FLAT_BIAS * size, .limit = margin};
    pe_cylinder_gap gap;
    contact s = {.slack = PE_CAP_SLACK * size};
    bool done = false;
    for (int pass = 0; pass < 2 && !done; ++pass) {
        if (!pe_cylinder_pair_gap(&ca, &cb, &query, &gap)) {
            return;
        }
        s.a = make_side(&ca, gap.normal);
        s.b = make_side(&cb, pe_scale(-1, gap.normal));
        s.list = pe_point_list_begin(gap.normal, gap.distance, margin, size);
        add_points(&s);
        done = add_nearest(&s, &gap, pass == 1);
        query.bias = 0; /* the bias kept a cap that the other cylinder does not meet */
    }
    pe_point_list_finish(&s.list, a.pose, false, manifold);
    manifold->normal_on_b = gap.kind == PE_CAP_B;
}
