/* Vertices that lie deep in the other solid.
 *
 * Where two surfaces cross, the corners behind the crossing triangles are looked at, and from those
 * that lie inside their neighbours along the edges, so that the work goes with what lies inside. A
 * vertex inside touches the nearest face that it faces and above which it would come out, unless
 * another part of the surface lies between. */
#include "collide_mesh.h"

#include <string.h>

/* Cosine of faces below which one looks the other way. */
static const double OPPOSITE = -0.3;

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
    pe_bvh_pair trees = pe_solid_around(&segment, solid);
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

/* A face over a vertex. */
typedef struct roof {
    int face; /* -1: none */
    double depth;
    bool strict;
} roof;

/* The nearest face over the vertex (of `of`, at x and with its axes turned into those of `solid`)
 * that it faces. One that it faces on the far side of where it came in is none: the nearest face of
 * all looks the other way, and is nearer. */
static roof nearest_face(const pe_solid *solid, const pe_solid *of, const pe_bvh_pair *seen,
                         int vertex, pe_vec3 x, double slack)
{
    pe_node point = pe_box_node(x, pe_v3(0, 0, 0));
    pe_bvh_pair trees = pe_solid_around(&point, solid);
    pe_bvh_walk walk;
    const pe_node *node, *leaf;
    roof found = {-1, HUGE_VAL, false}, nearest = found;
    pe_bvh_begin(&trees, &walk);
    while (pe_bvh_next(&trees, &walk, found.depth, &node, &leaf)) {
        for (int i = 0; i < leaf->count; ++i) {
            pe_facet facet;
            pe_solid_facet(solid, leaf->first + i, &facet);
            roof here = {facet.face, facet.offset - pe_dot(facet.normal, x), false};
            if (!(here.depth > 0) || here.depth >= found.depth ||
                !pe_facet_holds(&facet, x, slack)) {
                continue;
            }
            nearest = here.depth < nearest.depth ? here : nearest;
            if (pe_vertex_faces(of, vertex, pe_unrotate(&seen->turn, facet.normal), &here.strict)) {
                found = here;
            }
        }
    }
    if (found.face >= 0 &&
        pe_dot(solid->faces[found.face].normal, solid->faces[nearest.face].normal) < OPPOSITE) {
        found.face = -1;
    }
    return found;
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

static void add(const diver *d, int vertex, pe_vec3 x, const roof *over)
{
    const pe_solid_pair *pair = d->pair;
    pe_vec3 n = d->in->faces[over->face].normal;
    pe_touch_kind kind = d->of_a ? PE_VERTEX_FACE : PE_FACE_VERTEX;
    pe_touch touch = {.feature = pe_touch_feature(kind, vertex, over->face), .kind = kind};
    touch.separation = -over->depth - pair->radius;
    touch.strict = over->strict;
    if (d->of_a) {
        touch.normal = pe_scale(-1, n);
        touch.on_a = x;
    } else {
        touch.normal = pe_rotate(&pair->trees.turn, n);
        touch.on_a =
            pe_add(pe_rotate(&pair->trees.turn, pe_madd(x, over->depth, n)), pair->trees.offset);
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
        roof over = nearest_face(d->in, of, d->seen, vertex, x, d->pair->slack);
        if (over.face >= 0) {
            add(d, vertex, x, &over);
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
static void visit_crossing(void *context, const pe_crossing *c)
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
        pe_solids_each_crossing(pair, visit_crossing, &d);
    }
    dive(&d.a);
    if (!pair->a.core) {
        dive(&d.b);
    }
}
