/* The catalogue: every scenario's scene is what its reference says of it, worked out here by
 * another way. */
#include "check.h"
#include "plumb/scenario.h"
#include "scene_equal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void build(const char *name, const char *const *settings, int count, uint64_t seed,
                  pl_scene *scene)
{
    double values[PL_MAX_PARAMS];
    pl_error error = {.message = ""};
    const pl_scenario *scenario = pl_scenario_find(name, &error);
    assert_non_null(scenario);
    pl_status status = pl_scenario_values(scenario, settings, count, values, &error);
    if (status == PL_OK) {
        status = scenario->build(values, seed, scene, &error);
    }
    if (status != PL_OK) {
        fail_msg("%s", error.message);
    }
}

static void check_refused(const char *name, const char *setting, const char *part)
{
    double values[PL_MAX_PARAMS];
    pl_scene scene;
    pl_error error = {.message = ""};
    const pl_scenario *scenario = pl_scenario_find(name, &error);
    assert_non_null(scenario);
    pl_status status = pl_scenario_values(scenario, &setting, 1, values, &error);
    if (status == PL_OK) {
        status = scenario->build(values, 0, &scene, &error);
        assert_null(scene.bodies); /* left empty */
    }
    assert_int_equal(status, PL_BAD_INPUT);
    assert_contains(error.message, part);
}

/* Boxes whose axes are the world's: gaps along x, y, z; all three negative or zero means touching.
 */
static void gaps_of(const pl_body *a, const pl_body *b, double gaps[3])
{
    for (int k = 0; k < 3; k++) {
        gaps[k] = fabs(a->position[k] - b->position[k]) - a->shape.half_extents[k] -
                  b->shape.half_extents[k];
    }
}

static double bottom_of(const pl_body *body)
{
    return body->position[2] - body->shape.half_extents[2];
}

/* No two boxes overlap; each stands on the floor or exactly on others, and its centre of mass lies
 * over the hull of what it stands on along x. Returns the total mass. */
static double check_stacked(const pl_scene *scene)
{
    double mass = 0;
    for (int i = 1; i < scene->body_count; i++) {
        const pl_body *body = &scene->bodies[i];
        double left = HUGE_VAL, right = -HUGE_VAL;
        mass += body->mass;
        if (bottom_of(body) == 0) {
            left = -HUGE_VAL;
            right = HUGE_VAL;
        }
        for (int j = 1; j < scene->body_count; j++) {
            const pl_body *other = &scene->bodies[j];
            double gaps[3];
            gaps_of(body, other, gaps);
            bool apart = gaps[0] >= 0 || gaps[1] >= 0 || gaps[2] >= 0;
            assert_true(i == j || apart);
            bool below = other->position[2] < body->position[2] && gaps[2] == 0;
            if (i != j && below && gaps[0] < 0 && gaps[1] < 0) {
                left = fmin(left, other->position[0] - other->shape.half_extents[0]);
                right = fmax(right, other->position[0] + other->shape.half_extents[0]);
            }
        }
        assert_true(left < body->position[0] && body->position[0] < right);
        assert_true(bottom_of(body) >= 0);
    }
    return mass;
}

/* Every dynamic body is expected to end as it starts. */
static void check_all_rest(const pl_scene *scene)
{
    int dynamic = 0;
    for (int i = 0; i < scene->body_count; i++) {
        dynamic += scene->bodies[i].is_static ? 0 : 1;
    }
    assert_int_equal(scene->rest_count, dynamic);
    for (int i = 0; i < scene->rest_count; i++) {
        const pl_expect_rest *rest = &scene->rests[i];
        const pl_body *body = &scene->bodies[rest->body];
        assert_true(rest->has_orientation);
        assert_memory_equal(rest->position, body->position, sizeof rest->position);
        assert_memory_equal(rest->orientation, body->orientation, sizeof rest->orientation);
    }
}

