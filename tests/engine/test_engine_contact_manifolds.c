/* Pairs with several manifolds: a block in the corner of an L. */
#include "catalogue/solids.h"
#include "check.h"
#include "contact/contact.h"
#include "world_for_tests.h"

static const double H = 1.0 / 60;

/* A fixed L of 2 m with arms 0.5 m thick, tilted by 0.5 rad about y so that the inner corner opens
 * upwards, and a cube of 0.8 m that lies in the corner on both arms. */
typedef struct corner {
    pe_world *world;
    pe_body_id angle, block;
} corner;

static corner corner_with_block(void)
{
    corner c = {.world = make_world(NULL)};
    pl_solid solid = pl_solid_angle(2, 0.5, 1);
    pe_vec3 vertices[12];
    uint32_t triangles[20][3];
    for (int i = 0; i < 12; ++i) {
        const double *v = solid.vertices[i];
        vertices[i] = pe_v3(v[0], v[1], v[2]);
    }
    for (int i = 0; i < 60; ++i) {
        triangles[i / 3][i % 3] = (uint32_t)solid.triangles[i / 3][i % 3];
    }
    pl_solid_free(&solid);
    const pe_geometry_def def = {vertices, (const uint32_t(*)[3])triangles, 12, 20, false};
    pe_geometry_id geometry;
    assert_int_equal(pe_geometry_create(c.world, &def, &geometry, NULL), PE_OK);

    pe_body_def angle = pe_body_def_default();
    angle.is_static = true;
    angle.shape = (pe_shape){.kind = PE_SHAPE_MESH, .geometry = geometry};
    angle.orientation = pe_quat_unit((pe_quat){cos(-0.25), 0, sin(-0.25), 0});
    c.angle = add_body(c.world, &angle);

    pe_mat3 r = pe_matrix_of(angle.orientation);
    pe_body_def block = box_def(0.4, 0.4, 0.4, pe_rotate(&r, pe_v3(0.9, 0.5, 0.9)));
    block.orientation = angle.orientation;
    c.block = add_body(c.world, &block);
    return c;
}

static void test_block_in_a_corner_has_two_manifolds(void **state)
{
    (void)state;
    corner c = corner_with_block();
    step(c.world, H);
    wake_all(c.world);
    const pe_contacts *contacts = &c.world->contacts;
    const pe_manifold *m = pe_manifolds(contacts);
    assert_int_equal(contacts->manifold_count, 2);
    assert_close(pe_dot(m[0].normal, m[1].normal), 0, 1e-9, 0);
    assert_int_equal(m[0].first, 0);
    assert_int_equal(m[1].first, m[0].count);
    for (int i = 0; i < 2; ++i) {
        assert_int_equal(m[i].a, c.angle.index);
        assert_int_equal(m[i].b, c.block.index);
        assert_int_equal(m[i].count, 4);
    }
    /* Features name the points of the whole pair. */
    const pe_manifold_point *points = pe_manifold_points(contacts);
    for (int i = 0; i < contacts->point_count; ++i) {
        for (int j = 0; j < i; ++j) {
            assert_true(points[i].feature != points[j].feature);
        }
    }
    pe_world_destroy(c.world);
}

static pe_vec3 manifold_impulse(const pe_contacts *contacts, int manifold)
{
    const pe_manifold *m = &pe_manifolds(contacts)[manifold];
    pe_vec3 sum = pe_v3(0, 0, 0);
    for (int i = m->first; i < m->first + m->count; ++i) {
        sum = pe_add(sum, pe_manifold_points(contacts)[i].impulse);
    }
    return sum;
}

