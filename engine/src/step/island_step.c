/* One island over an interval of time: its contact problem, and the solver that it gets. */
#include "step.h"

#include "problem/midpoint.h"
#include "solver/solve.h"

#include <string.h>

/* How much each profile asks of an island that is not solved directly. */
typedef struct strictness {
    /* What sweeps aim at, in m/s, in an island of SWEPT_POINTS contact points or fewer: in a
     * collapse the next step's problem is another one. In a larger one they aim at less, as the
     * square: sweeps converge the more slowly there, and each costs more. */
    double tolerance;
    double updates;  /* part of max_contact_updates */
    int most_sweeps; /* of a step */
    double patience; /* a direct solve may cost this many times what the allowed sweeps do */
} strictness;

static const strictness STRICTNESS[] = {
    [PE_PROFILE_DEFAULT] = {.tolerance = 2e-4, .updates = 0.5, .most_sweeps = 30, .patience = 8},
    [PE_PROFILE_ACCURATE] = {.tolerance = 7e-5, .updates = 1, .most_sweeps = 2000, .patience = 4},
    [PE_PROFILE_FAST] = {.tolerance = 2e-4, .updates = 0.5, .most_sweeps = 30, .patience = 8},
};

/* The fast profile. Larger islands than these are swept, except chains. */
enum { DIRECT_BODIES = 60 };
static const double LARGE_TOLERANCE = 1e-6; /* m/s: where Newton's method would be tried */
static const double CHAIN = 1.1;            /* manifolds a body */
/* A new island gets many sweeps at once, because later steps go on from them. In an uneven one
 * (step.h) the heavy body's velocity is off by the residual times the ratio: so sweeps aim at this
 * over the ratio, within bounds, in m/s. Below CALM (m/s) they go on in the next steps. */
enum { NEW_SWEEPS = 300, UNEVEN_SWEEPS = 70, CALM_SWEEPS = 10 };
static const double UNEVEN_TOLERANCE = 1e-2, LEAST_UNEVEN_TOLERANCE = 1e-4, CALM = 0.02;
static const double SWEPT_POINTS = 1250;
static const double MOST_TOLERANCE = 0.02; /* m/s: what sweeps aim at in any island */

/* An island that hardly moves is made to stop, so that it can rest: in units of the tolerance, the aim of
 * these solves, and what bounds them. After so many in a row it waits. A warm start that leaves more than
 * DISTURBED, in m/s, says that something has happened. */
static const double STOPPING = 1e-4, DISTURBED = 1e-6;
enum { STOPPING_ITERATIONS = 4, MOST_TRIES = 3 };

/* How often the midpoint of a contact that rolls on a rim is found from impulses that fit at the last
 * one. */
enum { WANDERING_ROUNDS = 2 };

/* ---- Solving ---- */

static void count_solve(pe_step *step, const pe_island_report *report,
                        const pe_solve_history *history, int points)
{
    pe_step_stats *stats = &step->stats;
    const pe_solve_report *solve = &report->solve;
    stats->factor_flops += solve->factor_flops;
    stats->iterations =
        solve->iterations > stats->iterations ? solve->iterations : stats->iterations;
    stats->unconverged_islands += !(solve->residual.max <= step->world->def.tolerance);
    if (stats->path == PE_PATH_NONE || !(solve->residual.max <= stats->residual)) {
        stats->residual = solve->residual.max;
        stats->path = report->path;
        stats->stop = solve->stop;
        stats->history_count = history->count;
        for (int i = 0; i < history->count; ++i) {
            stats->history[i] = history->marks[i].residual;
        }
    }
    step->residual_squares += solve->residual.rms * solve->residual.rms * points;
    step->residual_points += points;
}

