/* Shapes in scene files: all of them read back number for number, stand once where bodies share
 * them, come from files next to the scene, and are refused with their place. */
#include "check.h"
#include "plumb/scenario.h"
#include "plumb/vec.h"
#include "scene/scene_internal.h"
#include "scene_equal.h"
#include "solid_for_tests.h"
#include "solids/polyhedron.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const double corners[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.1, 0.1, 0.1}};
static const int sides[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}; /* wound at random */

static void add_body(pl_scene *scene, const char *name, pl_shape shape)
{
    pl_body body = pl_body_default();
    snprintf(body.name, sizeof body.name, "%s", name);
    body.shape = shape;
    assert_int_equal(pl_scene_add_body(scene, &body, NULL, NULL), PL_OK);
}

static const pl_polyhedron *add_hull(pl_scene *scene, const char *name)
{
    const pl_polyhedron *made = NULL;
    assert_int_equal(pl_scene_add_hull(scene, name, corners, 5, &made, NULL), PL_OK);
    return made;
}

static const pl_polyhedron *add_mesh(pl_scene *scene, const char *name)
{
    const pl_polyhedron *made = NULL;
    assert_int_equal(pl_scene_add_mesh(scene, name, corners, 4, sides, 4, &made, NULL), PL_OK);
    return made;
}

static pl_scene empty_scene(void)
{
    pl_scene scene = pl_scene_default();
    const pl_material material = {.name = "stuff"};
    assert_int_equal(pl_scene_add_material(&scene, &material, NULL, NULL), PL_OK);
    return scene;
}

/* Reads back as it is, and is written the same again; the text, which the caller frees. */
static char *check_reads_back(const pl_scene *scene)
{
    assert_int_equal(pl_scene_validate(scene, NULL), PL_OK);
    char *text = pl_scene_to_text(scene), hash[17], hash_again[17];
    assert_non_null(text);
    pl_scene again = read_scene(text);
    assert_same_scene(&again, scene);
    char *second = pl_scene_to_text(&again);
    assert_string_equal(second, text);
    assert_int_equal(pl_scene_hash(scene, hash, NULL), PL_OK);
    assert_int_equal(pl_scene_hash(&again, hash_again, NULL), PL_OK);
    assert_string_equal(hash, hash_again);
    free(second);
    pl_scene_free(&again);
    return text;
}

static void test_scene_of_all_shapes_reads_back(void **state)
{
    (void)state;
    pl_scene scene = empty_scene();
    add_body(&scene, "sphere", pl_shape_sphere(0.1));
    add_body(&scene, "box", pl_shape_box(0.1, 0.2, 0.3));
    add_body(&scene, "capsule", pl_shape_capsule(0.1, 0.7));
    add_body(&scene, "cylinder", pl_shape_cylinder(0.3, 1 / 3.0));
    add_body(&scene, "hull", pl_shape_of(add_hull(&scene, NULL)));
    add_body(&scene, "mesh", pl_shape_of(add_mesh(&scene, NULL)));
    scene.bodies[5].inertia[1] *= 1.125;
    assert_int_equal(scene.bodies[4].shape.kind, PL_SHAPE_HULL);
    assert_int_equal(scene.bodies[5].shape.kind, PL_SHAPE_MESH);
    char *text = check_reads_back(&scene);
    assert_absent(text, "shapes");
    assert_int_equal(count_of(text, "\"inertia\""), 1);
    free(text);
    const uint32_t kinds = PL_NEEDS_SPHERE | PL_NEEDS_BOX | PL_NEEDS_CAPSULE | PL_NEEDS_CYLINDER |
                           PL_NEEDS_HULL | PL_NEEDS_MESH;
    assert_int_equal(pl_scene_needs(&scene), kinds | PL_NEEDS_ROTATION);
    assert_string_equal(pl_needs_name(PL_NEEDS_PLANE << PL_SHAPE_CAPSULE), "capsule");
    assert_string_equal(pl_needs_name(PL_NEEDS_PLANE << PL_SHAPE_CYLINDER), "cylinder");
    assert_string_equal(pl_needs_name(PL_NEEDS_PLANE << PL_SHAPE_HULL), "hull");
    assert_string_equal(pl_needs_name(PL_NEEDS_PLANE << PL_SHAPE_MESH), "mesh");
    pl_scene_free(&scene);
}

