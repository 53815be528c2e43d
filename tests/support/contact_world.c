#include "contact_world.h"

#include "random_pose.h"

void find_contacts_by(pe_world *world, double reuse_tolerance, int most_points)
{
    pe_contact_rules rules = {reuse_tolerance, most_points};
    pe_arena_reset(&world->arena, &world->allocator);
    assert_int_equal(pe_contacts_update(world, &rules, NULL, CONTACT_STEP, NULL), PE_OK);
}

void find_contacts(pe_world *world, double reuse_tolerance)
{
    find_contacts_by(world, reuse_tolerance, PE_MAX_POINTS);
}

void find_contacts_again(pe_world *world, const bool *moved, double tolerance)
{
    pe_contact_rules rules = {tolerance, PE_MAX_POINTS};
    assert_int_equal(pe_contacts_update(world, &rules, moved, CONTACT_STEP, NULL), PE_OK);
}

const pe_manifold *manifold_of(const pe_contacts *contacts, int a, int b)
{
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        if (m->a == a && m->b == b) {
            return m;
        }
    }
    return NULL;
}

void place_body(pe_world *world, pe_body_id id, pe_vec3 position, pe_quat orientation)
{
    pe_body_state s = {.position = position, .orientation = pe_quat_unit(orientation)};
    assert_int_equal(pe_body_set_state(world, id, &s, NULL), PE_OK);
}

pe_quat turned_by(pe_quat q, pe_vec3 r)
{
    return pe_quat_unit(pe_quat_product((pe_quat){1, 0.5 * r.x, 0.5 * r.y, 0.5 * r.z}, q));
}

pe_world *make_brick_wall(const pe_world_def *def, pe_body_id ids[BRICK_BODIES])
{
    pe_world *world = make_world(def);
    add_plane(world, pe_v3(0, 0, 1), (pe_material_id){0});
    for (int i = 0; i < BRICK_ROWS * BRICK_COLUMNS; ++i) {
        int row = i / BRICK_COLUMNS, column = i % BRICK_COLUMNS;
        pe_body_def brick =
            box_def(0.5, 0.25, 0.25, pe_v3(column + 0.5 * (row % 2), 0, 0.5 * row + 0.25));
        ids[i] = add_body(world, &brick);
    }
    for (int i = 0; i < BRICK_BALLS; ++i) {
        pe_body_def ball = pe_body_def_default();
        ball.position = pe_v3(1.3 * i + 0.4, 0, 0.5 * BRICK_ROWS + 0.5);
        ids[BRICK_ROWS * BRICK_COLUMNS + i] = add_body(world, &ball);
    }
    return world;
}

void shake_body(pe_world *world, pe_body_id id, check_random *random, double reach)
{
    pe_body_state s = state_of(world, id);
    pe_vec3 rotation = random_vector(random, reach);
    place_body(world, id, pe_add(s.position, random_vector(random, reach)),
               turned_by(s.orientation, rotation));
}

void shake_wall(pe_world *world, const pe_body_id ids[BRICK_BODIES], check_random *random,
                const bool *moved, double reach)
{
    for (int i = 0; i < BRICK_BODIES; ++i) {
        if (moved == NULL || moved[ids[i].index]) {
            shake_body(world, ids[i], random, reach);
        }
    }
}

void mark_impulses(pe_contacts *contacts)
{
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            pe_manifold_points(contacts)[j].impulse = pe_scale(1 + j, m->normal);
        }
    }
}

void assert_same_points(const pe_contacts *p, const pe_manifold *m, const pe_contacts *q,
                        const pe_manifold *n)
{
    assert_memory_equal(&m->normal, &n->normal, sizeof m->normal);
    assert_int_equal(m->count, n->count);
    for (int j = 0; j < m->count; ++j) {
        pe_manifold_point one = pe_manifold_points(p)[m->first + j],
                          two = pe_manifold_points(q)[n->first + j];
        assert_memory_equal(&one.position, &two.position, sizeof one.position);
        assert_memory_equal(&one.anchor_a, &two.anchor_a, 2 * sizeof one.anchor_a);
        assert_memory_equal(&one.separation, &two.separation, sizeof one.separation);
        assert_int_equal(one.feature, two.feature);
        assert_memory_equal(&one.impulse, &two.impulse, sizeof one.impulse);
    }
}
