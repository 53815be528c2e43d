/* Pairs of features within reach, by the rules of mesh_contact.c, and the nearest points of two
 * surfaces of triangles.
 *
 * For the nearest points, pairs of triangles are taken from the trees, near ones first, while their
 * boxes are within the least distance so far. Two triangles that do not cross are nearest at a
 * vertex of one and the interior of the other, or on two edges (Larsen, Gottschalk, Lin, Manocha
 * 1999). Convex edges suffice, for no point outside a solid is nearest to a dent. */
#include "near_features.h"

#include "narrow_phase/tolerances.h"
#include "solid_query.h"

/* ---- Features within reach ---- */

typedef struct finder {
    const pe_solid_pair *pair;
    double reach, depth, bound; /* m; bound: the larger of the two */
    pe_touches *list;
} finder;

/* Whether a point on a face's plane, past a dent, is in the solid: next to the end of the dent it may
 * not be, though it is behind the face across the dent. */
static bool is_in_solid(const pe_solid *solid, const pe_transform *placed, pe_vec3 x, double slack)
{
    pe_vec3 own = placed != NULL ? pe_transform_back(placed, x) : x;
    if (pe_solid_contains(solid, own)) {
        return true;
    }
    pe_vec3 d = pe_sub(own, pe_solid_nearest_point(solid, own));
    return pe_dot(d, d) <= slack * slack;
}

/* Adds the touch of corner k of one facet, at a height over the other. */
static void try_vertex(const finder *f, pe_touch_kind kind, const pe_facet *of,
                       const pe_facet *over, int k, double height)
{
    const pe_solid_pair *pair = f->pair;
    const pe_transform *placed = &pair->trees.a_in_b;
    if (!pe_facet_owns_corner(of, k) || height > f->reach ||
        height < -pe_max(f->depth, pair->slack)) {
        return;
    }
    bool of_a = kind == PE_VERTEX_FACE, strict;
    const pe_solid *solid = of_a ? &pair->b : &pair->a;
    placed = of_a ? NULL : placed;
    pe_facet_side side =
        pe_facet_contains_dented(solid, placed, over, of->x[k], pair->slack, f->depth);
    if (side == PE_OFF_FACET ||
        (side == PE_BEHIND_DENT &&
         !is_in_solid(solid, placed, pe_madd(of->x[k], -height, over->normal), pair->slack))) {
        return;
    }
    pe_vec3 normal = of_a ? pe_unrotate(&pair->trees.a_in_b.turn, over->normal) : over->normal;
    if (pe_vertex_takes_normal(of_a ? &pair->a : &pair->b, of->vertices[k], normal, &strict)) {
        pe_touch touch = pe_touch_on_face(kind, of->vertices[k], of->x[k], over, height);
        touch.separation -= pair->radius;
        touch.dent = side == PE_BEHIND_DENT;
        touch.strict = strict;
        pe_touches_add(f->list, &touch);
    }
}

/* Adds the touch of two convex edges whose lines are nearest inside both. With u and v their
 * directions and c = u x v, the normal n = +-c/|c| rises along the faces of the first edge by
 * +-(v.n0) |u|^2/|c| and -+(v.n1) |u|^2/|c|, for c x u has no other part along v. The same holds
 * for the second edge: the signs of four products show whether both edges face each other
 * (Gregorius 2013). */
static void try_edges(const finder *f, const pe_ridge *a, const pe_ridge *b)
{
    bool core = f->pair->a.core;
    double la = a->length, lb = b->length;
    double b0 = lb * pe_dot(a->along, b->normal[0]), b1 = -lb * pe_dot(a->along, b->normal[1]);
    double a0 = core ? 0 : la * pe_dot(b->along, a->normal[0]);
    double a1 = core ? 0 : -la * pe_dot(b->along, a->normal[1]);
    double sign = a0 + a1 + b0 + b1 > 0 ? 1 : -1;
    double least = pe_min(pe_min(sign * a0, sign * a1), pe_min(sign * b0, sign * b1));
    if (least < -(PE_FACING * la * lb)) {
        return;
    }
    pe_vec3 c = pe_cross(a->along, b->along), apart = pe_sub(b->x, a->x);
    double c2 = pe_dot(c, c);
    if (c2 <= PE_MESH_EDGES_PARALLEL * PE_MESH_EDGES_PARALLEL * a->length2 * b->length2) {
        return;
    }
    double scale = sign / sqrt(c2), separation = scale * pe_dot(apart, c);
    double length = fabs(1 / scale);
    if (separation > f->reach || separation < -pe_max(f->depth, f->pair->slack) ||
        least < -PE_FACING * length) {
        return;
    }
    double s = pe_dot(pe_cross(apart, b->along), c) / c2;
    double t = pe_dot(pe_cross(apart, a->along), c) / c2;
    double past_a = f->pair->slack / la, past_b = f->pair->slack / lb;
    if (s < -past_a || s > 1 + past_a || t < -past_b || t > 1 + past_b) {
        return;
    }
    pe_touch touch =
        pe_touch_make(PE_EDGE_EDGE, pe_touch_feature(PE_EDGE_EDGE, a->edge, b->edge),
                      pe_madd(a->x, s, a->along), pe_scale(scale, c), separation - f->pair->radius);
    touch.strict = least >= -PE_FACING_STRICT * length;
    touch.along_a = a->along;
    touch.along_b = b->along;
    pe_touches_add(f->list, &touch);
}

