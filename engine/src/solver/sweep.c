/* The layout of sweeps: colours, blocks, and the copy of a problem into them. */
#include "sweep.h"

#include <string.h>

/* Blocks of a piece, when the problem is copied. */
enum { FILL_GRAIN = 16 };

/* A colour of fewer blocks is not worth sharing. */
enum { SHARED_BLOCKS = 32 };

/* ---- Colours ---- */

/* Manifolds are sorted by colour, then by falling number of points, so that a block has few empty
 * lanes. A manifold that finds no colour free, on a body with more than 64 others, gets its own
 * block. Those that are left out come last. */
enum { MOST_COUNT = 8, OWN_BLOCK = PE_COLOURS * MOST_COUNT, LEFT_OUT, KEYS };

static int first_free(uint64_t used)
{
#if defined(__GNUC__)
    return ~used == 0 ? PE_COLOURS : __builtin_ctzll(~used);
#else
    int colour = 0;
    while (colour < PE_COLOURS && (used >> colour & 1) != 0) {
        ++colour;
    }
    return colour;
#endif
}

static int key_of(const pe_solver_manifold *manifold, int colour)
{
    int count = manifold->count < MOST_COUNT ? manifold->count : MOST_COUNT;
    return colour < PE_COLOURS ? colour * MOST_COUNT + (MOST_COUNT - count) : OWN_BLOCK;
}

/* A layout while it is made. */
typedef struct draft {
    pe_sweep *sweep;
    const bool *chosen; /* (manifold_count), or NULL */
    int *key;           /* (manifold_count): what manifolds are sorted by */
    int start[KEYS];    /* the place of the first manifold with a key */
} draft;

/* Fills d->key by greedy colouring, and counts the keys in d->start. `used` (body_count + 1) is
 * scratch. */
static void colour_manifolds(draft *d, uint64_t *used)
{
    const pe_problem *problem = d->sweep->problem;
    int n = problem->body_count;
    memset(used, 0, ((size_t)n + 1) * sizeof *used);
    memset(d->start, 0, sizeof d->start);
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        d->key[i] = LEFT_OUT;
        if (d->chosen == NULL || d->chosen[i]) {
            int colour = first_free(used[manifold->a] | used[manifold->b]);
            uint64_t bit = colour < PE_COLOURS ? (uint64_t)1 << colour : 0;
            used[manifold->a] |= manifold->a < n ? bit : 0;
            used[manifold->b] |= manifold->b < n ? bit : 0;
            d->key[i] = key_of(manifold, colour);
        }
        d->start[d->key[i]] += 1;
    }
}

/* Turns the counts of keys into places, and returns the number of blocks. */
static int place_keys(draft *d)
{
    int blocks = 0, lane = 0;
    for (int k = 0; k < OWN_BLOCK; ++k) {
        if (k % MOST_COUNT == 0 && lane > 0) {
            ++blocks; /* a new colour begins a new block */
            lane = 0;
        }
        int here = d->start[k];
        d->start[k] = PE_BLOCK_LANES * blocks + lane;
        blocks += (lane + here) / PE_BLOCK_LANES;
        lane = (lane + here) % PE_BLOCK_LANES;
    }
    blocks += lane > 0;
    int own = d->start[OWN_BLOCK];
    d->start[OWN_BLOCK] = PE_BLOCK_LANES * blocks;
    return blocks + own;
}

/* Fills sweep->place, sweep->source, and the blocks' numbers of points. */
static void place_manifolds(draft *d)
{
    pe_sweep *sweep = d->sweep;
    const pe_problem *problem = sweep->problem;
    for (int k = 0; k < sweep->block_count; ++k) {
        sweep->blocks[k].count = 0;
        for (int lane = 0; lane < PE_BLOCK_LANES; ++lane) {
            sweep->source[PE_BLOCK_LANES * k + lane] = -1;
        }
    }
    for (int i = 0; i < problem->manifold_count; ++i) {
        sweep->place[i] = -1;
        if (d->key[i] != LEFT_OUT) {
            int place = d->start[d->key[i]], count = problem->manifold[i].count;
            d->start[d->key[i]] += d->key[i] == OWN_BLOCK ? PE_BLOCK_LANES : 1;
            pe_sweep_block *block = &sweep->blocks[place / PE_BLOCK_LANES];
            block->count = count > block->count ? count : block->count;
            sweep->place[i] = place;
            sweep->source[place] = i;
        }
    }
}

