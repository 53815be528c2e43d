/* Wavefront .obj files: the good of tests/scenarios/obj/good are the solids that they say, in every
 * form; of the bad of tests/scenarios/obj/bad each is refused with its line, what was expected and
 * what was found. */
#include "base/number.h"
#include "check.h"
#include "plumb/vec.h"
#include "scene/mesh_file.h"
#include "scene/obj.h"
#include "scene/polyhedron.h"
#include "solid_for_tests.h"

#include <dirent.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GOOD PLUMB_SOURCE_DIR "/tests/scenarios/obj/good/"
#define BAD PLUMB_SOURCE_DIR "/tests/scenarios/obj/bad/"

static pl_polyhedron *read_good(const char *name)
{
    char path[512];
    pl_polyhedron *made = NULL;
    pl_error error = {.message = ""};
    snprintf(path, sizeof path, GOOD "%s.obj", name);
    if (pl_polyhedron_of_file(path, &made, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    return made;
}

static void check_good(const char *name, const solid_moments *expected, double relative)
{
    pl_polyhedron *made = read_good(name);
    known_check(made, expected, NULL, NULL, relative);
    pl_polyhedron_free(made);
}

static void check_boxes(const char *name, const double (*centres)[3], const double (*halves)[3],
                        const int *signs, int count)
{
    const solid_moments expected = known_moments_of_boxes(centres, halves, signs, count);
    check_good(name, &expected, 1e-14);
}

/* How many files of a folder end with ".obj" and begin with `beginning`. */
static int count_files(const char *folder, const char *beginning)
{
    DIR *listing = opendir(folder);
    assert_non_null(listing);
    int count = 0;
    const struct dirent *entry;
    while ((entry = readdir(listing)) != NULL) {
        const bool counts = strstr(entry->d_name, ".obj") != NULL &&
                            strncmp(entry->d_name, beginning, strlen(beginning)) == 0;
        count += counts ? 1 : 0;
    }
    closedir(listing);
    return count;
}

static void test_box_in_every_form_is_the_box(void **state)
{
    (void)state;
    static const char *const forms[] = {
        "box_byte_order_mark", "box_collinear", "box_crlf",           "box_forward",
        "box_inside_out",      "box_joined",    "box_mixed_winding",  "box_negative",
        "box_numbers",         "box_old_mac",   "box_quads",          "box_seams",
        "box_slashes",         "box_triangles", "box_weights_colours"};
    const double centre[3] = {1, 1.5, 2}, half[3] = {1, 1.5, 2};
    const int plus = 1, count = sizeof forms / sizeof forms[0];
    assert_int_equal(count, count_files(GOOD, "box_"));
    for (int i = 0; i < count; i++) {
        check_boxes(forms[i], &centre, &half, &plus, 1);
        pl_polyhedron *made = read_good(forms[i]);
        const bool has_extra = strcmp(forms[i], "box_collinear") == 0;
        assert_int_equal(made->vertex_count, has_extra ? 9 : 8);
        assert_int_equal(made->triangle_count, has_extra ? 14 : 12);
        pl_polyhedron_free(made);
    }
}

static void test_concave_faces_are_cut_into_the_whole_face(void **state)
{
    (void)state;
    const double l_centres[3][3] = {{0.5, 0.5, 0.5}, {1.5, 0.5, 0.5}, {0.5, 1.5, 0.5}};
    const double l_halves[3][3] = {{0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}};
    const double comb_centres[5][3] = {
        {3.5, 0.5, 0.5}, {0.5, 2, 0.5}, {2.5, 2, 0.5}, {4.5, 2, 0.5}, {6.5, 2, 0.5}};
    const double comb_halves[5][3] = {
        {3.5, 0.5, 0.5}, {0.5, 1, 0.5}, {0.5, 1, 0.5}, {0.5, 1, 0.5}, {0.5, 1, 0.5}};
    static const int plus[5] = {1, 1, 1, 1, 1};
    check_boxes("l_shape", l_centres, l_halves, plus, 3);
    check_boxes("comb", comb_centres, comb_halves, plus, 5);
}

static void test_several_surfaces_are_one_solid(void **state)
{
    (void)state;
    const double centres[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    const double halves[3][3] = {{2, 2, 2}, {1, 1, 1}, {0.5, 0.5, 0.5}};
    const double pair[2][3] = {{0, 0, 0}, {2, 0, 0}}, pair_halves[2][3] = {{1, 1, 1}, {1, 1, 1}};
    static const int nested[3] = {1, -1, 1}, plus[2] = {1, 1};
    check_boxes("hollow", centres, halves, nested, 3);
    check_boxes("two_boxes", pair, pair_halves, plus, 2);
}

static void test_round_solids_equal_their_slices(void **state)
{
    (void)state;
    const double two_pi = 6.28318530717958647692;
    double radius[12], height[12];
    for (int j = 0; j < 12; j++) {
        radius[j] = 2 + 0.5 * cos(j * two_pi / 12);
        height[j] = 0.5 * sin(j * two_pi / 12);
    }
    const solid_moments torus = known_moments_of_rings(24, radius, height, 12, true);
    check_good("torus", &torus, 1e-14);
    for (int j = 0; j <= 4; j++) { /* from pole to pole */
        radius[j] = j % 4 == 0 ? 0 : sin(j * two_pi / 8);
        height[j] = -cos(j * two_pi / 8);
    }
    const solid_moments ball = known_moments_of_rings(8, radius, height, 5, false);
    check_good("ball_poles", &ball, 1e-14);
    pl_polyhedron *made = read_good("tetrahedron");
    assert_close(made->volume, 1.0 / 6, 0, 1e-15);
    pl_polyhedron_free(made);
}

typedef struct fault {
    const char *file;
    int line; /* 0: none */
    const char *part;
} fault;

static void check_refused(const fault *item)
{
    char path[512], place[600];
    pl_polyhedron *made = NULL;
    pl_error error = {.message = ""};
    snprintf(path, sizeof path, BAD "%s.obj", item->file);
    snprintf(place, sizeof place, "%s:%d: expected ", path, item->line);
    if (item->line == 0) {
        snprintf(place, sizeof place, "%s: expected ", path);
    }
    if (pl_polyhedron_of_file(path, &made, &error) != PL_BAD_INPUT) {
        fail_msg("%s is not refused", path);
    }
    assert_null(made);
    if (strncmp(error.message, place, strlen(place)) != 0) {
        fail_msg("\"%s\"\n  does not begin with \"%s\"", error.message, place);
    }
    assert_contains(error.message, item->part);
    assert_contains(error.message, "found");
}

static void test_bad_files_are_refused_at_their_line(void **state)
{
    (void)state;
    static const fault faults[] = {
        {"binary", 1, "found \"?????\""},
        {"comment_only", 3, "expected vertices and faces, found 0 and 0"},
        {"crossing_boxes", 10, "does not cross itself"},
        {"crlf", 4, "found \"zero\""},
        {"curve", 5, "no curves and curved surfaces, found \"cstype\""},
        {"edge_of_four", 20, "found that of vertices 2 and 6 in 4"},
        {"edge_of_three", 6, "expected each edge to be of two triangles"},
        {"empty", 1, "expected vertices and faces, found 0 and 0"},
        {"face_before_first", 5, "of which there are 4, found \"-5\""},
        {"face_beyond", 9, "expected a vertex from 1 to 4, found 5"},
        {"face_beyond_int", 5, "found \"99999999999\""},
        {"face_bow_tie", 5, "outline does not touch or cross itself"},
        {"face_closed_again", 5, "different vertices in a face, found 1 twice"},
        {"face_exponent", 5, "found \"2e0\""},
        {"face_fraction", 5, "found \"2.5\""},
        {"face_joined_line", 7, "found \"x\""},
        {"face_no_corners", 5, "at least 3 corners, found 0"},
        {"face_not_flat", 5, "flat to a thousandth of its size"},
        {"face_on_a_line", 6, "a face with an area, found its corners on one line"},
        {"face_pentagram", 6, "outline does not touch or cross itself"},
        {"face_slash_at_end", 5, "found \"1/\""},
        {"face_slash_first", 5, "found \"/1\""},
        {"face_texture_word", 5, "found \"1/a\""},
        {"face_texture_zero", 5, "found \"1/0\""},
        {"face_three_slashes", 5, "found \"1/1/1/1\""},
        {"face_two_corners", 5, "at least 3 corners, found 2"},
        {"face_two_slashes_at_end", 5, "found \"1//\""},
        {"face_two_turns", 9, "outline does not touch or cross itself"},
        {"face_vertex_twice", 5, "different vertices in a face, found 2 twice"},
        {"face_word", 5, "found \"two\""},
        {"face_zero", 5, "found \"0\""},
        {"html", 1, "found \"<!DOCTYPE\""},
        {"json", 1, "found \"{\""},
        {"moebius", 15, "expected a surface with two sides"},
        {"no_faces", 5, "expected vertices and faces, found 4 and 0"},
        {"no_vertices", 2, "found 0 and 1"},
        {"number_broken", 1, "found \"1e\""},
        {"number_two_points", 1, "found \"1.2.3\""},
        {"one_triangle", 0, "expected 4 to 2097152 triangles, found 1"},
        {"open_box", 9, "closed surface, each edge of two triangles, found triangle"},
        {"overlapping_boxes", 9, "does not cross itself"},
        {"pillow", 5, "encloses a volume"},
        {"same_box_twice", 9, "does not cross itself"},
        {"sliver", 10, "a face with an area"},
        {"surface", 9, "found \"surf\""},
        {"triangle_on_a_line_far", 6, "a face with an area"},
        {"unknown_word", 5, "another word of an .obj file, found \"face\""},
        {"upper_case", 5, "found \"F\""},
        {"vertex_comma", 1, "found \"0,5\""},
        {"vertex_eight_numbers", 1, "found more than 7 numbers"},
        {"vertex_five_numbers", 1, "found 5 numbers"},
        {"vertex_hexadecimal", 5, "found \"0x1\""},
        {"vertex_huge", 4, "at most 1e50, found \"1e60\""},
        {"vertex_infinite", 5, "found \"inf\""},
        {"vertex_nan", 5, "found \"nan\""},
        {"vertex_no_numbers", 1, "found 0 numbers"},
        {"vertex_overflow", 5, "found \"1e999\""},
        {"vertex_two_numbers", 1, "found 2 numbers"},
        {"vertex_word", 1, "a number of a vertex, at most 1e50, found \"zero\""},
    };
    const int count = sizeof faults / sizeof faults[0];
    assert_int_equal(count, count_files(BAD, ""));
    for (int i = 0; i < count; i++) {
        check_refused(&faults[i]);
    }
}

static void test_missing_and_foreign_files_are_refused(void **state)
{
    (void)state;
    pl_polyhedron *made = NULL;
    pl_error error = {.message = ""};
    assert_int_equal(pl_polyhedron_of_file(GOOD "none.obj", &made, &error), PL_BAD_INPUT);
    assert_contains(error.message, "none.obj: expected a Wavefront .obj file, found none to read");
    assert_int_equal(pl_polyhedron_of_file(GOOD, &made, &error), PL_BAD_INPUT);
    assert_contains(error.message, "expected a Wavefront .obj file, found a directory");
    assert_null(made);
}

static pl_status read_text(const char *text, size_t length, pl_error *error)
{
    pl_obj obj;
    const pl_status status = pl_obj_read_text(text, length, "x.obj", &obj, error);
    pl_obj_free(&obj);
    return status;
}

/* Cut anywhere it is read or refused, without reading on behind the end (under a sanitizer). */
static void test_every_beginning_of_a_file_is_read_or_refused(void **state)
{
    (void)state;
    static const char text[] = "v 0 0 0\nv 1 0 0 1\\\r\n\nv 0 1 0\r\nv 0 0 1e0\rf 1/1 2//2 "
                               "3/1/1\\\n4#x\nf 1 2 4";
    for (size_t length = 0; length < sizeof text; length++) {
        char *exact = malloc(length + 1);
        assert_non_null(exact);
        memcpy(exact, text, length);
        pl_error error = {.message = ""};
        if (read_text(exact, length, &error) != PL_OK) {
            assert_contains(error.message, "x.obj:");
        }
        free(exact);
    }
}

/* A polygon of PL_MAX_POLYGON_CORNERS corners is read, one more refused. */
static void test_limits_are_said(void **state)
{
    (void)state;
    enum { CORNERS = 4097 };
    char *text = malloc(CORNERS * 80);
    assert_non_null(text);
    for (int count = CORNERS - 1; count <= CORNERS; count++) {
        size_t used = 0;
        for (int i = 0; i < count; i++) {
            const double angle = i * 6.28318530717958647692 / count;
            used += (size_t)snprintf(text + used, 80, "v %.17g %.17g 0\n", cos(angle), sin(angle));
        }
        used += (size_t)snprintf(text + used, 80, "f");
        for (int i = 0; i < count; i++) {
            used += (size_t)snprintf(text + used, 80, " %d", i + 1);
        }
        pl_error error = {.message = ""};
        pl_obj obj;
        const pl_status status = pl_obj_read_text(text, used, "x.obj", &obj, &error);
        if (count == CORNERS) {
            assert_int_equal(status, PL_BAD_INPUT);
            assert_string_equal(error.message,
                                "x.obj:4098: expected a face of at most 4096 corners, found more");
        } else {
            assert_int_equal(status, PL_OK);
            assert_int_equal(obj.triangle_count, count - 2);
            assert_int_equal(obj.lines[17], count + 1);
        }
        pl_obj_free(&obj);
    }
    free(text);
    size_t used = 0;
    text = malloc(((size_t)PL_MAX_VERTICES + 1) * 8);
    assert_non_null(text);
    for (int i = 0; i <= PL_MAX_VERTICES; i++) {
        memcpy(text + used, "v 0 1 2\n", 8);
        used += 8;
    }
    pl_error error = {.message = ""};
    assert_int_equal(read_text(text, used, &error), PL_BAD_INPUT);
    assert_string_equal(error.message,
                        "x.obj:2097153: expected at most 2097152 vertices, found more");
    free(text);
}

/* Random simple polygons (corners in the order of their angle about a point) are cut into triangles
 * of their direction whose areas add up to theirs, by Gauss's formula. */
static void test_polygons_are_cut_without_overlap(void **state)
{
    (void)state;
    check_random random = {.state = 12};
    for (int round = 0; round < 300; round++) {
        const int count = 4 + round % 60;
        double x[64], y[64], expected = 0;
        char text[64 * 96];
        size_t used = 0;
        for (int i = 0; i < count; i++) {
            const double angle = (i + check_uniform(&random, 0, 0.9)) * 6.2831853 / count;
            const double r = check_uniform(&random, 0.1, 1);
            x[i] = r * cos(angle);
            y[i] = r * sin(angle);
            used += (size_t)snprintf(text + used, 96, "v %.17g %.17g %.17g\n", x[i], y[i],
                                     x[i] + 2 * y[i]);
        }
        used += (size_t)snprintf(text + used, 96, "f");
        for (int i = 0; i < count; i++) {
            const int next = (i + 1) % count;
            expected += (x[i] * y[next] - x[next] * y[i]) / 2;
            used += (size_t)snprintf(text + used, 96, " %d", i + 1);
        }
        pl_obj obj;
        pl_error error = {.message = ""};
        if (pl_obj_read_text(text, used, "x.obj", &obj, &error) != PL_OK) {
            fail_msg("%s", error.message);
        }
        assert_int_equal(obj.triangle_count, count - 2);
        double sum = 0;
        for (int t = 0; t < obj.triangle_count; t++) {
            const int *c = obj.triangles[t];
            const double area = ((x[c[1]] - x[c[0]]) * (y[c[2]] - y[c[0]]) -
                                 (x[c[2]] - x[c[0]]) * (y[c[1]] - y[c[0]])) /
                                2;
            assert_true(area > 0);
            sum += area;
        }
        assert_close(sum, expected, 0, 1e-13);
        pl_obj_free(&obj);
    }
}

/* In a locale with a decimal comma a point is still a point. */
static void test_numbers_are_the_same_in_every_locale(void **state)
{
    (void)state;
    static const char *const commas[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "ru_RU.UTF-8"};
    double value = 0;
    for (int i = 0; i < 4; i++) {
        setlocale(LC_NUMERIC, commas[i]);
        assert_true(pl_decimal("-12.5e-1", 8, &value));
        assert_close(value, -1.25, 0, 0);
        assert_true(pl_parse_number("0.5", &value));
        assert_close(value, 0.5, 0, 0);
        assert_false(pl_decimal("0,5", 3, &value));
    }
    setlocale(LC_NUMERIC, "C");
    assert_true(pl_decimal("1.5x", 3, &value)); /* its length, not a zero, ends it */
    assert_close(value, 1.5, 0, 0);
    assert_false(pl_decimal("", 0, &value));
    assert_false(pl_decimal("1.5", 2000, &value));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box_in_every_form_is_the_box),
        cmocka_unit_test(test_concave_faces_are_cut_into_the_whole_face),
        cmocka_unit_test(test_several_surfaces_are_one_solid),
        cmocka_unit_test(test_round_solids_equal_their_slices),
        cmocka_unit_test(test_bad_files_are_refused_at_their_line),
        cmocka_unit_test(test_missing_and_foreign_files_are_refused),
        cmocka_unit_test(test_every_beginning_of_a_file_is_read_or_refused),
        cmocka_unit_test(test_limits_are_said),
        cmocka_unit_test(test_polygons_are_cut_without_overlap),
        cmocka_unit_test(test_numbers_are_the_same_in_every_locale),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
