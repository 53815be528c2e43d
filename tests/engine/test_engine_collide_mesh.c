/* Narrow phase of meshes: no contact with edges inside a face, but with both walls of a corner. */
#include "check.h"
#include "counting_allocator.h"
#include "mesh_for_tests.h"
#include "narrow_phase/mesh/near_features.h"
#include "random_pose.h"

static placed_shape shape_at(pe_shape shape, pe_vec3 position, pe_quat q)
{
    return (placed_shape){.shape = shape, .pose = pose_at(position, q)};
}

static placed_shape box_at(pe_vec3 half, pe_vec3 position, pe_quat q)
{
    return shape_at((pe_shape){.kind = PE_SHAPE_BOX, .half_extents = half}, position, q);
}

static placed_shape sphere_at(double radius, pe_vec3 position)
{
    return shape_at((pe_shape){.kind = PE_SHAPE_SPHERE, .radius = radius}, position, unturned);
}

typedef struct found {
    int count;
    pe_pair_manifold manifold[PE_MAX_MANIFOLDS];
} found;

static found collide(const placed_shape *a, const placed_shape *b, double margin)
{
    found f;
    pe_arena arena = {0};
    pe_allocator allocator = pe_allocator_default();
    f.count =
        pe_collide(of(a), of(b), margin, (pe_workspace){&arena, &allocator, NULL}, f.manifold);
    pe_arena_free(&arena, &allocator);
    assert_true(f.count >= 0 && f.count <= PE_MAX_MANIFOLDS);
    return f;
}

static double least_of(const found *f)
{
    double least = HUGE_VAL;
    for (int i = 0; i < f->count; ++i) {
        for (int k = 0; k < f->manifold[i].count; ++k) {
            least = pe_min(least, f->manifold[i].item[k].separation);
        }
    }
    return least;
}

/* A cube on a cube, moved sideways, touches at the corners of the rectangle where they overlap. */
static void test_stacked_cubes_touch_at_corners_of_their_overlap(void **state)
{
    (void)state;
    pe_geometry *g = mesh_geometry(mesh_cube(1));
    check_random random = {3};
    for (int i = 0; i < 500; ++i) {
        double dx = check_uniform(&random, -0.9, 0.9), dy = check_uniform(&random, -0.9, 0.9);
        double gap = check_uniform(&random, -1e-3, 1e-3);
        gap = i % 3 == 0 ? 0 : gap;
        dx = i % 5 == 0 ? 0 : dx;
        placed_shape lower = mesh_at(g, pe_v3(0, 0, 0), unturned);
        placed_shape other = i % 2 == 0
                                 ? mesh_at(g, pe_v3(dx, dy, 1 + gap), unturned)
                                 : box_at(pe_v3(0.5, 0.5, 0.5), pe_v3(dx, dy, 1 + gap), unturned);
        found f = collide(&lower, &other, 0.01);
        assert_int_equal(f.count, 1);
        assert_int_equal(f.manifold[0].count, 4);
        assert_close(f.manifold[0].normal.z, 1, 1e-12, 0);
        double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
        for (int k = 0; k < 4; ++k) {
            const pe_pair_point *h = &f.manifold[0].item[k];
            assert_close(h->separation, gap, 1e-12, 0);
            assert_close(h->position.z, 0.5 + 0.5 * gap, 1e-12, 0);
            low[0] = pe_min(low[0], h->position.x), high[0] = pe_max(high[0], h->position.x);
            low[1] = pe_min(low[1], h->position.y), high[1] = pe_max(high[1], h->position.y);
        }
        assert_close(high[0] - low[0], 1 - fabs(dx), 1e-8, 0);
        assert_close(high[1] - low[1], 1 - fabs(dy), 1e-8, 0);
    }
    free_geometry(g);
}

