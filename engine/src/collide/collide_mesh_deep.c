/* Vertices that lie deep in the other solid.
 *
 * Where two surfaces cross, the corners behind the crossing triangles are looked at, and from those
 * that lie inside their neighbours along the edges, so that the work goes with what lies inside. A
 * vertex inside touches the nearest face that it faces and above which it would come out, unless
 * another part of the surface lies between. */
#include "collide_mesh.h"

#include <string.h>

/* Sine of the angle to a face from which a way crosses it. */
static const double LEAST_RISE = 1e-9;

/* A box about a segment or a point, and the tree of a solid in whose axes it is. */
static pe_bvh_pair around(const pe_node *node, const pe_solid *solid)
{
    pe_mat3 same = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    return pe_bvh_pair_of(node, solid->nodes, &same, pe_v3(0, 0, 0));
}

/* The point of the triangle nearest to x. */
static pe_vec3 nearest_point(const pe_facet *facet, pe_vec3 x)
{
    if (pe_facet_holds(facet, x, 0)) {
        return pe_madd(x, facet->offset - pe_dot(facet->normal, x), facet->normal);
    }
    pe_vec3 best = facet->x[0];
    double least = HUGE_VAL;
    for (int k = 0; k < 3; ++k) {
        pe_vec3 from = facet->x[k], u = pe_sub(facet->x[k < 2 ? k + 1 : 0], from);
        double t = pe_dot(pe_sub(x, from), u) / pe_dot(u, u);
        pe_vec3 y = pe_madd(from, pe_max(0, pe_min(1, t)), u), d = pe_sub(x, y);
        if (pe_dot(d, d) < least) {
            least = pe_dot(d, d);
            best = y;
        }
    }
    return best;
}

/* By the nearest triangle; of several that share the nearest point, the one whose normal is most
 * along the line to it has the sign right. */
bool pe_solid_holds(const pe_solid *solid, pe_vec3 x)
{
    const pe_node *root = &solid->nodes[0];
    pe_vec3 in = pe_rotate(&root->axes, pe_sub(x, root->centre));
    if (fabs(in.x) > root->half.x || fabs(in.y) > root->half.y || fabs(in.z) > root->half.z) {
        return false;
    }
    pe_node point = pe_box_node(x, pe_v3(0, 0, 0));
    pe_bvh_pair trees = around(&point, solid);
    pe_bvh_walk walk;
    const pe_node *node, *leaf;
    double bound = HUGE_VAL, steepest = 0, height = 0;
    pe_bvh_begin(&trees, &walk);
    while (pe_bvh_next(&trees, &walk, bound, &node, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            pe_facet facet;
            pe_solid_facet(solid, leaf->first + i, &facet);
            pe_vec3 d = pe_sub(x, nearest_point(&facet, x));
            double distance = pe_length(d), h = pe_dot(facet.normal, d);
            double steep = distance > 0 ? fabs(h) / distance : 1;
            bool nearer = distance < bound * (1 - 1e-9);
            if (nearer || (distance <= bound * (1 + 1e-9) && steep > steepest)) {
                steepest = steep;
                height = h;
                bound = nearer ? distance : bound;
            }
        }
    }
    return height < 0;
}

/* Whether the face has an edge in common with the one that the triangle is of, near it. */
static bool are_neighbours(const pe_solid *solid, const pe_facet *facet, int face)
{
    for (int k = 0; k < 3; ++k) {
        int v = facet->vertices[k];
        for (int i = solid->vertex_first[v]; i < solid->vertex_first[v + 1]; ++i) {
            const int *f = solid->edges[solid->vertex_edges[i]].face;
            if ((f[0] == face && f[1] == facet->face) || (f[1] == face && f[0] == facet->face)) {
                return true;
            }
        }
    }
    return false;
}

/* Whether a triangle of another face crosses the way from x along d to the face, both ends apart.
 * A neighbour of the face does not count: where the two make a sharp edge, what lies under the one
 * lies beside the other, and the way out is over the edge all the same. */
