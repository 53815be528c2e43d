/* What is wrong with a scene file is said with its line, column and field. Each case changes the
 * sample scene at one place and marks with an @, which is taken out, where the fault is: so the
 * expected line and column are counted here, not copied from the reader. */
#include "check.h"
#include "plumb/scene.h"
#include "sample_scene.h"
#include "text_fault.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void check_message(const char *text, int line, int column, const char *path,
                          const char *part)
{
    pl_scene scene;
    pl_error error = {.status = PL_OK};
    char expected[256];
    snprintf(expected, sizeof expected, "bad.json:%d:%d: %s: ", line, column, path);
    assert_int_equal(pl_scene_read_text(text, strlen(text), "bad.json", &scene, &error),
                     PL_BAD_INPUT);
    assert_int_equal(error.status, PL_BAD_INPUT);
    if (strncmp(error.message, expected, strlen(expected)) != 0) {
        fail_msg("\"%s\"\n  does not begin with \"%s\"", error.message, expected);
    }
    assert_contains(error.message, part);
    assert_contains(error.message, "found");
    assert_null(scene.bodies); /* left empty */
}

static void check_fault(const text_fault *item)
{
    char *text = text_with(sample_scene, item->from, item->to);
    int line, column;
    take_mark(text, &line, &column);
    check_message(text, line, column, item->path, item->part);
    free(text);
}

static void check_faults(const text_fault *faults, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        check_fault(&faults[i]);
    }
}

static void test_syntax_errors_are_located(void **state)
{
    (void)state;
    static const text_fault faults[] = {
        {"0.01,", "@NaN,", "JSON syntax", "NaN"},
        {"0.01,", "@1e999,", "JSON syntax", "overflow"},
        {"0.01,", "@Infinity,", "JSON syntax", "invalid token"},
        {"0.01,\n  \"duration\"", "0.01\n  @\"duration\"", "JSON syntax", "'}' expected"},
        {"\"dt\": 0.01", "\"dt\": 0.01, @\"dt\": 0.02", "JSON syntax", "duplicate object key"},
        {"\"mass\": 2", "\"mass\": 2, @\"m\\u0061ss\": 2", "JSON syntax", "duplicate object key"},
        {"\"name\": \"ball\"", "\"name\": \"b@\xff\"", "JSON syntax", "0xff"},
        {"\"name\": \"ball\"", "\"name\": @\"ba\nll\"", "JSON syntax", "newline"},
        {"\"name\": \"ball\"", "\"name\": @\"\\u0000\"", "JSON syntax", "NUL"},
        {"    \"collapse_distance\": 0.5\n  }\n}\n", "    \"collapse_distance\": 0.5\n  }\n} @{",
         "JSON syntax", "end of file expected"},
        {"    \"collapse_distance\": 0.5\n  }\n}\n", "    \"collapse_distance\": 0.5\n  @",
         "JSON syntax", "end of file"},
        {"[1, 2, 3]", "[1, 2, 3@}", "JSON syntax", "']' expected"},
        {"[1, 2, 3]", "[1, 2, @01]", "JSON syntax", "invalid token"},
    };
    check_faults(faults, sizeof faults / sizeof faults[0]);
}

static void test_empty_and_foreign_texts_are_located(void **state)
{
    (void)state;
    check_message("", 1, 1, "scene", "empty file");
    check_message(" \n\t\n", 1, 1, "scene", "empty file");
    check_message("[]", 1, 1, "scene", "expected an object, found an array of 0");
    check_message("\n  [1]", 2, 3, "scene", "an array of 1");
    check_message("3", 1, 1, "JSON syntax", "'[' or '{' expected");
    check_message("{}", 1, 1, "plumb_scene", "expected 1 or 2, found nothing");
    check_message("{\"plumb_scene\": 1}", 1, 1, "bodies", "expected an array, found nothing");
    check_message("{\"plumb_scene\": 1, \"bodies\": []}", 1, 30, "bodies", "found 0");
    check_message("\xef\xbb\xbf{}", 1, 1, "plumb_scene", "expected 1 or 2, found nothing");
    check_message("\xef\xbb\xbf\xef\xbb\xbf{}", 1, 1, "JSON syntax", "expected");
}

