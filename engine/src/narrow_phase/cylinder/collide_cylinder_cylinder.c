/* A cylinder against a cylinder.
 *
 * The direction comes from pe_cylinder_pair_gap. Each cylinder faces the other with a cap or with
 * the lowest line of its side; the points are those that hold the overlap of the two, as seen along
 * the direction: of two caps, points of either rim within the other cap, in directions that stay
 * with the first cylinder's cap when both are about parallel, its lowest point, and where the rims
 * cross; of a line, its ends. */
#include "cylinder_pair.h"
#include "narrow_phase/point_list.h"

/* In units of the smaller cylinder: points this far outside a rim are moved onto it. */
static const double SLACK = 1e-6;
/* In units of the smaller cylinder: a cap tilted by less, from end to end, has no lowest point. */
static const double LEVEL = 6e-9;
/* In units of the smaller cylinder: where a point is, but for rounding. */
static const double TIE = 4e-10;
/* Least cosine between the direction and an axis at which it is a cap that faces the other. */
static const double FACING = 0.7;

/* In units of the smaller cylinder: a cap is left only for what is better by this, so that what
 * rests on one does not leave it for rounding. */
static const double BIAS = 4e-10;

/* Kinds of points, for their names. */
enum { RIM_A = 1, RIM_B, LOWEST_A, LOWEST_B, CROSSING, LINE_END, NEAREST };

static uint64_t name(uint64_t kind, int point)
{
    return kind << 56 | (uint64_t)(uint32_t)point;
}

/* A cylinder and what it faces the other one with. */
typedef struct side {
    pe_cylinder c;
    pe_vec3 toward;    /* unit: the direction to the other one */
    double rise;       /* axis . toward */
    pe_vec3 cap, line; /* middles of the facing cap and of the lowest line */
} side;

static side make_side(const pe_cylinder *c, pe_vec3 toward)
{
    side s = {.c = *c, .toward = toward, .rise = pe_dot(c->axis, toward)};
    s.cap = pe_madd(c->centre, s.rise < 0 ? -c->half_height : c->half_height, c->axis);
    double sine;
    s.line = pe_madd(c->centre, c->radius, pe_outward(c->axis, toward, &sine));
    return s;
}

static bool faces_with_cap(const side *s)
{
    return fabs(s->rise) >= FACING;
}

/* How far along `toward` the cap's plane is from x. */
static double to_cap(const side *s, pe_vec3 x)
{
    return pe_dot(pe_sub(s->cap, x), s->c.axis) / s->rise;
}

typedef struct scene {
    side a, b;
    double slack;
    pe_point_list patch;
} scene;

/* The side that is the patch's second shape adds its own points; the other moves them by the gap.
 */
static void add(scene *s, const side *of, pe_vec3 x, double gap, uint64_t feature)
{
    bool second = of == &s->b;
    pe_point_list_add(&s->patch, second ? x : pe_madd(x, gap, s->patch.normal), gap, feature);
}

/* A point of one cap's rim, if it lies in the other cap; if just outside, it is moved in. */
static void add_rim_point(scene *s, const side *of, const side *in, pe_vec3 x, uint64_t feature)
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
        if (pe_length(pe_sub(x, of->cap)) > of->c.radius + TIE * s->patch.size) {
            return;
        }
    }
    add(s, of, x, gap, feature);
}

/* Four points of one rim, in directions of the first cylinder's axes, and the one lowest over the
 * other cap. */
