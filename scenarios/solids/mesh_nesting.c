/* Whether a surface lies within another: a vertex or the middle of a triangle is inside when a ray
 * from it along z goes through the other surface an odd number of times. A ray that meets an edge is
 * moved in thought by less than any number along x and y, which decides every case alike; the signs
 * are exact. Surfaces may touch, so that points near the other one do not count. All others must
 * agree: that finds surfaces that cross along edges alone, too. */
#include "mesh.h"

#include "base/exact.h"
#include "base/number.h"
#include "mesh_tree.h"
#include "mesh_triangle.h"
#include "polyhedron.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void turn(int triangle[3])
{
    const int swapped = triangle[1];
    triangle[1] = triangle[2];
    triangle[2] = swapped;
}

/* ---- Outer sides ---- */

static bool check_volume(const pl_surface_sums *sums, int first, pl_diagnostic *diagnostic)
{
    if (pl_surface_is_thick(sums)) {
        return true;
    }
    char found[PL_NUMBER_SIZE];
    pl_path_push_key(&diagnostic->path, "triangles");
    pl_path_push_index(&diagnostic->path, first);
    return pl_diagnose(
        diagnostic,
        "expected a surface that encloses a volume, found %s m^3 in that of triangle %d",
        pl_number_text(fabs(pl_exact_value(&sums->six_volumes)) / 6, found), first);
}

bool pl_mesh_turn_outward(const double (*vertices)[3], int (*triangles)[3], int triangle_count,
                          const int *surface, int surface_count, pl_diagnostic *diagnostic)
{
    pl_surface_sums *sums = calloc((size_t)surface_count, sizeof *sums);
    if (sums == NULL) {
        return pl_diagnose_no_memory(diagnostic);
    }
    for (int t = 0; t < triangle_count; ++t) {
        pl_surface_add(&sums[surface[t]], vertices, triangles[t]);
    }
    bool right = true;
    for (int t = 0, seen = 0; t < triangle_count && right; ++t) {
        if (surface[t] == seen) { /* surfaces have numbers by their lowest triangle */
            right = check_volume(&sums[seen++], t, diagnostic);
        }
        if (pl_exact_sign(&sums[surface[t]].six_volumes) < 0) {
            turn(triangles[t]);
        }
    }
    free(sums);
    return right;
}

/* ---- Cavities ---- */

/* What is found of a surface against each of the others. */
typedef struct nesting {
    const pl_mesh_tree *tree;
    const int *surface; /* of each triangle */
    int surface_count;
    double tolerance;
    bool *is_seen; /* by vertex: it was looked at */
    /* By surface: */
    int *begin, *order;           /* its triangles are order[begin[c] .. begin[c + 1]) */
    double (*low)[3], (*high)[3]; /* its box, larger by the tolerance */
    int *times;                   /* how often the ray goes through it */
    bool *is_near;                /* the point is near it */
    int *inside, *near;           /* points of the surface in question that are inside or near it */
    int *met, met_count;          /* surfaces that the ray meets or the point is near */
    long left;                    /* triangles that may still be met */
} nesting;

static bool is_between(const double point[3], const double low[3], const double high[3])
{
    return low[0] <= point[0] && point[0] <= high[0] && low[1] <= point[1] && point[1] <= high[1] &&
           low[2] <= point[2] && point[2] <= high[2];
}

/* Whether the point is within the tolerance of the triangle, or near one of its corners. */
static bool is_near_triangle(const pl_mesh_tree *tree, int t, const double point[3],
                             double tolerance)
{
    double low[3], high[3];
    pl_mesh_box(tree, t, low, high);
    for (int k = 0; k < 3; ++k) {
        low[k] -= tolerance;
        high[k] += tolerance;
    }
    if (!is_between(point, low, high)) {
        return false;
    }
    const pl_mesh_triangle shape = pl_mesh_triangle_of(tree->vertices, tree->triangles[t]);
    pl_vec normal = pl_mesh_normal(&shape);
    normal = pl_vec_scale(normal, shape.facing / pl_vec_length(normal));
    bool near = true;
    for (int k = 0; k < 3 && near; ++k) {
        const pl_vec arm = pl_vec_sub(pl_vec_of(point), pl_vec_of(shape.corner[k]));
        const pl_vec inward = pl_vec_cross(normal, pl_mesh_edge(&shape, k, (k + 1) % 3));
        near = pl_vec_dot(arm, inward) >= -tolerance * pl_vec_length(inward) &&
               fabs(pl_vec_dot(arm, normal)) <= tolerance;
    }
    return near;
}

