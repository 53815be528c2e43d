#include "factor.h"

#include <math.h>
#include <string.h>

/* WIDE_CLONES: the function is compiled for several instruction sets, and one is chosen when the
 * program is loaded. Every lane does the IEEE operation of scalar code, so that all give the same
 * bits. clang 14 does not link such a function if another file calls it; the sanitizers run before
 * the choice can be made. */
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__) &&       \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define WIDE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define WIDE_CLONES
#endif

#define INLINE static inline __attribute__((always_inline))

pe_status pe_factor_create(const pe_pattern *pattern, pe_workspace work, pe_factor *factor,
                           pe_error *error)
{
    int blocks = pattern->start[pattern->count];
    *factor = (pe_factor){
        .pattern = pattern,
        .block = pe_take(work, (size_t)blocks + 1, sizeof *factor->block),
        .right = pe_take(work, (size_t)pattern->count + 1, sizeof *factor->right),
        .pool = work.pool,
    };
    if (factor->block == NULL || factor->right == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for a factor of %d blocks", blocks);
    }
    return PE_OK;
}

/* ---- Assembly ---- */

/* r = [c] m, the cross product of c with each column of m. */
static void cross_columns(const double c[3], const double m[3][3], double r[3][3])
{
    for (int j = 0; j < 3; ++j) {
        /* NOLINTNEXTLINE(clang-analyzer-core.*): m is set, as only dynamic bodies are coupled */
        r[0][j] = c[1] * m[2][j] - c[2] * m[1][j];
        r[1][j] = c[2] * m[0][j] - c[0] * m[2][j];
        r[2][j] = c[0] * m[1][j] - c[1] * m[0][j];
    }
}

/* m := D^T m D with the rows of D the frame: from the manifold's axes to the world's. */
static void to_world(const double d[3][3], double m[3][3])
{
    double t[3][3];
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            t[i][j] = m[i][0] * d[0][j] + m[i][1] * d[1][j] + m[i][2] * d[2][j];
        }
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            m[i][j] = d[0][i] * t[0][j] + d[1][i] * t[1][j] + d[2][i] * t[2][j];
        }
    }
}

/* sum over a manifold's points of B^T G B with B = (1, -[s]): K = sum G, A = sum [s] G,
 * C = sum [s] G [s]^T, in the world's axes. False when every gain is 0. */
static bool sum_points(const pe_problem *problem, const pe_solver_manifold *manifold,
                       const pe_gain *gain, double k[3][3], double a[3][3], double c[3][3])
{
    double sum_k[6] = {0}, sum_c[6] = {0};
    memset(a, 0, 9 * sizeof(double));
    for (int i = manifold->first; i < manifold->first + manifold->count; ++i) {
        const double *g = gain[i], *s = problem->point[i].s;
        if (g[0] == 0 && g[3] == 0 && g[5] == 0) {
            continue;
        }
        const double full[3][3] = {{g[0], g[1], g[2]}, {g[1], g[3], g[4]}, {g[2], g[4], g[5]}};
        double sg[3][3];
        cross_columns(s, full, sg);
        for (int q = 0; q < 6; ++q) {
            sum_k[q] += g[q];
        }
        for (int p = 0; p < 3; ++p) {
            for (int q = 0; q < 3; ++q) {
                a[p][q] += sg[p][q];
            }
        }
        /* Row p of [s] G [s]^T is s x (row p of [s] G). */
        sum_c[0] += s[1] * sg[0][2] - s[2] * sg[0][1];
        sum_c[1] += s[2] * sg[0][0] - s[0] * sg[0][2];
        sum_c[2] += s[0] * sg[0][1] - s[1] * sg[0][0];
        sum_c[3] += s[2] * sg[1][0] - s[0] * sg[1][2];
        sum_c[4] += s[0] * sg[1][1] - s[1] * sg[1][0];
        sum_c[5] += s[0] * sg[2][1] - s[1] * sg[2][0];
    }
    if (sum_k[0] == 0 && sum_k[3] == 0 && sum_k[5] == 0) {
        return false;
    }
    static const int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (int p = 0; p < 3; ++p) {
        for (int q = 0; q < 3; ++q) {
            k[p][q] = sum_k[at[p][q]];
            c[p][q] = sum_c[at[p][q]];
        }
    }
    to_world(manifold->frame, k);
    to_world(manifold->frame, a);
    to_world(manifold->frame, c);
    return true;
}

/* The sum of a manifold, transported from its centre to one body's centre of mass at -arm:
 * lower = A + [arm] K, its transpose, and the moment X + [arm] lower^T, X = C - A [arm]. */
typedef struct transported {
    double lower[3][3], upper[3][3], moment[3][3];
} transported;