static bool blocked(const pe_solid *solid, pe_vec3 x, pe_vec3 d, int face, double slack)
{
    pe_node segment =
        pe_box_node(pe_madd(x, 0.5, d), pe_scale(0.5, pe_v3(fabs(d.x), fabs(d.y), fabs(d.z))));
    pe_bvh_pair trees = around(&segment, solid);
    pe_bvh_walk walk;
    const pe_node *node, *leaf;
    pe_bvh_begin(&trees, &walk);
    while (pe_bvh_next(&trees, &walk, 0, &node, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            pe_facet facet;
            pe_solid_facet(solid, leaf->first + i, &facet);
            double from = pe_dot(facet.normal, x) - facet.offset;
            double to = from + pe_dot(facet.normal, d);
            bool crosses = (from > slack && to < -slack) || (from < -slack && to > slack);
            if (!crosses || facet.face == face) {
                continue;
            }
            /* The point of crossing, not its foot, decides. */
            pe_vec3 y = pe_madd(x, from / (from - to), d);
            if (pe_facet_holds(&facet, y, 0) && !are_neighbours(solid, &facet, face)) {
                return true;
            }
        }
    }
    return false;
}

bool pe_touch_is_blocked(const pe_solid_pair *pair, const pe_touch *touch)
{
    double depth = -(touch->separation + pair->radius);
    int face = pe_touch_second(touch->feature);
    if (touch->kind == PE_VERTEX_FACE) {
        return blocked(&pair->b, touch->on_a, pe_scale(-depth, touch->normal), face, pair->slack);
    }
    pe_vec3 on_b = pe_madd(touch->on_a, -depth, touch->normal);
    pe_vec3 x = pe_unrotate(&pair->trees.turn, pe_sub(on_b, pair->trees.offset));
    pe_vec3 n = pe_unrotate(&pair->trees.turn, touch->normal);
    return blocked(&pair->a, x, pe_scale(depth, n), face, pair->slack);
}

/* The nearest face over the vertex (of `of`, at x and with its axes turned into those of `solid`)
 * that it faces: -1: none. */
static int nearest_face(const pe_solid *solid, const pe_solid *of, const pe_bvh_pair *seen,
                        int vertex, pe_vec3 x, double slack, double *depth, bool *strict)
{
    pe_node point = pe_box_node(x, pe_v3(0, 0, 0));
    pe_bvh_pair trees = around(&point, solid);
    pe_bvh_walk walk;
    const pe_node *node, *leaf;
    int found = -1;
    *depth = HUGE_VAL;
    pe_bvh_begin(&trees, &walk);
    while (pe_bvh_next(&trees, &walk, *depth, &node, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            pe_facet facet;
            pe_solid_facet(solid, leaf->first + i, &facet);
            double d = facet.offset - pe_dot(facet.normal, x);
            bool is_strict;
            if (d > 0 && d < *depth && pe_facet_holds(&facet, x, slack) &&
                pe_vertex_faces(of, vertex, pe_unrotate(&seen->turn, facet.normal), &is_strict)) {
                *depth = d;
                *strict = is_strict;
                found = facet.face;
            }
        }
    }
    return found;
}

typedef struct crossing {
    const pe_facet *a, *b;
    const double *above_a, *above_b; /* heights of the other's corners */
    int count;
    const pe_vec3 *where; /* (count) */
} crossing;

typedef void take_crossing(void *context, const crossing *c);

typedef struct crossings {
    double slack;
    take_crossing *take;
    void *context;
} crossings;

static bool try_facets(void *context, pe_facet *a, pe_facet *b)
{
    const crossings *c = context;
    double above_a[3] = {0}, above_b[3];
    pe_vec3 where[PE_MOST_PIERCINGS];
    if (pe_facet_heights(b, a, c->slack, above_b) &&
        (a->face < 0 || pe_facet_heights(a, b, c->slack, above_a))) {
        int count = pe_facets_cross(a, above_b, b, above_a, c->slack, where);
        if (count > 0) {
            c->take(c->context, &(crossing){a, b, above_a, above_b, count, where});
        }
    }
    return true;
}

/* Hands over each two triangles that cross, and where they do. */
static void each_crossing(const pe_solid_pair *pair, take_crossing *take, void *context)
{
    crossings c = {pair->slack, take, context};
    double bound = pair->slack;
    pe_near_facets(pair, &bound, try_facets, &c);
}

/* One solid's vertices in the other. */
typedef struct diver {
    const pe_solid_pair *pair;
    bool of_a; /* the vertices are a's */
    const pe_solid *of, *in;
    const pe_bvh_pair *seen; /* `of` in the axes of `in` */
    bool *visited;
    int *stack, depth;
    pe_touches *list;
} diver;