/* Bars laid crosswise have no vertex in each other's face. */
static void test_crossed_bars_touch_at_corners_of_their_overlap(void **state)
{
    (void)state;
    static const double corners[4][2] = {{-2, -0.25}, {2, -0.25}, {2, 0.25}, {-2, 0.25}};
    form bar = form_prism(corners, 4, 0, 0.5);
    pe_geometry *g = mesh_geometry(mesh_of_form(&bar));
    for (int i = -1; i < 2; ++i) {
        double gap = 1e-3 * i;
        placed_shape lower = mesh_at(g, pe_v3(0, 0, 0), unturned);
        placed_shape upper = mesh_at(g, pe_v3(0, 0, 0.5 + gap), (pe_quat){1, 0, 0, 1});
        found f = collide(&lower, &upper, 0.01);
        assert_int_equal(f.count, 1);
        assert_int_equal(f.manifold[0].count, 4);
        for (int k = 0; k < 4; ++k) {
            const pe_pair_point *h = &f.manifold[0].item[k];
            assert_close(h->separation, gap, 1e-12, 0);
            assert_close(fabs(h->position.x), 0.25, 1e-8, 0);
            assert_close(fabs(h->position.y), 0.25, 1e-8, 0);
        }
    }
    free_geometry(g);
}

static bool pushes_along(const found *f, pe_vec3 n, double depth)
{
    for (int i = 0; i < f->count; ++i) {
        for (int k = 0; k < f->manifold[i].count; ++k) {
            if (pe_dot(f->manifold[i].normal, n) > 1 - 1e-9 &&
                fabs(f->manifold[i].item[k].separation + depth) < 1e-9) {
                return true;
            }
        }
    }
    return false;
}

/* A cube in the inner corner of an L, into both walls, deeper into the one or the other. */
static void test_a_cube_in_a_corner_feels_both_walls(void **state)
{
    (void)state;
    pe_geometry *bar = mesh_geometry(mesh_angle_bar()), *small = mesh_geometry(mesh_cube(1));
    static const double depths[] = {-1e-9, 0, 1e-9, 1e-6, 1e-4, 1e-3};
    for (int i = 0; i < 36; ++i) {
        double x = depths[i / 6], y = depths[i % 6];
        pe_vec3 at = pe_v3(0.5 - x, 0.5 - y, 1);
        placed_shape corner = mesh_at(bar, pe_v3(0, 0, 0), unturned);
        placed_shape one = mesh_at(small, at, unturned),
                     other = box_at(pe_v3(0.5, 0.5, 0.5), at, unturned);
        found f = collide(&corner, &one, 0.01), g = collide(&other, &corner, 0.01);
        assert_true(pushes_along(&f, pe_v3(1, 0, 0), x) && pushes_along(&f, pe_v3(0, 1, 0), y));
        assert_true(pushes_along(&g, pe_v3(-1, 0, 0), x) && pushes_along(&g, pe_v3(0, -1, 0), y));
        int against_x = 0, against_y = 0;
        for (int p = 0; p < f.count; ++p) {
            against_x += f.manifold[p].normal.x > 0.5 ? f.manifold[p].count : 0;
            against_y += f.manifold[p].normal.y > 0.5 ? f.manifold[p].count : 0;
        }
        assert_int_equal(against_x, 4);
        assert_int_equal(against_y, 4);
    }
    free_geometry(bar);
    free_geometry(small);
}

static void slide(pe_geometry *floor, placed_shape *slider, double height, check_random *random)
{
    placed_shape ground = mesh_at(floor, pe_v3(0, 0, 0), unturned);
    double gap = check_uniform(random, -1e-4, 1e-4);
    double y = check_uniform(random, -2, 2), x = check_uniform(random, -2, 2);
    slider->pose.position = pe_v3(x, y, height + gap);
    found f = collide(&ground, slider, 1e-3);
    assert_int_equal(f.count, 1);
    assert_close(f.manifold[0].normal.z, 1, 1e-9, 0);
    assert_close(least_of(&f), gap, 1e-12, 0);
}

static void test_sliding_over_flat_floor_ignores_inner_edges(void **state)
{
    (void)state;
    pe_geometry *floor = mesh_geometry(mesh_floor(6)), *small = mesh_geometry(mesh_cube(0.8));
    check_random random = {21};
    for (int i = 0; i < 1500; ++i) {
        double turn = check_uniform(&random, 0, 6.28);
        pe_quat q = {cos(turn), 0, 0, sin(turn)};
        placed_shape ball = sphere_at(0.4, pe_v3(0, 0, 0));
        placed_shape box = box_at(pe_v3(0.4, 0.4, 0.4), pe_v3(0, 0, 0), q);
        placed_shape block = mesh_at(small, pe_v3(0, 0, 0), q);
        placed_shape pin =
            shape_at((pe_shape){.kind = PE_SHAPE_CAPSULE, .radius = 0.1, .half_height = 0.7},
                     pe_v3(0, 0, 0), pe_quat_product(q, (pe_quat){1, 1, 0, 0}));
        placed_shape can =
            shape_at((pe_shape){.kind = PE_SHAPE_CYLINDER, .radius = 0.5, .half_height = 0.2},
                     pe_v3(0, 0, 0), q);
        slide(floor, &ball, 0.4, &random);
        slide(floor, &box, 0.4, &random);
        slide(floor, &block, 0.4, &random);
        slide(floor, &pin, 0.1, &random);
        slide(floor, &can, 0.2, &random);
    }
    free_geometry(floor);
    free_geometry(small);
}

