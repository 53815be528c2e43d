/* A mesh: the solid within closed surfaces of triangles, from vertices and triangles as people and
 * their programs write them.
 *
 * Refused, with the number of the triangle and of its vertices: an index out of range, a vertex
 * twice in a triangle, a triangle without area, an edge that is not of two triangles, a surface
 * with one side (of Moebius or Klein), one that crosses itself, one that encloses nothing.
 *
 * Corrected: vertices that no triangle uses are removed, and triangles are turned so that each
 * surface faces one way. Which way does not come from how they were wound, but from where they lie:
 * an outermost surface encloses the solid, one within it is a cavity and faces inward, one within
 * that encloses solid again. So a mesh that is inside out is turned round as a whole. */
#include "mesh.h"
#include "mesh_triangle.h"
#include "polyhedron.h"

#include <stdlib.h>
#include <string.h>

static bool check_indices(const int (*triangles)[3], int triangle_count, int vertex_count,
                          pl_diagnostic *diagnostic)
{
    for (int t = 0; t < triangle_count; ++t) {
        const int *corner = triangles[t];
        pl_path_push_key(&diagnostic->path, "triangles");
        pl_path_push_index(&diagnostic->path, t);
        for (int k = 0; k < 3; ++k) {
            if (corner[k] < 0 || corner[k] >= vertex_count) {
                pl_path_push_index(&diagnostic->path, k);
                return pl_diagnose(diagnostic,
                                   "expected the index of a vertex from 0 to %d, found "
                                   "%d in triangle %d",
                                   vertex_count - 1, corner[k], t);
            }
        }
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) {
            return pl_diagnose(diagnostic,
                               "expected three different vertices, found %d, %d and %d in triangle "
                               "%d",
                               corner[0], corner[1], corner[2], t);
        }
        pl_path_pop(&diagnostic->path);
        pl_path_pop(&diagnostic->path);
    }
    return true;
}

static bool check_areas(const double (*vertices)[3], const int (*triangles)[3], int triangle_count,
                        pl_diagnostic *diagnostic)
{
    for (int t = 0; t < triangle_count; ++t) {
        const int *corner = triangles[t];
        if (!pl_mesh_has_area(vertices, corner)) {
            pl_path_push_key(&diagnostic->path, "triangles");
            pl_path_push_index(&diagnostic->path, t);
            return pl_diagnose(diagnostic,
                               "expected a triangle with an area, found vertices %d, %d and %d of "
                               "triangle %d on one line",
                               corner[0], corner[1], corner[2], t);
        }
    }
    return true;
}

/* Of surfaces that are turned outward: reports those that cross, and turns cavities inward. */
static bool check_places(const double (*vertices)[3], int vertex_count, int (*triangles)[3],
                         int triangle_count, const int *surface, int surface_count,
                         pl_diagnostic *diagnostic)
{
    pl_mesh_tree tree;
    if (!pl_mesh_tree_create(vertices, (const int(*)[3])triangles, triangle_count, &tree)) {
        return pl_diagnose_no_memory(diagnostic);
    }
    const bool right = pl_mesh_check_crossing(&tree, triangle_count, diagnostic) &&
                       pl_mesh_turn_cavities(&tree, vertex_count, triangles, triangle_count,
                                             surface, surface_count, diagnostic);
    pl_mesh_tree_free(&tree);
    return right;
}

