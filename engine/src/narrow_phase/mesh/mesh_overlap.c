/* Overlaps that the features within reach do not show.
 *
 * Deep vertices. Where two surfaces cross, the vertices behind the crossing triangles are tested.
 * From each vertex that lies inside, the search goes on to its neighbours along the edges. So the
 * cost grows with the number of vertices inside. A vertex inside touches the nearest face that it
 * faces and above which it would come out, unless another part of the surface lies between.
 *
 * Translations, where no vertex shows one. The ends of a core leave by the nearest point of the
 * surface, and a solid wholly inside by the nearest faces. Where the surfaces cross, they do along
 * closed curves. The vector area of a curve is that of the part of a's surface within b. The volume
 * of the overlap shrinks most along it, for the derivative of a volume by a translation is the
 * surface's vector area. Each curve gives a touch. Its depth is the length of the overlap along its
 * normal at its centre, or, if the centre is not in both solids, the largest at its points. The
 * vector areas of the curves of a rod through a plate cancel. Then, and for convex solids, the
 * normal is that of the crossing triangles along which the solids as a whole overlap least, so that
 * it never leads further in. The depth is the largest along it where they cross. */
#include "near_features.h"

#include "narrow_phase/tolerances.h"
#include "solid_query.h"

#include <string.h>

bool pe_touch_is_blocked(const pe_solid_pair *pair, const pe_touch *touch)
{
    double depth = -(touch->separation + pair->radius);
    int face = pe_touch_second(touch->feature);
    if (touch->kind == PE_VERTEX_FACE) {
        return pe_solid_blocks(&pair->b, touch->on_a, pe_scale(-depth, touch->normal), face,
                               pair->slack);
    }
    const pe_transform *placed = &pair->trees.a_in_b;
    pe_vec3 x = pe_transform_back(placed, pe_madd(touch->on_a, -depth, touch->normal));
    pe_vec3 n = pe_unrotate(&placed->turn, touch->normal);
    return pe_solid_blocks(&pair->a, x, pe_scale(depth, n), face, pair->slack);
}

/* ---- Deep vertices ---- */

/* A face over a vertex. */
typedef struct face_above {
    int face; /* -1: none */
    double depth;
    bool strict;
} face_above;

/* The search for one solid's vertices in the other. */
typedef struct vertex_search {
    const pe_solid_pair *pair;
    bool of_a; /* the vertices are a's */
    const pe_solid *of, *in;
    const pe_transform *placed; /* `of` in the axes of `in` */
    bool *visited;
    int *stack, depth;
    pe_touches *list;
} vertex_search;

/* The nearest face over the vertex at x, in the axes of `in`, that the vertex faces. A face on the
 * far side does not count: the nearest face of all then looks the other way. */
static face_above nearest_face(const vertex_search *d, int vertex, pe_vec3 x)
{
    face_above found = {-1, HUGE_VAL, false}, nearest = found;
    pe_facet_walk walk;
    pe_facet facet;
    pe_walk_near_point(d->in, x, &walk);
    while (pe_walk_next(&walk, found.depth, &facet)) {
        face_above here = {facet.face, facet.offset - pe_dot(facet.normal, x), false};
        if (!(here.depth > 0) || here.depth >= found.depth ||
            !pe_facet_contains(&facet, x, d->pair->slack)) {
            continue;
        }
        nearest = here.depth < nearest.depth ? here : nearest;
        if (pe_vertex_takes_normal(d->of, vertex, pe_unrotate(&d->placed->turn, facet.normal),
                                   &here.strict)) {
            found = here;
        }
    }
    const pe_face *faces = d->in->faces;
    if (found.face >= 0 &&
        pe_dot(faces[found.face].normal, faces[nearest.face].normal) < PE_OPPOSITE) {
        found.face = -1;
    }
    return found;
}

static void visit(vertex_search *d, int vertex)
{
    if (!d->visited[vertex]) {
        d->visited[vertex] = true;
        d->stack[d->depth++] = vertex;
    }
}

