#include "island_step.h"

#include "integrate_positions.h"
#include "solver/solve_island.h"
#include "sparse/pattern_store.h"

/* How much each profile asks of an island that is not solved directly. */
typedef struct strictness {
    /* What sweeps aim at, in m/s, in an island of SWEPT_POINTS contact points or fewer: in what
     * collapses the next step's problem is another one. In a larger one they aim at less, as the
     * square: sweeps converge the more slowly there, and each costs more. */
    double tolerance;
    double updates;  /* part of max_contact_updates */
    double patience; /* how much dearer than the sweeps allowed a direct solve may be */
} strictness;

static const strictness STRICTNESS[] = {
    [PE_PROFILE_DEFAULT] = {.tolerance = 2e-4, .updates = 0.5, .patience = 8},
    [PE_PROFILE_ACCURATE] = {.tolerance = 5e-5, .updates = 1, .patience = 4},
    [PE_PROFILE_FAST] = {.tolerance = 2e-4, .updates = 0.5, .patience = 8},
};
static const double SWEPT_POINTS = 1250;

static void count_solve(const pe_world *world, const pe_island_report *report,
                        const pe_solve_history *history, int points, pe_solve_tally *tally)
{
    pe_step_stats *stats = tally->stats;
    const pe_solve_report *solve = &report->solve;
    stats->factor_flops += solve->factor_flops;
    stats->iterations =
        solve->iterations > stats->iterations ? solve->iterations : stats->iterations;
    stats->unconverged_islands += !(solve->residual.max <= world->def.tolerance);
    if (stats->path == PE_PATH_NONE || !(solve->residual.max <= stats->residual)) {
        stats->residual = solve->residual.max;
        stats->path = report->path;
        stats->stop = solve->stop;
        stats->history_count = history->count;
        for (int i = 0; i < history->count; ++i) {
            stats->history[i] = history->marks[i].residual;
        }
    }
    tally->squares += solve->residual.rms * solve->residual.rms * points;
    tally->points += points;
}

pe_status pe_island_solve(pe_world *world, const pe_islands *islands, int k,
                          const pe_free_motion *free, double dt, pe_solve_tally *tally,
                          pe_island_problem *island, pe_path *path, pe_error *error)
{
    pe_status status = pe_problem_build(world, islands, k, free, dt, island, error);
    if (status != PE_OK) {
        return status;
    }
    const strictness strict = STRICTNESS[world->def.profile];
    double size = pe_max(1, island->problem.point_count / SWEPT_POINTS);
    pe_solve_mark marks[PE_HISTORY];
    pe_solve_history history = {.marks = marks, .capacity = PE_HISTORY};
    pe_island_report report = {.solve.history = &history};
    pe_island_limits limits = {
        .tolerance = world->def.tolerance,
        .swept_tolerance = pe_max(world->def.tolerance, strict.tolerance * size * size),
        .max_updates = strict.updates * world->def.max_contact_updates,
        .max_iterations = world->def.max_iterations,
        .patience = strict.patience,
        .store = world->patterns,
    };
    status = pe_solve_island(&island->problem, &limits, pe_step_memory(world), &report, error);
    if (status == PE_OK) {
        count_solve(world, &report, &history, island->problem.point_count, tally);
        *path = report.path;
    }
    return status;
}

pe_status pe_island_step(pe_world *world, const pe_islands *islands, int k,
                         const pe_free_motion *free, double dt, pe_solve_tally *tally,
                         pe_path *path, pe_error *error)
{
    pe_island_problem island;
    pe_status status = pe_island_solve(world, islands, k, free, dt, tally, &island, path, error);
    if (status == PE_OK) {
        status = pe_integrate_island(world, &island, free, dt, error);
    }
    if (status == PE_OK) {
        pe_problem_store_impulses(world, &island);
    }
    return status;
}
