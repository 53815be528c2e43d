/* The direct solver's linear algebra against dense matrices made from the definition of J. */
#include "breadth_first.h"
#include "check.h"
#include "contact_problem_for_tests.h"
#include "dense_problem.h"
#include "solve/factor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef pe_status (*pattern_finder)(const pe_problem *problem, const bool *counted,
                                    pe_workspace work, pe_pattern *pattern, pe_error *error);

static const pattern_finder FINDERS[] = {pe_pattern_find, breadth_first_pattern};
enum { FINDER_COUNT = 2, MOST_PAIRS = 600 };

/* ---- Problems ----------------------------------------------------------------------------------
 */

typedef struct pairs {
    int list[MOST_PAIRS][2];
    int count;
} pairs;

static void pair_up(pairs *to, int a, int b)
{
    assert_true(to->count < MOST_PAIRS);
    to->list[to->count][0] = a;
    to->list[to->count++][1] = b;
}

static int draw_index(check_random *random, int below)
{
    return (int)check_uniform(random, 0, below);
}

/* Random pairs, either order; some on the ground, on either side of it; some twice. */
static pe_contact_problem *random_problem(uint64_t seed)
{
    check_random random = {seed};
    int bodies = 1 + draw_index(&random, 12), patches = draw_index(&random, 3 * bodies);
    pairs drawn = {.count = 0};
    for (int i = 0; i < patches; ++i) {
        int a = draw_index(&random, bodies), b = draw_index(&random, bodies);
        double kind = check_uniform(&random, 0, 1);
        if (i > 0 && kind < 0.2) {
            const int *former = drawn.list[draw_index(&random, i)];
            pair_up(&drawn, kind < 0.1 ? former[0] : former[1], kind < 0.1 ? former[1] : former[0]);
        } else if (a == b || kind < 0.4) {
            pair_up(&drawn, kind < 0.3 ? PE_STATIC : a, kind < 0.3 ? a : PE_STATIC);
        } else {
            pair_up(&drawn, a, b);
        }
    }
    return problem_of_pairs(seed, bodies, (const int(*)[2])drawn.list, drawn.count);
}

static pe_contact_problem *chain_problem(int bodies)
{
    pairs chain = {.count = 0};
    for (int i = 0; i < bodies; ++i) {
        pair_up(&chain, i - 1, i); /* the first with PE_STATIC */
    }
    return problem_of_pairs(7, bodies, (const int(*)[2])chain.list, chain.count);
}

/* A wall of `rows` x `columns`, its lowest row on the ground. */
static pe_contact_problem *grid_problem(int rows, int columns)
{
    pairs grid = {.count = 0};
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
            pair_up(&grid, i > 0 ? (i - 1) * columns + j : PE_STATIC, i * columns + j);
            if (j > 0) {
                pair_up(&grid, i * columns + j - 1, i * columns + j);
            }
        }
    }
    return problem_of_pairs(8, rows * columns, (const int(*)[2])grid.list, grid.count);
}

/* Positive semidefinite gains up to about `size`: of points that stick, that slip, that have no
 * friction (nn alone), that are open (all zero); zero where the patch is not counted. */
static void draw_gains(check_random *random, const pe_contact_problem *problem, const bool *counted,
                       double size, pe_gain *gain)
{
    memset(gain, 0, ((size_t)problem->point_count + 1) * sizeof *gain);
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_problem_manifold *m = &problem->manifolds[i];
        for (int j = m->first; j < m->first + m->count; ++j) {
            double kind = check_uniform(random, 0, 1), r[3][3];
            for (int k = 0; k < 9; ++k) {
                r[k / 3][k % 3] = check_uniform(random, -1, 1);
            }
            if (!counted[i] || (kind < 0.2 && j > m->first)) {
                continue;
            }
            if (kind < 0.4) {
                gain[j][0] = size * check_uniform(random, 0.1, 1);
                continue;
            }
            static const int at[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
            for (int k = 0; k < 6; ++k) { /* R^T R */
                for (int row = 0; row < (kind < 0.7 ? 2 : 3); ++row) {
                    gain[j][k] += size * r[row][at[k][0]] * r[row][at[k][1]];
                }
            }
        }
    }
}

