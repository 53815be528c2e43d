/* The report's pictures: the view, what hides what, and the drawing. */
#include "report/case_page.h"
#include "report/picture.h"

#include "check.h"
#include "polyhedra.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- Scenes by hand ---- */

static pl_scene empty_scene(double nx, double nz)
{
    pl_scene scene = pl_scene_default();
    pl_material material = {.name = "wood", .friction = 0.5};
    pl_body floor = pl_body_default();
    snprintf(scene.name, sizeof scene.name, "by hand");
    snprintf(floor.name, sizeof floor.name, "floor");
    floor.is_static = true;
    floor.shape = pl_shape_plane(nx, 0, nz, 0);
    assert_int_equal(pl_scene_add_material(&scene, &material, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_body(&scene, &floor, NULL, NULL), PL_OK);
    return scene;
}

static int add_body(pl_scene *scene, pl_shape shape, double x, double y, double z)
{
    pl_body body = pl_body_default();
    snprintf(body.name, sizeof body.name, "body %d", scene->body_count);
    body.shape = shape;
    body.position[0] = x;
    body.position[1] = y;
    body.position[2] = z;
    int index = -1;
    assert_int_equal(pl_scene_add_body(scene, &body, &index, NULL), PL_OK);
    return index;
}

static void expect_rest(pl_scene *scene, int body)
{
    pl_expect_rest rest = {.body = body, .orientation = {1, 0, 0, 0}, .has_orientation = true};
    memcpy(rest.position, scene->bodies[body].position, sizeof rest.position);
    assert_int_equal(pl_scene_add_rest(scene, &rest, NULL), PL_OK);
}

/* Two unit cubes, one on the other, expected to stay, and a ball next to them. */
static pl_scene tiny_scene(void)
{
    pl_scene scene = empty_scene(0, 1);
    expect_rest(&scene, add_body(&scene, pl_shape_box(0.5, 0.5, 0.5), 0, 0, 0.5));
    expect_rest(&scene, add_body(&scene, pl_shape_box(0.5, 0.5, 0.5), 0, 0, 1.5));
    add_body(&scene, pl_shape_sphere(0.4), 1.5, 0, 0.4);
    scene.collapse_distance = 0.5;
    return scene;
}

/* The poses of the start; the caller frees. */
static pl_pose *start_poses(const pl_scene *scene)
{
    pl_pose *poses = calloc((size_t)scene->body_count, sizeof *poses);
    for (int i = 0; i < scene->body_count; ++i) {
        poses[i] = pl_pose_of(&scene->bodies[i]);
    }
    return poses;
}

/* ---- View ---- */

static void test_view_is_a_right_handed_orthonormal_frame(void **state)
{
    (void)state;
    static const double gravities[][3] = {{0, 0, -9.81}, {0, 0, 0}, {3, 1, -9}, {9.81, 0, 0}};
    static const double tilts[] = {0, 0.3};
    for (int i = 0; i < 8; ++i) {
        pl_scene scene = empty_scene(sin(tilts[i % 2]), cos(tilts[i % 2]));
        add_body(&scene, pl_shape_box(3, 0.5, 1), 1, 2, 3);
        memcpy(scene.gravity, gravities[i / 2], sizeof scene.gravity);
        pl_view view = pl_view_choose(&scene, NULL, 0);
        assert_close(pl_vec_length(view.right), 1, 1e-12, 0);
        assert_close(pl_vec_length(view.up), 1, 1e-12, 0);
        pl_vec toward = pl_vec_cross(view.right, view.up);
        assert_close(pl_vec_length(pl_vec_mad(toward, -1, view.toward)), 0, 1e-12, 0);
        pl_scene_free(&scene);
    }
}

static void test_slope_is_seen_edge_on_falling_right(void **state)
{
    (void)state;
    for (int way = -1; way <= 1; way += 2) {
        pl_scene scene = empty_scene(way * 0.6, 0.8);
        add_body(&scene, pl_shape_box(0.5, 0.5, 0.5), 0, 0, 2);
        pl_view view = pl_view_choose(&scene, NULL, 0);
        pl_vec normal = {way * 0.6, 0, 0.8}, downhill = {way * 0.8, 0, -0.6};
        assert_close(pl_vec_dot(normal, view.toward), 0, 1e-12, 0);
        assert_true(pl_vec_dot(downhill, view.right) > 0);
        pl_scene_free(&scene);
    }
}

static void test_level_scene_is_seen_from_front_and_above(void **state)
{
    (void)state;
    pl_scene scene = empty_scene(0, 1);
    for (int i = 0; i < 8; ++i) {
        add_body(&scene, pl_shape_box(0.5, 0.5, 0.5), 0, i, 0.5); /* a row along y */
    }
    pl_view view = pl_view_choose(&scene, NULL, 0);
    assert_true(fabs(view.right.y) > fabs(view.right.x));
    assert_true(view.toward.z > 0.1 && view.toward.z < 0.4);
    assert_close(view.right.z, 0, 1e-12, 0);
    pl_scene_free(&scene);
}

static void test_frame_holds_all_poses_except_far_ones(void **state)
{
    (void)state;
    pl_scene scene = tiny_scene();
    pl_pose *poses = start_poses(&scene);
    pl_view still = pl_view_choose(&scene, NULL, 0);
    for (int i = 1; i < scene.body_count; ++i) {
        pl_pixel at = pl_view_project(&still, pl_vec_of(scene.bodies[i].position));
        assert_true(at.x > 0 && at.x < still.width && at.y > 0 && at.y < still.height);
    }
    poses[3].position[0] = 3;
    const pl_pose *runs[] = {poses};
    pl_view moved = pl_view_choose(&scene, runs, 1);
    pl_pixel at = pl_view_project(&moved, pl_vec_of(poses[3].position));
    assert_true(at.x > 0 && at.x < moved.width);
    poses[3].position[0] = 1e9;
    pl_view fled = pl_view_choose(&scene, runs, 1);
    assert_true(fled.scale > still.scale / 4);
    poses[3].position[0] = (double)NAN;
    pl_view lost = pl_view_choose(&scene, runs, 1);
    assert_close(lost.scale, still.scale, 0, 1e-12);
    free(poses);
    pl_scene_free(&scene);
}

/* ---- Painting order ---- */

/* A square facing the eye. */
static pl_face square(double x, double y, double size, double depth, int shade)
{
    return (pl_face){.corner = {{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}},
                     .depth = {depth, depth, depth, depth},
                     .shade = shade};
}

static void test_covered_faces_are_dropped_and_others_sorted(void **state)
{
    (void)state;
    pl_face faces[] = {square(10, 10, 20, 5, 1), square(0, 0, 50, 1, 2), square(12, 12, 4, 3, 3),
                       square(25, 25, 20, 9, 4)};
    pl_painting painting = {faces, 4};
    assert_true(pl_painting_arrange(&painting, 60, 60));
    assert_int_equal(painting.count, 3);
    assert_int_equal(faces[0].shade, 2);
    assert_int_equal(faces[1].shade, 1);
    assert_int_equal(faces[2].shade, 4);
}

static void test_cycle_of_faces_is_painted_each_once(void **state)
{
    (void)state;
    /* Three bars, each over the next at one end and under the previous at the other. */
    pl_face faces[3];
    for (int i = 0; i < 3; ++i) {
        double angle = i * 2.0943951023931953;
        double c = cos(angle), s = sin(angle);
        static const double bar[4][2] = {{-30, -14}, {30, -14}, {30, -6}, {-30, -6}};
        for (int k = 0; k < 4; ++k) {
            faces[i].corner[k] =
                (pl_pixel){40 + c * bar[k][0] - s * bar[k][1], 40 + s * bar[k][0] + c * bar[k][1]};
            faces[i].depth[k] = bar[k][0];
        }
        faces[i].radius = 0;
        faces[i].shade = i;
    }
    pl_painting painting = {faces, 3};
    assert_true(pl_painting_arrange(&painting, 80, 80));
    assert_int_equal(painting.count, 3);
    assert_int_equal(1 << faces[0].shade | 1 << faces[1].shade | 1 << faces[2].shade, 7);
}

/* The face that is on top where painting ends, by repainting; -1 for none. */
static int painted_last(const pl_painting *painting, double x, double y)
{
    int top = -1;
    for (int f = 0; f < painting->count; ++f) {
        bool left = false, right = false;
        for (int i = 0; i < 4; ++i) {
            double area = pl_pixel_turn(painting->faces[f].corner[i],
                                        painting->faces[f].corner[(i + 1) % 4], (pl_pixel){x, y});
            left |= area > 0;
            right |= area < 0;
        }
        if (!(left && right)) {
            top = painting->faces[f].shade;
        }
    }
    return top;
}

static void test_painting_shows_the_nearest_face_at_every_sample(void **state)
{
    (void)state;
    check_random random = {20250101};
    enum { COUNT = 120 };
    for (int trial = 0; trial < 20; ++trial) {
        pl_face faces[COUNT], original[COUNT];
        for (int i = 0; i < COUNT; ++i) {
            double size = check_uniform(&random, 3, 40);
            double y = check_uniform(&random, -10, 90), x = check_uniform(&random, -10, 90);
            faces[i] = square(x, y, size, i * 7 % COUNT, i);
        }
        memcpy(original, faces, sizeof faces);
        pl_painting painting = {faces, COUNT};
        assert_true(pl_painting_arrange(&painting, 100, 100));
        for (int s = 0; s < 40000; ++s) {
            double x = s % 200 * 0.5 + 0.25, y = (double)(s / 200) * 0.5 + 0.25;
            int nearest = -1;
            for (int i = 0; i < COUNT; ++i) {
                const pl_face *face = &original[i];
                if (x >= face->corner[0].x && x <= face->corner[2].x && y >= face->corner[0].y &&
                    y <= face->corner[2].y &&
                    (nearest < 0 || face->depth[0] > original[nearest].depth[0])) {
                    nearest = i;
                }
            }
            assert_int_equal(painted_last(&painting, x, y), nearest);
        }
    }
}

/* ---- Drawing ---- */

static void draw(const pl_scene *scene, const pl_pose *poses, pl_text_buffer *out)
{
    const pl_pose *runs[] = {poses};
    pl_view view = pl_view_choose(scene, runs, 1);
    pl_svg_expected(scene, &view, "expected-0", out);
    pl_svg_picture(scene, &view, poses, "expected-0", "tiny <scene>", out);
    assert_false(out->failed);
}

/* PLUMB_UPDATE_GOLDEN=1 writes it again: read the difference before you keep it. */
static void test_tiny_scene_draws_as_in_the_golden_file(void **state)
{
    (void)state;
    static const char path[] = PLUMB_SOURCE_DIR "/tests/compare/golden/report_tiny.svg";
    pl_scene scene = tiny_scene();
    pl_pose *poses = start_poses(&scene);
    poses[2].position[0] = 0.7; /* the upper cube has fallen off */
    poses[2].orientation[0] = cos(0.3);
    poses[2].orientation[2] = sin(0.3);
    pl_text_buffer out = {0};
    draw(&scene, poses, &out);
    pl_text_add(&out, "\n");
    if (getenv("PLUMB_UPDATE_GOLDEN") != NULL) {
        FILE *file = fopen(path, "wb");
        assert_non_null(file);
        fputs(out.data, file);
        fclose(file);
    }
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    char golden[8192] = "";
    size_t length = fread(golden, 1, sizeof golden - 1, file);
    fclose(file);
    assert_true(length < sizeof golden - 1);
    assert_string_equal(out.data, golden);
    pl_text_free(&out);
    free(poses);
    pl_scene_free(&scene);
}

static void test_standing_body_is_not_drawn_as_fallen(void **state)
{
    (void)state;
    pl_scene scene = tiny_scene();
    pl_pose *poses = start_poses(&scene);
    pl_text_buffer stands = {0}, leans = {0}, falls = {0};
    draw(&scene, poses, &stands);
    assert_int_equal(count_of(stands.data, "<path class=\"f"), 0);
    assert_int_equal(count_of(stands.data, "<path class=\"d"), 5); /* one top is covered */
    assert_contains(stands.data, "<title>tiny &lt;scene&gt;</title>");
    poses[2].position[0] = 0.49; /* of 0.5 */
    draw(&scene, poses, &leans);
    assert_int_equal(count_of(leans.data, "<path class=\"f"), 0);
    poses[2].position[0] = 0.51;
    draw(&scene, poses, &falls);
    assert_int_equal(count_of(falls.data, "<path class=\"f"), 3);
    pl_text_free(&stands);
    pl_text_free(&leans);
    pl_text_free(&falls);
    free(poses);
    pl_scene_free(&scene);
}

static void test_body_outside_is_counted_and_not_drawn(void **state)
{
    (void)state;
    pl_scene scene = tiny_scene();
    pl_pose *poses = start_poses(&scene);
    pl_view view = pl_view_choose(&scene, NULL, 0);
    static const double far[] = {1e6, 1e300, (double)INFINITY, (double)NAN};
    for (int i = 0; i < 4; ++i) {
        poses[3].position[0] = far[i];
        pl_text_buffer out = {0};
        assert_int_equal(pl_svg_picture(&scene, &view, poses, "e", "t", &out), 1);
        assert_int_equal(count_of(out.data, "<circle"), 0);
        pl_text_free(&out);
    }
    free(poses);
    pl_scene_free(&scene);
}

static void test_thousand_bricks_draw_in_a_tenth_megabyte(void **state)
{
    (void)state;
    pl_scene scene = empty_scene(0, 1);
    for (int i = 0; i < 1000; ++i) {
        add_body(&scene, pl_shape_box(0.5, 0.25, 0.25), i % 40, 0, 0.25 + 0.5 * (double)(i / 40));
    }
    pl_pose *poses = start_poses(&scene);
    pl_text_buffer out = {0};
    draw(&scene, poses, &out);
    assert_at_most((double)out.length, 100e3);
    assert_true(count_of(out.data, "<path class=\"d") >= 1000); /* every front is seen */
    assert_true(count_of(out.data, "<path class=\"d") < 1100);  /* nothing between bricks is */
    pl_text_free(&out);
    free(poses);
    pl_scene_free(&scene);
}

/* Of a cube as a mesh or a hull the six triangles that look at the eye; of round ones about half of
 * their facets, as fine as the picture shows. */
static void test_shapes_are_drawn_by_facets_facing_the_eye(void **state)
{
    (void)state;
    pl_scene scene = empty_scene(0, 1);
    const double half[3] = {0.5, 0.5, 0.5}, middle[3] = {4, 4, 4};
    const pl_polyhedron *cube = box_mesh(&scene, half, middle, 1), *hull = NULL;
    assert_int_equal(
        pl_scene_add_hull(&scene, NULL, (const double(*)[3])cube->vertices, 8, &hull, NULL), PL_OK);
    const pl_shape shapes[] = {pl_shape_of(cube), pl_shape_of(hull), pl_shape_capsule(0.3, 0.5),
                               pl_shape_cylinder(0.3, 0.5),
                               pl_shape_of(torus_mesh(&scene, 1, 0.25, 24, 12))};
    static const int least[] = {6, 6, 60, 15, 150}, most[] = {6, 6, 130, 30, 350};
    for (int i = 0; i < 5; ++i) {
        expect_rest(&scene, add_body(&scene, shapes[i], -4, -4, -3));
        pl_pose *poses = start_poses(&scene);
        pl_text_buffer out = {0};
        draw(&scene, poses, &out);
        int faces = count_of(out.data, "<path class=\"d");
        assert_in_range(faces, least[i], most[i]);
        assert_int_equal(count_of(out.data, " fine\""), faces);
        assert_contains(out.data, "<path class=\"expected\" d=\"M");
        pl_text_free(&out);
        free(poses);
        scene.body_count = 1; /* the next one alone */
        scene.rest_count = 0;
    }
    pl_scene_free(&scene);
}

static void test_thousand_meshes_draw_in_two_megabytes(void **state)
{
    (void)state;
    check_random random = {UINT64_C(20250101)};
    pl_scene scene = empty_scene(0, 1);
    pl_shape ring = pl_shape_of(torus_mesh(&scene, 0.3, 0.12, 25, 10));
    for (int i = 0; i < 1000; ++i) {
        double z = check_uniform(&random, 0.4, 5);
        double y = check_uniform(&random, -3, 3), x = check_uniform(&random, -3, 3);
        int body = add_body(&scene, ring, x, y, z);
        check_quaternion(&random, scene.bodies[body].orientation);
    }
    pl_pose *poses = start_poses(&scene);
    pl_text_buffer out = {0};
    draw(&scene, poses, &out);
    assert_at_most((double)out.length, 2e6);
    pl_text_free(&out);
    free(poses);
    pl_scene_free(&scene);
}

/* ---- From results ---- */

/* A result of one engine on a scene, with the scene's own poses. */
static json_t *result_of(const pl_scene *scene, const char *scenario, json_t *params)
{
    char hash[17];
    assert_int_equal(pl_scene_hash(scene, hash, NULL), PL_OK);
    json_t *poses = json_array();
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        const double *p = body->position, *q = body->orientation;
        json_array_append_new(
            poses, json_pack("[f, f, f, f, f, f, f]", p[0], p[1], p[2], q[0], q[1], q[2], q[3]));
    }
    return json_pack("[{s:s, s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:{}, s:{s:f, s:f}}]", "schema",
                     "plumb.result/1", "scenario", scenario, "engine", "ode", "label", "ode:quick",
                     "outcome", "ok", "scene_hash", hash, "params", params, "final_poses", poses,
                     "metrics", "settings", "dt", scene->dt, "duration", scene->duration);
}

