#include "pattern.h"

#include "order.h"

#include <string.h>

/* The graph of bodies: an edge for each pair that shares a manifold. */
typedef struct graph {
    int *start, *adjacent; /* as pe_order_find takes them */
} graph;

static bool is_static(const pe_problem *problem, const pe_solver_manifold *manifold)
{
    return manifold->a == problem->body_count || manifold->b == problem->body_count;
}

static bool couples(const pe_problem *problem, const bool *counted, int manifold)
{
    return counted[manifold] && !is_static(problem, &problem->manifold[manifold]);
}

static pe_status graph_of(const pe_problem *problem, const bool *counted, pe_workspace work,
                          graph *g, pe_error *error)
{
    int n = problem->body_count;
    int *start = pe_take(work, (size_t)n + 2, sizeof *start);
    int *adjacent = pe_take(work, 2 * (size_t)problem->manifold_count + 1, sizeof *adjacent);
    int *seen_by = pe_take(work, (size_t)n + 1, sizeof *seen_by);
    if (start == NULL || adjacent == NULL || seen_by == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the pairs of %d bodies", n);
    }
    /* Counting sort of both ends; start[i + 2] counts, so that filling leaves start[i] right. */
    memset(start, 0, ((size_t)n + 2) * sizeof *start);
    for (int k = 0; k < problem->manifold_count; ++k) {
        const pe_solver_manifold *manifold = &problem->manifold[k];
        if (couples(problem, counted, k)) {
            start[manifold->a + 2] += 1;
            start[manifold->b + 2] += 1;
        }
    }
    for (int i = 0; i < n; ++i) {
        start[i + 2] += start[i + 1];
    }
    for (int k = 0; k < problem->manifold_count; ++k) {
        const pe_solver_manifold *manifold = &problem->manifold[k];
        if (couples(problem, counted, k)) {
            adjacent[start[manifold->a + 1]++] = manifold->b;
            adjacent[start[manifold->b + 1]++] = manifold->a;
        }
    }
    /* Two manifolds may join the same pair: keep one edge. */
    int kept = 0;
    for (int i = 0; i < n; ++i) {
        seen_by[i] = -1;
    }
    for (int i = 0; i < n; ++i) {
        int from = start[i];
        start[i] = kept;
        for (int k = from; k < start[i + 1]; ++k) {
            if (seen_by[adjacent[k]] != i) {
                seen_by[adjacent[k]] = i;
                adjacent[kept++] = adjacent[k];
            }
        }
    }
    start[n] = kept;
    *g = (graph){start, adjacent};
    return PE_OK;
}

/* Parents in the elimination tree: the first row below the diagonal of each column of the factor
 * (Liu 1990). */
static void find_parents(const graph *g, int n, const int *order, const int *place, int *parent,
                         int *ancestor)
{
    for (int i = 0; i < n; ++i) {
        parent[i] = ancestor[i] = -1;
        for (int k = g->start[order[i]]; k < g->start[order[i] + 1]; ++k) {
            int j = place[g->adjacent[k]];
            while (j >= 0 && j < i) {
                int next = ancestor[j];
                ancestor[j] = i;
                if (next < 0) {
                    parent[j] = i;
                }
                j = next;
            }
        }
    }
}

/* Row i of the factor is the union of the tree's paths from its neighbours up to i. Counts its
 * blocks in count[column], or, when `row` is given, appends i to each of those columns. */
static void walk_rows(const graph *g, int n, const int *order, const int *place, const int *parent,
                      int *mark, int *next, int *row)
{
    for (int i = 0; i < n; ++i) {
        mark[i] = -1;
    }
    for (int i = 0; i < n; ++i) {
        mark[i] = i;
        for (int k = g->start[order[i]]; k < g->start[order[i] + 1]; ++k) {
            int j = place[g->adjacent[k]];
            for (; j < i && mark[j] != i; j = parent[j]) {
                mark[j] = i;
                if (row != NULL) {
                    row[next[j]] = i;
                }
                next[j] += 1;
            }
        }
    }
}