static void test_it_rests_there_on_both_and_is_kept(void **state)
{
    (void)state;
    corner c = corner_with_block();
    pe_body_state began = state_of(c.world, c.block);
    for (int i = 0; i < 120; ++i) {
        step(c.world, H);
    }
    pe_body_state ended = state_of(c.world, c.block);
    assert_at_most(pe_length(pe_sub(ended.position, began.position)), 1e-9);
    /* Both arms push, and support the weight together. */
    wake_all(c.world);
    const pe_contacts *contacts = &c.world->contacts;
    assert_int_equal(contacts->manifold_count, 2);
    pe_vec3 sum = pe_v3(0, 0, 0);
    for (int i = 0; i < 2; ++i) {
        assert_true(pe_manifolds(contacts)[i].kept);
        assert_true(pe_dot(manifold_impulse(contacts, i), pe_manifolds(contacts)[i].normal) > 0);
        sum = pe_add(sum, manifold_impulse(contacts, i));
    }
    assert_at_most(pe_length(pe_sub(sum, pe_v3(0, 0, 9.81 * H))), 1e-9);
    pe_world_destroy(c.world);
}

static void test_new_manifolds_inherit_impulses_by_feature(void **state)
{
    (void)state;
    corner c = corner_with_block();
    for (int i = 0; i < 10; ++i) {
        step(c.world, H);
    }
    wake_all(c.world);
    const pe_contacts *contacts = &c.world->contacts;
    pe_vec3 before[2] = {manifold_impulse(contacts, 0), manifold_impulse(contacts, 1)};
    /* A micrometre is too far for manifolds to be kept, but not for features to change. */
    pe_body_state s = state_of(c.world, c.block);
    s.position.x += 1e-6;
    assert_int_equal(pe_body_set_state(c.world, c.block, &s, NULL), PE_OK);
    pe_contact_rules rules = pe_contact_rules_exact();
    pe_arena_reset(&c.world->arena, &c.world->allocator);
    assert_int_equal(pe_contacts_update(c.world, &rules, NULL, H, NULL), PE_OK);
    assert_int_equal(contacts->manifold_count, 2);
    for (int i = 0; i < 2; ++i) {
        assert_false(pe_manifolds(contacts)[i].kept);
        assert_at_most(pe_length(pe_sub(manifold_impulse(contacts, i), before[i])), 1e-15);
    }
    pe_world_destroy(c.world);
}

/* Friction on one arm pushes towards the other: at the inner edge, where points of both meet, it must
 * not become a push of the other, even if that has no points of its own to inherit from. */
static void test_renamed_points_inherit_from_their_side_only(void **state)
{
    (void)state;
    corner c = corner_with_block();
    step(c.world, H);
    wake_all(c.world);
    pe_contacts *contacts = &c.world->contacts;
    for (int loaded = 0; loaded < 2; ++loaded) {
        for (int i = 0; i < 2; ++i) {
            const pe_manifold *m = &pe_manifolds(contacts)[i], *other = &pe_manifolds(contacts)[!i];
            pe_vec3 push = pe_madd(m->normal, 0.5, other->normal);
            for (int j = m->first; j < m->first + m->count; ++j) {
                pe_manifold_point *p = &pe_manifold_points(contacts)[j];
                p->impulse = pe_scale(i == loaded, push);
                p->feature += i == loaded ? 1u << 20 : 1u << 21;
                p->anchor_a.y += i == loaded ? 0 : 10;
            }
        }
        pe_vec3 before = manifold_impulse(contacts, loaded);
        pe_contact_rules no_reuse = {.reuse_tolerance = 0, .most_points = PE_MAX_POINTS};
        pe_arena_reset(&c.world->arena, &c.world->allocator);
        assert_int_equal(pe_contacts_update(c.world, &no_reuse, NULL, H, NULL), PE_OK);
        assert_int_equal(contacts->manifold_count, 2);
        assert_at_most(pe_length(pe_sub(manifold_impulse(contacts, loaded), before)), 1e-15);
        assert_at_most(pe_length(manifold_impulse(contacts, !loaded)), 0);
    }
    pe_world_destroy(c.world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_block_in_a_corner_has_two_manifolds),
        cmocka_unit_test(test_it_rests_there_on_both_and_is_kept),
        cmocka_unit_test(test_new_manifolds_inherit_impulses_by_feature),
        cmocka_unit_test(test_renamed_points_inherit_from_their_side_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
