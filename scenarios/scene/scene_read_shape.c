#include "scene_read_shape.h"

#include "scene_check.h"
#include "scene_internal.h"
#include "scene_read_fields.h"
#include "solids/obj.h"
#include "solids/polyhedron.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The scene takes `made`, which becomes the shape's. */
static bool keep(pl_shape_reader *r, const char *name, pl_polyhedron *made, pl_shape *shape)
{
    if (made == NULL) {
        return pl_diagnose_no_memory(r->diagnostic);
    }
    snprintf(made->name, sizeof made->name, "%s", name);
    r->triangles += made->triangle_count;
    if (r->triangles > PL_MAX_SCENE_TRIANGLES) {
        pl_polyhedron_free(made);
        return pl_diagnose(r->diagnostic,
                           "expected at most %d triangles of hulls and meshes together, found more",
                           PL_MAX_SCENE_TRIANGLES);
    }
    if (pl_scene_add_polyhedron(r->scene, made, NULL) != PL_OK) {
        pl_polyhedron_free(made);
        return pl_diagnose_no_memory(r->diagnostic);
    }
    *shape = pl_shape_of(made);
    return true;
}

static bool read_hull(pl_shape_reader *r, const json_t *json, const char *name, pl_shape *shape)
{
    double(*points)[3] = NULL;
    int count = 0;
    pl_polyhedron *made = NULL;
    const bool right =
        pl_json_triples(json, "points", &points, &count, r->diagnostic) &&
        pl_polyhedron_of_hull((const double(*)[3])points, count, &made, r->diagnostic);
    free(points);
    return right && keep(r, name, made, shape);
}

/* Numbers to indices; which of them are vertices is for the mesh to say. */
static bool to_indices(const double (*numbers)[3], int count, int (*triangles)[3],
                       pl_diagnostic *diagnostic)
{
    for (int i = 0; i < 3 * count; ++i) {
        const double x = numbers[i / 3][i % 3];
        if (!(x >= INT_MIN && x <= INT_MAX && x == (int)x)) {
            pl_path_push_key(&diagnostic->path, "triangles");
            pl_path_push_index(&diagnostic->path, i / 3);
            pl_path_push_index(&diagnostic->path, i % 3);
            return pl_diagnose(diagnostic, "expected the index of a vertex, found %.17g", x);
        }
        triangles[i / 3][i % 3] = (int)x;
    }
    return true;
}

static bool read_triangles(const json_t *json, int (**triangles)[3], int *count,
                           pl_diagnostic *diagnostic)
{
    double(*numbers)[3] = NULL;
    if (!pl_json_triples(json, "triangles", &numbers, count, diagnostic)) {
        return false;
    }
    bool right = true;
    *triangles = malloc((size_t)*count * sizeof **triangles + 1);
    if (*triangles == NULL) {
        right = pl_diagnose_no_memory(diagnostic);
    }
    right = right && to_indices((const double(*)[3])numbers, *count, *triangles, diagnostic);
    free(numbers);
    return right;
}

static bool read_inline_mesh(const json_t *json, pl_polyhedron **made, pl_diagnostic *diagnostic)
{
    double(*vertices)[3] = NULL;
    int(*triangles)[3] = NULL;
    int vertex_count = 0, triangle_count = 0;
    const bool right =
        pl_json_triples(json, "vertices", &vertices, &vertex_count, diagnostic) &&
        read_triangles(json, &triangles, &triangle_count, diagnostic) &&
        pl_polyhedron_of_mesh((const double(*)[3])vertices, vertex_count,
                              (const int(*)[3])triangles, triangle_count, made, diagnostic);
    free(vertices);
    free(triangles);
    return right;
}

static bool read_mesh_file(pl_shape_reader *r, const char *file, pl_polyhedron **made)
{
    if (r->folder == NULL) {
        return pl_diagnose_field(
            r->diagnostic, "file",
            "expected vertices and triangles, since a scene from memory has no "
            "folder, found a file");
    }
    pl_error error = {.status = PL_OK};
    size_t length = 0;
    const pl_status status = pl_polyhedron_of_file(r->folder, file, made, &length, &error);
    r->file_bytes += length;
    if (status == PL_OK && r->file_bytes > PL_MAX_SCENE_BYTES) {
        pl_polyhedron_free(*made);
        return pl_diagnose_field(r->diagnostic, "file",
                                 "expected files of at most %d MiB together, found more",
                                 PL_MAX_SCENE_BYTES >> 20);
    }
    if (status == PL_NO_MEMORY) {
        return pl_diagnose_no_memory(r->diagnostic);
    }
    return status == PL_OK || pl_diagnose_field(r->diagnostic, "file", "%s", error.message);
}