/* Returns the pictures of the one case in `results`, which it takes. The caller frees the text. */
static char *pictures_of(json_t *results)
{
    pl_result_matrix matrix;
    pl_text_buffer out = {0};
    assert_int_equal(pl_result_matrix_build(results, &matrix, NULL), PL_OK);
    assert_int_equal(matrix.case_count, 1);
    pl_case_pictures(&matrix, 0, &out);
    assert_false(out.failed);
    pl_result_matrix_free(&matrix);
    json_decref(results);
    return out.data;
}

static void test_every_scenario_of_the_catalogue_gets_its_picture(void **state)
{
    (void)state;
    int count = 0;
    const pl_scenario *const *all = pl_scenarios(&count);
    assert_true(count > 0);
    for (int i = 0; i < count; ++i) {
        double values[PL_MAX_PARAMS];
        assert_int_equal(pl_scenario_values(all[i], NULL, 0, values, NULL), PL_OK);
        pl_scene scene;
        assert_int_equal(pl_scenario_build(all[i], values, 0, &scene, NULL), PL_OK);
        json_t *params = json_object();
        for (int k = 0; k < all[i]->param_count; ++k) {
            json_object_set_new(params, all[i]->params[k].name, json_real(values[k]));
        }
        char *text = pictures_of(result_of(&scene, all[i]->name, params));
        if (strstr(text, "<svg viewBox") == NULL || strstr(text, "outside") != NULL) {
            fail_msg("%s: %.200s", all[i]->name, text);
        }
        free(text);
        pl_scene_free(&scene);
    }
}

