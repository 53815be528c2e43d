/* The list of contacts: which manifolds are kept, and which are built again. */
#include "contact_world.h"
#include "random_pose.h"

/* A touching pair of random kinds in a world of its own. */
static pe_world *random_pair(check_random *random, pe_body_id ids[2])
{
    pe_world *world = make_world(NULL);
    for (int k = 0; k < 2; ++k) {
        pe_vec3 e = random_vector(random, 0.4);
        pe_body_def def = box_def(0.6 + e.x, 0.6 + e.y, 0.6 + e.z, random_vector(random, 0.5));
        if (check_uniform(random, 0, 1) < 0.2) {
            def.shape = (pe_shape){.kind = PE_SHAPE_SPHERE, .radius = 0.6 + e.x};
        } else if (k == 0 && check_uniform(random, 0, 1) < 0.2) {
            def.shape = (pe_shape){.kind = PE_SHAPE_PLANE, .normal = {0.6, 0, 0.8}};
            def.is_static = true;
        }
        def.orientation = random_turn(random);
        ids[k] = add_body(world, &def);
    }
    return world;
}

static double size_of(const pe_world *world)
{
    double p = pe_bodies(world)[1].size, q = pe_bodies(world)[2].size;
    return p > 0 ? pe_min(p, q) : q;
}

/* Moves both bodies together, as one rigid body, and b also by up to a tenth of `tolerance`. */
static void move_pair(pe_world *world, const pe_body_id ids[2], check_random *random,
                      double tolerance)
{
    bool fixed = pe_bodies(world)[1].shape.kind == PE_SHAPE_PLANE;
    pe_quat turn = fixed ? (pe_quat){.w = 1} : pe_quat_unit(random_turn(random));
    pe_mat3 m = pe_matrix_of(turn);
    pe_vec3 shift = fixed ? pe_v3(0, 0, 0) : random_vector(random, 5);
    for (int k = 0; k < 2; ++k) {
        pe_body_state s = state_of(world, ids[k]);
        pe_vec3 x = pe_add(pe_rotate(&m, s.position), shift);
        pe_quat q = pe_quat_product(turn, s.orientation);
        double part = k == 0 ? 0 : 0.1 * tolerance * size_of(world);
        pe_vec3 rotation = random_vector(random, part);
        place_body(world, ids[k], pe_add(x, random_vector(random, part)), turned_by(q, rotation));
    }
}

/* How much farther than the boxes a point can move where an edge meets a side plane, by the sine of
 * the angle between them, or where two edges come nearest, by the square of theirs. Vertices and
 * the points of spheres move no farther. */
static double amplification(const pe_world *world)
{
    double most = 1;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            double r = fabs(pe_dot(pe_axis(&pe_poses(world)[1].rotation, i),
                                   pe_axis(&pe_poses(world)[2].rotation, j)));
            most = pe_max(most, pe_max(1 / r, 2 / (1 - r * r)));
        }
    }
    bool boxes = pe_bodies(world)[1].shape.kind == PE_SHAPE_BOX &&
                 pe_bodies(world)[2].shape.kind == PE_SHAPE_BOX;
    return boxes ? most : 1;
}

static void test_kept_manifold_equals_a_new_one_within_tolerance(void **state)
{
    (void)state;
    int points = 0, within = 0;
    check_random random = {31};
    static const double tolerances[] = {1e-9, 1e-6, 1e-4};
    int kept = 0;
    for (int i = 0; i < 6000; ++i) {
        pe_body_id ids[2];
        pe_world *world = random_pair(&random, ids);
        double tolerance = tolerances[i % 3], size = size_of(world);
        find_contacts(world, tolerance);
        move_pair(world, ids, &random, tolerance);
        find_contacts(world, tolerance);
        pe_contacts kept_list = world->contacts;
        world->contacts = (pe_contacts){0};
        find_contacts(world, 0);
        const pe_manifold *m = pe_manifolds(&kept_list), *fresh = pe_manifolds(&world->contacts);
        if (kept_list.manifold_count == 1 && m->kept) {
            kept += 1;
            assert_int_equal(world->contacts.manifold_count, 1);
            assert_false(fresh->kept);
            assert_int_equal(m->count, fresh->count);
            assert_at_most(pe_length(pe_sub(m->normal, fresh->normal)), 4 * tolerance);
            double error = tolerance * size, most = error * amplification(world) + 1e-14;
            for (int j = 0; j < m->count; ++j) {
                const pe_manifold_point *p = &pe_manifold_points(&kept_list)[j],
                                        *q = &pe_manifold_points(&world->contacts)[j];
                assert_int_equal(p->feature, q->feature);
                double moved = pe_length(pe_sub(p->position, q->position));
                assert_at_most(moved, most);
                assert_close(p->separation, q->separation, most, 0);
                points += 1;
                within +=
                    moved <= error + 1e-14 && fabs(p->separation - q->separation) <= error + 1e-14;
            }
        }
        pe_array_free(&kept_list.manifold_array, &world->allocator);
        pe_array_free(&kept_list.point_array, &world->allocator);
        pe_world_destroy(world);
    }
    assert_true(kept > 2000);
    assert_true(within > 0.98 * points);
}

