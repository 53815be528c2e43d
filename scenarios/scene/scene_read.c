/* Scene files: their text to a scene, object by object, by the table of fields. This file has the
 * rules that only the text shows: keys, types, names that refer to others, and defaults that depend
 * on other fields. The rules of the numbers are in scene_check.c. */
#include "scene_read.h"
#include "base/file_text.h"
#include "base/json_text.h"
#include "base/name_index.h"
#include "scene_check.h"
#include "scene_internal.h"
#include "scene_parameters.h"
#include "scene_read_fields.h"
#include "scene_read_shape.h"
#include "scene_scan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
    pl_scene *scene;
    pl_json_items *bodies; /* where they are apart from the rest; NULL: they are not */
    pl_shape_reader shapes;
    pl_name_index body_names; /* once all bodies are read */
    pl_diagnostic diagnostic;
} reader;

/* The struct of any object that is an item of a list. */
typedef union any_item {
    pl_material material;
    pl_material_pair pair;
    pl_body body;
    pl_force force;
    pl_expect_rest rest;
    pl_expect_travel travel;
    pl_expect_value value;
    pl_expect_statistic statistic;
} any_item;

static bool read_object(reader *r, const json_t *json, pl_object_kind kind, void *item);

static bool added(reader *r, pl_status status)
{
    return status == PL_OK || pl_diagnose_no_memory(&r->diagnostic);
}

/* ---- References ---- */

/* The material of a body that names none. */
static bool use_default_material(reader *r, int *index)
{
    static const pl_material material = {.name = "default", .friction = 0.5, .restitution = 0};
    *index = pl_scene_find_material(r->scene, material.name);
    if (*index >= 0) {
        return true;
    }
    if (r->scene->material_count == PL_MAX_MATERIALS) {
        return pl_diagnose_field(
            &r->diagnostic, "material",
            "expected a name, since there is no room for a default material next "
            "to %d others, found nothing",
            PL_MAX_MATERIALS);
    }
    return added(r, pl_scene_add_material(r->scene, &material, index, NULL));
}

static bool read_material_reference(reader *r, const json_t *object, const char *key, int *index)
{
    const pl_scene *scene = r->scene;
    const char *name = NULL;
    if (!pl_json_string(object, key, PL_REQUIRED, "the name of a material", &name,
                        &r->diagnostic)) {
        return false;
    }
    *index = pl_scene_find_material(scene, name);
    if (*index >= 0) {
        return true;
    }
    const char *names[PL_MAX_MATERIALS];
    for (int i = 0; i < scene->material_count; ++i) {
        names[i] = scene->materials[i].name;
    }
    return pl_diagnose_reference(&r->diagnostic, key, "material", name,
                                 pl_nearest_name(name, names, scene->material_count));
}

static bool read_body_reference(reader *r, const json_t *object, const char *key, int *index)
{
    const char *name = NULL;
    if (!pl_json_string(object, key, PL_REQUIRED, "the name of a body", &name, &r->diagnostic)) {
        return false;
    }
    *index = pl_name_index_find(&r->body_names, name);
    return *index >= 0 || pl_diagnose_reference(&r->diagnostic, key, "body", name,
                                                pl_name_index_nearest(&r->body_names, name));
}

/* ---- Bodies ---- */

/* Reports an error when the body has one of `keys`, a list that ends with NULL. */
static bool has_none_of(reader *r, const json_t *body, const char *const *keys,
                        const char *expected)
{
    for (; *keys != NULL; ++keys) {
        const json_t *json = json_object_get(body, *keys);
        if (json != NULL) {
            char found[PL_FOUND_SIZE];
            r->diagnostic.at_key = true;
            return pl_diagnose_field(&r->diagnostic, *keys, "expected %s, found %s", expected,
                                     pl_json_found(json, found));
        }
    }
    return true;
}

/* The mass may be given as density times volume. Inertia, where it is given, is not all zeros,
 * which stand for that of the shape. */