/* Adds the touch of a vertex and the face over it. */
static void add_deep(const vertex_search *d, int vertex, pe_vec3 x, const face_above *over)
{
    const pe_transform *placed = &d->pair->trees.a_in_b;
    pe_vec3 n = d->in->faces[over->face].normal;
    pe_touch_kind kind = d->of_a ? PE_VERTEX_FACE : PE_FACE_VERTEX;
    pe_touch touch = pe_touch_make(
        kind, pe_touch_feature(kind, vertex, over->face),
        d->of_a ? x : pe_transform_point(placed, pe_madd(x, over->depth, n)),
        d->of_a ? pe_scale(-1, n) : pe_rotate(&placed->turn, n), -over->depth - d->pair->radius);
    touch.strict = over->strict;
    pe_touches_add(d->list, &touch);
}

/* Follows the edges from the visited vertices as long as they lie inside. */
static void follow_edges(vertex_search *d)
{
    const pe_solid *of = d->of;
    while (d->depth > 0) {
        int vertex = d->stack[--d->depth];
        pe_vec3 x = pe_transform_point(d->placed, of->vertices[vertex]);
        if (!pe_solid_contains(d->in, x)) {
            continue;
        }
        face_above over = nearest_face(d, vertex, x);
        if (over.face >= 0) {
            add_deep(d, vertex, x, &over);
        }
        for (int i = of->vertex_first[vertex]; i < of->vertex_first[vertex + 1]; ++i) {
            const pe_edge *edge = &of->edges[of->vertex_edges[i]];
            visit(d, edge->vertex[edge->vertex[0] == vertex]);
        }
    }
}

/* False: out of memory. */
static bool begin(vertex_search *d)
{
    size_t count = (size_t)d->of->vertex_count;
    d->visited = pe_take(d->list->work, count, sizeof *d->visited);
    d->stack = pe_take(d->list->work, count, sizeof *d->stack);
    d->list->failed = d->list->failed || d->visited == NULL || d->stack == NULL;
    if (!d->list->failed) {
        memset(d->visited, 0, count * sizeof *d->visited);
    }
    return !d->list->failed;
}

/* Visits corners that lie farther behind the other triangle than `depth`, but not past all of its
 * solid. */
static void visit_behind(vertex_search *d, const pe_facet *facet, const double height[3],
                         double depth)
{
    const pe_bvh_pair *trees = &d->pair->trees;
    for (int k = 0; k < 3; ++k) {
        double along = pe_dot(trees->parting, facet->x[k]);
        if (height[k] < -depth && (d->of_a ? along > trees->least_b : along < trees->most_a)) {
            visit(d, facet->vertices[k]);
        }
    }
}

typedef struct vertex_searches {
    vertex_search a, b;
    double depth;
} vertex_searches;

static void visit_crossing(void *context, const pe_crossing *c)
{
    vertex_searches *d = context;
    visit_behind(&d->a, c->a, c->heights->above_b, d->depth);
    visit_behind(&d->b, c->b, c->heights->above_a, d->depth);
}

static void visit_all(vertex_search *d)
{
    for (int v = 0; v < d->of->vertex_count; ++v) {
        visit(d, v);
    }
}

void pe_touches_find_deep(const pe_solid_pair *pair, double depth, bool all, pe_touches *list)
{
    vertex_searches d = {
        .a = {pair, true, &pair->a, &pair->b, &pair->trees.a_in_b, .list = list},
        .b = {pair, false, &pair->b, &pair->a, &pair->b_in_a, .list = list},
        .depth = depth,
    };
    if (!begin(&d.a) || !begin(&d.b)) {
        return;
    }
    if (all) {
        visit_all(&d.a);
        visit_all(&d.b);
    } else {
        pe_each_crossing(pair, visit_crossing, &d);
    }
    follow_edges(&d.a);
    if (!pair->a.core) {
        follow_edges(&d.b);
    }
}

