/* The convex hull of points, by qhull (Barber, Dobkin and Huhdanpaa 1996).
 * qhull merges facets that are flat within rounding into faces of many corners; each becomes a fan
 * of triangles here. Rounding is that of the coordinates as given: far from the origin they are
 * coarse, however small the solid. A point is a corner when it is one of at least three faces: so
 * points inside, on an edge, on a face, or given twice are none. The hull is made again from its
 * corners alone until all of them are corners, which makes it the same when it is made from its own
 * vertices; vertices keep their order, and triangles are in the order of their faces' lowest
 * corners. */
#define _POSIX_C_SOURCE 200809L

#include "mesh.h"
#include "plumb/vec.h"
#include "polyhedron.h"

#include <libqhull_r/qhull_ra.h>

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Faces as qhull finds them: the corners of face f are corner[first[f] .. first[f + 1]), numbers of
 * points. */
typedef struct faces {
    int *first, *corner;
    int face_count, corner_count;
    int face_room, corner_room;
} faces;

static void free_faces(faces *f)
{
    free(f->first);
    free(f->corner);
    *f = (faces){.first = NULL};
}

/* Room for `count` more numbers; the array as it then is, or NULL. */
static int *grow(int *numbers, int used, int count, int *room)
{
    if (used + count <= *room) {
        return numbers;
    }
    *room = 2 * (used + count) + 64;
    return realloc(numbers, (size_t)*room * sizeof *numbers);
}

static bool add_face(faces *f, const int *corners, int count)
{
    int *first = grow(f->first, f->face_count, 2, &f->face_room);
    f->first = first != NULL ? first : f->first;
    int *corner = grow(f->corner, f->corner_count, count, &f->corner_room);
    f->corner = corner != NULL ? corner : f->corner;
    if (first == NULL || corner == NULL) {
        return false;
    }
    first[0] = 0;
    memcpy(corner + f->corner_count, corners, (size_t)count * sizeof *corners);
    f->corner_count += count;
    f->face_count += 1;
    first[f->face_count] = f->corner_count;
    return true;
}

/* Twice the area vector of a polygon (Newell), from its first corner. */
static pl_vec area_vector(const double (*points)[3], const int *corner, int count)
{
    pl_vec sum = {0, 0, 0};
    const pl_vec origin = pl_vec_of(points[corner[0]]);
    for (int i = 1; i + 1 < count; ++i) {
        const pl_vec a = pl_vec_sub(pl_vec_of(points[corner[i]]), origin);
        const pl_vec b = pl_vec_sub(pl_vec_of(points[corner[i + 1]]), origin);
        sum = pl_vec_add(sum, pl_vec_cross(a, b));
    }
    return sum;
}

/* Turns and shifts the polygon so that it is counter-clockwise about `outward` and begins with its
 * lowest corner. `spare` has room for it. */
static void arrange(const double (*points)[3], int *corner, int count, pl_vec outward, int *spare)
{
    const bool turned = pl_vec_dot(area_vector(points, corner, count), outward) < 0;
    int lowest = 0;
    for (int i = 1; i < count; ++i) {
        lowest = corner[i] < corner[lowest] ? i : lowest;
    }
    for (int i = 0; i < count; ++i) {
        spare[i] = corner[(lowest + (turned ? count - i : i)) % count];
    }
    memcpy(corner, spare, (size_t)count * sizeof *corner);
}

/* All faces of a finished qhull. False when out of memory. */
static bool take_faces(qhT *qh, const double (*points)[3], int *buffer, faces *f)
{
    facetT *facet;
    vertexT *vertex, **vertexp;
    FORALLfacets
    {
        setT *ring = qh_facet3vertex(qh, facet);
        int count = 0;
        FOREACHvertex_(ring)
        {
            buffer[count++] = qh_pointid(qh, vertex->point);
        }
        qh_settempfree(qh, &ring);
        arrange(points, buffer, count, pl_vec_of(facet->normal), buffer + qh->num_points);
        if (!add_face(f, buffer, count)) {
            return false;
        }
    }
    return true;
}

/* qhull leaves a fault by longjmp; the caller frees the memory afterwards. Returns its exit code,
 * qh_ERRmem when our own memory ran out. */