static void test_deep_nesting_is_refused(void **state)
{
    (void)state;
    enum { DEPTH = 100000 };
    char *text = malloc(DEPTH + 1);
    assert_non_null(text);
    memset(text, '[', DEPTH);
    text[DEPTH] = '\0';
    check_message(text, 1, 2049, "JSON syntax", "depth");
    free(text);
}

static void test_keys_are_located(void **state)
{
    (void)state;
    static const text_fault faults[] = {
        {"\"dt\": 0.01,", "\"dt\": 0.01, @\"colour\": 1,", "colour", "expected one of plumb_scene"},
        {"\"gravity\"", "@\"gravty\"", "gravty", "did you mean \"gravity\"?"},
        {"\"plumb_scene\": 1,\n  \"name\": \"é", "\"plumb_scene\": 1,\n  @\"é\": 1, \"name\": \"é",
         "[\"é\"]", "expected one of"},
        {"\"friction\": 0.5", "\"friction\": 0.5, @\"grip\": 1", "materials.wood.grip", "\"grip\""},
        {"\"restitution\": 0.125", "\"restitution\": 0.125, @\"c\": 1", "pairs[0].c", "\"c\""},
        {"\"mass\": 2", "\"mass\": 2, @\"weight\": 20", "bodies[1].weight", "\"weight\""},
        {"\"radius\": 0.2", "\"radius\": 0.2, @\"half_extents\": [1, 1, 1]",
         "bodies[2].shape.half_extents", "expected one of type, radius"},
        {"\"until\": 2", "@\"til\": 2", "bodies[1].forces[0].til", "\"til\""},
        {"\"primary\"", "@\"primry\"", "expect.primry", "did you mean \"primary\"?"},
        {"\"position\": [1, 2, 0]", "\"position\": [1, 2, 0], @\"when\": 1", "expect.rest[0].when",
         "\"when\""},
        {"\"distance\": 4", "\"distance\": 4, @\"spee\\u0064\": 1", "expect.travel[0].speed",
         "\"speed\""},
        /* A missing key is at the object that lacks it. */
        {"{\n  \"plumb_scene\": 1,", "@{", "plumb_scene", "expected 1 or 2, found nothing"},
        {"{ \"friction\": 0.5, ", "@{ ", "materials.wood.friction", "a number, found nothing"},
        {"{ \"a\": \"wood\", ", "@{ ", "pairs[0].a", "a material, found nothing"},
        {"{ \"name\": \"kåse\", \"mass\": 2,", "@{ \"name\": \"kåse\",", "bodies[1].mass",
         "either mass or density of a body that is not static, found neither"},
        {"{ \"name\": \"ball\",", "@{ ", "bodies[2].name", "a name, found nothing"},
        {"    { \"name\": \"ball\", \"density\": 100,\n"
         "      \"shape\": { \"type\": \"sphere\", \"radius\": 0.2 } }",
         "@{ \"name\": \"ball\" }", "bodies[2].shape",
         "an object or the name of a shape, found nothing"},
        {"{ \"type\": \"sphere\", \"radius\": 0.2 }", "@{ \"type\": \"sphere\" }",
         "bodies[2].shape.radius", "a number, found nothing"},
        {"{ \"force\": [1, 0, 0] }", "@{ }", "bodies[1].forces[1].force",
         "an array of 3 numbers, found nothing"},
        {"{ \"body\": \"ball\", \"direction\": [1, 0, 0],", "@{ \"body\": \"ball\",",
         "expect.travel[0].direction", "an array of 3 numbers, found nothing"},
        /* Keys that have no meaning where they stand. */
        {"\"static\": true,", "\"static\": true, @\"mass\": 3,", "bodies[0].mass",
         "of a static body, found 3"},
        {"\"static\": true,", "\"static\": true, @\"position\": [0, 0, 1],", "bodies[0].position",
         "by its shape's normal and offset, found an array of 3"},
        {"\"static\": true,", "\"static\": true, @\"orientation\": [1, 0, 0, 0],",
         "bodies[0].orientation", "normal and offset"},
        {"\"mass\": 2", "\"mass\": 2, @\"density\": 1", "bodies[1].density", "found both"},
    };
    check_faults(faults, sizeof faults / sizeof faults[0]);
}