/* ---- Intersection curves ---- */

/* The length of the overlap of the solids as a whole along the unit direction n, from a to b. */
static double overlap(const pe_solid_pair *pair, pe_vec3 n)
{
    const pe_transform *placed = &pair->trees.a_in_b;
    pe_vec3 back = pe_unrotate(&placed->turn, n);
    return pe_dot(back, pe_solid_support(&pair->a, back)) + pe_dot(n, placed->offset) -
           pe_dot(n, pe_solid_support(&pair->b, pe_scale(-1, n)));
}

/* A segment of an intersection curve, in two triangles. From p to q, the part of a that lies in b
 * is on the left, seen from outside a. */
typedef struct segment {
    pe_vec3 p, q;
    int face_a, face_b;
    int curve; /* the first segment of its curve */
} segment;

typedef struct segments {
    segment *items;
    int count, capacity;
} segments;

static void count_segment(void *context, const pe_crossing *c)
{
    segments *s = context;
    s->capacity += c->count > 1;
}

static void add_segment(void *context, const pe_crossing *c)
{
    segments *s = context;
    pe_vec3 along = pe_cross(c->a->normal, c->b->normal);
    int first = 0, last = 0;
    /* Of two faces in one plane the direction is rounding. Their borders cross other faces there. */
    const bool crosses = pe_dot(along, along) > PE_LEAST_RISE * PE_LEAST_RISE;
    for (int i = 1; i < c->count && crosses; ++i) {
        first = pe_dot(along, c->where[i]) < pe_dot(along, c->where[first]) ? i : first;
        last = pe_dot(along, c->where[i]) > pe_dot(along, c->where[last]) ? i : last;
    }
    if (first != last && s->count < s->capacity) {
        s->items[s->count] =
            (segment){c->where[first], c->where[last], c->a->face, c->b->face, s->count};
        s->count += 1;
    }
}

static bool are_joined(const segment *i, const segment *j, double reach)
{
    pe_vec3 d = pe_sub(i->q, j->p), e = pe_sub(i->p, j->q);
    return pe_dot(d, d) <= reach * reach || pe_dot(e, e) <= reach * reach;
}

/* Gives all connected segments the number of their first one. */
static void find_curves(segments *s, double reach)
{
    for (int i = 0; i < s->count; ++i) {
        for (int j = 0; j < i; ++j) {
            int from = s->items[i].curve, to = s->items[j].curve;
            if (from == to || !are_joined(&s->items[i], &s->items[j], reach)) {
                continue;
            }
            for (int k = 0; k <= i; ++k) {
                int curve = s->items[k].curve;
                s->items[k].curve = curve == from || curve == to ? (from < to ? from : to) : curve;
            }
        }
    }
}

typedef struct curve {
    pe_vec3 area, centre; /* m^2, m */
    double length;
    int face_a, face_b; /* of the segment with the lowest numbers */
} curve;

/* Where faces of both solids lie in one plane, the curve need not be closed. Its area is therefore
 * taken about its centre, so that it does not depend on the segment that comes first. */
static curve measure_curve(const segments *s, int first)
{
    pe_vec3 origin = s->items[first].p, open = {0, 0, 0};
    curve c = {.face_a = s->items[first].face_a, .face_b = s->items[first].face_b};
    for (int i = first; i < s->count; ++i) {
        const segment *one = &s->items[i];
        if (one->curve != first) {
            continue;
        }
        pe_vec3 p = pe_sub(one->p, origin), q = pe_sub(one->q, origin);
        double length = pe_length(pe_sub(q, p));
        c.area = pe_madd(c.area, 0.5, pe_cross(p, q));
        open = pe_add(open, pe_sub(q, p));
        c.centre = pe_madd(c.centre, 0.5 * length, pe_add(p, q));
        c.length += length;
        if (one->face_a < c.face_a || (one->face_a == c.face_a && one->face_b < c.face_b)) {
            c.face_a = one->face_a;
            c.face_b = one->face_b;
        }
    }
    pe_vec3 centre = pe_scale(c.length > 0 ? 1 / c.length : 0, c.centre);
    c.area = pe_madd(c.area, -0.5, pe_cross(centre, open));
    c.centre = pe_add(origin, centre);
    return c;
}

