#include "obj.h"

#include "base/array.h"
#include "base/diagnostic.h"
#include "base/file_beneath.h"
#include "base/file_text.h"
#include "base/number.h"
#include "base/text_buffer.h"
#include "obj_faces.h"
#include "polyhedron.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Lines and words ---- */

typedef struct scanner {
    const char *at, *end;
    int line; /* from 1 */
    const char *label;
    pl_error *error;
    bool is_obj; /* a vertex was read: words of the text may be shown */
} scanner;

typedef struct obj_word {
    const char *text; /* borrowed */
    size_t length;    /* 0: the line has ended */
} obj_word;

static char peek(const scanner *s, size_t ahead)
{
    return (size_t)(s->end - s->at) > ahead ? s->at[ahead] : '\n';
}

/* Bytes of a line break here: LF, CR LF or CR; 0 where none is. */
static size_t break_size(const scanner *s, size_t ahead)
{
    if (peek(s, ahead) == '\r') {
        return (size_t)(s->end - s->at) > ahead + 1 && s->at[ahead + 1] == '\n' ? 2 : 1;
    }
    return peek(s, ahead) == '\n' ? 1 : 0;
}

static bool is_joined(const scanner *s)
{
    return s->at < s->end && *s->at == '\\' && break_size(s, 1) > 0;
}

static void skip(scanner *s, size_t count)
{
    const size_t left = (size_t)(s->end - s->at);
    s->at += count < left ? count : left;
}

/* The next word of the line, after comments and joined lines. */
static obj_word next_word(scanner *s)
{
    while (peek(s, 0) == ' ' || peek(s, 0) == '\t' || is_joined(s)) {
        if (is_joined(s)) {
            skip(s, 1 + break_size(s, 1));
            ++s->line;
        } else {
            ++s->at;
        }
    }
    if (peek(s, 0) == '#') {
        while (break_size(s, 0) == 0) {
            ++s->at;
        }
    }
    const char *begin = s->at;
    while (peek(s, 0) != ' ' && peek(s, 0) != '\t' && break_size(s, 0) == 0 && !is_joined(s)) {
        ++s->at;
    }
    return (obj_word){begin, (size_t)(s->at - begin)};
}

/* Goes to the line after the words. False at the end of the text. */
static bool next_line(scanner *s)
{
    while (next_word(s).length > 0) {}
    if (s->at == s->end) {
        return false;
    }
    skip(s, break_size(s, 0));
    ++s->line;
    return true;
}

static bool word_is(obj_word word, const char *text)
{
    return word.length == strlen(text) && memcmp(word.text, text, word.length) == 0;
}

/* PL_BAD_INPUT: LABEL:LINE: expected ..., found the word, or what stands for it. */
static pl_status fail_by_word(const scanner *s, int line, const char *expected, obj_word found)
{
    char copy[PL_QUOTED_SIZE], quoted[PL_QUOTED_SIZE];
    if (!s->is_obj && found.length > 0) {
        return pl_fail(s->error, PL_BAD_INPUT, "%s:%d: expected %s, found another word", s->label,
                       line, expected);
    }
    const size_t kept = found.length < sizeof copy - 1 ? found.length : sizeof copy - 1;
    memcpy(copy, found.text, kept);
    copy[kept] = '\0';
    for (char *zero; (zero = memchr(copy, '\0', kept)) != NULL;) {
        *zero = '?';
    }
    return pl_fail(s->error, PL_BAD_INPUT, "%s:%d: expected %s, found %s", s->label, line, expected,
                   found.length == 0 ? "the end of the line" : pl_quoted(copy, quoted));
}

/* ---- Vertices and faces ---- */

typedef struct reader {
    scanner scan;
    pl_obj *obj;
    pl_obj_faces faces;
    int vertex_room, corner_room, first_room, line_room;
} reader;

static pl_status fail_by_memory(const reader *r)
{
    return pl_fail(r->scan.error, PL_NO_MEMORY, "%s: out of memory", r->scan.label);
}

