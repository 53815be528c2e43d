/* Pairs of triangles by a tree of boxes, then Moeller's test (A fast triangle-triangle intersection
 * test, 1997): each has vertices on both sides of the other's plane, and the two segments that
 * they cut from the common line of the planes overlap. All three by more than a tolerance: what
 * touches does not cross. Triangles in one plane that face the same way overlap only where two
 * solids do; those that face each other are solids that touch. */
#include "mesh.h"

#include "plumb/vec.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

typedef struct triangle {
    pl_vec corner[3];
    pl_vec normal; /* unit */
} triangle;

/* How far three points reach along a direction. */
typedef struct interval {
    double low, high;
} interval;

static double overlap(interval a, interval b)
{
    return fmin(a.high, b.high) - fmax(a.low, b.low);
}

static interval along(const triangle *t, pl_vec origin, pl_vec direction)
{
    interval s = {(double)INFINITY, -(double)INFINITY};
    for (int k = 0; k < 3; ++k) {
        const double x = pl_vec_dot(pl_vec_sub(t->corner[k], origin), direction);
        s.low = fmin(s.low, x);
        s.high = fmax(s.high, x);
    }
    return s;
}

/* For triangles in one plane: whether no edge of either separates them. */
static bool overlap_in_plane(const triangle *a, const triangle *b, double tolerance)
{
    const triangle *both[2] = {a, b};
    for (int i = 0; i < 6; ++i) {
        const triangle *t = both[i / 3];
        const pl_vec edge = pl_vec_sub(t->corner[(i + 1) % 3], t->corner[i % 3]);
        const pl_vec across = pl_vec_cross(t->normal, edge);
        const double length = pl_vec_length(across);
        const pl_vec origin = t->corner[i % 3];
        if (overlap(along(a, origin, across), along(b, origin, across)) <= tolerance * length) {
            return false;
        }
    }
    return true;
}

/* Heights of t's corners above a plane; a height within the tolerance counts as 0. */
typedef struct heights {
    double of[3];
    bool above, below;
} heights;

static heights measure_heights(const triangle *t, const triangle *plane, double tolerance)
{
    heights h = {.above = false};
    for (int k = 0; k < 3; ++k) {
        const double x = pl_vec_dot(pl_vec_sub(t->corner[k], plane->corner[0]), plane->normal);
        h.of[k] = fabs(x) <= tolerance ? 0 : x;
        h.above = h.above || h.of[k] > 0;
        h.below = h.below || h.of[k] < 0;
    }
    return h;
}

/* The interval of the triangle in the plane, along the unit direction `line`. */
static interval cut(const triangle *t, const heights *h, pl_vec origin, pl_vec line)
{
    interval s = {(double)INFINITY, -(double)INFINITY};
    for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        const double from = h->of[k], to = h->of[next];
        pl_vec point = pl_vec_sub(t->corner[k], origin);
        if ((from > 0 && to < 0) || (from < 0 && to > 0)) {
            point =
                pl_vec_mad(point, from / (from - to), pl_vec_sub(t->corner[next], t->corner[k]));
        } else if (from != 0) {
            continue;
        }
        const double x = pl_vec_dot(point, line);
        s.low = fmin(s.low, x);
        s.high = fmax(s.high, x);
    }
    return s;
}

static bool cross(const triangle *a, const triangle *b, double tolerance)
{
    const heights of_a = measure_heights(a, b, tolerance);
    if (of_a.above != of_a.below) {
        return false; /* on one side */
    }
    const heights of_b = measure_heights(b, a, tolerance);
    if (of_a.above && of_b.above && of_b.below) {
        const pl_vec line = pl_vec_cross(a->normal, b->normal);
        const double length = pl_vec_length(line);
        if (length == 0) {
            return false;
        }
        const pl_vec unit = pl_vec_scale(line, 1 / length), origin = a->corner[0];
        return overlap(cut(a, &of_a, origin, unit), cut(b, &of_b, origin, unit)) > tolerance;
    }
    const bool in_plane = !of_a.above && !of_b.above && !of_b.below;
    return in_plane && pl_vec_dot(a->normal, b->normal) > 0 && overlap_in_plane(a, b, tolerance);
}

