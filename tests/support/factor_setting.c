#include "factor_setting.h"

#include "breadth_first.h"
#include "check.h"

#include <stdlib.h>
#include <string.h>

const pattern_finder PATTERN_FINDERS[] = {pe_pattern_find, breadth_first_pattern};

void pair_up(pair_list *to, int a, int b)
{
    assert_true(to->count < MOST_PAIRS);
    to->list[to->count][0] = a;
    to->list[to->count++][1] = b;
}

static int draw_index(check_random *random, int below)
{
    return (int)check_uniform(random, 0, below);
}

pe_contact_problem *problem_of_random_pairs(uint64_t seed)
{
    check_random random = {seed};
    int bodies = 1 + draw_index(&random, 12), manifolds = draw_index(&random, 3 * bodies);
    pair_list drawn = {.count = 0};
    for (int i = 0; i < manifolds; ++i) {
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

pe_contact_problem *problem_of_chain(int bodies)
{
    pair_list chain = {.count = 0};
    for (int i = 0; i < bodies; ++i) {
        pair_up(&chain, i - 1, i); /* the first with PE_STATIC */
    }
    return problem_of_pairs(7, bodies, (const int(*)[2])chain.list, chain.count);
}

pe_contact_problem *problem_of_grid(int rows, int columns)
{
    pair_list grid = {.count = 0};
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
 * friction (nn alone), that are open (all zero); zero where the manifold is not counted. */
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

void setting_begin(factor_setting *s, pe_contact_problem *source, const bool *counted,
                   pattern_finder find_pattern, uint64_t seed, double size)
{
    s->work = test_memory_begin(&s->memory);
    s->source = source;
    s->problem = solver_problem(source, s->work);
    s->n = 6 * source->body_count;
    size_t manifolds = (size_t)source->manifold_count;
    s->counted = pe_take(s->work, manifolds + 1, sizeof *s->counted);
    s->gain = pe_take(s->work, (size_t)source->point_count + 1, sizeof *s->gain);
    for (size_t i = 0; i < manifolds; ++i) {
        s->counted[i] = counted == NULL || counted[i];
    }
    check_random random = {seed + 1};
    draw_gains(&random, source, s->counted, size, s->gain);
    s->h = dense_matrix(source, (const pe_gain *)s->gain);
    assert_int_equal(find_pattern(&s->problem, counted, s->work, &s->pattern, NULL), PE_OK);
    assert_int_equal(pe_factor_create(&s->pattern, s->work, &s->factor, NULL), PE_OK);
    pe_factor_assemble(&s->factor, &s->problem, (const pe_gain *)s->gain);
}

void setting_end(factor_setting *s)
{
    free(s->h);
    pe_contact_problem_destroy(s->source);
    test_memory_end(&s->memory);
}

/* Draws which manifolds count; the caller frees it. */
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

void hold_everywhere(factor_law holds, double size)
{
    for (int f = 0; f < PATTERN_FINDER_COUNT; ++f) {
        for (uint64_t seed = 1; seed <= 60; ++seed) {
            factor_setting s;
            pe_contact_problem *source = problem_of_random_pairs(seed);
            bool *counted = draw_subset(seed, source->manifold_count);
            setting_begin(&s, source, seed % 2 == 0 ? counted : NULL, PATTERN_FINDERS[f], seed,
                          size);
            holds(&s, "random");
            setting_end(&s);
            free(counted);
        }
        pe_contact_problem *sources[] = {problem_of_pairs(1, 1, NULL, 0),
                                         problem_of_pairs(2, 5, NULL, 0), problem_of_chain(1),
                                         problem_of_chain(40), problem_of_grid(7, 8)};
        const char *const names[] = {"a body", "five bodies apart", "a body on the ground",
                                     "a chain of 40", "a grid of 7 by 8"};
        for (int i = 0; i < 5; ++i) {
            factor_setting s;
            setting_begin(&s, sources[i], NULL, PATTERN_FINDERS[f], 3, size);
            holds(&s, names[i]);
            setting_end(&s);
        }
    }
}

double *draw_vector(uint64_t seed, int n)
{
    check_random random = {seed};
    double *b = malloc((size_t)(n + 6) * sizeof *b);
    assert_non_null(b);
    for (int i = 0; i < n; ++i) {
        b[i] = check_uniform(&random, -1, 1);
    }
    return b;
}