static bool finish_mass(reader *r, const json_t *json, pl_body *body)
{
    pl_diagnostic *diagnostic = &r->diagnostic;
    static const char *const of_dynamic[] = {"mass", "density", "inertia", NULL};
    if (body->is_static || body->shape.kind == PL_SHAPE_PLANE) {
        return has_none_of(r, json, of_dynamic, "neither mass nor inertia of a static body");
    }
    const bool has_mass = json_object_get(json, "mass") != NULL;
    const bool has_density = json_object_get(json, "density") != NULL;
    if (has_mass == has_density) {
        diagnostic->at_key = has_density;
        return pl_diagnose_field(diagnostic, has_mass ? "density" : "mass",
                                 "expected either mass or density of a body that is not static, "
                                 "found %s",
                                 has_mass ? "both" : "neither");
    }
    if (has_density) {
        double density = 0;
        if (!pl_json_number(json, "density", PL_REQUIRED, &density, diagnostic)) {
            return false;
        }
        if (!(density > 0)) {
            return pl_diagnose_field(diagnostic, "density", "expected a number above 0, found %g",
                                     density);
        }
        body->mass = density * pl_shape_volume(&body->shape);
    }
    const bool all_zero = body->inertia[0] == 0 && body->inertia[1] == 0 && body->inertia[2] == 0;
    if (all_zero && json_object_get(json, "inertia") != NULL) {
        return pl_diagnose_field(diagnostic, "inertia", "expected numbers above 0, found zeros");
    }
    return true;
}

static bool finish_body(reader *r, const json_t *json, pl_body *body)
{
    static const char *const of_placed[] = {"position", "orientation", NULL};
    if (body->shape.kind == PL_SHAPE_PLANE) {
        if (json_object_get(json, "static") == NULL) {
            body->is_static = true;
        }
        if (!has_none_of(r, json, of_placed,
                         "a plane to be placed by its shape's normal and offset")) {
            return false;
        }
    }
    return finish_mass(r, json, body) &&
           (json_object_get(json, "material") != NULL || use_default_material(r, &body->material));
}

/* ---- Lists ---- */

/* Completes an item that is read and gives it to the scene. */
static bool add_item(reader *r, const json_t *json, pl_object_kind kind, any_item *item)
{
    pl_scene *scene = r->scene;
    switch (kind) {
    case PL_OBJECT_MATERIAL:
        return added(r, pl_scene_add_material(scene, &item->material, NULL, NULL));
    case PL_OBJECT_PAIR:
        return added(r, pl_scene_add_pair(scene, &item->pair, NULL));
    case PL_OBJECT_BODY:
        return finish_body(r, json, &item->body) &&
               added(r, pl_scene_add_body(scene, &item->body, NULL, NULL));
    case PL_OBJECT_FORCE:
        item->force.body = scene->body_count - 1;
        return added(r, pl_scene_add_force(scene, &item->force, NULL));
    case PL_OBJECT_REST:
        item->rest.has_orientation = json_object_get(json, "orientation") != NULL;
        return added(r, pl_scene_add_rest(scene, &item->rest, NULL));
    case PL_OBJECT_TRAVEL:
        return added(r, pl_scene_add_travel(scene, &item->travel, NULL));
    case PL_OBJECT_STATISTIC:
        return added(r, pl_scene_add_statistic(scene, &item->statistic, NULL));
    default:
        return added(r, pl_scene_add_value(scene, &item->value, NULL));
    }
}

static bool read_items(reader *r, const json_t *object, const pl_field *field);

/* Reads one item. `name` is its key in an object of items, NULL in an array. The path stands at
 * it. */
static bool read_item(reader *r, const json_t *json, pl_object_kind kind, const char *name)
{
    any_item item;
    memcpy(&item, pl_objects[kind].defaults, pl_objects[kind].size);
    if (kind == PL_OBJECT_VALUE) {
        item.value = pl_expect_value_default(r->scene);
    }
    if (name != NULL) {
        r->diagnostic.at_key = true;
        if (!pl_check_name(name, strlen(name), &r->diagnostic)) {
            return false;
        }
        r->diagnostic.at_key = false;
        memcpy(item.material.name, name, strlen(name) + 1);
    }
    if (!read_object(r, json, kind, &item) || !add_item(r, json, kind, &item)) {
        return false;
    }
    /* Forces refer to their body, which is now there. */
    for (int i = 0; i < pl_objects[kind].field_count; ++i) {
        const pl_field *field = &pl_objects[kind].fields[i];
        if (field->type == PL_FIELD_FORCES && !read_items(r, json, field)) {
            return false;
        }
    }
    return true;
}

/* Reads the next body from its text. False when it is not of the usual form. */
static bool read_plain_body(reader *r)
{
    pl_json_scanner s = {r->bodies->text + r->bodies->at, r->bodies->text + r->bodies->end};
    pl_body body;
    if (!pl_scan_body(&s, &r->shapes, &body) ||
        (body.material < 0 && !use_default_material(r, &body.material)) ||
        pl_scene_add_body(r->scene, &body, NULL, NULL) != PL_OK) {
        return false;
    }
    r->bodies->at = (size_t)(s.at - r->bodies->text);
    return true;
}

/* Reads the next body, of any form. */
static bool read_parsed_body(reader *r)
{
    json_t *item = pl_json_parse_item(r->bodies);
    const bool right = item != NULL && read_item(r, item, PL_OBJECT_BODY, NULL);
    json_decref(item);
    return right;
}