/* Writes the scene where `path` says; the caller removes it. */
static void write_scene(const pl_scene *scene, char path[64])
{
    snprintf(path, 64, "/tmp/plumb-scene-XXXXXX");
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    char *text = pl_scene_to_text(scene);
    assert_int_equal(write(descriptor, text, strlen(text)), strlen(text));
    close(descriptor);
    free(text);
}

static void test_scene_file_gets_pictures_at_the_runs_step(void **state)
{
    (void)state;
    char path[64];
    pl_scene scene = tiny_scene();
    write_scene(&scene, path);
    scene.dt = 1.0 / 240; /* as --dt does */
    scene.duration = 2;
    char *text = pictures_of(result_of(&scene, path, json_object()));
    assert_contains(text, "<svg viewBox");
    free(text);
    unlink(path);
    pl_scene_free(&scene);
}

static void test_changed_scene_gets_a_reason_instead_of_pictures(void **state)
{
    (void)state;
    char path[64];
    pl_scene scene = tiny_scene();
    json_t *results = result_of(&scene, "", json_object());
    scene.bodies[1].position[0] = 0.1;
    write_scene(&scene, path);
    json_object_set_new(json_array_get(results, 0), "scenario", json_string(path));
    char *text = pictures_of(results);
    assert_contains(text, "No pictures: the scene as it is built today");
    free(text);
    unlink(path);
    pl_scene_free(&scene);
}