static void test_every_scenario_is_complete_and_builds(void **state)
{
    (void)state;
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; i++) {
        const pl_scenario *s = scenarios[i];
        const char *texts[] = {s->name,      s->title,    s->description,
                               s->reference, s->expected, s->source};
        for (size_t k = 0; k < sizeof texts / sizeof texts[0]; k++) {
            assert_non_null(texts[k]);
            assert_true(strlen(texts[k]) > 0);
        }
        assert_true(strncmp(s->expected, "ok: ", 4) == 0 && strlen(s->expected) <= 120);
        assert_null(strchr(s->expected, '\n'));
        assert_ptr_equal(pl_scenario_find(s->name, NULL), s);
        assert_in_range(s->param_count, 2, PL_MAX_PARAMS);
        bool has_dt = false, has_duration = false;
        for (int k = 0; k < s->param_count; k++) {
            const pl_param *param = &s->params[k];
            has_dt = has_dt || strcmp(param->name, "dt") == 0;
            has_duration = has_duration || strcmp(param->name, "duration") == 0;
            assert_true(param->min <= param->value && param->value <= param->max);
            assert_true(strlen(param->unit) > 0 && strlen(param->help) > 0);
        }
        assert_true(has_dt && has_duration);
        pl_scene scene;
        build(s->name, NULL, 0, 0, &scene);
        assert_int_equal(pl_scene_validate(&scene, NULL), PL_OK);
        assert_string_equal(scene.name, s->name);
        assert_string_equal(scene.primary_error, s->primary_error);
        pl_scene_free(&scene);
    }
}

static void test_declared_needs_are_those_of_the_default_scene(void **state)
{
    (void)state;
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; i++) {
        pl_scene scene;
        build(scenarios[i]->name, NULL, 0, 0, &scene);
        assert_int_equal(pl_scene_needs(&scene), scenarios[i]->needs);
        pl_scene_free(&scene);
    }
}

static void test_same_seed_gives_the_same_scene_and_file(void **state)
{
    (void)state;
    static const char *const jittered[] = {"offset=0.1"};
    char hash[3][17];
    const uint64_t seeds[3] = {7, 7, 8};
    for (int i = 0; i < 3; i++) {
        pl_scene scene;
        build("tower", jittered, 1, seeds[i], &scene);
        assert_int_equal(pl_scene_hash(&scene, hash[i], NULL), PL_OK);
        pl_scene_free(&scene);
    }
    assert_string_equal(hash[0], hash[1]);
    assert_string_not_equal(hash[0], hash[2]);
}

static void test_every_scene_reads_back_from_its_file(void **state)
{
    (void)state;
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; i++) {
        pl_scene scene, again;
        pl_error error = {.message = ""};
        build(scenarios[i]->name, NULL, 0, 3, &scene);
        char *text = pl_scene_to_text(&scene);
        assert_non_null(text);
        if (pl_scene_read_text(text, strlen(text), "scene", &again, &error) != PL_OK) {
            fail_msg("%s", error.message);
        }
        assert_same_scene(&again, &scene);
        free(text);
        pl_scene_free(&scene);
        pl_scene_free(&again);
    }
}

static void test_tower_cubes_touch_and_stand(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=25"};
    pl_scene scene;
    build("tower", settings, 1, 0, &scene);
    assert_int_equal(scene.body_count, 26);
    assert_close(check_stacked(&scene), 25, 0, 0);
    check_all_rest(&scene);
    const pl_body *top = &scene.bodies[25];
    assert_close(top->position[2] + top->shape.half_extents[2], 25, 0, 0);
    assert_close(top->inertia[0], 1.0 / 6, 0, 1e-15);
    pl_scene_free(&scene);
}

/* The centre of mass of all cubes above a joint lies over the face that the two cubes share there.
 */
static void test_displaced_tower_stands_for_every_seed(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=100", "offset=0.2"};
    double largest = 0;
    for (uint64_t seed = 0; seed < 100; seed++) {
        pl_scene scene;
        build("tower", settings, 2, seed, &scene);
        check_stacked(&scene);
        double mass = 0, moment[2] = {0, 0};
        for (int i = scene.body_count - 1; i >= 2; i--) {
            const pl_body *cube = &scene.bodies[i];
            mass += cube->mass;
            for (int k = 0; k < 2; k++) {
                double below = cube[-1].position[k];
                moment[k] += cube->mass * cube->position[k];
                double low = fmax(below, cube->position[k]) - 0.5;
                double high = fmin(below, cube->position[k]) + 0.5;
                assert_true(low < moment[k] / mass && moment[k] / mass < high);
                largest = fmax(largest, fabs(below));
            }
        }
        pl_scene_free(&scene);
    }
    assert_true(largest > 0.199 && largest <= 0.2);
}