static void add_rim(scene *s, const side *of, const side *in, uint64_t kind, uint64_t lowest)
{
    const pe_cylinder *c = &of->c;
    double sine;
    pe_vec3 t1 = pe_outward(c->axis, pe_v3(1, 0, 0), &sine);
    t1 = sine > 0.5 ? t1 : pe_outward(c->axis, pe_v3(0, 1, 0), &sine);
    t1 = pe_scale(c->radius, t1);
    pe_vec3 t2 = pe_cross(c->axis, t1);
    add_rim_point(s, of, in, pe_add(of->cap, t1), name(kind, 0));
    add_rim_point(s, of, in, pe_add(of->cap, t2), name(kind, 1));
    add_rim_point(s, of, in, pe_sub(of->cap, t1), name(kind, 2));
    add_rim_point(s, of, in, pe_sub(of->cap, t2), name(kind, 3));
    pe_vec3 out = pe_outward(c->axis, in->c.axis, &sine);
    if (2 * c->radius * sine > LEVEL * s->patch.size) {
        double sign = in->rise < 0 ? 1 : -1; /* against the other cap's outward normal */
        add_rim_point(s, of, in, pe_madd(of->cap, sign * c->radius, out), name(lowest, 0));
    }
}

/* Where the rims cross, seen along the direction; exact for parallel caps, and left out where the
 * caps are so tilted that it is not near both rims. */
static void add_crossings(scene *s)
{
    const side *a = &s->a, *b = &s->b;
    pe_vec3 between = pe_sub(b->cap, a->cap);
    between = pe_madd(between, -pe_dot(between, a->c.axis) / a->rise, a->toward);
    double ra = a->c.radius, rb = b->c.radius, d2 = pe_dot(between, between);
    double t = 0.5 * (d2 + ra * ra - rb * rb); /* d times the way to the common chord */
    double chord2 = ra * ra * d2 - t * t;
    if (!(d2 > s->slack * s->slack) || !(chord2 > 2 * s->slack * ra * d2)) {
        return;
    }
    pe_vec3 middle = pe_madd(a->cap, t / d2, between);
    pe_vec3 half = pe_scale(sqrt(chord2) / d2, pe_cross(a->c.axis, between));
    add_rim_point(s, a, b, pe_add(middle, half), name(CROSSING, 0));
    add_rim_point(s, a, b, pe_sub(middle, half), name(CROSSING, 1));
}

static void add_caps(scene *s)
{
    add_rim(s, &s->a, &s->b, RIM_A, LOWEST_A);
    add_rim(s, &s->b, &s->a, RIM_B, LOWEST_B);
    add_crossings(s);
}

/* Ends of the part of one's lowest line that lies in the other's cap. */
static void add_line_in_cap(scene *s, const side *line, const side *cap)
{
    /* In the cap's plane, from its middle: x + z u. */
    pe_vec3 x = pe_sub(line->line, cap->cap), u = line->c.axis;
    x = pe_madd(x, -pe_dot(x, cap->c.axis) / cap->rise, cap->toward);
    u = pe_madd(u, -pe_dot(u, cap->c.axis) / cap->rise, cap->toward);
    double r = cap->c.radius, half = line->c.half_height;
    double u2 = pe_dot(u, u), middle = -pe_dot(x, u) / u2;
    double past = pe_length(pe_madd(x, middle, u)) - r; /* of the point nearest to the middle */
    if (past > TIE * s->patch.size) {
        return;
    }
    double root = sqrt(pe_max(0, -past * (2 * r + past)) / u2);
    double low = pe_max(-half, middle - root), high = pe_min(half, middle + root);
    if (low <= high) {
        pe_vec3 p = pe_madd(line->line, low, line->c.axis);
        pe_vec3 q = pe_madd(line->line, high, line->c.axis);
        add(s, line, p, -to_cap(cap, p), name(LINE_END, 0));
        add(s, line, q, -to_cap(cap, q), name(LINE_END, 1));
    }
}

/* How far along `toward` a point near the axis is from the side's surface; false near its
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

/* How far along a's axis, from its centre, the line from the point at z of that axis along the
 * direction meets the plane that b's axis is in. */
static double opposite(const scene *s, double z)
{
    pe_vec3 offset = pe_sub(s->b.c.centre, s->a.c.centre);
    return z + pe_dot(offset, s->patch.normal) * s->a.rise;
}

