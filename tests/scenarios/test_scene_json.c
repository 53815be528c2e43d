/* Scene files: what is written reads back number for number, defaults, and the schema next to the
 * reader. */
#include "base/hash.h"
#include "base/number.h"
#include "check.h"
#include "plumb/scene.h"
#include "referee/metrics/metrics.h"
#include "sample_scene.h"
#include "scene/scene_fields.h"
#include "scene_equal.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void check_reads_back(const pl_scene *scene)
{
    char *text = pl_scene_to_text(scene);
    assert_non_null(text);
    pl_scene again = read_scene(text);
    assert_same_scene(&again, scene);
    free(text);
    pl_scene_free(&again);
}

/* The bodies are parsed apart from the rest: a fault at their seams must not be lost. */
static void test_text_that_is_no_json_is_refused(void **state)
{
    (void)state;
    static const char marks[] = ",]}[{:\"0 ";
    const size_t length = strlen(sample_scene);
    char *text = malloc(length + 1);
    assert_non_null(text);
    int refused = 0;
    for (size_t at = 0; at < length; ++at) {
        for (size_t k = 0; k < sizeof marks - 1; ++k) {
            memcpy(text, sample_scene, length + 1);
            text[at] = marks[k];
            json_t *json = json_loadb(text, length, JSON_REJECT_DUPLICATES, NULL);
            pl_scene scene;
            const pl_status status = pl_scene_read_text(text, length, "text", &scene, NULL);
            if (json == NULL) {
                assert_int_equal(status, PL_BAD_INPUT);
                refused += 1;
            } else if (status == PL_OK) {
                pl_scene_free(&scene);
            }
            json_decref(json);
        }
    }
    assert_true(refused > 1000);
    free(text);
}

/* In memory of its own size, so that a reader that goes beyond its end is seen. */
static void test_text_that_is_cut_short_is_refused(void **state)
{
    (void)state;
    for (size_t length = 0; length < strlen(sample_scene) - 2; ++length) {
        char *text = malloc(length + 1);
        assert_non_null(text);
        memcpy(text + 1, sample_scene, length);
        pl_scene scene;
        pl_error error = {.message = ""};
        assert_int_equal(pl_scene_read_text(text + 1, length, "text", &scene, &error),
                         PL_BAD_INPUT);
        assert_contains(error.message, "text:");
        free(text);
    }
}

/* The hash is taken piece by piece, without the whole text. */
static void test_scene_hash_is_that_of_its_text(void **state)
{
    (void)state;
    char hash[PL_HASH_TEXT_SIZE], expected[PL_HASH_TEXT_SIZE];
    pl_scene scene = read_scene(sample_scene);
    char *text = pl_scene_to_text(&scene);
    assert_non_null(text);
    assert_int_equal(pl_scene_hash(&scene, hash, NULL), PL_OK);
    assert_string_equal(hash, pl_hash_hex(pl_hash_text(PL_HASH_START, text), expected));
    free(text);
    pl_scene_free(&scene);
}

