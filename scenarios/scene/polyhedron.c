#include "polyhedron.h"

#include "base/number.h"

#include <math.h>
#include <stdlib.h>

pl_polyhedron *pl_polyhedron_create(int vertex_count, int triangle_count)
{
    pl_polyhedron *made = calloc(1, sizeof *made);
    if (made == NULL) {
        return NULL;
    }
    made->vertices = malloc((size_t)vertex_count * sizeof *made->vertices);
    made->triangles = malloc((size_t)triangle_count * sizeof *made->triangles);
    if (made->vertices == NULL || made->triangles == NULL) {
        pl_polyhedron_free(made);
        return NULL;
    }
    made->vertex_count = vertex_count;
    made->triangle_count = triangle_count;
    return made;
}

void pl_polyhedron_free(pl_polyhedron *polyhedron)
{
    if (polyhedron != NULL) {
        free(polyhedron->vertices);
        free(polyhedron->triangles);
        free(polyhedron);
    }
}

bool pl_polyhedron_check_points(const char *key, const double (*points)[3], int count,
                                pl_diagnostic *diagnostic)
{
    for (int i = 0; i < 3 * count; i++) {
        const double x = points[i / 3][i % 3];
        if (!(fabs(x) <= PL_MAX_COORDINATE)) {
            char found[PL_NUMBER_SIZE];
            pl_path_push_key(&diagnostic->path, key);
            pl_path_push_index(&diagnostic->path, i / 3);
            pl_path_push_index(&diagnostic->path, i % 3);
            return pl_complain(diagnostic, "expected a finite number of at most %g, found %s",
                               PL_MAX_COORDINATE, pl_number_text(x, found));
        }
    }
    return true;
}

double pl_largest_coordinate(const double (*points)[3], int count)
{
    double largest = 0;
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            largest = fmax(largest, fabs(points[i][k]));
        }
    }
    return largest;
}
