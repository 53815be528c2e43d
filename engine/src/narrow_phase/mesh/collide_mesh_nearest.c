/* The nearest points of two surfaces of triangles.
 *
 * Pairs of triangles are taken from the trees, near ones first, while their boxes are within the
 * least distance so far. Two triangles that do not cross are nearest at a vertex of one and the
 * other's inside, or on two edges (Larsen, Gottschalk, Lin, Manocha 1999). Of the edges the convex
 * ones suffice, for nothing outside a solid is nearest to a dent of it. */
#include "collide_mesh.h"

/* In units of the smaller solid: of features as near as this the one of the lowest name is taken,
 * in whatever order they are found. */
static const double TIE = 1e-13;
/* Edges at a smaller angle than this, in rad, have no common normal but for rounding. */
static const double LEAST_SINE = 1e-6;

typedef struct search {
    const pe_solid_pair *pair;
    double bound; /* m: what is farther is not looked at */
    pe_nearest best;
} search;

static void offer(search *s, const pe_nearest *found)
{
    double tie = TIE * s->pair->size, least = pe_min(s->best.distance, found->distance);
    if (!s->best.found || found->distance < s->best.distance - tie ||
        found->touch.feature < s->best.touch.feature) {
        s->best = *found;
    }
    s->best.distance = least;
    s->bound = least + tie;
}

static void try_edges(search *s, const pe_ridge *a, const pe_ridge *b)
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
    int name_a = end_a ? s->pair->a.edges[a->edge].vertex[at_a >= 1] : a->edge;
    int name_b = end_b ? s->pair->b.edges[b->edge].vertex[at_b >= 1] : b->edge;
    double distance = sqrt(distance2);
    pe_nearest found = {
        .distance = distance,
        .found = true,
        .touch = {.feature = pe_touch_feature(kind, name_a, name_b),
                  .kind = kind,
                  .on_a = on_a,
                  .normal = pe_scale(1 / distance, apart)},
    };
    offer(s, &found);
}

static void try_vertices(search *s, pe_touch_kind kind, const pe_facet *of, const pe_facet *over,
                         const double height[3])
{
    bool of_a = kind == PE_VERTEX_FACE;
    for (int k = 0; k < 3; ++k) {
        bool owned = (of->owns >> k & 1) != 0;
        if (!owned || !(fabs(height[k]) < s->bound) || !pe_facet_holds(over, of->x[k], 0)) {
            continue;
        }
        pe_nearest found = {
            .distance = fabs(height[k]),
            .found = true,
            .inside = height[k] < 0,
            .touch = {.feature = pe_touch_feature(kind, of->vertices[k], over->face),
                      .kind = kind,
                      .on_a = of_a ? of->x[k] : pe_madd(of->x[k], -height[k], over->normal),
                      .normal = pe_scale(of_a ? -1 : 1, over->normal)},
        };
        offer(s, &found);
    }
}

/* The least height, where all are of one side: no point of the triangle is nearer to the plane. */
static double least_height(const double height[3])
{
    double least = pe_min(height[0], pe_min(height[1], height[2]));
    double most = pe_max(height[0], pe_max(height[1], height[2]));
    return least > 0 ? least : most < 0 ? -most : 0;
}

static bool try_facets(void *context, pe_facet *a, pe_facet *b)
{
    search *s = context;
    const pe_solid_pair *pair = s->pair;
    double above_a[3] = {0}, above_b[3];
    if (!pe_facet_heights(b, a, s->bound, above_b) ||
        (a->face >= 0 && !pe_facet_heights(a, b, s->bound, above_a))) {
        return true;
    }
    pe_vec3 where[PE_MOST_PIERCINGS];
    double bound_b = least_height(above_b), bound_a = least_height(above_a);
    if (bound_b == 0 && (a->face < 0 || bound_a == 0) &&
        pe_facets_cross(a, above_b, b, above_a, 0, where) > 0) {
        s->best = (pe_nearest){.distance = s->best.distance, .found = true, .cross = true};
        return false;
    }
    try_vertices(s, PE_VERTEX_FACE, a, b, above_b);
    if (a->face >= 0) {
        try_vertices(s, PE_FACE_VERTEX, b, a, above_a);
    }
    if (pe_max(bound_a, bound_b) >= s->bound) {
        return true;
    }
    pe_facet_ridges(&pair->a, &pair->trees, a);
    pe_facet_ridges(&pair->b, NULL, b);
    for (int i = 0; i < a->ridge_count; ++i) {
        for (int j = 0; j < b->ridge_count; ++j) {
            try_edges(s, &a->ridges[i], &b->ridges[j]);
        }
    }
    return true;
}

