/* Round shapes are cut into slices like an orange. Meshes are thinned by clustering their vertices
 * in a grid (Rossignac and Borrel 1993). */
#include "facets.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;

enum { LEAST_SLICES = 8, MOST_SLICES = 24, BANDS = 4 /* of a half sphere */ };

void pl_facets_free(pl_facets *facets)
{
    free(facets->items);
    *facets = (pl_facets){0};
}

static bool reserve(pl_facets *facets, int most)
{
    *facets = (pl_facets){.items = calloc((size_t)most + 1, sizeof *facets->items)};
    return facets->items != NULL;
}

static void add(pl_facets *facets, pl_vec a, pl_vec b, pl_vec c, pl_vec d)
{
    facets->items[facets->count++] = (pl_facet){.corner = {a, b, c, d}};
}

static void add_triangle(pl_facets *facets, pl_vec a, pl_vec b, pl_vec c)
{
    facets->items[facets->count++] = (pl_facet){.corner = {a, b, c, c}, .triangle = true};
}

static bool add_box(const double half[3], pl_facets *facets)
{
    if (!reserve(facets, 6))
        return false;
    for (int side = 0; side < 6; side++) {
        const int axis = side / 2, sign = side % 2 == 0 ? -1 : 1;
        static const int ring[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
        pl_vec corner[4];
        for (int i = 0; i < 4; i++) {
            const int *at = ring[sign > 0 ? i : (4 - i) % 4];
            double p[3];
            p[axis] = sign * half[axis];
            p[(axis + 1) % 3] = at[0] * half[(axis + 1) % 3];
            p[(axis + 2) % 3] = at[1] * half[(axis + 2) % 3];
            corner[i] = pl_vec_of(p);
        }
        add(facets, corner[0], corner[1], corner[2], corner[3]);
    }
    return true;
}

/* --- Round shapes --- */

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

/* Between two circles, the lower first. One of them may be a point. */
static void add_band(pl_facets *facets, const double radius[2], const double z[2], int slices)
{
    for (int i = 0; i < slices; i++) {
        pl_vec a = on_circle(radius[0], z[0], i, slices);
        pl_vec b = on_circle(radius[0], z[0], i + 1, slices);
        pl_vec c = on_circle(radius[1], z[1], i + 1, slices);
        pl_vec d = on_circle(radius[1], z[1], i, slices);
        if (radius[0] == 0)
            add_triangle(facets, a, c, d);
        else if (radius[1] == 0)
            add_triangle(facets, a, b, c);
        else
            add(facets, a, b, c, d);
    }
}

static bool add_capsule(double radius, double half_height, double resolution, pl_facets *facets)
{
    int slices = slices_of(radius, resolution);
    if (!reserve(facets, (2 * BANDS + 1) * slices))
        return false;
    for (int band = -BANDS; band <= BANDS; band++) {
        double r[2], z[2];
        for (int k = 0; k < 2; k++) {
            /* Circles from pole to pole, that of the equator at both ends of the segment. */
            int circle = band + k;
            bool upper = band > 0 || (band == 0 && k == 1);
            int step = upper ? circle - 1 : circle;
            double angle = pi / 2 * step / BANDS;
            r[k] = abs(step) == BANDS ? 0 : radius * cos(angle);
            z[k] = radius * sin(angle) + (upper ? half_height : -half_height);
        }
        add_band(facets, r, z, slices);
    }
    return true;
}

/* An end's polygon in strips. */
static void add_end(pl_facets *facets, double radius, double z, int slices)
{
    for (int i = 0; i + 1 < slices / 2; i++) {
        const int at[4] = {i, i + 1, slices - i - 2, slices - i - 1};
        pl_vec corner[4];
        for (int k = 0; k < 4; k++)
            corner[k] = on_circle(radius, z, at[z > 0 ? k : 3 - k], slices);
        add(facets, corner[0], corner[1], corner[2], corner[3]);
    }
}

static bool add_cylinder(double radius, double half_height, double resolution, pl_facets *facets)
{
    int slices = slices_of(radius, resolution);
    const double r[2] = {radius, radius}, z[2] = {-half_height, half_height};
    if (!reserve(facets, 2 * slices))
        return false;
    add_band(facets, r, z, slices);
    add_end(facets, radius, half_height, slices);
    add_end(facets, radius, -half_height, slices);
    return true;
}

/* --- Hulls and meshes --- */

typedef struct cell {
    double at[3]; /* whole numbers */
    int vertex;
} cell;

static int compare_cells(const void *left, const void *right)
{
    const cell *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->at[k] != b->at[k])
            return a->at[k] < b->at[k] ? -1 : 1;
    return a->vertex - b->vertex;
}

/* For each vertex the first of its cell, into first[vertex_count]. */
static bool cluster(const pl_polyhedron *polyhedron, double size, int *first)
{
    int count = polyhedron->vertex_count;
    cell *cells = calloc((size_t)count + 1, sizeof *cells);
    if (cells == NULL)
        return false;
    for (int i = 0; i < count; i++) {
        cells[i].vertex = i;
        for (int k = 0; k < 3; k++)
            cells[i].at[k] = floor((polyhedron->vertices[i][k] - polyhedron->centre[k]) / size);
    }
    qsort(cells, (size_t)count, sizeof *cells, compare_cells);
    for (int i = 0; i < count; i++) {
        bool same = i > 0;
        for (int k = 0; k < 3; k++)
            same = same && cells[i].at[k] == cells[i - 1].at[k];
        first[cells[i].vertex] = same ? first[cells[i - 1].vertex] : cells[i].vertex;
    }
    free(cells);
    return true;
}

static bool add_polyhedron(const pl_polyhedron *polyhedron, double resolution, pl_facets *facets)
{
    int *first = calloc((size_t)polyhedron->vertex_count + 1, sizeof *first);
    /* However small, a body keeps its form in the rough. */
    double size = fmin(resolution, polyhedron->radius / 2);
    bool complete = first != NULL && cluster(polyhedron, size, first) &&
                    reserve(facets, polyhedron->triangle_count);
    for (int t = 0; complete && t < polyhedron->triangle_count; t++) {
        const int *corner = polyhedron->triangles[t];
        int a = first[corner[0]], b = first[corner[1]], c = first[corner[2]];
        if (a != b && b != c && c != a)
            add_triangle(facets, pl_vec_of(polyhedron->vertices[a]),
                         pl_vec_of(polyhedron->vertices[b]), pl_vec_of(polyhedron->vertices[c]));
    }
    free(first);
    return complete;
}

bool pl_facets_of(const pl_shape *shape, double resolution, pl_facets *facets)
{
    *facets = (pl_facets){0};
    switch (shape->kind) {
    case PL_SHAPE_BOX:
        return add_box(shape->half_extents, facets);
    case PL_SHAPE_CAPSULE:
        return add_capsule(shape->radius, shape->half_height, resolution, facets);
    case PL_SHAPE_CYLINDER:
        return add_cylinder(shape->radius, shape->half_height, resolution, facets);
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        return add_polyhedron(shape->polyhedron, resolution, facets);
    case PL_SHAPE_PLANE:
    case PL_SHAPE_SPHERE:
        break;
    }
    return true;
}
