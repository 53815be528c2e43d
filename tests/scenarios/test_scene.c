/* The scene model made by code: growth, shapes, pairs, validation, needs. Also the base helpers. */
#include "base/name_index.h"
#include "base/number.h"
#include "base/random.h"
#include "check.h"
#include "plumb/scenario.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void test_error_has_status_and_may_be_null(void **state)
{
    (void)state;
    pl_error error = {.status = PL_OK};
    assert_int_equal(pl_fail(&error, PL_IO, "%s: %d", "file", 7), PL_IO);
    assert_int_equal(error.status, PL_IO);
    assert_string_equal(error.message, "file: 7");
    assert_int_equal(pl_fail(NULL, PL_FAILED, "x"), PL_FAILED);
}

static void test_long_message_is_cut_between_characters(void **state)
{
    (void)state;
    char text[1024];
    for (size_t shift = 0; shift < 3; ++shift) {
        size_t length = 0;
        for (; length < shift; ++length) {
            text[length] = 'x';
        }
        for (; length + 3 < sizeof text; length += 3) {
            memcpy(text + length, "€", 3);
        }
        text[length] = '\0';
        pl_error error;
        pl_fail(&error, PL_FAILED, "%s", text);
        size_t kept = strlen(error.message);
        assert_in_range(kept, sizeof error.message - 5, sizeof error.message - 1);
        assert_int_equal((kept - shift) % 3, 0);
    }
}

static void test_nearest_name_is_within_a_third(void **state)
{
    (void)state;
    static const char *const names[] = {"tower", "wall", "wall-collapse", "slope-slide"};
    assert_string_equal(pl_nearest_name("towr", names, 4), "tower");
    assert_string_equal(pl_nearest_name("slope_slid", names, 4), "slope-slide");
    assert_string_equal(pl_nearest_name("wall", names, 4), "wall");
    assert_null(pl_nearest_name("pyramid", names, 4));
    /* "wall" is 3 and 4 letters off; 1 + 7 / 3 = 1 + 8 / 3 = 3 are allowed. */
    assert_string_equal(pl_nearest_name("wall-co", names, 4), "wall");
    assert_null(pl_nearest_name("wall-cox", names, 4));
    assert_null(pl_nearest_name("", names, 0));
}

static void test_numbers_are_decimals_or_ratios(void **state)
{
    (void)state;
    static const char *const bad[] = {"",   " 1",  "1 ",    "0x1", "inf", "nan", "1e999", "1/",
                                      "/2", "1/0", "1/2/3", "1,5", "-",   "1e",  "--1"};
    double value = 0;
    assert_true(pl_parse_number("-2.5e-3", &value));
    assert_close(value, -0.0025, 0, 0);
    assert_true(pl_parse_number("1/60", &value));
    assert_close(value, 1.0 / 60, 0, 0);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        if (pl_parse_number(bad[i], &value)) {
            fail_msg("\"%s\" was read as %g", bad[i], value);
        }
    }
}

static void test_number_text_is_short_and_reads_back(void **state)
{
    (void)state;
    char text[PL_NUMBER_SIZE];
    assert_string_equal(pl_number_text(0.1, text), "0.1");
    assert_string_equal(pl_number_text(-0.0, text), "-0");
    assert_string_equal(pl_number_text(100, text), "100");
    assert_string_equal(pl_number_text(HUGE_VAL, text), "inf");
    pl_random random = {.state = 1};
    for (int i = 0; i < 100000; ++i) {
        uint64_t bits = pl_random_bits(&random);
        double value;
        memcpy(&value, &bits, sizeof value);
        if (isfinite(value)) {
            assert_close(strtod(pl_number_text(value, text), NULL), value, 0, 0);
        }
    }
}

/* The shortest of "%.15g", "%.16g" and "%.17g" that reads back, by the C library. */
static void by_printf(double value, char text[PL_NUMBER_SIZE])
{
    int digits = 15;
    do {
        (void)snprintf(text, PL_NUMBER_SIZE, "%.*g", digits, value);
    } while (strtod(text, NULL) != value && ++digits <= 17);
}