static int run_qhull(qhT *qh, double (*scaled)[3], int count, double rounding,
                     const double (*points)[3], int *buffer, faces *f)
{
    char command[64], words[512];
    /* A whole number and an exponent: the same in every locale. */
    snprintf(command, sizeof command, "qhull Pp E%.0fe-18", ceil(rounding * 1e18));
    FILE *sink = fmemopen(words, sizeof words, "w"); /* it must print somewhere */
    if (sink == NULL) {
        return qh_ERRmem;
    }
    qh_zero(qh, sink);
    int code = qh_new_qhull(qh, 3, count, scaled[0], False, command, sink, sink);
    if (code == qh_ERRnone) {
        qh->NOerrexit = False;
        code = setjmp(qh->errexit);
        if (code == 0) {
            code = take_faces(qh, points, buffer, f) ? qh_ERRnone : qh_ERRmem;
        }
        qh->NOerrexit = True;
    }
    int long_left, total;
    qh_freeqhull(qh, !qh_ALL);
    qh_memfreeshort(qh, &long_left, &total);
    fclose(sink);
    return code;
}

/* The points, moved and scaled so that the largest coordinate is about 1: by powers of two and
 * differences that lose nothing that the coordinates have. Returns their rounding on that scale. */
static double scale_points(const double (*points)[3], int count, double (*scaled)[3])
{
    double low[3], size = 0;
    memcpy(low, points[0], sizeof low);
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            low[k] = fmin(low[k], points[i][k]);
        }
    }
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            scaled[i][k] = points[i][k] - low[k];
            size = fmax(size, scaled[i][k]);
        }
    }
    if (size == 0) {
        return 1; /* all in one place */
    }
    int exponent = 0;
    frexp(size, &exponent);
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            scaled[i][k] = ldexp(scaled[i][k], -exponent);
        }
    }
    return 16 * DBL_EPSILON * fmax(1, ldexp(pl_largest_coordinate(points, count), -exponent));
}

static bool find_faces(const double (*points)[3], int count, faces *f, pl_diagnostic *diagnostic)
{
    qhT *qh = malloc(sizeof *qh);
    double(*scaled)[3] = malloc((size_t)count * sizeof *scaled);
    int *buffer = malloc(2 * (size_t)count * sizeof *buffer);
    int code = qh_ERRmem;
    if (qh != NULL && scaled != NULL && buffer != NULL) {
        const double rounding = scale_points(points, count, scaled);
        code = rounding < 0.01 ? run_qhull(qh, scaled, count, rounding, points, buffer, f)
                               : qh_ERRsingular;
    }
    free(qh);
    free(scaled);
    free(buffer);
    switch (code) {
    case qh_ERRnone:
        return true;
    case qh_ERRmem:
        return pl_diagnose_no_memory(diagnostic);
    case qh_ERRsingular:
        return pl_diagnose_field(
            diagnostic, "points",
            "expected points that do not all lie in one plane, found %d that do", count);
    default:
        return pl_diagnose_field(
            diagnostic, "points",
            "expected points whose hull is clear beyond rounding, found %d that "
            "are flat or close together",
            count);
    }
}

/* Keeps of points[*count] those that are one of at least three faces. */
static bool keep_corners(const faces *f, double (*points)[3], int *count, pl_diagnostic *diagnostic)
{
    int *uses = calloc((size_t)*count, sizeof *uses);
    if (uses == NULL) {
        return pl_diagnose_no_memory(diagnostic);
    }
    for (int i = 0; i < f->corner_count; ++i) {
        ++uses[f->corner[i]];
    }
    int kept = 0;
    for (int i = 0; i < *count; ++i) {
        if (uses[i] >= 3) {
            memmove(points[kept++], points[i], sizeof points[i]);
        }
    }
    free(uses);
    *count = kept;
    return kept >= 4 ||
           pl_diagnose_field(diagnostic, "points",
                             "expected at least 4 corners, found %d: the points are nearly flat",
                             kept);
}

/* Whether all triangles of the fan from corner number `apex` have an area and the same sense. */
static bool is_clear_fan(const double (*points)[3], const int *corner, int count, int apex,
                         pl_vec outward)
{
    for (int i = 1; i + 1 < count; ++i) {
        const int triangle[3] = {corner[apex], corner[(apex + i) % count],
                                 corner[(apex + i + 1) % count]};
        if (!(pl_vec_dot(area_vector(points, triangle, 3), outward) > 0)) {
            return false;
        }
    }
    return true;
}