/* The longest waits among the bodies. */
static pe_record record_of(const pe_world *world, const int *slots, int count)
{
    pe_record record = {0};
    for (int i = 0; i < count; ++i) {
        const pe_record *r = &pe_records(world)[slots[i]];
        record.direct = pe_backoff_longer(record.direct, r->direct);
        record.settling = pe_backoff_longer(record.settling, r->settling);
        record.stopping.backoff = pe_backoff_longer(record.stopping.backoff, r->stopping.backoff);
        record.stopping.tries =
            r->stopping.tries > record.stopping.tries ? r->stopping.tries : record.stopping.tries;
    }
    return record;
}

/* The wait after a step: one less, or another one if the work was done. */
static pe_backoff after_step(pe_backoff before, bool done, bool failed)
{
    return before.wait > 0 ? pe_backoff_less(before)
           : done          ? pe_backoff_after(failed, before.pause)
                           : before;
}

/* What is noted of the tries to stop an island. */
static pe_stopping after_try(const pe_island_item *item)
{
    pe_stopping s = item->record.stopping;
    if (item->solving.warm > DISTURBED) {
        return (pe_stopping){0};
    }
    if (!item->interval.stops) {
        s.backoff = pe_backoff_less(s.backoff);
    } else if (item->exact && ++s.tries == MOST_TRIES) {
        s = (pe_stopping){.backoff = pe_backoff_after(true, s.backoff.pause)};
    }
    return s;
}

/* Notes for all bodies of the island what its solve was like. */
static void note_solve(const pe_world *world, const pe_island_item *item)
{
    const pe_island_report *report = &item->solving.report;
    const bool done = report->path != PE_PATH_WARM && !item->exact;
    for (int i = 0; i < item->island.problem.body_count; ++i) {
        pe_record *r = &pe_records(world)[item->island.slot[i]];
        r->direct = after_step(item->record.direct, done, report->direct_failed);
        r->settling = after_step(item->record.settling, done, report->settling_failed);
        r->stopping = after_try(item);
        r->residual = report->solve.residual.max;
        r->rms = report->solve.residual.rms;
        r->put_back = false;
    }
}

bool pe_island_hold(pe_step *step, int k)
{
    const pe_world *world = step->world;
    const pe_islands *islands = &step->islands;
    const int *slots = islands->bodies + islands->body_start[k];
    const int count = islands->body_start[k + 1] - islands->body_start[k];
    bool held = step->repeats;
    for (int i = 0; i < count && held; ++i) {
        const pe_record *r = &pe_records(world)[slots[i]];
        held = r->put_back && r->direct.wait > 0 && r->settling.wait > 0 &&
               pe_is_still(&pe_twists(world)[slots[i]]);
    }
    for (int i = 0; i < count && held; ++i) {
        pe_record *r = &pe_records(world)[slots[i]];
        r->direct = pe_backoff_less(r->direct);
        r->settling = pe_backoff_less(r->settling);
        step->moves[slots[i]] = false;
    }
    if (held) {
        const pe_record *r = &pe_records(world)[slots[0]];
        int points = 0;
        for (pe_point_walk at = pe_walk_island(&world->contacts, islands, k); pe_next_point(&at);) {
            ++points;
        }
        pe_island_report report = {
            .path = PE_PATH_SWEEPS,
            .solve = {.residual = {.max = r->residual, .rms = r->rms}, .stop = PE_STOP_STALLED},
        };
        count_solve(step, &report, &(pe_solve_history){0}, points);
    }
    return held;
}

static pe_island_limits limits_of(const pe_world *world, const pe_island_problem *island)
{
    const strictness strict = STRICTNESS[world->def.profile];
    const bool fast = world->def.profile == PE_PROFILE_FAST;
    double size = fast ? 1 : pe_max(1, island->problem.point_count / SWEPT_POINTS);
    double swept = pe_min(MOST_TOLERANCE, strict.tolerance * size * size);
    return (pe_island_limits){
        .tolerance = world->def.tolerance,
        .swept_tolerance = pe_max(world->def.tolerance, swept),
        .max_updates = strict.updates * world->def.max_contact_updates,
        .most_sweeps = strict.most_sweeps,
        .max_iterations = world->def.max_iterations,
        .rough = world->def.profile != PE_PROFILE_ACCURATE,
        .patience = strict.patience,
        .store = world->patterns,
    };
}

