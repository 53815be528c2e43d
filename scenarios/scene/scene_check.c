/* The rules of a scene: each field by its type and range in the table of fields, then what must
 * hold between fields. */
#include "scene_check.h"

#include "base/diagnostic.h"
#include "base/name_index.h"
#include "base/number.h"
#include "scene_fields.h"
#include "scene_internal.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The scene that is checked, and data for the checks of single items. */
typedef struct checker {
    const pl_scene *scene;
    pl_pointer_map polyhedra;
    bool *pairs; /* (PL_MAX_MATERIALS, PL_MAX_MATERIALS): the pairs of materials seen so far */
    pl_diagnostic *diagnostic;
} checker;

static bool check_object(const checker *c, pl_object_kind kind, const void *object);

/* ---- Fields ---- */

/* A name in an array of PL_NAME_SIZE bytes: it could lack its zero, or not be UTF-8. */
static bool check_stored_name(const char *name, pl_diagnostic *diagnostic)
{
    const char *end = memchr(name, '\0', PL_NAME_SIZE);
    if (!pl_check_name(name, end == NULL ? PL_NAME_SIZE : (size_t)(end - name), diagnostic)) {
        return false;
    }
    bool is_ascii = true;
    for (const char *c = name; *c != '\0'; ++c) {
        is_ascii = is_ascii && (unsigned char)*c < 0x80;
    }
    json_t *text = is_ascii ? NULL : json_string(name); /* NULL where it is not UTF-8 */
    json_decref(text);
    return is_ascii || text != NULL ||
           pl_diagnose(diagnostic, "expected a name in UTF-8, found other bytes");
}

static bool check_index(pl_diagnostic *diagnostic, const char *key, int index, int count,
                        const char *kind)
{
    return (index >= 0 && index < count) ||
           pl_diagnose_field(diagnostic, key, "expected the index of a %s from 0 to %d, found %d",
                             kind, count - 1, index);
}

/* A body of an expectation. */
static bool check_placed_body(const checker *c, const char *key, int body)
{
    if (!check_index(c->diagnostic, key, body, c->scene->body_count, "body")) {
        return false;
    }
    return c->scene->bodies[body].shape.kind != PL_SHAPE_PLANE ||
           pl_diagnose_field(c->diagnostic, key,
                             "expected a body with a position, found the plane %s",
                             c->scene->bodies[body].name);
}

