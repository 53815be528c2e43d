/* How long members stay together, on trajectories that are written by hand. */
#include "check.h"
#include "plumb/jitter.h"
#include "plumb_process.h"
#include "runner/execute.h"
#include "runner/positions.h"
#include "runner/recording.h"
#include "studies/ensemble/members.h"
#include "studies/ensemble/sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void test_spread_is_that_of_the_most_spread_body(void **state)
{
    (void)state;
    /* Two bodies, four members: the second body lies on the corners of a tetrahedron. */
    static const double at[4][6] = {
        {9, 9, 9, 1, 1, 1}, {9, 9, 9, 1, -1, -1}, {9, 9, 9, -1, 1, -1}, {9, 9, 9, -1, -1, 1}};
    const double *members[4] = {at[0], at[1], at[2], at[3]};
    assert_close(pl_ensemble_spread(members, 4, 1), 0, 0, 0);
    assert_close(pl_ensemble_spread(members, 4, 2), sqrt(3 * 4.0 / 3), 1e-15, 0);
}

static void test_samples_are_at_most_60_a_second(void **state)
{
    (void)state;
    assert_int_equal(pl_positions_stride(1.0 / 30), 1);
    assert_int_equal(pl_positions_stride(1.0 / 60), 1);
    assert_int_equal(pl_positions_stride(1.0 / 61), 2);
    assert_int_equal(pl_positions_stride(1.0 / 240), 4);
    assert_int_equal(pl_positions_stride(1.0 / 960), 16);
    assert_int_equal(pl_positions_stride(1.0 / 1000), 17);
}

/* Two members of a tower of two cubes of 1 m. */
typedef struct fixture {
    char *folder;
    pl_plan plan;
    pl_ensembles ensembles;
} fixture;

static pl_status add_tower(void *user, int setting, pl_plan *plan, pl_error *error)
{
    (void)user;
    (void)setting;
    static const char *const settings[] = {"n=2", "dt=1/240", "duration=1"};
    return pl_plan_add_scenario(plan, pl_scenario_find("tower", NULL), settings, 3, error);
}

static int prepare(void **state)
{
    fixture *f = calloc(1, sizeof *f);
    const pl_members_def def = {.members = 2, .add = add_tower};
    f->plan = (pl_plan){.repeats = 1};
    f->folder = make_directory();
    assert_int_equal(pl_plan_add_engine(&f->plan, "plumb", NULL), PL_OK);
    assert_int_equal(pl_members_plan(&def, &f->plan, &f->ensembles, NULL), PL_OK);
    assert_int_equal(f->ensembles.count, 1);
    *state = f;
    return 0;
}

static int clean(void **state)
{
    fixture *f = *state;
    free(f->ensembles.items);
    pl_plan_free(&f->plan);
    remove_directory(f->folder);
    free(f);
    return 0;
}

/* Writes a member's trajectory of so many steps in which every body flies along x at `speed`. */
static void write_member(const fixture *f, int member, double speed, long steps)
{
    const pl_ensemble *ensemble = &f->ensembles.items[0];
    const pl_scene *scene = &f->plan.cases[pl_member_case(&f->ensembles, ensemble, member)].scene;
    pl_body_state states[8];
    pl_positions_writer writer;
    memset(states, 0, sizeof states);
    assert_true(scene->body_count <= 8);
    json_t *runs = pl_member_runs(&f->plan, &f->ensembles, ensemble);
    char *path = pl_run_file(f->folder, json_string_value(json_array_get(runs, (size_t)member)),
                             "positions");
    json_decref(runs);
    assert_int_equal(pl_positions_create(path, scene, 0, &writer, NULL), PL_OK);
    for (long step = 0; step <= steps; ++step) {
        for (int i = 0; i < scene->body_count; ++i) {
            memcpy(states[i].position, scene->bodies[i].position, sizeof states[i].position);
            memcpy(states[i].orientation, scene->bodies[i].orientation,
                   sizeof states[i].orientation);
            states[i].position[0] += speed * (double)step * scene->dt;
        }
        const pl_frame frame = {.body_count = scene->body_count, .bodies = states};
        assert_int_equal(pl_positions_write(&writer, step, &frame, NULL), PL_OK);
    }
    pl_positions_end(&writer);
    free(path);
}

