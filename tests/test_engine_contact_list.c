/* The list of contacts: what is kept, carried along, found again and taken over. */
#include "check.h"
#include "contact/contact.h"
#include "world_for_tests.h"

#include <stdlib.h>
#include <string.h>

static const double H = 1.0 / 60;

/* Contacts at the poses now, as a step finds them. */
static void find_by(pe_world *world, double reuse_tolerance, int most_points)
{
    pe_contact_rules rules = {reuse_tolerance, most_points};
    pe_pair *pairs;
    int count;
    pe_arena_reset(&world->arena, &world->allocator);
    assert_int_equal(pe_broad_phase(world, H, &pairs, &count, NULL), PE_OK);
    assert_int_equal(pe_contacts_find_by(world, &rules, pairs, count, H, NULL), PE_OK);
}

static void find(pe_world *world, double reuse_tolerance)
{
    find_by(world, reuse_tolerance, PE_MAX_POINTS);
}

static const pe_manifold *manifold_of(const pe_contacts *contacts, int a, int b)
{
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        if (m->a == a && m->b == b) {
            return m;
        }
    }
    return NULL;
}

static pe_vec3 random_vector(check_random *random, double reach)
{
    double x = check_uniform(random, -reach, reach), y = check_uniform(random, -reach, reach);
    return pe_v3(x, y, check_uniform(random, -reach, reach));
}

static pe_quat random_turn(check_random *random)
{
    double q[4];
    check_quaternion(random, q);
    return (pe_quat){q[0], q[1], q[2], q[3]};
}

static void place(pe_world *world, pe_body_id id, pe_vec3 position, pe_quat orientation)
{
    pe_body_state s = {.position = position, .orientation = pe_quat_unit(orientation)};
    assert_int_equal(pe_body_set_state(world, id, &s, NULL), PE_OK);
}

/* The rotation by a small vector. */
static pe_quat turned(pe_quat q, pe_vec3 r)
{
    return pe_quat_unit(pe_quat_product((pe_quat){1, 0.5 * r.x, 0.5 * r.y, 0.5 * r.z}, q));
}

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

/* Moves both bodies together, as one rigid body, and b by up to a tenth of `tolerance` besides. */
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
        place(world, ids[k], pe_add(x, random_vector(random, part)),
              turned(q, random_vector(random, part)));
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

static void test_a_kept_manifold_is_a_fresh_one_within_its_tolerance(void **state)
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
        find(world, tolerance);
        move_pair(world, ids, &random, tolerance);
        find(world, tolerance);
        pe_contacts carried = world->contacts;
        world->contacts = (pe_contacts){0};
        find(world, 0);
        const pe_manifold *m = pe_manifolds(&carried), *fresh = pe_manifolds(&world->contacts);
        if (carried.manifold_count == 1 && m->kept) {
            kept += 1;
            assert_int_equal(world->contacts.manifold_count, 1);
            assert_false(fresh->kept);
            assert_int_equal(m->count, fresh->count);
            assert_at_most(pe_length(pe_sub(m->normal, fresh->normal)), 4 * tolerance);
            double error = tolerance * size, most = error * amplification(world) + 1e-14;
            for (int j = 0; j < m->count; ++j) {
                const pe_point *p = &pe_points(&carried)[j], *q = &pe_points(&world->contacts)[j];
                assert_int_equal(p->feature, q->feature);
                double moved = pe_length(pe_sub(p->position, q->position));
                assert_at_most(moved, most);
                assert_close(p->separation, q->separation, most, 0);
                points += 1;
                within +=
                    moved <= error + 1e-14 && fabs(p->separation - q->separation) <= error + 1e-14;
            }
        }
        pe_array_free(&carried.manifold_array, &world->allocator);
        pe_array_free(&carried.point_array, &world->allocator);
        pe_world_destroy(world);
    }
    assert_true(kept > 2000);
    assert_true(within > 0.98 * points);
}