/* Solves a problem that the impulses of the last step do not fit, as after an impact, and builds it
 * again at the midpoint that follows from those that do. */
static pe_status settle(pe_step *step, pe_island_item *item)
{
    pe_world *world = step->world;
    const pe_solve_limits limits = {world->def.tolerance, world->def.max_iterations};
    const int rounds = item->island.wanders ? WANDERING_ROUNDS : 1;
    pe_interval interval = item->interval;
    interval.solved = true;
    pe_status status = PE_OK;
    for (int i = 0; i < rounds && status == PE_OK; ++i) {
        pe_solve_report report = {0};
        status = pe_solve_tiny(&item->island.problem, &limits, pe_step_memory(world), &report,
                               step->error);
        if (status == PE_OK && pe_problem_has_impulse(&item->island.problem)) {
            pe_problem_store_impulses(world, &item->island);
            status = pe_problem_build(world, &interval, &item->island, step->error);
        }
    }
    return status;
}

double pe_island_mass_ratio(const pe_world *world, const pe_islands *islands, int k)
{
    double most = 1;
    for (int i = islands->start[k]; i < islands->start[k + 1]; ++i) {
        const pe_manifold *m = &pe_manifolds(&world->contacts)[islands->manifolds[i]];
        const double a = pe_masses(world)[m->a].mass, b = pe_masses(world)[m->b].mass;
        if (!pe_bodies(world)[m->a].is_static && !pe_bodies(world)[m->b].is_static) {
            most = pe_max(most, pe_max(a / b, b / a));
        }
    }
    return most;
}

/* Adapts the limits to the fast profile. */
static void limit_fast(const pe_island_problem *island, double ratio, pe_island_limits *limits)
{
    const pe_problem *problem = &island->problem;
    const int bodies = problem->body_count;
    if (bodies > DIRECT_BODIES && problem->manifold_count > CHAIN * bodies) {
        limits->direct_waits = true;
        limits->tolerance = pe_max(limits->tolerance, LARGE_TOLERANCE);
    }
    if (ratio > PE_UNEVEN) {
        const double aim = pe_max(LEAST_UNEVEN_TOLERANCE, UNEVEN_TOLERANCE / ratio);
        limits->swept_tolerance = pe_max(limits->tolerance, aim);
        limits->most_sweeps = UNEVEN_SWEEPS;
    }
    if (!pe_problem_has_impulse(problem)) {
        limits->most_sweeps = NEW_SWEEPS;
    }
}

/* An uneven island that is calm gets few sweeps in a step. */
static void calm_down(double ratio, pe_solving *solving)
{
    if (ratio > PE_UNEVEN && solving->warm < CALM && solving->sweeps > CALM_SWEEPS) {
        solving->sweeps = CALM_SWEEPS;
    }
}

/* Whether the island hardly moves, on contacts that it had before. */
static bool hardly_moves(const pe_step *step, const pe_islands *islands, int k)
{
    for (int i = islands->start[k]; i < islands->start[k + 1]; ++i) {
        if (!pe_manifolds(&step->world->contacts)[islands->manifolds[i]].kept) {
            return false;
        }
    }
    return pe_is_slow(step, islands, k, step->world->def.tolerance);
}

/* Begins to solve. Where an island is to stop and its warm start would be kept, it is solved as exactly as
 * rounding allows. */
static pe_status begin_solve(const pe_step *step, pe_island_item *item)
{
    pe_solving *solving = &item->solving;
    const pe_workspace work = pe_step_memory(step->world);
    pe_status status = pe_solving_begin(solving, work, step->error);
    item->exact = status == PE_OK && solving->report.path == PE_PATH_WARM && item->interval.stops;
    if (item->exact) {
        const pe_island_limits limits = solving->limits;
        solving->limits.tolerance *= STOPPING;
        solving->limits.max_iterations = limits.max_iterations < STOPPING_ITERATIONS
                                             ? limits.max_iterations
                                             : STOPPING_ITERATIONS;
        status = pe_solving_begin(solving, work, step->error);
        solving->limits = limits;
        solving->sweeps = 0;
    }
    return status;
}

