/* How chaotic scenes are judged: by overlap, energy, momentum and end statistics. */
#include "check.h"
#include "referee/metrics/expectations.h"
#include "referee/referee.h"
#include "scenario_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- The metrics from other metrics ---- */

/* A scene of one box, 0.5 m thin, that is judged by chaotic_error. */
static pl_scene box_scene(void)
{
    pl_scene scene = pl_scene_default();
    pl_body box = pl_body_default();
    box.shape = pl_shape_box(0.25, 1, 2);
    assert_int_equal(pl_scene_add_body(&scene, &box, NULL, NULL), PL_OK);
    snprintf(scene.primary_error, sizeof scene.primary_error, "chaotic_error");
    return scene;
}

static void expect(pl_scene *scene, pl_statistic metric, double low, double high, double scale)
{
    const pl_expect_statistic statistic = {
        .metric = metric, .low = low, .high = high, .scale = scale};
    assert_int_equal(pl_scene_add_statistic(scene, &statistic, NULL), PL_OK);
}

static void test_statistics_count_outside_their_interval(void **state)
{
    (void)state;
    static const struct {
        double height, spread, error;
        const char *part;
    } cases[] = {{1, 5, 0, "mass_height"},
                 {2, 3, 0, "mass_height"},
                 {0.5, 5, 0.125, "mass_height"},
                 {2.5, 5, 0.125, "mass_height"},
                 {2.5, 5.5, 0.25, "spread_x"}};
    pl_scene scene = box_scene();
    expect(&scene, PL_STATISTIC_MASS_HEIGHT, 1, 2, 4);
    expect(&scene, PL_STATISTIC_SPREAD_X, 3, 5, 2);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        pl_metric item[PL_METRIC_COUNT] = {0};
        item[PL_METRIC_MASS_HEIGHT] = pl_metric_value(cases[i].height);
        item[PL_METRIC_SPREAD_X] = pl_metric_value(cases[i].spread);
        pl_chaotic_metrics(&scene, item);
        assert_close(item[PL_METRIC_STATISTICS_ERROR].value, cases[i].error, 0, 1e-15);
        assert_string_equal(item[PL_METRIC_STATISTICS_ERROR].part, cases[i].part);
        assert_close(item[PL_METRIC_CHAOTIC_ERROR].value, fmax(cases[i].error, 1e-3), 0, 1e-15);
    }
    pl_metric item[PL_METRIC_COUNT] = {0};
    item[PL_METRIC_MASS_HEIGHT] = pl_metric_failed("the run ended");
    pl_chaotic_metrics(&scene, item);
    assert_int_equal(item[PL_METRIC_STATISTICS_ERROR].state, PL_METRIC_FAILED);
    assert_string_equal(item[PL_METRIC_STATISTICS_ERROR].reason, "the run ended");
    pl_scene_free(&scene);
}

static void test_largest_part_is_the_error(void **state)
{
    (void)state;
    static const struct {
        double p99, deepest, energy, momentum, error;
        const char *part;
    } cases[] = {
        {1e-5, 1e-4, 0, 0, 1e-3, "resolution"},     {4e-4, 4e-3, 9e-4, 0, 1e-3, "resolution"},
        {0.05, 0.06, 0, 0, 0.1, "penetration_p99"}, {1e-5, 1, 0, 0, 0.2, "penetration_max"},
        {0.05, 1, 0.3, 0, 0.3, "energy_gain"},      {0.05, 1, 0.3, 0.4, 0.4, "momentum_error"}};
    pl_scene scene = box_scene();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        pl_metric item[PL_METRIC_COUNT] = {0};
        item[PL_METRIC_PENETRATION_MAX] = pl_metric_value(cases[i].deepest);
        item[PL_METRIC_PENETRATION_MAX].p99 = cases[i].p99;
        item[PL_METRIC_ENERGY_GAIN] = pl_metric_value(cases[i].energy);
        item[PL_METRIC_MOMENTUM_ERROR] = pl_metric_value(cases[i].momentum);
        pl_chaotic_metrics(&scene, item);
        assert_close(item[PL_METRIC_CHAOTIC_ERROR].value, cases[i].error, 0, 1e-15);
        assert_string_equal(item[PL_METRIC_CHAOTIC_ERROR].part, cases[i].part);
        assert_int_equal(item[PL_METRIC_STATISTICS_ERROR].state, PL_METRIC_ABSENT);
    }
    pl_scene_free(&scene);
}

