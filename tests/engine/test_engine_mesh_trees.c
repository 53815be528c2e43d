/* The trees of meshes: pairs of near triangles and containment, against brute force. */
#include "check.h"
#include "mesh_for_tests.h"
#include "narrow_phase/mesh/solid_pair.h"
#include "narrow_phase/mesh/solid_query.h"

static double distance_of_facets(const pe_facet *a, const pe_facet *b)
{
    double least = HUGE_VAL;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            pe_vec3 u = pe_sub(a->x[(i + 1) % 3], a->x[i]), v = pe_sub(b->x[(j + 1) % 3], b->x[j]);
            double s, t;
            pe_segments_nearest(a->x[i], u, b->x[j], v, &s, &t);
            least =
                pe_min(least, pe_length(pe_sub(pe_madd(a->x[i], s, u), pe_madd(b->x[j], t, v))));
        }
    }
    for (int side = 0; side < 2; ++side) {
        const pe_facet *over = side == 0 ? a : b, *of = side == 0 ? b : a;
        for (int k = 0; k < 3; ++k) {
            double height = pe_dot(over->normal, of->x[k]) - over->offset;
            least = pe_facet_contains(over, of->x[k], 0) ? pe_min(least, fabs(height)) : least;
        }
    }
    return least;
}

typedef struct tally {
    const pe_solid_pair *pair;
    double bound;
    long near; /* pairs within the bound, by their exact distance */
} tally;

static bool count_near(void *context, pe_facet *a, pe_facet *b)
{
    tally *t = context;
    t->near += distance_of_facets(a, b) <= t->bound;
    return true;
}

/* By the trees, with a parting direction, and gathered. */
static void test_all_triangle_pairs_within_bound_are_reported(void **state)
{
    (void)state;
    pe_geometry *g = mesh_geometry(mesh_torus(0.35, 0.15, 10, 6));
    check_random random = {5};
    pe_arena arena = {0};
    pe_allocator allocator = pe_allocator_default();
    long total = 0;
    int gathered = 0;
    for (int i = 0; i < 60; ++i) {
        placed_shape a = mesh_at(g, pe_v3(0, 0, 0), random_turn(&random));
        pe_quat turn = random_turn(&random);
        placed_shape b = mesh_at(g, random_vector(&random, 0.6), turn);
        pe_solid_pair pair;
        pe_solid_pair_make(of(&a), of(&b), &pair);
        double bound = check_uniform(&random, 0, 0.05);
        tally want = {.pair = &pair, .bound = bound};
        for (int m = 0; m < g->triangle_count; ++m) {
            pe_facet fa, fb;
            pe_solid_facet_placed(&pair.a, &pair.trees.a_in_b, m, &fa);
            for (int n = 0; n < g->triangle_count; ++n) {
                pe_solid_facet(&pair.b, n, &fb);
                count_near(&want, &fa, &fb);
            }
        }
        tally plain = {.pair = &pair, .bound = bound};
        pe_each_near_facets(&pair, &bound, count_near, &plain);
        assert_int_equal(plain.near, want.near);
        if (!pe_solid_pair_part(&pair, bound)) {
            assert_int_equal(want.near, 0);
            continue;
        }
        tally parted = {.pair = &pair, .bound = bound};
        pe_each_near_facets(&pair, &bound, count_near, &parted);
        assert_int_equal(parted.near, want.near);
        assert_true(pe_solid_pair_gather(&pair, bound, (pe_workspace){&arena, &allocator, NULL}));
        gathered += pair.near_a.facets != NULL;
        tally each = {.pair = &pair, .bound = bound};
        pe_each_near_facets(&pair, &bound, count_near, &each);
        assert_int_equal(each.near, want.near);
        total += want.near;
    }
    assert_true(total > 200 && gathered > 10);
    pe_arena_free(&arena, &allocator);
    free_geometry(g);
}

/* Winding number by solid angles, Van Oosterom and Strackee 1983. */
static bool winds_around(const pe_geometry *g, pe_vec3 x)
{
    double sum = 0;
    for (int i = 0; i < g->triangle_count; ++i) {
        pe_vec3 r[3];
        double l[3];
        for (int k = 0; k < 3; ++k) {
            r[k] = pe_sub(g->vertices[g->triangles[i][k]], x);
            l[k] = pe_length(r[k]);
        }
        sum += 2 * atan2(pe_dot(r[0], pe_cross(r[1], r[2])),
                         l[0] * l[1] * l[2] + pe_dot(r[0], r[1]) * l[2] +
                             pe_dot(r[1], r[2]) * l[0] + pe_dot(r[2], r[0]) * l[1]);
    }
    return sum > 6.28;
}

static void test_containment_equals_winding_number(void **state)
{
    (void)state;
    pe_geometry *both[2] = {mesh_geometry(mesh_torus(0.35, 0.15, 14, 8)),
                            mesh_geometry(mesh_angle_bar())};
    check_random random = {9};
    int inside = 0;
    for (int i = 0; i < 4000; ++i) {
        const pe_geometry *g = both[i % 2];
        pe_solid solid = pe_solid_of_geometry(g);
        pe_vec3 x = random_vector(&random, 0.7 * g->bounding_radius);
        bool truth = winds_around(g, x);
        assert_int_equal(pe_solid_contains(&solid, x), truth);
        inside += truth;
    }
    assert_true(inside > 300);
    free_geometry(both[0]);
    free_geometry(both[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all_triangle_pairs_within_bound_are_reported),
        cmocka_unit_test(test_containment_equals_winding_number),
    };
    return cmocka_run_group_tests_name("engine_mesh_trees", tests, NULL, NULL);
}
