#include "scene_scan.h"

#include "base/json_field.h"
#include "scene_fields.h"
#include "scene_internal.h"

#include <math.h>
#include <string.h>

/* A text to read, and what its names refer to. */
typedef struct scan {
    pl_json_scanner *text;
    const pl_shape_reader *shapes;
} scan;

static bool scan_object(const scan *s, pl_object_kind kind, void *item);

/* A name of an item, by the rules of pl_check_name. */
static bool scan_name(const scan *s, char name[PL_NAME_SIZE])
{
    const char *text;
    size_t length;
    if (!pl_json_scan_string(s->text, &text, &length) || length == 0 || length >= PL_NAME_SIZE) {
        return false;
    }
    memcpy(name, text, length);
    name[length] = '\0';
    return true;
}

static bool scan_material(const scan *s, void *index)
{
    char name[PL_NAME_SIZE];
    const int found = scan_name(s, name) ? pl_scene_find_material(s->shapes->scene, name) : -1;
    memcpy(index, &found, sizeof found);
    return found >= 0;
}

/* The name of a shape, or an object that has no polyhedron and begins with its type. */
static bool scan_shape(const scan *s, pl_shape *shape)
{
    char name[PL_NAME_SIZE];
    pl_json_scanner ahead = *s->text;
    const scan type = {&ahead, s->shapes};
    if (!pl_json_scan_mark(&ahead, '{')) {
        const int named = scan_name(s, name) ? pl_name_index_find(&s->shapes->index, name) : -1;
        if (named >= 0) {
            *shape = s->shapes->shapes[named].shape;
        }
        return named >= 0;
    }
    if (!scan_name(&type, name) || strcmp(name, "type") != 0 || !pl_json_scan_mark(&ahead, ':') ||
        !scan_name(&type, name)) {
        return false;
    }
    for (int kind = PL_SHAPE_SPHERE; kind < PL_SHAPE_HULL; ++kind) {
        if (strcmp(name, pl_shape_names[kind]) == 0) {
            *shape = (pl_shape){.kind = (pl_shape_kind)kind};
            return scan_object(s, PL_OBJECT_PLANE + (pl_object_kind)kind, shape);
        }
    }
    return false;
}

static bool scan_field(const scan *s, const pl_field *field, void *item)
{
    char type[PL_NAME_SIZE];
    void *value = (char *)item + field->offset;
    switch (field->type) {
    case PL_FIELD_NUMBER:
        return pl_json_scan_number(s->text, value);
    case PL_FIELD_VECTOR:
    case PL_FIELD_INERTIA:
        return pl_json_scan_numbers(s->text, value, 3);
    case PL_FIELD_QUATERNION:
        if (!pl_json_scan_numbers(s->text, value, 4)) {
            return false;
        }
        pl_normalize_written(value, 4);
        return true;
    case PL_FIELD_BOOL:
        return pl_json_scan_bool(s->text, value);
    case PL_FIELD_NAME:
        return scan_name(s, value);
    case PL_FIELD_MATERIAL:
        return scan_material(s, value);
    case PL_FIELD_SHAPE:
        return scan_shape(s, value);
    case PL_FIELD_TYPE:
        return scan_name(s, type);
    default:
        return false;
    }
}

/* The field of a key, looked for from the one after the last; -1 when there is none. */
static int find_field(const pl_object *object, int next, const char *key, size_t length)
{
    for (int i = 0; i < object->field_count; ++i, ++next) {
        const char *known = object->fields[next % object->field_count].key;
        if (strncmp(known, key, length) == 0 && known[length] == '\0') {
            return next % object->field_count;
        }
    }
    return -1;
}

/* Reads an object that has all fields that it must have, and none twice. */
static bool scan_object(const scan *s, pl_object_kind kind, void *item)
{
    const pl_object *object = &pl_objects[kind];
    unsigned seen = 0; /* bit i: field i */
    bool right = pl_json_scan_mark(s->text, '{');
    int i = -1;
    do {
        const char *key;
        size_t length;
        right =
            right && pl_json_scan_string(s->text, &key, &length) && pl_json_scan_mark(s->text, ':');
        i = right ? find_field(object, i + 1, key, length) : -1;
        right = i >= 0 && (seen >> i & 1) == 0 && scan_field(s, &object->fields[i], item);
        seen |= right ? 1U << i : 0;
    } while (right && pl_json_scan_mark(s->text, ','));
    for (i = 0; i < object->field_count && right; ++i) {
        right = object->fields[i].need != PL_NEED_ALWAYS || (seen >> i & 1) != 0;
    }
    return right && pl_json_scan_mark(s->text, '}');
}

bool pl_scan_body(pl_json_scanner *scanner, const pl_shape_reader *shapes, pl_body *body)
{
    const pl_object *object = &pl_objects[PL_OBJECT_BODY];
    const scan s = {scanner, shapes};
    memcpy(body, object->defaults, object->size);
    /* No text has a NaN. */
    body->mass = body->inertia[0] = (double)NAN;
    body->material = -1;
    if (!scan_object(&s, PL_OBJECT_BODY, body) || isnan(body->mass) || body->is_static ||
        body->shape.kind == PL_SHAPE_PLANE) {
        return false;
    }
    if (isnan(body->inertia[0])) {
        body->inertia[0] = 0;
        return true;
    }
    return body->inertia[0] != 0 || body->inertia[1] != 0 || body->inertia[2] != 0;
}
