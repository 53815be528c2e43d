/* Bodies of the usual form are read without a tree of JSON: with the same scene, to the bit, and the
 * same messages as all others. */
#include "base/json_scan.h"
#include "base/text_buffer.h"
#include "check.h"
#include "plumb/scene.h"
#include "scene/scene_scan.h"
#include "scene_equal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A whole number from 0 to below `count`. */
static int pick(check_random *random, int count)
{
    return (int)check_uniform(random, 0, count);
}

/* Scans a number that is all of the text. */
static bool scan_number(const char *text, double *value)
{
    pl_json_scanner scanner = {text, text + strlen(text)};
    return pl_json_scan_number(&scanner, value) && scanner.at == scanner.end;
}

static void check_number(const char *text)
{
    double value = 0;
    const double expected = strtod(text, NULL);
    if (!scan_number(text, &value) || value != expected || signbit(value) != signbit(expected)) {
        fail_msg("%s was read as %.17g, not %.17g", text, value, expected);
    }
}

static void test_numbers_are_rounded_to_the_nearest_double(void **state)
{
    (void)state;
    check_random random = {7};
    char text[80];
    for (int i = 0; i < 300000; ++i) {
        const int whole = 1 + pick(&random, 12), places = pick(&random, 14);
        int at = sprintf(text, "%s%d", i % 2 == 0 ? "" : "-", 1 + pick(&random, 9));
        for (int k = 1; k < whole; ++k) {
            text[at++] = (char)('0' + pick(&random, 10));
        }
        at += sprintf(text + at, "%s", places == 0 ? "" : ".");
        for (int k = 0; k < places; ++k) {
            text[at++] = (char)('0' + pick(&random, 10));
        }
        text[at] = '\0';
        if (i % 5 == 0) {
            sprintf(
                text + at, "%c%s%d", "eE" [pick(&random, 2)],
                (const char *[]) { "", "+", "-" }[pick(&random, 3)], pick(&random, 60));
        }
        check_number(text);
    }
}

/* Middles between two doubles, and one unit of the last place to either side. */
static void test_ties_are_rounded_to_even(void **state)
{
    (void)state;
    check_random random = {9};
    for (int i = 0; i < 100000; ++i) {
        const int bits = 1 + pick(&random, 3); /* after the point */
        const uint64_t power = UINT64_C(1) << bits;
        const uint64_t odd = 1 + 2 * (uint64_t)check_uniform(&random, 0x1p52, 0x1p53); /* 54 bits */
        const uint64_t places = bits == 1 ? 10 : bits == 2 ? 100 : 1000;
        char text[80];
        for (int shift = -1; shift <= 1; ++shift) {
            const uint64_t rest = odd % power * (places / power) + (uint64_t)shift;
            sprintf(text, "%llu.%0*llu", (unsigned long long)(odd / power), bits,
                    (unsigned long long)rest);
            check_number(text);
        }
    }
}

static void test_numbers_at_the_edges(void **state)
{
    (void)state;
    static const char *const right[] = {
        "0",
        "-0",
        "-0.0",
        "0e5",
        "9007199254740992",
        "9007199254740993",
        "9007199254740993.0",
        "9223372036854776833",
        "18446744073709551615",
        "9999999999999999999",
        "0.9999999999999999999",
        "1.0000000000000000000",
        "0.00000000000000000000000001",
        "123456789012345678901234567890",
        "2.2250738585072011e-308",
        "4.9e-324",
        "1e-400",
        "1.7976931348623157e308",
    };
    static const char *const wrong[] = {"",         "-",    "+1",  "01",  "-01",   "1.",
                                        ".5",       "1e",   "1e+", "0x1", "1e999", "nan",
                                        "Infinity", "1.5.", "1,",  "--1"};
    for (size_t i = 0; i < sizeof right / sizeof right[0]; ++i) {
        check_number(right[i]);
    }
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        double value;
        assert_false(scan_number(wrong[i], &value));
    }
}

/* ---- Bodies ---- */