/* A node of the tree: the triangles order[begin .. end) and the box around them. Its first child
 * follows it. */
typedef struct node {
    double low[3], high[3];
    int begin, end;
    int second; /* the other child; 0: a leaf */
} node;

typedef struct search {
    const double (*vertices)[3];
    const int (*triangles)[3];
    double tolerance;
    pl_vec *normals; /* of the triangles, unit */
    int *order;
    double (*middle)[3]; /* of the triangles' boxes, twice */
    node *nodes;
    int node_count;
} search;

enum { LEAF_SIZE = 4, DEEPEST = 64 };

static void box_of_triangle(const search *s, int t, double low[3], double high[3])
{
    for (int k = 0; k < 3; ++k) {
        const double a = s->vertices[s->triangles[t][0]][k];
        const double b = s->vertices[s->triangles[t][1]][k];
        const double c = s->vertices[s->triangles[t][2]][k];
        low[k] = fmin(a, fmin(b, c));
        high[k] = fmax(a, fmax(b, c));
    }
}

static bool comes_before(const search *s, int axis, int a, int b)
{
    const double x = s->middle[a][axis], y = s->middle[b][axis];
    return x != y ? x < y : a < b;
}

/* Hoare's selection: order[middle] becomes what sorting would put there, all before it smaller. */
static void select_middle(const search *s, int axis, int begin, int end, int middle)
{
    int low = begin, high = end - 1;
    while (low < high) {
        const int pivot = s->order[low + (high - low) / 2];
        int i = low, j = high;
        while (i <= j) {
            while (comes_before(s, axis, s->order[i], pivot)) {
                ++i;
            }
            while (comes_before(s, axis, pivot, s->order[j])) {
                --j;
            }
            if (i <= j) {
                const int swapped = s->order[i];
                s->order[i++] = s->order[j];
                s->order[j--] = swapped;
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
static int build_node(search *s, int begin, int end)
{
    const int index = s->node_count++;
    node n = {.begin = begin, .end = end};
    for (int i = begin; i < end; ++i) {
        double low[3], high[3];
        box_of_triangle(s, s->order[i], low, high);
        for (int k = 0; k < 3; ++k) {
            n.low[k] = i == begin ? low[k] : fmin(n.low[k], low[k]);
            n.high[k] = i == begin ? high[k] : fmax(n.high[k], high[k]);
        }
    }
    if (end - begin > LEAF_SIZE) {
        int axis = 0;
        for (int k = 1; k < 3; ++k) {
            axis = n.high[k] - n.low[k] > n.high[axis] - n.low[axis] ? k : axis;
        }
        const int middle = begin + (end - begin) / 2;
        select_middle(s, axis, begin, end, middle);
        build_node(s, begin, middle);
        n.second = build_node(s, middle, end);
    }
    s->nodes[index] = n;
    return index;
}

static triangle load(const search *s, int t)
{
    triangle made = {.normal = s->normals[t]};
    for (int k = 0; k < 3; ++k) {
        made.corner[k] = pl_vec_of(s->vertices[s->triangles[t][k]]);
    }
    return made;
}

static pl_vec normal_of(const search *s, int t)
{
    const pl_vec a = pl_vec_of(s->vertices[s->triangles[t][0]]);
    const pl_vec ab = pl_vec_sub(pl_vec_of(s->vertices[s->triangles[t][1]]), a);
    const pl_vec ac = pl_vec_sub(pl_vec_of(s->vertices[s->triangles[t][2]]), a);
    const pl_vec normal = pl_vec_cross(ab, ac);
    return pl_vec_scale(normal, 1 / pl_vec_length(normal));
}

static int common_vertices(const int a[3], const int b[3])
{
    int count = 0;
    for (int i = 0; i < 9; ++i) {
        count += a[i / 3] == b[i % 3] ? 1 : 0;
    }
    return count;
}

/* The lowest triangle after t that crosses it; -1: none. */
static int find_crossing(const search *s, int t)
{
    double low[3], high[3];
    box_of_triangle(s, t, low, high);
    const triangle mine = load(s, t);
    int stack[DEEPEST], depth = 0, found = -1;
    stack[depth++] = 0;
    while (depth > 0) {
        const int index = stack[--depth];
        const node *n = &s->nodes[index];
        bool near = true;
        for (int k = 0; k < 3; ++k) {
            near = near && n->low[k] <= high[k] && low[k] <= n->high[k];
        }
        if (near && n->second != 0) {
            stack[depth++] = n->second;
            stack[depth++] = index + 1;
        }
        for (int i = n->begin; i < n->end && near && n->second == 0; ++i) {
            const int other = s->order[i];
            if (other > t && (found < 0 || other < found) &&
                common_vertices(s->triangles[t], s->triangles[other]) < 2) {
                const triangle theirs = load(s, other);
                found = cross(&mine, &theirs, s->tolerance) ? other : found;
            }
        }
    }
    return found;
}

static bool prepare(search *s, int vertex_count, int triangle_count)
{
    double size = 0, largest = 0;
    for (int k = 0; k < 3; ++k) {
        double low = s->vertices[s->triangles[0][0]][k], high = low;
        for (int i = 0; i < vertex_count; ++i) {
            low = fmin(low, s->vertices[i][k]);
            high = fmax(high, s->vertices[i][k]);
        }
        size = fmax(size, high - low);
        largest = fmax(largest, fmax(-low, high));
    }
    s->tolerance = 1e-9 * size + 16 * DBL_EPSILON * largest;
    s->normals = malloc((size_t)triangle_count * sizeof *s->normals);
    s->order = malloc((size_t)triangle_count * sizeof *s->order);
    s->middle = malloc((size_t)triangle_count * sizeof *s->middle);
    s->nodes = calloc(2 * (size_t)triangle_count, sizeof *s->nodes);
    if (s->normals == NULL || s->order == NULL || s->middle == NULL || s->nodes == NULL) {
        return false;
    }
    for (int t = 0; t < triangle_count; ++t) {
        double low[3], high[3];
        box_of_triangle(s, t, low, high);
        s->order[t] = t;
        s->normals[t] = normal_of(s, t);
        for (int k = 0; k < 3; ++k) {
            s->middle[t][k] = low[k] + high[k];
        }
    }
    build_node(s, 0, triangle_count);
    return true;
}

bool pl_mesh_check_crossing(const double (*vertices)[3], int vertex_count,
                            const int (*triangles)[3], int triangle_count,
                            pl_diagnostic *diagnostic)
{
    search s = {.vertices = vertices, .triangles = triangles};
    bool right = prepare(&s, vertex_count, triangle_count);
    if (!right) {
        pl_diagnose_no_memory(diagnostic);
    }
    for (int t = 0; t < triangle_count && right; ++t) {
        const int other = find_crossing(&s, t);
        if (other >= 0) {
            pl_path_push_key(&diagnostic->path, "triangles");
            pl_path_push_index(&diagnostic->path, t);
            right = pl_diagnose(diagnostic,
                                "expected a surface that does not cross itself, found triangles %d "
                                "(vertices %d, %d, %d) and %d (%d, %d, %d) in each other",
                                t, triangles[t][0], triangles[t][1], triangles[t][2], other,
                                triangles[other][0], triangles[other][1], triangles[other][2]);
        }
    }
    free(s.normals);
    free(s.order);
    free(s.middle);
    free(s.nodes);
    return right;
}