/* The overlap along the unit direction n, at most `most`, at a point in both solids. */
static pe_touch touch_at(const pe_solid_pair *pair, pe_vec3 n, double most, pe_vec3 where)
{
    const pe_transform *placed = &pair->trees.a_in_b;
    pe_vec3 along = pe_scale(most, n);
    double in_b = most * pe_solid_exit(&pair->b, where, pe_scale(-1, along), pair->slack);
    double in_a = 0;
    if (!pair->a.core) {
        in_a = most * pe_solid_exit(&pair->a, pe_transform_back(placed, where),
                                    pe_unrotate(&placed->turn, along), pair->slack);
    }
    return pe_touch_make(PE_VERTEX_VERTEX,
                         pe_touch_feature(PE_VERTEX_VERTEX, 0, pair->b.vertex_count),
                         pe_madd(where, in_a, n), n, -in_a - in_b - pair->radius);
}

/* A feature id beyond those of vertices, not in the list: two curves may cross the same faces. */
static uint64_t feature_of_curve(const pe_solid_pair *pair, const curve *c, const pe_touches *list)
{
    int second = pair->b.vertex_count + 1 + c->face_b;
    uint64_t feature = pe_touch_feature(PE_VERTEX_VERTEX, c->face_a, second);
    for (int i = 0; i < list->count; ++i) {
        if (list->items[i].feature == feature) {
            second += pair->b.triangle_count;
            feature = pe_touch_feature(PE_VERTEX_VERTEX, c->face_a, second);
            i = -1;
        }
    }
    return feature;
}

/* Whether x, or a point next to it along n, is in both solids. The curve around a part that sticks
 * out of one face has its centre on that face, where rounding decides. */
static bool is_in_both(const pe_solid_pair *pair, pe_vec3 x, pe_vec3 n)
{
    bool in_both = false;
    for (int i = 0; i < 3 && !in_both; ++i) {
        pe_vec3 y = pe_madd(x, i == 0 ? 0 : i == 1 ? pair->slack : -pair->slack, n);
        in_both = pe_solid_contains(&pair->b, y) &&
                  pe_solid_contains(&pair->a, pe_transform_back(&pair->trees.a_in_b, y));
    }
    return in_both;
}

/* Adds the touch of the curve with the first segment `first`. False: it has no direction. */
static bool part_by_curve(const pe_solid_pair *pair, const segments *s, int first, pe_touches *list)
{
    curve c = measure_curve(s, first);
    double area = pe_length(c.area);
    if (!(area > PE_LEAST_CURVE_AREA * c.length * c.length)) {
        return false;
    }
    pe_vec3 n = pe_scale(1 / area, c.area);
    double most = overlap(pair, n);
    if (!(most > 0)) {
        return false;
    }
    bool in_both = is_in_both(pair, c.centre, n);
    pe_touch touch = touch_at(pair, n, most, in_both ? c.centre : s->items[first].p);
    for (int i = first + 1; i < s->count && !in_both; ++i) {
        if (s->items[i].curve == first) {
            pe_touch other = touch_at(pair, n, most, s->items[i].p);
            touch = other.separation < touch.separation ? other : touch;
        }
    }
    touch.feature = feature_of_curve(pair, &c, list);
    pe_touches_add(list, &touch);
    return true;
}