static void test_sample_reads_as_written(void **state)
{
    (void)state;
    pl_scene scene = read_scene(sample_scene);
    assert_string_equal(scene.name, "é scène");
    assert_close(scene.gravity[1], 0.5, 0, 0);
    assert_close(scene.dt, 0.01, 0, 0);
    assert_int_equal(pl_scene_steps(&scene), 200);
    assert_int_equal(scene.material_count, 3); /* with the ball's default */
    assert_string_equal(scene.materials[1].name, "stål");
    assert_string_equal(scene.materials[2].name, "default");
    assert_close(scene.materials[2].friction, 0.5, 0, 0);
    assert_close(scene.materials[2].restitution, 0, 0, 0);
    assert_int_equal(scene.pairs[0].material_a, 0);
    assert_int_equal(scene.pairs[0].material_b, 1);
    assert_true(scene.bodies[0].is_static);
    assert_close(scene.bodies[0].shape.offset, -0.5, 0, 0);
    const pl_body *box = &scene.bodies[1];
    assert_close(box->mass, 2, 0, 0);
    assert_close(box->inertia[2], 0.5, 0, 0);
    assert_close(box->orientation[2], 0.8, 0, 0);
    assert_close(box->angular_velocity[2], 1, 0, 0);
    assert_int_equal(scene.force_count, 2);
    assert_int_equal(scene.forces[0].frame, PL_FRAME_BODY);
    assert_close(scene.forces[0].at[2], -0.5, 0, 0);
    assert_close(scene.forces[0].until, 2, 0, 0);
    assert_int_equal(scene.forces[1].frame, PL_FRAME_WORLD);
    assert_close(scene.forces[1].from, 0, 0, 0);
    assert_true(isinf(scene.forces[1].until));
    const pl_body *ball = &scene.bodies[2];
    const double pi = acos(-1);
    assert_close(ball->mass, 100 * 4 * pi / 3 * 0.008, 0, 1e-15);
    assert_close(ball->inertia[0], 0.4 * ball->mass * 0.04, 0, 1e-15);
    assert_close(ball->orientation[0], 1, 0, 0);
    assert_int_equal(scene.rests[0].body, 1);
    assert_true(scene.rests[0].has_orientation);
    assert_int_equal(scene.travels[0].body, 2);
    assert_close(scene.travels[0].discrete, 4.5, 0, 0);
    assert_int_equal(scene.values[0].quantity, PL_QUANTITY_APEX);
    assert_close(scene.values[0].from, 0.5, 0, 0);
    assert_close(scene.values[0].scale, 2, 0, 0);
    assert_int_equal(scene.statistics[0].metric, PL_STATISTIC_SPREAD_Y);
    assert_close(scene.statistics[0].low, 0.5, 0, 0);
    assert_close(scene.statistics[0].high, 0.75, 0, 0);
    assert_close(scene.statistics[0].scale, 4, 0, 0);
    assert_string_equal(scene.primary_error, "drift");
    assert_close(scene.collapse_distance, 0.5, 0, 0);
    pl_scene_free(&scene);
}

static void test_written_sample_reads_back(void **state)
{
    (void)state;
    pl_scene scene = read_scene(sample_scene);
    check_reads_back(&scene);
    pl_scene_free(&scene);
}

static double any_double(check_random *random)
{
    double digits = check_uniform(random, -1, 1);
    return digits * pow(10, check_uniform(random, -300, 300));
}