/* M + J^T G J. */
static double *dense_matrix(const pe_contact_problem *problem, const pe_gain *gain)
{
    static const int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    int n = 6 * problem->body_count;
    double *h = dense_mass(problem), *jacobian = dense_jacobian(problem);
    for (int j = 0; j < problem->point_count; ++j) {
        const double *rows = jacobian + 3 * j * n;
        for (int a = 0; a < n; ++a) {
            double pushed[3]; /* column a of J^T G, transposed */
            for (int k = 0; k < 3; ++k) {
                pushed[k] = rows[a] * gain[j][at[0][k]] + rows[n + a] * gain[j][at[1][k]] +
                            rows[2 * n + a] * gain[j][at[2][k]];
            }
            if (pushed[0] == 0 && pushed[1] == 0 && pushed[2] == 0) {
                continue;
            }
            for (int b = 0; b < n; ++b) {
                h[a * n + b] +=
                    pushed[0] * rows[b] + pushed[1] * rows[n + b] + pushed[2] * rows[2 * n + b];
            }
        }
    }
    free(jacobian);
    return h;
}

/* ---- A problem with everything that is made from it --------------------------------------------
 */

typedef struct setting {
    test_memory memory;
    pe_workspace work;
    pe_contact_problem *source;
    pe_problem problem;
    bool *counted;
    pe_gain *gain;
    pe_pattern pattern;
    pe_factor factor;
    double *h; /* (n x n) */
    int n;
} setting;

/* `counted` NULL: all. Takes `source`. */
static void begin(setting *s, pe_contact_problem *source, const bool *counted,
                  pattern_finder find_pattern, uint64_t seed, double size)
{
    s->work = test_memory_begin(&s->memory);
    s->source = source;
    s->problem = solver_problem(source, s->work);
    s->n = 6 * source->body_count;
    size_t patches = (size_t)source->manifold_count;
    s->counted = pe_take(s->work, patches + 1, sizeof *s->counted);
    s->gain = pe_take(s->work, (size_t)source->point_count + 1, sizeof *s->gain);
    for (size_t i = 0; i < patches; ++i) {
        s->counted[i] = counted == NULL || counted[i];
    }
    check_random random = {seed + 1};
    draw_gains(&random, source, s->counted, size, s->gain);
    s->h = dense_matrix(source, (const pe_gain *)s->gain);
    assert_int_equal(find_pattern(&s->problem, counted, s->work, &s->pattern, NULL), PE_OK);
    assert_int_equal(pe_factor_create(&s->pattern, s->work, &s->factor, NULL), PE_OK);
    pe_factor_assemble(&s->factor, &s->problem, (const pe_gain *)s->gain);
}

static void end(setting *s)
{
    free(s->h);
    pe_contact_problem_destroy(s->source);
    test_memory_end(&s->memory);
}

/* Draws which patches count; the caller frees it. */
static bool *draw_subset(uint64_t seed, int count)
{
    check_random random = {seed + 100};
    bool *counted = malloc((size_t)count + 1);
    assert_non_null(counted);
    for (int i = 0; i < count; ++i) {
        counted[i] = check_uniform(&random, 0, 1) < 0.6;
    }
    return counted;
}

typedef void (*law)(setting *s, const char *name);