static void test_unreadable_scene_gets_a_reason_instead_of_pictures(void **state)
{
    (void)state;
    static const char *const names[] = {
        "/nonexistent.json", "-", "/dev/zero", "/tmp", "", "no such"};
    pl_scene scene = tiny_scene();
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        char *text = pictures_of(result_of(&scene, names[i], json_object()));
        assert_contains(text, "No pictures: there is no scene file");
        free(text);
    }
    pl_scene_free(&scene);
}

static void test_run_without_poses_gets_a_panel_with_reason(void **state)
{
    (void)state;
    char path[64];
    pl_scene scene = tiny_scene();
    write_scene(&scene, path);
    static const char *const poses[][2] = {
        {"null", "no final poses were recorded"},
        {"7", "no final poses were recorded"},
        {"[[0,0,0,1,0,0,0]]", "1 poses for 4 bodies"},
    };
    for (size_t i = 0; i < sizeof poses / sizeof poses[0]; ++i) {
        json_t *results = result_of(&scene, path, json_object());
        json_object_set_new(json_array_get(results, 0), "final_poses",
                            json_loads(poses[i][0], JSON_DECODE_ANY, NULL));
        char *text = pictures_of(results);
        assert_contains(text, "class=\"empty\"");
        assert_contains(text, poses[i][1]);
        free(text);
    }
    json_t *results = result_of(&scene, path, json_object());
    json_object_set_new(json_array_get(results, 0), "final_poses",
                        json_loads("[[],null,[\"x\"],{}]", 0, NULL));
    char *text = pictures_of(results);
    assert_contains(text, "3 bodies are outside the picture");
    free(text);
    unlink(path);
    pl_scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_view_is_a_right_handed_orthonormal_frame),
        cmocka_unit_test(test_slope_is_seen_edge_on_falling_right),
        cmocka_unit_test(test_level_scene_is_seen_from_front_and_above),
        cmocka_unit_test(test_frame_holds_all_poses_except_far_ones),
        cmocka_unit_test(test_covered_faces_are_dropped_and_others_sorted),
        cmocka_unit_test(test_cycle_of_faces_is_painted_each_once),
        cmocka_unit_test(test_painting_shows_the_nearest_face_at_every_sample),
        cmocka_unit_test(test_tiny_scene_draws_as_in_the_golden_file),
        cmocka_unit_test(test_standing_body_is_not_drawn_as_fallen),
        cmocka_unit_test(test_body_outside_is_counted_and_not_drawn),
        cmocka_unit_test(test_thousand_bricks_draw_in_a_tenth_megabyte),
        cmocka_unit_test(test_shapes_are_drawn_by_facets_facing_the_eye),
        cmocka_unit_test(test_thousand_meshes_draw_in_two_megabytes),
        cmocka_unit_test(test_every_scenario_of_the_catalogue_gets_its_picture),
        cmocka_unit_test(test_scene_file_gets_pictures_at_the_runs_step),
        cmocka_unit_test(test_changed_scene_gets_a_reason_instead_of_pictures),
        cmocka_unit_test(test_unreadable_scene_gets_a_reason_instead_of_pictures),
        cmocka_unit_test(test_run_without_poses_gets_a_panel_with_reason),
    };
    return cmocka_run_group_tests_name("report_pictures", tests, NULL, NULL);
}