/* Every number that is free is drawn over the whole range of doubles. */
static void test_random_scenes_read_back_number_for_number(void **state)
{
    (void)state;
    check_random random = {.state = 99};
    for (int round = 0; round < 200; ++round) {
        pl_scene scene = pl_scene_default();
        pl_material material = {.name = "a\"b\\c/\x7e é"};
        material.friction = fabs(any_double(&random));
        material.restitution = check_uniform(&random, 0, 1);
        assert_int_equal(pl_scene_add_material(&scene, &material, NULL, NULL), PL_OK);
        for (int i = 0; i < 20; ++i) {
            pl_body body = pl_body_default();
            snprintf(body.name, sizeof body.name, "b%d", i);
            double size = pow(10, check_uniform(&random, -50, 50));
            body.shape =
                i % 2 == 0 ? pl_shape_sphere(size) : pl_shape_box(size, size * 0.7, size * 3);
            body.mass = pow(10, check_uniform(&random, -100, 100));
            check_quaternion(&random, body.orientation);
            for (int k = 0; k < 3; ++k) {
                scene.gravity[k] = any_double(&random);
                body.position[k] = any_double(&random);
                body.velocity[k] = i % 3 == 0 ? -0.0 : any_double(&random);
                body.angular_velocity[k] = any_double(&random);
            }
            pl_force force = {.body = i, .force = {any_double(&random), 1, 0}, .from = -0.0};
            force.until = fabs(any_double(&random));
            pl_expect_rest rest = {.body = i, .position = {any_double(&random), 0, 0}};
            const pl_expect_travel travel = {.body = i,
                                             .direction = {0, 0.6, 0.8},
                                             .distance = any_double(&random),
                                             .discrete = nan("")};
            assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
            assert_int_equal(pl_scene_add_force(&scene, &force, NULL), PL_OK);
            assert_int_equal(pl_scene_add_rest(&scene, &rest, NULL), PL_OK);
            pl_expect_value value = pl_expect_value_default(&scene);
            value.body = i;
            value.quantity = (pl_quantity)(i % PL_QUANTITY_COUNT);
            value.value = any_double(&random);
            value.scale = fabs(any_double(&random));
            assert_int_equal(pl_scene_add_travel(&scene, &travel, NULL), PL_OK);
            assert_int_equal(pl_scene_add_value(&scene, &value, NULL), PL_OK);
            const double low = any_double(&random);
            const pl_expect_statistic statistic = {.metric = (pl_statistic)(i % PL_STATISTIC_COUNT),
                                                   .low = low,
                                                   .high = low + fabs(any_double(&random)),
                                                   .scale = fabs(any_double(&random))};
            assert_int_equal(pl_scene_add_statistic(&scene, &statistic, NULL), PL_OK);
        }
        assert_int_equal(pl_scene_validate(&scene, NULL), PL_OK);
        check_reads_back(&scene);
        pl_scene_free(&scene);
    }
}

static void test_expectations_that_differ_from_their_defaults_read_back(void **state)
{
    (void)state;
    pl_scene scene = read_scene(sample_scene);
    scene.collapse_distance = HUGE_VAL; /* with a rest, whose default is finite */
    scene.primary_error[0] = '\0';
    check_reads_back(&scene);
    scene.rest_count = scene.travel_count = scene.value_count = 0;
    check_reads_back(&scene); /* statistics alone */
    scene.statistic_count = 0;
    check_reads_back(&scene);
    scene.collapse_distance = 3;
    check_reads_back(&scene);
    pl_scene_free(&scene);
}

static void test_default_material_is_created_at_most_once(void **state)
{
    (void)state;
    pl_scene scene = read_scene(
        "{\"plumb_scene\": 1, \"materials\": {\"x\": {\"friction\": 1, \"restitution\": 0},"
        "\"default\": {\"friction\": 0.125, \"restitution\": 1}}, \"bodies\": ["
        "{\"name\": \"a\", \"mass\": 1, \"shape\": {\"type\": \"sphere\", \"radius\": 1}}]}");
    assert_int_equal(scene.material_count, 2);
    assert_int_equal(scene.bodies[0].material, 1);
    pl_scene_free(&scene);
    scene = read_scene(
        "{\"plumb_scene\": 1, \"bodies\": ["
        "{\"name\": \"a\", \"mass\": 1, \"shape\": {\"type\": \"sphere\", \"radius\": 1}},"
        "{\"name\": \"b\", \"mass\": 1, \"shape\": {\"type\": \"sphere\", \"radius\": 1}}]}");
    assert_int_equal(scene.material_count, 1);
    pl_scene_free(&scene);
}