/* Masses as their definition says, by the C library's pow, and the scene otherwise that of the
 * plain tower. */
static void test_tower_masses_rise_in_equal_ratios_to_a_heavier_top(void **state)
{
    (void)state;
    static const char *const settings[][3] = {{"n=100", "top_mass=1000", "rising_mass=1"},
                                              {"n=100", "top_mass=1", "rising_mass=1000"},
                                              {"n=3", "top_mass=7", "rising_mass=1e6"},
                                              {"n=1", "top_mass=5", "rising_mass=1000"},
                                              {"n=2", "top_mass=1", "rising_mass=1"}};
    static const double top[] = {1000, 1, 7, 5, 1}, rising[] = {1, 1000, 1e6, 1000, 1};
    for (int i = 0; i < 5; i++) {
        pl_scene scene;
        build("tower", settings[i], 3, 0, &scene);
        int n = scene.body_count - 1;
        for (int k = 1; k <= n; k++) {
            const pl_body *cube = &scene.bodies[k];
            double mass = n > 1 ? pow(rising[i], (k - 1.0) / (n - 1)) : 1;
            mass *= k == n ? top[i] : 1;
            assert_close(cube->mass, mass, 0, 1e-12);
            assert_close(cube->inertia[2], mass / 6, 0, 1e-12);
        }
        check_stacked(&scene);
        check_all_rest(&scene);
        pl_scene_free(&scene);
    }
}

static void test_displaced_tower_of_any_masses_stands_by_statics(void **state)
{
    (void)state;
    static const char *const settings[] = {"n=30", "offset=0.2", "top_mass=1e6", "rising_mass=1e6"};
    for (uint64_t seed = 0; seed < 50; seed++) {
        pl_scene scene;
        build("tower", settings, 4, seed, &scene);
        check_all_rest(&scene);
        double mass = 0, moment[2] = {0, 0};
        for (int i = scene.body_count - 1; i >= 2; i--) {
            const pl_body *cube = &scene.bodies[i];
            mass += cube->mass;
            for (int k = 0; k < 2; k++) {
                moment[k] += cube->mass * cube->position[k];
                assert_true(fabs(moment[k] / mass - cube[-1].position[k]) < 0.5);
                assert_true(fabs(moment[k] / mass - cube->position[k]) < 0.5);
            }
        }
        pl_scene_free(&scene);
    }
}

static void test_mass_ratio_is_ten_to_the_k(void **state)
{
    (void)state;
    static const char *const settings[] = {"k=0", "k=1", "k=2", "k=3", "k=4", "k=5", "k=6"};
    static const double ratios[] = {1, 10, 100, 1e3, 1e4, 1e5, 1e6};
    for (int i = 0; i < 7; i++) {
        pl_scene scene;
        build("mass-ratio", &settings[i], 1, 0, &scene);
        assert_int_equal(scene.body_count, 3);
        assert_close(scene.bodies[1].mass, 1, 0, 0);
        assert_close(scene.bodies[2].mass, ratios[i], 0, 0);
        check_stacked(&scene);
        check_all_rest(&scene);
        assert_close(scene.bodies[2].position[2], 1.5, 0, 0);
        assert_close(scene.collapse_distance, 0.5, 0, 0);
        pl_scene_free(&scene);
    }
}

static void test_wall_bricks_touch_and_stand(void **state)
{
    (void)state;
    static const char *const sizes[][2] = {{"rows=10", "columns=10"},
                                           {"rows=1", "columns=1"},
                                           {"rows=6", "columns=1"},
                                           {"rows=7", "columns=12"}};
    static const double rows[] = {10, 1, 6, 7}, columns[] = {10, 1, 1, 12};
    for (int i = 0; i < 4; i++) {
        pl_scene scene;
        build("wall", sizes[i], 2, 0, &scene);
        double bricks = rows[i] * columns[i] + floor(rows[i] / 2);
        assert_close(scene.body_count - 1, bricks, 0, 0);
        assert_close(check_stacked(&scene), rows[i] * columns[i], 0, 0);
        check_all_rest(&scene);
        /* The bricks fill the wall: their volume is that of the whole. */
        double volume = 0;
        for (int b = 1; b < scene.body_count; b++) {
            volume += pl_shape_volume(&scene.bodies[b].shape);
        }
        assert_close(volume, columns[i] * 0.5 * rows[i] * 0.5, 0, 1e-14);
        pl_scene_free(&scene);
    }
}

