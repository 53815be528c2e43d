/* Object by object. Here stands what only the text can show: keys, types, names that refer to
 * others, defaults. What must hold of the numbers is in scene_check.c. */
#include "scene_read.h"

#include "base/json_field.h"
#include "base/name_index.h"
#include "scene_check.h"
#include "scene_keys.h"
#include "scene_read_shape.h"
#include "shape_width.h"

#include <math.h>
#include <string.h>

typedef struct reader {
    pl_scene *scene;
    pl_shape_reader shapes;
    pl_name_index body_names; /* once all bodies are read */
    pl_diagnostic diagnostic;
} reader;

/* Reads one item of an array; the path stands at it. */
typedef bool (*item_reader)(reader *r, const json_t *json);

static bool read_items(reader *r, const json_t *object, const char *key, pl_presence presence,
                       item_reader read_item)
{
    const json_t *array;
    if (!pl_json_array(object, key, presence, &array, &r->diagnostic)) {
        return false;
    }
    pl_path_push_key(&r->diagnostic.path, key);
    size_t i;
    json_t *item;
    json_array_foreach(array, i, item)
    {
        pl_path_push_index(&r->diagnostic.path, (int)i);
        if (!read_item(r, item)) {
            return false;
        }
        pl_path_pop(&r->diagnostic.path);
    }
    pl_path_pop(&r->diagnostic.path);
    return true;
}

static bool added(reader *r, pl_status status)
{
    return status == PL_OK || pl_complain_no_memory(&r->diagnostic);
}

