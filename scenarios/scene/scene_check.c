#include "scene_check.h"

#include "base/diagnostic.h"
#include "base/name_index.h"
#include "base/number.h"
#include "shape_check.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const pl_primary_errors[] = {
    "rest_position_error", "rest_rotation_error", "travel_error", "value_error", "discrete_error",
    "penetration_max",     "penetration_rest",    "drift",        "creep",       "energy_gain",
    "momentum_error"};
const int pl_primary_error_count = sizeof pl_primary_errors / sizeof pl_primary_errors[0];

/* A name in an array of PL_NAME_SIZE bytes: it could lack its zero, or not be UTF-8. */
static bool check_stored_name(const char *name, pl_diagnostic *diagnostic)
{
    const char *end = memchr(name, '\0', PL_NAME_SIZE);
    if (!pl_check_name(name, end == NULL ? PL_NAME_SIZE : (size_t)(end - name), diagnostic)) {
        return false;
    }
    json_t *text = json_string(name); /* NULL for what is not UTF-8 */
    json_decref(text);
    return text != NULL || pl_complain(diagnostic, "expected a name in UTF-8, found other bytes");
}

static bool check_zero(pl_diagnostic *diagnostic, const char *key, const double vector[3])
{
    bool zero = vector[0] == 0 && vector[1] == 0 && vector[2] == 0;
    return zero || pl_complain_of(diagnostic, key,
                                  "expected zero, since a static body never moves, found another");
}

static bool check_index(pl_diagnostic *diagnostic, const char *key, int index, int count,
                        const char *kind)
{
    return (index >= 0 && index < count) ||
           pl_complain_of(diagnostic, key, "expected the index of a %s from 0 to %d, found %d",
                          kind, count - 1, index);
}

static bool check_friction_and_restitution(pl_diagnostic *diagnostic, double friction,
                                           double restitution)
{
    return pl_check_number(diagnostic, "friction", friction, isfinite(friction) && friction >= 0,
                           "a finite number of at least 0") &&
           pl_check_number(diagnostic, "restitution", restitution,
                           restitution >= 0 && restitution <= 1, "a number from 0 to 1");
}

static bool check_time(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    if (!pl_check_positive(diagnostic, "dt", scene->dt) ||
        !pl_check_is_finite(diagnostic, "duration", scene->duration)) {
        return false;
    }
    char dt[PL_NUMBER_SIZE], found[PL_NUMBER_SIZE];
    if (scene->duration < scene->dt) {
        return pl_complain_of(diagnostic, "duration", "expected at least dt, which is %s, found %s",
                              pl_number_text(scene->dt, dt),
                              pl_number_text(scene->duration, found));
    }
    double steps = round(scene->duration / scene->dt);
    return steps <= PL_MAX_STEPS ||
           pl_complain_of(diagnostic, "duration",
                          "expected at most %d steps of dt, which is %s, found %.17g steps",
                          PL_MAX_STEPS, pl_number_text(scene->dt, dt), steps);
}

/* Complains of the first name that an earlier one of `count` items equals. The path stands at the
 * array. */
static bool check_unique(pl_diagnostic *diagnostic, const char *first_name, size_t stride,
                         int count)
{
    pl_name_index names;
    if (pl_name_index_create(first_name, stride, count, &names) != PL_OK) {
        return pl_complain_no_memory(diagnostic);
    }
    int duplicate = pl_name_index_duplicate(&names);
    bool unique = duplicate < 0;
    if (!unique) {
        const char *name = first_name + (size_t)duplicate * stride;
        char quoted[PL_QUOTED_SIZE];
        pl_path_push_index(&diagnostic->path, duplicate);
        pl_complain_of(diagnostic, "name",
                       "expected a name of its own, found %s, which item %d has",
                       pl_quoted(name, quoted), pl_name_index_find(&names, name));
    }
    pl_name_index_free(&names);
    return unique;
}