/* A law on problems of every kind, in both orders of elimination, on all patches and on some. */
static void hold_everywhere(law holds, double size)
{
    for (int f = 0; f < FINDER_COUNT; ++f) {
        for (uint64_t seed = 1; seed <= 60; ++seed) {
            setting s;
            pe_contact_problem *source = random_problem(seed);
            bool *counted = draw_subset(seed, source->manifold_count);
            begin(&s, source, seed % 2 == 0 ? counted : NULL, FINDERS[f], seed, size);
            holds(&s, "random");
            end(&s);
            free(counted);
        }
        pe_contact_problem *sources[] = {problem_of_pairs(1, 1, NULL, 0),
                                         problem_of_pairs(2, 5, NULL, 0), chain_problem(1),
                                         chain_problem(40), grid_problem(7, 8)};
        const char *const names[] = {"a body", "five bodies apart", "a body on the ground",
                                     "a chain of 40", "a grid of 7 by 8"};
        for (int i = 0; i < 5; ++i) {
            setting s;
            begin(&s, sources[i], NULL, FINDERS[f], 3, size);
            holds(&s, names[i]);
            end(&s);
        }
    }
}

static double largest(const double *a, int count)
{
    double most = 0;
    for (int i = 0; i < count; ++i) {
        most = fmax(most, fabs(a[i]));
    }
    return most;
}

/* ---- The matrix and its factor -----------------------------------------------------------------
 */

/* Every block of the lower triangle, in the order of elimination, that the pattern has. */
static void assembled_equals_dense(setting *s, const char *name)
{
    const pe_pattern *pattern = &s->pattern;
    double *rest = malloc((size_t)(s->n * s->n + 1) * sizeof *rest),
           size = largest(s->h, s->n * s->n);
    assert_non_null(rest);
    memcpy(rest, s->h, (size_t)(s->n * s->n) * sizeof *rest);
    for (int k = 0; k < pattern->count; ++k) {
        for (int block = pattern->start[k]; block < pattern->start[k + 1]; ++block) {
            int column = 6 * pattern->order[k], row = 6 * pattern->order[pattern->row[block]];
            for (int i = 0; i < 6; ++i) {
                for (int j = 0; j < 6; ++j) {
                    double found = s->factor.block[block].column[j][i];
                    double expected = s->h[(row + i) * s->n + column + j];
                    if (!(fabs(found - expected) <= 1e-14 * size)) {
                        fail_msg("%s: (%d, %d): %.17g, dense %.17g", name, row + i, column + j,
                                 found, expected);
                    }
                    rest[(row + i) * s->n + column + j] = rest[(column + j) * s->n + row + i] = 0;
                }
            }
        }
    }
    assert_at_most(largest(rest, s->n * s->n), 0);
    free(rest);
}

static void test_assembled_blocks_equal_the_dense_matrix(void **state)
{
    (void)state;
    hold_everywhere(assembled_equals_dense, 30);
}

static double *draw_vector(uint64_t seed, int n)
{
    check_random random = {seed};
    double *b = malloc((size_t)(n + 6) * sizeof *b);
    assert_non_null(b);
    for (int i = 0; i < n; ++i) {
        b[i] = check_uniform(&random, -1, 1);
    }
    return b;
}

static void solve_equals_dense(setting *s, const char *name)
{
    double *b = draw_vector(5, s->n), *expected = draw_vector(5, s->n);
    double *x = draw_vector(6, s->n);
    assert_true(pe_factor_compute(&s->factor));
    pe_factor_solve(&s->factor, (const double(*)[6])b, (double(*)[6])x);
    /* The same array on both sides. */
    pe_factor_solve(&s->factor, (const double(*)[6])b, (double(*)[6])b);
    assert_memory_equal(x, b, (size_t)s->n * sizeof *x);
    dense_cholesky(s->h, s->n);
    dense_solve(s->h, s->n, expected);
    double size = largest(expected, s->n);
    for (int i = 0; i < s->n; ++i) {
        if (!(fabs(x[i] - expected[i]) <= 1e-10 * size)) {
            fail_msg("%s: x[%d]: %.17g, dense %.17g", name, i, x[i], expected[i]);
        }
    }
    free(b);
    free(x);
    free(expected);
}

static void test_factor_and_solve_equal_a_dense_solve(void **state)
{
    (void)state;
    hold_everywhere(solve_equals_dense, 30);
}

