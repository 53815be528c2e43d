/* Pairs of triangles by a tree of boxes, and then what is known without rounding: each has corners
 * on both sides of the other's plane, and the two segments that they cut from the common line of the
 * planes overlap (Devillers and Guigue, Faster triangle-triangle intersection tests, 2002). What
 * touches does not cross: neither do triangles that a shift by a tolerance parts, along a normal or a
 * direction across two edges. Triangles in one plane that face the same way overlap only where two
 * solids do; those that face each other are solids that touch. */
#include "mesh.h"

#include "base/exact.h"
#include "mesh_tree.h"
#include "mesh_triangle.h"

#include <math.h>

/* A triangle and the unit vector that it faces along. */
typedef struct triangle {
    pl_mesh_triangle shape;
    pl_vec normal;
} triangle;

/* ---- With a tolerance ---- */

/* How far three points reach along a direction. */
typedef struct interval {
    double low, high;
} interval;

/* The length of the shortest shift that parts them; negative where they are apart. */
static double depth(interval a, interval b)
{
    return fmin(a.high - b.low, b.high - a.low);
}

static interval along(const triangle *t, pl_vec origin, pl_vec direction)
{
    interval s = {(double)INFINITY, -(double)INFINITY};
    for (int k = 0; k < 3; ++k) {
        const pl_vec arm = pl_vec_sub(pl_vec_of(t->shape.corner[k]), origin);
        const double x = pl_vec_dot(arm, direction);
        s.low = fmin(s.low, x);
        s.high = fmax(s.high, x);
    }
    return s;
}

/* Whether a shift by the tolerance along the direction parts them. */
static bool parts(const triangle *a, const triangle *b, pl_vec direction, double tolerance)
{
    const pl_vec origin = pl_vec_of(a->shape.corner[0]);
    return depth(along(a, origin, direction), along(b, origin, direction)) <=
           tolerance * pl_vec_length(direction);
}

/* For triangles in one plane: whether no edge of either parts them. */
static bool overlap_in_plane(const triangle *a, const triangle *b, double tolerance)
{
    const triangle *both[2] = {a, b};
    for (int i = 0; i < 6; ++i) {
        const triangle *t = both[i / 3];
        const pl_vec edge = pl_mesh_edge(&t->shape, i % 3, (i + 1) % 3);
        if (parts(a, b, pl_vec_cross(t->normal, edge), tolerance)) {
            return false;
        }
    }
    return true;
}

static bool lies_in_plane(const triangle *t, const triangle *plane, double tolerance)
{
    const interval heights = along(t, pl_vec_of(plane->shape.corner[0]), plane->normal);
    return heights.low >= -tolerance && heights.high <= tolerance;
}

/* Whether a direction across an edge of each parts them. Nearly parallel edges have none. */
static bool edges_part(const triangle *a, const triangle *b, double tolerance)
{
    const double least_sine = 1e-7;
    for (int i = 0; i < 9; ++i) {
        const pl_vec edge = pl_mesh_edge(&a->shape, i / 3, (i / 3 + 1) % 3);
        const pl_vec other = pl_mesh_edge(&b->shape, i % 3, (i % 3 + 1) % 3);
        const pl_vec across = pl_vec_cross(edge, other);
        if (pl_vec_length(across) > least_sine * pl_vec_length(edge) * pl_vec_length(other) &&
            parts(a, b, across, tolerance)) {
            return true;
        }
    }
    return false;
}

/* ---- Without rounding ---- */

/* Corners of a triangle in a new order: the first lies alone on its side of a plane. */
typedef struct cut {
    const double *corner[3];
    int side; /* of the first */
} cut;

/* False when not all sides of the other's plane have corners. */
static bool find_cut(const triangle *t, const triangle *other, cut *c)
{
    const double *const *plane = other->shape.corner, *const *corner = t->shape.corner;
    int side[3];
    for (int k = 0; k < 3; ++k) {
        side[k] = pl_side_of_plane(plane[0], plane[1], plane[2], corner[k]);
    }
    for (int k = 0; k < 3; ++k) {
        const int next = side[(k + 1) % 3] * side[k], last = side[(k + 2) % 3] * side[k];
        if (next <= 0 && last <= 0 && next + last < 0) {
            *c = (cut){{corner[k], corner[(k + 1) % 3], corner[(k + 2) % 3]}, side[k]};
            return true;
        }
    }
    return false;
}

