#include "obj.h"

#include "base/file_text.h"
#include "base/number.h"
#include "obj_faces.h"
#include "obj_scan.h"
#include "plumb/scene.h"
#include "polygon.h"
#include "polyhedron.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
    pl_obj_scan scan;
    pl_obj *obj;
    pl_obj_faces faces;
    int vertex_room, corner_room, face_room;
} reader;

static pl_status fail_by_memory(const reader *r)
{
    return pl_fail(r->scan.error, PL_NO_MEMORY, "%s: out of memory", r->scan.label);
}

/* Makes room for one more item and returns the array as it then is; NULL when out of memory. */
static void *with_room(void *items, int count, int *room, size_t size)
{
    if (count < *room) {
        return items;
    }
    const int wanted = *room == 0 ? 256 : 2 * *room;
    void *grown = realloc(items, (size_t)wanted * size);
    *room = grown == NULL ? *room : wanted;
    return grown;
}

static pl_status read_vertex(reader *r)
{
    pl_obj *obj = r->obj;
    double numbers[7] = {0};
    int count = 0;
    pl_obj_word word = pl_obj_next_word(&r->scan);
    for (; word.length > 0 && count < 7; word = pl_obj_next_word(&r->scan)) {
        if (!pl_decimal(word.text, word.length, &numbers[count]) ||
            fabs(numbers[count]) > PL_MAX_COORDINATE) {
            return pl_obj_fail(&r->scan, r->scan.line, "a number of a vertex, at most 1e50", word);
        }
        count++;
    }
    if (word.length > 0 || count < 3 || count == 5) {
        return pl_fail(r->scan.error, PL_BAD_INPUT,
                       "%s:%d: expected x, y and z of a vertex, and perhaps a weight or a colour, "
                       "found %s%d numbers",
                       r->scan.label, r->scan.line, word.length > 0 ? "more than " : "", count);
    }
    if (obj->vertex_count == PL_MAX_VERTICES) {
        return pl_fail(r->scan.error, PL_BAD_INPUT,
                       "%s:%d: expected at most %d vertices, found more", r->scan.label,
                       r->scan.line, PL_MAX_VERTICES);
    }
    void *grown =
        with_room(obj->vertices, obj->vertex_count, &r->vertex_room, sizeof *obj->vertices);
    if (grown == NULL) {
        return fail_by_memory(r);
    }
    obj->vertices = grown;
    for (int k = 0; k < 3; k++) {
        obj->vertices[obj->vertex_count][k] = numbers[k] + 0.0; /* no -0: it is the same place */
    }
    obj->vertex_count++;
    return PL_OK;
}

/* A whole number other than 0 from text[0 .. length). */
static bool to_number(const char *text, size_t length, int *number)
{
    double value;
    if (length == 0 || memchr(text, '.', length) != NULL || memchr(text, 'e', length) != NULL ||
        memchr(text, 'E', length) != NULL || !pl_decimal(text, length, &value) ||
        fabs(value) > INT_MAX || value == 0) {
        return false;
    }
    *number = (int)value;
    return true;
}

/* v, v/vt, v//vn or v/vt/vn; *number is v. */
static bool to_corner(pl_obj_word word, int *number)
{
    const char *end = word.text + word.length;
    const char *slash = memchr(word.text, '/', word.length);
    if (!to_number(word.text, (size_t)((slash == NULL ? end : slash) - word.text), number)) {
        return false;
    }
    if (slash == NULL) {
        return true;
    }
    const char *texture = slash + 1;
    const char *second = memchr(texture, '/', (size_t)(end - texture));
    int ignored;
    if (second == NULL) {
        return to_number(texture, (size_t)(end - texture), &ignored);
    }
    return (second == texture || to_number(texture, (size_t)(second - texture), &ignored)) &&
           to_number(second + 1, (size_t)(end - second - 1), &ignored);
}

static pl_status read_corner(reader *r, pl_obj_word word)
{
    int number;
    if (!to_corner(word, &number)) {
        return pl_obj_fail(&r->scan, r->scan.line,
                           "a corner v, v/vt, v//vn or v/vt/vn of whole numbers other than 0",
                           word);
    }
    if (number < -r->obj->vertex_count) {
        char expected[96];
        snprintf(expected, sizeof expected, "a vertex before the face, of which there are %d",
                 r->obj->vertex_count);
        return pl_obj_fail(&r->scan, r->scan.line, expected, word);
    }
    if (r->faces.corner_count - r->faces.first[r->faces.face_count] == PL_MAX_POLYGON_CORNERS) {
        return pl_fail(r->scan.error, PL_BAD_INPUT,
                       "%s:%d: expected a face of at most %d corners, found more", r->scan.label,
                       r->scan.line, PL_MAX_POLYGON_CORNERS);
    }
    int *grown =
        with_room(r->faces.corner, r->faces.corner_count, &r->corner_room, sizeof *r->faces.corner);
    if (grown == NULL) {
        return fail_by_memory(r);
    }
    r->faces.corner = grown;
    r->faces.corner[r->faces.corner_count++] =
        number > 0 ? number - 1 : r->obj->vertex_count + number;
    return PL_OK;
}

