/* The faces of an .obj file as triangles.
 *
 * A polygon of which all corners are seen from the first in turn becomes a fan. Any other is cut by
 * clipping ears (Meisters, Polygons have ears, 1975): an ear is a corner whose triangle with its
 * two neighbours has an area and holds no other corner, not even on its border, so that what is
 * left is again a polygon. Whether a corner is an ear changes only when a neighbour goes. */
#include "obj_faces.h"

#include "mesh.h"
#include "mesh_triangle.h"
#include "plumb/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Polygons ---- */

typedef enum polygon_fault {
    POLYGON_RIGHT,
    POLYGON_NO_AREA,
    POLYGON_NOT_FLAT, /* a corner is farther from the plane than a thousandth of its size */
    POLYGON_CROSSES,  /* its outline does not enclose one piece */
    POLYGON_NO_MEMORY
} polygon_fault;

typedef struct point {
    double x, y; /* in the polygon's plane, seen so that it is counter-clockwise, over its size */
} point;

/* Less than this, over the square of the size, is no area. */
#define AREA_ROUNDING 1e-14
#define FLATNESS 1e-3

/* Twice the area of a triangle, positive when counter-clockwise. */
static double area(point a, point b, point c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static pl_vec arm(const double (*vertices)[3], const int *corner, int i)
{
    return pl_vec_sub(pl_vec_of(vertices[corner[i]]), pl_vec_of(vertices[corner[0]]));
}

static polygon_fault project(const double (*vertices)[3], const int *corner, int count,
                             point *points)
{
    double size = 0;
    for (int i = 1; i < count; ++i) {
        size = fmax(size, pl_vec_length(arm(vertices, corner, i)));
    }
    if (!(size > 0)) {
        return POLYGON_NO_AREA;
    }
    pl_vec normal = {0, 0, 0}; /* twice the area, over the square of the size */
    for (int i = 1; i + 1 < count; ++i) {
        const pl_vec a = pl_vec_scale(arm(vertices, corner, i), 1 / size);
        const pl_vec b = pl_vec_scale(arm(vertices, corner, i + 1), 1 / size);
        normal = pl_vec_add(normal, pl_vec_cross(a, b));
    }
    const double length = pl_vec_length(normal);
    if (!(length > AREA_ROUNDING)) {
        return POLYGON_NO_AREA;
    }
    normal = pl_vec_scale(normal, 1 / length);
    const pl_vec steepest = fabs(normal.x) < 0.6   ? (pl_vec){1, 0, 0}
                            : fabs(normal.y) < 0.6 ? (pl_vec){0, 1, 0}
                                                   : (pl_vec){0, 0, 1};
    pl_vec u = pl_vec_reject(steepest, normal);
    u = pl_vec_scale(u, 1 / pl_vec_length(u));
    const pl_vec v = pl_vec_cross(normal, u);
    double low = 0, high = 0;
    for (int i = 0; i < count; ++i) {
        const pl_vec a = pl_vec_scale(arm(vertices, corner, i), 1 / size);
        points[i] = (point){pl_vec_dot(a, u), pl_vec_dot(a, v)};
        low = fmin(low, pl_vec_dot(a, normal));
        high = fmax(high, pl_vec_dot(a, normal));
    }
    return high - low > FLATNESS ? POLYGON_NOT_FLAT : POLYGON_RIGHT;
}

/* Whether the corners go round the first counter-clockwise by less than half a turn. */
static bool is_fan(const point *points, int count)
{
    for (int i = 2; i < count; ++i) {
        if (!(area(points[0], points[1], points[i]) > AREA_ROUNDING) ||
            !(area(points[0], points[i - 1], points[i]) > AREA_ROUNDING)) {
            return false;
        }
    }
    return true;
}

/* Whether two sides cross. Clipping ears would not show it of an outline that goes round twice. */
static bool crosses_itself(const point *points, int count)
{
    for (int i = 0; i < count; ++i) {
        const point a = points[i], b = points[(i + 1) % count];
        for (int k = i + 2; k < count; ++k) {
            const point c = points[k], d = points[(k + 1) % count];
            if (area(a, b, c) * area(a, b, d) < 0 && area(c, d, a) * area(c, d, b) < 0) {
                return true;
            }
        }
    }
    return false;
}

/* The rest of a polygon after some ears are cut: a ring of corners. */
typedef struct ring {
    const point *points;
    int *previous, *next; /* (count) */
    bool *ear;            /* (count) */
} ring;

static bool is_ear(const ring *r, int i)
{
    const point a = r->points[r->previous[i]], b = r->points[i], c = r->points[r->next[i]];
    if (!(area(a, b, c) > AREA_ROUNDING)) {
        return false;
    }
    for (int k = r->next[r->next[i]]; k != r->previous[i]; k = r->next[k]) {
        const point p = r->points[k];
        if (area(a, b, p) >= -AREA_ROUNDING && area(b, c, p) >= -AREA_ROUNDING &&
            area(c, a, p) >= -AREA_ROUNDING) {
            return false;
        }
    }
    return true;
}

/* The triangles of the ring, as numbers of its corners; false where no ear is left. */
static bool clip_ears(ring *r, int count, int (*triangles)[3])
{
    for (int i = 0; i < count; ++i) {
        r->previous[i] = (i + count - 1) % count;
        r->next[i] = (i + 1) % count;
    }
    for (int i = 0; i < count; ++i) {
        r->ear[i] = is_ear(r, i);
    }
    int at = 0, left = count, passed = 0, made = 0;
    while (left > 3 && passed < left) {
        const int before = r->previous[at], after = r->next[at];
        if (!r->ear[at]) {
            ++passed;
            at = after;
            continue;
        }
        int *triangle = triangles[made++];
        triangle[0] = before;
        triangle[1] = at;
        triangle[2] = after;
        r->next[before] = after;
        r->previous[after] = before;
        --left;
        passed = 0;
        r->ear[before] = is_ear(r, before);
        r->ear[after] = is_ear(r, after);
        at = r->next[after]; /* ears from all around make fewer slivers than from one side */
    }
    const int before = r->previous[at], after = r->next[at];
    triangles[made][0] = before;
    triangles[made][1] = at;
    triangles[made][2] = after;
    return left == 3 && area(r->points[before], r->points[at], r->points[after]) > AREA_ROUNDING;
}

/* Cuts the polygon of corner[0 .. count), 3 to PL_MAX_POLYGON_CORNERS different vertices in order,
 * into count - 2 triangles of the same direction. O(n), or O(n^2) where it is not convex. */
static polygon_fault cut_polygon(const double (*vertices)[3], const int *corner, int count,
                                 int (*triangles)[3])
{
    const size_t room = (size_t)count;
    point *points = malloc(room * sizeof *points);
    ring r = {.points = points,
              .previous = malloc(room * sizeof *r.previous),
              .next = malloc(room * sizeof *r.next),
              .ear = malloc(room * sizeof *r.ear)};
    polygon_fault fault = POLYGON_NO_MEMORY;
    if (points == NULL || r.previous == NULL || r.next == NULL || r.ear == NULL) {
        goto cleanup;
    }
    if (count == 3) { /* as it is: the mesh's own rule applies */
        const bool has_area = pl_mesh_has_area(vertices, corner);
        memcpy(triangles[0], corner, sizeof triangles[0]);
        fault = has_area ? POLYGON_RIGHT : POLYGON_NO_AREA;
        goto cleanup;
    }
    fault = project(vertices, corner, count, points);
    if (fault != POLYGON_RIGHT) {
        goto cleanup;
    }
    if (is_fan(points, count)) {
        for (int i = 0; i < count - 2; ++i) {
            triangles[i][0] = 0;
            triangles[i][1] = i + 1;
            triangles[i][2] = i + 2;
        }
    } else if (crosses_itself(points, count) || !clip_ears(&r, count, triangles)) {
        fault = POLYGON_CROSSES;
        goto cleanup;
    }
    for (int i = 0; i < 3 * (count - 2); ++i) {
        triangles[i / 3][i % 3] = corner[triangles[i / 3][i % 3]];
    }
cleanup:
    free(points);
    free(r.previous);
    free(r.next);
    free(r.ear);
    return fault;
}

/* ---- Faces ---- */

typedef struct cutter {
    const pl_obj_faces *faces;
    pl_obj *obj;
    const char *label;
    pl_error *error;
    int *spare; /* (PL_MAX_POLYGON_CORNERS) */
} cutter;

static pl_status fail_by_memory(const cutter *c)
{
    return pl_fail(c->error, PL_NO_MEMORY, "%s: out of memory", c->label);
}

/* A vertex and its number. */
typedef struct placed {
    double place[3];
    int number;
} placed;

static int by_place_then_number(const void *left, const void *right)
{
    const placed *a = left, *b = right;
    for (int k = 0; k < 3; ++k) {
        if (a->place[k] != b->place[k]) {
            return a->place[k] < b->place[k] ? -1 : 1;
        }
    }
    return a->number < b->number ? -1 : 1;
}

/* For each vertex the first of the same place, malloc'd; NULL when out of memory. */
static int *find_firsts(const pl_obj *obj)
{
    const size_t count = (size_t)obj->vertex_count, size = sizeof(double[3]);
    placed *sorted = malloc(count * sizeof *sorted);
    int *firsts = malloc(count * sizeof *firsts);
    if (sorted == NULL || firsts == NULL) {
        free(sorted);
        free(firsts);
        return NULL;
    }
    for (int i = 0; i < obj->vertex_count; ++i) {
        memcpy(sorted[i].place, obj->vertices[i], sizeof sorted[i].place);
        sorted[i].number = i;
    }
    qsort(sorted, count, sizeof *sorted, by_place_then_number);
    for (size_t i = 0; i < count; ++i) {
        /* NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): equal bits are meant */
        const bool same = i > 0 && memcmp(sorted[i].place, sorted[i - 1].place, size) == 0;
        firsts[sorted[i].number] = same ? firsts[sorted[i - 1].number] : sorted[i].number;
    }
    free(sorted);
    return firsts;
}

static int by_value(const void *left, const void *right)
{
    const int a = *(const int *)left, b = *(const int *)right;
    return (a > b) - (a < b);
}

/* Reports a corner that is no vertex, or that the face has twice. */
static pl_status check_corners(const cutter *c, int face)
{
    const pl_obj_faces *f = c->faces;
    const int *corner = f->corner + f->first[face];
    const int count = f->first[face + 1] - f->first[face];
    for (int i = 0; i < count; ++i) {
        if (corner[i] >= c->obj->vertex_count) {
            return pl_fail(c->error, PL_BAD_INPUT,
                           "%s:%d: expected a vertex from 1 to %d, found %lld", c->label,
                           f->line[face], c->obj->vertex_count, corner[i] + 1LL);
        }
    }
    memcpy(c->spare, corner, (size_t)count * sizeof *corner);
    qsort(c->spare, (size_t)count, sizeof *c->spare, by_value);
    for (int i = 1; i < count; ++i) {
        if (c->spare[i] == c->spare[i - 1]) {
            return pl_fail(c->error, PL_BAD_INPUT,
                           "%s:%d: expected different vertices in a face, found %d twice", c->label,
                           f->line[face], c->spare[i] + 1);
        }
    }
    return PL_OK;
}

/* Fills `spare` with the corners of a face as numbered[] has them, without equal neighbours.
 * Returns their number. */
static int take_corners(const cutter *c, int face, const int *numbered)
{
    int count = 0;
    for (int i = c->faces->first[face]; i < c->faces->first[face + 1]; ++i) {
        const int corner = numbered[c->faces->corner[i]];
        if (count == 0 || corner != c->spare[count - 1]) {
            c->spare[count++] = corner;
        }
    }
    while (count > 1 && c->spare[count - 1] == c->spare[0]) {
        --count;
    }
    return count;
}

static pl_status cut_face(cutter *c, int face, int count)
{
    static const char *const expected[] = {
        [POLYGON_NO_AREA] = "a face with an area, found its corners on one line",
        [POLYGON_NOT_FLAT] = "a face that is flat to a thousandth of its size, found one that is "
                             "not: cut it into triangles",
        [POLYGON_CROSSES] = "a face whose outline does not touch or cross itself, found one that "
                            "does"};
    pl_obj *obj = c->obj;
    if (count < 3) {
        return PL_OK; /* all of it in one place, or on one edge */
    }
    const polygon_fault fault = cut_polygon((const double(*)[3])obj->vertices, c->spare, count,
                                            obj->triangles + obj->triangle_count);
    if (fault == POLYGON_NO_MEMORY) {
        return fail_by_memory(c);
    }
    if (fault != POLYGON_RIGHT) {
        return pl_fail(c->error, PL_BAD_INPUT, "%s:%d: expected %s", c->label, c->faces->line[face],
                       expected[fault]);
    }
    for (int i = 0; i < count - 2; ++i) {
        obj->lines[obj->triangle_count++] = c->faces->line[face];
    }
    return PL_OK;
}

static pl_status cut_all(cutter *c, const int *numbered)
{
    pl_status status = PL_OK;
    c->obj->triangle_count = 0;
    for (int face = 0; face < c->faces->face_count && status == PL_OK; ++face) {
        status = cut_face(c, face, take_corners(c, face, numbered));
    }
    return status;
}

/* Whether each edge is of two triangles; false also when out of memory. */
static bool is_closed(const pl_obj *obj)
{
    pl_diagnostic ignored = {.status = PL_OK};
    int(*neighbours)[3] = malloc((size_t)obj->triangle_count * sizeof *neighbours + 1);
    const bool closed = neighbours != NULL && obj->triangle_count > 0 &&
                        pl_mesh_neighbours((const int(*)[3])obj->triangles, obj->triangle_count,
                                           neighbours, &ignored);
    free(neighbours);
    return closed;
}

/* With the vertices as the file numbers them, or, where faces do not close so, with those of one
 * place as one: solids that touch stay apart. */
static pl_status cut_as_closed(cutter *c)
{
    const int count = c->obj->vertex_count;
    int *numbered = malloc((size_t)count * sizeof *numbered);
    int *firsts = find_firsts(c->obj);
    pl_status status = PL_NO_MEMORY;
    if (numbered == NULL || firsts == NULL) {
        fail_by_memory(c);
        goto cleanup;
    }
    for (int i = 0; i < count; ++i) {
        numbered[i] = i;
    }
    cutter quiet = *c;
    quiet.error = NULL;
    status = cut_all(&quiet, numbered);
    if (status != PL_OK || !is_closed(c->obj)) {
        status = cut_all(c, firsts);
    }
cleanup:
    free(numbered);
    free(firsts);
    return status;
}

pl_status pl_obj_cut_faces(const pl_obj_faces *faces, pl_obj *obj, const char *label,
                           pl_error *error)
{
    const size_t room = (size_t)(faces->corner_count - 2 * faces->face_count);
    cutter c = {.faces = faces,
                .obj = obj,
                .label = label,
                .error = error,
                .spare = malloc(PL_MAX_POLYGON_CORNERS * sizeof *c.spare)};
    obj->triangles = malloc(room * sizeof *obj->triangles);
    obj->lines = malloc(room * sizeof *obj->lines);
    pl_status status = PL_OK;
    if (obj->triangles == NULL || obj->lines == NULL || c.spare == NULL) {
        status = fail_by_memory(&c);
    }
    for (int face = 0; face < faces->face_count && status == PL_OK; ++face) {
        status = check_corners(&c, face);
    }
    if (status == PL_OK) {
        status = cut_as_closed(&c);
    }
    free(c.spare);
    return status;
}
