/* Top down: the triangles of a node are halved by number along the axis on which their middles are
 * spread widest. Halving by number bounds the depth, and the node's place in the array says where
 * its children are. */
#include "geometry_tree.h"

#include <stdlib.h>
#include <string.h>

enum { LEAF = 4 }; /* triangles at most */

typedef struct item {
    double key;
    pe_vec3 middle, low, high;
    int triangle;
} item;

static int by_key(const void *a, const void *b)
{
    const item *p = a, *q = b;
    if (p->key != q->key) {
        return p->key < q->key ? -1 : 1;
    }
    return p->triangle < q->triangle ? -1 : p->triangle > q->triangle;
}

static pe_vec3 lower(pe_vec3 a, pe_vec3 b)
{
    return pe_v3(pe_min(a.x, b.x), pe_min(a.y, b.y), pe_min(a.z, b.z));
}

static pe_vec3 higher(pe_vec3 a, pe_vec3 b)
{
    return pe_v3(pe_max(a.x, b.x), pe_max(a.y, b.y), pe_max(a.z, b.z));
}

static item item_of(const pe_geometry *g, int triangle)
{
    const int *t = g->triangles[triangle];
    pe_vec3 a = g->vertices[t[0]], b = g->vertices[t[1]], c = g->vertices[t[2]];
    return (item){
        .middle = pe_scale(1.0 / 3, pe_add(a, pe_add(b, c))),
        .low = lower(a, lower(b, c)),
        .high = higher(a, higher(b, c)),
        .triangle = triangle,
    };
}

/* Makes the node of the items and all below it; its index is the one after the last so far. */
static void make_node(pe_geometry *g, item *items, int first, int count)
{
    pe_vec3 low = items[0].low, high = items[0].high;
    pe_vec3 least = items[0].middle, most = items[0].middle;
    for (int i = 1; i < count; ++i) {
        low = lower(low, items[i].low);
        high = higher(high, items[i].high);
        least = lower(least, items[i].middle);
        most = higher(most, items[i].middle);
    }
    pe_node *node = &g->nodes[g->node_count++];
    *node = (pe_node){
        .centre = pe_scale(0.5, pe_add(low, high)),
        .half = pe_scale(0.5, pe_sub(high, low)),
        .right = -1,
        .first = first,
        .count = count,
    };
    if (count <= LEAF) {
        return;
    }
    pe_vec3 spread = pe_sub(most, least);
    int axis = spread.x >= spread.y && spread.x >= spread.z ? 0 : spread.y >= spread.z ? 1 : 2;
    for (int i = 0; i < count; ++i) {
        items[i].key = pe_component(items[i].middle, axis);
    }
    qsort(items, (size_t)count, sizeof *items, by_key);
    int half = count / 2;
    make_node(g, items, first, half);
    node->right = g->node_count;
    make_node(g, items + half, first + half, count - half);
}

/* Puts rows of `stride` bytes in the order of the items. */
static void reorder(void *rows, void *copy, size_t stride, const item *items, int count)
{
    memcpy(copy, rows, (size_t)count * stride);
    for (int i = 0; i < count; ++i) {
        memcpy((char *)rows + (size_t)i * stride,
               (const char *)copy + (size_t)items[i].triangle * stride, stride);
    }
}

/* Deals out the features: see triangle_owns. */
static void find_owners(pe_geometry *g, bool *taken)
{
    memset(taken, 0, (size_t)g->vertex_count * sizeof *taken);
    for (int i = 0; i < g->triangle_count; ++i) {
        unsigned owns = 0;
        for (int k = 0; k < 3; ++k) {
            int v = g->triangles[i][k], e = g->triangle_edges[i][k];
            if (!taken[v] && g->vertex_first[v + 1] > g->vertex_first[v]) {
                taken[v] = true;
                owns |= 1u << k;
            }
            if (e >= 0 && g->edges[e].convex && g->edges[e].face[0] == g->triangle_face[i]) {
                owns |= 8u << k;
            }
        }
        g->triangle_owns[i] = (unsigned char)owns;
    }
}

pe_status pe_geometry_make_tree(pe_geometry *g, const pe_allocator *allocator, pe_workspace work,
                                pe_error *error)
{
    int n = g->triangle_count;
    item *items = pe_take(work, (size_t)n, sizeof *items);
    void *copy = pe_take(work, (size_t)n, sizeof *g->triangles);
    g->nodes = pe_arena_take(&g->arena, allocator, 2 * (size_t)n, sizeof *g->nodes);
    bool *taken = pe_take(work, (size_t)g->vertex_count, sizeof *taken);
    g->triangle_owns = pe_arena_take(&g->arena, allocator, (size_t)n, sizeof *g->triangle_owns);
    if (items == NULL || copy == NULL || taken == NULL || g->nodes == NULL ||
        g->triangle_owns == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for a tree of %d triangles", n);
    }
    for (int i = 0; i < n; ++i) {
        items[i] = item_of(g, i);
    }
    g->node_count = 0;
    make_node(g, items, 0, n);
    reorder(g->triangles, copy, sizeof *g->triangles, items, n);
    reorder(g->triangle_edges, copy, sizeof *g->triangle_edges, items, n);
    reorder(g->triangle_face, copy, sizeof *g->triangle_face, items, n);
    find_owners(g, taken);
    return PE_OK;
}