static pl_status read_vertex(reader *r)
{
    pl_obj *obj = r->obj;
    double numbers[7] = {0};
    int count = 0;
    obj_word word = next_word(&r->scan);
    for (; word.length > 0 && count < 7; word = next_word(&r->scan)) {
        if (!pl_decimal(word.text, word.length, &numbers[count]) ||
            fabs(numbers[count]) > PL_MAX_COORDINATE) {
            return fail_by_word(&r->scan, r->scan.line, "a number of a vertex, at most 1e50", word);
        }
        ++count;
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
    if (pl_array_reserve(&obj->vertices, &r->vertex_room, obj->vertex_count + 1,
                         sizeof *obj->vertices, NULL) != PL_OK) {
        return fail_by_memory(r);
    }
    for (int k = 0; k < 3; ++k) {
        obj->vertices[obj->vertex_count][k] = numbers[k] + 0.0; /* no -0: it is the same place */
    }
    ++obj->vertex_count;
    r->scan.is_obj = true;
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
static bool to_corner(obj_word word, int *number)
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

static pl_status read_corner(reader *r, obj_word word)
{
    int number;
    if (!to_corner(word, &number)) {
        return fail_by_word(&r->scan, r->scan.line,
                            "a corner v, v/vt, v//vn or v/vt/vn of whole numbers other than 0",
                            word);
    }
    if (number < -r->obj->vertex_count) {
        char expected[96];
        snprintf(expected, sizeof expected, "a vertex before the face, of which there are %d",
                 r->obj->vertex_count);
        return fail_by_word(&r->scan, r->scan.line, expected, word);
    }
    if (r->faces.corner_count - r->faces.first[r->faces.face_count] == PL_MAX_POLYGON_CORNERS) {
        return pl_fail(r->scan.error, PL_BAD_INPUT,
                       "%s:%d: expected a face of at most %d corners, found more", r->scan.label,
                       r->scan.line, PL_MAX_POLYGON_CORNERS);
    }
    if (pl_array_reserve(&r->faces.corner, &r->corner_room, r->faces.corner_count + 1,
                         sizeof *r->faces.corner, NULL) != PL_OK) {
        return fail_by_memory(r);
    }
    r->faces.corner[r->faces.corner_count++] =
        number > 0 ? number - 1 : r->obj->vertex_count + number;
    return PL_OK;
}

static pl_status read_face(reader *r)
{
    const int wanted = r->faces.face_count + 2; /* both arrays have one more than faces */
    if (pl_array_reserve(&r->faces.first, &r->first_room, wanted, sizeof *r->faces.first, NULL) !=
            PL_OK ||
        pl_array_reserve(&r->faces.line, &r->line_room, wanted, sizeof *r->faces.line, NULL) !=
            PL_OK) {
        return fail_by_memory(r);
    }
    r->faces.first[r->faces.face_count] = r->faces.corner_count;
    r->faces.line[r->faces.face_count] = r->scan.line;
    pl_status status = PL_OK;
    int count = 0;
    for (obj_word word = next_word(&r->scan); word.length > 0 && status == PL_OK;
         word = next_word(&r->scan)) {
        status = read_corner(r, word);
        ++count;
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
    const obj_word word = next_word(&r->scan);
    if (word.length == 0) {
        return PL_OK;
    }
    if (word_is(word, "v")) {
        return read_vertex(r);
    }
    if (word_is(word, "f")) {
        return read_face(r);
    }
    for (size_t i = 0; i < sizeof left_out / sizeof left_out[0]; ++i) {
        if (word_is(word, left_out[i])) {
            return PL_OK;
        }
    }
    for (size_t i = 0; i < sizeof curved / sizeof curved[0]; ++i) {
        if (word_is(word, curved[i])) {
            return fail_by_word(&r->scan, r->scan.line, "faces, no curves and curved surfaces",
                                word);
        }
    }
    return fail_by_word(&r->scan, r->scan.line, "v, f or another word of an .obj file", word);
}

static pl_status read_lines(reader *r)
{
    r->scan.at += pl_byte_order_mark(r->scan.at, (size_t)(r->scan.end - r->scan.at));
    do {
        const pl_status status = read_line(r);
        if (status != PL_OK) {
            return status;
        }
    } while (next_line(&r->scan));
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

void pl_obj_free(pl_obj *obj)
{
    free(obj->vertices);
    free(obj->triangles);
    free(obj->lines);
    *obj = (pl_obj){.vertices = NULL};
}

/* ---- Solids ---- */

/* The diagnostic of a mesh as an error at the line of the triangle that it is about. */
static pl_status fail_by(const pl_diagnostic *diagnostic, const pl_obj *obj, const char *path,
                         pl_error *error)
{
    const pl_path *place = &diagnostic->path;
    if (diagnostic->status != PL_BAD_INPUT) {
        return pl_fail(error, diagnostic->status, "%s: %s", path, diagnostic->text);
    }
    if (place->depth >= 2 && strcmp(place->steps[0].key, "triangles") == 0) {
        return pl_fail(error, PL_BAD_INPUT, "%s:%d: %s (numbers from 0)", path,
                       obj->lines[place->steps[1].index], diagnostic->text);
    }
    return pl_fail(error, PL_BAD_INPUT, "%s: %s", path, diagnostic->text);
}

/* Reads the file below the folder. */
static pl_status read_file(const char *folder, const char *path, const char *label, char **text,
                           size_t *length, pl_error *error)
{
    static const pl_file_kind kind = {.noun = "Wavefront .obj", .most_bytes = PL_MAX_SCENE_BYTES};
    int descriptor = -1;
    const pl_status status =
        pl_file_open_beneath(kind.noun, folder, path, label, &descriptor, error);
    return status != PL_OK ? status
                           : pl_file_read_open(&kind, descriptor, label, text, length, error);
}

static pl_status make_solid(const char *text, size_t length, const char *label,
                            pl_polyhedron **polyhedron, pl_error *error)
{
    pl_obj obj;
    pl_diagnostic diagnostic = {.status = PL_OK};
    pl_status status = pl_obj_read_text(text, length, label, &obj, error);
    if (status == PL_OK && !pl_polyhedron_of_mesh((const double(*)[3])obj.vertices,
                                                  obj.vertex_count, (const int(*)[3])obj.triangles,
                                                  obj.triangle_count, polyhedron, &diagnostic)) {
        status = fail_by(&diagnostic, &obj, label, error);
    }
    pl_obj_free(&obj);
    return status;
}

pl_status pl_polyhedron_of_file(const char *folder, const char *path, pl_polyhedron **polyhedron,
                                size_t *length, pl_error *error)
{
    pl_text_buffer label = {0};
    char *text = NULL;
    pl_text_add(&label, path[0] == '/' ? "" : folder);
    pl_text_add(&label, path);
    if (label.failed) {
        return pl_fail(error, PL_NO_MEMORY, "%s: out of memory", path);
    }
    pl_status status = read_file(folder, path, label.data, &text, length, error);
    if (status == PL_OK) {
        status = make_solid(text, *length, label.data, polyhedron, error);
        free(text);
    }
    pl_text_free(&label);
    return status;
}
