/* The symbolic factorisation: the graph of bodies, its elimination order, the elimination tree, and
 * the blocks of the factor. */
#include "pattern.h"

#include <string.h>

#ifdef PLUMB_HAVE_AMD
#include <suitesparse/amd.h>
#endif

/* ---- Elimination order ----
 *
 * A graph of `count` vertices: the neighbours of i are adjacent[start[i]] .. adjacent[start[i + 1]
 * - 1], each edge is listed at both ends. There are no double edges and no loops. Fills order
 * (count): order[k] is eliminated k-th. */

#ifdef PLUMB_HAVE_AMD

static pe_status find_order(int count, const int *start, const int *adjacent, pe_workspace work,
                            int *order, pe_error *error)
{
    size_t n = (size_t)count, edges = (size_t)start[count];
    size_t room = edges + edges / 5 + n + 1;
    int *p = pe_take(work, n + 1, sizeof *p), *length = pe_take(work, n + 1, sizeof *length);
    int *list = pe_take(work, room, sizeof *list);
    int *space = pe_take(work, 6 * n + 1, sizeof *space);
    if (p == NULL || length == NULL || list == NULL || space == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to order %d bodies", count);
    }
    memcpy(p, start, (n + 1) * sizeof *p);
    memcpy(list, adjacent, edges * sizeof *list);
    for (size_t i = 0; i < n; ++i) {
        length[i] = start[i + 1] - start[i];
    }
    /* Unlike amd_order, amd_2 takes its memory from the caller. It needs a clean pattern, which
     * this is. */
    amd_2(count, p, list, length, (int)room, (int)edges, space, space + n, order, space + 2 * n,
          space + 3 * n, space + 4 * n, space + 5 * n, NULL, NULL);
    return PE_OK;
}

#else

static pe_status find_order(int count, const int *start, const int *adjacent, pe_workspace work,
                            int *order, pe_error *error)
{
    char *seen = pe_take(work, (size_t)count + 1, sizeof *seen);
    if (seen == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to order %d bodies", count);
    }
    memset(seen, 0, (size_t)count);
    int queued = 0;
    for (int next = 0; next < count; ++next) {
        if (next == queued) { /* a component not reached yet: begin at its least degree */
            int root = -1;
            for (int i = 0; i < count; ++i) {
                if (!seen[i] &&
                    (root < 0 || start[i + 1] - start[i] < start[root + 1] - start[root])) {
                    root = i;
                }
            }
            seen[root] = 1;
            order[queued++] = root;
        }
        int i = order[next];
        for (int k = start[i]; k < start[i + 1]; ++k) {
            if (!seen[adjacent[k]]) {
                seen[adjacent[k]] = 1;
                order[queued++] = adjacent[k];
            }
        }
    }
    for (int i = 0; i < count / 2; ++i) {
        int swapped = order[i];
        order[i] = order[count - 1 - i];
        order[count - 1 - i] = swapped;
    }
    return PE_OK;
}

#endif

/* ---- The graph ---- */

/* The graph of bodies, with an edge for each pair that shares a manifold, and its elimination. */
typedef struct graph {
    int count;
    int *start, *adjacent; /* as find_order takes them */
    int *order, *place;    /* (count) each: the inverse of each other */
    int *parent;           /* (count): of each column in the elimination tree; -1 for a root */
    int *mark;             /* (count): scratch */
} graph;

static bool is_static(const pe_problem *problem, const pe_solver_manifold *manifold)
{
    return manifold->a == problem->body_count || manifold->b == problem->body_count;
}

static bool couples(const pe_problem *problem, const bool *counted, int manifold)
{
    return counted[manifold] && !is_static(problem, &problem->manifold[manifold]);
}

