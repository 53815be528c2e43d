#include "surface.h"

#include <stdlib.h>
#include <string.h>

enum { LEAF = 2, MAX_DEPTH = 64 };

/* ---- Vertices and triangles ---- */

/* Allocates all arrays and copies the vertices and triangles. */
static void fill(pl_surface *s, pl_arena *arena, const pl_polyhedron *source)
{
    size_t v = (size_t)source->vertex_count, t = (size_t)source->triangle_count;
    s->vertex_count = source->vertex_count;
    s->triangle_count = source->triangle_count;
    s->vertices = pl_arena_take(arena, v, sizeof *s->vertices);
    s->triangles = pl_arena_take(arena, t, sizeof *s->triangles);
    s->normals = pl_arena_take(arena, t, sizeof *s->normals);
    s->sides = pl_arena_take(arena, t, sizeof *s->sides);
    s->edges = pl_arena_take(arena, 3 * t, sizeof *s->edges);
    s->vertex_normals = pl_arena_take(arena, v, sizeof *s->vertex_normals);
    s->ring_start = pl_arena_take(arena, v + 1, sizeof *s->ring_start);
    s->ring = pl_arena_take(arena, 6 * t, sizeof *s->ring);
    s->parts = pl_arena_take(arena, v, sizeof *s->parts);
    s->nodes = pl_arena_take(arena, 2 * t, sizeof *s->nodes);
    s->order = pl_arena_take(arena, t, sizeof *s->order);
    for (int i = 0; i < s->vertex_count; ++i) {
        s->vertices[i] = pl_vec_of(source->vertices[i]);
    }
    memcpy(s->triangles, source->triangles, t * sizeof *s->triangles);
}

pl_triangle pl_surface_triangle(const pl_surface *s, int triangle)
{
    const int *t = s->triangles[triangle];
    return (pl_triangle){{s->vertices[t[0]], s->vertices[t[1]], s->vertices[t[2]]}};
}

/* ---- Normals and edges ---- */

static pl_vec unit(pl_vec v)
{
    double length = pl_vec_length(v);
    return length > 0 ? pl_vec_scale(v, 1 / length) : v;
}

static void find_normals(pl_surface *s)
{
    for (int t = 0; t < s->triangle_count; ++t) {
        pl_triangle tri = pl_surface_triangle(s, t);
        pl_vec u = pl_vec_sub(tri.corner[1], tri.corner[0]);
        pl_vec v = pl_vec_sub(tri.corner[2], tri.corner[0]);
        s->normals[t] = unit(pl_vec_cross(u, v));
        for (int k = 0; k < 3; ++k) {
            u = pl_vec_sub(tri.corner[(k + 1) % 3], tri.corner[k]);
            v = pl_vec_sub(tri.corner[(k + 2) % 3], tri.corner[k]);
            double angle = atan2(pl_vec_length(pl_vec_cross(u, v)), pl_vec_dot(u, v));
            pl_vec *sum = &s->vertex_normals[s->triangles[t][k]];
            *sum = pl_vec_mad(*sum, angle, s->normals[t]);
        }
    }
}

/* A side of a triangle, with its lower vertex first. */
typedef struct side {
    int low, high, triangle, corner;
} side;

static int compare_sides(const void *left, const void *right)
{
    const side *a = left, *b = right;
    if (a->low != b->low) {
        return a->low < b->low ? -1 : 1;
    }
    if (a->high != b->high) {
        return a->high < b->high ? -1 : 1;
    }
    return a->triangle != b->triangle ? (a->triangle < b->triangle ? -1 : 1)
                                      : a->corner - b->corner;
}

/* Makes one edge of the equal sides of several triangles. Sides without length, as in a capsule's
 * core, are left out. */
static void find_edges(pl_surface *s, pl_arena *scratch)
{
    int count = 0;
    find_normals(s);
    side *sides = pl_arena_take(scratch, 3 * (size_t)s->triangle_count, sizeof *sides);
    for (int t = 0; t < s->triangle_count; ++t) {
        for (int k = 0; k < 3; ++k) {
            int from = s->triangles[t][k], to = s->triangles[t][(k + 1) % 3];
            if (from != to) {
                sides[count++] = (side){from < to ? from : to, from < to ? to : from, t, k};
            }
        }
    }
    qsort(sides, (size_t)count, sizeof *sides, compare_sides);
    for (int i = 0; i < count; ++i) {
        if (i == 0 || sides[i].low != sides[i - 1].low || sides[i].high != sides[i - 1].high) {
            s->edges[s->edge_count++] = (pl_surface_edge){
                .start = sides[i].low, .end = sides[i].high, .triangle = sides[i].triangle};
        }
        pl_surface_edge *edge = &s->edges[s->edge_count - 1];
        edge->normal = pl_vec_add(edge->normal, s->normals[sides[i].triangle]);
        s->sides[sides[i].triangle][sides[i].corner] = s->edge_count - 1;
    }
}