static int find_block(const int *start, const int *row, int column, int wanted)
{
    int low = start[column], high = start[column + 1] - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (row[middle] < wanted) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* Multiplications and additions of one factorisation in 6 x 6 blocks. */
static double count_flops(const int *start, int n)
{
    double flops = 0;
    for (int k = 0; k < n; ++k) {
        double below = start[k + 1] - start[k] - 1;
        flops += 72 + 216 * below + 216 * below * (below + 1);
    }
    return flops;
}

/* Breadth first from the bodies that touch something static. `queue` and `level` are scratch. */
static int find_depth(const pe_problem *problem, const graph *g, int *queue, int *level)
{
    int n = problem->body_count, queued = 0, depth = 1;
    for (int i = 0; i < n; ++i) {
        level[i] = 0;
    }
    for (int k = 0; k < problem->manifold_count; ++k) {
        const pe_solver_manifold *manifold = &problem->manifold[k];
        int body = manifold->a == n ? manifold->b : manifold->a;
        if (is_static(problem, manifold) && level[body] == 0) {
            level[body] = 1;
            queue[queued++] = body;
        }
    }
    for (int next = 0; next < queued; ++next) {
        int i = queue[next];
        depth = level[i] > depth ? level[i] : depth;
        for (int k = g->start[i]; k < g->start[i + 1]; ++k) {
            if (level[g->adjacent[k]] == 0) {
                level[g->adjacent[k]] = level[i] + 1;
                queue[queued++] = g->adjacent[k];
            }
        }
    }
    return depth;
}

double pe_pattern_mass_ratio(const pe_problem *problem)
{
    double least = problem->inertia[0].mass, most = least;
    for (int i = 1; i < problem->body_count; ++i) {
        double mass = problem->inertia[i].mass;
        least = mass < least ? mass : least;
        most = mass > most ? mass : most;
    }
    return least / most;
}

int pe_pattern_mark_loaded(const pe_problem *problem, double speed, bool *loaded)
{
    int points = 0;
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        double q[6], u[3];
        pe_solver_manifold_twist(manifold, (const double(*)[6])problem->velocity, q);
        loaded[i] = false;
        for (int j = manifold->first; j < manifold->first + manifold->count && !loaded[i]; ++j) {
            pe_point_velocity(&problem->point[j], q, u);
            loaded[i] = problem->impulse[j][0] > 0 || u[0] < -speed;
        }
        points += loaded[i] ? manifold->count : 0;
    }
    return points;
}

pe_status pe_pattern_find(const pe_problem *problem, const bool *counted, pe_workspace work,
                          pe_pattern *pattern, pe_error *error)
{
    int n = problem->body_count;
    size_t bodies = (size_t)n + 1;
    size_t manifolds = (size_t)problem->manifold_count;
    bool *kept = pe_take(work, manifolds + 1, sizeof *kept);
    if (kept == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the factor of %d bodies", n);
    }
    if (counted != NULL) {
        memcpy(kept, counted, manifolds * sizeof *kept);
    } else {
        memset(kept, true, manifolds * sizeof *kept);
    }
    graph g = {0};
    pe_status status = graph_of(problem, kept, work, &g, error);
    int *order = pe_take(work, bodies, sizeof *order),
        *place = pe_take(work, bodies, sizeof *place);
    int *start = pe_take(work, bodies, sizeof *start), *next = pe_take(work, bodies, sizeof *next);
    int *parent = pe_take(work, bodies, sizeof *parent),
        *mark = pe_take(work, bodies, sizeof *mark);
    int *couple = pe_take(work, manifolds + 1, sizeof *couple);
    if (status == PE_OK && (order == NULL || place == NULL || start == NULL || next == NULL ||
                            parent == NULL || mark == NULL || couple == NULL)) {
        status = pe_fail(error, PE_NO_MEMORY, "no memory for the factor of %d bodies", n);
    }
    if (status == PE_OK) {
        status = pe_order_find(n, g.start, g.adjacent, work, order, error);
    }
    if (status != PE_OK) {
        return status;
    }
    for (int k = 0; k < n; ++k) {
        place[order[k]] = k;
    }
    find_parents(&g, n, order, place, parent, mark);
    memset(next, 0, bodies * sizeof *next);
    walk_rows(&g, n, order, place, parent, mark, next, NULL);
    start[0] = 0;
    for (int k = 0; k < n; ++k) {
        start[k + 1] = start[k] + 1 + next[k];
        next[k] = start[k] + 1;
    }
    int *row = pe_take(work, (size_t)start[n] + 1, sizeof *row);
    if (row == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the %d blocks of a factor", start[n]);
    }
    for (int k = 0; k < n; ++k) {
        row[start[k]] = k;
    }
    walk_rows(&g, n, order, place, parent, mark, next, row);
    for (int k = 0; k < problem->manifold_count; ++k) {
        const pe_solver_manifold *manifold = &problem->manifold[k];
        couple[k] = -1;
        if (couples(problem, kept, k)) {
            int p = place[manifold->a], q = place[manifold->b];
            couple[k] = find_block(start, row, p < q ? p : q, p < q ? q : p);
        }
    }
    *pattern = (pe_pattern){
        .count = n,
        .order = order,
        .place = place,
        .start = start,
        .row = row,
        .couple = couple,
        .counted = kept,
        .depth = find_depth(problem, &g, next, mark),
        .mass_ratio = pe_pattern_mass_ratio(problem),
        .flops = count_flops(start, n),
    };
    return PE_OK;
}
