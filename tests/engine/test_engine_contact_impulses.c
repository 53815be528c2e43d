/* Which impulses a contact takes over from the step before. */
#include "contact_world.h"

/* Two cubes on a plane, their contacts found and marked. */
static pe_world *marked_tower(pe_body_id ids[2])
{
    pe_world *world = make_world(NULL);
    add_tower(world, 2, (pe_material_id){0}, ids);
    find_contacts(world, 0);
    mark_impulses(&world->contacts);
    return world;
}

static void test_impulses_follow_features_and_pulls_are_dropped(void **state)
{
    (void)state;
    pe_body_id ids[2];
    pe_world *world = marked_tower(ids);
    pe_manifold_points(&world->contacts)[2].impulse.z *= -1;
    find_contacts(world, 0); /* again, at the same poses */
    for (int i = 0; i < world->contacts.point_count; ++i) {
        const pe_manifold_point *p = &pe_manifold_points(&world->contacts)[i];
        assert_int_equal(p->feature, pe_manifold_points(&world->previous)[i].feature);
        assert_close(p->impulse.z, i == 2 ? 0 : i + 1, 0, 0);
    }
    /* Another step: twice as long, twice the impulse. */
    world->previous_dt = CONTACT_STEP;
    pe_contacts_scale_impulses(world, 2 * CONTACT_STEP);
    assert_close(pe_manifold_points(&world->contacts)[4].impulse.z, 10, 1e-15, 0);
    pe_world_destroy(world);
}

static void test_impulses_go_to_nearest_points_without_features(void **state)
{
    (void)state;
    pe_body_id ids[2];
    pe_world *world = marked_tower(ids);
    const pe_manifold *m = manifold_of(&world->contacts, 2, 3);
    assert_non_null(m);
    for (int j = m->first; j < m->first + m->count; ++j) {
        pe_manifold_points(&world->contacts)[j].feature += 1u << 20;
    }
    pe_body_state s = state_of(world, ids[1]);
    place_body(world, ids[1], pe_add(s.position, pe_v3(4e-3, 0, 0)), s.orientation);
    find_contacts(world, 0);
    for (int j = m->first; j < m->first + m->count; ++j) {
        assert_close(pe_manifold_points(&world->contacts)[j].impulse.z, 1 + j, 0, 0);
    }
    /* Too far for being the same. */
    m = manifold_of(&world->contacts, 2, 3);
    for (int j = m->first; j < m->first + m->count; ++j) {
        pe_manifold_points(&world->contacts)[j].feature += 1u << 20;
        pe_manifold_points(&world->contacts)[j].anchor_a.y += 0.011;
    }
    find_contacts(world, 0);
    for (int j = m->first; j < m->first + m->count; ++j) {
        assert_close(pe_manifold_points(&world->contacts)[j].impulse.z, 0, 0, 0);
    }
    pe_world_destroy(world);
}

static void test_kept_manifold_has_impulses_and_current_material(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_id ids[2];
    pe_material_id material = add_material(world, 0.5, 0);
    add_tower(world, 2, material, ids);
    find_contacts(world, 1e-9);
    mark_impulses(&world->contacts);
    assert_int_equal(pe_world_set_pair(world, material, material, 0.25, 0.75, NULL), PE_OK);
    find_contacts(world, 1e-9);
    assert_int_equal(world->contacts.manifold_count, 2);
    for (int i = 0; i < 2; ++i) {
        const pe_manifold *m = &pe_manifolds(&world->contacts)[i];
        assert_true(m->kept);
        assert_close(m->friction, 0.25, 0, 0);
        assert_close(m->restitution, 0.75, 0, 0);
        for (int j = m->first; j < m->first + m->count; ++j) {
            assert_close(pe_manifold_points(&world->contacts)[j].impulse.z, 1 + j, 0, 0);
        }
    }
    pe_world_destroy(world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_impulses_follow_features_and_pulls_are_dropped),
        cmocka_unit_test(test_impulses_go_to_nearest_points_without_features),
        cmocka_unit_test(test_kept_manifold_has_impulses_and_current_material),
    };
    return cmocka_run_group_tests_name("engine_contact_impulses", tests, NULL, NULL);
}
