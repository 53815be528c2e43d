/* Sweeps over all blocks, colour by colour, and what is read of them. */
#include "sweep.h"

/* Blocks, bodies and manifolds of a piece. */
enum { SWEEP_GRAIN = 8, BODY_GRAIN = 512, MANIFOLD_GRAIN = 256 };

pe_sweep_part pe_sweep_whole(const pe_sweep *sweep)
{
    const pe_problem *problem = sweep->problem;
    return (pe_sweep_part){0, problem->body_count, 0, problem->manifold_count};
}

static bool is_whole(const pe_sweep *sweep, const pe_sweep_part *part)
{
    return part->manifold_count == sweep->problem->manifold_count;
}

void pe_sweep_set_beta(pe_sweep *sweep, const pe_sweep_part *part, double beta)
{
    sweep->one_beta = is_whole(sweep, part);
    if (sweep->one_beta) {
        sweep->whole_beta = beta;
        return;
    }
    for (int i = 0; i < part->body_count; ++i) {
        sweep->beta[part->body + i] = beta;
    }
    for (int i = 0; i < part->manifold_count; ++i) {
        int place = sweep->place[part->manifold + i];
        sweep->blocks[place / PE_BLOCK_LANES].beta[place % PE_BLOCK_LANES] = beta;
    }
}

/* ---- Sweeps ---- */

/* Work on blocks or bodies. */
typedef struct pieces {
    pe_sweep *sweep;
    void (*work)(pe_sweep *sweep, int begin, int end);
} pieces;

static void run_piece(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pieces *p = context;
    p->work(p->sweep, begin, end);
}

static void sweep_by(pe_sweep *sweep, void (*work)(pe_sweep *sweep, int begin, int end))
{
    pe_pool *pool = sweep->problem->pool;
    pieces bodies = {sweep, sweep->kernel->extrapolate}, blocks = {sweep, work};
    pe_pool_run(pool, sweep->problem->body_count + 1, BODY_GRAIN, run_piece, &bodies);
    pe_stages_run(&sweep->stages, pool, SWEEP_GRAIN, run_piece, &blocks);
}

void pe_sweep_cones(pe_sweep *sweep)
{
    sweep_by(sweep, sweep->kernel->sweep_cones);
}

void pe_sweep_normals(pe_sweep *sweep)
{
    sweep_by(sweep, sweep->kernel->sweep_normals);
}

/* ---- Results ---- */

static void find_residuals(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pe_sweep *sweep = context;
    sweep->kernel->residuals(sweep, begin, end);
}

/* The largest residual of all lanes; it is 0 where there is no manifold. */
static double largest_residual(const pe_sweep *sweep)
{
    double largest = 0;
    for (int k = 0; k < sweep->block_count; ++k) {
        for (int lane = 0; lane < PE_BLOCK_LANES; ++lane) {
            const double worst = sweep->worst[k][lane];
            largest = worst > largest ? worst : largest;
        }
    }
    return largest;
}

void pe_sweep_residuals(const pe_sweep *sweep, const pe_sweep_part *parts, int count,
                        double *residuals)
{
    pe_pool_run(sweep->problem->pool, sweep->block_count, PE_SUM_GRAIN, find_residuals,
                (void *)sweep);
    for (int k = 0; k < count; ++k) {
        residuals[k] = 0;
        if (is_whole(sweep, &parts[k])) {
            residuals[k] = largest_residual(sweep);
            continue;
        }
        for (int i = 0; i < parts[k].manifold_count; ++i) {
            int place = sweep->place[parts[k].manifold + i];
            double worst = sweep->worst[place / PE_BLOCK_LANES][place % PE_BLOCK_LANES];
            residuals[k] = worst > residuals[k] ? worst : residuals[k];
        }
    }
}

static void find_violation(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pe_sweep *sweep = context;
    sweep->sums[begin / PE_SUM_GRAIN] = sweep->kernel->violation(sweep, begin, end);
}

pe_violation pe_sweep_violation(const pe_sweep *sweep)
{
    pe_violation all = {0};
    pe_pool_run(sweep->problem->pool, sweep->block_count, PE_SUM_GRAIN, find_violation,
                (void *)sweep);
    for (int i = 0; i < pe_piece_count(sweep->block_count, PE_SUM_GRAIN); ++i) {
        const pe_violation *v = &sweep->sums[i];
        all.deepest = v->deepest > all.deepest ? v->deepest : all.deepest;
        all.squares += v->squares;
    }
    return all;
}

static void store_manifolds(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pe_sweep *sweep = context;
    const pe_problem *problem = sweep->problem;
    for (int i = begin; i < end; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        if (sweep->place[i] < 0) {
            continue;
        }
        int lane = sweep->place[i] % PE_BLOCK_LANES;
        int first = sweep->blocks[sweep->place[i] / PE_BLOCK_LANES].first;
        for (int j = 0; j < manifold->count; ++j) {
            double *impulse = problem->impulse[manifold->first + j];
            impulse[0] = sweep->points[first + j].impulse[lane];
            for (int k = 0; k < 2 && !sweep->normals; ++k) {
                impulse[1 + k] = sweep->frictions[first + j].impulse[k][lane];
            }
        }
    }
}

void pe_sweep_store(const pe_sweep *sweep, const pe_sweep_part *part)
{
    pe_pool_run_range(sweep->problem->pool, part->manifold, part->manifold + part->manifold_count,
                      MANIFOLD_GRAIN, store_manifolds, (void *)sweep);
}
