/* A face consists of all triangles whose corners lie in one plane: on a convex surface they are
 * connected.
 * Its border is the directed edges whose reverse belongs to no triangle of the face.
 *
 * The largest triangle that is still free founds the next face, so that a thin one, whose normal is
 * poor, founds none that a good one could. */
#include "hull_faces.h"

#include "plumb/vec.h"

#include <stdlib.h>
#include <string.h>

/* Corners within this share of the hull's radius of a plane lie in it: rounding of coordinates. */
static const double flatness = 1e-9;

/* What the search holds while it runs. */
typedef struct search {
    const pl_polyhedron *hull;
    int *face_of;      /* (triangle_count): -1 while free */
    int *next;         /* (vertex_count): the corner after this one on the border, or -1 */
    unsigned int *end; /* where the next polygon is written */
} search;

/* Twice the area, along the outward normal. */
static pl_vec area_vector(const pl_polyhedron *hull, int triangle)
{
    const int *t = hull->triangles[triangle];
    pl_vec a = pl_vec_of(hull->vertices[t[0]]);
    return pl_vec_cross(pl_vec_sub(pl_vec_of(hull->vertices[t[1]]), a),
                        pl_vec_sub(pl_vec_of(hull->vertices[t[2]]), a));
}

static int largest_free_triangle(const search *s)
{
    int largest = -1;
    double most = -1;
    for (int i = 0; i < s->hull->triangle_count; ++i) {
        double area = pl_vec_length(area_vector(s->hull, i));
        if (s->face_of[i] < 0 && area > most) {
            largest = i;
            most = area;
        }
    }
    return largest;
}

static bool lies_in(const pl_polyhedron *hull, int triangle, pl_vec normal, double offset)
{
    for (int k = 0; k < 3; ++k) {
        pl_vec corner = pl_vec_of(hull->vertices[hull->triangles[triangle][k]]);
        if (fabs(pl_vec_dot(normal, corner) - offset) > flatness * hull->radius) {
            return false;
        }
    }
    return pl_vec_dot(normal, area_vector(hull, triangle)) >= 0;
}

static bool has_edge(const search *s, int face, int from, int to)
{
    for (int i = 0; i < s->hull->triangle_count; ++i) {
        const int *t = s->hull->triangles[i];
        for (int k = 0; s->face_of[i] == face && k < 3; ++k) {
            if (t[k] == from && t[(k + 1) % 3] == to) {
                return true;
            }
        }
    }
    return false;
}

/* Writes the polygon around a face; false when its border is not one loop. */
static bool walk_border(search *s, int face)
{
    const pl_polyhedron *hull = s->hull;
    unsigned int edges = 0, corners = 0;
    int start = -1;
    for (int i = 0; i < hull->vertex_count; ++i) {
        s->next[i] = -1;
    }
    for (int i = 0; i < hull->triangle_count; ++i) {
        const int *t = hull->triangles[i];
        for (int k = 0; s->face_of[i] == face && k < 3; ++k) {
            if (!has_edge(s, face, t[(k + 1) % 3], t[k])) {
                start = t[k];
                s->next[start] = t[(k + 1) % 3];
                ++edges;
            }
        }
    }
    int corner = start;
    do {
        if (corner < 0 || corners == edges) {
            return false;
        }
        s->end[++corners] = (unsigned int)corner;
        corner = s->next[corner];
    } while (corner != start);
    s->end[0] = corners;
    s->end += corners + 1;
    return corners == edges;
}

static bool find_faces(search *s, const double origin[3], pl_hull_faces *faces)
{
    const pl_polyhedron *hull = s->hull;
    for (int founder; (founder = largest_free_triangle(s)) >= 0; ++faces->count) {
        pl_vec normal = area_vector(hull, founder);
        normal = pl_vec_scale(normal, 1 / pl_vec_length(normal));
        double offset = pl_vec_dot(normal, pl_vec_of(hull->vertices[hull->triangles[founder][0]]));
        for (int i = 0; i < hull->triangle_count; ++i) {
            if (s->face_of[i] < 0 && (i == founder || lies_in(hull, i, normal, offset))) {
                s->face_of[i] = faces->count;
            }
        }
        double *plane = faces->planes[faces->count];
        pl_vec_store(normal, plane);
        plane[3] = offset - pl_vec_dot(normal, pl_vec_of(origin));
        if (!walk_border(s, faces->count)) {
            return false;
        }
    }
    return true;
}

pl_status pl_hull_faces_of(const pl_polyhedron *hull, const double origin[3], pl_hull_faces *faces,
                           pl_error *error)
{
    pl_status status = PL_OK;
    size_t triangles = (size_t)hull->triangle_count;
    search s = {.hull = hull,
                .face_of = malloc((triangles + 1) * sizeof *s.face_of),
                .next = malloc(((size_t)hull->vertex_count + 1) * sizeof *s.next)};
    *faces = (pl_hull_faces){.planes = malloc((triangles + 1) * sizeof *faces->planes),
                             /* At most each triangle is a face: a count and three corners. */
                             .polygons = malloc((4 * triangles + 1) * sizeof *faces->polygons)};
    s.end = faces->polygons;
    if (s.face_of == NULL || s.next == NULL || faces->planes == NULL || s.end == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for the faces of a hull");
        goto cleanup;
    }
    memset(s.face_of, -1, triangles * sizeof *s.face_of);
    if (!find_faces(&s, origin, faces)) {
        status = pl_fail(error, PL_BAD_INPUT,
                         "hull \"%s\": face %d of its %d triangles has no single border: a hull "
                         "of corners alone, none of them within 1e-9 of a face, has",
                         hull->name, faces->count, hull->triangle_count);
    }
cleanup:
    free(s.face_of);
    free(s.next);
    if (status != PL_OK) {
        pl_hull_faces_free(faces);
    }
    return status;
}

void pl_hull_faces_free(pl_hull_faces *faces)
{
    free(faces->planes);
    free(faces->polygons);
    *faces = (pl_hull_faces){0};
}