static void test_types_and_lengths_are_located(void **state)
{
    (void)state;
    static const text_fault faults[] = {
        {"\"plumb_scene\": 1", "\"plumb_scene\": @3", "plumb_scene", "expected 1 or 2, found 3"},
        {"\"plumb_scene\": 1", "\"plumb_scene\": @\"1\"", "plumb_scene", "found \"1\""},
        {"\"é scène\"", "@7", "name", "a name, found 7"},
        {"[0, 0.5, -9.81]", "@9.81", "gravity", "an array of 3 numbers, found 9.81"},
        {"[0, 0.5, -9.81]", "@[0, -9.81]", "gravity", "3 numbers, found an array of 2"},
        {"[0, 0.5, -9.81]", "[0, @\"g\", -9.81]", "gravity[1]", "no parameters, found \"g\""},
        {"0.01,", "@true,", "dt", "a number, found true"},
        {"\"duration\": 2", "\"duration\": @null", "duration", "a number, found null"},
        {"{ \"friction\": 0.5, \"restitution\": 0 }", "@0.5", "materials.wood",
         "an object, found 0.5"},
        {"{ \"friction\": 0.25, \"restitution\": 0.75 }", "@[]", "materials[\"stål\"]",
         "an object, found an array of 0"},
        {"\"b\": \"stål\"", "\"b\": @{}", "pairs[0].b", "a material, found an object"},
        {"\"static\": true", "\"static\": @1", "bodies[0].static", "true or false, found 1"},
        {"\"static\": true", "\"static\": @false", "bodies[0].static",
         "since a plane never moves, found false"},
        {"\"mass\": 2", "\"mass\": @\"2 kg\"", "bodies[1].mass",
         "or the end, found 'k' at character 3 of \"2 kg\""},
        {"[0.6, 0, 0.8, 0]", "@[0, 0, 0]", "bodies[1].orientation",
         "4 numbers, found an array of 3"},
        {"\"sphere\"", "@\"cone\"", "bodies[2].shape.type",
         "expected plane, sphere, box, capsule, cylinder, hull or mesh, found \"cone\""},
        {"\"sphere\"", "@\"a\\u0001\\\"\"", "bodies[2].shape.type", "found \"a?\"\""},
        {"{ \"type\": \"sphere\", \"radius\": 0.2 }", "@\"sphere\"", "bodies[2].shape",
         "expected the name of a shape, found \"sphere\""},
        {"\"body\", \"from\"", "@\"local\", \"from\"", "bodies[1].forces[0].frame",
         "world or body, found \"local\""},
        {"[ { \"body\": \"kåse\", \"position\": [1, 2, 0], \"orientation\": [1, 0, 0, 0] } ]",
         "@\"kåse\"", "expect.rest", "an array, found \"kåse\""},
        {"\"drift\"", "@\"drft\"", "expect.primary", "such as \"drift\", found \"drft\""},
        {"\"collapse_distance\": 0.5", "\"collapse_distance\": @\"far\"",
         "expect.collapse_distance", "a number; the scene has no parameters, found \"far\""},
    };
    check_faults(faults, sizeof faults / sizeof faults[0]);
}

