/* Round shapes are cut into slices along their axis. Meshes are thinned by clustering their
 * vertices in a grid (Rossignac and Borrel 1993). */
#include "picture.h"

#include "base/array.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;

enum { LEAST_SLICES = 8, MOST_SLICES = 24, BANDS = 4 /* of a half sphere */ };

static void add(pl_facets *facets, pl_vec a, pl_vec b, pl_vec c, pl_vec d, bool triangle)
{
    const pl_facet facet = {.corner = {a, b, c, d}, .triangle = triangle};
    facets->failed |=
        pl_array_push(&facets->items, &facets->count, &facet, sizeof facet, NULL) != PL_OK;
}

static void add_triangle(pl_facets *facets, pl_vec a, pl_vec b, pl_vec c)
{
    add(facets, a, b, c, c, true);
}

static void add_box(const double half[3], pl_facets *facets)
{
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2, sign = side % 2 == 0 ? -1 : 1;
        static const int ring[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
        pl_vec corner[4];
        for (int i = 0; i < 4; ++i) {
            const int *at = ring[sign > 0 ? i : (4 - i) % 4];
            double p[3];
            p[axis] = sign * half[axis];
            p[(axis + 1) % 3] = at[0] * half[(axis + 1) % 3];
            p[(axis + 2) % 3] = at[1] * half[(axis + 2) % 3];
            corner[i] = pl_vec_of(p);
        }
        add(facets, corner[0], corner[1], corner[2], corner[3], false);
    }
}

/* ---- Round shapes ---- */

static int slices_of(double radius, double resolution)
{
    double slices = fmin(fmax(2 * pi * radius / resolution, LEAST_SLICES), MOST_SLICES);
    return 2 * (int)ceil(slices / 2);
}

/* A point of the circle of `radius` at height z. */
static pl_vec on_circle(double radius, double z, int i, int slices)
{
    double angle = 2 * pi * (i % slices) / slices;
    return (pl_vec){radius * cos(angle), radius * sin(angle), z};
}

/* Adds the surface between two circles, the lower first. One of them may be a point. */
static void add_band(pl_facets *facets, const double radius[2], const double z[2], int slices)
{
    for (int i = 0; i < slices; ++i) {
        pl_vec a = on_circle(radius[0], z[0], i, slices);
        pl_vec b = on_circle(radius[0], z[0], i + 1, slices);
        pl_vec c = on_circle(radius[1], z[1], i + 1, slices);
        pl_vec d = on_circle(radius[1], z[1], i, slices);
        if (radius[0] == 0) {
            add_triangle(facets, a, c, d);
        } else if (radius[1] == 0) {
            add_triangle(facets, a, b, c);
        } else {
            add(facets, a, b, c, d, false);
        }
    }
}

static void add_capsule(double radius, double half_height, double resolution, pl_facets *facets)
{
    for (int band = -BANDS; band <= BANDS; ++band) {
        double r[2], z[2];
        for (int k = 0; k < 2; ++k) {
            /* Circles from pole to pole, with that of the equator at both ends of the segment. */
            bool upper = band > 0 || (band == 0 && k == 1);
            int step = upper ? band + k - 1 : band + k;
            double angle = pi / 2 * step / BANDS;
            r[k] = abs(step) == BANDS ? 0 : radius * cos(angle);
            z[k] = radius * sin(angle) + (upper ? half_height : -half_height);
        }
        add_band(facets, r, z, slices_of(radius, resolution));
    }
}

static void add_cylinder(double radius, double half_height, double resolution, pl_facets *facets)
{
    const int slices = slices_of(radius, resolution);
    const double r[2] = {radius, radius}, z[2] = {-half_height, half_height};
    add_band(facets, r, z, slices);
    for (int end = 1; end >= 0; --end) {
        /* The polygon in strips. */
        for (int i = 0; i + 1 < slices / 2; ++i) {
            const int at[4] = {i, i + 1, slices - i - 2, slices - i - 1};
            pl_vec corner[4];
            for (int k = 0; k < 4; ++k) {
                corner[k] = on_circle(radius, z[end], at[z[end] > 0 ? k : 3 - k], slices);
            }
            add(facets, corner[0], corner[1], corner[2], corner[3], false);
        }
    }
}

/* ---- Hulls and meshes ---- */

typedef struct grid_vertex {
    double cell[3]; /* whole numbers */
    int vertex;
} grid_vertex;

static int compare_cells(const void *left, const void *right)
{
    const grid_vertex *a = left, *b = right;
    for (int k = 0; k < 3; ++k) {
        if (a->cell[k] != b->cell[k]) {
            return a->cell[k] < b->cell[k] ? -1 : 1;
        }
    }
    return a->vertex - b->vertex;
}

/* Finds for each vertex the first one in its grid cell, first[vertex_count]. */
static bool cluster(const pl_polyhedron *polyhedron, double size, int *first)
{
    int count = polyhedron->vertex_count;
    grid_vertex *sorted = calloc((size_t)count + 1, sizeof *sorted);
    if (sorted == NULL) {
        return false;
    }
    for (int i = 0; i < count; ++i) {
        sorted[i].vertex = i;
        for (int k = 0; k < 3; ++k) {
            sorted[i].cell[k] = floor((polyhedron->vertices[i][k] - polyhedron->centre[k]) / size);
        }
    }
    qsort(sorted, (size_t)count, sizeof *sorted, compare_cells);
    for (int i = 0; i < count; ++i) {
        bool same = i > 0;
        for (int k = 0; k < 3; ++k) {
            same = same && sorted[i].cell[k] == sorted[i - 1].cell[k];
        }
        first[sorted[i].vertex] = same ? first[sorted[i - 1].vertex] : sorted[i].vertex;
    }
    free(sorted);
    return true;
}

static void add_polyhedron(const pl_polyhedron *polyhedron, double resolution, pl_facets *facets)
{
    int *first = calloc((size_t)polyhedron->vertex_count + 1, sizeof *first);
    /* A body keeps its rough form, however small it is. */
    double size = fmin(resolution, polyhedron->radius / 2);
    facets->failed |= first == NULL || !cluster(polyhedron, size, first);
    for (int t = 0; !facets->failed && t < polyhedron->triangle_count; ++t) {
        const int *corner = polyhedron->triangles[t];
        int a = first[corner[0]], b = first[corner[1]], c = first[corner[2]];
        if (a != b && b != c && c != a) {
            add_triangle(facets, pl_vec_of(polyhedron->vertices[a]),
                         pl_vec_of(polyhedron->vertices[b]), pl_vec_of(polyhedron->vertices[c]));
        }
    }
    free(first);
}

pl_facets pl_facets_of(const pl_shape *shape, double resolution)
{
    pl_facets facets = {0};
    switch (shape->kind) {
    case PL_SHAPE_BOX:
        add_box(shape->half_extents, &facets);
        break;
    case PL_SHAPE_CAPSULE:
        add_capsule(shape->radius, shape->half_height, resolution, &facets);
        break;
    case PL_SHAPE_CYLINDER:
        add_cylinder(shape->radius, shape->half_height, resolution, &facets);
        break;
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        add_polyhedron(shape->polyhedron, resolution, &facets);
        break;
    case PL_SHAPE_PLANE:
    case PL_SHAPE_SPHERE:
        break;
    }
    return facets;
}
