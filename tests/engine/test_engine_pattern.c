/* The pattern of the direct solver's factor against the dense factor, and its order of
 * elimination. */
#include "check.h"
#include "factor_setting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Which blocks of the dense factor are not zero, in the order of elimination. */
static bool *dense_blocks(const factor_setting *s)
{
    int n = s->n, bodies = n / 6;
    double *l = malloc((size_t)(n * n + 1) * sizeof *l);
    bool *present = calloc((size_t)(bodies * bodies) + 1, sizeof *present);
    assert_true(l != NULL && present != NULL);
    const int *order = s->pattern.order;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            l[i * n + j] = s->h[(6 * order[i / 6] + i % 6) * n + 6 * order[j / 6] + j % 6];
        }
    }
    dense_cholesky(l, n);
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j <= i; ++j) {
            present[i / 6 * bodies + j / 6] |= l[i * n + j] != 0;
        }
    }
    free(l);
    return present;
}

/* Multiplications and additions, block by block: b^3/3 for a diagonal block, b^3
 * for a division, 2 b^3 for a product that is subtracted. */
static double count_flops(const bool *present, int bodies)
{
    double flops = 0;
    for (int k = 0; k < bodies; ++k) {
        flops += 72;
        for (int i = k + 1; i < bodies; ++i) {
            flops += present[i * bodies + k] ? 216 : 0;
            for (int j = k + 1; j <= i; ++j) {
                flops += present[i * bodies + k] && present[j * bodies + k] ? 432 : 0;
            }
        }
    }
    return flops;
}

static void pattern_is_that_of_the_dense_factor(factor_setting *s, const char *name)
{
    const pe_pattern *pattern = &s->pattern;
    int bodies = pattern->count;
    bool *present = dense_blocks(s), *listed = calloc((size_t)(bodies * bodies), sizeof *listed);
    assert_non_null(listed);
    for (int k = 0; k < bodies; ++k) {
        assert_int_equal(pattern->place[pattern->order[k]], k);
        assert_int_equal(pattern->row[pattern->start[k]], k);
        for (int b = pattern->start[k]; b < pattern->start[k + 1]; ++b) {
            assert_true(b == pattern->start[k] || pattern->row[b] > pattern->row[b - 1]);
            listed[pattern->row[b] * bodies + k] = true;
        }
    }
    for (int i = 0; i < bodies; ++i) {
        for (int k = 0; k <= i; ++k) {
            if (listed[i * bodies + k] != present[i * bodies + k]) {
                fail_msg("%s: block (%d, %d): in the pattern %d, in the dense factor %d", name, i,
                         k, listed[i * bodies + k], present[i * bodies + k]);
            }
        }
    }
    assert_close(pattern->flops, count_flops(present, bodies), 0, 0);
    free(present);
    free(listed);
}

static void test_pattern_blocks_and_flops_equal_the_dense_factor(void **state)
{
    (void)state;
    hold_everywhere(pattern_is_that_of_the_dense_factor, 30);
}

static void patches_couple_in_their_own_block(factor_setting *s, const char *name)
{
    (void)name;
    const pe_pattern *pattern = &s->pattern;
    for (int i = 0; i < s->problem.manifold_count; ++i) {
        const pe_problem_manifold *m = &s->source->manifolds[i];
        assert_int_equal(pattern->counted[i], s->counted[i]);
        if (!s->counted[i] || m->a == PE_STATIC || m->b == PE_STATIC) {
            assert_int_equal(pattern->couple[i], -1);
            continue;
        }
        int p = pattern->place[m->a], q = pattern->place[m->b], column = p < q ? p : q;
        assert_in_range(pattern->couple[i], pattern->start[column] + 1,
                        pattern->start[column + 1] - 1);
        assert_int_equal(pattern->row[pattern->couple[i]], p + q - column);
    }
}

static void test_only_counted_manifolds_couple_bodies(void **state)
{
    (void)state;
    hold_everywhere(patches_couple_in_their_own_block, 30);
}

static void test_null_counts_every_manifold(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        factor_setting all, each;
        pe_contact_problem *source = problem_of_random_pairs(seed);
        bool *counted = malloc((size_t)source->manifold_count + 1);
        assert_non_null(counted);
        memset(counted, true, (size_t)source->manifold_count + 1);
        setting_begin(&all, problem_of_random_pairs(seed), NULL, pe_pattern_find, seed, 30);
        setting_begin(&each, source, counted, pe_pattern_find, seed, 30);
        int bodies = all.pattern.count, blocks = all.pattern.start[bodies];
        assert_int_equal(each.pattern.start[bodies], blocks);
        assert_memory_equal(all.pattern.order, each.pattern.order, (size_t)bodies * sizeof(int));
        assert_memory_equal(all.pattern.row, each.pattern.row, (size_t)blocks * sizeof(int));
        assert_memory_equal(all.factor.block, each.factor.block, (size_t)blocks * sizeof(pe_block));
        setting_end(&all);
        setting_end(&each);
        free(counted);
    }
}

static int depth_of(pe_contact_problem *source, const bool *counted)
{
    factor_setting s;
    setting_begin(&s, source, counted, pe_pattern_find, 1, 30);
    int depth = s.pattern.depth;
    setting_end(&s);
    return depth;
}