/* Numbers the points and the colours of the blocks, and divides them into stages. */
static void number_blocks(const draft *d)
{
    pe_sweep *sweep = d->sweep;
    int begin = 0;
    for (int k = 0; k < sweep->block_count; ++k) {
        pe_sweep_block *block = &sweep->blocks[k];
        int i = sweep->source[PE_BLOCK_LANES * k];
        block->colour = d->key[i] < OWN_BLOCK ? d->key[i] / MOST_COUNT : PE_COLOURS + i;
        block->first = sweep->point_count;
        sweep->point_count += block->count;
        if (block->colour != sweep->blocks[begin].colour) {
            pe_stages_add(&sweep->stages, begin, k, k - begin >= SHARED_BLOCKS);
            begin = k;
        }
    }
    const int left = sweep->block_count - begin;
    pe_stages_add(&sweep->stages, begin, sweep->block_count, left >= SHARED_BLOCKS);
}

/* ---- Layout ---- */

/* The gap of a lane without a point: it never closes. */
#define FAR_AWAY 1e300

static void fill_manifold(const pe_problem *problem, const pe_solver_manifold *manifold,
                          pe_sweep_block *block, int lane)
{
    block->a[lane] = manifold->a;
    block->b[lane] = manifold->b;
    block->friction[lane] = manifold->friction;
    block->beta[lane] = 0;
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

/* Fills a lane of point `to` from point j of the problem; j < 0: the lane has none. */
static void fill_point(const pe_sweep *sweep, int to, int lane, int j)
{
    static const pe_solver_point NO_POINT = {.bias = FAR_AWAY};
    static const double NO_IMPULSE[3] = {0};
    const pe_solver_point *from = j < 0 ? &NO_POINT : &sweep->problem->point[j];
    const double *p = j < 0 ? NO_IMPULSE : sweep->problem->impulse[j];
    pe_sweep_point *point = &sweep->points[to];
    point->s[0][lane] = from->s[1];
    point->s[1][lane] = from->s[2];
    point->bias[lane] = from->bias;
    point->inverse_wnn[lane] = j < 0 ? 0 : 1;
    point->impulse[lane] = point->before[lane] = p[0];
    if (sweep->normals) {
        return;
    }
    pe_sweep_friction *friction = &sweep->frictions[to];
    pe_sweep_extra *extra = &sweep->extras[to];
    friction->s[lane] = from->s[0];
    for (int k = 0; k < 2; ++k) {
        friction->impulse[k][lane] = friction->before[k][lane] = p[1 + k];
        extra->slip[k][lane] = from->slip[k];
    }
    extra->scale[lane] = from->scale;
}

/* Makes a lane of one that has no manifold. */
static void clear_lane(const pe_sweep *sweep, pe_sweep_block *block, int lane)
{
    double *row = block->normal[0] + lane, *end = block->beta + PE_BLOCK_LANES;
    block->a[lane] = block->b[lane] = sweep->problem->body_count;
    for (; row < end; row += PE_BLOCK_LANES) {
        *row = 0;
    }
}

/* Fills and prepares blocks begin .. end - 1. */
static void fill_blocks(void *context, int worker, int begin, int end)
{
    (void)worker;
    pe_sweep *sweep = context;
    const pe_problem *problem = sweep->problem;
    for (int k = begin; k < end; ++k) {
        pe_sweep_block *block = &sweep->blocks[k];
        for (int lane = 0; lane < PE_BLOCK_LANES; ++lane) {
            const int i = sweep->source[PE_BLOCK_LANES * k + lane];
            const pe_solver_manifold *manifold = &problem->manifold[i < 0 ? 0 : i];
            const int count = i < 0 ? 0 : manifold->count;
            if (i < 0) {
                clear_lane(sweep, block, lane);
            } else {
                fill_manifold(problem, manifold, block, lane);
            }
            for (int j = 0; j < block->count; ++j) {
                fill_point(sweep, block->first + j, lane, j < count ? manifold->first + j : -1);
            }
        }
        sweep->kernel->prepare(sweep, k, k + 1);
    }
}

static void fill_bodies(const pe_sweep *sweep)
{
    const pe_problem *problem = sweep->problem;
    for (int i = 0; i <= problem->body_count; ++i) {
        const double *v = problem->velocity[i];
        sweep->velocity[i] = (pe_solver_body){.linear = {v[0], v[1], v[2]},
                                              .inverse_mass = problem->inertia[i].inverse_mass,
                                              .angular = {v[3], v[4], v[5]}};
        sweep->before[i] = sweep->velocity[i];
    }
}

static bool has_slip(const pe_problem *problem)
{
    bool found = false;
    for (int j = 0; j < problem->point_count && !found; ++j) {
        found = problem->point[j].slip[0] != 0 || problem->point[j].slip[1] != 0;
    }
    return found;
}

/* Takes the arrays whose sizes follow from the number of blocks, and then from that of points. */
static bool take_blocks(pe_workspace work, pe_sweep *sweep)
{
    const size_t blocks = (size_t)sweep->block_count + 1;
    sweep->blocks = pe_take(work, blocks, sizeof *sweep->blocks);
    sweep->worst = pe_take(work, blocks, sizeof *sweep->worst);
    sweep->source = pe_take(work, PE_BLOCK_LANES * blocks, sizeof *sweep->source);
    sweep->sums = pe_take(work, blocks / PE_SUM_GRAIN + 1, sizeof *sweep->sums);
    return sweep->blocks != NULL && sweep->worst != NULL && sweep->source != NULL &&
           sweep->sums != NULL;
}

static bool take_points(pe_workspace work, pe_sweep *sweep)
{
    const size_t points = (size_t)sweep->point_count + 1;
    sweep->points = pe_take(work, points, sizeof *sweep->points);
    if (!sweep->normals) {
        sweep->frictions = pe_take(work, points, sizeof *sweep->frictions);
        sweep->extras = pe_take(work, points, sizeof *sweep->extras);
    }
    return sweep->points != NULL &&
           (sweep->normals || (sweep->frictions != NULL && sweep->extras != NULL));
}

static pe_status create(const pe_problem *problem, const bool *chosen, bool normals,
                        const pe_sweep_kernel *kernel, pe_workspace work, pe_sweep *sweep,
                        pe_error *error)
{
    size_t manifolds = (size_t)problem->manifold_count + 1,
           bodies = (size_t)problem->body_count + 1;
    *sweep = (pe_sweep){
        .problem = problem,
        .kernel = kernel,
        .normals = normals,
        .velocity = pe_take(work, bodies, sizeof *sweep->velocity),
        .before = pe_take(work, bodies, sizeof *sweep->before),
        .beta = pe_take(work, bodies, sizeof *sweep->beta),
        .place = pe_take(work, manifolds, sizeof *sweep->place),
    };
    uint64_t *used = pe_take(work, bodies, sizeof *used);
    draft d = {.sweep = sweep, .chosen = chosen, .key = pe_take(work, manifolds, sizeof *d.key)};
    if (sweep->velocity == NULL || sweep->before == NULL || sweep->beta == NULL ||
        sweep->place == NULL || used == NULL || d.key == NULL) {
        goto no_memory;
    }
    colour_manifolds(&d, used);
    sweep->block_count = place_keys(&d);
    if (!take_blocks(work, sweep)) {
        goto no_memory;
    }
    place_manifolds(&d);
    number_blocks(&d);
    if (!take_points(work, sweep)) {
        goto no_memory;
    }
    fill_bodies(sweep);
    sweep->has_slip = !normals && has_slip(problem);
    pe_pool_run(problem->pool, sweep->block_count, FILL_GRAIN, fill_blocks, sweep);
    memset(sweep->beta, 0, bodies * sizeof *sweep->beta);
    return PE_OK;

no_memory:
    return pe_fail(error, PE_NO_MEMORY, "no memory to sweep %d contact points",
                   problem->point_count);
}

pe_status pe_sweep_create(const pe_problem *problem, const pe_sweep_kernel *kernel,
                          pe_workspace work, pe_sweep *sweep, pe_error *error)
{
    return create(problem, NULL, false, kernel, work, sweep, error);
}

pe_status pe_sweep_create_normals(const pe_problem *problem, const bool *chosen,
                                  const pe_sweep_kernel *kernel, pe_workspace work, pe_sweep *sweep,
                                  pe_error *error)
{
    return create(problem, chosen, true, kernel, work, sweep, error);
}