static void test_a_pair_that_moved_beyond_the_tolerance_is_found_anew_to_the_bit(void **state)
{
    (void)state;
    check_random random = {5};
    int found = 0;
    for (int i = 0; i < 2000; ++i) {
        pe_body_id ids[2];
        pe_world *world = random_pair(&random, ids);
        const double tolerance = 1e-4;
        find(world, tolerance);
        /* Beyond it at the surface, by moving or by turning. */
        pe_body_state s = state_of(world, ids[1]);
        double far = 1.01 * tolerance * size_of(world);
        if (i % 2 == 0) {
            place(world, ids[1], pe_add(s.position, pe_v3(0, far, 0)), s.orientation);
        } else {
            double angle = far / size_of(world);
            place(world, ids[1], s.position, turned(s.orientation, pe_v3(angle, 0, 0)));
        }
        find(world, tolerance);
        pe_contacts second = world->contacts;
        world->contacts = (pe_contacts){0};
        find(world, 0);
        assert_int_equal(second.manifold_count, world->contacts.manifold_count);
        for (int j = 0; j < second.manifold_count; ++j) {
            assert_false(pe_manifolds(&second)->kept);
            assert_int_equal(second.point_count, world->contacts.point_count);
            found += 1;
        }
        for (int j = 0; j < second.point_count; ++j) {
            const pe_point *p = &pe_points(&second)[j], *q = &pe_points(&world->contacts)[j];
            assert_memory_equal(&p->position, &q->position, sizeof p->position);
            assert_memory_equal(&p->separation, &q->separation, sizeof p->separation);
        }
        pe_array_free(&second.manifold_array, &world->allocator);
        pe_array_free(&second.point_array, &world->allocator);
        pe_world_destroy(world);
    }
    assert_true(found > 1000);
}

static void test_slow_motion_does_not_carry_a_manifold_for_ever(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_id ids[2];
    add_tower(world, 2, (pe_material_id){0}, ids);
    const double tolerance = 1e-3;
    int kept = 0, made = 0;
    for (int i = 0; i < 200; ++i) {
        double x = 1e-4 * i; /* a fifth of the tolerance of a cube of half extent 0.5 */
        place(world, ids[1], pe_v3(x, 0, 1.5), (pe_quat){.w = 1});
        find(world, tolerance);
        const pe_manifold *m = manifold_of(&world->contacts, 2, 3);
        assert_non_null(m);
        kept += m->kept;
        made += !m->kept;
        assert_int_equal(m->count, 4);
        for (int j = m->first; j < m->first + m->count; ++j) {
            /* The overlap of the two faces reaches from x - 1/2 to 1/2. */
            double at = pe_points(&world->contacts)[j].position.x;
            double off = pe_min(fabs(at - 0.5), fabs(at - (x - 0.5)));
            assert_at_most(off, 0.5 * tolerance + 2e-6);
        }
    }
    assert_true(kept > 2 * made);
    assert_true(made > 20);
    pe_world_destroy(world);
}

static void test_a_manifold_is_kept_only_if_the_margin_asks_for_the_same_points(void **state)
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
        find(world, 1e-9);
        assert_int_equal(world->contacts.manifold_count, 1);
        assert_int_equal(world->contacts.point_count, points[i]);
        assert_int_equal(pe_manifolds(&world->contacts)->kept, kept[i]);
    }
    pe_world_destroy(world);
}

/* A wall of bricks on a plane with balls on top. */
enum { ROWS = 5, COLUMNS = 6, BALLS = 4, BODIES = ROWS * COLUMNS + BALLS };