/* Of the smooth torus that the mesh of ring 0.35 and tube 0.15 approximates: the vector to x from
 * the nearest point of its ring. */
static pe_vec3 from_ring(const placed_shape *b, pe_vec3 x)
{
    pe_mat3 frame = pe_matrix_of(
        pe_quat_product(b->pose.orientation, pe_quat_conjugate(b->geometry->frame.orientation)));
    pe_vec3 y = pe_unrotate(&frame, pe_sub(x, b->pose.position));
    double r = sqrt(y.x * y.x + y.y * y.y);
    return pe_rotate(&frame, pe_sub(y, pe_v3(0.35 * y.x / r, 0.35 * y.y / r, 0)));
}

static pe_vec3 out_of_torus(const placed_shape *b, pe_vec3 x)
{
    pe_vec3 out = from_ring(b, x);
    return pe_scale(1 / pe_length(out), out);
}

/* The gap of two such tori, from points along the ring of the first. */
static double gap_of_tori(const placed_shape *a, const placed_shape *b)
{
    enum { POINTS = 2000 };
    pe_mat3 frame = pe_matrix_of(
        pe_quat_product(a->pose.orientation, pe_quat_conjugate(a->geometry->frame.orientation)));
    double least = HUGE_VAL;
    for (int i = 0; i < POINTS; ++i) {
        double angle = 6.283185307179586 * i / POINTS;
        pe_vec3 x = pe_v3(0.35 * cos(angle), 0.35 * sin(angle), 0);
        x = pe_add(a->pose.position, pe_rotate(&frame, x));
        least = pe_min(least, pe_length(from_ring(b, x)));
    }
    return least - 2 * 0.15;
}

/* Rings through each other, touching or overlapping by up to a fifth of the tube: each normal leads
 * out of both rings. */
static void test_linked_rings_are_never_pulled_through_each_other(void **state)
{
    (void)state;
    pe_geometry *g = mesh_geometry(mesh_torus(0.35, 0.15, 25, 12));
    check_random random = {77};
    int contacts = 0;
    for (int i = 0; i < 400; ++i) {
        placed_shape a = mesh_at(g, pe_v3(0, 0, 0), unturned);
        pe_quat q = {.w = 1};
        q.x = 1 + check_uniform(&random, -0.3, 0.3);
        q.y = check_uniform(&random, -0.3, 0.3);
        double height = check_uniform(&random, -0.1, 0.1);
        double sideways = 0.35 + check_uniform(&random, -0.1, 0.1);
        placed_shape b = mesh_at(g, pe_v3(sideways, 0, height), q);
        if (gap_of_tori(&a, &b) < -0.03) {
            continue;
        }
        found f = collide(&a, &b, 0.01);
        for (int p = 0; p < f.count; ++p) {
            for (int k = 0; k < f.manifold[p].count; ++k) {
                pe_vec3 x = f.manifold[p].item[k].position, n = f.manifold[p].normal;
                assert_true(pe_dot(n, out_of_torus(&a, x)) > 0.5);
                assert_true(pe_dot(n, out_of_torus(&b, x)) < -0.5);
                contacts += 1;
            }
        }
    }
    assert_true(contacts > 200);
    free_geometry(g);
}

