/* A tree of oriented boxes (Gottschalk, Lin, Manocha 1996).
 *
 * Each box lies along the principal axes of its corners, or along the body's axes if that box is
 * smaller. Its triangles are halved by number along its longest axis. Halving by number bounds the
 * depth, and the node's place in the array gives those of its children. */
#include "geometry_build.h"

#include <stdlib.h>
#include <string.h>

enum { LEAF = 2 }; /* triangles at most */

typedef struct item {
    double key;
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

static pe_vec3 corner_of(const pe_geometry *g, const item *items, int i)
{
    return g->vertices[g->triangles[items[i / 3].triangle][i % 3]];
}

/* Fits the node's box, along the axes, to the triangles. */
static void fit(const pe_geometry *g, const item *items, int count, const pe_mat3 *axes,
                pe_node *node)
{
    pe_vec3 low = pe_v3(HUGE_VAL, HUGE_VAL, HUGE_VAL), high = pe_scale(-1, low);
    for (int i = 0; i < 3 * count; ++i) {
        pe_vec3 x = pe_rotate(axes, corner_of(g, items, i));
        low = pe_v3(pe_min(low.x, x.x), pe_min(low.y, x.y), pe_min(low.z, x.z));
        high = pe_v3(pe_max(high.x, x.x), pe_max(high.y, x.y), pe_max(high.z, x.z));
    }
    node->axes = *axes;
    node->centre = pe_unrotate(axes, pe_scale(0.5, pe_add(low, high)));
    node->half = pe_scale(0.5, pe_sub(high, low));
    node->radius = pe_length(node->half);
}

/* Rows: the principal axes of the corners' scatter about their mean. */
static pe_mat3 principal_axes_of(const pe_geometry *g, const item *items, int count)
{
    pe_vec3 mean = pe_v3(0, 0, 0);
    for (int i = 0; i < 3 * count; ++i) {
        mean = pe_madd(mean, 1.0 / (3 * count), corner_of(g, items, i));
    }
    double a[3][3] = {{0}}, axes[3][3];
    for (int i = 0; i < 3 * count; ++i) {
        pe_vec3 d = pe_sub(corner_of(g, items, i), mean);
        const double x[3] = {d.x, d.y, d.z};
        for (int k = 0; k < 9; ++k) {
            a[k / 3][k % 3] += x[k / 3] * x[k % 3];
        }
    }
    pe_principal_axes(a, axes);
    return (pe_mat3){
        .r0 = {axes[0][0], axes[1][0], axes[2][0]},
        .r1 = {axes[0][1], axes[1][1], axes[2][1]},
        .r2 = {axes[0][2], axes[1][2], axes[2][2]},
    };
}

static double area(pe_vec3 half)
{
    return half.x * half.y + half.y * half.z + half.z * half.x;
}

/* Makes the node of the items and all nodes below it. Nodes are numbered as they are made. */
static void make_node(pe_geometry *g, item *items, int first, int count)
{
    const pe_mat3 own = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    pe_mat3 turned = principal_axes_of(g, items, count);
    pe_node *node = &g->nodes[g->node_count++], along_body;
    *node = along_body = (pe_node){.right = -1, .first = first, .count = count};
    fit(g, items, count, &turned, node);
    fit(g, items, count, &own, &along_body);
    if (!(area(node->half) < area(along_body.half))) {
        *node = along_body;
    }
    if (count <= LEAF) {
        return;
    }
    pe_vec3 h = node->half;
    pe_vec3 axis = h.x >= h.y && h.x >= h.z ? node->axes.r0
                   : h.y >= h.z             ? node->axes.r1
                                            : node->axes.r2;
    for (int i = 0; i < count; ++i) {
        pe_vec3 sum = pe_add(corner_of(g, items, 3 * i), corner_of(g, items, 3 * i + 1));
        items[i].key = pe_dot(axis, pe_add(sum, corner_of(g, items, 3 * i + 2)));
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

/* Assigns each feature to a triangle: see triangle_owns. */
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
        items[i] = (item){.triangle = i};
    }
    g->node_count = 0;
    make_node(g, items, 0, n);
    reorder(g->triangles, copy, sizeof *g->triangles, items, n);
    reorder(g->triangle_edges, copy, sizeof *g->triangle_edges, items, n);
    reorder(g->triangle_face, copy, sizeof *g->triangle_face, items, n);
    find_owners(g, taken);
    return PE_OK;
}
