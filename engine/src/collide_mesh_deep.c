/* Vertices that lie deep in the other solid.
 *
 * Where two surfaces cross, the corners behind the crossing triangles are looked at, and from those
 * that lie inside their neighbours along the edges, so that the work goes with what lies inside. A
 * vertex inside touches the nearest face that it faces and above which it would come out, unless
 * another part of the surface lies between. */
#include "collide_mesh.h"

#include <string.h>

static pe_node point_node(pe_vec3 x, pe_vec3 half)
{
    return (pe_node){.centre = x, .half = half, .right = -1, .count = 1};
}

/* A box about a segment or a point, and the tree of a solid in whose axes it is. */
static pe_bvh_pair around(const pe_node *node, const pe_solid *solid)
{
    pe_mat3 same = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    return pe_bvh_pair_of(node, solid->nodes, &same, pe_v3(0, 0, 0));
}

static void facet_of(const pe_solid *solid, int triangle, pe_facet *facet)
{
    facet->vertices = solid->triangles[triangle];
    facet->face = solid->triangle_face[triangle];
    for (int k = 0; k < 3; ++k) {
        facet->x[k] = solid->vertices[facet->vertices[k]];
    }
    facet->normal = solid->faces[facet->face].normal;
    facet->offset = solid->faces[facet->face].offset;
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
    pe_node point = point_node(x, pe_v3(0, 0, 0));
    pe_bvh_pair trees = around(&point, solid);
    pe_bvh_walk walk;
    const pe_node *node, *leaf;
    double bound = HUGE_VAL, steepest = 0, height = 0;
    pe_bvh_begin(&trees, &walk);
    while (pe_bvh_next(&trees, &walk, bound, &node, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            pe_facet facet;
            facet_of(solid, leaf->first + i, &facet);
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

/* Whether a triangle of another face crosses the way from x along d, both ends apart. */
static bool blocked(const pe_solid *solid, pe_vec3 x, pe_vec3 d, int face, double slack)
{
    pe_node segment = point_node(pe_madd(x, 0.5, d),
                                 pe_scale(0.5, pe_v3(fabs(d.x), fabs(d.y), fabs(d.z))));
    pe_bvh_pair trees = around(&segment, solid);
    pe_bvh_walk walk;
    const pe_node *node, *leaf;
    pe_bvh_begin(&trees, &walk);
    while (pe_bvh_next(&trees, &walk, 0, &node, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            pe_facet facet;
            facet_of(solid, leaf->first + i, &facet);
            double from = pe_dot(facet.normal, x) - facet.offset;
            double to = from + pe_dot(facet.normal, d);
            bool crosses = (from > slack && to < -slack) || (from < -slack && to > slack);
            if (!crosses || facet.face == face) {
                continue;
            }
            /* The point of crossing, not its foot, decides. */
            pe_vec3 y = pe_madd(x, from / (from - to), d);
            if (pe_facet_holds(&facet, y, 0)) {
                return true;
            }
        }
    }
    return false;
}

bool pe_touch_is_blocked(const pe_solid_pair *pair, const pe_touch *touch)
{
    double depth = -(touch->separation + pair->radius);
    int face = (int)(touch->feature & ((1u << 30) - 1));
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
                        int vertex, pe_vec3 x, double slack, double *depth)
{
    pe_node point = point_node(x, pe_v3(0, 0, 0));
    pe_bvh_pair trees = around(&point, solid);
    pe_bvh_walk walk;
    const pe_node *node, *leaf;
    int found = -1;
    *depth = HUGE_VAL;
    pe_bvh_begin(&trees, &walk);
    while (pe_bvh_next(&trees, &walk, *depth, &node, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            pe_facet facet;
            facet_of(solid, leaf->first + i, &facet);
            double d = facet.offset - pe_dot(facet.normal, x);
            if (d > 0 && d < *depth && pe_facet_holds(&facet, x, slack) &&
                pe_vertex_faces(of, vertex, pe_unrotate(&seen->turn, facet.normal))) {
                *depth = d;
                found = facet.face;
            }
        }
    }
    return found;
}

/* One solid's vertices in the other. */
typedef struct diver {
    const pe_solid_pair *pair;
    bool of_a;              /* the vertices are a's */
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

static void add(const diver *d, int vertex, pe_vec3 x, int face, double depth)
{
    const pe_solid_pair *pair = d->pair;
    pe_vec3 n = d->in->faces[face].normal;
    pe_touch_kind kind = d->of_a ? PE_VERTEX_FACE : PE_FACE_VERTEX;
    pe_touch touch = {.feature = pe_touch_feature(kind, vertex, face), .kind = kind};
    touch.separation = -depth - pair->radius;
    if (d->of_a) {
        touch.normal = pe_scale(-1, n);
        touch.on_a = x;
    } else {
        touch.normal = pe_rotate(&pair->trees.turn, n);
        touch.on_a = pe_add(pe_rotate(&pair->trees.turn, pe_madd(x, depth, n)),
                            pair->trees.offset);
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
        int face = nearest_face(d->in, of, d->seen, vertex, x, d->pair->slack, &depth);
        if (face >= 0) {
            add(d, vertex, x, face, depth);
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

static void visit_behind(diver *d, const pe_facet *facet, const double height[3], double reach)
{
    for (int k = 0; k < 3; ++k) {
        if (height[k] < -reach) {
            visit(d, facet->vertices[k]);
        }
    }
}

/* The corners of crossing triangles that lie behind each other. */
static void visit_crossings(const pe_solid_pair *pair, double reach, diver *a, diver *b)
{
    pe_bvh_walk walk;
    const pe_node *leaf_a, *leaf_b;
    pe_bvh_begin(&pair->trees, &walk);
    while (pe_bvh_next(&pair->trees, &walk, 0, &leaf_a, &leaf_b)) {
        for (int i = 0; i < leaf_a->count; ++i) {
            pe_facet fa, fb;
            pe_facet_of_a(pair, leaf_a->first + i, &fa);
            for (int j = 0; j < leaf_b->count; ++j) {
                double above_a[3] = {0}, above_b[3];
                pe_facet_of_b(pair, leaf_b->first + j, &fb);
                if (pe_facet_heights(&fb, &fa, 0, above_b) &&
                    (fa.face < 0 || pe_facet_heights(&fa, &fb, 0, above_a)) &&
                    pe_facets_cross(&fa, above_b, &fb, above_a)) {
                    visit_behind(a, &fa, above_b, reach);
                    visit_behind(b, &fb, above_a, reach);
                }
            }
        }
    }
}

static void visit_all(diver *d)
{
    for (int v = 0; v < d->of->vertex_count; ++v) {
        visit(d, v);
    }
}

void pe_touches_find_deep(const pe_solid_pair *pair, double reach, bool all, pe_touches *list)
{
    diver a = {.pair = pair, .of_a = true, .of = &pair->a, .in = &pair->b, .list = list};
    diver b = {.pair = pair, .of = &pair->b, .in = &pair->a, .list = list};
    a.seen = &pair->trees;
    b.seen = &pair->swapped;
    if (!begin(&a) || !begin(&b)) {
        return;
    }
    if (all) {
        visit_all(&a);
        visit_all(&b);
    } else {
        visit_crossings(pair, reach, &a, &b);
    }
    dive(&a);
    if (!pair->a.core) {
        dive(&b);
    }
}

/* How far the solids reach past each other along the unit direction n, from a to b. */
static double overlap(const pe_solid_pair *pair, pe_vec3 n)
{
    double most = -HUGE_VAL, least = HUGE_VAL;
    pe_vec3 back = pe_unrotate(&pair->trees.turn, n);
    for (int i = 0; i < pair->a.vertex_count; ++i) {
        most = pe_max(most, pe_dot(back, pair->a.vertices[i]));
    }
    for (int i = 0; i < pair->b.vertex_count; ++i) {
        least = pe_min(least, pe_dot(n, pair->b.vertices[i]));
    }
    return most + pe_dot(n, pair->trees.offset) - least;
}

/* The shortest way out among those along the normals of triangles that cross, all the way past the
 * other solid, which may be far but never leads further in. */
void pe_touches_find_way_out(const pe_solid_pair *pair, pe_touches *list)
{
    enum { MOST_TRIED = 16 };
    pe_bvh_walk walk;
    const pe_node *leaf_a, *leaf_b;
    int tried = 0;
    pe_touch best = {.feature = pe_touch_feature(PE_VERTEX_VERTEX, 0, 0),
                     .kind = PE_VERTEX_VERTEX,
                     .separation = -HUGE_VAL};
    pe_bvh_begin(&pair->trees, &walk);
    while (tried < MOST_TRIED && pe_bvh_next(&pair->trees, &walk, pair->slack, &leaf_a, &leaf_b)) {
        for (int i = 0; i < leaf_a->count; ++i) {
            pe_facet a, b;
            pe_facet_of_a(pair, leaf_a->first + i, &a);
            for (int j = 0; j < leaf_b->count && tried < MOST_TRIED; ++j) {
                pe_facet_of_b(pair, leaf_b->first + j, &b);
                for (int side = a.face < 0; side < 2; ++side) {
                    pe_vec3 n = side == 0 ? a.normal : pe_scale(-1, b.normal);
                    double depth = overlap(pair, n);
                    if (-depth > best.separation) {
                        best.separation = -depth;
                        best.normal = n;
                        best.on_a = pe_madd(b.x[0], 0.5 * depth, n);
                    }
                }
                tried += 1;
            }
        }
    }
    if (tried > 0) {
        best.separation -= pair->radius;
        pe_touches_add(list, &best);
    }
}