/* Whether the ray from the point along z goes through the triangle. */
static bool is_below(const pl_mesh_tree *tree, int t, const double point[3])
{
    const double *corner[3];
    for (int k = 0; k < 3; ++k) {
        corner[k] = tree->vertices[tree->triangles[t][k]];
    }
    bool is_within = false; /* seen along z */
    for (int k = 0; k < 3; ++k) {
        const double *a = corner[k], *b = corner[(k + 1) % 3];
        if ((a[1] > point[1]) != (b[1] > point[1])) {
            const int side =
                a[1] < b[1] ? pl_turn_about(2, a, b, point) : pl_turn_about(2, b, a, point);
            is_within = is_within != (side > 0);
        }
    }
    return is_within && pl_turn_about(2, corner[0], corner[1], corner[2]) *
                                pl_side_of_plane(corner[0], corner[1], corner[2], point) <
                            0;
}

static void note(nesting *n, int surface)
{
    if (n->times[surface] == 0 && !n->is_near[surface]) {
        n->met[n->met_count++] = surface;
    }
}

/* Counts a point of surface c for each surface that it is inside of or near to. */
static void add_point(nesting *n, int c, const double point[3])
{
    double low[3], high[3];
    for (int k = 0; k < 3; ++k) {
        low[k] = point[k] - n->tolerance;
        high[k] = k == 2 ? (double)INFINITY : point[k] + n->tolerance;
    }
    pl_mesh_search search = pl_mesh_search_begin(n->tree, low, high);
    n->met_count = 0;
    for (int t = 0; (t = pl_mesh_search_next(&search)) >= 0 && n->left > 0; --n->left) {
        const int other = n->surface[t];
        if (other == c) {
            continue;
        }
        if (is_near_triangle(n->tree, t, point, n->tolerance)) {
            note(n, other);
            n->is_near[other] = true;
        } else if (is_below(n->tree, t, point)) {
            note(n, other);
            n->times[other]++;
        }
    }
    for (int i = 0; i < n->met_count; ++i) {
        const int other = n->met[i];
        n->near[other] += n->is_near[other];
        n->inside[other] += !n->is_near[other] && n->times[other] % 2 == 1;
        n->times[other] = 0;
        n->is_near[other] = false;
    }
}

/* Whether the box of surface c overlaps another's. */
static bool may_touch(const nesting *n, int c)
{
    bool found = false;
    for (int d = 0; d < n->surface_count && !found; ++d) {
        found = d != c;
        for (int k = 0; k < 3; ++k) {
            found = found && n->low[d][k] <= n->high[c][k] && n->low[c][k] <= n->high[d][k];
        }
    }
    return found;
}

/* The lowest triangle of a surface. */
static int first_of(const nesting *n, int c)
{
    return n->order[n->begin[c]];
}

static bool diagnose_pair(const nesting *n, int c, int d, const char *what,
                          pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "triangles");
    pl_path_push_index(&diagnostic->path, first_of(n, c));
    return pl_diagnose(diagnostic,
                       "expected surfaces apart or one in another, found those of triangles %d and "
                       "%d %s",
                       first_of(n, c), first_of(n, d), what);
}

/* Whether surface c is a cavity: within an odd number of others. */
static bool find_depth(nesting *n, int c, bool *is_cavity, pl_diagnostic *diagnostic)
{
    *is_cavity = false;
    if (!may_touch(n, c)) {
        return true;
    }
    const size_t size = (size_t)n->surface_count * sizeof(int);
    memset(n->inside, 0, size);
    memset(n->near, 0, size);
    int points = 0;
    for (int i = n->begin[c]; i < n->begin[c + 1]; ++i) {
        const int *corner = n->tree->triangles[n->order[i]];
        const pl_mesh_triangle t = pl_mesh_triangle_of(n->tree->vertices, corner);
        double middle[3];
        for (int k = 0; k < 3; ++k) {
            middle[k] = t.corner[0][k] / 3 + t.corner[1][k] / 3 + t.corner[2][k] / 3;
        }
        add_point(n, c, middle);
        ++points;
        for (int k = 0; k < 3; ++k) {
            if (!n->is_seen[corner[k]]) {
                n->is_seen[corner[k]] = true;
                add_point(n, c, n->tree->vertices[corner[k]]);
                ++points;
            }
        }
    }
    if (n->left <= 0) {
        return pl_mesh_diagnose_near(diagnostic);
    }
    for (int d = 0; d < n->surface_count; ++d) {
        if (d != c && n->near[d] == points) {
            return diagnose_pair(n, c, d, "in one place", diagnostic);
        }
        if (n->inside[d] > 0 && n->inside[d] + n->near[d] < points) {
            return diagnose_pair(n, c, d, "partly in each other", diagnostic);
        }
        *is_cavity = *is_cavity != (n->inside[d] > 0);
    }
    return true;
}

