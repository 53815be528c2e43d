/* The direct solver's matrix and its factor against dense ones. */
#include "breadth_first.h"
#include "check.h"
#include "factor_setting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double largest(const double *a, int count)
{
    double most = 0;
    for (int i = 0; i < count; ++i) {
        most = fmax(most, fabs(a[i]));
    }
    return most;
}

/* Every block of the pattern in the lower triangle, in the order of elimination. */
static void assembled_equals_dense(factor_setting *s, const char *name)
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

static void solve_equals_dense(factor_setting *s, const char *name)
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

/* |H x - b| <= 1e-13 (|H| |x| + |b|): backward stability, at every condition number. */
static void solve_is_backward_stable(factor_setting *s, const char *name)
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

static void test_backward_error_is_small_at_every_stiffness(void **state)
{
    (void)state;
    hold_everywhere(solve_is_backward_stable, 1e-6);
    hold_everywhere(solve_is_backward_stable, 1e6);
    hold_everywhere(solve_is_backward_stable, 1e10);
}

static void chain_of_200(pattern_finder find_pattern)
{
    factor_setting s;
    setting_begin(&s, problem_of_chain(200), NULL, find_pattern, 4, 30);
    assert_int_equal(s.pattern.depth, 200);
    assert_int_equal(s.pattern.start[200], 200 + 199); /* a chain has no fill-in */
    solve_equals_dense(&s, "a chain of 200");
    setting_end(&s);
}

static void test_chain_of_200_has_no_fill_in(void **state)
{
    (void)state;
    chain_of_200(pe_pattern_find);
    chain_of_200(breadth_first_pattern);
}

static void test_non_positive_pivot_is_refused(void **state)
{
    (void)state;
    for (int k = 0; k < 6; ++k) {
        factor_setting s;
        setting_begin(&s, problem_of_chain(5), NULL, pe_pattern_find, 4, 30);
        s.factor.block[s.pattern.start[3]].column[k][k] = k % 2 == 0 ? (double)NAN : -1e9;
        assert_false(pe_factor_compute(&s.factor));
        setting_end(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_assembled_blocks_equal_the_dense_matrix),
        cmocka_unit_test(test_factor_and_solve_equal_a_dense_solve),
        cmocka_unit_test(test_backward_error_is_small_at_every_stiffness),
        cmocka_unit_test(test_chain_of_200_has_no_fill_in),
        cmocka_unit_test(test_non_positive_pivot_is_refused),
    };
    return cmocka_run_group_tests_name("engine_factor", tests, NULL, NULL);
}