static void test_numbers_out_of_range_are_located(void **state)
{
    (void)state;
    static const text_fault faults[] = {
        {"\"dt\": 0.01", "\"dt\": @0", "dt", "above 0, found 0"},
        {"\"dt\": 0.01", "\"dt\": @-0.01", "dt", "found -0.01"},
        {"\"duration\": 2", "\"duration\": @0.005", "duration", "at least dt, which is 0.01"},
        {"\"duration\": 2", "\"duration\": @100001", "duration", "at most 10000000 steps"},
        {"\"friction\": 0.5", "\"friction\": @-0.5", "materials.wood.friction", "found -0.5"},
        {"\"restitution\": 0.75", "\"restitution\": @1.5", "materials[\"stål\"].restitution",
         "from 0 to 1, found 1.5"},
        {"\"restitution\": 0.125", "\"restitution\": @-1", "pairs[0].restitution", "found -1"},
        {"\"mass\": 2", "\"mass\": @0", "bodies[1].mass", "above 0, found 0"},
        {"\"mass\": 2", "\"mass\": @-2", "bodies[1].mass", "found -2"},
        {"\"density\": 100", "\"density\": @0", "bodies[2].density", "above 0"},
        /* Values that follow from the shape have no place in the file: they are reported at the
           body. */
        {"{ \"name\": \"ball\", \"density\": 100,\n      \"shape\": { \"type\": \"sphere\", "
         "\"radius\": 0.2",
         "@{ \"name\": \"ball\", \"density\": 100,\n      \"shape\": { \"type\": \"sphere\", "
         "\"radius\": 1e200",
         "bodies[2].mass", "found inf"},
        {"{ \"name\": \"ball\", \"density\": 100,\n      \"shape\": { \"type\": \"sphere\", "
         "\"radius\": 0.2",
         "@{ \"name\": \"ball\", \"mass\": 100,\n      \"shape\": { \"type\": \"sphere\", "
         "\"radius\": 1e200",
         "bodies[2].inertia", "found [inf, inf, inf]"},
        {"[0.3, 0.4, 0.5]", "@[0.3, 0.4, 0.8]", "bodies[1].inertia",
         "none larger than the sum of the other two, found [0.3, 0.4, 0.8]"},
        {"[0.3, 0.4, 0.5]", "@[0, 0, 0]", "bodies[1].inertia", "above 0"},
        {"[0.3, 0.4, 0.5]", "@[1, -1, 1]", "bodies[1].inertia", "above 0"},
        {"\"radius\": 0.2", "\"radius\": @-0.2", "bodies[2].shape.radius", "found -0.2"},
        {"[0.5, 0.25, 0.75]", "[0.5, @0, 0.75]", "bodies[1].shape.half_extents[1]", "found 0"},
        {"[0, 0, 1]", "@[0, 0, 1.00001]", "bodies[0].shape.normal",
         "unit vector, found one of norm"},
        {"[0.6, 0, 0.8, 0]", "@[0.6, 0, 0.8, 0.1]", "bodies[1].orientation", "unit quaternion"},
        {"[0.6, 0, 0.8, 0]", "@[0, 0, 0, 0]", "bodies[1].orientation", "norm 0"},
        {"[0.6, 0, 0.8, 0]", "@[1e200, 0, 0, 0]", "bodies[1].orientation", "norm inf"},
        {"\"from\": 0.5", "\"from\": @-1", "bodies[1].forces[0].from", "at least 0, found -1"},
        {"\"until\": 2", "\"until\": @0.5", "bodies[1].forces[0].until",
         "after `from`, which is 0.5, found 0.5"},
        {"{ \"force\": [1, 0, 0] }", "{ \"force\": [1, 0, 0], \"until\": @-1 }",
         "bodies[1].forces[1].until", "found -1"},
        {"\"direction\": [1, 0, 0]", "\"direction\": @[1, 1, 0]", "expect.travel[0].direction",
         "unit vector"},
        {"\"distance\": 4", "\"distance\": @0", "expect.travel[0].distance", "other than 0"},
        {"\"discrete\": 4.5", "\"discrete\": @0", "expect.travel[0].discrete", "other than 0"},
        {"\"collapse_distance\": 0.5", "\"collapse_distance\": @0", "expect.collapse_distance",
         "above 0, found 0"},
        {"\"density\": 100,", "\"static\": true, \"velocity\": @[0, 0, 1],", "bodies[2].velocity",
         "a static body never moves"},
        {"\"density\": 100,", "\"static\": true, \"forces\": @[ { \"force\": [1, 0, 0] } ],",
         "bodies[2].forces", "no forces on a static body"},
    };
    check_faults(faults, sizeof faults / sizeof faults[0]);
}