/* Numbers of few digits, powers of 2 and of 10, their neighbours, and any others. */
static void test_number_text_is_that_of_printf(void **state)
{
    (void)state;
    char text[PL_NUMBER_SIZE], expected[PL_NUMBER_SIZE];
    pl_random random = {.state = 2};
    for (int i = 0; i < 200000; ++i) {
        const double uniform = pl_random_unit(&random);
        const int power = (int)(pl_random_bits(&random) % 24) - 6;
        double value = ldexp(1, 3 * power);
        if (i % 4 == 1) {
            value = pow(10, power);
        } else if (i % 4 == 2) {
            value = floor(1e4 * uniform) / 1000;
        } else if (i % 4 == 3) {
            value = uniform * pow(10, power);
        }
        if (i % 3 > 0) {
            value = nextafter(value, i % 3 == 1 ? 0 : HUGE_VAL);
        }
        value = i % 5 == 0 ? -value : value;
        by_printf(value, expected);
        assert_string_equal(pl_number_text(value, text), expected);
    }
}

/* Vigna's splitmix64.c from seed 1234567 gives 6457827717110365317 first: a known answer. */
static void test_random_bits_are_splitmix64(void **state)
{
    (void)state;
    pl_random random = {.state = 1234567};
    assert_true(pl_random_bits(&random) == UINT64_C(6457827717110365317));
    assert_true(pl_random_bits(&random) == UINT64_C(3203168211198807973));
    double sum = 0;
    for (int i = 0; i < 100000; ++i) {
        double unit = pl_random_unit(&random);
        assert_true(unit >= 0 && unit < 1);
        sum += unit;
    }
    assert_close(sum / 100000, 0.5, 5 / sqrt(12.0 * 100000), 0); /* five standard deviations */
}

static void test_name_index_finds_names_and_the_first_duplicate(void **state)
{
    (void)state;
    static const char names[][8] = {"pear", "fig", "apple", "fig", "pear"};
    pl_name_index index;
    assert_int_equal(pl_name_index_create(names[0], sizeof names[0], 5, &index), PL_OK);
    assert_int_equal(pl_name_index_find(&index, "pear"), 0);
    assert_int_equal(pl_name_index_find(&index, "fig"), 1);
    assert_int_equal(pl_name_index_find(&index, "apple"), 2);
    assert_int_equal(pl_name_index_find(&index, "plum"), -1);
    assert_int_equal(pl_name_index_duplicate(&index), 3);
    assert_string_equal(pl_name_index_nearest(&index, "aple"), "apple");
    pl_name_index_free(&index);
    assert_int_equal(pl_name_index_create(names[0], sizeof names[0], 3, &index), PL_OK);
    assert_int_equal(pl_name_index_duplicate(&index), -1);
    pl_name_index_free(&index);
    assert_int_equal(pl_name_index_create(NULL, 0, 0, &index), PL_OK);
    assert_int_equal(pl_name_index_find(&index, "fig"), -1);
    assert_null(pl_name_index_nearest(&index, "fig"));
    pl_name_index_free(&index);
}

/* Of names that are equally near, the first of the alphabet is suggested, in whatever order they
 * are. */
static void test_name_index_of_many_names(void **state)
{
    (void)state;
    enum { COUNT = 5000 };
    char(*names)[16] = calloc(COUNT, sizeof *names);
    assert_non_null(names);
    for (int i = 0; i < COUNT; ++i) {
        snprintf(names[i], sizeof names[i], "body %d", COUNT - i);
    }
    pl_name_index index;
    assert_int_equal(pl_name_index_create(names[0], sizeof names[0], COUNT, &index), PL_OK);
    for (int i = 0; i < COUNT; ++i) {
        char copy[16];
        memcpy(copy, names[i], sizeof copy);
        assert_int_equal(pl_name_index_find(&index, copy), i);
    }
    assert_int_equal(pl_name_index_find(&index, "body 0"), -1);
    assert_int_equal(pl_name_index_duplicate(&index), -1);
    assert_string_equal(pl_name_index_nearest(&index, "bod 77"), "body 77");
    assert_string_equal(pl_name_index_nearest(&index, "body x"), "body 1");
    pl_name_index_free(&index);
    free(names);
}

/* Mean squares of the coordinates by the midpoint rule on a grid of cells: the integrals
 * themselves. */