/* ---- Neighbours and connected parts ---- */

static void find_rings(pl_surface *s)
{
    for (int e = 0; e < s->edge_count; ++e) {
        s->ring_start[s->edges[e].start] += 1;
        s->ring_start[s->edges[e].end] += 1;
    }
    int sum = 0;
    for (int i = 0; i <= s->vertex_count; ++i) {
        sum += s->ring_start[i];
        s->ring_start[i] = sum; /* the end; the next loop moves it to the start */
    }
    for (int e = 0; e < s->edge_count; ++e) {
        s->ring[--s->ring_start[s->edges[e].start]] = e;
        s->ring[--s->ring_start[s->edges[e].end]] = e;
    }
}

static void find_parts(pl_surface *s, pl_arena *scratch)
{
    find_rings(s);
    bool *seen = pl_arena_take(scratch, (size_t)s->vertex_count, sizeof *seen);
    int *stack = pl_arena_take(scratch, (size_t)s->vertex_count, sizeof *stack);
    for (int i = 0; i < s->vertex_count; ++i) {
        if (seen[i]) {
            continue;
        }
        int height = 0;
        s->parts[s->part_count++] = i;
        seen[i] = true;
        stack[height++] = i;
        while (height > 0) {
            int v = stack[--height];
            for (int k = s->ring_start[v]; k < s->ring_start[v + 1]; ++k) {
                int other = s->edges[s->ring[k]].start + s->edges[s->ring[k]].end - v;
                if (!seen[other]) {
                    seen[other] = true;
                    stack[height++] = other;
                }
            }
        }
    }
}

/* ---- Tree: halves by the median along the widest axis of the triangles' centroids ---- */

/* A triangle to be sorted into the tree. */
typedef struct item {
    double centroid[3];
    int triangle;
    int axis; /* to sort by */
} item;

static int compare_items(const void *left, const void *right)
{
    const item *a = left, *b = right;
    double difference = a->centroid[a->axis] - b->centroid[b->axis];
    return difference < 0 ? -1 : difference > 0 ? 1 : a->triangle - b->triangle;
}

static int widest_axis(const item *items, int count)
{
    int widest = 0;
    double most = -1;
    for (int k = 0; k < 3; ++k) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int i = 0; i < count; ++i) {
            low = fmin(low, items[i].centroid[k]);
            high = fmax(high, items[i].centroid[k]);
        }
        if (high - low > most) {
            most = high - low;
            widest = k;
        }
    }
    return widest;
}

static void enclose(const pl_surface *s, const item *items, int count, pl_surface_node *node)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i < count; ++i) {
        pl_triangle t = pl_surface_triangle(s, items[i].triangle);
        for (int c = 0; c < 3; ++c) {
            double p[3];
            pl_vec_store(t.corner[c], p);
            for (int k = 0; k < 3; ++k) {
                low[k] = fmin(low[k], p[k]);
                high[k] = fmax(high[k], p[k]);
            }
        }
    }
    node->centre = pl_vec_scale(pl_vec_add(pl_vec_of(low), pl_vec_of(high)), 0.5);
    node->half = pl_vec_scale(pl_vec_sub(pl_vec_of(high), pl_vec_of(low)), 0.5);
}

/* Makes the node of `count` items, which become order[first .. first + count). The depth of the
 * tree is at most 1 + log2(triangles). */
static void build_node(pl_surface *s, item *items, int first, int count)
{
    int index = s->node_count++;
    pl_surface_node *node = &s->nodes[index];
    enclose(s, items, count, node);
    if (count <= LEAF) {
        node->first = first;
        node->count = count;
        for (int i = 0; i < count; ++i) {
            s->order[first + i] = items[i].triangle;
        }
        return;
    }
    int axis = widest_axis(items, count), half = count / 2;
    for (int i = 0; i < count; ++i) {
        items[i].axis = axis;
    }
    qsort(items, (size_t)count, sizeof *items, compare_items);
    build_node(s, items, first, half);
    node->second = s->node_count;
    build_node(s, items + half, first + half, count - half);
}

static void build_tree(pl_surface *s, pl_arena *scratch)
{
    item *items = pl_arena_take(scratch, (size_t)s->triangle_count, sizeof *items);
    for (int t = 0; t < s->triangle_count; ++t) {
        pl_triangle tri = pl_surface_triangle(s, t);
        pl_vec sum = pl_vec_add(tri.corner[0], pl_vec_add(tri.corner[1], tri.corner[2]));
        items[t].triangle = t;
        pl_vec_store(pl_vec_scale(sum, 1.0 / 3), items[t].centroid);
    }
    build_node(s, items, 0, s->triangle_count);
}

