/* Wavefront .obj files that are refused: each with its line and what was expected and found. */
#include "check.h"
#include "obj_text.h"
#include "solids/obj.h"

#include <stdio.h>
#include <string.h>

typedef struct fault {
    const char *name;
    const char *text; /* of the file */
    int line;         /* 0: none */
    const char *part; /* of the message */
} fault;

static void check_refused(const fault *item, size_t length)
{
    char path[512], place[600];
    pl_polyhedron *made = NULL;
    pl_error error = {.message = ""};
    write_obj(item->name, item->text, length, path);
    snprintf(place, sizeof place, "%s:%d: expected ", path, item->line);
    if (item->line == 0) {
        snprintf(place, sizeof place, "%s: expected ", path);
    }
    const pl_status status = read_obj(path, &made, &error);
    remove(path);
    if (status != PL_BAD_INPUT) {
        fail_msg("%s is not refused", item->name);
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
        {"comment_only", "# nothing\n\n", 3, "expected vertices and faces, found 0 and 0"},
        {"crossing_boxes",
         CUBE FACES "v -0.5 -0.6 -0.7\nv 1.5 -0.6 -0.7\nv 1.5 1.4 -0.7\nv -0.5 1.4 -0.7\nv -0.5 "
                    "-0.6 1.3\nv 1.5 -0.6 1.3\nv 1.5 1.4 1.3\nv -0.5 1.4 1.3\n" OTHER_FACES,
         10, "does not cross itself"},
        {"crlf", "# CR LF is one end of a line.\r\n\r\nv 0 0 0\r\nv 1 zero 0\r\n", 4,
         "found \"zero\""},
        {"curve", FOUR "cstype bezier\n", 5, "no curves and curved surfaces, found \"cstype\""},
        {"edge_of_four",
         CUBE
         "v 1 1 -1\nv 3 1 -1\nv 3 3 -1\nv 1 3 -1\nv 1 1 1\nv 3 1 1\nv 3 3 1\nv 1 3 1\n" FACES
         "f 3 12 11 10\nf 7 14 15 16\nf 3 10 14 7\nf 10 11 15 14\nf 11 12 16 15\nf 12 3 7 16\n",
         20, "found that of vertices 2 and 6 in 4"},
        {"edge_of_three", FOUR "v 1 1 1\n" FOUR_FACES "f 1 2 5\nf 2 5 3\nf 5 1 3\n", 6,
         "expected each edge to be of two triangles"},
        {"empty", "", 1, "expected vertices and faces, found 0 and 0"},
        {"face_before_first", FOUR "f -1 -2 -5\n", 5, "of which there are 4, found \"-5\""},
        {"face_beyond", FOUR FOUR_FACES "f 1 2 5\n", 9, "expected a vertex from 1 to 4, found 5"},
        {"face_beyond_int", FOUR "f 1 2 99999999999\n", 5, "found \"99999999999\""},
        {"face_bow_tie", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 2 0\nf 1 2 3 4\n", 5,
         "outline does not touch or cross itself"},
        {"face_closed_again", FOUR "f 1 2 3 1\n", 5, "different vertices in a face, found 1 twice"},
        {"face_exponent", FOUR "f 1 2e0 3\n", 5, "found \"2e0\""},
        {"face_fraction", FOUR "f 1 2.5 3\n", 5, "found \"2.5\""},
        {"face_joined_line", FOUR "f 1 \\\n 2 \\\n x\n", 7, "found \"x\""},
        {"face_no_corners", FOUR "f\n", 5, "at least 3 corners, found 0"},
        {"face_not_flat", "v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv 0 1 0\nf 1 2 3 4\n", 5,
         "flat to a thousandth of its size"},
        {"face_on_a_line", FOUR "v 2 0 0\nf 1 2 5\n", 6,
         "a face with an area, found its corners on one line"},
        {"face_pentagram",
         "v 1 0 0\nv -0.80901699437494734 0.58778525229247325 0\nv 0.30901699437494723 "
         "-0.95105651629515364 0\nv 0.30901699437494773 0.95105651629515353 0\nv "
         "-0.80901699437494767 -0.5877852522924728 0\nf 1 2 3 4 5\n",
         6, "outline does not touch or cross itself"},
        {"face_slash_at_end", FOUR "f 1/ 2/ 3/\n", 5, "found \"1/\""},
        {"face_slash_first", FOUR "f /1 2 3\n", 5, "found \"/1\""},
        {"face_texture_word", FOUR "f 1/a 2 3\n", 5, "found \"1/a\""},
        {"face_texture_zero", FOUR "f 1/0 2 3\n", 5, "found \"1/0\""},
        {"face_three_slashes", FOUR "f 1/1/1/1 2 3\n", 5, "found \"1/1/1/1\""},
        {"face_two_corners", FOUR "f 1 2\n", 5, "at least 3 corners, found 2"},
        {"face_two_slashes_at_end", FOUR "f 1// 2// 3//\n", 5, "found \"1//\""},
        {"face_two_turns",
         "v 0 0 0\nv 1 0 0\nv -0.19101299543362335 1.0832885283134288 0\nv -1.12763114494309 "
         "-0.41042417199080239 0\nv 0.65000000000000013 -1.1258330249197701 0\nv "
         "1.0724622203665692 0.89990265356115473 0\nv -1.1490666646784675 0.96418141452980854 0\nv "
         "-0.79999999999999982 -1.3856406460551021 0\nf 1 2 3 4 5 6 7 8\n",
         9, "outline does not touch or cross itself"},
        {"face_vertex_twice", FOUR "f 1 2 2\n", 5, "different vertices in a face, found 2 twice"},
        {"face_word", FOUR "f 1 two 3\n", 5, "found \"two\""},
        {"face_zero", FOUR "f 0 1 2\n", 5, "found \"0\""},
        {"html", "<!DOCTYPE html>\n<html>\n", 1, "found another word"},
        {"json", "{ \"plumb_scene\": 1 }\n", 1, "found another word"},
        {"moebius",
         "v 0 0 1\nv 1 0 0\nv 0.3 0.9 0.1\nv -0.8 0.6 0.2\nv -0.8 -0.6 0.4\nv 0.3 -0.9 0.3\nf 1 2 "
         "3\nf 1 3 4\nf 1 4 5\nf 1 5 6\nf 1 6 2\nf 2 3 5\nf 3 4 6\nf 4 5 2\nf 5 6 3\nf 6 2 4\n",
         15, "expected a surface with two sides"},
        {"no_faces", FOUR, 5, "expected vertices and faces, found 4 and 0"},
        {"no_vertices", "f 1 2 3\n", 2, "found 0 and 1"},
        {"number_broken", "v 0 0 0\nv 0 1e 0\n", 2, "found \"1e\""},
        {"number_two_points", "v 0 0 0\nv 0 1.2.3 0\n", 2, "found \"1.2.3\""},
        {"one_triangle", FOUR "f 1 2 3\n", 0, "expected 4 to 2097152 triangles, found 1"},
        {"open_box", BOX "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n", 9,
         "closed surface, each edge of two triangles, found triangle"},
        {"overlapping_boxes",
         CUBE FACES "v -0.5 -1 -1\nv 1.5 -1 -1\nv 1.5 1 -1\nv -0.5 1 -1\nv -0.5 -1 1\nv 1.5 -1 "
                    "1\nv 1.5 1 1\nv -0.5 1 1\n" OTHER_FACES,
         9, "does not cross itself"},
        {"pillow", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.25 0.25 0\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 3 2 1\n",
         5, "encloses a volume"},
        {"same_box_twice", CUBE FACES CUBE OTHER_FACES, 9, "does not cross itself"},
        {"sliver", FOUR "v 0.5 0 0\n" FOUR_FACES "f 1 5 2\nf 2 5 1\n", 10, "a face with an area"},
        {"surface", FOUR FOUR_FACES "surf 0 1 0 1 1 2 3 4\n", 9, "found \"surf\""},
        {"triangle_on_a_line_far",
         "v 100000000.0 0 0\nv 100000001.0 0 0\nv 100000002.0 0 0\nv 1e8 1 0\nv 1e8 0 1\nf 1 2 "
         "3\nf 1 2 4\nf 2 3 4\nf 1 3 4\n",
         6, "a face with an area"},
        {"unknown_word", FOUR "face 1 2 3\n", 5, "another word of an .obj file, found \"face\""},
        {"upper_case", FOUR "F 1 2 3\n", 5, "found \"F\""},
        {"vertex_comma", "v 0 0 0\nv 0,5 0 0\n", 2, "found \"0,5\""},
        {"vertex_eight_numbers", "v 0 0 0 1 1 1 1 1\n" FOUR_FACES, 1, "found more than 7 numbers"},
        {"vertex_five_numbers", "v 0 0 0 1 1\n" FOUR_FACES, 1, "found 5 numbers"},
        {"vertex_hexadecimal", FOUR "v 0x1 0 0\n", 5, "found \"0x1\""},
        {"vertex_huge", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1e60\n" FOUR_FACES, 4,
         "at most 1e50, found \"1e60\""},
        {"vertex_infinite", FOUR "v 0 inf 0\n", 5, "found \"inf\""},
        {"vertex_nan", FOUR "v 0 nan 0\n", 5, "found \"nan\""},
        {"vertex_no_numbers", "v\n" FOUR_FACES, 1, "found 0 numbers"},
        {"vertex_overflow", FOUR "v 0 1e999 0\n", 5, "found \"1e999\""},
        {"vertex_two_numbers", "v 0 0\n" FOUR_FACES, 1, "found 2 numbers"},
        {"vertex_word", "v 0 0 0\nv 0 zero 0\n", 2,
         "a number of a vertex, at most 1e50, found \"zero\""},
    };
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; ++i) {
        check_refused(&faults[i], strlen(faults[i].text));
    }
}

static void test_binary_file_is_refused(void **state)
{
    (void)state;
    static const fault binary = {"binary", "\000\001\002\003\377\n", 1, "found another word"};
    check_refused(&binary, 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_files_are_refused_at_their_line),
        cmocka_unit_test(test_binary_file_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
