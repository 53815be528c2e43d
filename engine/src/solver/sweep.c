/* The layout of sweeps: colours, blocks, and the copy of a problem into them. */
#include "sweep.h"

#include <string.h>

/* ---- Colours ---- */

/* Manifolds are sorted by colour, then by falling number of points, so that a block has few empty
 * lanes. A manifold that finds no colour free, on a body with more than 64 others, gets its own
 * block. */
enum { MOST_COLOURS = 64, MOST_COUNT = 8, KEYS = MOST_COLOURS * MOST_COUNT };

static int first_free(uint64_t used)
{
    int colour = 0;
    while (colour < MOST_COLOURS && (used >> colour & 1) != 0) {
        ++colour;
    }
    return colour;
}

static int key_of(const pe_solver_manifold *manifold, int colour)
{
    int count = manifold->count < MOST_COUNT ? manifold->count : MOST_COUNT;
    return colour * MOST_COUNT + (MOST_COUNT - count);
}

/* Fills key (manifold_count) by greedy colouring. `used` (body_count + 1) is scratch. */
static void colour_manifolds(const pe_problem *problem, uint64_t *used, int *key)
{
    int n = problem->body_count;
    memset(used, 0, ((size_t)n + 1) * sizeof *used);
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        int colour = first_free(used[manifold->a] | used[manifold->b]);
        if (colour < MOST_COLOURS) {
            uint64_t bit = (uint64_t)1 << colour;
            used[manifold->a] |= manifold->a < n ? bit : 0;
            used[manifold->b] |= manifold->b < n ? bit : 0;
        }
        key[i] = key_of(manifold, colour);
    }
}

/* Fills place (manifold_count) and returns the number of blocks. */
static int place_manifolds(const pe_problem *problem, const int *key, int *place)
{
    int start[KEYS + 1] = {0}, blocks = 0, lane = 0;
    for (int i = 0; i < problem->manifold_count; ++i) {
        start[key[i] < KEYS ? key[i] : KEYS] += 1;
    }
    for (int k = 0; k < KEYS; ++k) {
        if (k % MOST_COUNT == 0 && lane > 0) {
            ++blocks; /* a new colour begins a new block */
            lane = 0;
        }
        int here = start[k];
        start[k] = PE_BLOCK_LANES * blocks + lane;
        blocks += (lane + here) / PE_BLOCK_LANES;
        lane = (lane + here) % PE_BLOCK_LANES;
    }
    blocks += lane > 0;
    start[KEYS] = PE_BLOCK_LANES * blocks;
    for (int i = 0; i < problem->manifold_count; ++i) {
        if (key[i] < KEYS) {
            place[i] = start[key[i]]++;
        } else {
            place[i] = PE_BLOCK_LANES * blocks++;
        }
    }
    return blocks;
}

/* ---- Layout ---- */

/* The gap of a lane without a point: it never closes. */
static const double FAR_AWAY = 1e300;

static void fill_manifold(const pe_problem *problem, const pe_solver_manifold *manifold,
                          pe_sweep_block *block, int lane)
{
    block->a[lane] = manifold->a;
    block->b[lane] = manifold->b;
    block->friction[lane] = manifold->friction;
    for (int k = 0; k < 3; ++k) {
        block->normal[k][lane] = manifold->frame[0][k];
        block->tangent[k][lane] = manifold->frame[1][k];
        block->arm_a[k][lane] = manifold->arm_a[k];
        block->arm_b[k][lane] = manifold->arm_b[k];
    }
    for (int k = 0; k < 6; ++k) {
        block->inverse_inertia_a[k][lane] = problem->inertia[manifold->a].inverse_tensor[k];
        block->inverse_inertia_b[k][lane] = problem->inertia[manifold->b].inverse_tensor[k];
    }
}

static void fill_point(const pe_solver_point *from, const double p[3], pe_sweep_point *point,
                       int lane)
{
    for (int k = 0; k < 3; ++k) {
        point->s[k][lane] = from->s[k];
        point->impulse[k][lane] = p[k];
        point->before[k][lane] = p[k];
    }
    point->bias[lane] = from->bias;
    point->slip[0][lane] = from->slip[0];
    point->slip[1][lane] = from->slip[1];
    point->scale[lane] = from->scale;
    point->inverse_wnn[lane] = 1;
}

/* Sets the number of points of each block, and returns their sum. */
static int count_points(const pe_sweep *sweep)
{
    const pe_problem *problem = sweep->problem;
    for (int i = 0; i < problem->manifold_count; ++i) {
        pe_sweep_block *block = &sweep->blocks[sweep->place[i] / PE_BLOCK_LANES];
        int count = problem->manifold[i].count;
        block->count = count > block->count ? count : block->count;
    }
    int points = 0;
    for (int k = 0; k < sweep->block_count; ++k) {
        sweep->blocks[k].first = points;
        points += sweep->blocks[k].count;
    }
    return points;
}