static void test_what_is_left_out_has_the_defaults(void **state)
{
    (void)state;
    pl_scene scene = read_scene(
        "{\"plumb_scene\": 1, \"bodies\": ["
        "{\"name\": \"floor\", \"shape\": {\"type\": \"plane\", \"normal\": [0, 0, 1], \"offset\": "
        "0}},"
        "{\"name\": \"a\", \"mass\": 1, \"shape\": {\"type\": \"box\", \"half_extents\": [3, 2, "
        "4]}},"
        "{\"name\": \"b\", \"mass\": 1, \"shape\": {\"type\": \"sphere\", \"radius\": 2.5}}],"
        "\"expect\": {\"rest\": [{\"body\": \"a\", \"position\": [0, 0, 0]},"
        "{\"body\": \"b\", \"position\": [0, 0, 0]}]}}");
    assert_string_equal(scene.name, "");
    assert_close(scene.gravity[2], -9.81, 0, 0);
    assert_close(scene.dt, 1.0 / 60, 0, 0);
    assert_close(scene.duration, 5, 0, 0);
    assert_true(scene.bodies[0].is_static); /* a plane need not say so */
    assert_string_equal(scene.primary_error, "rest_position_error");
    assert_close(scene.collapse_distance, 2, 0, 0); /* half of 4, the box's height along y */
    assert_false(scene.rests[0].has_orientation);
    check_reads_back(&scene);
    pl_scene_free(&scene);
}