/* Adds the touch of a point of the core and a point of b, `apart` from it, across a gap. */
static void add_points(const finder *f, pe_touch_kind kind, uint64_t feature, pe_vec3 on_a,
                       pe_vec3 apart, double distance)
{
    pe_touch touch = pe_touch_make(kind, feature, on_a, pe_scale(1 / distance, apart),
                                   distance - f->pair->radius);
    pe_touches_add(f->list, &touch);
}

/* An end of the core, and an edge of b or one of its vertices. */
static void try_end_edge(const finder *f, int end, pe_vec3 x, const pe_ridge *b)
{
    const pe_solid_pair *pair = f->pair;
    double t = pe_dot(pe_sub(x, b->x), b->along) / b->length2;
    bool at_vertex = t <= 0 || t >= 1;
    int vertex = pair->b.edges[b->edge].vertex[t >= 1];
    pe_vec3 y = at_vertex ? pair->b.vertices[vertex] : pe_madd(b->x, t, b->along);
    pe_vec3 apart = pe_sub(y, x), out = pe_scale(-1, apart);
    double distance = pe_length(apart);
    if (distance > f->reach || !(distance > pair->slack) ||
        !pe_vertex_faces(&pair->a, end, pe_unrotate(&pair->trees.a_in_b.turn, out), distance,
                         PE_FACING)) {
        return;
    }
    if (at_vertex ? pe_vertex_faces(&pair->b, vertex, apart, distance, PE_FACING_ROUNDED)
                  : pe_ridge_faces(b, out, distance, PE_FACING_ROUNDED)) {
        pe_touch_kind kind = at_vertex ? PE_VERTEX_VERTEX : PE_VERTEX_EDGE;
        add_points(f, kind, pe_touch_feature(kind, end, at_vertex ? vertex : b->edge), x, apart,
                   distance);
    }
}

/* The interior of the core's segment and a vertex of b. */
static void try_segment_vertex(const finder *f, const pe_ridge *segment, int vertex, pe_vec3 y)
{
    double s = pe_dot(pe_sub(y, segment->x), segment->along) / segment->length2;
    pe_vec3 x = pe_madd(segment->x, s, segment->along), apart = pe_sub(y, x);
    double distance = pe_length(apart);
    if (s > 0 && s < 1 && distance <= f->reach && distance > f->pair->slack &&
        pe_vertex_faces(&f->pair->b, vertex, apart, distance, PE_FACING_ROUNDED)) {
        add_points(f, PE_EDGE_VERTEX, pe_touch_feature(PE_EDGE_VERTEX, segment->edge, vertex), x,
                   apart, distance);
    }
}

static void try_core(const finder *f, const pe_facet *a, const pe_facet *b)
{
    bool point = !pe_facet_owns_corner(a, 1);
    for (int j = 0; j < b->ridge_count; ++j) {
        for (int k = 0; k < 2; ++k) {
            if (pe_facet_owns_corner(a, k)) {
                try_end_edge(f, a->vertices[k], a->x[k], &b->ridges[j]);
            }
        }
        if (!point) {
            try_edges(f, a->ridges, &b->ridges[j]);
        }
    }
    for (int k = 0; k < 3 && !point; ++k) {
        if (pe_facet_owns_corner(b, k)) {
            try_segment_vertex(f, a->ridges, b->vertices[k], b->x[k]);
        }
    }
}

