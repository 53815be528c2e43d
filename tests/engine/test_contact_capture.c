/* Contact problems captured from a world: they are those of the next step, and capturing changes
 * nothing. */
#include "check.h"
#include "contact_problem_for_tests.h"
#include "counting_allocator.h"
#include "world_for_tests.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BODIES = 12 };

/* A tower of six hit by a box, and away from it spheres that rest and roll. */
static pe_world *make_scene(const pe_world_def *def, pe_body_id ids[BODIES])
{
    pe_world *world = make_world(def);
    pe_material_id material = add_material(world, 0.4, 0);
    add_tower(world, 6, material, ids);
    pe_body_def box = box_def(0.3, 0.4, 0.2, (pe_vec3){-1.2, 0.1, 4.2});
    box.velocity.x = 3;
    box.angular_velocity.y = 1;
    box.material = material;
    ids[6] = add_body(world, &box);
    for (int i = 7; i < BODIES; ++i) {
        pe_body_def sphere = pe_body_def_default();
        sphere.material = material;
        sphere.position = (pe_vec3){5 + 0.95 * (i - 7), 0.1 * i, 0.5 + 0.02 * i};
        sphere.velocity.y = i % 2 == 0 ? 0.5 : -0.5;
        ids[i] = add_body(world, &sphere);
    }
    return world;
}

static pe_contact_problem **capture(pe_world *world, double dt, int *count)
{
    pe_contact_problem **problems;
    pe_error error;
    if (pe_world_capture_problems(world, dt, &problems, count, &error) != PE_OK) {
        fail_msg("%s", error.message);
    }
    return problems;
}

static void assert_same_states(const pe_world *a, const pe_world *b, const pe_body_id *ids)
{
    for (int i = 0; i < BODIES; ++i) {
        pe_body_state x = state_of(a, ids[i]), y = state_of(b, ids[i]);
        assert_memory_equal(&x, &y, sizeof x);
    }
}

/* The velocities that the body has in the world, and those of the solution. */
static void assert_velocities(const pe_world *world, pe_body_id id, const double v[6])
{
    pe_body_state s = state_of(world, id);
    const double w[6] = {s.velocity.x,         s.velocity.y,         s.velocity.z,
                         s.angular_velocity.x, s.angular_velocity.y, s.angular_velocity.z};
    for (int k = 0; k < 6; ++k) {
        assert_close(v[k], w[k], 1e-9, 0);
    }
}

/* The number of bodies of the problems that have the velocities of the step; fails for one that has
 * others. Problems that one of the two did not solve are skipped. */
static int count_equal(const pe_world *world, pe_contact_problem *const *problems, int count)
{
    const pe_solve_limits limits = {.tolerance = 1e-10, .max_iterations = 100000};
    int equal = 0;
    for (int k = 0; k < count; ++k) {
        pe_contact_solution s;
        assert_int_equal(pe_contact_problem_solve(problems[k], "direct", &limits, NULL, &s, NULL),
                         PE_OK);
        for (int i = 0; i < problems[k]->body_count && s.stop == PE_STOP_CONVERGED; ++i) {
            assert_velocities(world, problems[k]->bodies[i].id, s.velocities[i]);
            ++equal;
        }
        pe_contact_solution_free(&s);
    }
    return equal;
}

static void test_captured_problem_gives_the_velocities_of_the_step(void **state)
{
    (void)state;
    enum { STEPS = 30, ALL = 7 };
    pe_world_def def = pe_world_def_default();
    def.tolerance = 1e-10;
    pe_body_id ids[5];
    pe_world *world = make_world(&def);
    pe_material_id material = add_material(world, 0.4, 0);
    add_tower(world, 5, material, ids);
    pe_body_state pushed = state_of(world, ids[4]);
    pushed.velocity.x = 0.05; /* the top one slides */
    assert_int_equal(pe_body_set_state(world, ids[4], &pushed, NULL), PE_OK);
    for (int i = 0; i < 2; ++i) { /* one that rolls, and one that slides and spins up */
        pe_body_def sphere = pe_body_def_default();
        sphere.material = material;
        sphere.position = (pe_vec3){10 + 3 * i, 0, 0.5};
        sphere.velocity = (pe_vec3){0.3, 2, 0};
        sphere.angular_velocity = i == 0 ? (pe_vec3){-4, 0.6, 0.5} : (pe_vec3){3, 0, 0};
        add_body(world, &sphere);
    }
    int equal = 0;
    for (int k = 0; k < STEPS; ++k) {
        int count;
        pe_contact_problem **problems = capture(world, STEP, &count);
        pe_step_stats stats = step(world, STEP);
        assert_int_equal(count, 3);
        equal += stats.unconverged_islands == 0 ? count_equal(world, problems, count) : 0;
        pe_contact_problems_destroy(problems, count);
    }
    assert_true(equal >= STEPS * ALL * 2 / 3); /* most of them were solved and compared */
    pe_world_destroy(world);
}