static void test_wall_collapse_is_the_wall_and_a_ball_that_misses_nothing(void **state)
{
    (void)state;
    pl_scene scene, wall;
    static const char *const settings[] = {"rows=25", "columns=40"};
    build("wall-collapse", NULL, 0, 0, &scene);
    build("wall", settings, 2, 0, &wall);
    assert_int_equal(pl_scene_steps(&scene), 300);
    assert_int_equal(scene.rest_count, 0);
    assert_true(isinf(scene.collapse_distance));
    assert_int_equal(scene.body_count, wall.body_count + 1);
    for (int i = 0; i < wall.body_count; i++) {
        const pl_body *brick = &scene.bodies[i], *expected = &wall.bodies[i];
        assert_string_equal(brick->name, expected->name);
        assert_memory_equal(brick->position, expected->position, sizeof brick->position);
        assert_memory_equal(&brick->shape.half_extents, &expected->shape.half_extents,
                            sizeof brick->shape.half_extents);
    }
    const pl_body *ball = &scene.bodies[wall.body_count];
    const double position[3] = {20, -3, 6.55}, velocity[3] = {0, 20, 0};
    for (int k = 0; k < 3; k++) {
        assert_close(ball->position[k], position[k], 1e-15, 0);
        assert_close(ball->velocity[k], velocity[k], 0, 0);
    }
    assert_close(ball->mass, 100, 0, 0);
    /* It reaches the wall while still at the height of the bricks: free fall over 1.75 m at 20 m/s.
     */
    double time = (3 - 0.25 - 1) / 20.0;
    double height = ball->position[2] - 9.81 * time * time / 2;
    assert_true(height > 0 && height < 12.5);
    pl_scene_free(&scene);
    pl_scene_free(&wall);
}

static void test_ball_never_starts_in_the_floor_or_the_wall(void **state)
{
    (void)state;
    static const char *const settings[] = {"rows=1", "columns=1"};
    pl_scene scene;
    build("wall-collapse", settings, 2, 0, &scene);
    const pl_body *ball = &scene.bodies[scene.body_count - 1];
    assert_true(ball->position[2] >= ball->shape.radius);
    assert_true(ball->position[1] + ball->shape.radius < -0.25);
    pl_scene_free(&scene);
}

/* The block's lowest corners, turned by its quaternion, all lie on the plane. */
static void check_block_lies_on_plane(const pl_scene *scene, double angle)
{
    const pl_shape *plane = &scene->bodies[0].shape;
    const pl_body *block = &scene->bodies[1];
    const double *q = block->orientation, *h = block->shape.half_extents;
    assert_close(plane->normal[0], sin(angle), 4e-16, 0);
    assert_close(plane->normal[2], cos(angle), 4e-16, 0);
    for (int corner = 0; corner < 4; corner++) {
        const double v[3] = {corner % 2 == 0 ? h[0] : -h[0], corner / 2 == 0 ? h[1] : -h[1], -h[2]};
        /* v + 2 w (u x v) + 2 u x (u x v) with q = (w, u). */
        const double c[3] = {q[2] * v[2] - q[3] * v[1], q[3] * v[0] - q[1] * v[2],
                             q[1] * v[1] - q[2] * v[0]};
        const double d[3] = {q[2] * c[2] - q[3] * c[1], q[3] * c[0] - q[1] * c[2],
                             q[1] * c[1] - q[2] * c[0]};
        double height = -plane->offset;
        for (int k = 0; k < 3; k++) {
            height += plane->normal[k] * (block->position[k] + v[k] + 2 * (q[0] * c[k] + d[k]));
        }
        assert_close(height, 0, 3e-16, 0);
    }
}

static void test_slope_blocks_lie_on_the_plane(void **state)
{
    (void)state;
    static const char *const settings[][2] = {
        {"angle=0", "friction=0.1"}, {"angle=0.44", "friction=0.5"}, {"angle=1", "friction=1.6"}};
    static const double angles[] = {0, 0.44, 1};
    pl_scene scene;
    for (int i = 0; i < 3; i++) {
        build("slope-stick", settings[i], 2, 0, &scene);
        check_block_lies_on_plane(&scene, angles[i]);
        check_all_rest(&scene);
        pl_scene_free(&scene);
    }
    build("slope-slide", NULL, 0, 0, &scene);
    check_block_lies_on_plane(&scene, 0.6);
    pl_scene_free(&scene);
}