static bool find_touches(void *context, pe_facet *a, pe_facet *b)
{
    const finder *f = context;
    pe_facet_heights heights;
    if (!pe_facets_heights(a, b, f->bound, &heights)) {
        return true;
    }
    for (int k = 0; k < 3; ++k) {
        try_vertex(f, PE_VERTEX_FACE, a, b, k, heights.above_b[k]);
        if (a->face >= 0) {
            try_vertex(f, PE_FACE_VERTEX, b, a, k, heights.above_a[k]);
        }
    }
    pe_facet_ridges(&f->pair->a, &f->pair->trees.a_in_b, a);
    pe_facet_ridges(&f->pair->b, NULL, b);
    if (f->pair->a.core) {
        try_core(f, a, b);
        return !f->list->failed;
    }
    for (int i = 0; i < a->ridge_count; ++i) {
        for (int j = 0; j < b->ridge_count; ++j) {
            try_edges(f, &a->ridges[i], &b->ridges[j]);
        }
    }
    return !f->list->failed;
}

void pe_touches_find(const pe_solid_pair *pair, double reach, double depth, pe_touches *list)
{
    finder f = {pair, reach, depth, pe_max(reach, depth), list};
    pe_each_near_facets(pair, &f.bound, find_touches, &f);
}

/* ---- Nearest points ---- */

typedef struct search {
    const pe_solid_pair *pair;
    double bound; /* m: farther features are not tested */
    pe_nearest best;
} search;

static void offer(search *s, const pe_touch *touch, double distance, bool inside)
{
    double tie = PE_NEAREST_TIE * s->pair->size, least = pe_min(s->best.distance, distance);
    if (!s->best.found || distance < s->best.distance - tie ||
        touch->feature < s->best.touch.feature) {
        s->best = (pe_nearest){.found = true, .inside = inside, .touch = *touch};
    }
    s->best.distance = least;
    s->bound = least + tie;
}

static void offer_edges(search *s, const pe_ridge *a, const pe_ridge *b)
{
    double at_a, at_b;
    pe_segments_nearest(a->x, a->along, b->x, b->along, &at_a, &at_b);
    pe_vec3 on_a = pe_madd(a->x, at_a, a->along);
    pe_vec3 apart = pe_sub(pe_madd(b->x, at_b, b->along), on_a);
    double distance2 = pe_dot(apart, apart);
    if (!(distance2 < s->bound * s->bound && distance2 > 0)) {
        return;
    }
    bool end_a = at_a <= 0 || at_a >= 1, end_b = at_b <= 0 || at_b >= 1;
    pe_touch_kind kind = end_a   ? end_b ? PE_VERTEX_VERTEX : PE_VERTEX_EDGE
                         : end_b ? PE_EDGE_VERTEX
                                 : PE_EDGE_EDGE;
    int first = end_a ? s->pair->a.edges[a->edge].vertex[at_a >= 1] : a->edge;
    int second = end_b ? s->pair->b.edges[b->edge].vertex[at_b >= 1] : b->edge;
    double distance = sqrt(distance2);
    pe_touch touch = pe_touch_make(kind, pe_touch_feature(kind, first, second), on_a,
                                   pe_scale(1 / distance, apart), 0);
    offer(s, &touch, distance, false);
}

static void offer_vertices(search *s, pe_touch_kind kind, const pe_facet *of, const pe_facet *over,
                           const double height[3])
{
    for (int k = 0; k < 3; ++k) {
        if (pe_facet_owns_corner(of, k) && fabs(height[k]) < s->bound &&
            pe_facet_covers(over, of->x[k], s->pair->slack)) {
            pe_touch touch = pe_touch_on_face(kind, of->vertices[k], of->x[k], over, height[k]);
            offer(s, &touch, fabs(height[k]), height[k] < 0);
        }
    }
}

/* The least height if all are on one side, else 0: a bound of the distance from the plane. */
static double least_height(const double height[3])
{
    double least = pe_min(height[0], pe_min(height[1], height[2]));
    double most = pe_max(height[0], pe_max(height[1], height[2]));
    return least > 0 ? least : most < 0 ? -most : 0;
}