static void test_capture_holds_every_contact_and_island(void **state)
{
    (void)state;
    pe_body_id ids[BODIES];
    pe_world *world = make_scene(NULL, ids);
    for (int k = 0; k < 60; ++k) {
        int count, points = 0, manifolds = 0;
        pe_contact_problem **problems = capture(world, STEP, &count);
        for (int i = 0; i < count; ++i) {
            pe_problem_fault fault;
            if (!pe_contact_problem_is_valid(problems[i], &fault)) {
                fail_msg("%s[%d].%s: %s", fault.list, fault.index, fault.field, fault.text);
            }
            points += problems[i]->point_count;
            manifolds += problems[i]->manifold_count;
        }
        pe_step_stats stats = step(world, STEP);
        assert_int_equal(count, stats.islands);
        assert_int_equal(points, stats.contacts);
        assert_int_equal(manifolds, stats.manifolds);
        pe_contact_problems_destroy(problems, count);
    }
    pe_world_destroy(world);
}

static void test_capture_holds_the_warm_start(void **state)
{
    (void)state;
    pe_body_id ids[6];
    pe_world *world = make_world(NULL);
    add_tower(world, 6, add_material(world, 0.5, 0), ids);
    step(world, STEP);
    int count;
    double sum = 0;
    pe_contact_problem **problems = capture(world, STEP, &count);
    assert_int_equal(count, 1);
    for (int j = 0; j < problems[0]->manifolds[0].count; ++j) {
        sum += problems[0]->points[j].impulse[0];
    }
    assert_close(sum, 6 * GRAVITY * STEP, 1e-6, 0);
    pe_contact_problems_destroy(problems, count);
    pe_world_destroy(world);
}

static void test_capturing_does_not_change_the_steps(void **state)
{
    (void)state;
    pe_body_id ids[BODIES], twin_ids[BODIES];
    pe_world *world = make_scene(NULL, ids), *twin = make_scene(NULL, twin_ids);
    for (int k = 0; k < 60; ++k) {
        double dt = k % 7 == 3 ? STEP / 2 : STEP;
        int count;
        pe_contact_problem **problems = capture(world, dt, &count);
        pe_contact_problems_destroy(problems, count);
        problems = capture(world, dt, &count);
        pe_contact_problems_destroy(problems, count);
        step(world, dt);
        step(twin, dt);
        assert_same_states(world, twin, ids);
        if (k % 10 == 5) {
            pe_body_state moved = state_of(world, ids[8]);
            moved.position.z += 0.01;
            assert_int_equal(pe_body_set_state(world, ids[8], &moved, NULL), PE_OK);
            assert_int_equal(pe_body_set_state(twin, twin_ids[8], &moved, NULL), PE_OK);
        }
    }
    pe_world_destroy(world);
    pe_world_destroy(twin);
}

static void test_without_contact_there_is_no_problem(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_def sphere = pe_body_def_default();
    add_body(world, &sphere);
    int count = -1;
    pe_contact_problem **problems = capture(world, STEP, &count);
    assert_int_equal(count, 0);
    pe_contact_problems_destroy(problems, count);
    pe_error error;
    assert_int_equal(pe_world_capture_problems(world, 0, &problems, &count, &error),
                     PE_BAD_ARGUMENT);
    assert_contains(error.message, "dt");
    assert_int_equal(pe_world_capture_problems(world, (double)NAN, &problems, &count, NULL),
                     PE_BAD_ARGUMENT);
    pe_world_destroy(world);
}

static void test_one_of_many_problems_can_be_kept(void **state)
{
    (void)state;
    pe_body_id ids[BODIES];
    pe_world *world = make_scene(NULL, ids);
    step(world, STEP);
    int count;
    pe_contact_problem **problems = capture(world, STEP, &count);
    assert_true(count > 1);
    pe_contact_problem *last = problems[count - 1];
    assert_ptr_equal(pe_contact_problems_keep(problems, count, count - 1), last);
    assert_true(last->point_count > 0);
    pe_contact_problem_destroy(last);
    pe_world_destroy(world);
}

/* ---- Memory ---- */

static void test_failed_capture_does_not_change_the_steps(void **state)
{
    (void)state;
    bool done = false;
    for (int k = 0; !done; ++k) {
        counter c = {.fail_at = -1};
        pe_world_def def = pe_world_def_default();
        def.allocator = (pe_allocator){count_allocate, count_release, &c};
        pe_body_id ids[BODIES], twin_ids[BODIES];
        pe_world *world = make_scene(&def, ids), *twin = make_scene(NULL, twin_ids);
        int count = 0;
        pe_contact_problem **problems = NULL;
        pe_error error = {.message = ""};
        c.calls = 0;
        c.fail_at = k;
        pe_status status = pe_world_capture_problems(world, STEP, &problems, &count, &error);
        c.fail_at = -1;
        done = status == PE_OK;
        if (done) {
            pe_contact_problems_destroy(problems, count);
        } else {
            assert_int_equal(status, PE_NO_MEMORY);
            assert_contains(error.message, "memory");
        }
        for (int i = 0; i < 3; ++i) {
            step(world, STEP);
            step(twin, STEP);
        }
        assert_same_states(world, twin, ids);
        pe_world_destroy(world);
        pe_world_destroy(twin);
        assert_int_equal(c.living, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_captured_problem_gives_the_velocities_of_the_step),
        cmocka_unit_test(test_capture_holds_every_contact_and_island),
        cmocka_unit_test(test_capture_holds_the_warm_start),
        cmocka_unit_test(test_capturing_does_not_change_the_steps),
        cmocka_unit_test(test_without_contact_there_is_no_problem),
        cmocka_unit_test(test_one_of_many_problems_can_be_kept),
        cmocka_unit_test(test_failed_capture_does_not_change_the_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