static void test_names_and_references_are_located(void **state)
{
    (void)state;
    static const text_fault faults[] = {
        {"{ \"name\": \"ball\"",
         "{ \"name\": @\"kåse\", \"shape\": { \"type\": \"plane\", \"normal\": [1, 0, 0], "
         "\"offset\": 0 } }, { \"name\": \"ball\"",
         "bodies[2].name", "a name of its own, found \"kåse\", which item 1 has"},
        {"\"name\": \"ball\"", "\"name\": @\"\"", "bodies[2].name", "1 to 63 bytes, found 0"},
        {"\"name\": \"ball\"",
         "\"name\": @\"0123456789012345678901234567890123456789012345678901234567890123\"",
         "bodies[2].name", "found 64 bytes"},
        {"\"name\": \"ball\"", "\"name\": @\"a\\nb\"", "bodies[2].name", "control"},
        {"\"wood\": {", "@\"\": {", "materials[\"\"]", "found 0 bytes"},
        {"\"material\": \"wood\"", "\"material\": @\"wodo\"", "bodies[0].material",
         "found \"wodo\"; did you mean \"wood\"?"},
        {"\"material\": \"wood\"", "\"material\": @\"granite\"", "bodies[0].material",
         "the name of a material, found \"granite\""},
        {"\"a\": \"wood\"", "\"a\": @\"iron\"", "pairs[0].a", "found \"iron\""},
        {"0.125 }",
         "0.125 }, @{ \"a\": \"stål\", \"b\": \"wood\", \"friction\": 1, \"restitution\": 0 }",
         "pairs[1]", "each pair of materials once, found wood and stål again"},
        {"\"quantity\": \"apex\"", "\"quantity\": @\"appex\"", "expect.values[0].quantity",
         "top_speed, excursion or energy, found \"appex\""},
        {"\"from\": 0.5, \"until\": 1.25", "\"from\": @1.5, \"until\": 1.25",
         "expect.values[0].from", "0 to `until`"},
        {"\"until\": 1.25", "\"until\": @1e9", "expect.values[0].until", "within the run"},
        {"\"scale\": 2", "\"scale\": @0", "expect.values[0].scale", "above 0"},
        {"\"answer\": 3", "\"answer\": @1.5", "expect.values[0].answer",
         "a whole number of 0 to 8"},
        {"\"answer\": 3", "\"answer\": @9", "expect.values[0].answer", "a whole number of 0 to 8"},
        {"\"spread_y\"", "@\"spread_z\"", "expect.statistics[0].metric", "found \"spread_z\""},
        {"\"high\": 0.75", "\"high\": @0.25", "expect.statistics[0].high",
         "at least `low`, which is 0.5, found 0.25"},
        {"\"low\": 0.5", "\"low\": @\"half\"", "expect.statistics[0].low", "number"},
        {"\"scale\": 4", "\"scale\": @0", "expect.statistics[0].scale", "above 0"},
        {"\"body\": \"ball\"", "\"body\": @\"bell\"", "expect.travel[0].body",
         "found \"bell\"; did you mean \"ball\"?"},
        {"\"body\": \"kåse\"", "\"body\": @\"floor\"", "expect.rest[0].body",
         "a body with a position, found the plane floor"},
    };
    check_faults(faults, sizeof faults / sizeof faults[0]);
}

