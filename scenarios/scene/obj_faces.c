#include "obj_faces.h"

#include "mesh_edges.h"
#include "polygon.h"

#include <stdlib.h>
#include <string.h>

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
    for (int k = 0; k < 3; k++) {
        if (a->place[k] != b->place[k]) {
            return a->place[k] < b->place[k] ? -1 : 1;
        }
    }
    return a->number < b->number ? -1 : 1;
}

/* For each vertex the first of the same place, malloc'd; NULL when out of memory. */
static int *find_firsts(const pl_obj *obj)
{
    const size_t count = (size_t)obj->vertex_count;
    placed *sorted = malloc(count * sizeof *sorted);
    int *firsts = malloc(count * sizeof *firsts);
    if (sorted == NULL || firsts == NULL) {
        free(sorted);
        free(firsts);
        return NULL;
    }
    for (int i = 0; i < obj->vertex_count; i++) {
        memcpy(sorted[i].place, obj->vertices[i], sizeof sorted[i].place);
        sorted[i].number = i;
    }
    qsort(sorted, count, sizeof *sorted, by_place_then_number);
    for (size_t i = 0; i < count; i++) {
        const bool same =
            i > 0 && memcmp(sorted[i].place, sorted[i - 1].place, sizeof sorted[i].place) == 0;
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

/* Complains of a corner that is no vertex, or that the face has twice. */
static pl_status check_corners(const cutter *c, int face)
{
    const pl_obj_faces *f = c->faces;
    const int *corner = f->corner + f->first[face];
    const int count = f->first[face + 1] - f->first[face];
    for (int i = 0; i < count; i++) {
        if (corner[i] >= c->obj->vertex_count) {
            return pl_fail(c->error, PL_BAD_INPUT,
                           "%s:%d: expected a vertex from 1 to %d, found %lld", c->label,
                           f->line[face], c->obj->vertex_count, corner[i] + 1LL);
        }
    }
    memcpy(c->spare, corner, (size_t)count * sizeof *corner);
    qsort(c->spare, (size_t)count, sizeof *c->spare, by_value);
    for (int i = 1; i < count; i++) {
        if (c->spare[i] == c->spare[i - 1]) {
            return pl_fail(c->error, PL_BAD_INPUT,
                           "%s:%d: expected different vertices in a face, found %d twice", c->label,
                           f->line[face], c->spare[i] + 1);
        }
    }
    return PL_OK;
}

/* The corners of a face as numbered[] has them, none beside itself, into `spare`; their count. */
static int take_corners(const cutter *c, int face, const int *numbered)
{
    int count = 0;
    for (int i = c->faces->first[face]; i < c->faces->first[face + 1]; i++) {
        const int corner = numbered[c->faces->corner[i]];
        if (count == 0 || corner != c->spare[count - 1]) {
            c->spare[count++] = corner;
        }
    }
    while (count > 1 && c->spare[count - 1] == c->spare[0]) {
        count--;
    }
    return count;
}

static pl_status cut_face(cutter *c, int face, int count)
{
    static const char *const expected[] = {
        [PL_POLYGON_NO_AREA] = "a face with an area, found its corners on one line",
        [PL_POLYGON_NOT_FLAT] =
            "a face that is flat to a thousandth of its size, found one that is "
            "not: cut it into triangles",
        [PL_POLYGON_CROSSES] =
            "a face whose outline does not touch or cross itself, found one that "
            "does"};
    pl_obj *obj = c->obj;
    if (count < 3) {
        return PL_OK; /* all of it in one place, or on one edge */
    }
    const pl_polygon_fault fault = pl_polygon_cut((const double(*)[3])obj->vertices, c->spare,
                                                  count, obj->triangles + obj->triangle_count);
    if (fault == PL_POLYGON_NO_MEMORY) {
        return fail_by_memory(c);
    }
    if (fault != PL_POLYGON_RIGHT) {
        return pl_fail(c->error, PL_BAD_INPUT, "%s:%d: expected %s", c->label, c->faces->line[face],
                       expected[fault]);
    }
    for (int i = 0; i < count - 2; i++) {
        obj->lines[obj->triangle_count++] = c->faces->line[face];
    }
    return PL_OK;
}

static pl_status cut_all(cutter *c, const int *numbered)
{
    pl_status status = PL_OK;
    c->obj->triangle_count = 0;
    for (int face = 0; face < c->faces->face_count && status == PL_OK; face++) {
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
    for (int i = 0; i < count; i++) {
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
    for (int face = 0; face < faces->face_count && status == PL_OK; face++) {
        status = check_corners(&c, face);
    }
    if (status == PL_OK) {
        status = cut_as_closed(&c);
    }
    free(c.spare);
    return status;
}