static void transport(const double arm[3], double k[3][3], double a[3][3], double c[3][3],
                      transported *to, double moment_at_arm[3][3])
{
    double turned[3][3];
    cross_columns(arm, (const double(*)[3])k, turned);
    for (int i = 0; i < 3; ++i) {
        /* Row i of A [arm] is (row i of A) x arm. */
        double ai_arm[3];
        pe_cross3(a[i], arm, ai_arm);
        for (int j = 0; j < 3; ++j) {
            to->lower[i][j] = a[i][j] + turned[i][j];
            to->upper[j][i] = to->lower[i][j];
            moment_at_arm[i][j] = c[i][j] - ai_arm[j];
        }
    }
    cross_columns(arm, (const double(*)[3])to->upper, turned);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            to->moment[i][j] = moment_at_arm[i][j] + turned[i][j];
        }
    }
}

/* Adds ((k, upper), (lower, moment)) to a diagonal block. */
static void add_diagonal(pe_block *block, double k[3][3], const transported *to)
{
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            block->column[j][i] += k[i][j];
            block->column[3 + j][i] += to->upper[i][j];
            block->column[j][3 + i] += to->lower[i][j];
            block->column[3 + j][3 + i] += to->moment[i][j];
        }
    }
}

/* Subtracts ((k, upper), (lower, corner)), the rows of body A and the columns of body B, from a
 * block that has it transposed if A is its column. */
static void subtract_coupling(pe_block *block, double k[3][3], double upper[3][3],
                              double lower[3][3], double corner[3][3], bool a_is_column)
{
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            if (a_is_column) {
                block->column[i][j] -= k[i][j];
                block->column[i][3 + j] -= upper[i][j];
                block->column[3 + i][j] -= lower[i][j];
                block->column[3 + i][3 + j] -= corner[i][j];
            } else {
                block->column[j][i] -= k[i][j];
                block->column[3 + j][i] -= upper[i][j];
                block->column[j][3 + i] -= lower[i][j];
                block->column[3 + j][3 + i] -= corner[i][j];
            }
        }
    }
}

static void add_mass(pe_block *block, const pe_inertia *m)
{
    const double *t = m->tensor;
    block->column[0] = (pe_lanes){m->mass};
    block->column[1] = (pe_lanes){0, m->mass};
    block->column[2] = (pe_lanes){0, 0, m->mass};
    block->column[3] = (pe_lanes){0, 0, 0, t[0], t[1], t[2]};
    block->column[4] = (pe_lanes){0, 0, 0, t[1], t[3], t[4]};
    block->column[5] = (pe_lanes){0, 0, 0, t[2], t[4], t[5]};
}

void pe_factor_assemble(pe_factor *factor, const pe_problem *problem, const pe_gain *gain)
{
    const pe_pattern *pattern = factor->pattern;
    memset(factor->block, 0, (size_t)pattern->start[pattern->count] * sizeof *factor->block);
    for (int i = 0; i < pattern->count; ++i) {
        add_mass(&factor->block[pattern->start[pattern->place[i]]], &problem->inertia[i]);
    }
    int statics = problem->body_count;
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        double k[3][3], a[3][3], c[3][3], at_a[3][3], at_b[3][3];
        transported to_a, to_b;
        if (!sum_points(problem, manifold, gain, k, a, c)) {
            continue;
        }
        if (manifold->a != statics) {
            transport(manifold->arm_a, k, a, c, &to_a, at_a);
            add_diagonal(&factor->block[pattern->start[pattern->place[manifold->a]]], k, &to_a);
        }
        if (manifold->b != statics) {
            transport(manifold->arm_b, k, a, c, &to_b, at_b);
            add_diagonal(&factor->block[pattern->start[pattern->place[manifold->b]]], k, &to_b);
        }
        if (pattern->couple[i] >= 0) {
            /* H_ab = -((K, upper_b), (lower_a, X_b + [arm_a] upper_b)) */
            double corner[3][3];
            cross_columns(manifold->arm_a, (const double(*)[3])to_b.upper, corner);
            for (int p = 0; p < 3; ++p) {
                for (int q = 0; q < 3; ++q) {
                    corner[p][q] += at_b[p][q];
                }
            }
            subtract_coupling(&factor->block[pattern->couple[i]], k, to_b.upper, to_a.lower, corner,
                              pattern->place[manifold->a] < pattern->place[manifold->b]);
        }
    }
}

/* ---- Factorisation ---- */

/* Factors a diagonal block and returns the inverses of its diagonal; false if a pivot is not
 * positive. */
INLINE bool factor_diagonal(pe_block *d, double inverse[6])
{
    for (int j = 0; j < 6; ++j) {
        double pivot = d->column[j][j];
        if (!(pivot > 0)) {
            return false;
        }
        inverse[j] = 1 / sqrt(pivot);
        d->column[j] *= inverse[j];
        for (int q = j + 1; q < 6; ++q) {
            d->column[q] -= d->column[j] * d->column[j][q];
        }
    }
    return true;
}