/* Reads the bodies that were taken out of the text. A fault is not described. */
static bool read_bodies_apart(reader *r)
{
    while (pl_json_next_item(r->bodies)) {
        if (!read_plain_body(r) && !read_parsed_body(r)) {
            return false;
        }
    }
    return !r->bodies->failed;
}

static bool read_items(reader *r, const json_t *object, const pl_field *field)
{
    if (r->bodies != NULL && field->items == PL_OBJECT_BODY) {
        return read_bodies_apart(r);
    }
    const pl_presence presence = field->need == PL_NEED_ALWAYS ? PL_REQUIRED : PL_OPTIONAL;
    const json_t *array;
    if (!pl_json_array(object, field->key, presence, &array, &r->diagnostic)) {
        return false;
    }
    pl_path_push_key(&r->diagnostic.path, field->key);
    size_t i;
    json_t *item;
    json_array_foreach(array, i, item)
    {
        pl_path_push_index(&r->diagnostic.path, (int)i);
        if (!pl_leave(&r->diagnostic, read_item(r, item, field->items, NULL))) {
            return false;
        }
    }
    pl_path_pop(&r->diagnostic.path);
    return true;
}

static bool read_named_items(reader *r, const json_t *object, const pl_field *field)
{
    const json_t *items = json_object_get(object, field->key);
    if (items == NULL) {
        return true;
    }
    pl_path_push_key(&r->diagnostic.path, field->key);
    if (!json_is_object(items) || json_object_size(items) > (size_t)field->most) {
        char found[PL_FOUND_SIZE];
        return pl_diagnose(&r->diagnostic, "expected an object of at most %d %s, found %s",
                           field->most, field->key,
                           json_is_object(items) ? "more" : pl_json_found(items, found));
    }
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)items, name, value)
    {
        pl_path_push_key(&r->diagnostic.path, name);
        if (!pl_leave(&r->diagnostic, read_item(r, value, field->items, name))) {
            return false;
        }
    }
    pl_path_pop(&r->diagnostic.path);
    return true;
}

/* ---- Expectations ---- */

/* The default is half of the smallest dimension of the bodies that should rest: a body that has
 * moved farther has collapsed. */
static double default_collapse_distance(const pl_scene *scene)
{
    double half = (double)INFINITY;
    for (int i = 0; i < scene->rest_count; ++i) {
        half = fmin(half, pl_shape_half_width(&scene->bodies[scene->rests[i].body].shape));
    }
    return half;
}

/* The default follows from the lists of expectations, which come first. */
static bool read_metric(reader *r, const json_t *expect, const pl_field *field)
{
    pl_scene *scene = r->scene;
    const char *metric = scene->travel_count > 0      ? "travel_error"
                         : scene->value_count > 0     ? "value_error"
                         : scene->rest_count > 0      ? "rest_position_error"
                         : scene->statistic_count > 0 ? "statistics_error"
                                                      : "";
    scene->collapse_distance = default_collapse_distance(scene);
    if (!pl_json_string(expect, field->key, PL_OPTIONAL, "the name of a metric", &metric,
                        &r->diagnostic)) {
        return false;
    }
    if (strlen(metric) >= sizeof scene->primary_error) {
        char quoted[PL_QUOTED_SIZE];
        return pl_diagnose_field(&r->diagnostic, field->key,
                                 "expected the name of a metric, found %s",
                                 pl_quoted(metric, quoted));
    }
    memcpy(scene->primary_error, metric, strlen(metric) + 1);
    return true;
}

static bool read_expectations(reader *r, const json_t *object, const pl_field *field)
{
    pl_scene *scene = r->scene;
    const json_t *expect = json_object_get(object, field->key);
    if (expect == NULL) {
        return true;
    }
    if (pl_name_index_create(scene->body_count == 0 ? NULL : scene->bodies[0].name,
                             sizeof *scene->bodies, scene->body_count, &r->body_names) != PL_OK) {
        return pl_diagnose_no_memory(&r->diagnostic);
    }
    pl_path_push_key(&r->diagnostic.path, field->key);
    return pl_leave(&r->diagnostic, read_object(r, expect, field->items, scene));
}

/* ---- Objects ---- */

static bool read_version(reader *r, const json_t *json, const pl_field *field)
{
    const json_t *version = json_object_get(json, field->key);
    const double number = json_is_number(version) ? json_number_value(version) : 0;
    if (number == 1 || number == PL_SCENE_VERSION) {
        return true;
    }
    char found[PL_FOUND_SIZE];
    return pl_diagnose_field(&r->diagnostic, field->key, "expected 1 or %d, found %s",
                             PL_SCENE_VERSION, pl_json_found(version, found));
}