/* The part of a's axis, in m from its centre, from which the lines along the direction go through
 * both sides: from end[0] to end[1] if not empty. */
static void beside(const scene *s, double end[2])
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

/* Ends of the part of b's side that lies along a's. */
static void add_sides(scene *s)
{
    const pe_cylinder *a = &s->a.c, *b = &s->b.c;
    pe_vec3 d = s->patch.normal, offset = pe_sub(b->centre, a->centre);
    pe_vec3 lateral = pe_cross(a->axis, d);
    double cosine = pe_dot(a->axis, b->axis), middle = pe_dot(offset, a->axis), end[2];
    double rounding = TIE * s->patch.size;
    beside(s, end);
    for (int k = 0; k < 2 && end[0] <= end[1] && cosine != 0; ++k) {
        pe_vec3 x = pe_madd(a->centre, end[k], a->axis);
        pe_vec3 y = pe_madd(b->centre, (opposite(s, end[k]) - middle) / cosine, b->axis);
        /* Between the two axes, nearer to the thinner cylinder's. */
        double aside = pe_dot(pe_sub(y, x), lateral), share = a->radius / (a->radius + b->radius);
        double from_x, from_y;
        x = pe_madd(x, aside * share, lateral);
        y = pe_madd(x, pe_dot(pe_sub(y, x), d), d);
        if (to_side(&s->a, rounding, x, &from_x) && to_side(&s->b, rounding, y, &from_y)) {
            double gap = pe_dot(pe_sub(y, x), d) - from_x - from_y;
            add(s, &s->a, pe_madd(x, from_x, d), gap, name(LINE_END, k));
        }
    }
}

/* Adds the point that realises the gap if none of the others does. False where, for the bias
 * towards caps, it is not in both cylinders; then it is added `at_any_rate` only. */
static bool add_nearest(scene *s, const pe_cylinder_gap *gap, bool at_any_rate)
{
    if (pe_point_list_has_nearest(&s->patch)) {
        return true;
    }
    bool sound = gap->aside <= TIE * s->patch.size;
    if (sound || at_any_rate) {
        pe_vec3 x = pe_madd(gap->on_a, gap->distance, s->patch.normal);
        pe_point_list_add(&s->patch, x, gap->distance, name(NEAREST, 0));
    }
    return sound;
}

static void add_points(scene *s)
{
    bool cap_a = faces_with_cap(&s->a), cap_b = faces_with_cap(&s->b);
    if (cap_a && cap_b) {
        add_caps(s);
    } else if (cap_a) {
        add_line_in_cap(s, &s->b, &s->a);
    } else if (cap_b) {
        add_line_in_cap(s, &s->a, &s->b);
    } else {
        add_sides(s);
    }
}

void pe_collide_cylinder_cylinder(pe_placed a, pe_placed b, double margin, pe_pair_manifold *hits)
{
    pe_cylinder ca = pe_cylinder_seen(a, a.pose), cb = pe_cylinder_seen(b, a.pose);
    double size = pe_min(a.size, b.size), bias = BIAS * size;
    pe_cylinder_gap gap;
    scene s = {.slack = SLACK * size};
    bool done = false;
    for (int pass = 0; pass < 2 && !done; ++pass) {
        if (!pe_cylinder_pair_gap(&ca, &cb, size, bias, margin, &gap)) {
            return;
        }
        s.a = make_side(&ca, gap.normal);
        s.b = make_side(&cb, pe_scale(-1, gap.normal));
        s.patch = pe_point_list_begin(gap.normal, gap.distance, margin, size);
        add_points(&s);
        done = add_nearest(&s, &gap, pass == 1);
        bias = 0; /* it took a cap that the other cylinder only passes by */
    }
    pe_point_list_finish(&s.patch, a.pose, false, hits);
    hits->normal_on_b = gap.kind == PE_CAP_B;
}