/* Large random hulls and a turned torus: every bit of the vertices, axes and moments. */
static void test_random_polyhedra_read_back_to_the_bit(void **state)
{
    (void)state;
    static solid_surface surface;
    check_random random = {.state = 71};
    for (int round = 0; round < 20; ++round) {
        pl_scene scene = empty_scene();
        const pl_polyhedron *hull = NULL, *mesh = NULL;
        double points[200][3], rotation[4], shift[3], radius[8], height[8];
        for (int i = 0; i < 600; ++i) {
            points[i / 3][i % 3] = check_uniform(&random, -1, 1) * pow(10, round - 10);
        }
        for (int j = 0; j < 8; ++j) {
            radius[j] = 2 + 0.5 * cos(j * 0.785398163);
            height[j] = 0.5 * sin(j * 0.785398163);
        }
        check_quaternion(&random, rotation);
        pl_vec_store((pl_vec){check_uniform(&random, -9, 9), 1e3, 0}, shift);
        known_clear(&surface);
        known_add_rings(&surface, 9, radius, height, 8, true);
        known_move(&surface, rotation, shift);
        assert_int_equal(
            pl_scene_add_hull(&scene, NULL, (const double(*)[3])points, 200, &hull, NULL), PL_OK);
        assert_int_equal(pl_scene_add_mesh(&scene, "torus", (const double(*)[3])surface.vertices,
                                           surface.vertex_count, (const int(*)[3])surface.triangles,
                                           surface.triangle_count, &mesh, NULL),
                         PL_OK);
        add_body(&scene, "stone", pl_shape_of(hull));
        add_body(&scene, "ring", pl_shape_of(mesh));
        free(check_reads_back(&scene));
        pl_scene_free(&scene);
    }
}

static void test_shared_and_named_polyhedra_are_written_once(void **state)
{
    (void)state;
    pl_scene scene = empty_scene();
    const pl_polyhedron *alone = add_hull(&scene, NULL);
    const pl_polyhedron *shared = add_hull(&scene, NULL);
    const pl_polyhedron *named = add_mesh(&scene, "polyhedron 1");
    const pl_polyhedron *unused = add_mesh(&scene, NULL);
    const pl_polyhedron *also_shared = add_mesh(&scene, "");
    assert_non_null(unused);
    add_body(&scene, "a", pl_shape_of(alone));
    add_body(&scene, "b", pl_shape_of(also_shared));
    for (int i = 0; i < 3; ++i) {
        const char *const names[3] = {"c", "d", "e"};
        add_body(&scene, names[i], pl_shape_of(shared));
    }
    add_body(&scene, "f", pl_shape_of(also_shared));
    add_body(&scene, "g", pl_shape_of(named));
    char *text = check_reads_back(&scene);
    assert_int_equal(count_of(text, "\"hull\""), 2);
    assert_int_equal(count_of(text, "\"mesh\""), 2);
    assert_int_equal(count_of(text, "\"shape\": \"polyhedron 1\""), 1);
    assert_int_equal(count_of(text, "\"shape\": \"polyhedron 2\""), 3);
    assert_int_equal(count_of(text, "\"shape\": \"polyhedron 3\""), 2);
    pl_scene again = read_scene(text);
    assert_int_equal(again.polyhedron_count, 4);
    assert_ptr_equal(again.bodies[2].shape.polyhedron, again.bodies[4].shape.polyhedron);
    assert_string_equal(again.bodies[6].shape.polyhedron->name, "polyhedron 1");
    pl_scene_free(&again);
    free(text);
    pl_scene_free(&scene);
}