/* Turns the triangles so that the solid is behind them, or reports an error. */
static bool face_outward(const double (*vertices)[3], int vertex_count, int (*triangles)[3],
                         int triangle_count, pl_diagnostic *diagnostic)
{
    const size_t count = (size_t)triangle_count;
    int(*neighbours)[3] = malloc(count * sizeof *neighbours);
    int *surface = malloc(count * sizeof *surface);
    int surface_count = 0;
    bool right = (neighbours != NULL && surface != NULL) || pl_diagnose_no_memory(diagnostic);
    right =
        right &&
        pl_mesh_neighbours((const int(*)[3])triangles, triangle_count, neighbours, diagnostic) &&
        pl_mesh_orient(triangles, triangle_count, (const int(*)[3])neighbours, surface,
                       &surface_count, diagnostic);
    free(neighbours);
    if (right && surface_count > PL_MAX_SURFACES) {
        right = pl_diagnose_field(diagnostic, "triangles",
                                  "expected at most %d closed surfaces, found %d", PL_MAX_SURFACES,
                                  surface_count);
    }
    right = right &&
            pl_mesh_turn_outward(vertices, triangles, triangle_count, surface, surface_count,
                                 diagnostic) &&
            check_places(vertices, vertex_count, triangles, triangle_count, surface, surface_count,
                         diagnostic);
    free(surface);
    return right;
}

/* Leaves out vertices that no triangle has. False when out of memory. */
static bool keep_used_vertices(pl_polyhedron *p)
{
    int *number = calloc((size_t)p->vertex_count, sizeof *number);
    if (number == NULL) {
        return false;
    }
    for (int i = 0; i < 3 * p->triangle_count; ++i) {
        number[p->triangles[i / 3][i % 3]] = 1;
    }
    int kept = 0;
    for (int i = 0; i < p->vertex_count; ++i) {
        if (number[i] != 0) {
            memmove(p->vertices[kept], p->vertices[i], sizeof p->vertices[i]);
            number[i] = kept++;
        }
    }
    p->vertex_count = kept;
    for (int i = 0; i < 3 * p->triangle_count; ++i) {
        int *corner = &p->triangles[i / 3][i % 3];
        *corner = number[*corner];
    }
    free(number);
    return true;
}

static bool check_counts(int vertex_count, int triangle_count, pl_diagnostic *diagnostic)
{
    if (vertex_count < 4 || vertex_count > PL_MAX_VERTICES) {
        return pl_diagnose_field(diagnostic, "vertices", "expected 4 to %d vertices, found %d",
                                 PL_MAX_VERTICES, vertex_count);
    }
    if (triangle_count < 4 || triangle_count > PL_MAX_TRIANGLES) {
        return pl_diagnose_field(diagnostic, "triangles", "expected 4 to %d triangles, found %d",
                                 PL_MAX_TRIANGLES, triangle_count);
    }
    return true;
}

bool pl_polyhedron_of_mesh(const double (*vertices)[3], int vertex_count, const int (*triangles)[3],
                           int triangle_count, pl_polyhedron **polyhedron,
                           pl_diagnostic *diagnostic)
{
    if (!check_counts(vertex_count, triangle_count, diagnostic) ||
        !pl_polyhedron_check_points("vertices", vertices, vertex_count, diagnostic) ||
        !check_indices(triangles, triangle_count, vertex_count, diagnostic) ||
        !check_areas(vertices, triangles, triangle_count, diagnostic)) {
        return false;
    }
    pl_polyhedron *made = pl_polyhedron_create(vertex_count, triangle_count);
    if (made == NULL) {
        return pl_diagnose_no_memory(diagnostic);
    }
    memcpy(made->vertices, vertices, (size_t)vertex_count * sizeof *vertices);
    memcpy(made->triangles, triangles, (size_t)triangle_count * sizeof *triangles);
    if (!face_outward(vertices, vertex_count, made->triangles, triangle_count, diagnostic)) {
        pl_polyhedron_free(made);
        return false;
    }
    if (!keep_used_vertices(made)) {
        pl_polyhedron_free(made);
        return pl_diagnose_no_memory(diagnostic);
    }
    if (!pl_polyhedron_measure(made)) {
        pl_polyhedron_free(made);
        return pl_diagnose_field(
            diagnostic, "triangles",
            "expected a solid with a volume beyond rounding, at most a million times as long as "
            "wide, found another");
    }
    *polyhedron = made;
    return true;
}