static void integrate(const pl_shape *shape, const double half[3], double *volume,
                      double squares[3])
{
    enum { CELLS = 100 };
    const double cell = 8 * half[0] * half[1] * half[2] / ((double)CELLS * CELLS * CELLS);
    *volume = squares[0] = squares[1] = squares[2] = 0;
    for (int i = 0; i < CELLS * CELLS * CELLS; ++i) {
        const int place[3] = {i % CELLS, i / CELLS % CELLS, i / CELLS / CELLS};
        double x[3], r2 = 0;
        for (int k = 0; k < 3; ++k) {
            x[k] = half[k] * ((2 * place[k] + 1.0) / CELLS - 1);
            r2 += x[k] * x[k];
        }
        if (shape->kind == PL_SHAPE_SPHERE && r2 > shape->radius * shape->radius) {
            continue;
        }
        *volume += cell;
        for (int k = 0; k < 3; ++k) {
            squares[k] += cell * x[k] * x[k];
        }
    }
}

static void check_solid(const pl_shape *shape, const double half[3], double tolerance)
{
    double volume, squares[3], inertia[3];
    integrate(shape, half, &volume, squares);
    pl_shape_inertia(shape, 7, inertia);
    assert_close(pl_shape_volume(shape), volume, 0, tolerance);
    for (int k = 0; k < 3; ++k) {
        double expected = 7 * (squares[(k + 1) % 3] + squares[(k + 2) % 3]) / volume;
        assert_close(inertia[k], expected, 0, tolerance);
    }
}

static void test_volume_and_inertia_equal_quadrature(void **state)
{
    (void)state;
    const double box_half[3] = {0.5, 1.5, 0.25}, ball_half[3] = {0.75, 0.75, 0.75};
    const pl_shape box = pl_shape_box(0.5, 1.5, 0.25), ball = pl_shape_sphere(0.75);
    check_solid(&box, box_half, 2e-4);   /* the midpoint rule: 1 / CELLS^2 */
    check_solid(&ball, ball_half, 2e-3); /* its surface cuts cells */
    const pl_shape plane = pl_shape_plane(0, 0, 1, 0);
    assert_close(pl_shape_volume(&plane), 0, 0, 0);
}

static pl_body named_body(const char *name, pl_shape shape)
{
    pl_body body = pl_body_default();
    snprintf(body.name, sizeof body.name, "%s", name);
    body.shape = shape;
    return body;
}