/* The caller decrefs. */
static json_t *find(const fixture *f)
{
    const pl_ensemble *ensemble = &f->ensembles.items[0];
    json_t *runs = pl_member_runs(&f->plan, &f->ensembles, ensemble);
    json_t *horizon = pl_horizon_find(f->folder, runs,
                                      pl_scene_least_size(&f->plan.cases[ensemble->first].scene));
    json_decref(runs);
    return horizon;
}

/* The horizon of two members at these speeds along x, the second of which has `steps` steps. */
static json_t *horizon_of_two(const fixture *f, double first, double second, long steps)
{
    write_member(f, 0, first, 240);
    write_member(f, 1, second, steps);
    return find(f);
}

static double number(const json_t *horizon, const char *key)
{
    assert_true(json_is_number(json_object_get(horizon, key)));
    return json_number_value(json_object_get(horizon, key));
}

static void test_horizon_is_at_a_hundredth_body_size(void **state)
{
    json_t *horizon = horizon_of_two(*state, 0, 0.04, 240);
    const double time = number(horizon, "time");
    assert_close(number(horizon, "threshold"), 0.01, 1e-15, 0);
    /* Two members d apart spread by d / sqrt(2): 0.01 m at 0.354 s, but for the jitter of at most
     * 2e-4 m in each axis, which is 5 ms of flight along x and nothing across; seen at the next
     * sample. */
    assert_close(time, 0.01 * sqrt(2) / 0.04 + 0.5 / 60, 5e-3 + 0.5 / 60, 0);
    assert_close(time * 60, round(time * 60), 1e-9, 0);
    assert_close(number(horizon, "last_time"), 1, 1e-12, 0);
    assert_close(number(horizon, "last_spread"), 0.04 / sqrt(2), 2e-4, 0);
    json_decref(horizon);
}

static void test_members_that_stay_together_have_no_horizon(void **state)
{
    json_t *horizon = horizon_of_two(*state, 3, 3, 240);
    assert_true(json_is_null(json_object_get(horizon, "time")));
    assert_at_most(number(horizon, "last_spread"), 1e-4 * sqrt(6));
    json_decref(horizon);
}

static void test_a_member_that_ended_early_ends_the_search(void **state)
{
    json_t *horizon = horizon_of_two(*state, 0, 0.04, 60);
    assert_true(json_is_null(json_object_get(horizon, "time")));
    assert_contains(json_string_value(json_object_get(horizon, "reason")), "within 0.25 s");
    assert_close(number(horizon, "last_time"), 0.25, 1e-12, 0);
    json_decref(horizon);
}

static void test_without_every_trajectory_nothing_is_known(void **state)
{
    const fixture *f = *state;
    write_member(f, 1, 0, 240);
    json_t *horizon = find(f);
    assert_null(json_object_get(horizon, "threshold"));
    assert_contains(json_string_value(json_object_get(horizon, "reason")), "1 of 2 members");
    json_decref(horizon);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spread_is_that_of_the_most_spread_body),
        cmocka_unit_test(test_samples_are_at_most_60_a_second),
        cmocka_unit_test_setup_teardown(test_horizon_is_at_a_hundredth_body_size, prepare, clean),
        cmocka_unit_test_setup_teardown(test_members_that_stay_together_have_no_horizon, prepare,
                                        clean),
        cmocka_unit_test_setup_teardown(test_a_member_that_ended_early_ends_the_search, prepare,
                                        clean),
        cmocka_unit_test_setup_teardown(test_without_every_trajectory_nothing_is_known, prepare,
                                        clean),
    };
    return cmocka_run_group_tests_name("ensemble horizon", tests, NULL, NULL);
}