/* |H x - b| <= 1e-13 (|H| |x| + |b|): what backward stability promises whatever the condition. */
static void solve_is_backward_stable(setting *s, const char *name)
{
    double *b = draw_vector(5, s->n), *x = draw_vector(6, s->n);
    assert_true(pe_factor_compute(&s->factor));
    pe_factor_solve(&s->factor, (const double(*)[6])b, (double(*)[6])x);
    double size = s->n * largest(s->h, s->n * s->n) * largest(x, s->n) + largest(b, s->n);
    for (int i = 0; i < s->n; ++i) {
        double left = -b[i];
        for (int j = 0; j < s->n; ++j) {
            left += s->h[i * s->n + j] * x[j];
        }
        if (!(fabs(left) <= 1e-13 * size)) {
            fail_msg("%s: row %d: off by %g of %g", name, i, left, size);
        }
    }
    free(b);
    free(x);
}

static void test_hard_and_soft_contacts_factor_with_a_small_backward_error(void **state)
{
    (void)state;
    hold_everywhere(solve_is_backward_stable, 1e-6);
    hold_everywhere(solve_is_backward_stable, 1e6);
    hold_everywhere(solve_is_backward_stable, 1e10);
}

static void chain_of_200(pattern_finder find_pattern)
{
    setting s;
    begin(&s, chain_problem(200), NULL, find_pattern, 4, 30);
    assert_int_equal(s.pattern.depth, 200);
    assert_int_equal(s.pattern.start[200], 200 + 199); /* a chain fills nothing in */
    solve_equals_dense(&s, "a chain of 200");
    end(&s);
}

static void test_a_chain_of_200_is_solved_without_fill_in_in_either_order(void **state)
{
    (void)state;
    chain_of_200(pe_pattern_find);
    chain_of_200(breadth_first_pattern);
}

static void test_a_matrix_with_a_pivot_that_is_no_positive_number_is_refused(void **state)
{
    (void)state;
    for (int k = 0; k < 6; ++k) {
        setting s;
        begin(&s, chain_problem(5), NULL, pe_pattern_find, 4, 30);
        s.factor.block[s.pattern.start[3]].column[k][k] = k % 2 == 0 ? (double)NAN : -1e9;
        assert_false(pe_factor_compute(&s.factor));
        end(&s);
    }
}

/* ---- The pattern -------------------------------------------------------------------------------
 */

/* Which blocks of the dense factor are not zero, in the order of elimination. */
static bool *dense_blocks(const setting *s)
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