/* A vertex of a torus in the face of a cube: its depth is computed without a tree. */
static void test_torus_on_cube_is_deep_as_lowest_vertex(void **state)
{
    (void)state;
    pe_geometry *ring = mesh_geometry(mesh_torus(0.35, 0.15, 25, 10)),
                *block = mesh_geometry(mesh_cube(2));
    check_random random = {31};
    for (int i = 0; i < 2000; ++i) {
        pe_quat q = random_turn(&random);
        placed_shape b = mesh_at(block, pe_v3(0, 0, -1), unturned),
                     a = mesh_at(ring, pe_v3(0, 0, 1), q);
        double lowest = HUGE_VAL;
        for (int k = 0; k < ring->vertex_count; ++k) {
            lowest = pe_min(lowest, pe_rotate(&a.pose.rotation, ring->vertices[k]).z);
        }
        double gap = check_uniform(&random, -0.05, 0.02);
        a.pose.position = pe_v3(0, 0, gap - lowest);
        found f = collide(&b, &a, 0.03);
        assert_true(f.count >= 1);
        assert_close(least_of(&f), gap, 1e-12, 0);
        assert_close(f.manifold[0].normal.z, 1, 1e-9, 0);
        assert_int_equal(f.count, 1);
    }
    free_geometry(ring);
    free_geometry(block);
}

static void test_wide_margin_finds_nearest_features_only(void **state)
{
    (void)state;
    pe_geometry *g = mesh_geometry(mesh_torus(0.35, 0.15, 100, 25));
    placed_shape a = mesh_at(g, pe_v3(0, 0, 0), unturned), b = mesh_at(g, pe_v3(0, 0, 5), unturned);
    found f = collide(&a, &b, 100);
    assert_true(f.count >= 1);
    assert_true(least_of(&f) > 4.69 && least_of(&f) < 4.71);
    assert_int_equal(collide(&a, &b, 4.6).count, 0);
    free_geometry(g);
}

static void test_a_solid_wholly_inside_another_is_pushed_out(void **state)
{
    (void)state;
    pe_geometry *block = mesh_geometry(mesh_cube(2)),
                *ring = mesh_geometry(mesh_torus(0.35, 0.15, 12, 8));
    placed_shape outer = mesh_at(block, pe_v3(0, 0, 0), unturned);
    placed_shape inner[4] = {
        mesh_at(ring, pe_v3(0, 0, 0.4), unturned),
        box_at(pe_v3(0.2, 0.2, 0.2), pe_v3(0, 0, 0.4), unturned),
        sphere_at(0.2, pe_v3(0, 0, 0.4)),
        shape_at((pe_shape){.kind = PE_SHAPE_CYLINDER, .radius = 0.2, .half_height = 0.2},
                 pe_v3(0, 0, 0.4), unturned),
    };
    for (int i = 0; i < 4; ++i) {
        found f = collide(&outer, &inner[i], 1e-3);
        assert_true(f.count >= 1);
        assert_true(least_of(&f) < -0.5);
        /* The nearest face is the top one. */
        assert_close(f.manifold[0].normal.z, 1, 1e-9, 0);
    }
    free_geometry(block);
    free_geometry(ring);
}

/* At a margin that reaches the other side of the solid, too, and where the nearest part of its surface
 * is a dent. */
static void test_solid_inside_mesh_overlaps_at_any_margin(void **state)
{
    (void)state;
    check_random random = {3};
    pe_geometry *ring = mesh_geometry(mesh_torus(6, 2, 9, 8));
    pe_geometry *small = mesh_geometry(mesh_cube(0.1));
    placed_shape outer = mesh_at(ring, pe_v3(0, 0, 0), unturned);
    for (int i = 0; i < 100; ++i) {
        const double around = check_uniform(&random, 0, 7);
        pe_vec3 x = random_vector(&random, 0.5);
        x = pe_add(x, pe_v3(5.5 * cos(around), 5.5 * sin(around), 0));
        pe_quat turn = random_turn(&random);
        const placed_shape inner[5] = {
            shape_at((pe_shape){.kind = PE_SHAPE_CYLINDER, .radius = 0.016, .half_height = 0.077},
                     x, turn),
            shape_at((pe_shape){.kind = PE_SHAPE_CAPSULE, .radius = 0.016, .half_height = 0.077}, x,
                     turn),
            box_at(pe_v3(0.02, 0.05, 0.08), x, turn),
            sphere_at(0.05, x),
            mesh_at(small, x, turn),
        };
        for (int k = 0; k < 5; ++k) {
            for (double margin = 1e-3; margin < 10; margin *= 2) {
                found f = collide(&outer, &inner[k], margin);
                assert_true(f.count >= 1);
                assert_true(least_of(&f) < 0);
            }
        }
    }
    free_geometry(small);
    free_geometry(ring);
}

