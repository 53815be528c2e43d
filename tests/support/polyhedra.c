#include "polyhedra.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

const pl_polyhedron *random_hull(pl_scene *scene, check_random *random, int points)
{
    const pl_polyhedron *made = NULL;
    double(*corner)[3] = calloc((size_t)points, sizeof *corner);
    double half[3], middle[3];
    assert_non_null(corner);
    for (int k = 0; k < 3; ++k) {
        half[k] = check_uniform(random, 0.2, 1);
        middle[k] = check_uniform(random, -0.5, 0.5);
    }
    for (int i = 0; i < points; ++i) {
        double square = 0, v[3];
        do {
            square = 0;
            for (int k = 0; k < 3; ++k) {
                v[k] = check_uniform(random, -1, 1);
                square += v[k] * v[k];
            }
        } while (square > 1 || square < 0.01);
        for (int k = 0; k < 3; ++k) {
            corner[i][k] = middle[k] + half[k] * v[k] / sqrt(square);
        }
    }
    pl_error error = {0};
    if (pl_scene_add_hull(scene, NULL, (const double(*)[3])corner, points, &made, &error) !=
        PL_OK) {
        fail_msg("%s", error.message);
    }
    free(corner);
    return made;
}

static const pl_polyhedron *add_mesh(pl_scene *scene, const double (*vertices)[3], int vertex_count,
                                     const int (*triangles)[3], int triangle_count)
{
    const pl_polyhedron *made = NULL;
    pl_error error = {0};
    if (pl_scene_add_mesh(scene, NULL, vertices, vertex_count, triangles, triangle_count, &made,
                          &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    return made;
}

const pl_polyhedron *mesh_of(pl_scene *scene, const pl_polyhedron *p)
{
    return add_mesh(scene, (const double(*)[3])p->vertices, p->vertex_count,
                    (const int(*)[3])p->triangles, p->triangle_count);
}

/* The index of the grid point at (x, y, z) of 0 .. cells, made once. */
static int grid_vertex(const int at[3], int cells, const double half[3], const double middle[3],
                       int *index, double (*vertices)[3], int *count)
{
    int *found = &index[(at[0] * (cells + 1) + at[1]) * (cells + 1) + at[2]];
    if (*found == 0) {
        for (int k = 0; k < 3; ++k) {
            vertices[*count][k] = middle[k] + half[k] * (2.0 * at[k] / cells - 1);
        }
        *found = ++*count;
    }
    return *found - 1;
}

const pl_polyhedron *box_mesh(pl_scene *scene, const double half[3], const double middle[3],
                              int cells)
{
    size_t most = (size_t)(cells + 1) * (size_t)(cells + 1) * (size_t)(cells + 1);
    int *index = calloc(most, sizeof *index);
    double(*vertices)[3] = calloc(most, sizeof *vertices);
    int(*triangles)[3] = calloc((size_t)(12 * cells * cells), sizeof *triangles);
    int vertex_count = 0, count = 0;
    assert_true(index != NULL && vertices != NULL && triangles != NULL);
    for (int side = 0; side < 6; ++side) {
        int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int cell = 0; cell < cells * cells; ++cell) {
            int corner[4];
            for (int c = 0; c < 4; ++c) {
                int at[3];
                at[axis] = side % 2 == 0 ? 0 : cells;
                at[u] = cell % cells + (c == 1 || c == 2);
                at[v] = cell / cells + (c >= 2);
                corner[c] = grid_vertex(at, cells, half, middle, index, vertices, &vertex_count);
            }
            bool flip = side % 2 == 0;
            const int tris[2][3] = {{corner[0], corner[flip ? 2 : 1], corner[flip ? 1 : 2]},
                                    {corner[0], corner[flip ? 3 : 2], corner[flip ? 2 : 3]}};
            memcpy(triangles[count], tris, sizeof tris);
            count += 2;
        }
    }
    const pl_polyhedron *made = add_mesh(scene, (const double(*)[3])vertices, vertex_count,
                                         (const int(*)[3])triangles, count);
    free(index);
    free(vertices);
    free(triangles);
    return made;
}

const pl_polyhedron *torus_mesh(pl_scene *scene, double ring, double tube, int around, int sides)
{
    int vertex_count = around * sides, count = 0;
    double(*vertices)[3] = calloc((size_t)vertex_count, sizeof *vertices);
    int(*triangles)[3] = calloc((size_t)(2 * vertex_count), sizeof *triangles);
    assert_true(vertices != NULL && triangles != NULL);
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < sides; ++j) {
            double a = 2 * pi * i / around, b = 2 * pi * j / sides;
            double *v = vertices[i * sides + j], r = ring + tube * cos(b);
            v[0] = r * cos(a);
            v[1] = r * sin(a);
            v[2] = tube * sin(b);
            int i2 = (i + 1) % around, j2 = (j + 1) % sides;
            const int corner[4] = {i * sides + j, i2 * sides + j, i2 * sides + j2, i * sides + j2};
            const int tris[2][3] = {{corner[0], corner[1], corner[2]},
                                    {corner[0], corner[2], corner[3]}};
            memcpy(triangles[count], tris, sizeof tris);
            count += 2;
        }
    }
    const pl_polyhedron *made = add_mesh(scene, (const double(*)[3])vertices, vertex_count,
                                         (const int(*)[3])triangles, count);
    free(vertices);
    free(triangles);
    return made;
}