/* Multiplications and additions by the textbook, block by block: b^3/3 for a diagonal block, b^3
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

static void pattern_is_that_of_the_dense_factor(setting *s, const char *name)
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

static void test_pattern_has_the_blocks_of_the_dense_factor_and_counts_their_flops(void **state)
{
    (void)state;
    hold_everywhere(pattern_is_that_of_the_dense_factor, 30);
}

static void patches_couple_in_their_own_block(setting *s, const char *name)
{
    (void)name;
    const pe_pattern *pattern = &s->pattern;
    for (int i = 0; i < s->problem.patch_count; ++i) {
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

static void test_counted_patches_couple_their_two_bodies_and_no_others_do(void **state)
{
    (void)state;
    hold_everywhere(patches_couple_in_their_own_block, 30);
}

static void test_counting_every_patch_is_counting_none_out(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        setting all, each;
        pe_contact_problem *source = random_problem(seed);
        bool *counted = malloc((size_t)source->manifold_count + 1);
        assert_non_null(counted);
        memset(counted, true, (size_t)source->manifold_count + 1);
        begin(&all, random_problem(seed), NULL, pe_pattern_find, seed, 30);
        begin(&each, source, counted, pe_pattern_find, seed, 30);
        int bodies = all.pattern.count, blocks = all.pattern.start[bodies];
        assert_int_equal(each.pattern.start[bodies], blocks);
        assert_memory_equal(all.pattern.order, each.pattern.order, (size_t)bodies * sizeof(int));
        assert_memory_equal(all.pattern.row, each.pattern.row, (size_t)blocks * sizeof(int));
        assert_memory_equal(all.factor.block, each.factor.block, (size_t)blocks * sizeof(pe_block));
        end(&all);
        end(&each);
        free(counted);
    }
}

static int depth_of(pe_contact_problem *source, const bool *counted)
{
    setting s;
    begin(&s, source, counted, pe_pattern_find, 1, 30);
    int depth = s.pattern.depth;
    end(&s);
    return depth;
}

static void test_depth_is_the_longest_way_down_to_what_is_static(void **state)
{
    (void)state;
    assert_int_equal(depth_of(chain_problem(17), NULL), 17);
    assert_int_equal(depth_of(grid_problem(9, 4), NULL), 9);
    assert_int_equal(depth_of(problem_of_pairs(1, 1, NULL, 0), NULL), 1);
    const int loose[][2] = {{0, 1}, {1, 2}},
              bridge[][2] = {{PE_STATIC, 0}, {0, 1}, {1, 2}, {3, 2}, {3, PE_STATIC}};
    assert_int_equal(depth_of(problem_of_pairs(1, 3, loose, 2), NULL), 1);
    assert_int_equal(depth_of(problem_of_pairs(1, 4, bridge, 5), NULL), 2);
    const bool cut[] = {true, true, true, false, true};
    assert_int_equal(depth_of(problem_of_pairs(1, 4, bridge, 5), cut), 3);
}

/* A star: whoever begins in the middle couples all the others. */
static void test_either_order_leaves_the_hub_of_a_star_for_last_but_one(void **state)
{
    (void)state;
    enum { BODIES = 30 };
    pairs star = {.count = 0};
    for (int i = 1; i < BODIES; ++i) {
        pair_up(&star, 0, i);
    }
    for (int f = 0; f < FINDER_COUNT; ++f) {
        setting s;
        begin(&s, problem_of_pairs(3, BODIES, (const int(*)[2])star.list, star.count), NULL,
              FINDERS[f], 1, 30);
        assert_true(s.pattern.place[0] >= BODIES - 2);
        assert_int_equal(s.pattern.start[BODIES], 2 * BODIES - 1);
        end(&s);
    }
}

static void test_loaded_patches_are_those_that_carry_or_close(void **state)
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