static pe_vec3 vertex_of_a(const pe_solid_pair *pair, int vertex)
{
    return pe_add(pe_rotate(&pair->trees.turn, pair->a.vertices[vertex]), pair->trees.offset);
}

/* An edge of either solid. */
typedef struct line {
    pe_vec3 from, along;
} line;

static line edge_of_a(const pe_solid_pair *pair, int edge)
{
    const int *ends = pair->a.edges[edge].vertex;
    pe_vec3 from = vertex_of_a(pair, ends[0]);
    return (line){from, pe_sub(vertex_of_a(pair, ends[1]), from)};
}

static line edge_of_b(const pe_solid_pair *pair, int edge)
{
    const int *ends = pair->b.edges[edge].vertex;
    pe_vec3 from = pair->b.vertices[ends[0]];
    return (line){from, pe_sub(pair->b.vertices[ends[1]], from)};
}

static pe_vec3 nearest_on(const line *l, pe_vec3 x)
{
    return pe_madd(l->from, pe_dot(pe_sub(x, l->from), l->along) / pe_dot(l->along, l->along),
                   l->along);
}

static pe_vec3 square_to(const line *l, pe_vec3 d)
{
    return pe_madd(d, -pe_dot(d, l->along) / pe_dot(l->along, l->along), l->along);
}

/* A vertex ends several edges, and each finds it with another rounding: the points again, from the
 * features alone. Where they are near each other, the line between them has few digits; square to
 * an edge it must be to all of them. */
static void measure_again(const pe_solid_pair *pair, pe_nearest *best)
{
    pe_touch *touch = &best->touch;
    int name_a = pe_touch_first(touch->feature), name_b = pe_touch_second(touch->feature);
    if (touch->kind < PE_EDGE_EDGE) {
        return;
    }
    pe_vec3 x, n;
    if (touch->kind == PE_VERTEX_VERTEX) {
        x = vertex_of_a(pair, name_a);
        n = pe_sub(pair->b.vertices[name_b], x);
        best->distance = pe_length(n);
    } else if (touch->kind == PE_VERTEX_EDGE) {
        line b = edge_of_b(pair, name_b);
        x = vertex_of_a(pair, name_a);
        n = pe_sub(nearest_on(&b, x), x);
        best->distance = pe_length(n);
        n = square_to(&b, n);
    } else if (touch->kind == PE_EDGE_VERTEX) {
        line a = edge_of_a(pair, name_a);
        x = nearest_on(&a, pair->b.vertices[name_b]);
        n = pe_sub(pair->b.vertices[name_b], x);
        best->distance = pe_length(n);
        n = square_to(&a, n);
    } else {
        line a = edge_of_a(pair, name_a), b = edge_of_b(pair, name_b);
        x = touch->on_a;
        n = pe_cross(a.along, b.along);
        double sine2 = pe_dot(n, n) / (pe_dot(a.along, a.along) * pe_dot(b.along, b.along));
        n = !(sine2 > LEAST_SINE * LEAST_SINE) ? touch->normal
            : pe_dot(n, touch->normal) < 0     ? pe_scale(-1, n)
                                               : n;
    }
    touch->on_a = x;
    touch->normal = pe_scale(1 / pe_length(n), n);
}

pe_nearest pe_solids_nearest(const pe_solid_pair *pair, double bound)
{
    search s = {.pair = pair, .bound = bound, .best = {.distance = bound}};
    pe_near_facets(pair, &s.bound, try_facets, &s);
    if (s.best.found && !s.best.cross) {
        measure_again(pair, &s.best);
    }
    return s.best;
}