static int find_material(const pl_scene *scene, const char *name)
{
    for (int i = 0; i < scene->material_count; i++) {
        if (strcmp(scene->materials[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

static bool read_material_reference(reader *r, const json_t *object, const char *key, int *index)
{
    const pl_scene *scene = r->scene;
    const char *name = NULL;
    if (!pl_json_string(object, key, PL_REQUIRED, "the name of a material", &name,
                        &r->diagnostic)) {
        return false;
    }
    *index = find_material(scene, name);
    if (*index >= 0) {
        return true;
    }
    const char *names[PL_MAX_MATERIALS];
    for (int i = 0; i < scene->material_count; i++) {
        names[i] = scene->materials[i].name;
    }
    const char *nearest = pl_nearest_name(name, names, scene->material_count);
    return pl_complain_of_reference(&r->diagnostic, key, "material", name, nearest);
}

static bool read_material(reader *r, const char *name, const json_t *json)
{
    pl_material material = {.friction = 0};
    r->diagnostic.at_key = true;
    if (!pl_check_name(name, strlen(name), &r->diagnostic)) {
        return false;
    }
    r->diagnostic.at_key = false;
    memcpy(material.name, name, strlen(name) + 1);
    return pl_json_object(json, &pl_scene_keys[PL_OBJECT_MATERIAL], &r->diagnostic) &&
           pl_json_number(json, "friction", PL_REQUIRED, &material.friction, &r->diagnostic) &&
           pl_json_number(json, "restitution", PL_REQUIRED, &material.restitution,
                          &r->diagnostic) &&
           added(r, pl_scene_add_material(r->scene, &material, NULL, NULL));
}

static bool read_materials(reader *r, const json_t *object)
{
    const json_t *materials = json_object_get(object, "materials");
    if (materials == NULL) {
        return true;
    }
    pl_path_push_key(&r->diagnostic.path, "materials");
    if (!json_is_object(materials) || json_object_size(materials) > PL_MAX_MATERIALS) {
        char found[PL_FOUND_SIZE];
        return pl_complain(&r->diagnostic, "expected an object of at most %d materials, found %s",
                           PL_MAX_MATERIALS,
                           json_is_object(materials) ? "more" : pl_json_found(materials, found));
    }
    const char *name;
    json_t *value;
    json_object_foreach((json_t *)materials, name, value)
    {
        pl_path_push_key(&r->diagnostic.path, name);
        if (!read_material(r, name, value)) {
            return false;
        }
        pl_path_pop(&r->diagnostic.path);
    }
    pl_path_pop(&r->diagnostic.path);
    return true;
}

static bool read_pair(reader *r, const json_t *json)
{
    pl_material_pair pair = {.friction = 0};
    return pl_json_object(json, &pl_scene_keys[PL_OBJECT_PAIR], &r->diagnostic) &&
           read_material_reference(r, json, "a", &pair.material_a) &&
           read_material_reference(r, json, "b", &pair.material_b) &&
           pl_json_number(json, "friction", PL_REQUIRED, &pair.friction, &r->diagnostic) &&
           pl_json_number(json, "restitution", PL_REQUIRED, &pair.restitution, &r->diagnostic) &&
           added(r, pl_scene_add_pair(r->scene, &pair, NULL));
}

/* Complains when the body has one of `keys`, a list that ends with NULL. */
static bool has_none_of(reader *r, const json_t *body, const char *const *keys,
                        const char *expected)
{
    for (; *keys != NULL; keys++) {
        const json_t *json = json_object_get(body, *keys);
        if (json != NULL) {
            char found[PL_FOUND_SIZE];
            r->diagnostic.at_key = true;
            return pl_complain_of(&r->diagnostic, *keys, "expected %s, found %s", expected,
                                  pl_json_found(json, found));
        }
    }
    return true;
}

/* Mass, or density times volume, and inertia where it is given. */
static bool read_mass(reader *r, const json_t *json, pl_body *body)
{
    pl_diagnostic *diagnostic = &r->diagnostic;
    static const char *const of_moving[] = {"mass", "density", "inertia", NULL};
    if (body->is_static || body->shape.kind == PL_SHAPE_PLANE) {
        return has_none_of(r, json, of_moving, "neither mass nor inertia of a static body");
    }
    bool has_mass = json_object_get(json, "mass") != NULL;
    bool has_density = json_object_get(json, "density") != NULL;
    if (has_mass == has_density) {
        diagnostic->at_key = has_density;
        return pl_complain_of(diagnostic, has_mass ? "density" : "mass",
                              "expected either mass or density of a body that is not static, "
                              "found %s",
                              has_mass ? "both" : "neither");
    }
    double density = 0;
    if (!pl_json_number(json, "mass", PL_OPTIONAL, &body->mass, diagnostic) ||
        !pl_json_number(json, "density", PL_OPTIONAL, &density, diagnostic) ||
        !pl_json_vector(json, "inertia", PL_OPTIONAL, body->inertia, 3, diagnostic)) {
        return false;
    }
    if (has_density) {
        if (!(density > 0)) {
            return pl_complain_of(diagnostic, "density", "expected a number above 0, found %g",
                                  density);
        }
        body->mass = density * pl_shape_volume(&body->shape);
    }
    bool all_zero = body->inertia[0] == 0 && body->inertia[1] == 0 && body->inertia[2] == 0;
    if (all_zero && json_object_get(json, "inertia") != NULL) {
        return pl_complain_of(diagnostic, "inertia", "expected numbers above 0, found zeros");
    }
    return true;
}

/* The material of a body that names none. */
static bool use_default_material(reader *r, int *index)
{
    static const pl_material material = {.name = "default", .friction = 0.5, .restitution = 0};
    *index = find_material(r->scene, material.name);
    if (*index >= 0) {
        return true;
    }
    if (r->scene->material_count == PL_MAX_MATERIALS) {
        return pl_complain_of(&r->diagnostic, "material",
                              "expected a name, there being no room for a default material beside "
                              "%d others, found nothing",
                              PL_MAX_MATERIALS);
    }
    return added(r, pl_scene_add_material(r->scene, &material, index, NULL));
}

static bool read_force(reader *r, const json_t *json)
{
    pl_force force = {.body = r->scene->body_count - 1, .until = (double)INFINITY};
    const char *frame = "world";
    pl_diagnostic *diagnostic = &r->diagnostic;
    if (!pl_json_object(json, &pl_scene_keys[PL_OBJECT_FORCE], diagnostic) ||
        !pl_json_vector(json, "force", PL_REQUIRED, force.force, 3, diagnostic) ||
        !pl_json_vector(json, "at", PL_OPTIONAL, force.at, 3, diagnostic) ||
        !pl_json_string(json, "frame", PL_OPTIONAL, "\"world\" or \"body\"", &frame, diagnostic) ||
        !pl_json_number(json, "from", PL_OPTIONAL, &force.from, diagnostic) ||
        !pl_json_number(json, "until", PL_OPTIONAL, &force.until, diagnostic)) {
        return false;
    }
    bool in_body = strcmp(frame, "body") == 0;
    if (!in_body && strcmp(frame, "world") != 0) {
        char quoted[PL_QUOTED_SIZE];
        return pl_complain_of(diagnostic, "frame", "expected \"world\" or \"body\", found %s",
                              pl_quoted(frame, quoted));
    }
    force.frame = in_body ? PL_FRAME_BODY : PL_FRAME_WORLD;
    return added(r, pl_scene_add_force(r->scene, &force, NULL));
}

static bool read_body(reader *r, const json_t *json)
{
    static const char *const of_placed[] = {"position", "orientation", NULL};
    pl_body body = pl_body_default();
    pl_diagnostic *diagnostic = &r->diagnostic;
    if (!pl_json_object(json, &pl_scene_keys[PL_OBJECT_BODY], diagnostic) ||
        !pl_json_name(json, "name", PL_REQUIRED, body.name, diagnostic) ||
        !pl_read_body_shape(&r->shapes, json, &body.shape)) {
        return false;
    }
    bool is_plane = body.shape.kind == PL_SHAPE_PLANE;
    body.is_static = is_plane;
    if (!pl_json_bool(json, "static", &body.is_static, diagnostic) ||
        (is_plane && !has_none_of(r, json, of_placed,
                                  "a plane to be placed by its shape's normal and offset")) ||
        !pl_json_vector(json, "position", PL_OPTIONAL, body.position, 3, diagnostic) ||
        !pl_json_unit(json, "orientation", PL_OPTIONAL, body.orientation, 4, &r->diagnostic) ||
        !pl_json_vector(json, "velocity", PL_OPTIONAL, body.velocity, 3, diagnostic) ||
        !pl_json_vector(json, "angular_velocity", PL_OPTIONAL, body.angular_velocity, 3,
                        diagnostic)) {
        return false;
    }
    bool has_material = json_object_get(json, "material") != NULL;
    return read_mass(r, json, &body) &&
           (has_material ? read_material_reference(r, json, "material", &body.material)
                         : use_default_material(r, &body.material)) &&
           added(r, pl_scene_add_body(r->scene, &body, NULL, NULL)) &&
           read_items(r, json, "forces", PL_OPTIONAL, read_force);
}

static bool read_body_reference(reader *r, const json_t *object, int *index)
{
    const char *name = NULL;
    if (!pl_json_string(object, "body", PL_REQUIRED, "the name of a body", &name, &r->diagnostic)) {
        return false;
    }
    *index = pl_name_index_find(&r->body_names, name);
    return *index >= 0 || pl_complain_of_reference(&r->diagnostic, "body", "body", name,
                                                   pl_name_index_nearest(&r->body_names, name));
}

static bool read_rest(reader *r, const json_t *json)
{
    pl_expect_rest rest = {.orientation = {1, 0, 0, 0}};
    rest.has_orientation = json_object_get(json, "orientation") != NULL;
    return pl_json_object(json, &pl_scene_keys[PL_OBJECT_REST], &r->diagnostic) &&
           read_body_reference(r, json, &rest.body) &&
           pl_json_vector(json, "position", PL_REQUIRED, rest.position, 3, &r->diagnostic) &&
           pl_json_unit(json, "orientation", PL_OPTIONAL, rest.orientation, 4, &r->diagnostic) &&
           added(r, pl_scene_add_rest(r->scene, &rest, NULL));
}

static bool read_travel(reader *r, const json_t *json)
{
    pl_expect_travel travel = {.discrete = (double)NAN};
    return pl_json_object(json, &pl_scene_keys[PL_OBJECT_TRAVEL], &r->diagnostic) &&
           read_body_reference(r, json, &travel.body) &&
           pl_json_unit(json, "direction", PL_REQUIRED, travel.direction, 3, &r->diagnostic) &&
           pl_json_number(json, "distance", PL_REQUIRED, &travel.distance, &r->diagnostic) &&
           pl_json_number(json, "discrete", PL_OPTIONAL, &travel.discrete, &r->diagnostic) &&
           added(r, pl_scene_add_travel(r->scene, &travel, NULL));
}

static bool read_quantity(reader *r, const json_t *json, pl_quantity *quantity)
{
    const char *name = NULL;
    if (!pl_json_string(json, "quantity", PL_REQUIRED, "the name of a quantity", &name,
                        &r->diagnostic)) {
        return false;
    }
    for (int i = 0; i < PL_QUANTITY_COUNT; i++) {
        if (strcmp(name, pl_quantity_names[i]) == 0) {
            *quantity = (pl_quantity)i;
            return true;
        }
    }
    const char *nearest = pl_nearest_name(name, pl_quantity_names, PL_QUANTITY_COUNT);
    char quoted[PL_QUOTED_SIZE];
    return pl_complain_of(
        &r->diagnostic, "quantity", "expected a quantity such as \"%s\", found %s",
        nearest != NULL ? nearest : pl_quantity_names[0], pl_quoted(name, quoted));
}

static bool read_value(reader *r, const json_t *json)
{
    pl_expect_value value = pl_expect_value_default(r->scene);
    return pl_json_object(json, &pl_scene_keys[PL_OBJECT_VALUE], &r->diagnostic) &&
           read_body_reference(r, json, &value.body) && read_quantity(r, json, &value.quantity) &&
           pl_json_unit(json, "direction", PL_REQUIRED, value.direction, 3, &r->diagnostic) &&
           pl_json_number(json, "from", PL_OPTIONAL, &value.from, &r->diagnostic) &&
           pl_json_number(json, "until", PL_OPTIONAL, &value.until, &r->diagnostic) &&
           pl_json_number(json, "value", PL_REQUIRED, &value.value, &r->diagnostic) &&
           pl_json_number(json, "discrete", PL_OPTIONAL, &value.discrete, &r->diagnostic) &&
           pl_json_number(json, "scale", PL_OPTIONAL, &value.scale, &r->diagnostic) &&
           added(r, pl_scene_add_value(r->scene, &value, NULL));
}

/* Half of the smallest dimension of the bodies that should rest: what has moved farther has fallen.
 */
static double default_collapse_distance(const pl_scene *scene)
{
    double half = (double)INFINITY;
    for (int i = 0; i < scene->rest_count; i++) {
        half = fmin(half, pl_shape_half_width(&scene->bodies[scene->rests[i].body].shape));
    }
    return half;
}

static bool read_primary_error(reader *r, const json_t *expect)
{
    pl_scene *scene = r->scene;
    const char *primary = scene->travel_count > 0  ? "travel_error"
                          : scene->value_count > 0 ? "value_error"
                          : scene->rest_count > 0  ? "rest_position_error"
                                                   : "";
    if (!pl_json_string(expect, "primary", PL_OPTIONAL, "the name of a metric", &primary,
                        &r->diagnostic)) {
        return false;
    }
    if (strlen(primary) >= sizeof scene->primary_error) {
        char quoted[PL_QUOTED_SIZE];
        return pl_complain_of(&r->diagnostic, "primary", "expected the name of a metric, found %s",
                              pl_quoted(primary, quoted));
    }
    memcpy(scene->primary_error, primary, strlen(primary) + 1);
    return true;
}

static bool read_expectations(reader *r, const json_t *object)
{
    pl_scene *scene = r->scene;
    const json_t *expect = json_object_get(object, "expect");
    if (expect == NULL) {
        return true;
    }
    if (pl_name_index_create(scene->body_count == 0 ? NULL : scene->bodies[0].name,
                             sizeof *scene->bodies, scene->body_count, &r->body_names) != PL_OK) {
        return pl_complain_no_memory(&r->diagnostic);
    }
    pl_path_push_key(&r->diagnostic.path, "expect");
    if (!pl_json_object(expect, &pl_scene_keys[PL_OBJECT_EXPECT], &r->diagnostic) ||
        !read_items(r, expect, "rest", PL_OPTIONAL, read_rest) ||
        !read_items(r, expect, "travel", PL_OPTIONAL, read_travel) ||
        !read_items(r, expect, "values", PL_OPTIONAL, read_value) ||
        !read_primary_error(r, expect)) {
        return false;
    }
    scene->collapse_distance = default_collapse_distance(scene);
    if (json_is_null(json_object_get(expect, "collapse_distance"))) {
        scene->collapse_distance = (double)INFINITY;
    } else if (!pl_json_number(expect, "collapse_distance", PL_OPTIONAL, &scene->collapse_distance,
                               &r->diagnostic)) {
        return false;
    }
    pl_path_pop(&r->diagnostic.path);
    return true;
}

static bool read_version(reader *r, const json_t *json)
{
    const json_t *version = json_object_get(json, "plumb_scene");
    if (json_is_number(version) && json_number_value(version) == 1) {
        return true;
    }
    char found[PL_FOUND_SIZE];
    return pl_complain_of(&r->diagnostic, "plumb_scene", "expected 1, found %s",
                          pl_json_found(version, found));
}

static bool read_scene(reader *r, const json_t *json)
{
    pl_scene *scene = r->scene;
    pl_diagnostic *diagnostic = &r->diagnostic;
    return pl_json_object(json, &pl_scene_keys[PL_OBJECT_SCENE], diagnostic) &&
           read_version(r, json) &&
           pl_json_name(json, "name", PL_OPTIONAL, scene->name, diagnostic) &&
           pl_json_vector(json, "gravity", PL_OPTIONAL, scene->gravity, 3, diagnostic) &&
           pl_json_number(json, "dt", PL_OPTIONAL, &scene->dt, diagnostic) &&
           pl_json_number(json, "duration", PL_OPTIONAL, &scene->duration, diagnostic) &&
           read_materials(r, json) && read_items(r, json, "pairs", PL_OPTIONAL, read_pair) &&
           pl_read_shapes(&r->shapes, json) &&
           read_items(r, json, "bodies", PL_REQUIRED, read_body) && read_expectations(r, json) &&
           pl_scene_check(scene, diagnostic);
}

bool pl_scene_from_json(const json_t *json, const char *folder, pl_scene *scene,
                        pl_diagnostic *diagnostic)
{
    reader r = {.scene = scene};
    r.shapes = (pl_shape_reader){.scene = scene, .folder = folder, .diagnostic = &r.diagnostic};
    bool right = read_scene(&r, json);
    pl_shape_reader_free(&r.shapes);
    pl_name_index_free(&r.body_names);
    *diagnostic = r.diagnostic;
    return right;
}