/* The face as a fan; from its lowest corner unless another makes better triangles. */
static void put_fan(pl_polyhedron *p, const int *corner, int count)
{
    const double(*points)[3] = (const double(*)[3])p->vertices;
    const pl_vec outward = area_vector(points, corner, count);
    int apex = 0;
    for (int i = 0; i < count; ++i) {
        if (is_clear_fan(points, corner, count, i, outward)) {
            apex = i;
            break;
        }
    }
    for (int i = 1; i + 1 < count; ++i) {
        int *triangle = p->triangles[p->triangle_count++];
        triangle[0] = corner[apex];
        triangle[1] = corner[(apex + i) % count];
        triangle[2] = corner[(apex + i + 1) % count];
    }
}

typedef struct ranked_face {
    const int *corner; /* its lowest comes first */
    int count;
} ranked_face;

static int by_first_corners(const void *left, const void *right)
{
    const ranked_face *a = left, *b = right;
    for (int k = 0; k < 3; ++k) {
        if (a->corner[k] != b->corner[k]) {
            return a->corner[k] < b->corner[k] ? -1 : 1;
        }
    }
    return 0;
}

static bool put_faces(const faces *f, pl_polyhedron *p)
{
    ranked_face *ranked = malloc(((size_t)f->face_count + 1) * sizeof *ranked);
    if (ranked == NULL) {
        return false;
    }
    for (int i = 0; i < f->face_count; ++i) {
        ranked[i] = (ranked_face){f->corner + f->first[i], f->first[i + 1] - f->first[i]};
    }
    qsort(ranked, (size_t)f->face_count, sizeof *ranked, by_first_corners);
    p->triangle_count = 0;
    for (int i = 0; i < f->face_count; ++i) {
        put_fan(p, ranked[i].corner, ranked[i].count);
    }
    free(ranked);
    return true;
}

/* A hull whose points are all corners, from its faces. */
static bool build(const double (*points)[3], int count, const faces *f, pl_polyhedron **polyhedron,
                  pl_diagnostic *diagnostic)
{
    pl_polyhedron *made = pl_polyhedron_create(count, f->corner_count - 2 * f->face_count);
    if (made == NULL) {
        return pl_diagnose_no_memory(diagnostic);
    }
    made->convex = true;
    memcpy(made->vertices, points, (size_t)count * sizeof *points);
    /* Euler: a sphere of V corners has 2 V - 4 triangles. */
    if (!put_faces(f, made)) {
        pl_diagnose_no_memory(diagnostic);
    } else if (made->triangle_count != 2 * count - 4 || !pl_mesh_is_closed(made) ||
               !pl_polyhedron_measure(made)) {
        pl_diagnose_field(diagnostic, "points",
                          "expected points whose hull is clear beyond rounding, at most a million "
                          "times as long as wide, found %d corners of another",
                          count);
    } else {
        *polyhedron = made;
        return true;
    }
    pl_polyhedron_free(made);
    return false;
}

bool pl_polyhedron_of_hull(const double (*points)[3], int count, pl_polyhedron **polyhedron,
                           pl_diagnostic *diagnostic)
{
    if (count < 4 || count > PL_MAX_HULL_POINTS) {
        return pl_diagnose_field(diagnostic, "points", "expected 4 to %d points, found %d",
                                 PL_MAX_HULL_POINTS, count);
    }
    if (!pl_polyhedron_check_points("points", points, count, diagnostic)) {
        return false;
    }
    double(*kept)[3] = malloc((size_t)count * sizeof *kept);
    if (kept == NULL) {
        return pl_diagnose_no_memory(diagnostic);
    }
    memcpy(kept, points, (size_t)count * sizeof *kept);
    faces f = {.first = NULL};
    bool made = false, right = true;
    while (right && !made) {
        free_faces(&f);
        int corners = count;
        right = find_faces((const double(*)[3])kept, count, &f, diagnostic) &&
                keep_corners(&f, kept, &corners, diagnostic);
        if (right && corners == count) {
            right = made = build((const double(*)[3])kept, count, &f, polyhedron, diagnostic);
        }
        count = corners;
    }
    free_faces(&f);
    free(kept);
    return made;
}