static void test_slope_threshold_is_the_angle_of_friction(void **state)
{
    (void)state;
    /* atan 0.5 = 0.46364760900080612 (OEIS A073000). */
    pl_scene scene;
    static const char *const below[] = {"angle=0.463647609"}, *const above[] = {"angle=0.46364761"};
    build("slope-stick", below, 1, 0, &scene);
    pl_scene_free(&scene);
    build("slope-slide", above, 1, 0, &scene);
    pl_scene_free(&scene);
    check_refused("slope-stick", above[0], "use slope-slide");
    check_refused("slope-slide", below[0], "use slope-stick");
    check_refused("slope-stick", "friction=0", "slope-slide");
}

static void test_slide_direction_is_downhill_along_the_plane(void **state)
{
    (void)state;
    pl_scene scene;
    build("slope-slide", NULL, 0, 0, &scene);
    assert_int_equal(scene.travel_count, 1);
    const pl_expect_travel *travel = &scene.travels[0];
    const double *normal = scene.bodies[0].shape.normal;
    double along = 0, with_gravity = 0;
    for (int k = 0; k < 3; k++) {
        along += travel->direction[k] * normal[k];
        with_gravity += travel->direction[k] * scene.gravity[k];
    }
    assert_close(along, 0, 1e-16, 0);
    assert_close(with_gravity, 9.81 * sin(0.6), 0, 1e-15);
    pl_scene_free(&scene);
}

/* Coulomb's law step by step, from gravity and the plane alone: the tangential speed loses at most
 * mu times what the normal one gains. */
static void test_slide_distances_equal_the_summed_recurrence(void **state)
{
    (void)state;
    static const char *const settings[][4] = {
        {"dt=1/60", "duration=2", "angle=0.6", "friction=0.5"},
        {"dt=0.01", "duration=0.505", "angle=1.2", "friction=1.5"},
        {"dt=0.25", "duration=1", "angle=0.3", "friction=0"}};
    for (int i = 0; i < 3; i++) {
        pl_scene scene;
        build("slope-slide", settings[i], 4, 0, &scene);
        const pl_expect_travel *travel = &scene.travels[0];
        const double *normal = scene.bodies[0].shape.normal;
        double friction = scene.materials[0].friction;
        double down = 0, into = 0;
        for (int k = 0; k < 3; k++) {
            down += travel->direction[k] * scene.gravity[k];
            into -= normal[k] * scene.gravity[k];
        }
        long steps = pl_scene_steps(&scene);
        double speed = 0, discrete = 0;
        for (long n = 0; n < steps; n++) {
            speed = fmax(0, speed + scene.dt * down - friction * scene.dt * into);
            discrete += scene.dt * speed;
        }
        assert_close(travel->discrete, discrete, 0, 1e-12);

        /* Continuous: the classical Runge-Kutta rule for s' = v, v' = a, exact for a parabola. */
        double place = 0, h = (double)steps * scene.dt / 16, a = down - friction * into;
        speed = 0;
        for (int n = 0; n < 16; n++) {
            double k1 = speed, k2 = speed + h / 2 * a, k3 = k2, k4 = speed + h * a;
            place += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
            speed += h * a;
        }
        assert_close(travel->distance, place, 0, 1e-12);
        pl_scene_free(&scene);
    }
}

/* Coulomb's law step by step: a step takes friction g h from the speed, never more than there is.
 */
static void test_stopping_distances_equal_the_summed_recurrence(void **state)
{
    (void)state;
    static const char *const settings[][4] = {
        {"speed=5", "friction=0.5", "dt=1/60", "duration=3"},
        {"speed=5", "friction=0.5", "dt=1e-5", "duration=1.5"},
        {"speed=2", "friction=1.9", "dt=0.01", "duration=0.05"},
        {"speed=3", "friction=0", "dt=0.01", "duration=2"},
        {"speed=0.05", "friction=0.5", "dt=1/60", "duration=1"}};
    static const double stops_at[] = {25 / 9.81, 25 / 9.81, 0, 0, 0.0025 / 9.81};
    for (int i = 0; i < 5; i++) {
        pl_scene scene;
        build("slide-to-stop", settings[i], 4, 0, &scene);
        const pl_expect_travel *travel = &scene.travels[0];
        double braking = scene.materials[0].friction * 9.81, discrete = 0;
        const double *v = scene.bodies[1].velocity;
        double speed = sqrt(v[0] * v[0] + v[1] * v[1]);
        for (long n = pl_scene_steps(&scene); n > 0; n--) {
            speed = fmax(0, speed - braking * scene.dt);
            discrete += scene.dt * speed;
        }
        if (discrete > 0) {
            assert_close(travel->discrete, discrete, 0, 1e-10);
        } else {
            assert_true(isnan(travel->discrete));
        }
        if (stops_at[i] > 0) {
            assert_close(travel->distance, stops_at[i], 0, 1e-14);
        } else {
            assert_close(travel->distance, discrete, 0, 0.1);
        }
        pl_scene_free(&scene);
    }
}