static void fill(pe_sweep *sweep, const int *key)
{
    const pe_problem *problem = sweep->problem;
    memset(sweep->points, 0, (size_t)sweep->point_count * sizeof *sweep->points);
    for (int i = 0; i < sweep->point_count; ++i) {
        for (int lane = 0; lane < PE_BLOCK_LANES; ++lane) {
            sweep->points[i].bias[lane] = FAR_AWAY;
        }
    }
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        int lane = sweep->place[i] % PE_BLOCK_LANES;
        pe_sweep_block *block = &sweep->blocks[sweep->place[i] / PE_BLOCK_LANES];
        block->colour = key[i] < KEYS ? key[i] / MOST_COUNT : MOST_COLOURS + i;
        fill_manifold(problem, manifold, block, lane);
        for (int j = 0; j < manifold->count; ++j) {
            fill_point(&problem->point[manifold->first + j], problem->impulse[manifold->first + j],
                       &sweep->points[block->first + j], lane);
        }
    }
    for (int i = 0; i <= problem->body_count; ++i) {
        const double *v = problem->velocity[i];
        sweep->velocity[i] = (pe_solver_body){.linear = {v[0], v[1], v[2]},
                                              .inverse_mass = problem->inertia[i].inverse_mass,
                                              .angular = {v[3], v[4], v[5]}};
        sweep->before[i] = sweep->velocity[i];
    }
}

pe_status pe_sweep_create(const pe_problem *problem, const pe_sweep_kernel *kernel,
                          pe_workspace work, pe_sweep *sweep, pe_error *error)
{
    size_t manifolds = (size_t)problem->manifold_count + 1,
           bodies = (size_t)problem->body_count + 1;
    *sweep = (pe_sweep){
        .problem = problem,
        .kernel = kernel,
        .velocity = pe_take(work, bodies, sizeof *sweep->velocity),
        .before = pe_take(work, bodies, sizeof *sweep->before),
        .beta = pe_take(work, bodies, sizeof *sweep->beta),
        .place = pe_take(work, manifolds, sizeof *sweep->place),
    };
    uint64_t *used = pe_take(work, bodies, sizeof *used);
    int *key = pe_take(work, manifolds, sizeof *key);
    if (sweep->velocity == NULL || sweep->before == NULL || sweep->beta == NULL ||
        sweep->place == NULL || used == NULL || key == NULL) {
        goto no_memory;
    }
    colour_manifolds(problem, used, key);
    sweep->block_count = place_manifolds(problem, key, sweep->place);
    sweep->blocks = pe_take(work, (size_t)sweep->block_count + 1, sizeof *sweep->blocks);
    sweep->worst = pe_take(work, (size_t)sweep->block_count + 1, sizeof *sweep->worst);
    if (sweep->blocks == NULL || sweep->worst == NULL) {
        goto no_memory;
    }
    memset(sweep->beta, 0, bodies * sizeof *sweep->beta);
    memset(sweep->blocks, 0, (size_t)sweep->block_count * sizeof *sweep->blocks);
    for (int k = 0; k < sweep->block_count; ++k) {
        for (int lane = 0; lane < PE_BLOCK_LANES; ++lane) {
            sweep->blocks[k].a[lane] = sweep->blocks[k].b[lane] = problem->body_count;
        }
    }
    sweep->point_count = count_points(sweep);
    sweep->points = pe_take(work, (size_t)sweep->point_count + 1, sizeof *sweep->points);
    if (sweep->points == NULL) {
        goto no_memory;
    }
    fill(sweep, key);
    kernel->prepare(sweep);
    return PE_OK;

no_memory:
    return pe_fail(error, PE_NO_MEMORY, "no memory to sweep %d contact points",
                   problem->point_count);
}

pe_sweep_part pe_sweep_whole(const pe_sweep *sweep)
{
    const pe_problem *problem = sweep->problem;
    return (pe_sweep_part){0, problem->body_count, 0, problem->manifold_count};
}

void pe_sweep_set_beta(const pe_sweep *sweep, const pe_sweep_part *part, double beta)
{
    for (int i = 0; i < part->body_count; ++i) {
        sweep->beta[part->body + i] = beta;
    }
    for (int i = 0; i < part->manifold_count; ++i) {
        int place = sweep->place[part->manifold + i];
        sweep->blocks[place / PE_BLOCK_LANES].beta[place % PE_BLOCK_LANES] = beta;
    }
}

void pe_sweep_residuals(const pe_sweep *sweep, const pe_sweep_part *parts, int count,
                        double *residuals)
{
    sweep->kernel->residuals(sweep);
    for (int k = 0; k < count; ++k) {
        residuals[k] = 0;
        for (int i = 0; i < parts[k].manifold_count; ++i) {
            int place = sweep->place[parts[k].manifold + i];
            double worst = sweep->worst[place / PE_BLOCK_LANES][place % PE_BLOCK_LANES];
            residuals[k] = worst > residuals[k] ? worst : residuals[k];
        }
    }
}

void pe_sweep_store(const pe_sweep *sweep, const pe_sweep_part *part)
{
    const pe_problem *problem = sweep->problem;
    for (int i = part->manifold; i < part->manifold + part->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        int lane = sweep->place[i] % PE_BLOCK_LANES;
        int first = sweep->blocks[sweep->place[i] / PE_BLOCK_LANES].first;
        for (int j = 0; j < manifold->count; ++j) {
            for (int k = 0; k < 3; ++k) {
                problem->impulse[manifold->first + j][k] =
                    sweep->points[first + j].impulse[k][lane];
            }
        }
    }
}
