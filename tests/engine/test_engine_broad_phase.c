/* The engine's broad phase against all pairs. */
#include "broad_phase/broad_phase.h"
#include "check.h"
#include "collide_convex.h"
#include "counting_allocator.h"
#include "model/integrate.h"
#include "random_pose.h"
#include "world_for_tests.h"

#include <string.h>

static const double H = 1.0 / 60;

enum { CROWD = 150, STEPS = 40 };

/* Crowded, most of it in a cube of 3 m, with some bodies far out. */
static pe_body_state random_state(check_random *random, bool is_static)
{
    double q[4];
    check_quaternion(random, q);
    bool far_out = check_uniform(random, 0, 1) < 0.05;
    double speed = is_static ? 0 : check_uniform(random, 0, 5);
    pe_body_state s = {.orientation = {q[0], q[1], q[2], q[3]}};
    s.position = random_vector(random, far_out ? 1e7 : 3);
    s.velocity = random_vector(random, speed);
    s.angular_velocity = random_vector(random, speed);
    return s;
}

/* Boxes and spheres from 2 cm to 5 m, a fifth of them static, and two planes. */
static pe_world *crowd_in(pe_world *world, check_random *random, pe_body_id *ids)
{
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

static pe_world *crowd(check_random *random, pe_body_id *ids)
{
    return crowd_in(make_world(NULL), random, ids);
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

static bool is_there(const pe_pair_list *pairs, int a, int b)
{
    for (int i = 0; i < pairs->count; ++i) {
        if (pairs->items[i].a == a && pairs->items[i].b == b) {
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

typedef struct tally {
    int near, listed;
} tally;

/* The pairs of the poses now: in order, and all that the narrow phase finds within their margin. */
static void check_pairs(pe_world *world, tally *t)
{
    pe_arena_reset(&world->arena, &world->allocator);
    pe_pair_list pairs;
    assert_int_equal(pe_broad_phase(world, H, NULL, &pairs, NULL), PE_OK);
    assert_sorted(world, pairs.items, pairs.count);
    t->listed += pairs.count;
    const pe_body *bodies = pe_bodies(world);
    const pe_pose *poses = pe_poses(world);
    for (int a = 1; a < world->slot_count; ++a) {
        for (int b = a + 1; b < world->slot_count; ++b) {
            double margin = pe_pair_margin(world, a, b, H);
            bool placed = pe_is_finite(poses[a].position) && pe_is_finite(poses[b].position);
            bool alive = bodies[a].alive && bodies[b].alive;
            if (!alive || (bodies[a].is_static && bodies[b].is_static) || !isfinite(margin) ||
                !placed) {
                continue;
            }
            pe_pair_manifold manifold;
            collide_convex(
                (pe_placed){&bodies[a].shape, bodies[a].geometry, &poses[a], bodies[a].size},
                (pe_placed){&bodies[b].shape, bodies[b].geometry, &poses[b], bodies[b].size},
                margin, &manifold);
            if (manifold.count > 0) {
                assert_true(is_there(&pairs, a, b));
                t->near += 1;
            }
        }
    }
}

static void test_pairs_within_margin_are_found_once_in_order(void **state)
{
    (void)state;
    check_random random = {4711};
    pe_body_id ids[CROWD];
    pe_world *world = crowd(&random, ids);
    for (int i = 0; i < CROWD; ++i) {
        pe_body_state s = random_state(&random, true);
        assert_int_equal(pe_body_set_state(world, ids[i], &s, NULL), PE_OK);
    }
    tally t = {0};
    for (int n = 0; n < STEPS; ++n) {
        move_at_random(world, ids, &random);
        check_pairs(world, &t);
    }
    assert_true(t.near > 3000);
    assert_true(t.listed < 8 * t.near); /* not all pairs */
    pe_world_destroy(world);
}

/* A step's motion, without contacts. Some bodies jump, some are destroyed and replaced. */
static void disturb(pe_world *world, pe_body_id *ids, int step, check_random *random)
{
    for (int i = 0; i < CROWD; ++i) {
        bool is_static = pe_bodies(world)[ids[i].index].is_static;
        double chance = check_uniform(random, 0, 1);
        if (chance < 0.01) {
            pe_body_state s = random_state(random, is_static);
            assert_int_equal(pe_body_set_state(world, ids[i], &s, NULL), PE_OK);
        } else if (chance < 0.02 || (step == 20 && i % 70 == 5)) { /* the planes go as well */
            pe_body_state s = random_state(random, i % 5 == 0);
            pe_body_def def = box_def(0.3, 0.2, 0.1, s.position);
            def.is_static = i % 5 == 0;
            assert_int_equal(pe_body_destroy(world, ids[i], NULL), PE_OK);
            ids[i] = add_body(world, &def);
        } else {
            pe_twist *m = &pe_twists(world)[ids[i].index];
            pe_pose_move(&pe_poses(world)[ids[i].index], pe_scale(H, m->velocity),
                         pe_scale(H, m->angular_velocity));
            m->velocity = pe_scale(check_uniform(random, 0.5, 1.1), m->velocity);
        }
    }
}

static void test_kept_pairs_are_complete(void **state)
{
    (void)state;
    check_random random = {4712};
    pe_body_id ids[CROWD];
    pe_world *world = crowd(&random, ids);
    move_at_random(world, ids, &random);
    tally t = {0};
    for (int n = 0; n < 2 * STEPS; ++n) {
        disturb(world, ids, n, &random);
        check_pairs(world, &t);
    }
    assert_true(t.near > 3000);
    pe_world_destroy(world);
}

/* A body moves so slowly that it takes tens of steps to leave a box. */
static void test_slowly_approaching_bodies_become_a_pair(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(0, 0, 0));
    add_body(world, &def);
    def.position.x = 1.6;
    pe_body_id creeping = add_body(world, &def);
    int paired = 0;
    for (int n = 0; n < 600; ++n) {
        pe_poses(world)[creeping.index].position.x -= 1e-3;
        tally t = {0};
        check_pairs(world, &t);
        paired += t.listed;
    }
    /* Not before the last 25 mm: twice 3.7 mm of margin and a hundredth of the radius. */
    assert_in_range(paired, 4, 26);
    pe_world_destroy(world);
}

/* A long body rotates in place, by poses alone, until its end reaches another body. */
static void test_rotating_bodies_become_a_pair_in_time(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_def def = box_def(2, 0.05, 0.05, pe_v3(0, 0, 0));
    pe_body_id turning = add_body(world, &def);
    def = box_def(0.5, 0.5, 0.5, pe_v3(2, 1.5, 0));
    add_body(world, &def);
    tally t = {0};
    for (int n = 0; n < 600; ++n) {
        pe_pose_move(&pe_poses(world)[turning.index], pe_v3(0, 0, 0), pe_v3(0, 0, 1e-3));
        check_pairs(world, &t);
    }
    assert_in_range(t.near, 50, 150); /* at 0.5 rad they meet */
    pe_world_destroy(world);
}

static void test_new_floor_pairs_with_all_resting_bodies(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    for (int i = 0; i < 10; ++i) {
        pe_body_def def = box_def(0.5, 0.5, 0.5, pe_v3(2 * i, 0, 0.5));
        add_body(world, &def);
    }
    tally before = {0}, with = {0}, after = {0};
    check_pairs(world, &before);
    pe_body_id floor = add_plane(world, pe_v3(0, 0, 1), (pe_material_id){0});
    check_pairs(world, &with);
    assert_int_equal(pe_body_destroy(world, floor, NULL), PE_OK);
    check_pairs(world, &after);
    assert_int_equal(before.listed, 0);
    assert_int_equal(with.listed, 10);
    assert_int_equal(after.listed, 0);
    pe_world_destroy(world);
}

static void test_nan_position_has_no_pairs(void **state)
{
    (void)state;
    check_random random = {4713};
    pe_body_id ids[CROWD];
    pe_world *world = crowd(&random, ids);
    for (int n = 0; n < STEPS; ++n) {
        move_at_random(world, ids, &random);
        pe_poses(world)[ids[1].index].position.x = NAN;
        pe_twists(world)[ids[2].index].velocity.y = INFINITY; /* which could be everywhere */
        tally t = {0};
        check_pairs(world, &t);
        pe_pair_list pairs;
        int wide = 0, lost = (int)ids[1].index, fast = (int)ids[2].index;
        assert_int_equal(pe_broad_phase(world, H, NULL, &pairs, NULL), PE_OK);
        for (int i = 0; i < pairs.count; ++i) {
            int a = pairs.items[i].a, b = pairs.items[i].b;
            assert_true(a != lost && b != lost);
            wide += a == fast || b == fast;
        }
        assert_true(wide > CROWD / 2);
    }
    pe_world_destroy(world);
}

/* Every allocation of some steps of the broad phase fails once. The next call makes up for it. */
static void test_after_a_failed_allocation_no_pair_is_lost(void **state)
{
    (void)state;
    int failures = 0, last = 0;
    for (int k = 0; k <= last; ++k) {
        counter c = {.fail_at = -1};
        pe_world_def def = pe_world_def_default();
        def.allocator = (pe_allocator){count_allocate, count_release, &c};
        check_random random = {4714};
        pe_body_id ids[CROWD];
        pe_world *world = crowd_in(make_world(&def), &random, ids);
        int before = c.calls;
        c.fail_at = before + k;
        for (int n = 0; n < 3; ++n) {
            move_at_random(world, ids, &random);
            pe_arena_reset(&world->arena, &world->allocator);
            pe_pair_list pairs;
            pe_status status = pe_broad_phase(world, H, NULL, &pairs, NULL);
            assert_true(status == PE_OK || status == PE_NO_MEMORY);
            failures += status != PE_OK;
            tally t = {0};
            check_pairs(world, &t);
        }
        last = c.calls - before > last ? c.calls - before - 1 : last;
        pe_world_destroy(world);
        assert_int_equal(c.living, 0);
    }
    assert_true(failures > 10);
}

static void test_oscillation_allocates_nothing_after_warm_up(void **state)
{
    (void)state;
    counter c = {.fail_at = -1};
    pe_world_def def = pe_world_def_default();
    def.allocator = (pe_allocator){count_allocate, count_release, &c};
    check_random random = {4715};
    pe_body_id ids[CROWD];
    pe_world *world = crowd_in(make_world(&def), &random, ids);
    move_at_random(world, ids, &random);
    int calls = 0;
    for (int n = 0; n < 8 * STEPS; ++n) {
        for (int i = 0; i < CROWD; ++i) {
            pe_twist *m = &pe_twists(world)[ids[i].index];
            m->velocity = n % STEPS == 0 ? pe_scale(-1, m->velocity) : m->velocity;
            pe_pose_move(&pe_poses(world)[ids[i].index], pe_scale(H, m->velocity), pe_v3(0, 0, 0));
        }
        pe_arena_reset(&world->arena, &world->allocator);
        pe_pair_list pairs;
        assert_int_equal(pe_broad_phase(world, H, NULL, &pairs, NULL), PE_OK);
        calls = n == 4 * STEPS ? c.calls : calls;
    }
    assert_int_equal(c.calls, calls);
    pe_world_destroy(world);
}

static void test_moved_body_pairs_equal_all_pairs(void **state)
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
        pe_pair_list all, some;
        int next = 0;
        assert_int_equal(pe_broad_phase(world, H, NULL, &all, NULL), PE_OK);
        assert_int_equal(pe_broad_phase(world, H, moved, &some, NULL), PE_OK);
        for (int i = 0; i < all.count; ++i) {
            if (moved[all.items[i].a] || moved[all.items[i].b]) {
                assert_true(next < some.count);
                assert_memory_equal(&all.items[i], &some.items[next], sizeof all.items[i]);
                next += 1;
            }
        }
        assert_int_equal(next, some.count);
        kept += next;
    }
    assert_true(kept > 500);
    pe_world_destroy(world);
}

static void test_wall_pairs_are_resting_neighbours_only(void **state)
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
    pe_pair_list pairs;
    assert_int_equal(pe_broad_phase(world, H, NULL, &pairs, NULL), PE_OK);
    /* On the floor; next to each other; above each other, by halves, where the last brick of a row
     * sticks out. */
    assert_int_equal(pairs.count, COLUMNS + ROWS * (COLUMNS - 1) + (ROWS - 1) * (2 * COLUMNS - 1));
    pe_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pairs_within_margin_are_found_once_in_order),
        cmocka_unit_test(test_kept_pairs_are_complete),
        cmocka_unit_test(test_slowly_approaching_bodies_become_a_pair),
        cmocka_unit_test(test_rotating_bodies_become_a_pair_in_time),
        cmocka_unit_test(test_new_floor_pairs_with_all_resting_bodies),
        cmocka_unit_test(test_nan_position_has_no_pairs),
        cmocka_unit_test(test_after_a_failed_allocation_no_pair_is_lost),
        cmocka_unit_test(test_oscillation_allocates_nothing_after_warm_up),
        cmocka_unit_test(test_moved_body_pairs_equal_all_pairs),
        cmocka_unit_test(test_wall_pairs_are_resting_neighbours_only),
    };
    return cmocka_run_group_tests_name("engine_broad_phase", tests, NULL, NULL);
}