static void test_without_memory_the_pattern_and_the_factor_say_so(void **state)
{
    (void)state;
    for (int f = 0; f < FINDER_COUNT; ++f) {
        pe_contact_problem *source = grid_problem(4, 4);
        pe_status status = PE_NO_MEMORY;
        for (long k = 1; status == PE_NO_MEMORY; ++k) {
            test_memory whole, scarce;
            pe_problem problem = solver_problem(source, test_memory_begin(&whole));
            pe_workspace work = test_memory_begin(&scarce);
            pe_pattern pattern;
            pe_factor factor;
            pe_error error = {0};
            scarce.fail_at = k;
            status = FINDERS[f](&problem, NULL, work, &pattern, &error);
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

/* ---- The residual ------------------------------------------------------------------------------
 */

static void test_residual_of_the_closed_form_of_a_resting_box_is_zero(void **state)
{
    (void)state;
    for (int i = 0; i < 4; ++i) {
        test_memory memory;
        double mass = pow(10, i - 1), friction = 0.25 * i;
        pe_contact_problem *source = problem_of_box_on_floor(mass, friction);
        for (int j = 0; j < 4; ++j) {
            source->points[j].impulse[0] = 0.25 * mass * GRAVITY * STEP;
        }
        pe_problem problem = solver_problem(source, test_memory_begin(&memory));
        pe_residual residual = pe_problem_residual(&problem);
        assert_at_most(residual.max, 1e-15);
        /* And off by what is missing: u_n = -g h/2 of half the impulse. */
        for (int j = 0; j < 4; ++j) {
            problem.impulse[j][0] *= 0.5;
        }
        pe_problem_rebuild_velocity(&problem);
        residual = pe_problem_residual(&problem);
        assert_close(residual.max, 0.5 * GRAVITY * STEP, 0, 1e-12);
        assert_close(residual.rms, 0.5 * GRAVITY * STEP, 0, 1e-12);
        pe_contact_problem_destroy(source);
        test_memory_end(&memory);
    }
}

/* Which way along the circle of unit generators the product with z grows. */
static double product_slope(const double z[3], double angle)
{
    return z[2] * cos(angle) - z[1] * sin(angle);
}

/* The point of the cone nearest to z: z itself, or the nearest on any of its generators, found by a
 * sweep of all directions and bisection next to the best. */
static void nearest_in_cone(double mu, const double z[3], double nearest[3])
{
    enum { DIRECTIONS = 64 };
    const double width = 2 * 3.14159265358979323846 / DIRECTIONS;
    double best = -HUGE_VAL, angle = 0;
    for (int i = 0; i < DIRECTIONS; ++i) {
        double product = z[1] * cos(i * width) + z[2] * sin(i * width);
        if (product > best) {
            best = product;
            angle = i * width;
        }
    }
    double low = angle - width, high = angle + width;
    for (int i = 0; i < 60; ++i) {
        angle = 0.5 * (low + high);
        *(product_slope(z, angle) > 0 ? &low : &high) = angle;
    }
    const double generator[3] = {1, mu * cos(angle), mu * sin(angle)};
    double along = fmax(0, pe_dot3(z, generator) / pe_dot3(generator, generator));
    bool inside = z[0] >= 0 && hypot(z[1], z[2]) <= mu * z[0];
    for (int k = 0; k < 3; ++k) {
        nearest[k] = inside ? z[k] : along * generator[k];
    }
}

static void test_residual_equals_the_distance_to_a_projection_found_by_search(void **state)
{
    (void)state;
    check_random random = {11};
    int moved[3] = {0};
    for (int i = 0; i < 20000; ++i) {
        double mu = i % 10 == 0 ? 0 : check_uniform(&random, 0, 1.5);
        double scale = pow(10, check_uniform(&random, -3, 3)), p[3], u[3], z[3], nearest[3];
        for (int k = 0; k < 3; ++k) {
            u[k] = check_uniform(&random, -1, 1);
            p[k] = check_uniform(&random, -1, 1) / scale;
        }
        p[1] = mu == 0 ? 0 : p[1];
        p[2] = mu == 0 ? 0 : p[2];
        double lifted = u[0] + mu * hypot(u[1], u[2]);
        z[0] = p[0] - lifted / scale;
        z[1] = mu == 0 ? 0 : p[1] - u[1] / scale;
        z[2] = mu == 0 ? 0 : p[2] - u[2] / scale;
        nearest_in_cone(mu, z, nearest);
        const double off[3] = {p[0] - nearest[0], p[1] - nearest[1], p[2] - nearest[2]};
        double found = pe_point_residual(mu, scale, p, u);
        assert_close(found, scale * sqrt(pe_dot3(off, off)), 1e-13, 1e-12);
        moved[nearest[0] == z[0] ? 0 : nearest[0] == 0 ? 1 : 2] += 1;
    }
    assert_true(moved[0] > 500 && moved[1] > 500 && moved[2] > 500);
}

/* trace of one point's J M^-1 J^T. */
static double dense_trace(const double *jacobian, const double *inverse_mass, int n, int point)
{
    double trace = 0;
    for (int row = 3 * point; row < 3 * point + 3; ++row) {
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                trace += jacobian[row * n + i] * inverse_mass[i * n + j] * jacobian[row * n + j];
            }
        }
    }
    return trace;
}

static void test_scale_of_a_point_is_a_third_of_the_dense_trace(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 30; ++seed) {
        test_memory memory;
        pe_contact_problem *source = random_problem(seed);
        pe_problem problem = solver_problem(source, test_memory_begin(&memory));
        double *jacobian = dense_jacobian(source), *inverse_mass = dense_inverse_mass(source);
        for (int j = 0; j < source->point_count; ++j) {
            double trace = dense_trace(jacobian, inverse_mass, 6 * source->body_count, j);
            assert_close(problem.point[j].scale, trace / 3, 0, 1e-13);
        }
        free(jacobian);
        free(inverse_mass);
        pe_contact_problem_destroy(source);
        test_memory_end(&memory);
    }
}