static pl_status read_face(reader *r)
{
    /* Both arrays have one more than faces, and the same room. */
    int room = r->face_room;
    int *first = with_room(r->faces.first, r->faces.face_count + 1, &room, sizeof *r->faces.first);
    r->faces.first = first != NULL ? first : r->faces.first;
    room = r->face_room;
    int *line = with_room(r->faces.line, r->faces.face_count + 1, &room, sizeof *r->faces.line);
    r->faces.line = line != NULL ? line : r->faces.line;
    if (first == NULL || line == NULL) {
        return fail_by_memory(r);
    }
    r->face_room = room;
    r->faces.first[r->faces.face_count] = r->faces.corner_count;
    r->faces.line[r->faces.face_count] = r->scan.line;
    pl_status status = PL_OK;
    int count = 0;
    for (pl_obj_word word = pl_obj_next_word(&r->scan); word.length > 0 && status == PL_OK;
         word = pl_obj_next_word(&r->scan)) {
        status = read_corner(r, word);
        count++;
    }
    if (status == PL_OK && count < 3) {
        return pl_fail(r->scan.error, PL_BAD_INPUT,
                       "%s:%d: expected a face of at least 3 corners, found %d", r->scan.label,
                       r->faces.line[r->faces.face_count], count);
    }
    const long long triangles = r->faces.corner_count - 2LL * (r->faces.face_count + 1);
    if (status == PL_OK && triangles > PL_MAX_TRIANGLES) {
        return pl_fail(r->scan.error, PL_BAD_INPUT,
                       "%s:%d: expected at most %d triangles, found more", r->scan.label,
                       r->scan.line, PL_MAX_TRIANGLES);
    }
    r->faces.first[++r->faces.face_count] = r->faces.corner_count;
    return status;
}

static pl_status read_line(reader *r)
{
    static const char *const left_out[] = {
        "vt",       "vn",  "vp",       "p",          "l",        "o",      "g",
        "s",        "mg",  "usemtl",   "mtllib",     "usemap",   "maplib", "bevel",
        "c_interp", "lod", "d_interp", "shadow_obj", "trace_obj"};
    static const char *const curved[] = {"cstype", "deg",  "bmat",  "step", "curv", "curv2",
                                         "surf",   "parm", "trim",  "hole", "scrv", "sp",
                                         "end",    "con",  "ctech", "stech"};
    const pl_obj_word word = pl_obj_next_word(&r->scan);
    if (word.length == 0) {
        return PL_OK;
    }
    if (pl_obj_word_is(word, "v")) {
        return read_vertex(r);
    }
    if (pl_obj_word_is(word, "f")) {
        return read_face(r);
    }
    for (size_t i = 0; i < sizeof left_out / sizeof left_out[0]; i++) {
        if (pl_obj_word_is(word, left_out[i])) {
            return PL_OK;
        }
    }
    for (size_t i = 0; i < sizeof curved / sizeof curved[0]; i++) {
        if (pl_obj_word_is(word, curved[i])) {
            return pl_obj_fail(&r->scan, r->scan.line, "faces, no curves and curved surfaces",
                               word);
        }
    }
    return pl_obj_fail(&r->scan, r->scan.line, "v, f or another word of an .obj file", word);
}

static pl_status read_lines(reader *r)
{
    static const char byte_order_mark[] = "\xEF\xBB\xBF";
    if (r->scan.end - r->scan.at >= 3 && memcmp(r->scan.at, byte_order_mark, 3) == 0) {
        r->scan.at += 3;
    }
    do {
        const pl_status status = read_line(r);
        if (status != PL_OK) {
            return status;
        }
    } while (pl_obj_next_line(&r->scan));
    if (r->obj->vertex_count == 0 || r->faces.face_count == 0) {
        return pl_fail(r->scan.error, PL_BAD_INPUT,
                       "%s:%d: expected vertices and faces, found %d and %d by the end of the file",
                       r->scan.label, r->scan.line, r->obj->vertex_count, r->faces.face_count);
    }
    return PL_OK;
}

pl_status pl_obj_read_text(const char *text, size_t length, const char *label, pl_obj *obj,
                           pl_error *error)
{
    *obj = (pl_obj){.vertices = NULL};
    reader r = {
        .scan = {.at = text, .end = text + length, .line = 1, .label = label, .error = error},
        .obj = obj};
    pl_status status = read_lines(&r);
    if (status == PL_OK) {
        status = pl_obj_cut_faces(&r.faces, obj, label, error);
    }
    free(r.faces.corner);
    free(r.faces.first);
    free(r.faces.line);
    if (status != PL_OK) {
        pl_obj_free(obj);
    }
    return status;
}

pl_status pl_obj_read_file(const char *path, pl_obj *obj, pl_error *error)
{
    static const pl_file_kind kind = {.noun = "Wavefront .obj", .most_bytes = PL_MAX_SCENE_BYTES};
    char *text = NULL;
    size_t length = 0;
    *obj = (pl_obj){.vertices = NULL};
    pl_status status = pl_file_read(&kind, path, &text, &length, error);
    if (status == PL_OK) {
        status = pl_obj_read_text(text, length, pl_file_label(path), obj, error);
        free(text);
    }
    return status;
}

void pl_obj_free(pl_obj *obj)
{
    free(obj->vertices);
    free(obj->triangles);
    free(obj->lines);
    *obj = (pl_obj){.vertices = NULL};
}