static void swap_last(cut *c)
{
    const double *swapped = c->corner[1];
    c->corner[1] = c->corner[2];
    c->corner[2] = swapped;
}

/* Whether they go through each other along a piece of a line. */
static bool go_through(const triangle *a, const triangle *b)
{
    cut p, q;
    if (!find_cut(a, b, &p) || !find_cut(b, a, &q)) {
        return false;
    }
    /* Turned so that the first corner of each is above the other. */
    if (p.side < 0) {
        swap_last(&q);
    }
    if (q.side < 0) {
        swap_last(&p);
    }
    return pl_side_of_plane(p.corner[0], p.corner[1], q.corner[0], q.corner[1]) < 0 &&
           pl_side_of_plane(p.corner[0], p.corner[2], q.corner[2], q.corner[0]) < 0;
}

static bool cross(const triangle *a, const triangle *b, double tolerance)
{
    if (lies_in_plane(a, b, tolerance) && lies_in_plane(b, a, tolerance)) {
        return pl_vec_dot(a->normal, b->normal) > 0 && overlap_in_plane(a, b, tolerance);
    }
    return !parts(a, b, a->normal, tolerance) && !parts(a, b, b->normal, tolerance) &&
           go_through(a, b) && !edges_part(a, b, tolerance);
}

/* The same bits for both orders. */
static bool cross_in_order(const triangle *a, const triangle *b, double tolerance)
{
    int order = 0;
    for (int k = 0; k < 3 && order == 0; ++k) {
        order = pl_compare_places(a->shape.corner[k], b->shape.corner[k]);
    }
    return order <= 0 ? cross(a, b, tolerance) : cross(b, a, tolerance);
}

/* ---- All pairs ---- */

static triangle load(const pl_mesh_tree *tree, int t)
{
    triangle made = {.shape = pl_mesh_triangle_of(tree->vertices, tree->triangles[t])};
    const pl_vec normal = pl_mesh_normal(&made.shape);
    made.normal = pl_vec_scale(normal, 1 / pl_vec_length(normal));
    return made;
}

static int common_vertices(const int a[3], const int b[3])
{
    int count = 0;
    for (int i = 0; i < 9; ++i) {
        count += a[i / 3] == b[i % 3] ? 1 : 0;
    }
    return count;
}

/* The lowest triangle after t that crosses it; -1: none. *left counts pairs down. */
static int find_crossing(const pl_mesh_tree *tree, int t, double tolerance, long *left)
{
    double low[3], high[3];
    pl_mesh_box(tree, t, low, high);
    const triangle mine = load(tree, t);
    pl_mesh_search search = pl_mesh_search_begin(tree, low, high);
    int found = -1;
    for (int other = 0; (other = pl_mesh_search_next(&search)) >= 0 && *left > 0; --*left) {
        if (other > t && (found < 0 || other < found) &&
            common_vertices(tree->triangles[t], tree->triangles[other]) < 2) {
            const triangle theirs = load(tree, other);
            found = cross_in_order(&mine, &theirs, tolerance) ? other : found;
        }
    }
    return found;
}

bool pl_mesh_check_crossing(const pl_mesh_tree *tree, int triangle_count, pl_diagnostic *diagnostic)
{
    const double tolerance = pl_mesh_tolerance(tree);
    const int(*triangles)[3] = tree->triangles;
    long left = pl_mesh_most_near(triangle_count);
    for (int t = 0; t < triangle_count; ++t) {
        const int other = find_crossing(tree, t, tolerance, &left);
        if (left == 0) {
            return pl_mesh_diagnose_near(diagnostic);
        }
        if (other >= 0) {
            pl_path_push_key(&diagnostic->path, "triangles");
            pl_path_push_index(&diagnostic->path, t);
            return pl_diagnose(diagnostic,
                               "expected a surface that does not cross itself, found triangles %d "
                               "(vertices %d, %d, %d) and %d (%d, %d, %d) in each other",
                               t, triangles[t][0], triangles[t][1], triangles[t][2], other,
                               triangles[other][0], triangles[other][1], triangles[other][2]);
        }
    }
    return true;
}