/* False: the curves have no direction. */
static bool part_by_curves(const pe_solid_pair *pair, pe_touches *list)
{
    segments s = {0};
    pe_each_crossing(pair, count_segment, &s);
    s.items = s.capacity > 0 ? pe_take(list->work, (size_t)s.capacity, sizeof *s.items) : NULL;
    if (s.items == NULL) {
        list->failed = list->failed || s.capacity > 0;
        return list->failed;
    }
    pe_each_crossing(pair, add_segment, &s);
    find_curves(&s, PE_JOINED * pair->size);
    pe_vec3 sum = {0, 0, 0};
    double whole = 0;
    for (int i = 0; i < s.count; ++i) {
        if (s.items[i].curve == i) {
            curve c = measure_curve(&s, i);
            sum = pe_add(sum, c.area);
            whole += pe_length(c.area);
        }
    }
    bool found = false;
    for (int i = 0; i < s.count && pe_length(sum) > PE_NOT_CANCELLED * whole; ++i) {
        if (s.items[i].curve == i) {
            found = part_by_curve(pair, &s, i, list) || found;
        }
    }
    return found;
}

/* ---- Other translations ---- */

/* Adds a touch for each end of a core that lies inside: it leaves by the nearest point of the
 * surface. */
static bool part_ends(const pe_solid_pair *pair, pe_touches *list)
{
    bool found = false;
    for (int i = 0; i < pair->a.vertex_count; ++i) {
        pe_vec3 x = pe_transform_point(&pair->trees.a_in_b, pair->a.vertices[i]);
        if (!pe_solid_contains(&pair->b, x)) {
            continue;
        }
        pe_vec3 in = pe_sub(x, pe_solid_nearest_point(&pair->b, x));
        double depth = pe_length(in);
        if (depth > 0) {
            pe_touch touch = pe_touch_make(
                PE_VERTEX_VERTEX, pe_touch_feature(PE_VERTEX_VERTEX, i, pair->b.vertex_count), x,
                pe_scale(1 / depth, in), -depth - pair->radius);
            pe_touches_add(list, &touch);
            found = true;
        }
    }
    return found;
}

/* The translation of the solids as a whole. */
typedef struct translation {
    const pe_solid_pair *pair;
    double least; /* m, overlap along n */
    pe_vec3 n;
    pe_touch touch;
} translation;

static void try_normals(void *context, const pe_crossing *c)
{
    translation *t = context;
    for (int side = c->a->face < 0; side < 2; ++side) {
        pe_vec3 n = side == 0 ? c->a->normal : pe_scale(-1, c->b->normal);
        double least = overlap(t->pair, n);
        if (least < t->least) {
            t->least = least;
            t->n = n;
        }
    }
}

static void try_points(void *context, const pe_crossing *c)
{
    translation *t = context;
    for (int i = 0; i < c->count; ++i) {
        pe_touch touch = touch_at(t->pair, t->n, t->least, c->where[i]);
        t->touch = touch.separation < t->touch.separation ? touch : t->touch;
    }
}

void pe_touches_find_translation(const pe_solid_pair *pair, const pe_nearest *nearest,
                                 pe_touches *list)
{
    if (pair->a.core && part_ends(pair, list)) {
        return;
    }
    if (!nearest->cross) {
        bool of_face = nearest->touch.kind <= PE_FACE_VERTEX;
        pe_touch touch = pe_touch_make(
            PE_VERTEX_VERTEX, pe_touch_feature(PE_VERTEX_VERTEX, 0, pair->b.vertex_count),
            nearest->touch.on_a, pe_scale(of_face ? 1 : -1, nearest->touch.normal),
            -nearest->distance - pair->radius);
        pe_touches_add(list, &touch);
    } else if (pair->a.core || (pair->a.convex && pair->b.convex) || !part_by_curves(pair, list)) {
        translation t = {.pair = pair, .least = HUGE_VAL, .touch = {.separation = HUGE_VAL}};
        pe_each_crossing(pair, try_normals, &t);
        pe_each_crossing(pair, try_points, &t);
        if (t.touch.separation < HUGE_VAL) {
            pe_touches_add(list, &t.touch);
        }
    }
}
