#include "transform.h"

#include "base/heap.h"
#include "plumb/vec.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_static_box(const pl_body *body)
{
    return body->is_static && body->shape.kind == PL_SHAPE_BOX;
}

int pl_static_box_count(const pl_scene *scene)
{
    int count = 0;
    for (int i = 0; i < scene->body_count; ++i) {
        count += is_static_box(&scene->bodies[i]);
    }
    return count;
}

/* The scene with what `divide` makes of each static box. */
static pl_status divide_boxes(const pl_scene *from,
                              pl_status (*divide)(pl_scene *scene, int body, void *user,
                                                  pl_error *error),
                              void *user, pl_scene *to, pl_error *error)
{
    pl_status status = pl_scene_copy_unjudged(from, to, error);
    for (int i = 0; i < from->body_count && status == PL_OK; ++i) {
        if (is_static_box(&from->bodies[i])) {
            status = divide(to, i, user, error);
        }
    }
    if (status == PL_OK) {
        status = pl_scene_validate(to, error);
    }
    if (status != PL_OK) {
        pl_scene_free(to);
    }
    return status;
}

/* ---- Halves ---- */

/* Makes the body its half at one end of its axis: -1 or 1. */
static void halve(pl_body *body, int axis, double end)
{
    const pl_axes axes = pl_axes_of(body->orientation);
    body->shape.half_extents[axis] /= 2;
    const double arm = end * body->shape.half_extents[axis];
    pl_vec_store(pl_vec_mad(pl_vec_of(body->position), arm, axes.axis[axis]), body->position);
}

/* Puts halves in the place of the box of body `body`. */
static pl_status split(pl_scene *scene, int body, void *axis, pl_error *error)
{
    pl_body second = scene->bodies[body];
    halve(&scene->bodies[body], *(int *)axis, -1);
    halve(&second, *(int *)axis, 1);
    snprintf(second.name, sizeof second.name, "other half of body %d", body);
    return pl_scene_add_body(scene, &second, NULL, error);
}

pl_status pl_split_boxes(const pl_scene *from, int axis, pl_scene *to, pl_error *error)
{
    return divide_boxes(from, split, &axis, to, error);
}

/* ---- Meshes ---- */

/* The surface of a box: the points of a lattice of (n + 1)^3 that lie on it. */
typedef struct grid {
    int n;
    int *index; /* ((n + 1)^3) of the vertex at a point of the lattice; -1: there is none yet */
    double (*vertices)[3]; /* (vertex_count) */
    int (*triangles)[3];   /* (triangle_count) */
    int vertex_count, triangle_count;
} grid;

/* Returns the vertex at a point of the lattice, and makes it at the first call. Opposite vertices are
 * mirror images to the bit. */
static int vertex_at(grid *g, const double half[3], const int at[3])
{
    int *index = &g->index[(at[0] * (g->n + 1) + at[1]) * (g->n + 1) + at[2]];
    if (*index < 0) {
        for (int k = 0; k < 3; ++k) {
            g->vertices[g->vertex_count][k] = half[k] * (2 * at[k] - g->n) / g->n;
        }
        *index = g->vertex_count++;
    }
    return *index;
}

/* Adds the face at the lower (end 0) or upper (end 1) end of an axis, wound outward. */
static void add_face(grid *g, const double half[3], int axis, int end)
{
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int cell = 0; cell < g->n * g->n; ++cell) {
        int corner[4];
        for (int c = 0; c < 4; ++c) {
            int at[3];
            at[axis] = end * g->n;
            at[u] = cell / g->n + (c == 1 || c == 2);
            at[v] = cell % g->n + (c >= 2);
            corner[c] = vertex_at(g, half, at);
        }
        for (int half_cell = 0; half_cell < 2; ++half_cell) {
            int *triangle = g->triangles[g->triangle_count++];
            triangle[0] = corner[0];
            triangle[1 + (end == 0)] = corner[1 + half_cell];
            triangle[1 + (end == 1)] = corner[2 + half_cell];
        }
    }
}

/* Puts the mesh in the place of the box of body `body`. */
static pl_status tessellate(pl_scene *scene, int body, void *user, pl_error *error)
{
    grid *g = user;
    const double *half = scene->bodies[body].shape.half_extents;
    const pl_polyhedron *mesh = NULL;
    g->vertex_count = g->triangle_count = 0;
    for (int i = 0; i < (g->n + 1) * (g->n + 1) * (g->n + 1); ++i) {
        g->index[i] = -1;
    }
    for (int face = 0; face < 6; ++face) {
        add_face(g, half, face / 2, face % 2);
    }
    pl_status status =
        pl_scene_add_mesh(scene, NULL, (const double(*)[3])g->vertices, g->vertex_count,
                          (const int(*)[3])g->triangles, g->triangle_count, &mesh, error);
    if (status == PL_OK) {
        scene->bodies[body].shape = pl_shape_of(mesh);
    }
    return status;
}

pl_status pl_tessellate_boxes(const pl_scene *from, int n, pl_scene *to, pl_error *error)
{
    const size_t points = (size_t)(n + 1) * (size_t)(n + 1) * (size_t)(n + 1);
    grid g = {.n = n,
              .index = pl_heap_new(points, sizeof *g.index),
              .vertices = pl_heap_new(points, sizeof *g.vertices),
              .triangles = pl_heap_new((size_t)12 * (size_t)n * (size_t)n, sizeof *g.triangles)};
    const pl_status status = divide_boxes(from, tessellate, &g, to, error);
    free(g.index);
    free(g.vertices);
    free(g.triangles);
    return status;
}