static pe_world *brick_wall(const pe_world_def *def, pe_body_id ids[BODIES])
{
    pe_world *world = make_world(def);
    add_plane(world, pe_v3(0, 0, 1), (pe_material_id){0});
    for (int i = 0; i < ROWS * COLUMNS; ++i) {
        int row = i / COLUMNS, column = i % COLUMNS;
        pe_body_def brick =
            box_def(0.5, 0.25, 0.25, pe_v3(column + 0.5 * (row % 2), 0, 0.5 * row + 0.25));
        ids[i] = add_body(world, &brick);
    }
    for (int i = 0; i < BALLS; ++i) {
        pe_body_def ball = pe_body_def_default();
        ball.position = pe_v3(1.3 * i + 0.4, 0, 0.5 * ROWS + 0.5);
        ids[ROWS * COLUMNS + i] = add_body(world, &ball);
    }
    return world;
}

/* Pushes that tell every point from all others. */
static void mark_impulses(pe_contacts *contacts)
{
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            pe_points(contacts)[j].impulse = pe_scale(1 + j, m->normal);
        }
    }
}

static void shake(pe_world *world, const pe_body_id ids[BODIES], check_random *random,
                  const bool *moved, double reach)
{
    for (int i = 0; i < BODIES; ++i) {
        if (moved == NULL || moved[ids[i].index]) {
            pe_body_state s = state_of(world, ids[i]);
            place(world, ids[i], pe_add(s.position, random_vector(random, reach)),
                  turned(s.orientation, random_vector(random, reach)));
        }
    }
}

static void refind(pe_world *world, const bool *moved, double tolerance)
{
    pe_contact_rules rules = {tolerance, PE_MAX_POINTS};
    pe_pair *pairs;
    int count;
    assert_int_equal(pe_broad_phase_moved(world, H, moved, &pairs, &count, NULL), PE_OK);
    assert_int_equal(pe_contacts_refind(world, &rules, pairs, count, moved, H, NULL), PE_OK);
}

static void assert_same_points(const pe_contacts *p, const pe_manifold *m, const pe_contacts *q,
                               const pe_manifold *n)
{
    assert_memory_equal(&m->normal, &n->normal, sizeof m->normal);
    assert_int_equal(m->count, n->count);
    for (int j = 0; j < m->count; ++j) {
        pe_point one = pe_points(p)[m->first + j], two = pe_points(q)[n->first + j];
        assert_memory_equal(&one.position, &two.position, sizeof one.position);
        assert_memory_equal(&one.anchor_a, &two.anchor_a, 2 * sizeof one.anchor_a);
        assert_memory_equal(&one.separation, &two.separation, sizeof one.separation);
        assert_int_equal(one.feature, two.feature);
        assert_memory_equal(&one.impulse, &two.impulse, sizeof one.impulse);
    }
}