static pe_status find_graph(const pe_problem *problem, const bool *counted, pe_workspace work,
                            graph *g, pe_error *error)
{
    int n = problem->body_count;
    int *start = pe_take(work, (size_t)n + 2, sizeof *start);
    int *adjacent = pe_take(work, 2 * (size_t)problem->manifold_count + 1, sizeof *adjacent);
    *g = (graph){
        .count = n,
        .start = start,
        .adjacent = adjacent,
        .order = pe_take(work, (size_t)n + 1, sizeof *g->order),
        .place = pe_take(work, (size_t)n + 1, sizeof *g->place),
        .parent = pe_take(work, (size_t)n + 1, sizeof *g->parent),
        .mark = pe_take(work, (size_t)n + 1, sizeof *g->mark),
    };
    int *seen_by = g->mark;
    if (start == NULL || adjacent == NULL || g->order == NULL || g->place == NULL ||
        g->parent == NULL || g->mark == NULL) {
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
    /* Several manifolds may join the same pair: keep one edge. */
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
    return PE_OK;
}

/* Parents in the elimination tree: the first row below the diagonal of each column of the factor
 * (Liu 1990). */
static void find_parents(const graph *g)
{
    int *ancestor = g->mark;
    for (int i = 0; i < g->count; ++i) {
        int body = g->order[i];
        g->parent[i] = ancestor[i] = -1;
        for (int k = g->start[body]; k < g->start[body + 1]; ++k) {
            int j = g->place[g->adjacent[k]];
            while (j >= 0 && j < i) {
                int next = ancestor[j];
                ancestor[j] = i;
                if (next < 0) {
                    g->parent[j] = i;
                }
                j = next;
            }
        }
    }
}

/* Row i of the factor is the union of the tree's paths from its neighbours up to i. Adds 1 to
 * next[column] for each block of the row; if `row` is not NULL, row[next[column]] is set to i
 * before. */
static void walk_rows(const graph *g, int *next, int *row)
{
    for (int i = 0; i < g->count; ++i) {
        g->mark[i] = -1;
    }
    for (int i = 0; i < g->count; ++i) {
        int body = g->order[i];
        g->mark[i] = i;
        for (int k = g->start[body]; k < g->start[body + 1]; ++k) {
            int j = g->place[g->adjacent[k]];
            for (; j < i && g->mark[j] != i; j = g->parent[j]) {
                g->mark[j] = i;
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
        int at = (low + high) / 2;
        if (row[at] < wanted) {
            low = at + 1;
        } else {
            high = at;
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

/* Breadth first from the bodies that touch something static. `queue` (count) is scratch. */
static int find_depth(const pe_problem *problem, const graph *g, int *queue)
{
    int n = problem->body_count, queued = 0, depth = 1, *level = g->mark;
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
    size_t bodies = (size_t)n + 1, manifolds = (size_t)problem->manifold_count;
    bool *kept = pe_take(work, manifolds + 1, sizeof *kept);
    int *couple = pe_take(work, manifolds + 1, sizeof *couple);
    int *start = pe_take(work, bodies, sizeof *start), *next = pe_take(work, bodies, sizeof *next);
    if (kept == NULL || couple == NULL || start == NULL || next == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the factor of %d bodies", n);
    }
    if (counted != NULL) {
        memcpy(kept, counted, manifolds * sizeof *kept);
    } else {
        memset(kept, true, manifolds * sizeof *kept);
    }
    graph g;
    pe_status status = find_graph(problem, kept, work, &g, error);
    if (status == PE_OK) {
        status = find_order(n, g.start, g.adjacent, work, g.order, error);
    }
    if (status != PE_OK) {
        return status;
    }
    for (int k = 0; k < n; ++k) {
        g.place[g.order[k]] = k;
    }
    find_parents(&g);
    memset(next, 0, bodies * sizeof *next);
    walk_rows(&g, next, NULL);
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
    walk_rows(&g, next, row);
    for (int k = 0; k < problem->manifold_count; ++k) {
        couple[k] = -1;
        if (couples(problem, kept, k)) {
            int p = g.place[problem->manifold[k].a], q = g.place[problem->manifold[k].b];
            couple[k] = find_block(start, row, p < q ? p : q, p < q ? q : p);
        }
    }
    *pattern = (pe_pattern){
        .count = n,
        .order = g.order,
        .place = g.place,
        .start = start,
        .row = row,
        .couple = couple,
        .counted = kept,
        .depth = find_depth(problem, &g, next),
        .mass_ratio = pe_pattern_mass_ratio(problem),
        .flops = count_flops(start, n),
    };
    return PE_OK;
}