static bool find_nearest(void *context, pe_facet *a, pe_facet *b)
{
    search *s = context;
    const pe_solid_pair *pair = s->pair;
    pe_facet_heights heights;
    if (!pe_facets_heights(a, b, s->bound, &heights)) {
        return true;
    }
    pe_vec3 where[PE_MOST_PIERCINGS];
    double bound_b = least_height(heights.above_b), bound_a = least_height(heights.above_a);
    if (bound_b == 0 && (a->face < 0 || bound_a == 0) &&
        pe_facets_cross(a, b, &heights, 0, where) > 0) {
        s->best = (pe_nearest){.distance = s->best.distance, .found = true, .cross = true};
        return false;
    }
    offer_vertices(s, PE_VERTEX_FACE, a, b, heights.above_b);
    if (a->face >= 0) {
        offer_vertices(s, PE_FACE_VERTEX, b, a, heights.above_a);
    }
    if (pe_max(bound_a, bound_b) >= s->bound) {
        return true;
    }
    pe_facet_ridges(&pair->a, &pair->trees.a_in_b, a);
    pe_facet_ridges(&pair->b, NULL, b);
    for (int i = 0; i < a->ridge_count; ++i) {
        for (int j = 0; j < b->ridge_count; ++j) {
            offer_edges(s, &a->ridges[i], &b->ridges[j]);
        }
    }
    return true;
}

/* An edge of either solid in b's axes. */
typedef struct line {
    pe_vec3 from, along;
} line;

static line line_of(const pe_solid *solid, const pe_transform *placed, int edge)
{
    const int *ends = solid->edges[edge].vertex;
    pe_vec3 p = solid->vertices[ends[0]], q = solid->vertices[ends[1]];
    if (placed != NULL) {
        p = pe_transform_point(placed, p);
        q = pe_transform_point(placed, q);
    }
    return (line){p, pe_sub(q, p)};
}

static pe_vec3 nearest_on(const line *l, pe_vec3 x)
{
    return pe_madd(l->from, pe_dot(pe_sub(x, l->from), l->along) / pe_dot(l->along, l->along),
                   l->along);
}

static pe_vec3 perpendicular_to(const line *l, pe_vec3 d)
{
    return pe_madd(d, -pe_dot(d, l->along) / pe_dot(l->along, l->along), l->along);
}

/* Computes the points again, from the features alone: a vertex ends several edges, and each finds
 * it with another rounding. If the points are near each other, the line between them has few
 * correct digits, but it must be perpendicular to an edge to the last digit. */
static void measure_again(const pe_solid_pair *pair, pe_nearest *best)
{
    pe_touch *touch = &best->touch;
    if (touch->kind < PE_EDGE_EDGE) {
        return;
    }
    int first = pe_touch_first(touch->feature), second = pe_touch_second(touch->feature);
    bool edge_a = touch->kind == PE_EDGE_EDGE || touch->kind == PE_EDGE_VERTEX;
    bool edge_b = touch->kind == PE_EDGE_EDGE || touch->kind == PE_VERTEX_EDGE;
    const pe_transform *placed = &pair->trees.a_in_b;
    line a = {0}, b = {0};
    if (edge_a) {
        a = line_of(&pair->a, placed, first);
    }
    if (edge_b) {
        b = line_of(&pair->b, NULL, second);
    }
    pe_vec3 x = touch->on_a, n;
    if (edge_a && edge_b) {
        n = pe_cross(a.along, b.along);
        double sine2 = pe_dot(n, n) / (pe_dot(a.along, a.along) * pe_dot(b.along, b.along));
        n = !(sine2 > PE_NEAREST_EDGES_PARALLEL * PE_NEAREST_EDGES_PARALLEL) ? touch->normal
            : pe_dot(n, touch->normal) < 0                                   ? pe_scale(-1, n)
                                                                             : n;
    } else {
        x = edge_a ? nearest_on(&a, pair->b.vertices[second])
                   : pe_transform_point(placed, pair->a.vertices[first]);
        n = pe_sub(edge_b ? nearest_on(&b, x) : pair->b.vertices[second], x);
        best->distance = pe_length(n);
        n = edge_a ? perpendicular_to(&a, n) : edge_b ? perpendicular_to(&b, n) : n;
    }
    touch->on_a = x;
    touch->normal = pe_scale(1 / pe_length(n), n);
}

pe_nearest pe_solids_nearest(const pe_solid_pair *pair, double bound)
{
    search s = {.pair = pair, .bound = bound, .best = {.distance = bound}};
    pe_each_near_facets(pair, &s.bound, find_nearest, &s);
    if (s.best.found && !s.best.cross) {
        measure_again(pair, &s.best);
    }
    return s.best;
}
