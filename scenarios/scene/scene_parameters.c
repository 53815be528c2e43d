/* The parameters of a scene file, and the substitution, which follows the table of fields. */
#include "scene_parameters.h"

#include "base/expression.h"
#include "base/number.h"
#include "scene_read_fields.h"

#include <string.h>

/* ---- Reading ---- */

/* Whether a parameter may have that name, at the current path. */
static bool check_parameter_name(const char *name, pl_diagnostic *diagnostic)
{
    char quoted[PL_QUOTED_SIZE];
    const bool is_taken = strcmp(name, "dt") == 0 || strcmp(name, "duration") == 0;
    diagnostic->at_key = true;
    if (is_taken || strlen(name) >= PL_NAME_SIZE || !pl_expression_may_name(name)) {
        return pl_diagnose(diagnostic,
                           "expected a name of at most 63 letters, digits and '_', none of dt, "
                           "duration, pi, sqrt, sin, cos and tan, found %s",
                           pl_quoted(name, quoted));
    }
    diagnostic->at_key = false;
    return true;
}

static bool check_parameter_range(const pl_scene_parameter *p, pl_diagnostic *diagnostic)
{
    char low[PL_NUMBER_SIZE], high[PL_NUMBER_SIZE], found[PL_NUMBER_SIZE];
    if (!(p->low < p->high)) {
        return pl_diagnose_field(diagnostic, "high", "expected a number above low, %s, found %s",
                                 pl_number_text(p->low, low), pl_number_text(p->high, found));
    }
    return (p->value >= p->low && p->value <= p->high) ||
           pl_diagnose_field(diagnostic, "value", "expected a number from %s to %s, found %s",
                             pl_number_text(p->low, low), pl_number_text(p->high, high),
                             pl_number_text(p->value, found));
}

static bool read_parameter(const char *name, const json_t *json, pl_scene_parameter *parameter,
                           pl_diagnostic *diagnostic)
{
    const pl_object *object = &pl_objects[PL_OBJECT_PARAMETER];
    memcpy(parameter, object->defaults, sizeof *parameter);
    if (!check_parameter_name(name, diagnostic)) {
        return false;
    }
    memcpy(parameter->name, name, strlen(name) + 1);
    if (json_is_number(json)) {
        parameter->value = json_number_value(json);
        return true;
    }
    if (!json_is_object(json)) {
        char found[PL_FOUND_SIZE];
        return pl_diagnose(diagnostic, "expected a number or an object, found %s",
                           pl_json_found(json, found));
    }
    bool right = pl_read_keys(json, PL_OBJECT_PARAMETER, diagnostic);
    for (int i = 0; i < object->field_count && right; ++i) {
        right = pl_read_field(json, &object->fields[i], parameter, diagnostic);
    }
    return right && check_parameter_range(parameter, diagnostic);
}