/* b := b L^-T, with L the factor of the column's diagonal block. */
INLINE void divide(pe_block *b, const pe_block *l, const double inverse[6])
{
    for (int j = 0; j < 6; ++j) {
        b->column[j] *= inverse[j];
        for (int q = j + 1; q < 6; ++q) {
            b->column[q] -= b->column[j] * l->column[j][q];
        }
    }
}

/* c := c - a b^T */
INLINE void subtract_product(pe_block *c, const pe_block *a, const pe_block *b)
{
    for (int j = 0; j < 6; ++j) {
        pe_lanes sum = c->column[j];
        for (int k = 0; k < 6; ++k) {
            sum -= a->column[k] * b->column[k][j];
        }
        c->column[j] = sum;
    }
}

/* Subtracts the products of column k that go to the columns of its blocks begin .. end - 1 below the
 * diagonal. */
INLINE void update_columns(const pe_factor *factor, int k, int begin, int end)
{
    const int *start = factor->pattern->start, *row = factor->pattern->row;
    pe_block *block = factor->block;
    const int first = start[k] + 1, last = start[k + 1];
    for (int y = first + begin; y < first + end; ++y) {
        int target = start[row[y]];
        for (int x = y; x < last; ++x) {
            while (row[target] != row[x]) {
                ++target;
            }
            subtract_product(&block[target], &block[x], &block[y]);
        }
    }
}

/* A column whose products the threads share. */
typedef struct wide_column {
    const pe_factor *factor;
    int k;
} wide_column;

WIDE_CLONES
static void update_piece(void *context, int worker, int begin, int end)
{
    (void)worker;
    const wide_column *c = context;
    update_columns(c->factor, c->k, begin, end);
}

/* A column of fewer blocks below the diagonal is not worth sharing; blocks of a piece. */
enum { WIDE = 32, GRAIN = 2 };

WIDE_CLONES
bool pe_factor_compute(pe_factor *factor)
{
    const pe_pattern *pattern = factor->pattern;
    const int *start = pattern->start;
    pe_block *block = factor->block;
    for (int k = 0; k < pattern->count; ++k) {
        double inverse[6];
        if (!factor_diagonal(&block[start[k]], inverse)) {
            return false;
        }
        int first = start[k] + 1, end = start[k + 1];
        for (int x = first; x < end; ++x) {
            divide(&block[x], &block[start[k]], inverse);
        }
        if (factor->pool == NULL || end - first < WIDE) {
            update_columns(factor, k, 0, end - first);
        } else {
            pe_pool_run(factor->pool, end - first, GRAIN, update_piece, &(wide_column){factor, k});
        }
    }
    return true;
}

/* ---- Solves ---- */

WIDE_CLONES
void pe_factor_solve(const pe_factor *factor, const double (*b)[6], double (*x)[6])
{
    const pe_pattern *pattern = factor->pattern;
    const int *start = pattern->start, *row = pattern->row;
    pe_lanes *z = factor->right;
    for (int k = 0; k < pattern->count; ++k) {
        const double *right = b[pattern->order[k]];
        z[k] = (pe_lanes){right[0], right[1], right[2], right[3], right[4], right[5], 0, 0};
    }
    for (int k = 0; k < pattern->count; ++k) {
        const pe_block *l = &factor->block[start[k]];
        for (int j = 0; j < 6; ++j) {
            z[k][j] /= l->column[j][j];
            for (int i = j + 1; i < 6; ++i) {
                z[k][i] -= l->column[j][i] * z[k][j];
            }
        }
        for (int i = start[k] + 1; i < start[k + 1]; ++i) {
            pe_lanes sum = z[row[i]];
            for (int j = 0; j < 6; ++j) {
                sum -= factor->block[i].column[j] * z[k][j];
            }
            z[row[i]] = sum;
        }
    }
    for (int k = pattern->count - 1; k >= 0; --k) {
        const pe_block *l = &factor->block[start[k]];
        for (int i = start[k] + 1; i < start[k + 1]; ++i) {
            for (int j = 0; j < 6; ++j) {
                pe_lanes t = factor->block[i].column[j] * z[row[i]];
                z[k][j] -= ((t[0] + t[1]) + (t[2] + t[3])) + (t[4] + t[5]);
            }
        }
        for (int j = 5; j >= 0; --j) {
            for (int i = j + 1; i < 6; ++i) {
                z[k][j] -= l->column[j][i] * z[k][i];
            }
            z[k][j] /= l->column[j][j];
        }
    }
    for (int k = 0; k < pattern->count; ++k) {
        for (int j = 0; j < 6; ++j) {
            x[pattern->order[k]][j] = z[k][j];
        }
    }
}