static void test_bodies_take_shapes_by_name(void **state)
{
    (void)state;
    pl_scene scene = read_scene(
        "{ \"plumb_scene\": 1, \"shapes\": {"
        "  \"pill\": { \"type\": \"capsule\", \"radius\": 0.5, \"half_height\": 2 },"
        "  \"unused\": { \"type\": \"sphere\", \"radius\": 3 },"
        "  \"floor\": { \"type\": \"plane\", \"normal\": [0, 0, 1], \"offset\": 0 },"
        "  \"rock\": { \"type\": \"hull\", \"points\": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]] } },"
        "  \"bodies\": [ { \"name\": \"a\", \"density\": 10, \"shape\": \"pill\" },"
        "    { \"name\": \"b\", \"shape\": \"floor\" },"
        "    { \"name\": \"c\", \"density\": 600, \"shape\": \"rock\" },"
        "    { \"name\": \"d\", \"static\": true, \"shape\": \"rock\" } ],"
        "  \"expect\": { \"rest\": [ { \"body\": \"c\", \"position\": [0, 0, 0] },"
        "    { \"body\": \"a\", \"position\": [0, 0, 0] } ] } }");
    const double pi = 3.14159265358979323846;
    assert_close(scene.bodies[0].mass, 10 * (pi * 0.25 * 4 + pi / 6), 0, 1e-15);
    assert_true(scene.bodies[1].is_static);
    assert_close(scene.bodies[2].mass, 100, 0, 1e-15);
    assert_int_equal(scene.polyhedron_count, 1);
    assert_ptr_equal(scene.bodies[2].shape.polyhedron, scene.bodies[3].shape.polyhedron);
    assert_string_equal(scene.polyhedra[0]->name, "rock");
    /* The least half width: of the rock, along one of its principal axes. */
    assert_close(scene.collapse_distance, pl_shape_half_width(&scene.bodies[2].shape), 0, 0);
    assert_true(scene.collapse_distance > 0.2 && scene.collapse_distance < 0.5);
    pl_scene_free(&scene);
}

static void test_half_width_is_the_least_half_dimension(void **state)
{
    (void)state;
    pl_scene scene = empty_scene();
    static solid_surface surface;
    const double centre[3] = {7, 8, 9}, half[3] = {3, 0.25, 2}, shift[3] = {0, 0, 0};
    const double rotation[4] = {0.6, 0, 0.8, 0};
    const pl_polyhedron *box = NULL;
    known_clear(&surface);
    known_add_box(&surface, centre, half, false);
    known_move(&surface, rotation, shift);
    assert_int_equal(
        pl_scene_add_hull(&scene, NULL, (const double(*)[3])surface.vertices, 8, &box, NULL),
        PL_OK);
    const pl_shape shapes[6] = {pl_shape_of(box),           pl_shape_sphere(0.25),
                                pl_shape_box(1, 0.25, 2),   pl_shape_capsule(0.25, 0.1),
                                pl_shape_cylinder(0.25, 1), pl_shape_cylinder(1, 0.25)};
    for (int i = 0; i < 6; ++i) {
        assert_close(pl_shape_half_width(&shapes[i]), 0.25, 0, 1e-13);
    }
    const pl_shape plane = pl_shape_plane(0, 0, 1, 0);
    assert_true(isinf(pl_shape_half_width(&plane)));
    pl_scene_free(&scene);
}

/* A prism of very many sides is a cylinder; with very many latitudes at its ends, a capsule. */
static void test_round_shapes_have_fine_polyhedron_moments(void **state)
{
    (void)state;
    enum { ARC = 400 };
    const double r = 0.75, h = 1.25, pi = 3.14159265358979323846;
    double radius[2 * ARC], height[2 * ARC], inertia[3];
    for (int j = 0; j < ARC; ++j) {
        const double angle = pi / 2 * j / (ARC - 1);
        radius[j] = radius[2 * ARC - 1 - j] = r * sin(angle);
        height[2 * ARC - 1 - j] = h + r * cos(angle);
        height[j] = -height[2 * ARC - 1 - j];
    }
    const double ends[2] = {-h, h}, same[2] = {r, r};
    const solid_moments solids[2] = {known_moments_of_rings(100000, radius, height, 2 * ARC, false),
                                     known_moments_of_rings(100000, same, ends, 2, false)};
    const pl_shape shapes[2] = {pl_shape_capsule(r, h), pl_shape_cylinder(r, h)};
    for (int i = 0; i < 2; ++i) {
        const solid_moments *m = &solids[i];
        assert_close(pl_shape_volume(&shapes[i]), m->volume, 0, 1e-5);
        pl_shape_inertia(&shapes[i], 3, inertia);
        for (int k = 0; k < 3; ++k) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            assert_close(inertia[k], 3 * (m->square[a][a] + m->square[b][b]), 0, 1e-5);
        }
    }
}