bool pl_read_parameters(const json_t *scene, pl_scene_parameters *parameters,
                        pl_diagnostic *diagnostic)
{
    const json_t *json = json_object_get(scene, "parameters");
    parameters->count = 0;
    if (json == NULL) {
        return true;
    }
    pl_path_push_key(&diagnostic->path, "parameters");
    if (!json_is_object(json) || json_object_size(json) > PL_MAX_SCENE_PARAMETERS) {
        char found[PL_FOUND_SIZE];
        return pl_diagnose(diagnostic, "expected an object of at most %d parameters, found %s",
                           PL_MAX_SCENE_PARAMETERS,
                           json_is_object(json) ? "more" : pl_json_found(json, found));
    }
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)json, name, value)
    {
        pl_path_push_key(&diagnostic->path, name);
        if (!pl_leave(diagnostic, read_parameter(name, value, &parameters->items[parameters->count],
                                                 diagnostic))) {
            return false;
        }
        ++parameters->count;
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

/* ---- Substitution ---- */

/* The numbers that expressions may name. */
typedef struct names {
    pl_named_number items[PL_MAX_SCENE_PARAMETERS];
    int count;
    pl_diagnostic *diagnostic;
} names;

static bool substitute_object(names *n, json_t *json, pl_object_kind kind);

/* The number of an expression; any other value, and arrays' items, too. *made is a new reference. */
static bool substitute_number(names *n, json_t *json, json_t **made)
{
    double value = 0;
    *made = NULL;
    if (json_is_string(json)) {
        if (!pl_expression_value(json_string_value(json), n->items, n->count, &value,
                                 n->diagnostic)) {
            return false;
        }
        *made = json_real(value);
        return *made != NULL || pl_diagnose_no_memory(n->diagnostic);
    }
    size_t i;
    json_t *item, *number;
    json_array_foreach(json, i, item)
    {
        pl_path_push_index(&n->diagnostic->path, (int)i);
        if (!pl_leave(n->diagnostic, substitute_number(n, item, &number))) {
            return false;
        }
        if (number != NULL && json_array_set_new(json, i, number) != 0) {
            return pl_diagnose_no_memory(n->diagnostic);
        }
    }
    return true;
}

/* A shape, unless it is the name of one. A type that is none is for the reader to report. */
static bool substitute_shape(names *n, json_t *json)
{
    const char *type = pl_json_get_text(json, "type");
    for (int kind = 0; kind < PL_SHAPE_KIND_COUNT; ++kind) {
        if (strcmp(type, pl_shape_names[kind]) == 0) {
            return substitute_object(n, json, PL_OBJECT_PLANE + (pl_object_kind)kind);
        }
    }
    return true;
}

/* Substitutes in the items of an array, or of an object. They are shapes or objects of `kind`. */
static bool substitute_items(names *n, json_t *items, bool are_shapes, pl_object_kind kind)
{
    size_t i;
    const char *name;
    json_t *item;
    bool right = true;
    json_array_foreach(items, i, item)
    {
        if (right) {
            pl_path_push_index(&n->diagnostic->path, (int)i);
            right = pl_leave(n->diagnostic, substitute_object(n, item, kind));
        }
    }
    json_object_foreach(items, name, item)
    {
        if (right) {
            pl_path_push_key(&n->diagnostic->path, name);
            right = pl_leave(n->diagnostic, are_shapes ? substitute_shape(n, item)
                                                       : substitute_object(n, item, kind));
        }
    }
    return right;
}

/* The value of one field of `object`. */
static bool substitute_field(names *n, json_t *object, const pl_field *field, json_t *value)
{
    json_t *number = NULL;
    switch (field->type) {
    case PL_FIELD_NUMBER:
    case PL_FIELD_VECTOR:
    case PL_FIELD_UNIT:
    case PL_FIELD_QUATERNION:
    case PL_FIELD_INERTIA:
    case PL_FIELD_POINTS:
    case PL_FIELD_DENSITY:
        return substitute_number(n, value, &number) &&
               (number == NULL || json_object_set_new(object, field->key, number) == 0 ||
                pl_diagnose_no_memory(n->diagnostic));
    case PL_FIELD_OBJECT:
        return substitute_object(n, value, field->items);
    case PL_FIELD_ITEMS:
    case PL_FIELD_NAMED_ITEMS:
    case PL_FIELD_FORCES:
    case PL_FIELD_SHAPES:
        return substitute_items(n, value, field->type == PL_FIELD_SHAPES, field->items);
    case PL_FIELD_SHAPE:
        return substitute_shape(n, value);
    default:
        return true;
    }
}

/* All fields of an object. A value of another type is for the reader to report. */
static bool substitute_object(names *n, json_t *json, pl_object_kind kind)
{
    const pl_object *object = &pl_objects[kind];
    for (int i = 0; i < object->field_count; ++i) {
        const pl_field *field = &object->fields[i];
        json_t *value = json_object_get(json, field->key);
        if (value == NULL) {
            continue;
        }
        pl_path_push_key(&n->diagnostic->path, field->key);
        if (!pl_leave(n->diagnostic, substitute_field(n, json, field, value))) {
            return false;
        }
    }
    return true;
}

bool pl_substitute_parameters(json_t *scene, const pl_scene_parameters *parameters,
                              const double *values, pl_diagnostic *diagnostic)
{
    names n = {.count = parameters->count, .diagnostic = diagnostic};
    for (int i = 0; i < n.count; ++i) {
        const pl_scene_parameter *parameter = &parameters->items[i];
        n.items[i] = (pl_named_number){.name = parameter->name,
                                       .value = values == NULL ? parameter->value : values[i]};
    }
    if (!substitute_object(&n, scene, PL_OBJECT_SCENE)) {
        return false;
    }
    for (int i = 0; i < n.count; ++i) {
        if (!n.items[i].used) {
            pl_path_push_key(&diagnostic->path, "parameters");
            diagnostic->at_key = true;
            return pl_diagnose_field(diagnostic, n.items[i].name,
                                     "expected a field that uses the parameter, found none");
        }
    }
    return true;
}