static void test_moved_pair_is_collided_again_exactly(void **state)
{
    (void)state;
    check_random random = {5};
    int found = 0;
    for (int i = 0; i < 2000; ++i) {
        pe_body_id ids[2];
        pe_world *world = random_pair(&random, ids);
        const double tolerance = 1e-4;
        find_contacts(world, tolerance);
        /* Beyond it at the surface, by moving or by turning. */
        pe_body_state s = state_of(world, ids[1]);
        double far = 1.01 * tolerance * size_of(world);
        if (i % 2 == 0) {
            place_body(world, ids[1], pe_add(s.position, pe_v3(0, far, 0)), s.orientation);
        } else {
            double angle = far / size_of(world);
            place_body(world, ids[1], s.position, turned_by(s.orientation, pe_v3(angle, 0, 0)));
        }
        find_contacts(world, tolerance);
        pe_contacts second = world->contacts;
        world->contacts = (pe_contacts){0};
        find_contacts(world, 0);
        assert_int_equal(second.manifold_count, world->contacts.manifold_count);
        for (int j = 0; j < second.manifold_count; ++j) {
            assert_false(pe_manifolds(&second)->kept);
            assert_int_equal(second.point_count, world->contacts.point_count);
            found += 1;
        }
        for (int j = 0; j < second.point_count; ++j) {
            const pe_manifold_point *p = &pe_manifold_points(&second)[j],
                                    *q = &pe_manifold_points(&world->contacts)[j];
            assert_memory_equal(&p->position, &q->position, sizeof p->position);
            assert_memory_equal(&p->separation, &q->separation, sizeof p->separation);
        }
        pe_array_free(&second.manifold_array, &world->allocator);
        pe_array_free(&second.point_array, &world->allocator);
        pe_world_destroy(world);
    }
    assert_true(found > 1000);
}

static void test_slow_motion_does_not_keep_manifolds_forever(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_id ids[2];
    add_tower(world, 2, (pe_material_id){0}, ids);
    const double tolerance = 1e-3;
    int kept = 0, made = 0;
    for (int i = 0; i < 200; ++i) {
        double x = 1e-4 * i; /* a fifth of the tolerance of a cube of half extent 0.5 */
        place_body(world, ids[1], pe_v3(x, 0, 1.5), (pe_quat){.w = 1});
        find_contacts(world, tolerance);
        const pe_manifold *m = manifold_of(&world->contacts, 2, 3);
        assert_non_null(m);
        kept += m->kept;
        made += !m->kept;
        assert_int_equal(m->count, 4);
        for (int j = m->first; j < m->first + m->count; ++j) {
            /* The overlap of the two faces reaches from x - 1/2 to 1/2. */
            double at = pe_manifold_points(&world->contacts)[j].position.x;
            double off = pe_min(fabs(at - 0.5), fabs(at - (x - 0.5)));
            assert_at_most(off, 0.5 * tolerance + 2e-6);
        }
    }
    assert_true(kept > 2 * made);
    assert_true(made > 20);
    pe_world_destroy(world);
}