/* A key of a body and values for it, the first of which is the usual one. */
typedef struct entry {
    const char *key;
    const char *values[8];
} entry;

static const entry entries[] = {
    {"mass", {"2.5", "1e3", "-0", "1e999", "\"2\"", "0", "null"}},
    {"shape",
     {"{\"type\": \"sphere\", \"radius\": 0.1234567890123456}",
      "{\"type\": \"box\", \"half_extents\": [0.5, 1, 0.25]}", "\"ball\"", "\"bell\"", "\"ground\"",
      "{\"radius\": 1, \"type\": \"sphere\"}", "{\"type\": \"sphere\"}",
      "{\"type\": \"sphere\", \"radius\": 1, \"radius\": 1}"}},
    {"position", {"[1, -2.5, 3e-5]", "[ 0 ,-0,0 ]", "[1, 2]", "[1, 2, 3, 4]", "[1 2 3]"}},
    {"orientation", {"[1, 0, 0, 0]", "[0.6, 0, 0.8000001, 0]", "[1, 1, 0, 0]", "[0.6, 0, .8, 0]"}},
    {"material", {"\"ice\"", "\"\\u0069ce\"", "\"iced\"", "5"}},
    {"inertia", {"[1, 1.5, 1]", "[0, 0, 0]", "[0.1, 0.1, 10]"}},
    {"velocity", {"[1, 2, 3]", "[1e400, 0, 0]", "{}"}},
    {"angular_velocity", {"[0.1, 0.2, 0.30000000000000004]"}},
    {"static", {"false", "true", "\"no\""}},
    {"forces", {"[]", "[{\"force\": [1, 0, 0]}]"}},
    {"density", {"3"}},
    {"weight", {"3"}},
};

enum { ENTRIES = sizeof entries / sizeof entries[0] };

/* Adds a body with some of the entries, most with their usual value, in any order. `name` is how its
 * key is spelled. */
static void add_body(pl_text_buffer *text, check_random *random, const char *name, int number)
{
    const int first = pick(random, ENTRIES);
    const bool is_usual = pick(random, 4) > 0;
    pl_text_format(text, "%s{\"%s\": \"b%d\"", number == 0 ? "" : ", ", name, number);
    for (int i = 0; i < ENTRIES; ++i) {
        const entry *e = &entries[(first + i) % ENTRIES];
        int values = 0;
        while (values < 8 && e->values[values] != NULL) {
            ++values;
        }
        const bool is_required = e < &entries[2];
        const bool is_rare = e >= &entries[8];
        if (pick(random, 20) < (is_required ? 19 : is_rare ? 1 : 10)) {
            const int value = is_usual || pick(random, 4) > 0 ? 0 : pick(random, values);
            pl_text_format(text, "%s\"%s\":%s%s", pick(random, 9) == 0 ? ",\n\t" : ", ", e->key,
                           pick(random, 9) == 0 ? " \r\n" : " ", e->values[value]);
        }
    }
    pl_text_add(text, pick(random, 60) == 0 ? ",}" : "}");
}

/* A scene of three random bodies. */
static char *random_scene(uint64_t seed, const char *name)
{
    check_random random = {seed};
    pl_text_buffer text = {0};
    pl_text_add(&text, "{\"plumb_scene\": 1, \"materials\": {\"ice\": {\"friction\": 0.1, "
                       "\"restitution\": 0}}, \"shapes\": {\"ball\": {\"type\": \"sphere\", "
                       "\"radius\": 0.3}, \"ground\": {\"type\": \"plane\", \"normal\": "
                       "[0, 0, 1], \"offset\": 0}}, \"bodies\": [");
    for (int i = 0; i < 3; ++i) {
        add_body(&text, &random, name, i);
    }
    pl_text_add(&text, "]}");
    return text.data;
}

/* A message without its column, which the spelling of a key moves. */
static const char *without_place(const char *message)
{
    const char *place = strstr(message, ": ");
    return place == NULL ? message : place;
}