const pl_surface *pl_surface_create(const pl_shape *shape, pl_arena *arena)
{
    int box[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    int segment[1][3] = {{0, 1, 1}};
    double ends[2][3] = {{0, 0, -shape->half_height}, {0, 0, shape->half_height}};
    double corners[8][3];
    pl_polyhedron source = {.vertices = corners, .vertex_count = 8};
    switch (shape->kind) {
    case PL_SHAPE_BOX:
        for (int i = 0; i < 8; ++i) {
            for (int k = 0; k < 3; ++k) {
                double half = shape->half_extents[k];
                corners[i][k] = (i >> k & 1) != 0 ? half : -half;
            }
        }
        source.triangles = box;
        source.triangle_count = 12;
        break;
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        source = *shape->polyhedron;
        break;
    case PL_SHAPE_CAPSULE:
        source = (pl_polyhedron){
            .vertices = ends, .vertex_count = 2, .triangles = segment, .triangle_count = 1};
        break;
    case PL_SHAPE_PLANE:
    case PL_SHAPE_SPHERE:
    case PL_SHAPE_CYLINDER:
        return NULL;
    }
    pl_surface *s = pl_arena_take(arena, 1, sizeof *s);
    pl_arena scratch = {0};
    fill(s, arena, &source);
    s->closed = shape->kind != PL_SHAPE_CAPSULE;
    find_edges(s, &scratch);
    find_parts(s, &scratch);
    build_tree(s, &scratch);
    pl_arena_free(&scratch);
    return s;
}

/* ---- Queries ---- */

/* The squared distance of a point from a node's box, m^2. */
static double box_square(const pl_surface_node *node, pl_vec point)
{
    pl_vec d = {fmax(fabs(point.x - node->centre.x) - node->half.x, 0),
                fmax(fabs(point.y - node->centre.y) - node->half.y, 0),
                fmax(fabs(point.z - node->centre.z) - node->half.z, 0)};
    return pl_vec_dot(d, d);
}

bool pl_surface_box_holds(const pl_surface *s, pl_vec point, double margin)
{
    return box_square(&s->nodes[0], point) <= margin * margin;
}

static pl_vec feature_normal(const pl_surface *s, int triangle, pl_feature feature)
{
    if (feature == PL_FACE) {
        return s->normals[triangle];
    }
    if (feature >= PL_EDGE_0) {
        return s->edges[s->sides[triangle][feature - PL_EDGE_0]].normal;
    }
    return s->vertex_normals[s->triangles[triangle][feature - PL_CORNER_0]];
}

pl_surface_point pl_surface_nearest(const pl_surface *s, pl_vec point)
{
    pl_surface_point best = {.triangle = s->order[0]};
    pl_feature on = PL_FACE;
    double least = HUGE_VAL;
    int stack[MAX_DEPTH], height = 0;
    stack[height++] = 0;
    while (height > 0) {
        int index = stack[--height];
        const pl_surface_node *node = &s->nodes[index];
        if (box_square(node, point) >= least) {
            continue;
        }
        for (int i = 0; i < node->count; ++i) {
            int t = s->order[node->first + i];
            pl_triangle triangle = pl_surface_triangle(s, t);
            pl_feature feature;
            pl_vec q = pl_triangle_nearest(&triangle, point, &feature);
            pl_vec d = pl_vec_sub(point, q);
            if (pl_vec_dot(d, d) < least) {
                least = pl_vec_dot(d, d);
                best.point = q;
                best.triangle = t;
                on = feature;
            }
        }
        if (node->count == 0) {
            bool first_nearer = box_square(&s->nodes[index + 1], point) <=
                                box_square(&s->nodes[node->second], point);
            stack[height++] = first_nearer ? node->second : index + 1;
            stack[height++] = first_nearer ? index + 1 : node->second;
        }
    }
    pl_vec out = feature_normal(s, best.triangle, on);
    bool inside = s->closed && pl_vec_dot(out, pl_vec_sub(point, best.point)) < 0;
    best.distance = inside ? -sqrt(least) : sqrt(least);
    return best;
}

void pl_surface_each_near(const pl_surface *s, pl_vec centre, pl_vec half,
                          void (*see)(void *context, int triangle), void *context)
{
    int stack[MAX_DEPTH], height = 0;
    stack[height++] = 0;
    while (height > 0) {
        int index = stack[--height];
        const pl_surface_node *node = &s->nodes[index];
        pl_vec d = pl_vec_sub(node->centre, centre);
        if (fabs(d.x) > node->half.x + half.x || fabs(d.y) > node->half.y + half.y ||
            fabs(d.z) > node->half.z + half.z) {
            continue;
        }
        for (int i = 0; i < node->count; ++i) {
            see(context, s->order[node->first + i]);
        }
        if (node->count == 0) {
            stack[height++] = node->second;
            stack[height++] = index + 1;
        }
    }
}