static void test_default_primary_error_is_travel_before_rest(void **state)
{
    (void)state;
    static const char body[] =
        "{\"plumb_scene\": 1, \"bodies\": [{\"name\": \"a\", \"mass\": 1, \"shape\": {\"type\": "
        "\"sphere\", \"radius\": 1}}], \"expect\": {%s}}";
    static const struct {
        const char *expect, *primary;
    } cases[] = {{"", ""},
                 {"\"travel\": [{\"body\": \"a\", \"direction\": [1, 0, 0], \"distance\": 1}], "
                  "\"rest\": [{\"body\": \"a\", \"position\": [1, 0, 0]}]",
                  "travel_error"},
                 {"\"rest\": [{\"body\": \"a\", \"position\": [1, 0, 0]}]", "rest_position_error"},
                 {"\"primary\": \"penetration_max\"", "penetration_max"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char text[512];
        snprintf(text, sizeof text, "%.*s%s}}", (int)(strlen(body) - 4), body, cases[i].expect);
        pl_scene scene = read_scene(text);
        assert_string_equal(scene.primary_error, cases[i].primary);
        assert_int_equal(isinf(scene.collapse_distance), scene.rest_count == 0);
        pl_scene_free(&scene);
    }
}

static pl_scene read_turned(double w, double x)
{
    char text[512], w_text[PL_NUMBER_SIZE], x_text[PL_NUMBER_SIZE];
    snprintf(
        text, sizeof text,
        "{\"plumb_scene\": 1, \"bodies\": [{\"name\": \"a\", \"mass\": 1, \"orientation\": [%s, "
        "%s, 0, 0], \"shape\": {\"type\": \"sphere\", \"radius\": 1}}]}",
        pl_number_text(w, w_text), pl_number_text(x, x_text));
    return read_scene(text);
}

static void test_only_almost_unit_quaternions_are_normalised(void **state)
{
    (void)state;
    pl_scene scene = read_turned(0.7071068, 0.7071068); /* as people write it: 1 + 2.6e-8 */
    const double *q = scene.bodies[0].orientation;
    assert_close(q[0] * q[0] + q[1] * q[1], 1, 4e-16, 0);
    assert_close(q[0], sqrt(0.5), 0, 2e-16);
    pl_scene_free(&scene);
    scene = read_turned(0.6, 0.8 + 1e-10); /* within rounding: left as it is */
    assert_close(scene.bodies[0].orientation[1], 0.8 + 1e-10, 0, 0);
    pl_scene_free(&scene);
}

static void test_whole_numbers_of_any_size_are_numbers(void **state)
{
    (void)state;
    pl_scene scene =
        read_scene("{\"plumb_scene\": 1.0, \"bodies\": [{\"name\": \"a\", \"mass\": "
                   "100000000000000000000, \"position\": [-0, 1e2, 0], \"shape\": {\"type\": "
                   "\"sphere\", \"radius\": 1}}]}");
    assert_close(scene.bodies[0].mass, 1e20, 0, 0);
    assert_true(signbit(scene.bodies[0].position[0]));
    assert_close(scene.bodies[0].position[1], 100, 0, 0);
    pl_scene_free(&scene);
}

static void test_forces_of_code_are_written_with_their_bodies(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    const pl_material material = {.name = "m"};
    assert_int_equal(pl_scene_add_material(&scene, &material, NULL, NULL), PL_OK);
    for (int i = 0; i < 3; ++i) {
        pl_body body = pl_body_default();
        snprintf(body.name, sizeof body.name, "%d", i);
        body.shape = pl_shape_sphere(1);
        assert_int_equal(pl_scene_add_body(&scene, &body, NULL, NULL), PL_OK);
    }
    static const int bodies[] = {2, 0, 2, 0, 2}, in_order[] = {1, 3, 0, 2, 4};
    for (int i = 0; i < 5; ++i) {
        const pl_force force = {.body = bodies[i], .force = {i, 0, 0}, .until = HUGE_VAL};
        assert_int_equal(pl_scene_add_force(&scene, &force, NULL), PL_OK);
    }
    char *text = pl_scene_to_text(&scene);
    pl_scene again = read_scene(text);
    assert_int_equal(again.force_count, 5);
    for (int i = 0; i < 5; ++i) {
        assert_int_equal(again.forces[i].body, bodies[in_order[i]]);
        assert_close(again.forces[i].force[0], in_order[i], 0, 0);
    }
    free(text);
    pl_scene_free(&scene);
    pl_scene_free(&again);
}

/* The smallest change that a double can have changes the hash; reading and writing does not. */
static void test_hash_tells_scenes_apart_by_one_bit(void **state)
{
    (void)state;
    char first[17], second[17], third[17];
    pl_scene scene = read_scene(sample_scene);
    assert_int_equal(pl_scene_hash(&scene, first, NULL), PL_OK);
    assert_int_equal(strlen(first), 16);
    assert_int_equal(strspn(first, "0123456789abcdef"), 16);
    scene.bodies[1].position[1] = nextafter(scene.bodies[1].position[1], 3);
    assert_int_equal(pl_scene_hash(&scene, second, NULL), PL_OK);
    assert_string_not_equal(first, second);
    scene.bodies[1].position[1] = 2;
    assert_int_equal(pl_scene_hash(&scene, third, NULL), PL_OK);
    assert_string_equal(first, third);
    pl_scene_free(&scene);
}

static json_t *load_schema(void)
{
    json_error_t error;
    json_t *schema = json_load_file(PLUMB_SOURCE_DIR "/scenarios/scene.schema.json",
                                    JSON_REJECT_DUPLICATES, &error);
    if (schema == NULL) {
        fail_msg("%s:%d:%d: %s", error.source, error.line, error.column, error.text);
    }
    return schema;
}

static const json_t *object_schema(const json_t *schema, int kind)
{
    const json_t *definition =
        kind == PL_OBJECT_SCENE
            ? schema
            : json_object_get(json_object_get(schema, "$defs"), pl_objects[kind].name);
    assert_non_null(definition);
    return definition;
}

static void test_schema_has_exactly_the_reader_keys(void **state)
{
    (void)state;
    json_t *schema = load_schema();
    for (int kind = 0; kind < PL_OBJECT_COUNT; ++kind) {
        const pl_object *object = &pl_objects[kind];
        const json_t *definition = object_schema(schema, kind);
        const json_t *properties = json_object_get(definition, "properties");
        assert_true(json_is_false(json_object_get(definition, "additionalProperties")));
        assert_int_equal(json_object_size(properties), object->field_count);
        for (int i = 0; i < object->field_count; ++i) {
            if (json_object_get(properties, object->fields[i].key) == NULL) {
                fail_msg("the schema's %s has no %s", object->name, object->fields[i].key);
            }
        }
    }
    json_decref(schema);
}

static void test_schema_has_the_reader_s_metrics_and_limits(void **state)
{
    (void)state;
    json_t *schema = load_schema();
    const json_t *properties =
        json_object_get(object_schema(schema, PL_OBJECT_EXPECT), "properties");
    const json_t *metrics = json_object_get(json_object_get(properties, "primary"), "enum");
    int count;
    const char *const *names = pl_primary_errors(&count);
    assert_int_equal(json_array_size(metrics), count + 1);
    assert_string_equal(json_string_value(json_array_get(metrics, 0)), "");
    for (int i = 0; i < count; ++i) {
        assert_string_equal(json_string_value(json_array_get(metrics, (size_t)i + 1)), names[i]);
    }
    properties = json_object_get(schema, "properties");
    const json_t *bodies = json_object_get(properties, "bodies");
    const json_t *materials = json_object_get(properties, "materials");
    assert_int_equal(json_integer_value(json_object_get(bodies, "maxItems")), PL_MAX_BODIES);
    assert_int_equal(json_integer_value(json_object_get(materials, "maxProperties")),
                     PL_MAX_MATERIALS);
    json_decref(schema);
}

static void test_every_primary_error_is_a_metric(void **state)
{
    (void)state;
    int count;
    const char *const *names = pl_primary_errors(&count);
    for (int i = 0; i < count; ++i) {
        assert_true(pl_metric_by_name(names[i]) >= 0);
    }
}

/* The instance of each kind of object in the sample; `json` is borrowed. */
static json_t *sample_object(json_t *sample, int kind)
{
    json_t *bodies = json_object_get(sample, "bodies");
    json_t *expect = json_object_get(sample, "expect");
    json_t *body = json_array_get(bodies, 1);
    switch (kind) {
    case PL_OBJECT_SCENE:
        return sample;
    case PL_OBJECT_MATERIAL:
        return json_object_get(json_object_get(sample, "materials"), "wood");
    case PL_OBJECT_PAIR:
        return json_array_get(json_object_get(sample, "pairs"), 0);
    case PL_OBJECT_BODY:
        return body;
    case PL_OBJECT_PLANE:
        return json_object_get(json_array_get(bodies, 0), "shape");
    case PL_OBJECT_BOX:
        return json_object_get(body, "shape");
    case PL_OBJECT_SPHERE:
        return json_object_get(json_array_get(bodies, 2), "shape");
    case PL_OBJECT_CAPSULE:
        return json_object_get(json_object_get(sample, "shapes"), "pill");
    case PL_OBJECT_CYLINDER:
        return json_object_get(json_object_get(sample, "shapes"), "can");
    case PL_OBJECT_HULL:
        return json_object_get(json_object_get(sample, "shapes"), "stone");
    case PL_OBJECT_MESH:
        return json_object_get(json_object_get(sample, "shapes"), "wedge");
    case PL_OBJECT_FORCE:
        return json_array_get(json_object_get(body, "forces"), 0);
    case PL_OBJECT_EXPECT:
        return expect;
    case PL_OBJECT_REST:
        return json_array_get(json_object_get(expect, "rest"), 0);
    case PL_OBJECT_TRAVEL:
        return json_array_get(json_object_get(expect, "travel"), 0);
    case PL_OBJECT_STATISTIC:
        return json_array_get(json_object_get(expect, "statistics"), 0);
    default:
        return json_array_get(json_object_get(expect, "values"), 0);
    }
}

static pl_status read_status(const json_t *json)
{
    char *text = json_dumps(json, JSON_COMPACT);
    assert_non_null(text);
    pl_scene scene;
    pl_status status = pl_scene_read_text(text, strlen(text), "scene", &scene, NULL);
    pl_scene_free(&scene);
    free(text);
    return status;
}

static bool is_required(const json_t *definition, const char *key)
{
    size_t i;
    json_t *item;
    json_array_foreach(json_object_get(definition, "required"), i, item)
    {
        if (strcmp(json_string_value(item), key) == 0) {
            return true;
        }
    }
    return false;
}

/* Mass is needed unless there is density, vertices and triangles unless there is a file: conditions
 * that `required` cannot say. The materials are needed by the sample's own references. */
static bool is_needed_here(int kind, const char *key)
{
    return (kind == PL_OBJECT_BODY && strcmp(key, "mass") == 0) ||
           (kind == PL_OBJECT_MESH && strcmp(key, "file") != 0) ||
           (kind == PL_OBJECT_SCENE && strcmp(key, "materials") == 0);
}

static void test_reader_and_schema_require_the_same_fields(void **state)
{
    (void)state;
    json_t *schema = load_schema();
    for (int kind = 0; kind < PL_OBJECT_COUNT; ++kind) {
        const json_t *definition = object_schema(schema, kind);
        for (int i = 0; i < pl_objects[kind].field_count; ++i) {
            const char *key = pl_objects[kind].fields[i].key;
            json_t *sample = json_loads(sample_scene, 0, NULL);
            json_object_del(sample_object(sample, kind), key);
            bool needed = is_required(definition, key) || is_needed_here(kind, key);
            if (read_status(sample) != (needed ? PL_BAD_INPUT : PL_OK)) {
                fail_msg("%s without %s is %s", pl_objects[kind].name, key,
                         needed ? "accepted" : "refused");
            }
            json_decref(sample);
        }
    }
    json_decref(schema);
}

/* No field accepts an empty object, except objects whose fields are all optional. */
static void test_reader_refuses_the_wrong_type_of_every_field(void **state)
{
    (void)state;
    for (int kind = 0; kind < PL_OBJECT_COUNT; ++kind) {
        for (int i = 0; i < pl_objects[kind].field_count; ++i) {
            const char *key = pl_objects[kind].fields[i].key;
            const bool may_be_empty = kind == PL_OBJECT_SCENE &&
                                      (strcmp(key, "expect") == 0 || strcmp(key, "shapes") == 0 ||
                                       strcmp(key, "parameters") == 0); /* all optional */
            json_t *sample = json_loads(sample_scene, 0, NULL);
            json_object_set_new(sample_object(sample, kind), key, json_object());
            if (!may_be_empty && read_status(sample) != PL_BAD_INPUT) {
                fail_msg("%s: {} is accepted as %s", pl_objects[kind].name, key);
            }
            json_decref(sample);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sample_reads_as_written),
        cmocka_unit_test(test_text_that_is_cut_short_is_refused),
        cmocka_unit_test(test_scene_hash_is_that_of_its_text),
        cmocka_unit_test(test_text_that_is_no_json_is_refused),
        cmocka_unit_test(test_written_sample_reads_back),
        cmocka_unit_test(test_random_scenes_read_back_number_for_number),
        cmocka_unit_test(test_expectations_that_differ_from_their_defaults_read_back),
        cmocka_unit_test(test_default_material_is_created_at_most_once),
        cmocka_unit_test(test_what_is_left_out_has_the_defaults),
        cmocka_unit_test(test_default_primary_error_is_travel_before_rest),
        cmocka_unit_test(test_only_almost_unit_quaternions_are_normalised),
        cmocka_unit_test(test_whole_numbers_of_any_size_are_numbers),
        cmocka_unit_test(test_forces_of_code_are_written_with_their_bodies),
        cmocka_unit_test(test_hash_tells_scenes_apart_by_one_bit),
        cmocka_unit_test(test_schema_has_exactly_the_reader_keys),
        cmocka_unit_test(test_schema_has_the_reader_s_metrics_and_limits),
        cmocka_unit_test(test_every_primary_error_is_a_metric),
        cmocka_unit_test(test_reader_and_schema_require_the_same_fields),
        cmocka_unit_test(test_reader_refuses_the_wrong_type_of_every_field),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