static void test_parts_without_a_value_are_left_out(void **state)
{
    (void)state;
    pl_scene scene = box_scene();
    pl_metric item[PL_METRIC_COUNT] = {0};
    item[PL_METRIC_MOMENTUM_ERROR] = pl_metric_failed("no contacts");
    pl_chaotic_metrics(&scene, item);
    assert_int_equal(item[PL_METRIC_CHAOTIC_ERROR].state, PL_METRIC_FAILED);
    assert_contains(item[PL_METRIC_CHAOTIC_ERROR].reason, "has a value");
    item[PL_METRIC_ENERGY_GAIN] = pl_metric_value(0.5);
    pl_chaotic_metrics(&scene, item);
    assert_close(item[PL_METRIC_CHAOTIC_ERROR].value, 0.5, 0, 0);
    scene.primary_error[0] = '\0';
    item[PL_METRIC_CHAOTIC_ERROR] = (pl_metric){0};
    pl_chaotic_metrics(&scene, item);
    assert_int_equal(item[PL_METRIC_CHAOTIC_ERROR].state, PL_METRIC_ABSENT);
    pl_scene_free(&scene);
}

/* ---- Engines that are wrong ---- */

/* A motion of all dynamic bodies: where a body is `time` after the start. */
typedef void (*motion)(const pl_scene *scene, double time, pl_body_state *bodies);

static void frozen(const pl_scene *scene, double time, pl_body_state *bodies)
{
    (void)scene;
    (void)time;
    (void)bodies;
}

/* Everything falls in free flight, but no deeper than the floor: bodies pass through each other. */
static void ghosts(const pl_scene *scene, double time, pl_body_state *bodies)
{
    for (int i = 0; i < scene->body_count; ++i) {
        const pl_body *body = &scene->bodies[i];
        if (!body->is_static) {
            for (int k = 0; k < 3; ++k) {
                bodies[i].position[k] = body->position[k] + body->velocity[k] * time +
                                        scene->gravity[k] * time * time / 2;
                bodies[i].velocity[k] = body->velocity[k] + scene->gravity[k] * time;
            }
            if (bodies[i].position[2] < 0.25) {
                bodies[i].position[2] = 0.25;
                memset(bodies[i].velocity, 0, sizeof bodies[i].velocity);
            }
        }
    }
}

/* Every body flies off sideways at 10 m/s. */
static void explosion(const pl_scene *scene, double time, pl_body_state *bodies)
{
    for (int i = 0; i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static) {
            bodies[i].velocity[1] = 10 + i;
            bodies[i].position[1] = scene->bodies[i].position[1] + bodies[i].velocity[1] * time;
        }
    }
}

/* The chaotic error of a motion; HUGE_VAL where the run did not end well. */
static double judge(const pl_scene *scene, motion moves)
{
    pl_referee *referee = pl_referee_create(scene, 1);
    pl_metrics metrics;
    pl_body_state *bodies = calloc((size_t)scene->body_count, sizeof *bodies);
    assert_non_null(bodies);
    for (int i = 0; i < scene->body_count; ++i) {
        memcpy(bodies[i].position, scene->bodies[i].position, sizeof bodies[i].position);
        memcpy(bodies[i].orientation, scene->bodies[i].orientation, sizeof bodies[i].orientation);
        memcpy(bodies[i].velocity, scene->bodies[i].velocity, sizeof bodies[i].velocity);
    }
    pl_frame frame = {.bodies = bodies};
    pl_ending verdict = pl_referee_start(referee, &(pl_referee_engine){0}, &frame);
    for (long step = 1; step <= pl_scene_steps(scene) && verdict == PL_ENDING_OK; ++step) {
        moves(scene, (double)step * scene->dt, bodies);
        const pl_step seen = {.after = bodies, .contact_count = -1};
        verdict = pl_referee_step(referee, &seen, NULL);
    }
    pl_note note;
    verdict = pl_referee_finish(referee, NULL, &metrics, &note, NULL);
    pl_referee_destroy(referee);
    free(bodies);
    return verdict == PL_ENDING_OK ? metrics.item[PL_METRIC_CHAOTIC_ERROR].value : HUGE_VAL;
}

/* The engine reports no contacts, so that its momentum is not judged. */
static void test_no_wrong_engine_is_accurate(void **state)
{
    (void)state;
    static const motion motions[] = {frozen, ghosts, explosion};
    static const char *const names[] = {"wall-collapse", "pile", "falling-cubes", "dominoes",
                                        "domino-into-pile"};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
        pl_scene scene = scenario_scene(names[i], NULL);
        for (size_t k = 0; k < sizeof motions / sizeof *motions; ++k) {
            const double error = judge(&scene, motions[k]);
            if (!(error > scene.acceptance)) {
                fail_msg("%s: motion %zu has an error of %g, and %g is accurate", names[i], k,
                         error, scene.acceptance);
            }
        }
        pl_scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_statistics_count_outside_their_interval),
        cmocka_unit_test(test_largest_part_is_the_error),
        cmocka_unit_test(test_parts_without_a_value_are_left_out),
        cmocka_unit_test(test_no_wrong_engine_is_accurate),
    };
    return cmocka_run_group_tests_name("referee chaotic", tests, NULL, NULL);
}