static bool read_field(reader *r, const json_t *json, const pl_field *field, void *item)
{
    void *value = (char *)item + field->offset;
    switch (field->type) {
    case PL_FIELD_VERSION:
        return read_version(r, json, field);
    case PL_FIELD_MATERIAL:
        return (field->need != PL_NEED_ALWAYS && json_object_get(json, field->key) == NULL) ||
               read_material_reference(r, json, field->key, value);
    case PL_FIELD_BODY:
        return read_body_reference(r, json, field->key, value);
    case PL_FIELD_ITEMS:
        return read_items(r, json, field);
    case PL_FIELD_NAMED_ITEMS:
        return read_named_items(r, json, field);
    case PL_FIELD_OBJECT:
        return read_expectations(r, json, field);
    case PL_FIELD_METRIC:
        return read_metric(r, json, field);
    case PL_FIELD_SHAPES:
        return pl_read_shapes(&r->shapes, json);
    case PL_FIELD_SHAPE:
        return pl_read_body_shape(&r->shapes, json, value);
    default:
        return pl_read_field(json, field, item, &r->diagnostic);
    }
}

static bool read_object(reader *r, const json_t *json, pl_object_kind kind, void *item)
{
    const pl_object *object = &pl_objects[kind];
    bool right = pl_read_keys(json, kind, &r->diagnostic);
    for (int i = 0; i < object->field_count && right; ++i) {
        right = read_field(r, json, &object->fields[i], item);
    }
    return right;
}

/* ---- Texts ---- */

/* A scene to fill, and how. */
typedef struct request {
    const pl_scene_text *source;
    pl_scene *scene;
    pl_json_items *bodies; /* as in the reader */
} request;

/* The bodies of a scene with parameters are not read apart, since they are texts there. */
static bool substitute(const json_t *json, const request *wanted, pl_diagnostic *diagnostic)
{
    pl_scene_parameters parameters;
    if (wanted->bodies != NULL) {
        return json_object_get(json, "parameters") == NULL;
    }
    return pl_read_parameters(json, &parameters, diagnostic) &&
           pl_substitute_parameters((json_t *)json, &parameters, wanted->source->values,
                                    diagnostic);
}

static bool read_scene(const json_t *json, void *user, pl_diagnostic *diagnostic)
{
    const request *wanted = user;
    reader r = {.scene = wanted->scene, .bodies = wanted->bodies};
    r.shapes = (pl_shape_reader){
        .scene = wanted->scene, .folder = wanted->source->folder, .diagnostic = &r.diagnostic};
    const bool right = substitute(json, wanted, &r.diagnostic) &&
                       read_object(&r, json, PL_OBJECT_SCENE, r.scene) &&
                       pl_scene_check(r.scene, &r.diagnostic);
    pl_shape_reader_free(&r.shapes);
    pl_name_index_free(&r.body_names);
    *diagnostic = r.diagnostic;
    return right;
}

static const pl_json_kind scene_kind = {
    .noun = "scene", .most_bytes = PL_MAX_SCENE_BYTES, .read = read_scene};

/* Reads the text with its bodies one by one. False at any fault, which is not described, and for text
 * of another form; the scene then has some of it. */
static bool read_in_parts(const request *wanted)
{
    pl_json_items bodies;
    size_t rest_length = 0;
    const pl_scene_text *source = wanted->source;
    const size_t mark = pl_byte_order_mark(source->text, source->length);
    const char *text = source->text + mark;
    const size_t length = source->length - mark;
    char *rest = length > PL_MAX_SCENE_BYTES
                     ? NULL
                     : pl_json_take_out(text, length, "bodies", &bodies, &rest_length);
    json_t *json = rest == NULL ? NULL : pl_json_parse(rest, rest_length);
    pl_diagnostic unused = {.status = PL_OK};
    request apart = {.scene = wanted->scene, .source = source, .bodies = &bodies};
    const bool right = json != NULL && read_scene(json, &apart, &unused);
    json_decref(json);
    free(rest);
    return right;
}

/* A text with a fault is read again as a whole, to say where the fault is. */
pl_status pl_scene_read(const pl_scene_text *source, pl_scene *scene, pl_error *error)
{
    request wanted = {.source = source, .scene = scene};
    *scene = pl_scene_default();
    if (read_in_parts(&wanted)) {
        return PL_OK;
    }
    pl_scene_free(scene);
    *scene = pl_scene_default();
    const pl_status status =
        pl_json_read_text(&scene_kind, source->text, source->length, source->label, &wanted, error);
    if (status != PL_OK) {
        pl_scene_free(scene);
    }
    return status;
}
