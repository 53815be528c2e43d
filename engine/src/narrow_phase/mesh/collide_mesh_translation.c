/* One way out of an overlap where no features show it.
 *
 * A core's ends that are inside leave by the nearest point of the surface, and what lies wholly
 * inside by the nearest faces. Where the surfaces cross, they do along closed curves. The vector
 * area of a curve is that of the part of a's surface within b: along it the volume of the overlap
 * shrinks most, for the derivative of a volume by a translation is the surface's vector area. Each
 * curve gives a touch: its depth is what lies in both along its normal at its centre, or if that is
 * not in both, the most of its points. Of a rod through a plate the curves' areas cancel each
 * other. Then, and of convex solids, the normal is that, of the triangles that cross, along which
 * the solids as a whole reach least past each other, so that it never leads further in; the depth
 * is the most that lies along it, in both, where they cross. */
#include "collide_mesh.h"

/* In units of the sum of all curves' areas: vector areas that do not cancel each other. */
static const double NOT_CANCELLED = 0.25;
/* In units of the squared length of a curve, of which a circle has 1 / (4 pi): a vector area that
 * tells a direction. */
static const double LEAST_AREA = 0.005;
/* In units of the smaller solid: how near the ends of two parts of one curve are. */
static const double JOINED = 1e-4;

/* How far the solids reach past each other along the unit direction n, from a to b. */
static double overlap(const pe_solid_pair *pair, pe_vec3 n)
{
    pe_vec3 back = pe_unrotate(&pair->trees.turn, n);
    return pe_dot(back, pe_solid_support(&pair->a, back)) + pe_dot(n, pair->trees.offset) -
           pe_dot(n, pe_solid_support(&pair->b, pe_scale(-1, n)));
}

/* The ends of a core that are inside leave by the nearest point of the surface. */
static bool find_way_out_of_ends(const pe_solid_pair *pair, pe_touches *list)
{
    bool found = false;
    for (int i = 0; i < pair->a.vertex_count; ++i) {
        pe_vec3 x = pe_add(pe_rotate(&pair->trees.turn, pair->a.vertices[i]), pair->trees.offset);
        if (!pe_solid_holds(&pair->b, x)) {
            continue;
        }
        pe_vec3 in = pe_sub(x, pe_solid_nearest_point(&pair->b, x));
        double depth = pe_length(in);
        if (depth > 0) {
            pe_touch touch = {
                .feature = pe_touch_feature(PE_VERTEX_VERTEX, i, pair->b.vertex_count),
                .kind = PE_VERTEX_VERTEX,
                .normal = pe_scale(1 / depth, in),
                .on_a = x,
                .separation = -depth - pair->radius,
            };
            pe_touches_add(list, &touch);
            found = true;
        }
    }
    return found;
}

/* A part of a curve, in two triangles. Run through from p to q, what of a lies in b is on its left,
 * seen from outside a. */
typedef struct part {
    pe_vec3 p, q;
    int face_a, face_b;
    int curve; /* the first part of its curve */
} part;

typedef struct rim {
    part *parts;
    int count, capacity;
    pe_touches *list; /* its memory, and whether that failed */
} rim;

static void count_part(void *context, const pe_crossing *c)
{
    rim *r = context;
    r->capacity += c->count > 1;
}

static void add_part(void *context, const pe_crossing *c)
{
    rim *r = context;
    pe_vec3 along = pe_cross(c->a->normal, c->b->normal);
    int first = 0, last = 0;
    for (int i = 1; i < c->count; ++i) {
        first = pe_dot(along, c->where[i]) < pe_dot(along, c->where[first]) ? i : first;
        last = pe_dot(along, c->where[i]) > pe_dot(along, c->where[last]) ? i : last;
    }
    if (first != last && r->count < r->capacity) {
        r->parts[r->count] =
            (part){c->where[first], c->where[last], c->a->face, c->b->face, r->count};
        r->count += 1;
    }
}

static bool are_joined(const part *i, const part *j, double reach)
{
    pe_vec3 d = pe_sub(i->q, j->p), e = pe_sub(i->p, j->q);
    return pe_dot(d, d) <= reach * reach || pe_dot(e, e) <= reach * reach;
}