static bool check_materials(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "materials");
    for (int i = 0; i < scene->material_count; i++) {
        const pl_material *material = &scene->materials[i];
        pl_path_push_index(&diagnostic->path, i);
        if (!check_stored_name(material->name, diagnostic)) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
        pl_path_push_key(&diagnostic->path, material->name); /* as the file has it */
        if (!check_friction_and_restitution(diagnostic, material->friction,
                                            material->restitution)) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    if (!check_unique(diagnostic, scene->materials == NULL ? NULL : scene->materials[0].name,
                      sizeof *scene->materials, scene->material_count)) {
        return false;
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

/* The names that polyhedra have are keys of one object in a scene file. */
static bool check_polyhedra(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    char(*names)[PL_NAME_SIZE] = calloc((size_t)scene->polyhedron_count + 1, sizeof *names);
    if (names == NULL) {
        return pl_complain_no_memory(diagnostic);
    }
    int count = 0;
    bool right = true;
    pl_path_push_key(&diagnostic->path, "shapes");
    for (int i = 0; i < scene->polyhedron_count && right; i++) {
        const char *name = scene->polyhedra[i]->name;
        if (name[0] != '\0') {
            right = check_stored_name(name, diagnostic);
            memcpy(names[count++], name, PL_NAME_SIZE);
        }
    }
    right = right && check_unique(diagnostic, names[0], sizeof *names, count);
    if (right) {
        pl_path_pop(&diagnostic->path);
    }
    free(names);
    return right;
}

static bool check_pair(const pl_scene *scene, int index, bool *seen, pl_diagnostic *diagnostic)
{
    const pl_material_pair *pair = &scene->pairs[index];
    if (!check_index(diagnostic, "a", pair->material_a, scene->material_count, "material") ||
        !check_index(diagnostic, "b", pair->material_b, scene->material_count, "material") ||
        !check_friction_and_restitution(diagnostic, pair->friction, pair->restitution)) {
        return false;
    }
    int low = pair->material_a < pair->material_b ? pair->material_a : pair->material_b;
    int high = pair->material_a + pair->material_b - low;
    bool *cell = &seen[high * PL_MAX_MATERIALS + low];
    if (*cell) {
        return pl_complain(diagnostic,
                           "expected each pair of materials once, found %s and %s again",
                           scene->materials[low].name, scene->materials[high].name);
    }
    *cell = true;
    return true;
}

static bool check_pairs(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    if (scene->pair_count == 0) {
        return true;
    }
    bool *seen = calloc((size_t)PL_MAX_MATERIALS * PL_MAX_MATERIALS, sizeof *seen);
    if (seen == NULL) {
        return pl_complain_no_memory(diagnostic);
    }
    bool right = true;
    pl_path_push_key(&diagnostic->path, "pairs");
    for (int i = 0; i < scene->pair_count && right; i++) {
        pl_path_push_index(&diagnostic->path, i);
        right = check_pair(scene, i, seen, diagnostic);
        if (right) {
            pl_path_pop(&diagnostic->path);
        }
    }
    if (right) {
        pl_path_pop(&diagnostic->path);
    }
    free(seen);
    return right;
}

/* Principal inertias of any solid keep I_a + I_b >= I_c: Goldstein, Classical Mechanics, ch. 5. */
static bool check_inertia(const double inertia[3], pl_diagnostic *diagnostic)
{
    bool right = true;
    double sum = inertia[0] + inertia[1] + inertia[2];
    for (int k = 0; k < 3; k++) {
        right = right && isfinite(inertia[k]) && inertia[k] > 0 &&
                inertia[k] <= (sum - inertia[k]) * (1 + PL_UNIT_TOLERANCE);
    }
    char x[PL_NUMBER_SIZE], y[PL_NUMBER_SIZE], z[PL_NUMBER_SIZE];
    return right ||
           pl_complain_of(diagnostic, "inertia",
                          "expected three finite numbers above 0, none larger than the sum "
                          "of the other two, found [%s, %s, %s]",
                          pl_number_text(inertia[0], x), pl_number_text(inertia[1], y),
                          pl_number_text(inertia[2], z));
}

static bool check_body_shape(const pl_shape *shape, const pl_pointer_map *polyhedra,
                             pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "shape");
    if (!pl_check_shape(shape, diagnostic) || !pl_check_polyhedron(shape, polyhedra, diagnostic)) {
        return false;
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool check_body(const pl_scene *scene, const pl_body *body, const pl_pointer_map *polyhedra,
                       pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "name");
    if (!check_stored_name(body->name, diagnostic)) {
        return false;
    }
    pl_path_pop(&diagnostic->path);
    if (!check_index(diagnostic, "material", body->material, scene->material_count, "material") ||
        !check_body_shape(&body->shape, polyhedra, diagnostic)) {
        return false;
    }
    if (body->shape.kind == PL_SHAPE_PLANE && !body->is_static) {
        return pl_complain_of(diagnostic, "static",
                              "expected true, since a plane never moves, found "
                              "false");
    }
    if (!pl_check_vector(diagnostic, "position", body->position) ||
        !pl_check_unit(diagnostic, "orientation", body->orientation, 4,
                       "a unit quaternion [w, x, y, z]") ||
        !pl_check_vector(diagnostic, "velocity", body->velocity) ||
        !pl_check_vector(diagnostic, "angular_velocity", body->angular_velocity)) {
        return false;
    }
    if (body->is_static) {
        return check_zero(diagnostic, "velocity", body->velocity) &&
               check_zero(diagnostic, "angular_velocity", body->angular_velocity);
    }
    return pl_check_positive(diagnostic, "mass", body->mass) &&
           check_inertia(body->inertia, diagnostic);
}

static bool check_bodies(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "bodies");
    if (scene->body_count < 1 || scene->body_count > PL_MAX_BODIES) {
        return pl_complain(diagnostic, "expected 1 to %d bodies, found %d", PL_MAX_BODIES,
                           scene->body_count);
    }
    pl_pointer_map polyhedra;
    if (pl_pointer_map_create(scene, &polyhedra) != PL_OK) {
        return pl_complain_no_memory(diagnostic);
    }
    bool right = true;
    for (int i = 0; i < scene->body_count && right; i++) {
        pl_path_push_index(&diagnostic->path, i);
        right = check_body(scene, &scene->bodies[i], &polyhedra, diagnostic);
        if (right) {
            pl_path_pop(&diagnostic->path);
        }
    }
    pl_pointer_map_free(&polyhedra);
    if (!right) {
        return false;
    }
    if (!check_unique(diagnostic, scene->bodies[0].name, sizeof *scene->bodies,
                      scene->body_count)) {
        return false;
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool check_force(const pl_force *force, pl_diagnostic *diagnostic)
{
    if (force->frame != PL_FRAME_WORLD && force->frame != PL_FRAME_BODY) {
        return pl_complain_of(diagnostic, "frame", "expected a known frame, found number %d",
                              (int)force->frame);
    }
    if (!pl_check_vector(diagnostic, "force", force->force) ||
        !pl_check_vector(diagnostic, "at", force->at) ||
        !pl_check_number(diagnostic, "from", force->from, isfinite(force->from) && force->from >= 0,
                         "a finite number of at least 0")) {
        return false;
    }
    char from[PL_NUMBER_SIZE], found[PL_NUMBER_SIZE];
    return force->until > force->from ||
           pl_complain_of(diagnostic, "until",
                          "expected a time after `from`, which is %s, found %s",
                          pl_number_text(force->from, from), pl_number_text(force->until, found));
}

/* Where force number `index` stands in a scene file: in its body's own list. */
static int place_in_body(const pl_scene *scene, int index)
{
    int place = 0;
    for (int i = 0; i < index; i++) {
        place += scene->forces[i].body == scene->forces[index].body ? 1 : 0;
    }
    return place;
}

static bool check_forces(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    for (int i = 0; i < scene->force_count; i++) {
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
            return pl_complain(diagnostic, "expected no forces on a static body, found one");
        }
        const pl_path list = diagnostic->path;
        pl_path_push_index(&diagnostic->path, 0);
        if (!check_force(force, diagnostic)) {
            /* Only now: counting for every force would be quadratic. */
            diagnostic->path.steps[list.depth].index = place_in_body(scene, i);
            return false;
        }
        diagnostic->path = outside;
    }
    return true;
}

static bool check_placed_body(const pl_scene *scene, int body, pl_diagnostic *diagnostic)
{
    if (!check_index(diagnostic, "body", body, scene->body_count, "body")) {
        return false;
    }
    return scene->bodies[body].shape.kind != PL_SHAPE_PLANE ||
           pl_complain_of(diagnostic, "body", "expected a body with a position, found the plane %s",
                          scene->bodies[body].name);
}

static bool check_rests(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "rest");
    for (int i = 0; i < scene->rest_count; i++) {
        const pl_expect_rest *rest = &scene->rests[i];
        pl_path_push_index(&diagnostic->path, i);
        if (!check_placed_body(scene, rest->body, diagnostic) ||
            !pl_check_vector(diagnostic, "position", rest->position) ||
            (rest->has_orientation && !pl_check_unit(diagnostic, "orientation", rest->orientation,
                                                     4, "a unit quaternion [w, x, y, z]"))) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool check_travels(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "travel");
    for (int i = 0; i < scene->travel_count; i++) {
        const pl_expect_travel *travel = &scene->travels[i];
        pl_path_push_index(&diagnostic->path, i);
        if (!check_placed_body(scene, travel->body, diagnostic) ||
            !pl_check_unit(diagnostic, "direction", travel->direction, 3, "a unit vector") ||
            !pl_check_number(diagnostic, "distance", travel->distance,
                             isfinite(travel->distance) && travel->distance != 0,
                             "a finite number other than 0") ||
            !pl_check_number(diagnostic, "discrete", travel->discrete,
                             isnan(travel->discrete) ||
                                 (isfinite(travel->discrete) && travel->discrete != 0),
                             "a finite number other than 0")) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
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

static bool check_values(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "values");
    for (int i = 0; i < scene->value_count; i++) {
        const pl_expect_value *value = &scene->values[i];
        pl_path_push_index(&diagnostic->path, i);
        if (!check_placed_body(scene, value->body, diagnostic) ||
            !pl_check_number(diagnostic, "quantity", value->quantity,
                             (int)value->quantity >= 0 && (int)value->quantity < PL_QUANTITY_COUNT,
                             "a quantity") ||
            !pl_check_unit(diagnostic, "direction", value->direction, 3, "a unit vector") ||
            !check_times(scene, value, diagnostic) ||
            !pl_check_number(diagnostic, "value", value->value, isfinite(value->value),
                             "a finite number") ||
            !pl_check_number(diagnostic, "discrete", value->discrete, !isinf(value->discrete),
                             "a finite number") ||
            !pl_check_number(diagnostic, "scale", value->scale,
                             isfinite(value->scale) && value->scale > 0, "a number above 0")) {
            return false;
        }
        pl_path_pop(&diagnostic->path);
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool check_primary_error(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    const char *primary = scene->primary_error;
    if (primary[0] == '\0') {
        return true;
    }
    if (memchr(primary, '\0', sizeof scene->primary_error) == NULL) {
        return pl_complain_of(diagnostic, "primary",
                              "expected a metric, found text without an end");
    }
    bool known = false;
    for (int i = 0; i < pl_primary_error_count; i++) {
        known = known || strcmp(primary, pl_primary_errors[i]) == 0;
    }
    if (!known) {
        const char *nearest = pl_nearest_name(primary, pl_primary_errors, pl_primary_error_count);
        char quoted[PL_QUOTED_SIZE];
        return pl_complain_of(diagnostic, "primary", "expected a metric such as \"%s\", found %s",
                              nearest != NULL ? nearest : pl_primary_errors[0],
                              pl_quoted(primary, quoted));
    }
    if (strncmp(primary, "rest_", 5) == 0 && scene->rest_count == 0) {
        return pl_complain_of(diagnostic, "primary", "expected `rest` beside \"%s\", found none",
                              primary);
    }
    if (strcmp(primary, "value_error") == 0 && scene->value_count == 0) {
        return pl_complain_of(diagnostic, "primary", "expected `values` beside \"%s\", found none",
                              primary);
    }
    bool of_travel = strcmp(primary, "travel_error") == 0 ||
                     (strcmp(primary, "discrete_error") == 0 && scene->value_count == 0);
    if (of_travel && scene->travel_count == 0) {
        return pl_complain_of(diagnostic, "primary", "expected `travel` beside \"%s\", found none",
                              primary);
    }
    return true;
}

static bool check_expectations(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    pl_path_push_key(&diagnostic->path, "expect");
    if (!check_rests(scene, diagnostic) || !check_travels(scene, diagnostic) ||
        !check_values(scene, diagnostic) || !check_primary_error(scene, diagnostic) ||
        !pl_check_number(diagnostic, "collapse_distance", scene->collapse_distance,
                         scene->collapse_distance > 0, "a number above 0")) {
        return false;
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

static bool check_scene_name(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    if (scene->name[0] == '\0') {
        return true; /* a scene need not have one */
    }
    pl_path_push_key(&diagnostic->path, "name");
    if (!check_stored_name(scene->name, diagnostic)) {
        return false;
    }
    pl_path_pop(&diagnostic->path);
    return true;
}

bool pl_scene_check(const pl_scene *scene, pl_diagnostic *diagnostic)
{
    return check_scene_name(scene, diagnostic) &&
           pl_check_vector(diagnostic, "gravity", scene->gravity) &&
           check_time(scene, diagnostic) && check_materials(scene, diagnostic) &&
           check_pairs(scene, diagnostic) && check_polyhedra(scene, diagnostic) &&
           check_bodies(scene, diagnostic) && check_forces(scene, diagnostic) &&
           check_expectations(scene, diagnostic);
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