static void test_manifold_is_kept_only_at_equal_margin(void **state)
{
    (void)state;
    /* A brick with one edge on the floor and the other 5 cm over it. */
    pe_world *world = make_world(NULL);
    add_plane(world, pe_v3(0, 0, 1), (pe_material_id){0});
    pe_body_def def = box_def(0.5, 0.5, 0.25, pe_v3(0, 0, 0.5));
    double sine = 0.05;
    def.orientation = (pe_quat){cos(0.5 * asin(sine)), 0, sin(0.5 * asin(sine)), 0};
    def.position.z = 0.25 * sqrt(1 - sine * sine) + 0.5 * sine;
    pe_body_id id = add_body(world, &def);
    pe_body_state s = state_of(world, id);
    static const double speed[] = {0, 1, 2.7, 2.8, 4, 4, 1, 1};
    static const int points[] = {2, 2, 2, 4, 4, 4, 2, 2}; /* 5 cm at 2.78 m/s and the slack */
    static const bool kept[] = {false, true, true, false, true, true, false, true};
    for (int i = 0; i < 8; ++i) {
        s.velocity = (pe_vec3){speed[i], 0, 0};
        assert_int_equal(pe_body_set_state(world, id, &s, NULL), PE_OK);
        find_contacts(world, 1e-9);
        assert_int_equal(world->contacts.manifold_count, 1);
        assert_int_equal(world->contacts.point_count, points[i]);
        assert_int_equal(pe_manifolds(&world->contacts)->kept, kept[i]);
    }
    pe_world_destroy(world);
}

static void test_new_body_in_old_slot_has_no_manifold(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_id ids[2];
    add_tower(world, 2, (pe_material_id){0}, ids);
    find_contacts(world, 1e-9);
    assert_int_equal(pe_body_destroy(world, ids[1], NULL), PE_OK);
    pe_body_def smaller = box_def(0.3, 0.3, 0.5, pe_v3(0, 0, 1.5));
    assert_int_equal(add_body(world, &smaller).index, ids[1].index);
    find_contacts(world, 1e-9);
    const pe_manifold *m = manifold_of(&world->contacts, 2, 3);
    assert_non_null(m);
    assert_false(m->kept);
    assert_close(fabs(pe_manifold_points(&world->contacts)[m->first].position.x), 0.3, 1e-5, 0);
    pe_world_destroy(world);
}

static void test_manifold_point_counts_are_bounded(void **state)
{
    (void)state;
    check_random random = {64};
    pe_body_id ids[BRICK_BODIES];
    pe_world *world = make_brick_wall(NULL, ids);
    int reduced = 0;
    for (int i = 0; i < 100; ++i) {
        shake_wall(world, ids, &random, NULL, 0.02);
        find_contacts_by(world, 1e-4, 4);
        int few = world->contacts.point_count;
        for (int k = 0; k < world->contacts.manifold_count; ++k) {
            assert_in_range(pe_manifolds(&world->contacts)[k].count, 1, 4);
        }
        find_contacts(world, 0);
        reduced += world->contacts.point_count > few;
    }
    assert_true(reduced > 50);
    pe_world_destroy(world);
}

static void test_equal_histories_give_equal_contacts_exactly(void **state)
{
    (void)state;
    pe_body_id ids[BRICK_BODIES];
    pe_world *worlds[2] = {make_brick_wall(NULL, ids), make_brick_wall(NULL, ids)};
    for (int k = 0; k < 2; ++k) {
        check_random random = {2};
        for (int i = 0; i < 50; ++i) {
            shake_wall(worlds[k], ids, &random, NULL, i % 3 == 0 ? 1e-2 : 1e-5);
            find_contacts(worlds[k], 1e-3);
        }
    }
    const pe_contacts *p = &worlds[0]->contacts, *q = &worlds[1]->contacts;
    int kept = 0;
    assert_int_equal(p->manifold_count, q->manifold_count);
    for (int i = 0; i < p->manifold_count; ++i) {
        assert_same_points(p, &pe_manifolds(p)[i], q, &pe_manifolds(q)[i]);
        kept += pe_manifolds(p)[i].kept;
    }
    assert_true(kept > 10);
    pe_world_destroy(worlds[0]);
    pe_world_destroy(worlds[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kept_manifold_equals_a_new_one_within_tolerance),
        cmocka_unit_test(test_moved_pair_is_collided_again_exactly),
        cmocka_unit_test(test_slow_motion_does_not_keep_manifolds_forever),
        cmocka_unit_test(test_manifold_is_kept_only_at_equal_margin),
        cmocka_unit_test(test_new_body_in_old_slot_has_no_manifold),
        cmocka_unit_test(test_manifold_point_counts_are_bounded),
        cmocka_unit_test(test_equal_histories_give_equal_contacts_exactly),
    };
    return cmocka_run_group_tests_name("engine_contact_list", tests, NULL, NULL);
}
