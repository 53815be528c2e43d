/* Wavefront .obj files: a box in every form of the format, and the files of tests/scenarios/obj,
 * are the solids that they describe. */
#include "base/number.h"
#include "check.h"
#include "obj_text.h"
#include "plumb/vec.h"
#include "solid_for_tests.h"
#include "solids/obj.h"
#include "solids/polyhedron.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FILES PLUMB_SOURCE_DIR "/tests/scenarios/obj/"

static pl_polyhedron *read_file(const char *name)
{
    char path[512];
    pl_polyhedron *made = NULL;
    pl_error error = {.message = ""};
    snprintf(path, sizeof path, FILES "%s.obj", name);
    if (read_obj(path, &made, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    return made;
}

static void check_file(const char *name, const solid_moments *expected, double relative)
{
    pl_polyhedron *made = read_file(name);
    known_check(made, expected, NULL, NULL, relative);
    pl_polyhedron_free(made);
}

static void check_boxes(const char *name, const double (*centres)[3], const double (*halves)[3],
                        const int *signs, int count)
{
    const solid_moments expected = known_moments_of_boxes(centres, halves, signs, count);
    check_file(name, &expected, 1e-14);
}

typedef struct box_form {
    const char *name;
    const char *text; /* of the file */
} box_form;

static void check_box(const box_form *form)
{
    const double centre[3] = {1, 1.5, 2}, half[3] = {1, 1.5, 2};
    const int plus = 1;
    const solid_moments expected = known_moments_of_boxes(&centre, &half, &plus, 1);
    char path[512];
    pl_polyhedron *made = NULL;
    pl_error error = {.message = ""};
    write_obj(form->name, form->text, strlen(form->text), path);
    const pl_status status = read_obj(path, &made, &error);
    remove(path);
    if (status != PL_OK) {
        fail_msg("%s", error.message);
    }
    known_check(made, &expected, NULL, NULL, 1e-14);
    const bool has_extra = strcmp(form->name, "collinear") == 0;
    assert_int_equal(made->vertex_count, has_extra ? 9 : 8);
    assert_int_equal(made->triangle_count, has_extra ? 14 : 12);
    pl_polyhedron_free(made);
}

static void test_box_in_every_form_is_the_box(void **state)
{
    (void)state;
    static const box_form forms[] = {
        {"byte_order_mark", "\357\273\277# The box, behind a byte order mark.\n" BOX FACES},
        {"collinear",
         "# The box, with a vertex in the middle of an edge, a corner of both faces there.\n" BOX
         "v 1 0 0\nf 1 4 3 2 9\nf 5 6 7 8\nf 1 9 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"},
        {"crlf", "# The box, with CR LF, tabs, blank lines and no end of the last "
                 "line."
                 "\r\n\r\nv\t0\t0\t0\r\nv\t2\t0\t0\r\nv\t2\t3\t0\r\nv\t0\t3\t0\r\nv\t0\t0\t4\r\nv\t"
                 "2\t0\t4\r\nv\t2\t3\t4\r\nv\t0\t3\t4\r\n\r\n  \r\nf 1 4 3 2\r\nf 5 6 7 8\r\nf 1 2 "
                 "6 5\r\nf 2 3 7 6\r\nf 3 4 8 7\r\nf 4 1 5 8  # the last"},
        {"forward", "# The box, its faces before its vertices.\n" FACES BOX},
        {"inside_out", "# The box, inside out.\n" BOX
                       "f 2 3 4 1\nf 8 7 6 5\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 8 5 1 4\n"},
        {"joined", "# The box, faces over two lines.\n" BOX
                   "f 1 4 \\\n  3 2\nf 5 6 \\\n  7 8\nf 1 2 \\\n  6 5\nf 2 3 \\\n  7 6\nf 3 4 \\\n "
                   " 8 7\nf 4 1 \\\n  5 8\n"},
        {"mixed_winding", "# The box, faces wound this way and that.\n" BOX
                          "f 2 3 4 1\nf 5 6 7 8\nf 5 6 2 1\nf 2 3 7 6\nf 7 8 4 3\nf 4 1 5 8\n"},
        {"negative",
         "# The box, counted back.\n" BOX "f -8 -5 -6 -7\nf -4 -3 -2 -1\nf -8 -7 -3 -4\nf -7 -6 -2 "
         "-3\nf -6 -5 -1 -2\nf -5 -8 -4 -1\n"},
        {"numbers",
         "# The box, numbers of all forms.\nv 0 .0 0.\nv +2 0 0\nv 2.0e0 30E-1 0\nv -0 3 0\nv 0 0 "
         ".4e+1\nv 2 0 400e-2\nv 2 3 4\nv 0 3 4.000000000000000000000000000000000000000\n" FACES},
        {"old_mac",
         "# The box, with CR alone.\rv 0 0 0\rv 2 0 0\rv 2 3 0\rv 0 3 0\rv 0 0 4\rv 2 0 4\rv 2 3 "
         "4\rv 0 3 4\rf 1 4 3 2\rf 5 6 7 8\rf 1 2 6 5\rf 2 3 7 6\rf 3 4 8 7\rf 4 1 5 8\r"},
        {"quads", "# A box of 2 x 3 x 4 m, quadrilaterals.\n" BOX FACES},
        {"seams", "# The box, each face with vertices of its own; -0 is 0.\nv 0 0 0\nv 0 3 0\nv 2 "
                  "3 0\nv 2 0 0\nf -4 -3 -2 -1\nv -0 -0 4\nv 2 -0 4\nv 2 3 4\nv -0 3 4\nf -4 -3 -2 "
                  "-1\nv 0 0 0\nv 2 0 0\nv 2 0 4\nv 0 0 4\nf -4 -3 -2 -1\nv 2 -0 -0\nv 2 3 -0\nv 2 "
                  "3 4\nv 2 -0 4\nf -4 -3 -2 -1\nv 2 3 0\nv 0 3 0\nv 0 3 4\nv 2 3 4\nf -4 -3 -2 "
                  "-1\nv -0 3 -0\nv -0 -0 -0\nv -0 -0 4\nv -0 3 4\nf -4 -3 -2 -1\n"},
        {"slashes",
         "# The box, all forms of corners, with textures and normals.\nmtllib none.mtl\no box\n" BOX
         "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 -1\nvn 0 0 1\ng sides\nusemtl wood\ns off\nf 1/1 "
         "4/2 3/3 2/4\nf 5//2 6//2 7//2 8//2\nf 1/1/1 2/2/1 6/3/1 5/4/1\nf 2 3/1 7//1 6/1/1\nf "
         "3/-1 4/-2 8/-3 7/-4\nf 4//-1 1//-1 5//-1 8//-1\n"},
        {"triangles",
         "# The box, triangles.\n" BOX "f 1 4 3\nf 1 3 2\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 "
         "3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n"},
        {"weights_colours",
         "# The box, with weights, colours, points, lines and a vertex that nothing has.\nv 9 9 9 "
         "1\nv 0 0 0 0.5 0.25 1\nv 2 0 0 1\nv 2 3 0 0.5 0.25 1\nv 0 3 0 1\nv 0 0 4 0.5 0.25 1\nv 2 "
         "0 4 1\nv 2 3 4 0.5 0.25 1\nv 0 3 4 1\nf 2 5 4 3\nf 6 7 8 9\nf 2 3 7 6\nf 3 4 8 7\nf 4 5 "
         "9 8\nf 5 2 6 9\np 1\nl 1 2 3\n"},
    };
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; ++i) {
        check_box(&forms[i]);
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
    for (int j = 0; j < 12; ++j) {
        radius[j] = 2 + 0.5 * cos(j * two_pi / 12);
        height[j] = 0.5 * sin(j * two_pi / 12);
    }
    const solid_moments torus = known_moments_of_rings(24, radius, height, 12, true);
    check_file("torus", &torus, 1e-14);
    for (int j = 0; j <= 4; ++j) { /* from pole to pole */
        radius[j] = j % 4 == 0 ? 0 : sin(j * two_pi / 8);
        height[j] = -cos(j * two_pi / 8);
    }
    const solid_moments ball = known_moments_of_rings(8, radius, height, 5, false);
    check_file("ball_poles", &ball, 1e-14);
    pl_polyhedron *made = read_file("tetrahedron");
    assert_close(made->volume, 1.0 / 6, 0, 1e-15);
    pl_polyhedron_free(made);
}

static void test_missing_and_foreign_files_are_refused(void **state)
{
    (void)state;
    pl_polyhedron *made = NULL;
    pl_error error = {.message = ""};
    assert_int_equal(read_obj(FILES "none.obj", &made, &error), PL_BAD_INPUT);
    assert_contains(error.message, "none.obj: expected a Wavefront .obj file, found none to read");
    assert_int_equal(read_obj(FILES, &made, &error), PL_BAD_INPUT);
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
static void test_every_file_prefix_is_read_or_refused(void **state)
{
    (void)state;
    static const char text[] = "v 0 0 0\nv 1 0 0 1\\\r\n\nv 0 1 0\r\nv 0 0 1e0\rf 1/1 2//2 "
                               "3/1/1\\\n4#x\nf 1 2 4";
    for (size_t length = 0; length < sizeof text; ++length) {
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
static void test_size_limits_are_enforced(void **state)
{
    (void)state;
    enum { CORNERS = 4097 };
    char *text = malloc(CORNERS * 80);
    assert_non_null(text);
    for (int count = CORNERS - 1; count <= CORNERS; ++count) {
        size_t used = 0;
        for (int i = 0; i < count; ++i) {
            const double angle = i * 6.28318530717958647692 / count;
            used += (size_t)snprintf(text + used, 80, "v %.17g %.17g 0\n", cos(angle), sin(angle));
        }
        used += (size_t)snprintf(text + used, 80, "f");
        for (int i = 0; i < count; ++i) {
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
    for (int i = 0; i <= PL_MAX_VERTICES; ++i) {
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
    for (int round = 0; round < 300; ++round) {
        const int count = 4 + round % 60;
        double x[64], y[64], expected = 0;
        char text[64 * 96];
        size_t used = 0;
        for (int i = 0; i < count; ++i) {
            const double angle = (i + check_uniform(&random, 0, 0.9)) * 6.2831853 / count;
            const double r = check_uniform(&random, 0.1, 1);
            x[i] = r * cos(angle);
            y[i] = r * sin(angle);
            used += (size_t)snprintf(text + used, 96, "v %.17g %.17g %.17g\n", x[i], y[i],
                                     x[i] + 2 * y[i]);
        }
        used += (size_t)snprintf(text + used, 96, "f");
        for (int i = 0; i < count; ++i) {
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
        for (int t = 0; t < obj.triangle_count; ++t) {
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
    for (int i = 0; i < 4; ++i) {
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
        cmocka_unit_test(test_missing_and_foreign_files_are_refused),
        cmocka_unit_test(test_every_file_prefix_is_read_or_refused),
        cmocka_unit_test(test_size_limits_are_enforced),
        cmocka_unit_test(test_polygons_are_cut_without_overlap),
        cmocka_unit_test(test_numbers_are_the_same_in_every_locale),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