pe_status pe_island_begin(pe_step *step, pe_island_item *item)
{
    pe_world *world = step->world;
    pe_interval *interval = &item->interval;
    const int first = interval->islands->body_start[interval->k];
    const int end = interval->islands->body_start[interval->k + 1];
    item->record = record_of(world, interval->islands->bodies + first, end - first);
    interval->stops = !interval->substep && item->record.stopping.backoff.wait == 0 &&
                      item->record.direct.wait == 0 &&
                      hardly_moves(step, interval->islands, interval->k);
    pe_status status = pe_problem_build(world, interval, &item->island, step->error);
    if (status == PE_OK && (item->island.unsettled || item->island.wanders)) {
        status = settle(step, item);
    }
    if (status != PE_OK) {
        return status;
    }
    item->history = (pe_solve_history){.marks = item->marks, .capacity = PE_HISTORY};
    item->solving = (pe_solving){
        .problem = &item->island.problem,
        .limits = limits_of(world, &item->island),
        .report.solve.history = &item->history,
    };
    item->solving.limits.direct_waits = item->record.direct.wait > 0;
    item->solving.limits.settling_waits = item->record.settling.wait > 0;
    if (world->def.profile != PE_PROFILE_FAST) {
        return begin_solve(step, item);
    }
    const double ratio = pe_island_mass_ratio(world, interval->islands, interval->k);
    limit_fast(&item->island, ratio, &item->solving.limits);
    status = begin_solve(step, item);
    calm_down(ratio, &item->solving);
    return status;
}

/* Ends the solve of an island that was swept if it asked for that. */
static pe_status end_solve(pe_step *step, pe_island_item *item)
{
    const pe_world *world = step->world;
    const pe_island_report *report = &item->solving.report;
    pe_status status = pe_solving_finish(&item->solving, pe_step_memory(step->world), step->error);
    if (status != PE_OK) {
        return status;
    }
    count_solve(step, report, &item->history, item->island.problem.point_count);
    item->interval.path = report->path;
    note_solve(world, item);
    return PE_OK;
}

/* Begins the island, and sweeps it by itself if it asks for that. */
static pe_status begin_alone(pe_step *step, pe_island_item *item)
{
    pe_solving *solving = &item->solving;
    pe_status status = pe_island_begin(step, item);
    return status == PE_OK && solving->sweeps > 0
               ? pe_solving_sweep(&solving, 1, pe_step_memory(step->world), step->error)
               : status;
}

pe_status pe_island_solve(pe_step *step, pe_interval *interval, pe_island_problem *island)
{
    pe_island_item item = {.interval = *interval};
    pe_status status = begin_alone(step, &item);
    if (status == PE_OK) {
        status = end_solve(step, &item);
    }
    *island = item.island;
    interval->path = item.interval.path;
    return status;
}

/* ---- The step ---- */

pe_status pe_island_end(pe_step *step, pe_island_item *item)
{
    const pe_interval *interval = &item->interval;
    pe_moved moved;
    pe_status status = end_solve(step, item);
    if (status == PE_OK) {
        status = pe_island_move(step, interval, &item->island, &moved);
    }
    if (status == PE_OK) {
        pe_problem_store_impulses(step->world, &item->island);
        if (interval->substep || item->island.end != NULL) {
            status = pe_list_apart(step, interval, interval->begin + interval->dt, &item->island,
                                   &moved);
        }
    }
    return status;
}

pe_status pe_island_step(pe_step *step, pe_interval *interval)
{
    pe_island_item item = {.interval = *interval};
    pe_status status = begin_alone(step, &item);
    if (status == PE_OK) {
        status = pe_island_end(step, &item);
    }
    interval->path = item.interval.path;
    return status;
}
