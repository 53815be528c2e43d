#include "scenario_scene.h"

#include "check.h"
#include "plumb_process.h"
#include "run_result.h"

#include <string.h>

enum { MOST_SETTINGS = 10, MOST_UNKNOWNS = 8 };

static int count_of_settings(const char *const *settings)
{
    int count = 0;
    while (settings != NULL && settings[count] != NULL) {
        ++count;
    }
    return count;
}

static pl_status build(const char *name, const char *const *settings, int count, uint64_t seed,
                       pl_scene *scene, pl_error *error)
{
    double values[PL_MAX_PARAMS];
    *scene = pl_scene_default();
    const pl_scenario *scenario = pl_scenario_find(name, error);
    assert_non_null(scenario);
    pl_status status = pl_scenario_values(scenario, settings, count, values, error);
    return status == PL_OK ? pl_scenario_build(scenario, values, seed, scene, error) : status;
}

void build_scenario(const char *name, const char *const *settings, int count, uint64_t seed,
                    pl_scene *scene)
{
    pl_error error = {.message = ""};
    if (build(name, settings, count, seed, scene, &error) != PL_OK) {
        fail_msg("%s %s: %s", name, count > 0 ? settings[0] : "", error.message);
    }
}

pl_scene scenario_scene(const char *name, const char *const *settings)
{
    pl_scene scene;
    build_scenario(name, settings, count_of_settings(settings), 0, &scene);
    return scene;
}

const pl_expect_value *expected_value(const pl_scene *scene, int body, pl_quantity quantity,
                                      int axis)
{
    const pl_expect_value *found = NULL;
    for (int i = 0; i < scene->value_count; ++i) {
        const pl_expect_value *value = &scene->values[i];
        if (value->body == body && value->quantity == quantity && value->direction[axis] == 1) {
            assert_null(found);
            found = value;
        }
    }
    assert_non_null(found);
    return found;
}

void assert_scenario_refuses(const char *name, const char *const *settings, const char *part)
{
    pl_scene scene;
    pl_error error = {.message = ""};
    int count = count_of_settings(settings);
    assert_int_equal(build(name, settings, count, 0, &scene, &error), PL_BAD_INPUT);
    assert_null(scene.bodies);
    assert_contains(error.message, part);
}

void assert_setting_refused(const char *name, const char *setting, const char *part)
{
    const char *const settings[] = {setting, NULL};
    assert_scenario_refuses(name, settings, part);
}

void check_all_rest(const pl_scene *scene)
{
    int dynamic = 0;
    for (int i = 0; i < scene->body_count; ++i) {
        dynamic += scene->bodies[i].is_static ? 0 : 1;
    }
    assert_int_equal(scene->rest_count, dynamic);
    for (int i = 0; i < scene->rest_count; ++i) {
        const pl_expect_rest *rest = &scene->rests[i];
        const pl_body *body = &scene->bodies[rest->body];
        assert_true(rest->has_orientation);
        assert_memory_equal(rest->position, body->position, sizeof rest->position);
        assert_memory_equal(rest->orientation, body->orientation, sizeof rest->orientation);
    }
}

double accurate_metric(const char *name, const char *const *settings, const char *dt,
                       const char *metric_name)
{
    const char *arguments[10 + 2 * MOST_SETTINGS] = {"run",  name, "--engine", "plumb:accurate",
                                                     "--dt", dt,   "--json",   "-"};
    int count = 8;
    assert_true(count_of_settings(settings) <= MOST_SETTINGS);
    for (int i = 0; i < count_of_settings(settings); ++i) {
        arguments[count++] = "--set";
        arguments[count++] = settings[i];
    }
    json_t *result = run_to_json(arguments);
    assert_string_equal(result_text(result, "outcome"), "ok");
    double value = metric(result, metric_name);
    json_decref(result);
    return value;
}

void integrate(rate_function rate, const void *context, double from, double until, int steps,
               int size, double *y)
{
    static const double node[4] = {0, 0.5, 0.5, 1},
                        weight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    const double h = (until - from) / steps;
    assert_true(size <= MOST_UNKNOWNS);
    for (int n = 0; n < steps; ++n) {
        double k[MOST_UNKNOWNS] = {0}, at[MOST_UNKNOWNS], sum[MOST_UNKNOWNS] = {0};
        for (int stage = 0; stage < 4; ++stage) {
            for (int i = 0; i < size; ++i) {
                at[i] = y[i] + node[stage] * h * k[i];
            }
            rate(context, from + (n + node[stage]) * h, at, k);
            for (int i = 0; i < size; ++i) {
                sum[i] += weight[stage] * k[i];
            }
        }
        for (int i = 0; i < size; ++i) {
            y[i] += h * sum[i];
        }
    }
}