static void test_primary_error_needs_its_expectation(void **state)
{
    (void)state;
    char *text = text_with(sample_scene,
                           "\"rest\": [ { \"body\": \"kåse\", \"position\": [1, 2, 0], "
                           "\"orientation\": [1, 0, 0, 0] } ],",
                           "");
    char *changed = text_with(text, "\"drift\"", "@\"rest_rotation_error\"");
    int line, column;
    take_mark(changed, &line, &column);
    check_message(changed, line, column, "expect.primary", "expected `rest` next to");
    free(changed);
    free(text);
    text = text_with(sample_scene,
                     "\"statistics\": [ { \"metric\": \"spread_y\", \"low\": 0.5, \"high\": 0.75, "
                     "\"scale\": 4 } ],",
                     "");
    changed = text_with(text, "\"drift\"", "@\"statistics_error\"");
    take_mark(changed, &line, &column);
    check_message(changed, line, column, "expect.primary", "expected `statistics` next to");
    free(changed);
    free(text);
}

/* A file in a fresh directory. */
typedef struct scratch {
    char directory[64], path[128];
} scratch;

static scratch make_scratch(void)
{
    scratch s = {.directory = "/tmp/plumb-scene-XXXXXX"};
    assert_non_null(mkdtemp(s.directory));
    snprintf(s.path, sizeof s.path, "%s/scene.json", s.directory);
    return s;
}

static void remove_scratch(const scratch *s)
{
    unlink(s->path);
    rmdir(s->directory);
}

static void check_file(const char *path, const char *part)
{
    pl_scene scene;
    pl_error error = {.status = PL_OK};
    assert_int_equal(pl_scene_read_file(path, &scene, &error), PL_BAD_INPUT);
    if (strncmp(error.message, path, strlen(path)) != 0) {
        fail_msg("\"%s\" does not begin with %s", error.message, path);
    }
    assert_contains(error.message, part);
    assert_null(scene.bodies);
}

static void test_missing_file_and_directory_are_refused_by_name(void **state)
{
    (void)state;
    scratch s = make_scratch();
    check_file(s.path, "No such file");
    check_file(s.directory, "a directory");
    remove_scratch(&s);
}

static void test_file_beyond_the_limit_is_refused_unread(void **state)
{
    (void)state;
    scratch s = make_scratch();
    FILE *file = fopen(s.path, "wb");
    assert_non_null(file);
    /* A hole: it would take 2 GB of memory to read. */
    assert_int_equal(ftruncate(fileno(file), 2147483648L), 0);
    fclose(file);
    check_file(s.path, "at most 64 MiB, found 2147483648 bytes");
    remove_scratch(&s);
}

static void test_stream_beyond_the_limit_is_refused(void **state)
{
    (void)state;
    check_file("/dev/zero", "at most 64 MiB, found more");
}

static void test_file_reads_as_its_text_does(void **state)
{
    (void)state;
    scratch s = make_scratch();
    FILE *file = fopen(s.path, "wb");
    assert_non_null(file);
    assert_int_equal(fputs(sample_scene, file) >= 0, 1);
    fclose(file);
    pl_scene scene;
    pl_error error = {.message = ""};
    assert_int_equal(pl_scene_read_file(s.path, &scene, &error), PL_OK);
    assert_int_equal(scene.body_count, 3);
    pl_scene_free(&scene);
    remove_scratch(&s);
}

static void test_more_bodies_than_allowed_are_refused(void **state)
{
    (void)state;
    enum { ROOM = 100 };
    size_t count = PL_MAX_BODIES + 1;
    char *text = malloc(count * ROOM + ROOM);
    assert_non_null(text);
    char *end = text + sprintf(text, "{\"plumb_scene\": 1, \"bodies\": [");
    for (size_t i = 0; i < count; ++i) {
        end += sprintf(
            end, "%s{\"name\":\"%zu\",\"mass\":1,\"shape\":{\"type\":\"sphere\",\"radius\":1}}",
            i == 0 ? "" : ",", i);
    }
    strcpy(end, "]}");
    check_message(text, 1, 30, "bodies", "1 to 200000 bodies, found 200001");
    free(text);
}