static void test_depth_is_the_distance_to_static_bodies(void **state)
{
    (void)state;
    assert_int_equal(depth_of(problem_of_chain(17), NULL), 17);
    assert_int_equal(depth_of(problem_of_grid(9, 4), NULL), 9);
    assert_int_equal(depth_of(problem_of_pairs(1, 1, NULL, 0), NULL), 1);
    const int loose[][2] = {{0, 1}, {1, 2}},
              bridge[][2] = {{PE_STATIC, 0}, {0, 1}, {1, 2}, {3, 2}, {3, PE_STATIC}};
    assert_int_equal(depth_of(problem_of_pairs(1, 3, loose, 2), NULL), 1);
    assert_int_equal(depth_of(problem_of_pairs(1, 4, bridge, 5), NULL), 2);
    const bool cut[] = {true, true, true, false, true};
    assert_int_equal(depth_of(problem_of_pairs(1, 4, bridge, 5), cut), 3);
}

/* A star: to eliminate its hub first would couple all the others. */
static void test_hub_of_a_star_is_eliminated_late(void **state)
{
    (void)state;
    enum { BODIES = 30 };
    pair_list star = {.count = 0};
    for (int i = 1; i < BODIES; ++i) {
        pair_up(&star, 0, i);
    }
    for (int f = 0; f < PATTERN_FINDER_COUNT; ++f) {
        factor_setting s;
        setting_begin(&s, problem_of_pairs(3, BODIES, (const int(*)[2])star.list, star.count), NULL,
                      PATTERN_FINDERS[f], 1, 30);
        assert_true(s.pattern.place[0] >= BODIES - 2);
        assert_int_equal(s.pattern.start[BODIES], 2 * BODIES - 1);
        setting_end(&s);
    }
}

static void test_loaded_manifolds_carry_or_approach(void **state)
{
    (void)state;
    int seen[2] = {0};
    for (uint64_t seed = 1; seed <= 40; ++seed) {
        test_memory memory;
        pe_workspace work = test_memory_begin(&memory);
        pe_contact_problem *source = problem_at_random(seed, 6, 10);
        check_random random = {seed};
        for (int j = 0; j < source->point_count; ++j) {
            source->points[j].impulse[0] = fmax(0, source->points[j].impulse[0]);
            source->points[j].bias += check_uniform(&random, 0, 8);
            if (check_uniform(&random, 0, 1) < 0.5) {
                memset(source->points[j].impulse, 0, sizeof source->points[j].impulse);
            }
        }
        pe_problem problem = solver_problem(source, work);
        double u[40][3];
        reference_contact_velocities(source, (const double(*)[6])problem.velocity, u);
        bool loaded[10];
        int points = pe_pattern_mark_loaded(&problem, 0.1, loaded), expected = 0;
        for (int i = 0; i < 10; ++i) {
            const pe_problem_manifold *m = &source->manifolds[i];
            bool carries = false;
            for (int j = m->first; j < m->first + m->count; ++j) {
                carries |= source->points[j].impulse[0] > 0 || u[j][0] < -0.1;
            }
            assert_int_equal(loaded[i], carries);
            expected += carries ? m->count : 0;
            seen[carries] += 1;
        }
        assert_int_equal(points, expected);
        pe_contact_problem_destroy(source);
        test_memory_end(&memory);
    }
    assert_true(seen[0] > 20 && seen[1] > 20);
}

static void test_out_of_memory_is_reported(void **state)
{
    (void)state;
    for (int f = 0; f < PATTERN_FINDER_COUNT; ++f) {
        pe_contact_problem *source = problem_of_grid(4, 4);
        pe_status status = PE_NO_MEMORY;
        for (long k = 1; status == PE_NO_MEMORY; ++k) {
            test_memory whole, scarce;
            pe_problem problem = solver_problem(source, test_memory_begin(&whole));
            pe_workspace work = test_memory_begin(&scarce);
            pe_pattern pattern;
            pe_factor factor;
            pe_error error = {0};
            scarce.fail_at = k;
            status = PATTERN_FINDERS[f](&problem, NULL, work, &pattern, &error);
            if (status == PE_OK) {
                status = pe_factor_create(&pattern, work, &factor, &error);
            }
            assert_true(status == PE_OK || status == PE_NO_MEMORY);
            assert_int_equal(status == PE_OK, k > scarce.made);
            assert_int_equal(error.status, status);
            test_memory_end(&scarce);
            test_memory_end(&whole);
        }
        pe_contact_problem_destroy(source);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pattern_blocks_and_flops_equal_the_dense_factor),
        cmocka_unit_test(test_only_counted_manifolds_couple_bodies),
        cmocka_unit_test(test_null_counts_every_manifold),
        cmocka_unit_test(test_depth_is_the_distance_to_static_bodies),
        cmocka_unit_test(test_hub_of_a_star_is_eliminated_late),
        cmocka_unit_test(test_loaded_manifolds_carry_or_approach),
        cmocka_unit_test(test_out_of_memory_is_reported),
    };
    return cmocka_run_group_tests_name("engine_pattern", tests, NULL, NULL);
}