/* A floor, a box and a ball of two materials, with a force and both kinds of expectation. */
static pl_scene make_scene(void)
{
    pl_scene scene = pl_scene_default();
    const pl_material ice = {.name = "ice", .friction = 0.04, .restitution = 0.5};
    const pl_material oak = {.name = "oak", .friction = 0.36, .restitution = 0.25};
    pl_body floor = named_body("floor", pl_shape_plane(0, 0, 1, 0));
    pl_body box = named_body("box", pl_shape_box(0.5, 0.5, 0.5));
    pl_body ball = named_body("ball", pl_shape_sphere(0.5));
    floor.is_static = true;
    box.material = ball.material = 1;
    const pl_force force = {.body = 1, .force = {1, 0, 0}, .until = HUGE_VAL};
    const pl_expect_rest rest = {.body = 1};
    const pl_expect_travel travel = {
        .body = 2, .direction = {1, 0, 0}, .distance = 1, .discrete = 1};
    assert_int_equal(pl_scene_add_material(&scene, &ice, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_material(&scene, &oak, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_body(&scene, &floor, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_body(&scene, &box, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_body(&scene, &ball, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_force(&scene, &force, NULL), PL_OK);
    assert_int_equal(pl_scene_add_rest(&scene, &rest, NULL), PL_OK);
    assert_int_equal(pl_scene_add_travel(&scene, &travel, NULL), PL_OK);
    return scene;
}

static void test_arrays_keep_added_items(void **state)
{
    (void)state;
    enum { COUNT = 1000 };
    pl_scene scene = pl_scene_default();
    for (int i = 0; i < COUNT; ++i) {
        pl_body body = named_body("", pl_shape_sphere(1 + i));
        const pl_force force = {.body = i};
        int index = -1;
        snprintf(body.name, sizeof body.name, "body %d", i);
        assert_int_equal(pl_scene_add_body(&scene, &body, &index, NULL), PL_OK);
        assert_int_equal(pl_scene_add_force(&scene, &force, NULL), PL_OK);
        assert_int_equal(index, i);
    }
    for (int i = 0; i < COUNT; ++i) {
        char name[PL_NAME_SIZE];
        snprintf(name, sizeof name, "body %d", i);
        assert_string_equal(scene.bodies[i].name, name);
        assert_close(scene.bodies[i].shape.radius, 1 + i, 0, 0);
        assert_int_equal(scene.forces[i].body, i);
    }
    pl_scene_free(&scene);
    assert_int_equal(scene.body_count, 0);
    assert_null(scene.bodies);
    pl_scene_free(&scene);
    pl_scene_free(NULL);
}

static void test_added_body_gets_inertia_and_drops_extras(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    pl_body box = named_body("box", pl_shape_box(0.5, 0.5, 0.5));
    box.mass = 6;
    assert_int_equal(pl_scene_add_body(&scene, &box, NULL, NULL), PL_OK);
    assert_close(scene.bodies[0].inertia[2], 1, 0, 1e-15); /* m (1 + 1) / 12 */
    box.inertia[0] = box.inertia[1] = box.inertia[2] = 3;
    assert_int_equal(pl_scene_add_body(&scene, &box, NULL, NULL), PL_OK);
    assert_close(scene.bodies[1].inertia[2], 3, 0, 0);
    box.is_static = true;
    assert_int_equal(pl_scene_add_body(&scene, &box, NULL, NULL), PL_OK);
    assert_close(scene.bodies[2].mass + scene.bodies[2].inertia[0], 0, 0, 0);
    pl_body plane = named_body("plane", pl_shape_plane(0, 0, 1, 2));
    plane.is_static = true;
    plane.position[0] = 5;
    assert_int_equal(pl_scene_add_body(&scene, &plane, NULL, NULL), PL_OK);
    assert_close(scene.bodies[3].position[0], 0, 0, 0);
    pl_scene_free(&scene);
}

static void test_materials_beyond_the_limit_are_refused(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    pl_error error = {.message = ""};
    const pl_material material = {.name = "m"};
    for (int i = 0; i < PL_MAX_MATERIALS; ++i) {
        assert_int_equal(pl_scene_add_material(&scene, &material, NULL, NULL), PL_OK);
    }
    assert_int_equal(pl_scene_add_material(&scene, &material, NULL, &error), PL_BAD_INPUT);
    assert_contains(error.message, "at most 256 materials");
    assert_int_equal(scene.material_count, PL_MAX_MATERIALS);
    pl_scene_free(&scene);
}

static void test_pair_mixes_or_is_overridden_in_either_order(void **state)
{
    (void)state;
    pl_scene scene = make_scene();
    double friction, restitution;
    pl_scene_pair(&scene, 0, 1, &friction, &restitution);
    assert_close(friction, 0.12, 0, 1e-15); /* sqrt(0.04 * 0.36) */
    assert_close(restitution, 0.5, 0, 0);
    for (int i = 0; i < 2; ++i) {
        pl_scene_pair(&scene, i, i, &friction, &restitution);
        assert_close(friction, scene.materials[i].friction, 0, 0);
        assert_close(restitution, scene.materials[i].restitution, 0, 0);
    }
    const pl_material_pair pair = {.material_a = 1, .material_b = 0, .friction = 0.7};
    assert_int_equal(pl_scene_add_pair(&scene, &pair, NULL), PL_OK);
    for (int i = 0; i < 2; ++i) {
        pl_scene_pair(&scene, i, 1 - i, &friction, &restitution);
        assert_close(friction, 0.7, 0, 0);
        assert_close(restitution, 0, 0, 0);
    }
    pl_scene_free(&scene);
}

static void test_steps_are_rounded(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    assert_int_equal(pl_scene_steps(&scene), 300);
    scene.dt = 0.1;
    scene.duration = 0.3; /* 0.3 / 0.1 is a little below 3 */
    assert_int_equal(pl_scene_steps(&scene), 3);
    scene.duration = 0.26;
    assert_int_equal(pl_scene_steps(&scene), 3);
}

static void test_default_scene_with_a_body_is_valid(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    pl_error error = {.message = ""};
    assert_int_equal(pl_scene_validate(&scene, &error), PL_BAD_INPUT);
    assert_string_equal(error.message, "bodies: expected 1 to 200000 bodies, found 0");
    scene = make_scene();
    assert_int_equal(pl_scene_validate(&scene, &error), PL_OK);
    pl_scene_free(&scene);
}

static void break_gravity(pl_scene *scene)
{
    scene->gravity[1] = HUGE_VAL;
}
static void break_dt(pl_scene *scene)
{
    scene->dt = nan("");
}
static void break_duration(pl_scene *scene)
{
    scene->duration = nan("");
}
static void break_collapse(pl_scene *scene)
{
    scene->collapse_distance = nan("");
}
static void break_friction(pl_scene *scene)
{
    scene->materials[1].friction = HUGE_VAL;
}
static void break_material_name(pl_scene *scene)
{
    snprintf(scene->materials[1].name, PL_NAME_SIZE, "ice");
}
static void break_name_end(pl_scene *scene)
{
    memset(scene->bodies[1].name, 'x', PL_NAME_SIZE);
}
static void break_name_encoding(pl_scene *scene)
{
    scene->bodies[1].name[1] = '\xff';
}
static void break_unique_names(pl_scene *scene)
{
    snprintf(scene->bodies[2].name, PL_NAME_SIZE, "floor");
}
static void break_material_index(pl_scene *scene)
{
    scene->bodies[1].material = 2;
}
static void break_shape_kind(pl_scene *scene)
{
    scene->bodies[1].shape.kind = (pl_shape_kind)PL_SHAPE_KIND_COUNT;
}
static void break_normal(pl_scene *scene)
{
    scene->bodies[0].shape.normal[0] = 1e-4; /* off the unit by 5e-9 */
}
static void break_static_plane(pl_scene *scene)
{
    scene->bodies[0].is_static = false;
}
static void break_orientation(pl_scene *scene)
{
    scene->bodies[2].orientation[0] = 1 + 2e-9;
}
static void break_mass(pl_scene *scene)
{
    scene->bodies[1].mass = -1;
}
static void break_inertia(pl_scene *scene)
{
    scene->bodies[1].inertia[2] = 1;
}
static void break_velocity(pl_scene *scene)
{
    scene->bodies[1].velocity[2] = nan("");
}
static void break_static_velocity(pl_scene *scene)
{
    scene->bodies[0].velocity[0] = 1;
}
static void break_force_body(pl_scene *scene)
{
    scene->forces[0].body = 3;
}
static void break_force_of_static(pl_scene *scene)
{
    scene->forces[0].body = 0;
}
static void break_force_frame(pl_scene *scene)
{
    scene->forces[0].frame = (pl_force_frame)2;
}
static void break_force_until(pl_scene *scene)
{
    scene->forces[0].until = nan("");
}
static void break_rest_body(pl_scene *scene)
{
    scene->rests[0].body = -1;
}
static void break_rest_position(pl_scene *scene)
{
    scene->rests[0].position[2] = nan("");
}
static void break_travel_direction(pl_scene *scene)
{
    scene->travels[0].direction[2] = 1;
}
static void break_travel_distance(pl_scene *scene)
{
    scene->travels[0].distance = HUGE_VAL;
}
static void break_primary(pl_scene *scene)
{
    snprintf(scene->primary_error, PL_NAME_SIZE, "rest_positon_error");
}
static void break_pair_index(pl_scene *scene)
{
    const pl_material_pair pair = {.material_a = 0, .material_b = 7};
    pl_scene_add_pair(scene, &pair, NULL);
}
static void break_pair_twice(pl_scene *scene)
{
    const pl_material_pair pair = {.material_a = 0, .material_b = 1};
    const pl_material_pair again = {.material_a = 1, .material_b = 0};
    pl_scene_add_pair(scene, &pair, NULL);
    pl_scene_add_pair(scene, &again, NULL);
}

static void test_validation_names_the_broken_field(void **state)
{
    (void)state;
    static const struct {
        void (*break_it)(pl_scene *);
        const char *message; /* its beginning */
    } cases[] = {
        {break_gravity, "gravity[1]: expected a finite number, found inf"},
        {break_dt, "dt: expected a finite number above 0, found nan"},
        {break_duration, "duration: expected a finite number above 0, found nan"},
        {break_collapse, "expect.collapse_distance: expected a number above 0, found nan"},
        {break_friction,
         "materials.oak.friction: expected a finite number of at least 0, found inf"},
        {break_material_name, "materials[1].name: expected a name of its own, found \"ice\""},
        {break_name_end, "bodies[1].name: expected a name of 1 to 63 bytes, found 64"},
        {break_name_encoding, "bodies[1].name: expected a name in UTF-8"},
        {break_unique_names, "bodies[2].name: expected a name of its own, found \"floor\""},
        {break_material_index, "bodies[1].material: expected the index of a material from 0 to 1"},
        {break_shape_kind, "bodies[1].shape.type: expected a known shape"},
        {break_normal, "bodies[0].shape.normal: expected a unit vector"},
        {break_static_plane, "bodies[0].static: expected true"},
        {break_orientation, "bodies[2].orientation: expected a unit quaternion"},
        {break_mass, "bodies[1].mass: expected a finite number above 0, found -1"},
        {break_inertia, "bodies[1].inertia: expected three finite numbers above 0"},
        {break_velocity, "bodies[1].velocity[2]: expected a finite number, found nan"},
        {break_static_velocity, "bodies[0].velocity: expected zero"},
        {break_force_body, "forces[0].body: expected the index of a body from 0 to 2, found 3"},
        {break_force_of_static, "bodies[0].forces: expected no forces on a static body"},
        {break_force_frame, "bodies[1].forces[0].frame: expected a known frame"},
        {break_force_until, "bodies[1].forces[0].until: expected a number above 0, found nan"},
        {break_rest_body, "expect.rest[0].body: expected the index of a body"},
        {break_rest_position, "expect.rest[0].position[2]: expected a finite number, found nan"},
        {break_travel_direction, "expect.travel[0].direction: expected a unit vector"},
        {break_travel_distance, "expect.travel[0].distance: expected a finite number other than 0"},
        {break_primary, "expect.primary: expected a metric such as \"rest_position_error\""},
        {break_pair_index, "pairs[0].b: expected the index of a material from 0 to 1, found 7"},
        {break_pair_twice, "pairs[1]: expected each pair of materials once"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        pl_scene scene = make_scene();
        pl_error error = {.message = ""};
        cases[i].break_it(&scene);
        assert_int_equal(pl_scene_validate(&scene, &error), PL_BAD_INPUT);
        if (strncmp(error.message, cases[i].message, strlen(cases[i].message)) != 0) {
            fail_msg("\"%s\"\n  does not begin with \"%s\"", error.message, cases[i].message);
        }
        pl_scene_free(&scene);
    }
}

static void test_force_is_named_by_its_index(void **state)
{
    (void)state;
    pl_scene scene = make_scene();
    pl_error error = {.message = ""};
    const pl_force other = {.body = 2, .until = HUGE_VAL}, bad = {.body = 1, .from = -1};
    assert_int_equal(pl_scene_add_force(&scene, &other, NULL), PL_OK);
    assert_int_equal(pl_scene_add_force(&scene, &bad, NULL), PL_OK);
    assert_int_equal(pl_scene_validate(&scene, &error), PL_BAD_INPUT);
    assert_contains(error.message, "bodies[1].forces[1].from: ");
    pl_scene_free(&scene);
}

static void test_lone_ball_needs_nothing_but_its_shape(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    const pl_material rough = {.name = "rough", .friction = 1, .restitution = 1};
    const pl_body ball = named_body("ball", pl_shape_sphere(1));
    assert_int_equal(pl_scene_add_material(&scene, &rough, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_body(&scene, &ball, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_needs(&scene), PL_NEEDS_SPHERE);
    scene.bodies[0].angular_velocity[0] = 1;
    assert_int_equal(pl_scene_needs(&scene), PL_NEEDS_SPHERE | PL_NEEDS_ROTATION);
    scene.bodies[0].angular_velocity[0] = 0;
    pl_force force = {.force = {1, 0, 0}, .until = 1};
    assert_int_equal(pl_scene_add_force(&scene, &force, NULL), PL_OK);
    assert_int_equal(pl_scene_needs(&scene), PL_NEEDS_SPHERE | PL_NEEDS_FORCES);
    scene.forces[0].at[1] = 1;
    assert_int_equal(pl_scene_needs(&scene), PL_NEEDS_SPHERE | PL_NEEDS_FORCES | PL_NEEDS_ROTATION);
    pl_scene_free(&scene);
}

static void test_needs_follow_the_pairs_that_can_touch(void **state)
{
    (void)state;
    pl_scene scene = pl_scene_default();
    const pl_material smooth = {.name = "smooth"}, rough = {.name = "rough", .friction = 1};
    pl_body floor = named_body("floor", pl_shape_plane(0, 0, 1, 0));
    pl_body pillar = named_body("pillar", pl_shape_box(1, 1, 1));
    const pl_body ball = named_body("ball", pl_shape_sphere(1));
    floor.is_static = pillar.is_static = true;
    floor.material = pillar.material = 1;
    assert_int_equal(pl_scene_add_material(&scene, &smooth, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_material(&scene, &rough, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_body(&scene, &floor, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_body(&scene, &pillar, NULL, NULL), PL_OK);
    assert_int_equal(pl_scene_add_body(&scene, &ball, NULL, NULL), PL_OK);
    const uint32_t shapes = PL_NEEDS_PLANE | PL_NEEDS_BOX | PL_NEEDS_SPHERE;
    /* Two rough bodies, both static; smooth on rough mixes to none. */
    assert_int_equal(pl_scene_needs(&scene), shapes);
    const pl_material_pair pair = {.material_b = 1, .restitution = 0.5};
    assert_int_equal(pl_scene_add_pair(&scene, &pair, NULL), PL_OK);
    assert_int_equal(pl_scene_needs(&scene), shapes | PL_NEEDS_RESTITUTION);
    scene.bodies[2].material = 1;
    assert_int_equal(pl_scene_needs(&scene), shapes | PL_NEEDS_FRICTION | PL_NEEDS_ROTATION);
    /* A box turns without friction. */
    scene.materials[1].friction = 0;
    scene.bodies[1].is_static = false;
    assert_int_equal(pl_scene_needs(&scene), shapes | PL_NEEDS_ROTATION);
    pl_scene_free(&scene);
}

static void test_every_capability_bit_has_a_name(void **state)
{
    (void)state;
    int names = 0;
    for (int bit = 0; bit < 32; ++bit) {
        names += pl_needs_name(UINT32_C(1) << bit) != NULL ? 1 : 0;
    }
    assert_int_equal(names, 4 + PL_SHAPE_KIND_COUNT);
    assert_string_equal(pl_needs_name(PL_NEEDS_BOX), "box");
    assert_int_equal(PL_NEEDS_PLANE << PL_SHAPE_BOX, PL_NEEDS_BOX);
    assert_null(pl_needs_name(0));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_error_has_status_and_may_be_null),
        cmocka_unit_test(test_long_message_is_cut_between_characters),
        cmocka_unit_test(test_nearest_name_is_within_a_third),
        cmocka_unit_test(test_numbers_are_decimals_or_ratios),
        cmocka_unit_test(test_number_text_is_short_and_reads_back),
        cmocka_unit_test(test_number_text_is_that_of_printf),
        cmocka_unit_test(test_random_bits_are_splitmix64),
        cmocka_unit_test(test_name_index_finds_names_and_the_first_duplicate),
        cmocka_unit_test(test_name_index_of_many_names),
        cmocka_unit_test(test_volume_and_inertia_equal_quadrature),
        cmocka_unit_test(test_arrays_keep_added_items),
        cmocka_unit_test(test_added_body_gets_inertia_and_drops_extras),
        cmocka_unit_test(test_materials_beyond_the_limit_are_refused),
        cmocka_unit_test(test_pair_mixes_or_is_overridden_in_either_order),
        cmocka_unit_test(test_steps_are_rounded),
        cmocka_unit_test(test_default_scene_with_a_body_is_valid),
        cmocka_unit_test(test_validation_names_the_broken_field),
        cmocka_unit_test(test_force_is_named_by_its_index),
        cmocka_unit_test(test_lone_ball_needs_nothing_but_its_shape),
        cmocka_unit_test(test_needs_follow_the_pairs_that_can_touch),
        cmocka_unit_test(test_every_capability_bit_has_a_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