static void visit(diver *d, int vertex)
{
    if (!d->visited[vertex]) {
        d->visited[vertex] = true;
        d->stack[d->depth++] = vertex;
    }
}

static void add(const diver *d, int vertex, pe_vec3 x, int face, double depth, bool strict)
{
    const pe_solid_pair *pair = d->pair;
    pe_vec3 n = d->in->faces[face].normal;
    pe_touch_kind kind = d->of_a ? PE_VERTEX_FACE : PE_FACE_VERTEX;
    pe_touch touch = {.feature = pe_touch_feature(kind, vertex, face), .kind = kind};
    touch.separation = -depth - pair->radius;
    touch.strict = strict;
    if (d->of_a) {
        touch.normal = pe_scale(-1, n);
        touch.on_a = x;
    } else {
        touch.normal = pe_rotate(&pair->trees.turn, n);
        touch.on_a = pe_add(pe_rotate(&pair->trees.turn, pe_madd(x, depth, n)), pair->trees.offset);
    }
    pe_touches_add(d->list, &touch);
}

static void dive(diver *d)
{
    const pe_solid *of = d->of;
    while (d->depth > 0) {
        int vertex = d->stack[--d->depth];
        pe_vec3 x = pe_add(pe_rotate(&d->seen->turn, of->vertices[vertex]), d->seen->offset);
        if (!pe_solid_holds(d->in, x)) {
            continue;
        }
        double depth;
        bool strict;
        int face = nearest_face(d->in, of, d->seen, vertex, x, d->pair->slack, &depth, &strict);
        if (face >= 0) {
            add(d, vertex, x, face, depth, strict);
        }
        for (int i = of->vertex_first[vertex]; i < of->vertex_first[vertex + 1]; ++i) {
            const pe_edge *edge = &of->edges[of->vertex_edges[i]];
            visit(d, edge->vertex[edge->vertex[0] == vertex]);
        }
    }
}

/* False: out of memory. */
static bool begin(diver *d)
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

/* Corners farther behind the other triangle than `depth`, but not past all of its solid. */
static void visit_behind(diver *d, const pe_facet *facet, const double height[3], double depth)
{
    const pe_bvh_pair *trees = &d->pair->trees;
    for (int k = 0; k < 3; ++k) {
        double along = pe_dot(trees->parting, facet->x[k]);
        if (height[k] < -depth && (d->of_a ? along > trees->least_b : along < trees->most_a)) {
            visit(d, facet->vertices[k]);
        }
    }
}

typedef struct divers {
    diver a, b;
    double depth;
} divers;

/* The corners of crossing triangles that lie behind each other. */
static void visit_crossing(void *context, const crossing *c)
{
    divers *d = context;
    visit_behind(&d->a, c->a, c->above_b, d->depth);
    visit_behind(&d->b, c->b, c->above_a, d->depth);
}

static void visit_all(diver *d)
{
    for (int v = 0; v < d->of->vertex_count; ++v) {
        visit(d, v);
    }
}

void pe_touches_find_deep(const pe_solid_pair *pair, double depth, bool all, pe_touches *list)
{
    divers d = {
        .a = {pair, true, &pair->a, &pair->b, &pair->trees, .list = list},
        .b = {pair, false, &pair->b, &pair->a, &pair->swapped, .list = list},
        .depth = depth,
    };
    if (!begin(&d.a) || !begin(&d.b)) {
        return;
    }
    if (all) {
        visit_all(&d.a);
        visit_all(&d.b);
    } else {
        each_crossing(pair, visit_crossing, &d);
    }
    dive(&d.a);
    if (!pair->a.core) {
        dive(&d.b);
    }
}

/* How far the solids reach past each other along the unit direction n, from a to b. */
static double overlap(const pe_solid_pair *pair, pe_vec3 n)
{
    pe_vec3 back = pe_unrotate(&pair->trees.turn, n);
    return pe_dot(back, pe_solid_support(&pair->a, back)) + pe_dot(n, pair->trees.offset) -
           pe_dot(n, pe_solid_support(&pair->b, pe_scale(-1, n)));
}