/* A key with an escape is not of the usual form, so that the body goes by way of a tree. */
static void test_spelling_of_a_key_changes_nothing(void **state)
{
    (void)state;
    int right = 0, wrong = 0;
    for (uint64_t seed = 1; seed <= 20000; ++seed) {
        pl_scene scenes[2];
        pl_error errors[2] = {{.status = PL_OK}};
        pl_status status[2];
        for (int k = 0; k < 2; ++k) {
            char *text = random_scene(seed * 7919, k == 0 ? "name" : "n\\u0061me");
            status[k] = pl_scene_read_text(text, strlen(text), "text", &scenes[k], &errors[k]);
            free(text);
        }
        assert_int_equal(status[0], status[1]);
        if (status[0] == PL_OK) {
            assert_same_scene(&scenes[0], &scenes[1]);
            pl_scene_free(&scenes[0]);
            pl_scene_free(&scenes[1]);
            ++right;
        } else {
            assert_string_equal(without_place(errors[0].message), without_place(errors[1].message));
            ++wrong;
        }
    }
    assert_true(right > 2000 && wrong > 2000);
}

/* Whether a body is read from its text, and to its last byte. */
static bool is_scanned(const char *text)
{
    pl_scene scene = read_scene("{\"plumb_scene\": 1, \"materials\": {\"ice\": {\"friction\": 0.1, "
                                "\"restitution\": 0}}, \"bodies\": [{\"name\": \"floor\", "
                                "\"shape\": {\"type\": \"plane\", \"normal\": [0, 0, 1], "
                                "\"offset\": 0}}]}");
    const pl_shape_reader shapes = {.scene = &scene};
    pl_json_scanner scanner = {text, text + strlen(text)};
    pl_body body;
    const bool scanned = pl_scan_body(&scanner, &shapes, &body) && scanner.at == scanner.end;
    pl_scene_free(&scene);
    return scanned;
}

#define BALL "\"shape\": {\"type\": \"sphere\", \"radius\": 1}"
#define PLANE "\"shape\": {\"type\": \"plane\", \"normal\": [0, 0, 1], \"offset\": 0}"
#define CYLINDER "\"shape\":{\"type\":\"cylinder\",\"radius\":1,\"half_height\":2}"

static void test_usual_bodies_need_no_tree(void **state)
{
    (void)state;
    assert_true(is_scanned("{\"name\": \"a\", \"mass\": 1, \"material\": \"ice\", " BALL
                           ", \"position\": [0, 0, 1], \"orientation\": [1, 0, 0, 0]}"));
    assert_true(is_scanned(
        "{\"mass\":1,\"static\":false,\"name\":\"a\",\"inertia\":[1,1,1]," CYLINDER "}"));
    /* One that is cut short, and one with more behind it. */
    assert_false(is_scanned("{\"name\": \"a\", \"mass\": 1, " BALL));
    assert_false(is_scanned("{\"name\": \"a\", \"mass\": 1, " BALL "} "));
    assert_false(is_scanned("{\"name\": \"a\", " BALL "}"));
    assert_false(is_scanned("{\"name\": \"a\", \"name\": \"a\", \"mass\": 1, " BALL "}"));
    assert_false(is_scanned("{\"name\": \"\303\251\", \"mass\": 1, " BALL "}"));
    assert_false(is_scanned("{\"name\": \"\", \"mass\": 1, " BALL "}"));
    assert_false(is_scanned("{\"name\": \"a\", \"static\": true, " BALL "}"));
    assert_false(is_scanned("{\"name\": \"a\", \"mass\": 1, " PLANE "}"));
    assert_false(is_scanned("{}"));
    assert_false(is_scanned(""));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers_are_rounded_to_the_nearest_double),
        cmocka_unit_test(test_ties_are_rounded_to_even),
        cmocka_unit_test(test_numbers_at_the_edges),
        cmocka_unit_test(test_spelling_of_a_key_changes_nothing),
        cmocka_unit_test(test_usual_bodies_need_no_tree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