/* Gives all parts that hang together the number of their first one. */
static void find_curves(rim *r, double reach)
{
    for (int i = 0; i < r->count; ++i) {
        for (int j = 0; j < i; ++j) {
            int from = r->parts[i].curve, to = r->parts[j].curve;
            if (from == to || !are_joined(&r->parts[i], &r->parts[j], reach)) {
                continue;
            }
            for (int k = 0; k <= i; ++k) {
                int curve = r->parts[k].curve;
                r->parts[k].curve = curve == from || curve == to ? (from < to ? from : to) : curve;
            }
        }
    }
}

typedef struct curve {
    pe_vec3 area, centre; /* m^2, m */
    double length;
    int face_a, face_b; /* of its part with the lowest numbers */
} curve;

static curve measure_curve(const rim *r, int first)
{
    pe_vec3 origin = r->parts[first].p;
    curve c = {.face_a = r->parts[first].face_a, .face_b = r->parts[first].face_b};
    for (int i = first; i < r->count; ++i) {
        const part *one = &r->parts[i];
        if (one->curve != first) {
            continue;
        }
        pe_vec3 p = pe_sub(one->p, origin), q = pe_sub(one->q, origin);
        double length = pe_length(pe_sub(q, p));
        c.area = pe_madd(c.area, 0.5, pe_cross(p, q));
        c.centre = pe_madd(c.centre, 0.5 * length, pe_add(p, q));
        c.length += length;
        if (one->face_a < c.face_a || (one->face_a == c.face_a && one->face_b < c.face_b)) {
            c.face_a = one->face_a;
            c.face_b = one->face_b;
        }
    }
    c.centre = c.length > 0 ? pe_madd(origin, 1 / c.length, c.centre) : origin;
    return c;
}

static pe_vec3 in_axes_of_a(const pe_solid_pair *pair, pe_vec3 x)
{
    return pe_unrotate(&pair->trees.turn, pe_sub(x, pair->trees.offset));
}

/* What lies along the unit direction n, as far as `most`, at a point in both. */
static pe_touch touch_at(const pe_solid_pair *pair, pe_vec3 n, double most, pe_vec3 where)
{
    pe_vec3 way = pe_scale(most, n);
    double in_b = most * pe_solid_way_to_exit(&pair->b, where, pe_scale(-1, way), pair->slack);
    double in_a = 0;
    if (!pair->a.core) {
        pe_vec3 x = in_axes_of_a(pair, where), turned = pe_unrotate(&pair->trees.turn, way);
        in_a = most * pe_solid_way_to_exit(&pair->a, x, turned, pair->slack);
    }
    return (pe_touch){
        .feature = pe_touch_feature(PE_VERTEX_VERTEX, 0, pair->b.vertex_count),
        .kind = PE_VERTEX_VERTEX,
        .normal = n,
        .on_a = pe_madd(where, in_a, n),
        .separation = -in_a - in_b - pair->radius,
    };
}

/* Beyond the names of vertices. Two curves may run through the same faces. */
static uint64_t name_of(const pe_solid_pair *pair, const curve *c, const pe_touches *list)
{
    int second = pair->b.vertex_count + 1 + c->face_b;
    uint64_t name = pe_touch_feature(PE_VERTEX_VERTEX, c->face_a, second);
    for (int i = 0; i < list->count; ++i) {
        if (list->items[i].feature == name) {
            second += pair->b.triangle_count;
            name = pe_touch_feature(PE_VERTEX_VERTEX, c->face_a, second);
            i = -1;
        }
    }
    return name;
}

/* The most that lies along n at a point of the curve. */
static pe_touch touch_on_curve(const pe_solid_pair *pair, const rim *r, int first, pe_vec3 n,
                               double most)
{
    pe_touch touch = touch_at(pair, n, most, r->parts[first].p);
    for (int i = first + 1; i < r->count; ++i) {
        if (r->parts[i].curve == first) {
            pe_touch other = touch_at(pair, n, most, r->parts[i].p);
            touch = other.separation < touch.separation ? other : touch;
        }
    }
    return touch;
}