static void sort_triangles(nesting *n, int triangle_count)
{
    int *begin = n->begin; /* at first of the surface before, two places on */
    for (int t = 0; t < triangle_count; ++t) {
        begin[n->surface[t] + 2]++;
    }
    for (int c = 0; c < n->surface_count; ++c) {
        begin[c + 2] += begin[c + 1];
    }
    for (int t = 0; t < triangle_count; ++t) {
        n->order[begin[n->surface[t] + 1]++] = t;
    }
}

static void find_boxes(nesting *n)
{
    for (int c = 0; c < n->surface_count; ++c) {
        for (int i = n->begin[c]; i < n->begin[c + 1]; ++i) {
            double low[3], high[3];
            pl_mesh_box(n->tree, n->order[i], low, high);
            const bool is_first = i == n->begin[c];
            for (int k = 0; k < 3; ++k) {
                low[k] -= n->tolerance;
                high[k] += n->tolerance;
                n->low[c][k] = is_first ? low[k] : fmin(n->low[c][k], low[k]);
                n->high[c][k] = is_first ? high[k] : fmax(n->high[c][k], high[k]);
            }
        }
    }
}

static void free_nesting(nesting *n)
{
    free(n->is_seen);
    free(n->begin);
    free(n->order);
    free(n->low);
    free(n->high);
    free(n->times);
    free(n->is_near);
    free(n->inside);
    free(n->near);
    free(n->met);
}

static bool create_nesting(nesting *n, int vertex_count, int triangle_count)
{
    const size_t count = (size_t)n->surface_count;
    n->is_seen = calloc((size_t)vertex_count, sizeof *n->is_seen);
    n->begin = calloc(count + 2, sizeof *n->begin);
    n->order = malloc((size_t)triangle_count * sizeof *n->order);
    n->low = malloc(count * sizeof *n->low);
    n->high = malloc(count * sizeof *n->high);
    n->times = calloc(count, sizeof *n->times);
    n->is_near = calloc(count, sizeof *n->is_near);
    n->inside = malloc(count * sizeof *n->inside);
    n->near = malloc(count * sizeof *n->near);
    n->met = malloc(count * sizeof *n->met);
    if (n->is_seen == NULL || n->begin == NULL || n->order == NULL || n->low == NULL ||
        n->high == NULL || n->times == NULL || n->is_near == NULL || n->inside == NULL ||
        n->near == NULL || n->met == NULL) {
        return false;
    }
    sort_triangles(n, triangle_count);
    find_boxes(n);
    return true;
}

/* Marks the cavities. */
static bool find_cavities(nesting *n, bool *is_cavity, pl_diagnostic *diagnostic)
{
    for (int c = 0; c < n->surface_count; ++c) {
        if (!find_depth(n, c, &is_cavity[c], diagnostic)) {
            return false;
        }
    }
    return true;
}

bool pl_mesh_turn_cavities(const pl_mesh_tree *tree, int vertex_count, int (*triangles)[3],
                           int triangle_count, const int *surface, int surface_count,
                           pl_diagnostic *diagnostic)
{
    if (surface_count == 1) {
        return true;
    }
    nesting n = {.tree = tree,
                 .surface = surface,
                 .surface_count = surface_count,
                 .tolerance = pl_mesh_tolerance(tree),
                 .left = pl_mesh_most_near(triangle_count)};
    bool *is_cavity = calloc((size_t)surface_count, sizeof *is_cavity);
    bool right = is_cavity != NULL && create_nesting(&n, vertex_count, triangle_count);
    if (!right) {
        pl_diagnose_no_memory(diagnostic);
    }
    right = right && find_cavities(&n, is_cavity, diagnostic);
    for (int t = 0; t < triangle_count && right; ++t) {
        if (is_cavity[surface[t]]) {
            turn(triangles[t]);
        }
    }
    free(is_cavity);
    free_nesting(&n);
    return right;
}