static bool check_components(const pl_field *field, const double vector[3],
                             pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, field->key);
    for (int k = 0; k < 3; ++k) {
        pl_path_push_index(&diagnostic->path, k);
        if (!pl_check_number(diagnostic, NULL, vector[k], pl_range_holds(field->range, vector[k]),
                             pl_range_rules[field->range].expected)) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

/* Principal inertias of any solid keep I_a + I_b >= I_c: Goldstein, Classical Mechanics, ch. 5. */
static bool check_inertia(const double inertia[3], pl_diagnostic *diagnostic)
{
    bool right = true;
    double sum = inertia[0] + inertia[1] + inertia[2];
    for (int k = 0; k < 3; ++k) {
        right = right && isfinite(inertia[k]) && inertia[k] > 0 &&
                inertia[k] <= (sum - inertia[k]) * (1 + PL_UNIT_TOLERANCE);
    }
    char x[PL_NUMBER_SIZE], y[PL_NUMBER_SIZE], z[PL_NUMBER_SIZE];
    return right ||
           pl_diagnose_field(diagnostic, "inertia",
                             "expected three finite numbers above 0, none larger than the sum "
                             "of the other two, found [%s, %s, %s]",
                             pl_number_text(inertia[0], x), pl_number_text(inertia[1], y),
                             pl_number_text(inertia[2], z));
}

static bool check_primary_error(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    const char *primary = scene->primary_error;
    if (primary[0] == '\0') {
        return true;
    }
    if (memchr(primary, '\0', sizeof scene->primary_error) == NULL) {
        return pl_diagnose_field(diagnostic, "primary",
                                 "expected a metric, found text without an end");
    }
    int count;
    const char *const *names = pl_primary_errors(&count);
    const char *nearest = pl_nearest_name(primary, names, count);
    if (nearest == NULL || strcmp(nearest, primary) != 0) {
        char quoted[PL_QUOTED_SIZE];
        return pl_diagnose_field(diagnostic, "primary",
                                 "expected a metric such as \"%s\", found %s",
                                 nearest != NULL ? nearest : names[0], pl_quoted(primary, quoted));
    }
    if (strncmp(primary, "rest_", 5) == 0 && scene->rest_count == 0) {
        return pl_diagnose_field(diagnostic, "primary",
                                 "expected `rest` next to \"%s\", found none", primary);
    }
    if (strcmp(primary, "value_error") == 0 && scene->value_count == 0) {
        return pl_diagnose_field(diagnostic, "primary",
                                 "expected `values` next to \"%s\", found none", primary);
    }
    if (strcmp(primary, "statistics_error") == 0 && scene->statistic_count == 0) {
        return pl_diagnose_field(diagnostic, "primary",
                                 "expected `statistics` next to \"%s\", found none", primary);
    }
    bool of_travel = strcmp(primary, "travel_error") == 0 ||
                     (strcmp(primary, "discrete_error") == 0 && scene->value_count == 0);
    if (of_travel && scene->travel_count == 0) {
        return pl_diagnose_field(diagnostic, "primary",
                                 "expected `travel` next to \"%s\", found none", primary);
    }
    return true;
}

bool pl_check_shape(const pl_shape *shape, pl_diagnostic *diagnostic)
{
    const checker c = {.diagnostic = diagnostic};
    return (int)shape->kind >= 0 && (int)shape->kind < PL_SHAPE_KIND_COUNT
               ? check_object(&c, PL_OBJECT_PLANE + (pl_object_kind)shape->kind, shape)
               : pl_diagnose_field(diagnostic, "type", "expected a known shape, found number %d",
                                   (int)shape->kind);
}

/* The polyhedron of a hull or a mesh is one of the scene's, and of that kind. */
static bool check_polyhedron(const checker *c, const pl_shape *shape)
{
    if (shape->kind != PL_SHAPE_HULL && shape->kind != PL_SHAPE_MESH) {
        return true;
    }
    if (pl_pointer_map_find(&c->polyhedra, shape->polyhedron) < 0) {
        return pl_diagnose(c->diagnostic, "expected a polyhedron of the scene, found %s",
                           shape->polyhedron == NULL ? "none" : "another");
    }
    if (shape->polyhedron->convex != (shape->kind == PL_SHAPE_HULL)) {
        return pl_diagnose_field(c->diagnostic, "type",
                                 "expected a %s for this polyhedron, found a %s",
                                 shape->polyhedron->convex ? "hull" : "mesh",
                                 shape->kind == PL_SHAPE_HULL ? "hull" : "mesh");
    }
    return true;
}

/* A number that is absent is a NaN, where that is its default. */
static bool is_absent(const pl_object *table, const pl_field *field, double value)
{
    return isnan(value) && isnan(*(const double *)pl_field_of(field, table->defaults));
}

static bool check_name(const pl_field *field, const char *name, pl_diagnostic *diagnostic)
{
    if (field->need != PL_NEED_ALWAYS && name[0] == '\0') {
        return true;
    }
    pl_path_push_key(&diagnostic->path, field->key);
    return pl_leave(diagnostic, check_stored_name(name, diagnostic));
}

/* A field that is checked by itself. */
static bool check_value(const checker *c, const pl_object *table, const pl_field *field,
                        const void *object)
{
    pl_diagnostic *diagnostic = c->diagnostic;
    const void *value = pl_field_of(field, object);
    const double *numbers = value;
    int index = 0;
    switch (field->type) {
    case PL_FIELD_NUMBER:
        return is_absent(table, field, numbers[0]) ||
               pl_check_number(diagnostic, field->key, numbers[0],
                               pl_range_holds(field->range, numbers[0]),
                               pl_range_rules[field->range].expected);
    case PL_FIELD_VECTOR:
        return check_components(field, numbers, diagnostic);
    case PL_FIELD_UNIT:
        return pl_check_unit(diagnostic, field->key, numbers, 3, "a unit vector");
    case PL_FIELD_QUATERNION:
        return pl_check_unit(diagnostic, field->key, numbers, 4, "a unit quaternion [w, x, y, z]");
    case PL_FIELD_INERTIA:
        return check_inertia(numbers, diagnostic);
    case PL_FIELD_NAME:
        return check_name(field, value, diagnostic);
    case PL_FIELD_WORD:
        index = pl_field_index(field, object);
        return (index >= 0 && index < field->word_count) ||
               pl_diagnose_field(diagnostic, field->key, "expected a known %s, found number %d",
                                 field->key, index);
    case PL_FIELD_METRIC:
        return check_primary_error(c->scene, diagnostic);
    case PL_FIELD_MATERIAL:
        return check_index(diagnostic, field->key, pl_field_index(field, object),
                           c->scene->material_count, "material");
    case PL_FIELD_BODY:
        return check_placed_body(c, field->key, pl_field_index(field, object));
    case PL_FIELD_SHAPE:
        pl_path_push_key(&diagnostic->path, field->key);
        return pl_leave(diagnostic,
                        pl_check_shape(value, diagnostic) && check_polyhedron(c, value));
    default:
        return true;
    }
}

/* ---- Rules between fields ---- */

static bool check_time(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    char dt[PL_NUMBER_SIZE], found[PL_NUMBER_SIZE];
    if (scene->duration < scene->dt) {
        return pl_diagnose_field(
            diagnostic, "duration", "expected at least dt, which is %s, found %s",
            pl_number_text(scene->dt, dt), pl_number_text(scene->duration, found));
    }
    double steps = round(scene->duration / scene->dt);
    return steps <= PL_MAX_STEPS ||
           pl_diagnose_field(diagnostic, "duration",
                             "expected at most %d steps of dt, which is %s, found %.17g steps",
                             PL_MAX_STEPS, pl_number_text(scene->dt, dt), steps);
}

static bool check_pair(const checker *c, const pl_material_pair *pair)
{
    const int low = pair->material_a < pair->material_b ? pair->material_a : pair->material_b;
    const int high = pair->material_a + pair->material_b - low;
    bool *seen = &c->pairs[high * PL_MAX_MATERIALS + low];
    if (*seen) {
        return pl_diagnose(c->diagnostic,
                           "expected each pair of materials once, found %s and %s again",
                           c->scene->materials[low].name, c->scene->materials[high].name);
    }
    *seen = true;
    return true;
}

static bool check_zero(pl_diagnostic *diagnostic, const char *key, const double vector[3])
{
    bool zero = vector[0] == 0 && vector[1] == 0 && vector[2] == 0;
    return zero ||
           pl_diagnose_field(diagnostic, key,
                             "expected zero, since a static body never moves, found another");
}

static bool check_body(const pl_body *body, pl_diagnostic *diagnostic)
{
    if (body->shape.kind == PL_SHAPE_PLANE && !body->is_static) {
        return pl_diagnose_field(diagnostic, "static",
                                 "expected true, since a plane never moves, found false");
    }
    return !body->is_static || (check_zero(diagnostic, "velocity", body->velocity) &&
                                check_zero(diagnostic, "angular_velocity", body->angular_velocity));
}

static bool check_force(const pl_force *force, pl_diagnostic *diagnostic)
{
    char from[PL_NUMBER_SIZE], found[PL_NUMBER_SIZE];
    return force->until > force->from ||
           pl_diagnose_field(
               diagnostic, "until", "expected a time after `from`, which is %s, found %s",
               pl_number_text(force->from, from), pl_number_text(force->until, found));
}

static bool check_times(const pl_scene *scene, const pl_expect_value *value,
                        pl_diagnostic *diagnostic)
{
    /* The last frame is at a whole number of steps. */
    double end = (double)pl_scene_steps(scene) * scene->dt * (1 + 1e-12);
    return pl_check_number(diagnostic, "from", value->from,
                           value->from >= 0 && value->from <= value->until,
                           "a time from 0 to `until`") &&
           pl_check_number(diagnostic, "until", value->until,
                           value->until > 0 && value->until <= end, "a time within the run");
}

static bool check_expected(const pl_scene *scene, const pl_expect_value *value,
                           pl_diagnostic *diagnostic)
{
    return check_times(scene, value, diagnostic) &&
           pl_check_number(diagnostic, "number", value->number,
                           value->number == floor(value->number) &&
                               (value->number == 0 || value->quantity == PL_QUANTITY_APEX),
                           "a whole number, 0 except of an apex") &&
           pl_check_number(diagnostic, "answer", value->answer,
                           value->answer == floor(value->answer) && value->answer <= PL_MAX_ANSWERS,
                           "a whole number of 0 to 8");
}

static bool check_interval(const pl_expect_statistic *statistic, pl_diagnostic *diagnostic)
{
    char low[PL_NUMBER_SIZE], found[PL_NUMBER_SIZE];
    return statistic->high >= statistic->low ||
           pl_diagnose_field(
               diagnostic, "high", "expected a number of at least `low`, which is %s, found %s",
               pl_number_text(statistic->low, low), pl_number_text(statistic->high, found));
}

/* The rules of an object, in addition to those of its fields. */
static bool check_rules(const checker *c, pl_object_kind kind, const void *object)
{
    switch (kind) {
    case PL_OBJECT_SCENE:
        return check_time(object, c->diagnostic);
    case PL_OBJECT_PAIR:
        return check_pair(c, object);
    case PL_OBJECT_BODY:
        return check_body(object, c->diagnostic);
    case PL_OBJECT_FORCE:
        return check_force(object, c->diagnostic);
    case PL_OBJECT_VALUE:
        return check_expected(c->scene, object, c->diagnostic);
    case PL_OBJECT_STATISTIC:
        return check_interval(object, c->diagnostic);
    default:
        return true;
    }
}

/* ---- Lists ---- */

/* Reports the first name that an earlier one of `count` items equals. The path stands at the
 * array. */
static bool check_unique(pl_diagnostic *diagnostic, const char *first_name, size_t stride,
                         int count)
{
    pl_name_index names;
    if (pl_name_index_create(first_name, stride, count, &names) != PL_OK) {
        return pl_diagnose_no_memory(diagnostic);
    }
    int duplicate = pl_name_index_duplicate(&names);
    bool unique = duplicate < 0;
    if (!unique) {
        const char *name = first_name + (size_t)duplicate * stride;
        char quoted[PL_QUOTED_SIZE];
        pl_path_push_index(&diagnostic->path, duplicate);
        pl_diagnose_field(diagnostic, "name",
                          "expected a name of its own, found %s, which item %d has",
                          pl_quoted(name, quoted), pl_name_index_find(&names, name));
    }
    pl_name_index_free(&names);
    return unique;
}

/* The names that polyhedra have are keys of one object in a scene file. */
static bool check_polyhedra(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    char(*names)[PL_NAME_SIZE] = calloc((size_t)scene->polyhedron_count + 1, sizeof *names);
    if (names == NULL) {
        return pl_diagnose_no_memory(diagnostic);
    }
    int count = 0;
    bool right = true;
    pl_path_push_key(&diagnostic->path, "shapes");
    for (int i = 0; i < scene->polyhedron_count && right; ++i) {
        const char *name = scene->polyhedra[i]->name;
        if (name[0] != '\0') {
            right = check_stored_name(name, diagnostic);
            memcpy(names[count++], name, PL_NAME_SIZE);
        }
    }
    right = right && check_unique(diagnostic, names[0], sizeof *names, count);
    free(names);
    return pl_leave(diagnostic, right);
}

static bool check_items(const checker *c, const pl_field *field, const void *object)
{
    pl_diagnostic *diagnostic = c->diagnostic;
    const size_t size = pl_objects[field->items].size;
    const bool named = field->type == PL_FIELD_NAMED_ITEMS;
    int count;
    const char *items = pl_field_items(field, object, &count);
    pl_path_push_key(&diagnostic->path, field->key);
    if (count < field->least || (field->most > 0 && count > field->most)) {
        return pl_diagnose(diagnostic, "expected %d to %d %s, found %d", field->least, field->most,
                           field->key, count);
    }
    for (int i = 0; i < count; ++i) {
        const char *item = items + (size_t)i * size;
        pl_path_push_index(&diagnostic->path, i);
        if (named) {
            if (!check_stored_name(item, diagnostic)) { /* the struct begins with its name */
                return false;
            }
            pl_path_pop(&diagnostic->path);
            pl_path_push_key(&diagnostic->path, item); /* as in the file */
        }
        if (!pl_leave(diagnostic, check_object(c, field->items, item))) {
            return false;
        }
    }
    return pl_leave(diagnostic, (!named && field->items != PL_OBJECT_BODY) ||
                                    check_unique(diagnostic, items, size, count));
}

/* Where force number `index` stands in a scene file: in its body's own list. */
static int place_in_body(const pl_scene *scene, int index)
{
    int place = 0;
    for (int i = 0; i < index; ++i) {
        place += scene->forces[i].body == scene->forces[index].body ? 1 : 0;
    }
    return place;
}

static bool check_forces(const checker *c)
{
    const pl_scene *scene = c->scene;
    pl_diagnostic *diagnostic = c->diagnostic;
    for (int i = 0; i < scene->force_count; ++i) {
        const pl_force *force = &scene->forces[i];
        const pl_path outside = diagnostic->path;
        if (force->body < 0 || force->body >= scene->body_count) {
            pl_path_push_key(&diagnostic->path, "forces");
            pl_path_push_index(&diagnostic->path, i);
            return check_index(diagnostic, "body", force->body, scene->body_count, "body");
        }
        pl_path_push_key(&diagnostic->path, "bodies");
        pl_path_push_index(&diagnostic->path, force->body);
        pl_path_push_key(&diagnostic->path, "forces");
        if (scene->bodies[force->body].is_static) {
            return pl_diagnose(diagnostic, "expected no forces on a static body, found one");
        }
        const pl_path list = diagnostic->path;
        pl_path_push_index(&diagnostic->path, 0);
        if (!check_object(c, PL_OBJECT_FORCE, force)) {
            /* Only now: counting for every force would be quadratic. */
            diagnostic->path.steps[list.depth].index = place_in_body(scene, i);
            return false;
        }
        diagnostic->path = outside;
    }
    return true;
}

/* A field that holds other objects. */
static bool check_nested(const checker *c, const pl_field *field, const void *object)
{
    switch (field->type) {
    case PL_FIELD_ITEMS:
    case PL_FIELD_NAMED_ITEMS:
        return check_items(c, field, object) && (field->items != PL_OBJECT_BODY || check_forces(c));
    case PL_FIELD_SHAPES:
        return check_polyhedra(object, c->diagnostic);
    case PL_FIELD_OBJECT:
        pl_path_push_key(&c->diagnostic->path, field->key);
        return pl_leave(c->diagnostic, check_object(c, field->items, object));
    default:
        return true;
    }
}

/* Checks the required fields, the rules between them, the optional fields, and then the objects
 * within. So mass and inertia, which may come from the shape, are checked after it. */
static bool check_object(const checker *c, pl_object_kind kind, const void *object)
{
    const pl_object *table = &pl_objects[kind];
    const pl_field *fields = table->fields;
    bool right = true;
    for (int i = 0; i < table->field_count && right; ++i) {
        right = fields[i].applies != NULL || check_value(c, table, &fields[i], object);
    }
    right = right && check_rules(c, kind, object);
    for (int i = 0; i < table->field_count && right; ++i) {
        right = fields[i].applies == NULL || !fields[i].applies(object) ||
                check_value(c, table, &fields[i], object);
    }
    for (int i = 0; i < table->field_count && right; ++i) {
        right = check_nested(c, &fields[i], object);
    }
    return right;
}

bool pl_scene_check(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    checker c = {.scene = scene, .diagnostic = diagnostic};
    c.pairs = calloc((size_t)PL_MAX_MATERIALS * PL_MAX_MATERIALS, sizeof *c.pairs);
    const bool right = c.pairs != NULL && pl_pointer_map_create(scene, &c.polyhedra) == PL_OK
                           ? check_object(&c, PL_OBJECT_SCENE, scene)
                           : pl_diagnose_no_memory(diagnostic);
    pl_pointer_map_free(&c.polyhedra);
    free(c.pairs);
    return right;
}

pl_status pl_scene_validate(const pl_scene *scene, pl_error *error)
{
    pl_diagnostic diagnostic = {.status = PL_OK};
    if (pl_scene_check(scene, &diagnostic)) {
        return PL_OK;
    }
    char path[256];
    pl_path_text(&diagnostic.path, "scene", path, sizeof path);
    return pl_fail(error, diagnostic.status, "%s: %s", path, diagnostic.text);
}