/* `first`: the curve's first part. False: it tells no direction. */
static bool leave_by_curve(const pe_solid_pair *pair, const rim *r, int first, pe_touches *list)
{
    curve c = measure_curve(r, first);
    double area = pe_length(c.area);
    if (!(area > LEAST_AREA * c.length * c.length)) {
        return false;
    }
    pe_vec3 n = pe_scale(1 / area, c.area);
    double most = overlap(pair, n);
    if (!(most > 0)) {
        return false;
    }
    bool in_both = pe_solid_holds(&pair->b, c.centre) &&
                   pe_solid_holds(&pair->a, in_axes_of_a(pair, c.centre));
    pe_touch touch =
        in_both ? touch_at(pair, n, most, c.centre) : touch_on_curve(pair, r, first, n, most);
    touch.feature = name_of(pair, &c, list);
    pe_touches_add(list, &touch);
    return true;
}

/* False: the curves tell no way out. */
static bool leave_by_curves(const pe_solid_pair *pair, pe_touches *list)
{
    rim r = {.list = list};
    pe_solids_each_crossing(pair, count_part, &r);
    r.parts = r.capacity > 0 ? pe_take(list->work, (size_t)r.capacity, sizeof *r.parts) : NULL;
    if (r.parts == NULL) {
        list->failed = list->failed || r.capacity > 0;
        return list->failed;
    }
    pe_solids_each_crossing(pair, add_part, &r);
    find_curves(&r, JOINED * pair->size);
    pe_vec3 sum = {0, 0, 0};
    double whole = 0;
    for (int i = 0; i < r.count; ++i) {
        if (r.parts[i].curve == i) {
            curve c = measure_curve(&r, i);
            sum = pe_add(sum, c.area);
            whole += pe_length(c.area);
        }
    }
    bool found = false;
    for (int i = 0; i < r.count && pe_length(sum) > NOT_CANCELLED * whole; ++i) {
        if (r.parts[i].curve == i) {
            found = leave_by_curve(pair, &r, i, list) || found;
        }
    }
    return found;
}

typedef struct way_out {
    const pe_solid_pair *pair;
    double least; /* m, overlap along n */
    pe_vec3 n;
    pe_touch touch;
} way_out;

static void try_normals(void *context, const pe_crossing *c)
{
    way_out *w = context;
    for (int side = c->a->face < 0; side < 2; ++side) {
        pe_vec3 n = side == 0 ? c->a->normal : pe_scale(-1, c->b->normal);
        double least = overlap(w->pair, n);
        if (least < w->least) {
            w->least = least;
            w->n = n;
        }
    }
}

static void try_points(void *context, const pe_crossing *c)
{
    way_out *w = context;
    for (int i = 0; i < c->count; ++i) {
        pe_touch touch = touch_at(w->pair, w->n, w->least, c->where[i]);
        if (touch.separation < w->touch.separation) {
            w->touch = touch;
        }
    }
}

static void leave_as_a_whole(const pe_solid_pair *pair, pe_touches *list)
{
    way_out w = {.pair = pair, .least = HUGE_VAL, .touch = {.separation = HUGE_VAL}};
    pe_solids_each_crossing(pair, try_normals, &w);
    pe_solids_each_crossing(pair, try_points, &w);
    if (w.touch.separation < HUGE_VAL) {
        pe_touches_add(list, &w.touch);
    }
}

void pe_touches_find_translation(const pe_solid_pair *pair, const pe_nearest *nearest,
                                 pe_touches *list)
{
    if (pair->a.core && find_way_out_of_ends(pair, list)) {
        return;
    }
    if (!nearest->cross) {
        bool of_face = nearest->touch.kind <= PE_FACE_VERTEX;
        pe_touch touch = {
            .feature = pe_touch_feature(PE_VERTEX_VERTEX, 0, pair->b.vertex_count),
            .kind = PE_VERTEX_VERTEX,
            .normal = pe_scale(of_face ? 1 : -1, nearest->touch.normal),
            .on_a = nearest->touch.on_a,
            .separation = -nearest->distance - pair->radius,
        };
        pe_touches_add(list, &touch);
    } else if (pair->a.core || (pair->a.convex && pair->b.convex) || !leave_by_curves(pair, list)) {
        leave_as_a_whole(pair, list);
    }
}