static void test_finding_again_equals_finding_all_for_moved_bodies_and_keeps_the_rest(void **state)
{
    (void)state;
    check_random random = {77};
    int again = 0, stayed = 0;
    for (int trial = 0; trial < 60; ++trial) {
        pe_body_id ids[BODIES], same_ids[BODIES];
        pe_world *one = brick_wall(NULL, ids), *all = brick_wall(NULL, same_ids);
        uint64_t seed = random.state;
        for (int k = 0; k < 2; ++k) {
            pe_world *world = k == 0 ? one : all;
            random.state = seed;
            shake(world, ids, &random, NULL, 1e-2);
            find(world, 1e-9);
            mark_impulses(&world->contacts);
        }
        bool moved[BODIES + 2] = {0};
        for (int i = 0; i < 4; ++i) {
            moved[(int)check_uniform(&random, 2, BODIES + 2)] = true;
        }
        double reach = trial % 2 == 0 ? 1e-3 : 0.2;
        seed = random.state;
        shake(one, ids, &random, moved, reach);
        random.state = seed;
        shake(all, ids, &random, moved, reach);
        refind(one, moved, 1e-9);
        find(all, 1e-9);
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

static void test_the_steps_own_pairs_serve_after_moves_of_half_the_contact_margin(void **state)
{
    (void)state;
    check_random random = {123};
    int touching = 0;
    for (int trial = 0; trial < 200; ++trial) {
        pe_body_id ids[BODIES];
        pe_world_def def = pe_world_def_default();
        def.contact_margin = 0.04;
        pe_world *world = brick_wall(&def, ids);
        shake(world, ids, &random, NULL, 0.05);
        pe_pair *pairs, *now;
        int count, now_count;
        assert_int_equal(pe_broad_phase(world, H, &pairs, &count, NULL), PE_OK);
        pe_contact_rules rules = pe_contact_rules_exact();
        assert_int_equal(pe_contacts_find_by(world, &rules, pairs, count, H, NULL), PE_OK);
        bool moved[BODIES + 2];
        for (int i = 0; i < BODIES + 2; ++i) {
            moved[i] = true;
        }
        /* Components of at most 0.01, so that a half of it is left for a turn at 0.61 m. */
        for (int i = 0; i < BODIES; ++i) {
            pe_body_state s = state_of(world, ids[i]);
            place(world, ids[i], pe_add(s.position, random_vector(&random, 0.005)),
                  turned(s.orientation, random_vector(&random, 0.005)));
        }
        assert_int_equal(pe_contacts_refind(world, &rules, pairs, count, moved, H, NULL), PE_OK);
        int found = world->contacts.manifold_count;
        assert_int_equal(pe_broad_phase(world, H, &now, &now_count, NULL), PE_OK);
        assert_int_equal(pe_contacts_refind(world, &rules, now, now_count, moved, H, NULL), PE_OK);
        assert_int_equal(found, world->contacts.manifold_count);
        touching += found;
        pe_world_destroy(world);
    }
    assert_true(touching > 5000);
}

typedef struct counter {
    long made, fail_from; /* fail_from 0: never */
} counter;

static void *count_allocate(void *context, size_t size)
{
    counter *c = context;
    c->made += 1;
    return c->fail_from > 0 && c->made >= c->fail_from ? NULL
                                                       : aligned_alloc(64, (size + 63) / 64 * 64);
}

static void count_release(void *context, void *memory)
{
    (void)context;
    free(memory);
}

static void test_finding_again_allocates_nothing_after_warm_up(void **state)
{
    (void)state;
    counter c = {0};
    pe_world_def def = pe_world_def_default();
    def.allocator = (pe_allocator){count_allocate, count_release, &c};
    pe_body_id ids[BODIES];
    pe_world *world = brick_wall(&def, ids);
    check_random random = {8};
    long warm = 0;
    for (int i = 0; i < 60; ++i) {
        find(world, 1e-9);
        for (int k = 0; k < 4; ++k) {
            bool moved[BODIES + 2] = {0};
            for (int slot = 2 + k; slot < BODIES + 2; slot += 5) {
                moved[slot] = true;
            }
            shake(world, ids, &random, moved, 1e-6);
            refind(world, moved, 1e-9);
        }
        warm = i < 5 ? c.made : warm;
    }
    assert_int_equal(c.made, warm);
    pe_world_destroy(world);
}

static void test_without_memory_the_contacts_are_as_they_were(void **state)
{
    (void)state;
    int failed = 0;
    for (long k = 1; k < 20; ++k) {
        counter c = {0};
        pe_world_def def = pe_world_def_default();
        def.allocator = (pe_allocator){count_allocate, count_release, &c};
        pe_body_id ids[BODIES];
        pe_world *world = brick_wall(&def, ids);
        find(world, 1e-9);
        mark_impulses(&world->contacts);
        pe_contacts before = world->contacts;
        size_t size = (size_t)before.point_count * sizeof(pe_point);
        void *points = malloc(size);
        assert_non_null(points);
        memcpy(points, before.point_array.items, size);
        bool moved[BODIES + 2] = {[5] = true, [17] = true};
        pe_pair *pairs;
        int count;
        c.fail_from = c.made + k;
        pe_error error = {0};
        pe_contact_rules rules = pe_contact_rules_exact();
        pe_status status = pe_broad_phase_moved(world, H, moved, &pairs, &count, &error);
        if (status == PE_OK) {
            status = pe_contacts_refind(world, &rules, pairs, count, moved, H, &error);
        }
        if (status != PE_OK) {
            assert_int_equal(status, PE_NO_MEMORY);
            assert_contains(error.message, "no memory");
            assert_memory_equal(&world->contacts, &before, sizeof before);
            assert_memory_equal(before.point_array.items, points, size);
            failed += 1;
        }
        free(points);
        c.fail_from = 0;
        pe_world_destroy(world);
    }
    assert_true(failed > 5);
}

static void test_impulses_go_with_the_features_and_what_would_pull_is_dropped(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_id ids[2];
    add_tower(world, 2, (pe_material_id){0}, ids);
    find(world, 0);
    mark_impulses(&world->contacts);
    pe_points(&world->contacts)[2].impulse.z *= -1;
    find(world, 0); /* anew, at the same poses */
    for (int i = 0; i < world->contacts.point_count; ++i) {
        const pe_point *p = &pe_points(&world->contacts)[i];
        assert_int_equal(p->feature, pe_points(&world->previous)[i].feature);
        assert_close(p->impulse.z, i == 2 ? 0 : i + 1, 0, 0);
    }
    /* Another step: twice as long, twice the impulse. */
    world->previous_dt = H;
    pe_contacts_match(world, 2 * H);
    assert_close(pe_points(&world->contacts)[4].impulse.z, 10, 1e-15, 0);
    pe_world_destroy(world);
}

static void test_impulses_go_to_the_nearest_point_when_features_are_renamed(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_id ids[2];
    add_tower(world, 2, (pe_material_id){0}, ids);
    find(world, 0);
    mark_impulses(&world->contacts);
    const pe_manifold *m = manifold_of(&world->contacts, 2, 3);
    assert_non_null(m);
    for (int j = m->first; j < m->first + m->count; ++j) {
        pe_points(&world->contacts)[j].feature += 1u << 20;
    }
    pe_body_state s = state_of(world, ids[1]);
    place(world, ids[1], pe_add(s.position, pe_v3(4e-3, 0, 0)), s.orientation);
    find(world, 0);
    for (int j = m->first; j < m->first + m->count; ++j) {
        assert_close(pe_points(&world->contacts)[j].impulse.z, 1 + j, 0, 0);
    }
    /* Too far for being the same. */
    m = manifold_of(&world->contacts, 2, 3);
    for (int j = m->first; j < m->first + m->count; ++j) {
        pe_points(&world->contacts)[j].feature += 1u << 20;
        pe_points(&world->contacts)[j].anchor_a.y += 0.011;
    }
    find(world, 0);
    for (int j = m->first; j < m->first + m->count; ++j) {
        assert_close(pe_points(&world->contacts)[j].impulse.z, 0, 0, 0);
    }
    pe_world_destroy(world);
}

static void test_a_kept_manifold_has_its_impulses_and_the_surface_of_now(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_id ids[2];
    pe_material_id material = add_material(world, 0.5, 0);
    add_tower(world, 2, material, ids);
    find(world, 1e-9);
    mark_impulses(&world->contacts);
    assert_int_equal(pe_world_set_pair(world, material, material, 0.25, 0.75, NULL), PE_OK);
    find(world, 1e-9);
    assert_int_equal(world->contacts.manifold_count, 2);
    for (int i = 0; i < 2; ++i) {
        const pe_manifold *m = &pe_manifolds(&world->contacts)[i];
        assert_true(m->kept);
        assert_close(m->friction, 0.25, 0, 0);
        assert_close(m->restitution, 0.75, 0, 0);
        for (int j = m->first; j < m->first + m->count; ++j) {
            assert_close(pe_points(&world->contacts)[j].impulse.z, 1 + j, 0, 0);
        }
    }
    pe_world_destroy(world);
}

static void test_a_new_body_in_an_old_slot_inherits_no_manifold(void **state)
{
    (void)state;
    pe_world *world = make_world(NULL);
    pe_body_id ids[2];
    add_tower(world, 2, (pe_material_id){0}, ids);
    find(world, 1e-9);
    assert_int_equal(pe_body_destroy(world, ids[1], NULL), PE_OK);
    pe_body_def smaller = box_def(0.3, 0.3, 0.5, pe_v3(0, 0, 1.5));
    assert_int_equal(add_body(world, &smaller).index, ids[1].index);
    find(world, 1e-9);
    const pe_manifold *m = manifold_of(&world->contacts, 2, 3);
    assert_non_null(m);
    assert_false(m->kept);
    assert_close(fabs(pe_points(&world->contacts)[m->first].position.x), 0.3, 1e-5, 0);
    pe_world_destroy(world);
}

static void test_no_manifold_has_more_points_than_the_rules_allow(void **state)
{
    (void)state;
    check_random random = {64};
    pe_body_id ids[BODIES];
    pe_world *world = brick_wall(NULL, ids);
    int reduced = 0;
    for (int i = 0; i < 100; ++i) {
        shake(world, ids, &random, NULL, 0.02);
        find_by(world, 1e-4, 4);
        int few = world->contacts.point_count;
        for (int k = 0; k < world->contacts.manifold_count; ++k) {
            assert_in_range(pe_manifolds(&world->contacts)[k].count, 1, 4);
        }
        find(world, 0);
        reduced += world->contacts.point_count > few;
    }
    assert_true(reduced > 50);
    pe_world_destroy(world);
}

static void test_two_worlds_with_the_same_history_have_the_same_contacts_to_the_bit(void **state)
{
    (void)state;
    pe_body_id ids[BODIES];
    pe_world *worlds[2] = {brick_wall(NULL, ids), brick_wall(NULL, ids)};
    for (int k = 0; k < 2; ++k) {
        check_random random = {2};
        for (int i = 0; i < 50; ++i) {
            shake(worlds[k], ids, &random, NULL, i % 3 == 0 ? 1e-2 : 1e-5);
            find(worlds[k], 1e-3);
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
        cmocka_unit_test(test_a_kept_manifold_is_a_fresh_one_within_its_tolerance),
        cmocka_unit_test(test_a_pair_that_moved_beyond_the_tolerance_is_found_anew_to_the_bit),
        cmocka_unit_test(test_slow_motion_does_not_carry_a_manifold_for_ever),
        cmocka_unit_test(test_a_manifold_is_kept_only_if_the_margin_asks_for_the_same_points),
        cmocka_unit_test(test_finding_again_equals_finding_all_for_moved_bodies_and_keeps_the_rest),
        cmocka_unit_test(test_the_steps_own_pairs_serve_after_moves_of_half_the_contact_margin),
        cmocka_unit_test(test_finding_again_allocates_nothing_after_warm_up),
        cmocka_unit_test(test_without_memory_the_contacts_are_as_they_were),
        cmocka_unit_test(test_impulses_go_with_the_features_and_what_would_pull_is_dropped),
        cmocka_unit_test(test_impulses_go_to_the_nearest_point_when_features_are_renamed),
        cmocka_unit_test(test_a_kept_manifold_has_its_impulses_and_the_surface_of_now),
        cmocka_unit_test(test_a_new_body_in_an_old_slot_inherits_no_manifold),
        cmocka_unit_test(test_no_manifold_has_more_points_than_the_rules_allow),
        cmocka_unit_test(test_two_worlds_with_the_same_history_have_the_same_contacts_to_the_bit),
    };
    return cmocka_run_group_tests_name("engine_contact_list", tests, NULL, NULL);
}