/* v - v* = M^-1 J^T p, and u = J v + b, by matrices. */
static void test_velocities_of_the_impulses_are_those_of_the_dense_matrices(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 30; ++seed) {
        test_memory memory;
        pe_contact_problem *source = random_problem(seed);
        pe_problem problem = solver_problem(source, test_memory_begin(&memory));
        int n = 6 * source->body_count;
        double *jacobian = dense_jacobian(source), *inverse_mass = dense_inverse_mass(source);
        double *push = draw_vector(1, n), *change = draw_vector(1, n);
        for (int i = 0; i < n; ++i) {
            push[i] = change[i] = 0;
            for (int row = 0; row < 3 * source->point_count; ++row) {
                push[i] += jacobian[row * n + i] * source->points[row / 3].impulse[row % 3];
            }
        }
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                change[i] += inverse_mass[i * n + j] * push[j];
            }
            assert_close(problem.velocity[i / 6][i % 6],
                         source->bodies[i / 6].free_velocity[i % 6] + change[i], 1e-12, 1e-13);
        }
        for (int i = 0; i < problem.patch_count; ++i) {
            const pe_patch *patch = &problem.patch[i];
            double q[6], u[3];
            pe_patch_twist(patch, (const double(*)[6])problem.velocity, q);
            for (int row = 3 * patch->first; row < 3 * (patch->first + patch->count); ++row) {
                double expected = row % 3 == 0 ? problem.point[row / 3].bias : 0;
                for (int k = 0; k < n; ++k) {
                    expected += jacobian[row * n + k] * problem.velocity[k / 6][k % 6];
                }
                pe_point_velocity(&problem.point[row / 3], q, u);
                assert_close(u[row % 3], expected, 1e-12, 1e-13);
            }
        }
        free(jacobian);
        free(inverse_mass);
        free(push);
        free(change);
        pe_contact_problem_destroy(source);
        test_memory_end(&memory);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_assembled_blocks_equal_the_dense_matrix),
        cmocka_unit_test(test_factor_and_solve_equal_a_dense_solve),
        cmocka_unit_test(test_hard_and_soft_contacts_factor_with_a_small_backward_error),
        cmocka_unit_test(test_a_chain_of_200_is_solved_without_fill_in_in_either_order),
        cmocka_unit_test(test_a_matrix_with_a_pivot_that_is_no_positive_number_is_refused),
        cmocka_unit_test(test_pattern_has_the_blocks_of_the_dense_factor_and_counts_their_flops),
        cmocka_unit_test(test_counted_patches_couple_their_two_bodies_and_no_others_do),
        cmocka_unit_test(test_counting_every_patch_is_counting_none_out),
        cmocka_unit_test(test_depth_is_the_longest_way_down_to_what_is_static),
        cmocka_unit_test(test_either_order_leaves_the_hub_of_a_star_for_last_but_one),
        cmocka_unit_test(test_loaded_patches_are_those_that_carry_or_close),
        cmocka_unit_test(test_without_memory_the_pattern_and_the_factor_say_so),
        cmocka_unit_test(test_residual_of_the_closed_form_of_a_resting_box_is_zero),
        cmocka_unit_test(test_residual_equals_the_distance_to_a_projection_found_by_search),
        cmocka_unit_test(test_scale_of_a_point_is_a_third_of_the_dense_trace),
        cmocka_unit_test(test_velocities_of_the_impulses_are_those_of_the_dense_matrices),
    };
    return cmocka_run_group_tests_name("engine_factor", tests, NULL, NULL);
}
