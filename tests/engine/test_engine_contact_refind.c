/* Contacts found again within a step, where some bodies have moved. */
#include "contact_world.h"
#include "counting_allocator.h"
#include "random_pose.h"

#include <stdlib.h>
#include <string.h>

static void test_partial_update_equals_a_full_update(void **state)
{
    (void)state;
    check_random random = {77};
    int again = 0, stayed = 0;
    for (int trial = 0; trial < 60; ++trial) {
        pe_body_id ids[BRICK_BODIES], same_ids[BRICK_BODIES];
        pe_world *one = make_brick_wall(NULL, ids), *all = make_brick_wall(NULL, same_ids);
        uint64_t seed = random.state;
        for (int k = 0; k < 2; ++k) {
            pe_world *world = k == 0 ? one : all;
            random.state = seed;
            shake_wall(world, ids, &random, NULL, 1e-2);
            find_contacts(world, 1e-9);
            mark_impulses(&world->contacts);
        }
        bool moved[BRICK_BODIES + 2] = {0};
        for (int i = 0; i < 4; ++i) {
            moved[(int)check_uniform(&random, 2, BRICK_BODIES + 2)] = true;
        }
        double reach = trial % 2 == 0 ? 1e-3 : 0.2;
        seed = random.state;
        shake_wall(one, ids, &random, moved, reach);
        random.state = seed;
        shake_wall(all, ids, &random, moved, reach);
        find_contacts_again(one, moved, 1e-9);
        find_contacts(all, 1e-9);
        assert_int_equal(one->contacts.manifold_count, all->contacts.manifold_count);
        assert_int_equal(one->contacts.point_count, all->contacts.point_count);
        int next_point = 0;
        for (int i = 0; i < one->contacts.manifold_count; ++i) {
            const pe_manifold *m = &pe_manifolds(&one->contacts)[i];
            const pe_manifold *n = &pe_manifolds(&all->contacts)[i];
            assert_int_equal(m->a, n->a);
            assert_int_equal(m->b, n->b);
            assert_int_equal(m->first, next_point);
            next_point += m->count;
            if (moved[m->a] || moved[m->b]) {
                assert_same_points(&one->contacts, m, &all->contacts, n);
                again += 1;
            } else {
                const pe_manifold *before = manifold_of(&one->previous, m->a, m->b);
                assert_non_null(before);
                assert_same_points(&one->contacts, m, &one->previous, before);
                stayed += 1;
            }
        }
        pe_world_destroy(one);
        pe_world_destroy(all);
    }
    assert_true(again > 500);
    assert_true(stayed > 2000);
}

static void test_step_pairs_remain_valid_within_half_margin(void **state)
{
    (void)state;
    check_random random = {123};
    int touching = 0;
    for (int trial = 0; trial < 200; ++trial) {
        pe_body_id ids[BRICK_BODIES];
        pe_world_def def = pe_world_def_default();
        def.contact_margin = 0.04;
        pe_world *world = make_brick_wall(&def, ids);
        shake_wall(world, ids, &random, NULL, 0.05);
        pe_pair_list pairs;
        assert_int_equal(pe_broad_phase(world, CONTACT_STEP, NULL, &pairs, NULL), PE_OK);
        pe_contact_rules rules = pe_contact_rules_exact();
        assert_int_equal(pe_contacts_find(world, &rules, &pairs, NULL, CONTACT_STEP, NULL), PE_OK);
        bool moved[BRICK_BODIES + 2];
        for (int i = 0; i < BRICK_BODIES + 2; ++i) {
            moved[i] = true;
        }
        /* Components of at most 0.01, so that a half of it is left for a turn at 0.61 m. */
        for (int i = 0; i < BRICK_BODIES; ++i) {
            shake_body(world, ids[i], &random, 0.005);
        }
        assert_int_equal(pe_contacts_find(world, &rules, &pairs, moved, CONTACT_STEP, NULL), PE_OK);
        int found = world->contacts.manifold_count;
        pe_pair_list now;
        assert_int_equal(pe_broad_phase(world, CONTACT_STEP, NULL, &now, NULL), PE_OK);
        assert_int_equal(pe_contacts_find(world, &rules, &now, moved, CONTACT_STEP, NULL), PE_OK);
        assert_int_equal(found, world->contacts.manifold_count);
        touching += found;
        pe_world_destroy(world);
    }
    assert_true(touching > 5000);
}

static void test_finding_again_allocates_nothing_after_warm_up(void **state)
{
    (void)state;
    counter c = {.fail_at = -1, .lasting = true};
    pe_world_def def = pe_world_def_default();
    def.allocator = (pe_allocator){count_allocate, count_release, &c};
    pe_body_id ids[BRICK_BODIES];
    pe_world *world = make_brick_wall(&def, ids);
    check_random random = {8};
    int warm = 0;
    for (int i = 0; i < 60; ++i) {
        find_contacts(world, 1e-9);
        for (int k = 0; k < 4; ++k) {
            bool moved[BRICK_BODIES + 2] = {0};
            for (int slot = 2 + k; slot < BRICK_BODIES + 2; slot += 5) {
                moved[slot] = true;
            }
            shake_wall(world, ids, &random, moved, 1e-6);
            find_contacts_again(world, moved, 1e-9);
        }
        warm = i < 5 ? c.calls : warm;
    }
    assert_int_equal(c.calls, warm);
    pe_world_destroy(world);
}

static void test_without_memory_the_contacts_are_as_they_were(void **state)
{
    (void)state;
    int failed = 0;
    for (int k = 0; k < 19; ++k) {
        counter c = {.fail_at = -1, .lasting = true};
        pe_world_def def = pe_world_def_default();
        def.allocator = (pe_allocator){count_allocate, count_release, &c};
        pe_body_id ids[BRICK_BODIES];
        pe_world *world = make_brick_wall(&def, ids);
        find_contacts(world, 1e-9);
        mark_impulses(&world->contacts);
        pe_contacts before = world->contacts;
        size_t size = (size_t)before.point_count * sizeof(pe_manifold_point);
        void *points = malloc(size);
        assert_non_null(points);
        memcpy(points, before.point_array.items, size);
        bool moved[BRICK_BODIES + 2] = {[5] = true, [17] = true};
        c.fail_at = c.calls + k;
        pe_error error = {0};
        pe_contact_rules rules = pe_contact_rules_exact();
        pe_status status = pe_contacts_update(world, &rules, moved, CONTACT_STEP, &error);
        if (status != PE_OK) {
            assert_int_equal(status, PE_NO_MEMORY);
            assert_contains(error.message, "no memory");
            assert_memory_equal(&world->contacts, &before, sizeof before);
            assert_memory_equal(before.point_array.items, points, size);
            failed += 1;
        }
        free(points);
        c.fail_at = -1;
        pe_world_destroy(world);
    }
    assert_true(failed > 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_partial_update_equals_a_full_update),
        cmocka_unit_test(test_step_pairs_remain_valid_within_half_margin),
        cmocka_unit_test(test_finding_again_allocates_nothing_after_warm_up),
        cmocka_unit_test(test_without_memory_the_contacts_are_as_they_were),
    };
    return cmocka_run_group_tests_name("engine_contact_refind", tests, NULL, NULL);
}
