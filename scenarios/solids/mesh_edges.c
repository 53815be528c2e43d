#include "mesh.h"

#include <stdlib.h>
#include <string.h>

/* One edge of one triangle. */
typedef struct half_edge {
    int low, high; /* vertices */
    int side;      /* 3 * triangle + corner where it begins */
} half_edge;

static int by_vertices_then_side(const void *left, const void *right)
{
    const half_edge *a = left, *b = right;
    if (a->low != b->low) {
        return a->low < b->low ? -1 : 1;
    }
    if (a->high != b->high) {
        return a->high < b->high ? -1 : 1;
    }
    return a->side < b->side ? -1 : 1;
}

static half_edge *sorted_edges(const int (*triangles)[3], int triangle_count)
{
    const size_t count = 3 * (size_t)triangle_count;
    half_edge *edges = malloc(count * sizeof *edges);
    if (edges == NULL) {
        return NULL;
    }
    for (int t = 0; t < triangle_count; ++t) {
        for (int k = 0; k < 3; ++k) {
            const int a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            edges[3 * t + k] = (half_edge){a < b ? a : b, a < b ? b : a, 3 * t + k};
        }
    }
    qsort(edges, count, sizeof *edges, by_vertices_then_side);
    return edges;
}

static bool diagnose_edge(const half_edge *edge, int uses, pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "triangles");
    pl_path_push_index(&diagnostic->path, edge->side / 3);
    if (uses == 1) {
        return pl_diagnose(diagnostic,
                           "expected a closed surface, each edge of two triangles, found triangle "
                           "%d alone at the edge of vertices %d and %d",
                           edge->side / 3, edge->low, edge->high);
    }
    return pl_diagnose(diagnostic,
                       "expected each edge to be of two triangles, found that of vertices %d and "
                       "%d in %d, such as triangles %d, %d and %d",
                       edge->low, edge->high, uses, edge[0].side / 3, edge[1].side / 3,
                       edge[2].side / 3);
}

bool pl_mesh_neighbours(const int (*triangles)[3], int triangle_count, int (*neighbours)[3],
                        pl_diagnostic *diagnostic)
{
    half_edge *edges = sorted_edges(triangles, triangle_count);
    if (edges == NULL) {
        return pl_diagnose_no_memory(diagnostic);
    }
    bool right = true;
    const int count = 3 * triangle_count;
    for (int i = 0, end; i < count && right; i = end) {
        end = i + 1;
        while (end < count && edges[end].low == edges[i].low && edges[end].high == edges[i].high) {
            ++end;
        }
        if (end - i != 2) {
            right = diagnose_edge(&edges[i], end - i, diagnostic);
        } else {
            const int a = edges[i].side, b = edges[i + 1].side;
            neighbours[a / 3][a % 3] = b / 3;
            neighbours[b / 3][b % 3] = a / 3;
        }
    }
    free(edges);
    return right;
}

/* Whether the triangle has an edge from vertex `from` to vertex `to`, in that order. */
static bool runs(const int triangle[3], int from, int to)
{
    return (triangle[0] == from && triangle[1] == to) ||
           (triangle[1] == from && triangle[2] == to) || (triangle[2] == from && triangle[0] == to);
}

typedef struct walk {
    const int (*triangles)[3];
    const int (*neighbours)[3];
    int *component; /* -1: not seen yet */
    bool *turned;
    int *queue;
} walk;

/* Goes through the component of triangle `first`, breadth first. */
static bool walk_component(walk *w, int first, int number, pl_diagnostic *diagnostic)
{
    int head = 0, tail = 0;
    w->queue[tail++] = first;
    w->component[first] = number;
    while (head < tail) {
        const int t = w->queue[head++];
        for (int k = 0; k < 3; ++k) {
            const int u = w->neighbours[t][k];
            const int from = w->triangles[t][k], to = w->triangles[t][(k + 1) % 3];
            const bool turned = w->turned[t] != runs(w->triangles[u], from, to);
            if (w->component[u] < 0) {
                w->component[u] = number;
                w->turned[u] = turned;
                w->queue[tail++] = u;
            } else if (w->turned[u] != turned) {
                pl_path_push_key(&diagnostic->path, "triangles");
                pl_path_push_index(&diagnostic->path, u);
                return pl_diagnose(diagnostic,
                                   "expected a surface with two sides, found that triangles %d and "
                                   "%d, with the edge of vertices %d and %d, cannot face the same",
                                   t, u, from, to);
            }
        }
    }
    return true;
}

bool pl_mesh_orient(int (*triangles)[3], int triangle_count, const int (*neighbours)[3],
                    int *component, int *component_count, pl_diagnostic *diagnostic)
{
    const size_t count = (size_t)triangle_count;
    walk w = {.triangles = (const int(*)[3])triangles,
              .neighbours = neighbours,
              .component = component,
              .turned = calloc(count, sizeof *w.turned),
              .queue = malloc(count * sizeof *w.queue)};
    bool right = w.turned != NULL && w.queue != NULL;
    if (!right) {
        pl_diagnose_no_memory(diagnostic);
    }
    memset(component, -1, count * sizeof *component);
    *component_count = 0;
    for (int t = 0; t < triangle_count && right; ++t) {
        if (component[t] < 0) {
            right = walk_component(&w, t, *component_count, diagnostic);
            *component_count += 1;
        }
    }
    for (int t = 0; t < triangle_count && right; ++t) {
        if (w.turned[t]) {
            const int swapped = triangles[t][1];
            triangles[t][1] = triangles[t][2];
            triangles[t][2] = swapped;
        }
    }
    free(w.turned);
    free(w.queue);
    return right;
}

bool pl_mesh_is_closed(const pl_polyhedron *p)
{
    half_edge *edges = sorted_edges((const int(*)[3])p->triangles, p->triangle_count);
    bool closed = edges != NULL;
    const int count = 3 * p->triangle_count;
    for (int i = 0; i < count && closed; i += 2) {
        closed =
            i + 1 < count && edges[i].low == edges[i + 1].low && edges[i].high == edges[i + 1].high;
        if (closed) {
            const int side = edges[i].side, other = edges[i + 1].side;
            const int *a = p->triangles[side / 3];
            closed = !runs(p->triangles[other / 3], a[side % 3], a[(side % 3 + 1) % 3]) &&
                     (i + 2 >= count || edges[i + 2].low != edges[i].low ||
                      edges[i + 2].high != edges[i].high);
        }
    }
    free(edges);
    return closed;
}
