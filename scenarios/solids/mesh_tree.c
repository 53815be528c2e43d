#include "mesh_tree.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { LEAF_SIZE = 4 };

static double least(double a, double b)
{
    return a < b ? a : b;
}

static double most(double a, double b)
{
    return a > b ? a : b;
}

void pl_mesh_box(const pl_mesh_tree *tree, int t, double low[3], double high[3])
{
    const int *corner = tree->triangles[t];
    for (int k = 0; k < 3; ++k) {
        const double a = tree->vertices[corner[0]][k], b = tree->vertices[corner[1]][k];
        const double c = tree->vertices[corner[2]][k];
        low[k] = least(a, least(b, c));
        high[k] = most(a, most(b, c));
    }
}

static bool comes_before(const pl_mesh_tree *tree, int axis, int a, int b)
{
    const double x = tree->middle[a][axis], y = tree->middle[b][axis];
    return x != y ? x < y : a < b;
}

/* Hoare's selection: order[middle] becomes what sorting would put there, all before it smaller. */
static void select_middle(const pl_mesh_tree *tree, int axis, int begin, int end, int middle)
{
    int low = begin, high = end - 1;
    while (low < high) {
        const int pivot = tree->order[low + (high - low) / 2];
        int i = low, j = high;
        while (i <= j) {
            while (comes_before(tree, axis, tree->order[i], pivot)) {
                ++i;
            }
            while (comes_before(tree, axis, pivot, tree->order[j])) {
                --j;
            }
            if (i <= j) {
                const int swapped = tree->order[i];
                tree->order[i++] = tree->order[j];
                tree->order[j--] = swapped;
            }
        }
        if (middle <= j) {
            high = j;
        } else if (middle >= i) {
            low = i;
        } else {
            return;
        }
    }
}

/* Returns the number of the node. Each half has half of the triangles: the depth is log2 n. */
static int build_node(pl_mesh_tree *tree, int begin, int end)
{
    const int index = tree->node_count++;
    pl_mesh_node n = {.begin = begin, .end = end};
    for (int i = begin; i < end; ++i) {
        double low[3], high[3];
        pl_mesh_box(tree, tree->order[i], low, high);
        for (int k = 0; k < 3; ++k) {
            n.low[k] = i == begin ? low[k] : least(n.low[k], low[k]);
            n.high[k] = i == begin ? high[k] : most(n.high[k], high[k]);
        }
    }
    if (end - begin > LEAF_SIZE) {
        int axis = 0;
        for (int k = 1; k < 3; ++k) {
            axis = n.high[k] - n.low[k] > n.high[axis] - n.low[axis] ? k : axis;
        }
        const int middle = begin + (end - begin) / 2;
        select_middle(tree, axis, begin, end, middle);
        build_node(tree, begin, middle);
        n.second = build_node(tree, middle, end);
    }
    tree->nodes[index] = n;
    return index;
}

bool pl_mesh_tree_create(const double (*vertices)[3], const int (*triangles)[3], int triangle_count,
                         pl_mesh_tree *tree)
{
    const size_t count = (size_t)triangle_count;
    *tree = (pl_mesh_tree){.vertices = vertices,
                           .triangles = triangles,
                           .order = malloc(count * sizeof *tree->order),
                           .middle = malloc(count * sizeof *tree->middle),
                           .nodes = calloc(2 * count, sizeof *tree->nodes)};
    if (tree->order == NULL || tree->middle == NULL || tree->nodes == NULL) {
        pl_mesh_tree_free(tree);
        return false;
    }
    for (int t = 0; t < triangle_count; ++t) {
        double low[3], high[3];
        pl_mesh_box(tree, t, low, high);
        tree->order[t] = t;
        for (int k = 0; k < 3; ++k) {
            tree->middle[t][k] = low[k] + high[k];
        }
    }
    build_node(tree, 0, triangle_count);
    return true;
}

void pl_mesh_tree_free(pl_mesh_tree *tree)
{
    free(tree->order);
    free(tree->middle);
    free(tree->nodes);
    *tree = (pl_mesh_tree){.order = NULL};
}

double pl_mesh_tolerance(const pl_mesh_tree *tree)
{
    const pl_mesh_node *all = &tree->nodes[0];
    double size = 0, largest = 0;
    for (int k = 0; k < 3; ++k) {
        size = most(size, all->high[k] - all->low[k]);
        largest = most(largest, most(-all->low[k], all->high[k]));
    }
    return 1e-9 * size + 16 * DBL_EPSILON * largest;
}

long pl_mesh_most_near(int triangle_count)
{
    return 65536 + 2560L * triangle_count;
}

bool pl_mesh_diagnose_near(pl_diagnostic *diagnostic)
{
    return pl_diagnose_field(diagnostic, "triangles",
                             "expected triangles that are near 2560 others on average at most, "
                             "found them near more");
}

pl_mesh_search pl_mesh_search_begin(const pl_mesh_tree *tree, const double low[3],
                                    const double high[3])
{
    pl_mesh_search search = {.tree = tree, .depth = 1};
    memcpy(search.low, low, sizeof search.low);
    memcpy(search.high, high, sizeof search.high);
    return search;
}

static bool overlaps(const pl_mesh_search *s, const double low[3], const double high[3])
{
    return low[0] <= s->high[0] && s->low[0] <= high[0] && low[1] <= s->high[1] &&
           s->low[1] <= high[1] && low[2] <= s->high[2] && s->low[2] <= high[2];
}

/* Goes to the next leaf whose box touches. False when there is none. */
static bool next_leaf(pl_mesh_search *s)
{
    while (s->depth > 0) {
        const int index = s->stack[--s->depth];
        const pl_mesh_node *n = &s->tree->nodes[index];
        if (!overlaps(s, n->low, n->high)) {
            continue;
        }
        if (n->second == 0) {
            s->at = n->begin;
            s->end = n->end;
            return true;
        }
        s->stack[s->depth++] = n->second;
        s->stack[s->depth++] = index + 1;
    }
    return false;
}

int pl_mesh_search_next(pl_mesh_search *s)
{
    do {
        while (s->at < s->end) {
            const int t = s->tree->order[s->at++];
            double low[3], high[3];
            pl_mesh_box(s->tree, t, low, high);
            if (overlaps(s, low, high)) {
                return t;
            }
        }
    } while (next_leaf(s));
    return -1;
}
