/* The engine's broad phase against all pairs. */
#include "broad_phase.h"
#include "check.h"
#include "collide_convex.h"
#include "world_for_tests.h"

#include <string.h>

static const double H = 1.0 / 60;

enum { CROWD = 150, STEPS = 40 };

static pe_vec3 random_vector(check_random *random, double reach)
{
    double x = check_uniform(random, -reach, reach), y = check_uniform(random, -reach, reach);
    return pe_v3(x, y, check_uniform(random, -reach, reach));
}

/* Crowded, most of it in a cube of 3 m, with some bodies far out. */
static pe_body_state random_state(check_random *random, bool is_static)
{
    double q[4];
    check_quaternion(random, q);
    bool far_out = check_uniform(random, 0, 1) < 0.05;
    double speed = is_static ? 0 : check_uniform(random, 0, 5);
    return (pe_body_state){
        .position = random_vector(random, far_out ? 1e7 : 3),
        .orientation = {q[0], q[1], q[2], q[3]},
        .velocity = random_vector(random, speed),
        .angular_velocity = random_vector(random, speed),
    };
}

/* Boxes and spheres from 2 cm to 5 m, a fifth of them static, and two planes. */
static pe_world *crowd(check_random *random, pe_body_id *ids)
{
    pe_world *world = make_world(NULL);
    for (int i = 0; i < CROWD; ++i) {
        double size = 0.02 * pow(250, pow(check_uniform(random, 0, 1), 3));
        pe_body_def def = i % 3 == 0 ? pe_body_def_default()
                                     : box_def(size, 2 * size, 0.5 * size, pe_v3(0, 0, 0));
        if (i % 3 == 0) {
            def.shape.radius = size;
        }
        def.is_static = i % 5 == 0;
        if (i % 70 == 5) {
            double angle = i;
            def.shape = (pe_shape){
                .kind = PE_SHAPE_PLANE, .normal = {cos(angle), 0, sin(angle)}, .offset = -2};
        }
        ids[i] = add_body(world, &def);
    }
    return world;
}

static void move_at_random(pe_world *world, const pe_body_id *ids, check_random *random)
{
    for (int i = 0; i < CROWD; ++i) {
        if (!pe_bodies(world)[ids[i].index].is_static) {
            pe_body_state s = random_state(random, false);
            assert_int_equal(pe_body_set_state(world, ids[i], &s, NULL), PE_OK);
        }
    }
}

static bool is_there(const pe_pair *pairs, int count, int a, int b)
{
    for (int i = 0; i < count; ++i) {
        if (pairs[i].a == a && pairs[i].b == b) {
            return true;
        }
    }
    return false;
}

static void assert_sorted(const pe_world *world, const pe_pair *pairs, int count)
{
    for (int i = 0; i < count; ++i) {
        assert_true(pairs[i].a < pairs[i].b);
        assert_false(pe_bodies(world)[pairs[i].a].is_static &&
                     pe_bodies(world)[pairs[i].b].is_static);
        if (i > 0) {
            assert_true(pairs[i - 1].a < pairs[i].a ||
                        (pairs[i - 1].a == pairs[i].a && pairs[i - 1].b < pairs[i].b));
        }
    }
}

static void test_every_pair_within_its_margin_is_found_once_and_in_order(void **state)
{
    (void)state;
    check_random random = {4711};
    pe_body_id ids[CROWD];
    pe_world *world = crowd(&random, ids);
    for (int i = 0; i < CROWD; ++i) {
        pe_body_state s = random_state(&random, true);
        assert_int_equal(pe_body_set_state(world, ids[i], &s, NULL), PE_OK);
    }
    int near = 0, listed = 0;
    for (int n = 0; n < STEPS; ++n) {
        move_at_random(world, ids, &random);
        pe_arena_reset(&world->arena, &world->allocator);
        pe_pair *pairs;
        int count;
        assert_int_equal(pe_broad_phase(world, H, &pairs, &count, NULL), PE_OK);
        assert_sorted(world, pairs, count);
        listed += count;
        const pe_body *bodies = pe_bodies(world);
        const pe_pose *poses = pe_poses(world);
        for (int a = 1; a < world->slot_count; ++a) {
            for (int b = a + 1; b < world->slot_count; ++b) {
                if (bodies[a].is_static && bodies[b].is_static) {
                    continue;
                }
                pe_hits hits;
                collide_convex(
                    (pe_placed){&bodies[a].shape, bodies[a].geometry, &poses[a], bodies[a].size},
                    (pe_placed){&bodies[b].shape, bodies[b].geometry, &poses[b], bodies[b].size},
                    pe_pair_margin(world, a, b, H), &hits);
                if (hits.count > 0) {
                    assert_true(is_there(pairs, count, a, b));
                    near += 1;
                }
            }
        }
    }
    assert_true(near > 3000);
    assert_true(listed < 8 * near); /* not all pairs */
    pe_world_destroy(world);
}

static void test_pairs_of_moved_bodies_are_those_of_all_pairs(void **state)
{
    (void)state;
    check_random random = {99};
    pe_body_id ids[CROWD];
    pe_world *world = crowd(&random, ids);
    int kept = 0;
    for (int n = 0; n < STEPS; ++n) {
        move_at_random(world, ids, &random);
        bool moved[CROWD + 1] = {0};
        for (int slot = 1; slot <= CROWD; ++slot) {
            moved[slot] = check_uniform(&random, 0, 1) < 0.1;
        }
        pe_arena_reset(&world->arena, &world->allocator);
        pe_pair *all, *some;
        int all_count, some_count, next = 0;
        assert_int_equal(pe_broad_phase(world, H, &all, &all_count, NULL), PE_OK);
        assert_int_equal(pe_broad_phase_moved(world, H, moved, &some, &some_count, NULL), PE_OK);
        for (int i = 0; i < all_count; ++i) {
            if (moved[all[i].a] || moved[all[i].b]) {
                assert_true(next < some_count);
                assert_memory_equal(&all[i], &some[next], sizeof all[i]);
                next += 1;
            }
        }
        assert_int_equal(next, some_count);
        kept += next;
    }
    assert_true(kept > 500);
    pe_world_destroy(world);
}

static void test_resting_neighbours_are_the_only_pairs_of_a_wall(void **state)
{
    (void)state;
    enum { ROWS = 8, COLUMNS = 12 };
    pe_world *world = make_world(NULL);
    add_plane(world, pe_v3(0, 0, 1), (pe_material_id){0});
    for (int row = 0; row < ROWS; ++row) {
        for (int column = 0; column < COLUMNS; ++column) {
            pe_body_def def =
                box_def(0.5, 0.25, 0.25, pe_v3(column + 0.5 * (row % 2), 0, 0.5 * row + 0.25));
            add_body(world, &def);
        }
    }
    pe_pair *pairs;
    int count;
    assert_int_equal(pe_broad_phase(world, H, &pairs, &count, NULL), PE_OK);
    /* On the floor; beside; over, by halves, where the last brick of a row sticks out. */
    assert_int_equal(count, COLUMNS + ROWS * (COLUMNS - 1) + (ROWS - 1) * (2 * COLUMNS - 1));
    pe_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_pair_within_its_margin_is_found_once_and_in_order),
        cmocka_unit_test(test_pairs_of_moved_bodies_are_those_of_all_pairs),
        cmocka_unit_test(test_resting_neighbours_are_the_only_pairs_of_a_wall),
    };
    return cmocka_run_group_tests_name("engine_broad_phase", tests, NULL, NULL);
}