static void test_features_stay_while_a_stack_sways(void **state)
{
    (void)state;
    pe_geometry *g = mesh_geometry(mesh_cube(1)),
                *ring = mesh_geometry(mesh_torus(0.35, 0.15, 25, 10));
    placed_shape lower = mesh_at(g, pe_v3(0, 0, 0), unturned);
    pe_shape plane = {.kind = PE_SHAPE_PLANE, .normal = {0, 0, 1}};
    placed_shape ground = shape_at(plane, pe_v3(0, 0, 0), unturned);
    check_random random = {13};
    double bottom = HUGE_VAL;
    for (int k = 0; k < ring->vertex_count; ++k) {
        bottom = pe_min(bottom, pe_add(ring->vertices[k], ring->frame.centre).z);
    }
    found first[2] = {{.count = 0}};
    for (int i = 0; i < 300; ++i) {
        pe_vec3 d = i == 0 ? pe_v3(0, 0, 0) : random_vector(&random, 1e-9);
        pe_vec3 r = i == 0 ? pe_v3(0, 0, 0) : random_vector(&random, 0.5e-9);
        pe_quat q = {1, r.x, r.y, r.z};
        placed_shape upper = mesh_at(g, pe_add(pe_v3(0.2, 0.3, 1), d), q);
        placed_shape hoop = mesh_at(ring, pe_add(pe_v3(0, 0, -bottom), d), q);
        found now[2] = {collide(&lower, &upper, 0.01), collide(&ground, &hoop, 0.01)};
        for (int k = 0; k < 2; ++k) {
            first[k] = i == 0 ? now[k] : first[k];
            assert_int_equal(now[k].count, first[k].count);
            for (int p = 0; p < now[k].count; ++p) {
                assert_int_equal(now[k].manifold[p].count, first[k].manifold[p].count);
                for (int m = 0; m < now[k].manifold[p].count; ++m) {
                    assert_true(now[k].manifold[p].item[m].feature ==
                                first[k].manifold[p].item[m].feature);
                }
            }
        }
    }
    free_geometry(g);
    free_geometry(ring);
}

static void test_any_allocation_may_fail(void **state)
{
    (void)state;
    pe_geometry *g = mesh_geometry(mesh_torus(0.35, 0.15, 25, 10));
    placed_shape a = mesh_at(g, pe_v3(0, 0, 0), unturned);
    placed_shape b = mesh_at(g, pe_v3(0.1, 0, 0.05), (pe_quat){1, 0.2, 0.1, 0});
    counter c = {.fail_at = -1};
    pe_allocator allocator = {count_allocate, count_release, &c};
    int all = 0;
    for (int k = -1; k < all; ++k) {
        c = (counter){.fail_at = k};
        pe_arena arena = {0};
        pe_pair_manifold manifolds[PE_MAX_MANIFOLDS];
        int count =
            pe_collide(of(&a), of(&b), 0.01, (pe_workspace){&arena, &allocator, NULL}, manifolds);
        all = k < 0 ? c.calls : all;
        assert_true(k < 0 ? count > 0 : count == -1);
        pe_arena_free(&arena, &allocator);
        assert_int_equal(c.living, 0);
    }
    assert_true(all >= 3);
    free_geometry(g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stacked_cubes_touch_at_corners_of_their_overlap),
        cmocka_unit_test(test_crossed_bars_touch_at_corners_of_their_overlap),
        cmocka_unit_test(test_a_cube_in_a_corner_feels_both_walls),
        cmocka_unit_test(test_sliding_over_flat_floor_ignores_inner_edges),
        cmocka_unit_test(test_linked_rings_are_never_pulled_through_each_other),
        cmocka_unit_test(test_torus_on_cube_is_deep_as_lowest_vertex),
        cmocka_unit_test(test_wide_margin_finds_nearest_features_only),
        cmocka_unit_test(test_a_solid_wholly_inside_another_is_pushed_out),
        cmocka_unit_test(test_solid_inside_mesh_overlaps_at_any_margin),
        cmocka_unit_test(test_features_stay_while_a_stack_sways),
        cmocka_unit_test(test_any_allocation_may_fail),
    };
    return cmocka_run_group_tests_name("engine_collide_mesh", tests, NULL, NULL);
}