static void write_file(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* A scene in a folder of its own, with files next to it and in a folder below. */
static void test_mesh_files_are_found_beside_the_scene(void **state)
{
    (void)state;
    char folder[] = "/tmp/plumb_shapes_XXXXXX", path[256];
    assert_non_null(mkdtemp(folder));
    static const char obj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n";
    static const char scene_text[] =
        "{ \"plumb_scene\": 1, \"bodies\": [\n"
        "{ \"name\": \"a\", \"mass\": 1, \"shape\": { \"type\": \"mesh\", \"file\": \"a.obj\" } "
        "},\n"
        "{ \"name\": \"b\", \"mass\": 1, \"shape\": { \"type\": \"mesh\",\n"
        "  \"file\": \"below/../below/b.obj\" } } ] }\n";
    char whole[256], expected[600];
    snprintf(whole, sizeof whole, "%sf 2 3 4\n", obj);
    snprintf(path, sizeof path, "%s/below", folder);
    assert_int_equal(mkdir(path, 0700), 0);
    snprintf(path, sizeof path, "%s/a.obj", folder);
    write_file(path, whole);
    snprintf(path, sizeof path, "%s/below/b.obj", folder);
    write_file(path, whole);
    snprintf(path, sizeof path, "%s/scene.json", folder);
    write_file(path, scene_text);
    pl_scene scene;
    pl_error error = {.message = ""};
    if (pl_scene_read_file(path, &scene, &error) != PL_OK) {
        fail_msg("%s", error.message);
    }
    assert_close(scene.bodies[1].shape.polyhedron->volume, 1.0 / 6, 0, 1e-15);
    char *text = check_reads_back(&scene);
    assert_absent(text, "file"); /* it has the vertices now */
    free(text);
    pl_scene_free(&scene);
    /* An open mesh: the place in the scene, then that in its file. */
    char obj_path[256];
    snprintf(obj_path, sizeof obj_path, "%s/below/b.obj", folder);
    snprintf(whole, sizeof whole, "%sv 1 1 1\nf 2 3 5\n", obj);
    write_file(obj_path, whole);
    assert_int_equal(pl_scene_read_file(path, &scene, &error), PL_BAD_INPUT);
    snprintf(expected, sizeof expected,
             "%s:4:11: bodies[1].shape.file: %s/below/../below/b.obj:6: expected a closed surface, "
             "each edge of two triangles, found triangle 1 alone at the edge of vertices 1 and 3 "
             "(numbers from 0)",
             path, folder);
    assert_string_equal(error.message, expected);
    assert_int_equal(unlink(obj_path), 0);
    assert_int_equal(pl_scene_read_file(path, &scene, &error), PL_BAD_INPUT);
    assert_contains(error.message, "b.obj: expected a Wavefront .obj file, found none to read");
    snprintf(obj_path, sizeof obj_path, "%s/a.obj", folder);
    assert_int_equal(unlink(obj_path), 0);
    assert_int_equal(unlink(path), 0);
    snprintf(path, sizeof path, "%s/below", folder);
    assert_int_equal(rmdir(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

typedef struct fault {
    const char *shape, *message;
} fault;

/* Fails unless the text is refused with the message, and no shape is left in the scene. */
static void expect_refused(const char *text, const char *message)
{
    pl_scene scene;
    pl_error error = {.message = ""};
    assert_int_equal(pl_scene_read_text(text, strlen(text), "scene", &scene, &error), PL_BAD_INPUT);
    assert_contains(error.message, message);
    assert_int_equal(scene.polyhedron_count, 0);
}

static void test_bad_shapes_are_refused_with_their_place(void **state)
{
    (void)state;
    static const fault faults[] = {
        {"3", "scene:1:46: bodies[0].shape: expected an object or the name of a shape, found 3"},
        {"\"ston\"", "scene:1:46: bodies[0].shape: expected the name of a shape, found \"ston\"; "
                     "did you mean \"stone\"?"},
        {"{ \"type\": \"capsule\", \"radius\": 1 }",
         "scene:1:46: bodies[0].shape.half_height: expected a number, found nothing"},
        {"{ \"type\": \"capsule\", \"radius\": 1, \"half_height\": 0 }",
         "scene:1:95: bodies[0].shape.half_height: expected a finite number above 0, found 0"},
        {"{ \"type\": \"cylinder\", \"radius\": -1, \"half_height\": 1 }",
         "scene:1:78: bodies[0].shape.radius: expected a finite number above 0, found -1"},
        {"{ \"type\": \"cylinder\", \"radius\": 1, \"height\": 1 }",
         "bodies[0].shape.height: expected one of type, radius, half_height, found \"height\""},
        {"{ \"type\": \"hull\" }", "bodies[0].shape.points: expected an array, found nothing"},
        {"{ \"type\": \"hull\", \"points\": [] }",
         "bodies[0].shape.points: expected 4 to 65536 points, found 0"},
        {"{ \"type\": \"hull\", \"points\": [[0,0,0],[1,0],[0,1,0],[0,0,1]] }",
         "scene:1:83: bodies[0].shape.points[1]: expected an array of 3 numbers, found an array of "
         "2"},
        {"{ \"type\": \"hull\", \"points\": [[0,0,0],[1,0,null],[0,1,0],[0,0,1]] }",
         "scene:1:88: bodies[0].shape.points[1][2]: expected a number, found null"},
        {"{ \"type\": \"hull\", \"points\": [[0,0,0],[1,0,0],[0,1,0],[1,1,0]] }",
         "scene:1:74: bodies[0].shape.points: expected points that do not all lie in one plane, "
         "found 4 that do"},
        {"{ \"type\": \"mesh\" }",
         "bodies[0].shape.file: expected either file or vertices and triangles of a mesh, found "
         "neither"},
        {"{ \"type\": \"mesh\", \"file\": \"a.obj\", \"triangles\": [] }",
         "scene:1:64: bodies[0].shape.file: expected either file or vertices and triangles of a "
         "mesh, found both"},
        {"{ \"type\": \"mesh\", \"file\": \"a.obj\" }",
         "bodies[0].shape.file: expected vertices and triangles, since a scene from memory has no "
         "folder, found a file"},
        {"{ \"type\": \"mesh\", \"vertices\": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]] }",
         "bodies[0].shape.triangles: expected an array, found nothing"},
        {"{ \"type\": \"mesh\", \"vertices\": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], \"triangles\": "
         "[[0,1,2],[0,1,3],[0,2,3],[1,2,2.5]] }",
         "scene:1:154: bodies[0].shape.triangles[3][2]: expected the index of a vertex, found 2.5"},
        {"{ \"type\": \"mesh\", \"vertices\": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], \"triangles\": "
         "[[0,1,2],[0,1,3],[0,2,3],[1,2,1e300]] }",
         "bodies[0].shape.triangles[3][2]: expected the index of a vertex, found 1"},
        {"{ \"type\": \"mesh\", \"vertices\": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], \"triangles\": "
         "[[0,1,2],[0,1,3],[0,2,3],[1,2,4]] }",
         "scene:1:154: bodies[0].shape.triangles[3][2]: expected the index of a vertex from 0 to "
         "3, found 4 in triangle 3"},
        {"{ \"type\": \"mesh\", \"vertices\": [[0,0,0],[1,0,0],[0,1,0],[0,0,1e60]], \"triangles\": "
         "[[0,1,2],[0,1,3],[0,2,3],[1,2,3]] }",
         "bodies[0].shape.vertices[3][2]: expected a finite number of at most 1e+50, found 1e+60"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; ++i) {
        char text[1024];
        snprintf(
            text, sizeof text,
            "{ \"plumb_scene\": 1, \"bodies\": [{ \"shape\":    %s, \"name\": \"a\", \"mass\": "
            "1 }], \"shapes\": { \"stone\": { \"type\": \"sphere\", \"radius\": 1 } } }",
            faults[i].shape);
        expect_refused(text, faults[i].message);
    }
}

static void test_bad_named_shapes_are_refused_even_unused(void **state)
{
    (void)state;
    static const fault faults[] = {
        {"[]", "shapes: expected an object of shapes, found an array of 0"},
        {"{ \"\": { \"type\": \"sphere\", \"radius\": 1 } }",
         "expected a name of 1 to 63 bytes, found 0 bytes"},
        {"{ \"a\": \"b\" }", "shapes.a: expected an object, found \"b\""},
        {"{ \"a\": { \"type\": \"sphere\", \"radius\": -1 } }",
         "shapes.a.radius: expected a finite number above 0, found -1"},
        {"{ \"a b\": { \"type\": \"hull\", \"points\": [[0,0,0]] } }",
         "shapes[\"a b\"].points: expected 4 to 65536 points, found 1"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; ++i) {
        char text[512];
        snprintf(text, sizeof text, "{ \"plumb_scene\": 1, \"bodies\": [], \"shapes\": %s }",
                 faults[i].shape);
        expect_refused(text, faults[i].message);
    }
}

static void expect_invalid(const pl_scene *scene, const char *message)
{
    pl_error error = {.message = ""};
    assert_int_equal(pl_scene_validate(scene, &error), PL_BAD_INPUT);
    assert_contains(error.message, message);
}

static void test_shapes_of_code_keep_the_rules_of_files(void **state)
{
    (void)state;
    pl_scene other = empty_scene(), scene = empty_scene();
    const pl_polyhedron *foreign = add_hull(&other, NULL);
    add_body(&scene, "a", pl_shape_of(foreign));
    expect_invalid(&scene, "bodies[0].shape: expected a polyhedron of the scene, found another");
    scene.bodies[0].shape.polyhedron = NULL;
    expect_invalid(&scene, "bodies[0].shape: expected a polyhedron of the scene, found none");
    scene.bodies[0].shape = pl_shape_of(add_hull(&scene, "x"));
    assert_int_equal(pl_scene_validate(&scene, NULL), PL_OK);
    scene.bodies[0].shape.kind = PL_SHAPE_MESH;
    expect_invalid(&scene, "bodies[0].shape.type: expected a hull for this polyhedron, found a "
                           "mesh");
    scene.bodies[0].shape = pl_shape_capsule(1, nan(""));
    expect_invalid(&scene, "bodies[0].shape.half_height: expected a finite number above 0, found "
                           "nan");
    scene.bodies[0].shape = pl_shape_sphere(1);
    add_mesh(&scene, "x");
    expect_invalid(&scene, "shapes[1].name: expected a name of its own, found \"x\", which item 0 "
                           "has");
    pl_error error = {.message = ""};
    char long_name[80];
    memset(long_name, 'n', sizeof long_name);
    long_name[79] = '\0';
    assert_int_equal(pl_scene_add_hull(&scene, long_name, corners, 5, NULL, &error), PL_BAD_INPUT);
    assert_contains(error.message, "expected at most 63 bytes, found 79");
    assert_int_equal(scene.polyhedron_count, 2);
    pl_scene_free(&scene);
    pl_scene_free(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scene_of_all_shapes_reads_back),
        cmocka_unit_test(test_random_polyhedra_read_back_to_the_bit),
        cmocka_unit_test(test_shared_and_named_polyhedra_are_written_once),
        cmocka_unit_test(test_bodies_take_shapes_by_name),
        cmocka_unit_test(test_half_width_is_the_least_half_dimension),
        cmocka_unit_test(test_round_shapes_have_fine_polyhedron_moments),
        cmocka_unit_test(test_mesh_files_are_found_beside_the_scene),
        cmocka_unit_test(test_bad_shapes_are_refused_with_their_place),
        cmocka_unit_test(test_bad_named_shapes_are_refused_even_unused),
        cmocka_unit_test(test_shapes_of_code_keep_the_rules_of_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