/* Bytes that make or break JSON more often than others do. */
static char likely_byte(check_random *random)
{
    static const char likely[] = "{}[]:,\"\\0123456789.eE+-tfn \n@\x01\x80\xc3\xff";
    double choice = check_uniform(random, 0, 1);
    return choice < 0.2 ? (char)(int)check_uniform(random, 0, 127)
                        : likely[(size_t)check_uniform(random, 0, sizeof likely - 1)];
}

static size_t mutate(char *text, size_t length, check_random *random)
{
    size_t at = (size_t)check_uniform(random, 0, (double)length);
    size_t size = 1 + (size_t)check_uniform(random, 0, 4);
    size = at + size <= length ? size : length - at;
    double choice = check_uniform(random, 0, 1);
    if (choice < 0.35) {
        memmove(text + at, text + at + size, length - at - size);
        return length - size;
    }
    if (choice < 0.65) {
        memmove(text + at + 1, text + at, length - at);
        text[at] = likely_byte(random);
        return length + 1;
    }
    if (choice < 0.85) {
        text[at] = likely_byte(random);
        return length;
    }
    /* A copy of a piece of the text elsewhere. */
    size_t from = (size_t)check_uniform(random, 0, (double)(length - size));
    memmove(text + at, text + from, size);
    return length;
}

static void test_mutated_scene_is_valid_or_reported(void **state)
{
    (void)state;
    enum { ROUNDS = 20000, MOST_MUTATIONS = 4 };
    check_random random = {.state = 20240607};
    size_t length = strlen(sample_scene);
    int read = 0;
    for (int round = 0; round < ROUNDS; ++round) {
        /* Exactly as long as the text, so that a sanitizer sees a read beyond it. */
        char *text = malloc(length + MOST_MUTATIONS);
        assert_non_null(text);
        memcpy(text, sample_scene, length);
        size_t size = length;
        int mutations = 1 + (int)check_uniform(&random, 0, MOST_MUTATIONS);
        for (int i = 0; i < mutations; ++i) {
            size = mutate(text, size, &random);
        }
        char *exact = realloc(text, size);
        assert_non_null(exact);
        pl_scene scene;
        pl_error error = {.message = ""};
        pl_status status = pl_scene_read_text(exact, size, "fuzz", &scene, &error);
        if (status == PL_OK) {
            ++read;
            assert_int_equal(pl_scene_validate(&scene, NULL), PL_OK);
        } else {
            int line = 0, column = 0;
            assert_int_equal(status, PL_BAD_INPUT);
            if (sscanf(error.message, "fuzz:%d:%d: ", &line, &column) != 2 || line < 1 ||
                column < 1) {
                fail_msg("round %d: %s", round, error.message);
            }
        }
        pl_scene_free(&scene);
        free(exact);
    }
    /* Both outcomes are really tried. */
    assert_in_range(read, ROUNDS / 100, ROUNDS * 9 / 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_syntax_errors_are_located),
        cmocka_unit_test(test_empty_and_foreign_texts_are_located),
        cmocka_unit_test(test_deep_nesting_is_refused),
        cmocka_unit_test(test_keys_are_located),
        cmocka_unit_test(test_types_and_lengths_are_located),
        cmocka_unit_test(test_numbers_out_of_range_are_located),
        cmocka_unit_test(test_names_and_references_are_located),
        cmocka_unit_test(test_primary_error_needs_its_expectation),
        cmocka_unit_test(test_missing_file_and_directory_are_refused_by_name),
        cmocka_unit_test(test_file_beyond_the_limit_is_refused_unread),
        cmocka_unit_test(test_stream_beyond_the_limit_is_refused),
        cmocka_unit_test(test_file_reads_as_its_text_does),
        cmocka_unit_test(test_more_bodies_than_allowed_are_refused),
        cmocka_unit_test(test_mutated_scene_is_valid_or_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