static bool read_mesh(pl_shape_reader *r, const json_t *json, const char *name, pl_shape *shape)
{
    const char *file = NULL;
    const bool has_vertices =
        json_object_get(json, "vertices") != NULL || json_object_get(json, "triangles") != NULL;
    if (!pl_json_string(json, "file", PL_OPTIONAL, "the name of a file", &file, r->diagnostic)) {
        return false;
    }
    if ((file != NULL) == has_vertices) {
        r->diagnostic->at_key = has_vertices;
        return pl_diagnose_field(
            r->diagnostic, "file",
            "expected either file or vertices and triangles of a mesh, found %s",
            has_vertices ? "both" : "neither");
    }
    pl_polyhedron *made = NULL;
    const bool right = file != NULL ? read_mesh_file(r, file, &made)
                                    : read_inline_mesh(json, &made, r->diagnostic);
    return right && keep(r, name, made, shape);
}

/* Reads the shape that `json` describes. A polyhedron gets the name. */
static bool read_shape(pl_shape_reader *r, const json_t *json, const char *name, pl_shape *shape)
{
    pl_diagnostic *diagnostic = r->diagnostic;
    int kind = 0;
    if (!json_is_object(json)) {
        char found[PL_FOUND_SIZE];
        return pl_diagnose(diagnostic, "expected an object, found %s", pl_json_found(json, found));
    }
    if (!pl_read_word(json, "type", PL_REQUIRED, pl_shape_names, PL_SHAPE_KIND_COUNT, &kind,
                      diagnostic) ||
        !pl_read_keys(json, PL_OBJECT_PLANE + (pl_object_kind)kind, diagnostic)) {
        return false;
    }
    *shape = (pl_shape){.kind = (pl_shape_kind)kind};
    if (shape->kind == PL_SHAPE_HULL) {
        return read_hull(r, json, name, shape);
    }
    if (shape->kind == PL_SHAPE_MESH) {
        return read_mesh(r, json, name, shape);
    }
    const pl_object *object = &pl_objects[PL_OBJECT_PLANE + kind];
    for (int i = 0; i < object->field_count; ++i) {
        if (!pl_read_field(json, &object->fields[i], shape, diagnostic)) {
            return false;
        }
    }
    return true;
}

/* One of "shapes"; the path stands at it. */
static bool read_named_shape(pl_shape_reader *r, const char *name, const json_t *json,
                             pl_named_shape *named)
{
    r->diagnostic->at_key = true;
    if (!pl_check_name(name, strlen(name), r->diagnostic)) {
        return false;
    }
    r->diagnostic->at_key = false;
    snprintf(named->name, sizeof named->name, "%s", name);
    return read_shape(r, json, name, &named->shape) && pl_check_shape(&named->shape, r->diagnostic);
}

bool pl_read_shapes(pl_shape_reader *r, const json_t *scene)
{
    const json_t *shapes = json_object_get(scene, "shapes");
    if (shapes == NULL) {
        return true;
    }
    pl_path_push_key(&r->diagnostic->path, "shapes");
    if (!json_is_object(shapes)) {
        char found[PL_FOUND_SIZE];
        return pl_diagnose(r->diagnostic, "expected an object of shapes, found %s",
                           pl_json_found(shapes, found));
    }
    r->shapes = malloc(json_object_size(shapes) * sizeof *r->shapes + 1);
    if (r->shapes == NULL) {
        return pl_diagnose_no_memory(r->diagnostic);
    }
    const char *name;
    json_t *value;
    int count = 0;
    json_object_foreach((json_t *)shapes, name, value)
    {
        pl_path_push_key(&r->diagnostic->path, name);
        if (!pl_leave(r->diagnostic, read_named_shape(r, name, value, &r->shapes[count++]))) {
            return false;
        }
    }
    if (pl_name_index_create(r->shapes[0].name, sizeof *r->shapes, count, &r->index) != PL_OK) {
        return pl_diagnose_no_memory(r->diagnostic);
    }
    pl_path_pop(&r->diagnostic->path);
    return true;
}

bool pl_read_body_shape(pl_shape_reader *r, const json_t *body, pl_shape *shape)
{
    const json_t *json = json_object_get(body, "shape");
    if (json_is_string(json)) {
        const char *name = json_string_value(json);
        const int i = pl_name_index_find(&r->index, name);
        if (i < 0) {
            return pl_diagnose_reference(r->diagnostic, "shape", "shape", name,
                                         pl_name_index_nearest(&r->index, name));
        }
        *shape = r->shapes[i].shape;
        return true;
    }
    pl_path_push_key(&r->diagnostic->path, "shape");
    if (!json_is_object(json)) {
        char found[PL_FOUND_SIZE];
        return pl_diagnose(r->diagnostic, "expected an object or the name of a shape, found %s",
                           pl_json_found(json, found));
    }
    return pl_leave(r->diagnostic, read_shape(r, json, "", shape));
}

void pl_shape_reader_free(pl_shape_reader *r)
{
    free(r->shapes);
    pl_name_index_free(&r->index);
}