static void test_push_goes_along_the_azimuth_and_is_its_own_mirror_image(void **state)
{
    (void)state;
    static const char *const settings[] = {"azimuth=0", "azimuth=90", "azimuth=25", "azimuth=65",
                                           "azimuth=45"};
    static const double degrees[] = {0, 90, 25, 65, 45};
    double directions[5][3];
    for (int i = 0; i < 5; i++) {
        pl_scene scene;
        build("slide-to-stop", &settings[i], 1, 0, &scene);
        double *d = directions[i];
        memcpy(d, scene.travels[0].direction, sizeof directions[i]);
        assert_close(d[0], cos(degrees[i] * 0.017453292519943295), 2e-16, 0);
        assert_close(d[1], sin(degrees[i] * 0.017453292519943295), 2e-16, 0);
        for (int k = 0; k < 3; k++) {
            assert_close(scene.bodies[1].velocity[k], 5 * d[k], 0, 0);
        }
        check_block_lies_on_plane(&scene, 0);
        pl_scene_free(&scene);
    }
    assert_true(directions[0][1] == 0 && directions[1][0] == 0 && directions[1][1] == 1);
    assert_true(directions[2][0] == directions[3][1] && directions[2][1] == directions[3][0]);
    /* Beyond 2 the block tips. */
    check_refused("slide-to-stop", "friction=2", "expected 0 to 1.9");
    check_refused("slide-to-stop", "azimuth=91", "expected 0 to 90");
}

static void test_dt_and_duration_reach_the_scene(void **state)
{
    (void)state;
    static const char *const settings[] = {"dt=1/240", "duration=0.5"};
    int count;
    const pl_scenario *const *scenarios = pl_scenarios(&count);
    for (int i = 0; i < count; i++) {
        pl_scene scene;
        build(scenarios[i]->name, settings, 2, 0, &scene);
        assert_close(scene.dt, 1.0 / 240, 0, 0);
        assert_int_equal(pl_scene_steps(&scene), 120);
        pl_scene_free(&scene);
    }
}

static void test_bad_settings_are_refused(void **state)
{
    (void)state;
    check_refused("tower", "n", "expected NAME=VALUE, found \"n\"");
    check_refused("tower", "frction=1", "did you mean \"friction\"?");
    check_refused("tower", "elasticity=1", "it has n, friction, offset, top_mass, rising_mass, dt");
    check_refused("tower", "n=ten", "n: expected a number, found \"ten\"");
    check_refused("tower", "n=", "expected a number");
    check_refused("tower", "n=nan", "expected a number");
    check_refused("tower", "n=0x10", "expected a number");
    check_refused("tower", "n=10 ", "expected a number");
    check_refused("tower", "n=1e999", "expected a number");
    check_refused("tower", "n=10.5", "expected a whole number, found 10.5");
    check_refused("tower", "n=0", "expected 1 to 2000");
    check_refused("tower", "n=2001", "expected 1 to 2000");
    check_refused("tower", "offset=0.3", "expected 0 to 0.2");
    check_refused("tower", "dt=1/0", "expected a number");
    check_refused("tower", "dt=20", "dt: expected");
    check_refused("tower", "duration=0.001", "duration: expected at least dt");
    check_refused("tower", "duration=1e6", "at most 10000000 steps");
    check_refused("slope-slide", "friction=2", "expected 0 to 1.9");
}