pe_vec3 pe_solid_nearest_point(const pe_solid *solid, pe_vec3 x)
{
    pe_node point = pe_box_node(x, pe_v3(0, 0, 0));
    pe_bvh_pair trees = around(&point, solid);
    pe_bvh_walk walk;
    const pe_node *node, *leaf;
    double bound = HUGE_VAL;
    pe_vec3 best = x;
    pe_bvh_begin(&trees, &walk);
    while (pe_bvh_next(&trees, &walk, bound, &node, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            pe_facet facet;
            pe_solid_facet(solid, leaf->first + i, &facet);
            pe_vec3 y = nearest_point(&facet, x);
            double distance = pe_length(pe_sub(y, x));
            if (distance < bound) {
                bound = distance;
                best = y;
            }
        }
    }
    return best;
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

/* How far it is from x, along d, to where the surface is crossed outwards, in units of d; 0: it is
 * not crossed within d. What is met within the slack counts, so that rounding does not decide. */
static double way_to_exit(const pe_solid *solid, pe_vec3 x, pe_vec3 d, double slack)
{
    double least_rise = LEAST_RISE * pe_length(d);
    pe_node segment =
        pe_box_node(pe_madd(x, 0.5, d), pe_scale(0.5, pe_v3(fabs(d.x), fabs(d.y), fabs(d.z))));
    pe_bvh_pair trees = around(&segment, solid);
    pe_bvh_walk walk;
    const pe_node *node, *leaf;
    double first = HUGE_VAL;
    pe_bvh_begin(&trees, &walk);
    while (pe_bvh_next(&trees, &walk, slack, &node, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            pe_facet facet;
            pe_solid_facet(solid, leaf->first + i, &facet);
            double from = facet.offset - pe_dot(facet.normal, x), rise = pe_dot(facet.normal, d);
            if (from < -slack || from > rise + slack || rise < least_rise) {
                continue;
            }
            double t = pe_max(0, from) / rise;
            if (t < first && pe_facet_holds(&facet, pe_madd(x, t, d), slack)) {
                first = t;
            }
        }
    }
    return first < HUGE_VAL ? first : 0;
}

typedef struct way_out {
    const pe_solid_pair *pair;
    double least; /* m, overlap along n */
    pe_vec3 n;
    pe_touch touch;
} way_out;

static void try_normals(void *context, const crossing *c)
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

static void measure_at(way_out *w, pe_vec3 where)
{
    const pe_solid_pair *pair = w->pair;
    pe_vec3 way = pe_scale(w->least, w->n);
    double in_a = 0, in_b = w->least * way_to_exit(&pair->b, where, pe_scale(-1, way), pair->slack);
    if (!pair->a.core) {
        pe_vec3 x = pe_unrotate(&pair->trees.turn, pe_sub(where, pair->trees.offset));
        in_a =
            w->least * way_to_exit(&pair->a, x, pe_unrotate(&pair->trees.turn, way), pair->slack);
    }
    double separation = -in_a - in_b - pair->radius;
    if (separation < w->touch.separation) {
        w->touch.separation = separation;
        w->touch.on_a = pe_madd(where, in_a, w->n);
    }
}

static void measure(void *context, const crossing *c)
{
    for (int i = 0; i < c->count; ++i) {
        measure_at(context, c->where[i]);
    }
}

/* A core's ends, and what lies wholly inside, leave by the nearest way. Else the direction is that,
 * of the normals of triangles that cross, along which the solids as a whole reach least past each
 * other, so that it never leads further in; the depth is the most that lies along it, in both,
 * where triangles cross. */
void pe_touches_find_way_out(const pe_solid_pair *pair, const pe_nearest *nearest, pe_touches *list)
{
    if (pair->a.core && find_way_out_of_ends(pair, list)) {
        return;
    }
    way_out w = {
        .pair = pair,
        .least = HUGE_VAL,
        .touch = {.feature = pe_touch_feature(PE_VERTEX_VERTEX, 0, pair->b.vertex_count),
                  .kind = PE_VERTEX_VERTEX,
                  .separation = HUGE_VAL},
    };
    if (nearest->cross) {
        each_crossing(pair, try_normals, &w);
        each_crossing(pair, measure, &w);
        w.touch.normal = w.n;
    } else {
        bool of_face = nearest->touch.kind <= PE_FACE_VERTEX;
        w.touch.normal = pe_scale(of_face ? 1 : -1, nearest->touch.normal);
        w.touch.on_a = nearest->touch.on_a;
        w.touch.separation = -nearest->distance - pair->radius;
    }
    if (w.touch.separation < HUGE_VAL) {
        pe_touches_add(list, &w.touch);
    }
}
