/* A cylinder against a cylinder.
 *
 * The direction comes from pe_cylinder_pair_gap. Each cylinder faces the other with a cap or with
 * the lowest line of its side; the points are those that hold the overlap of the two, as seen along
 * the direction: of two caps, points of either rim within the other cap, in directions that stay
 * with the first cylinder's cap when both are about parallel, its lowest point, and where the rims
 * cross; of a line, its ends. */
#include "cylinder_pair.h"
#include "hit_list.h"

/* In units of the smaller cylinder: points this far outside a rim are moved onto it. */
static const double SLACK = 1e-6;
/* In units of the smaller cylinder: a cap tilted by less, from end to end, has no lowest point. */
static const double LEVEL = 3e-9;
/* Least cosine between the direction and an axis at which it is a cap that faces the other. */
static const double FACING = 0.7;

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
    s.line = pe_madd(c->centre, c->radius, pe_cylinder_outward(c, toward, &sine));
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
    pe_hit_list patch;
} scene;

/* The side that is the patch's second shape adds its own points; the other moves them by the gap. */
static void add(scene *s, const side *of, pe_vec3 x, double gap, uint64_t feature)
{
    bool second = of == &s->b;
    pe_hit_list_add(&s->patch, second ? x : pe_madd(x, gap, s->patch.normal), gap, feature);
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
    }
    add(s, of, x, gap, feature);
}

/* Four points of one rim, in the directions t1 and across it, and the one lowest over the other. */
static void add_rim(scene *s, const side *of, const side *in, pe_vec3 t1, uint64_t kind,
                    uint64_t lowest)
{
    const pe_cylinder *c = &of->c;
    double length, sine;
    t1 = pe_scale(c->radius, pe_cylinder_outward(c, t1, &length));
    pe_vec3 t2 = pe_cross(c->axis, t1);
    add_rim_point(s, of, in, pe_add(of->cap, t1), name(kind, 0));
    add_rim_point(s, of, in, pe_add(of->cap, t2), name(kind, 1));
    add_rim_point(s, of, in, pe_sub(of->cap, t1), name(kind, 2));
    add_rim_point(s, of, in, pe_sub(of->cap, t2), name(kind, 3));
    pe_vec3 out = pe_cylinder_outward(c, in->c.axis, &sine);
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
    pe_vec3 t1, t2;
    pe_tangents(s->patch.normal, &t1, &t2);
    add_rim(s, &s->a, &s->b, t1, RIM_A, LOWEST_A);
    add_rim(s, &s->b, &s->a, t1, RIM_B, LOWEST_B);
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
    double u2 = pe_dot(u, u), xu = pe_dot(x, u), root2 = xu * xu - u2 * (pe_dot(x, x) - r * r);
    if (!(root2 > 0)) {
        return;
    }
    double low = pe_max(-half, (-xu - sqrt(root2)) / u2);
    double high = pe_min(half, (-xu + sqrt(root2)) / u2);
    if (low <= high) {
        pe_vec3 p = pe_madd(line->line, low, line->c.axis);
        pe_vec3 q = pe_madd(line->line, high, line->c.axis);
        add(s, line, p, -to_cap(cap, p), name(LINE_END, 0));
        add(s, line, q, -to_cap(cap, q), name(LINE_END, 1));
    }
}

/* How far along `toward` a point, near the axis, is from the side's surface; false near its
 * silhouette or beyond its ends. */
static bool to_side(const side *s, double rounding, pe_vec3 x, double *t)
{
    const pe_cylinder *c = &s->c;
    pe_vec3 p = pe_cylinder_across(c, pe_sub(x, c->centre)), e = pe_cylinder_across(c, s->toward);
    double e2 = pe_dot(e, e), along = pe_dot(p, e), r2 = c->radius * c->radius;
    double root2 = along * along - e2 * (pe_dot(p, p) - r2);
    if (!(root2 > 0.75 * r2 * e2)) {
        return false;
    }
    *t = (-along + sqrt(root2)) / e2;
    double z = pe_dot(pe_sub(pe_madd(x, *t, s->toward), c->centre), c->axis);
    return fabs(z) <= c->half_height + rounding;
}

/* The part of a's axis that b lies beside, in m from a's centre: end[0] to end[1] if not empty. */
static void beside(const pe_cylinder *a, const pe_cylinder *b, double end[2])
{
    double middle = pe_dot(pe_sub(b->centre, a->centre), a->axis);
    double reach = b->half_height * fabs(pe_dot(a->axis, b->axis));
    end[0] = pe_max(-a->half_height, middle - reach);
    end[1] = pe_min(a->half_height, middle + reach);
}

/* Ends of the part of b's side that lies along a's. */
static void add_sides(scene *s)
{
    const pe_cylinder *a = &s->a.c, *b = &s->b.c;
    pe_vec3 d = s->patch.normal, offset = pe_sub(b->centre, a->centre);
    pe_vec3 lateral = pe_cross(a->axis, d);
    double cosine = pe_dot(a->axis, b->axis), middle = pe_dot(offset, a->axis), end[2];
    double rounding = 1e-10 * s->patch.size;
    beside(a, b, end);
    for (int k = 0; k < 2 && end[0] <= end[1] && cosine != 0; ++k) {
        pe_vec3 x = pe_madd(a->centre, end[k], a->axis);
        pe_vec3 y = pe_madd(b->centre, (end[k] - middle) / cosine, b->axis);
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

/* Adds the point that realises the gap if none of the others does. */
static void add_nearest(scene *s, pe_cylinder_meeting kind)
{
    const pe_cylinder *a = &s->a.c, *b = &s->b.c;
    const side *of = kind == PE_CAP_B || kind == PE_SIDE_B ? &s->a : &s->b;
    pe_vec3 x = pe_cylinder_support(&of->c, of->toward);
    if (kind == PE_SIDES) {
        /* Where a's axis is nearest to b's; of parallel ones the middle of what they share. */
        pe_vec3 across = pe_cylinder_across(b, a->axis);
        double sine2 = pe_dot(across, across), end[2];
        beside(a, b, end);
        double z = 0.5 * (end[0] + end[1]);
        if (sine2 > 1e-30) {
            z = pe_dot(pe_sub(b->centre, a->centre), across) / sine2;
            z = pe_max(end[0], pe_min(end[1], z));
        }
        of = &s->a;
        x = pe_madd(pe_madd(a->centre, z, a->axis), a->radius, s->a.toward);
    }
    x = of == &s->b ? x : pe_madd(x, s->patch.least, s->patch.normal);
    pe_hit_list_add_nearest(&s->patch, x, name(NEAREST, (int)kind));
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

void pe_collide_cylinder_cylinder(pe_placed a, pe_placed b, double margin, pe_hits *hits)
{
    pe_cylinder ca = pe_cylinder_seen(a, a.pose), cb = pe_cylinder_seen(b, a.pose);
    double size = pe_min(a.size, b.size);
    pe_cylinder_gap gap;
    if (!pe_cylinder_pair_gap(&ca, &cb, size, margin, &gap)) {
        return;
    }
    scene s = {
        .a = make_side(&ca, gap.normal),
        .b = make_side(&cb, pe_scale(-1, gap.normal)),
        .slack = SLACK * size,
        .patch = pe_hit_list_begin(gap.normal, gap.distance, margin, size),
    };
    add_points(&s);
    add_nearest(&s, gap.kind);
    pe_hit_list_finish(&s.patch, a.pose, false, hits);
    hits->normal_on_b = gap.kind == PE_CAP_B;
}
