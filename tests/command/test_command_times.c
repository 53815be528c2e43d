/* CPU and wall time of create, step and read: each call's cost is in the metric of its name alone, and
 * all of it. The engine works until its own clock says so; what is compared otherwise differs by a
 * factor of a hundred. */
#include "check.h"
#include "plumb_process.h"

#include <stdio.h>
#include <stdlib.h>

/* The result of a run of the faulty engine with the profile. */
static json_t *run_profile(void **state, const char *profile)
{
    const workspace *w = *state;
    char engine[512];
    snprintf(engine, sizeof engine, "%s:%s", FAULTY, profile);
    const char *const arguments[] = {"run", w->scene, "--engine", engine, "--json", "-", NULL};
    plumb_output output = run_plumb(w->directory, arguments);
    json_t *result = json_loads(output.out, 0, NULL);
    assert_int_equal(output.code, 0);
    assert_non_null(result);
    free_output(&output);
    return result;
}

static double value(const json_t *result, const char *metric)
{
    const json_t *found =
        json_object_get(json_object_get(json_object_get(result, "metrics"), metric), "value");
    if (!json_is_number(found)) {
        print_error("%s has no value\n", metric);
        fail();
    }
    return json_number_value(found);
}

static void test_an_engine_that_sleeps_has_wall_time_alone(void **state)
{
    json_t *sleeps = run_profile(state, "slow_print");
    assert_true(value(sleeps, "wall_time_per_step") > 10 * value(sleeps, "time_per_step"));
    assert_true(value(sleeps, "wall_time_per_step") > 10 * value(sleeps, "wall_time_read"));
    assert_true(value(sleeps, "wall_time_per_step") > 10 * value(sleeps, "time_create"));
    json_decref(sleeps);
}

static void test_work_in_create_is_time_of_create(void **state)
{
    json_t *works = run_profile(state, "work_in_create"), *good = run_profile(state, "good");
    assert_true(value(works, "time_create") > 10 * value(good, "time_create"));
    assert_true(value(works, "time_create") > 10 * value(works, "time_per_step"));
    assert_true(value(works, "time_create") > 10 * value(works, "time_read"));
    assert_true(value(works, "wall_time_create") > 0.5 * value(works, "time_create"));
    json_decref(works);
    json_decref(good);
}

static void test_work_in_reading_is_time_of_reading(void **state)
{
    json_t *works = run_profile(state, "work_in_read");
    assert_true(value(works, "time_read") > 10 * value(works, "time_per_step"));
    assert_true(value(works, "time_read") > 10 * value(works, "time_create"));
    assert_true(value(works, "wall_time_read") > 0.5 * value(works, "time_read"));
    json_decref(works);
}

/* The engine works for so long by the clock of the same process, on one thread. */
static void test_no_measured_time_is_less_than_the_work(void **state)
{
    static const struct {
        const char *profile, *cpu, *wall;
        double work; /* s */
    } cases[] = {{"work_in_create", "time_create", "wall_time_create", 0.05},
                 {"work_in_step", "time_per_step", "wall_time_per_step", 0.002},
                 {"work_in_read", "time_read", "wall_time_read", 0.002}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        json_t *result = run_profile(state, cases[i].profile);
        const double cpu = value(result, cases[i].cpu), wall = value(result, cases[i].wall);
        assert_true(cpu > 0.99 * cases[i].work);
        assert_true(wall > 0.99 * cpu);
        json_decref(result);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_an_engine_that_sleeps_has_wall_time_alone),
        cmocka_unit_test(test_work_in_create_is_time_of_create),
        cmocka_unit_test(test_work_in_reading_is_time_of_reading),
        cmocka_unit_test(test_no_measured_time_is_less_than_the_work),
    };
    return cmocka_run_group_tests_name("times", tests, setup_workspace, teardown_workspace);
}