static void test_unknown_names_get_the_nearest(void **state)
{
    (void)state;
    pl_error error = {.message = ""};
    assert_null(pl_scenario_find("wal-colapse", &error));
    assert_contains(error.message, "did you mean \"wall-collapse\"?");
    assert_null(pl_scenario_find("zzzzzz", &error));
    assert_string_equal(error.message, "unknown scenario \"zzzzzz\"");
    assert_null(pl_suite_find("cannonical", &error));
    assert_contains(error.message, "did you mean \"canonical\"?");
}

static void test_canonical_suite_is_these_in_order(void **state)
{
    (void)state;
    static const char *const expected[] = {"tower",         "multi-tower",   "slope-stick",
                                           "slope-slide",   "slope-tip",     "wall",
                                           "wall-collapse", "falling-cubes", "rocket"};
    enum { COUNT = sizeof expected / sizeof expected[0] };
    const pl_suite *suite = pl_suite_find("canonical", NULL);
    assert_non_null(suite);
    assert_int_equal(suite->entry_count, COUNT);
    for (int i = 0; i < COUNT; i++) {
        assert_string_equal(suite->entries[i].scenario, expected[i]);
    }
    assert_string_equal(suite->entries[1].setting, "k=2,n=10");
    assert_null(suite->published_metric);
}

static void test_paper_suite_holds_the_table_of_the_source(void **state)
{
    (void)state;
    static const char *const towers[] = {"n=5", "n=10", "n=25"};
    static const double iterations[] = {1.65, 36, 47};
    const pl_suite *suite = pl_suite_find("paper", NULL);
    assert_non_null(suite);
    assert_int_equal(suite->entry_count, 3);
    for (int i = 0; i < 3; i++) {
        assert_string_equal(suite->entries[i].scenario, "tower");
        assert_string_equal(suite->entries[i].setting, towers[i]);
        assert_close(suite->entries[i].published, iterations[i], 0, 0);
    }
    assert_string_equal(suite->published_metric, "iterations_mean");
    assert_contains(suite->source, "Table 2");
}

static void test_suites_name_known_scenarios_and_settings(void **state)
{
    (void)state;
    int count;
    const pl_suite *suites = pl_suites(&count);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < suites[i].entry_count; k++) {
            const pl_suite_entry *entry = &suites[i].entries[k];
            pl_scene scene;
            build(entry->scenario, &entry->setting, entry->setting == NULL ? 0 : 1, 0, &scene);
            pl_scene_free(&scene);
        }
        assert_true((suites[i].published_metric == NULL) == (suites[i].source == NULL));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_scenario_is_complete_and_builds),
        cmocka_unit_test(test_declared_needs_are_those_of_the_default_scene),
        cmocka_unit_test(test_same_seed_gives_the_same_scene_and_file),
        cmocka_unit_test(test_every_scene_reads_back_from_its_file),
        cmocka_unit_test(test_tower_cubes_touch_and_stand),
        cmocka_unit_test(test_displaced_tower_stands_for_every_seed),
        cmocka_unit_test(test_tower_masses_rise_in_equal_ratios_to_a_heavier_top),
        cmocka_unit_test(test_displaced_tower_of_any_masses_stands_by_statics),
        cmocka_unit_test(test_mass_ratio_is_ten_to_the_k),
        cmocka_unit_test(test_wall_bricks_touch_and_stand),
        cmocka_unit_test(test_wall_collapse_is_the_wall_and_a_ball_that_misses_nothing),
        cmocka_unit_test(test_ball_never_starts_in_the_floor_or_the_wall),
        cmocka_unit_test(test_slope_blocks_lie_on_the_plane),
        cmocka_unit_test(test_slope_threshold_is_the_angle_of_friction),
        cmocka_unit_test(test_slide_direction_is_downhill_along_the_plane),
        cmocka_unit_test(test_slide_distances_equal_the_summed_recurrence),
        cmocka_unit_test(test_stopping_distances_equal_the_summed_recurrence),
        cmocka_unit_test(test_push_goes_along_the_azimuth_and_is_its_own_mirror_image),
        cmocka_unit_test(test_dt_and_duration_reach_the_scene),
        cmocka_unit_test(test_bad_settings_are_refused),
        cmocka_unit_test(test_unknown_names_get_the_nearest),
        cmocka_unit_test(test_canonical_suite_is_these_in_order),
        cmocka_unit_test(test_paper_suite_holds_the_table_of_the_source),
        cmocka_unit_test(test_suites_name_known_scenarios_and_settings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
