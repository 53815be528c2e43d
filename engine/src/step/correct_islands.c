/* Which islands have their positions corrected, how far, and by which solver. */
#include "model/rest.h"
#include "step.h"

/* Depth, in m, from which position correction acts in islands that were solved directly. */
static const double DIRECT_DEPTH = 1e-8;
static const double FAST_DIRECT_DEPTH = 1e-4; /* the same in the fast profile */
enum { CORRECTION_ITERATIONS = 30 };

/* Position correction by sweeps. Lengths are in units of the slop (pe_correction_rules). */
typedef struct swept_correction {
    double begin, aim, enough;
    int max_rounds, max_sweeps;
} swept_correction;

static const swept_correction SWEPT[] = {
    [PE_PROFILE_DEFAULT] = {6, 1, 0.5, 2, 30},
    [PE_PROFILE_ACCURATE] = {3, 1, 0.5, 8, 200},
    [PE_PROFILE_FAST] = {6, 1, 0.5, 2, 100},
};
/* Soft contacts push by themselves. */
static const swept_correction AFTER_SOFT = {12, 6, 4.8, 1, 20};
static const swept_correction STILL_DEEP = {50, 6, 4.8, 3, 60}; /* after that */

/* Sets penetration_left to the depth that is left between the bodies that the rules apply to. */
static pe_status correct_by(pe_step *step, const pe_correction_rules *rules)
{
    pe_correction_report report;
    pe_status status = pe_correct_positions(step, rules, &report);
    if (status != PE_OK) {
        return status;
    }
    pe_step_stats *stats = &step->stats;
    stats->projection_rounds += report.rounds;
    stats->projection_iterations = report.iterations > stats->projection_iterations
                                       ? report.iterations
                                       : stats->projection_iterations;
    stats->penetration = pe_max(stats->penetration, report.penetration);
    stats->penetration_left = report.penetration_left;
    return PE_OK;
}

/* The bodies whose islands were solved directly, and whose correction is not waiting. */
static const bool *find_exactly_corrected(pe_step *step)
{
    pe_world *world = step->world;
    bool *found = pe_scratch_zero(world, (size_t)world->slot_count, sizeof *found);
    for (int i = 0; i < pe_awake_count(world) && found != NULL; ++i) {
        const int slot = pe_awake(world)[i];
        pe_backoff *b = &pe_records(world)[slot].correction;
        found[slot] = step->solved_directly[slot] && b->wait == 0;
        *b = pe_backoff_less(*b);
    }
    return found;
}

static pe_status correct_by_sweeps(pe_step *step, const swept_correction *c, const bool *among)
{
    const double slop = step->world->def.penetration_slop;
    pe_correction_rules rules = pe_correction_rules_default();
    rules.begin = c->begin * slop;
    rules.aim = c->aim * slop;
    rules.enough = c->enough * slop;
    rules.max_rounds = c->max_rounds;
    rules.max_sweeps = c->max_sweeps;
    rules.among = among;
    return correct_by(step, &rules);
}

/* Corrects what soft contact moved, or only fell, after the rest. */
static pe_status correct_fast(pe_step *step)
{
    const pe_islands *islands = &step->islands;
    const size_t slots = (size_t)step->world->slot_count;
    bool *swept = pe_scratch_zero(step->world, slots, sizeof *swept);
    bool *soft = pe_scratch_zero(step->world, slots, sizeof *soft);
    if (swept == NULL || soft == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory to correct %zu bodies", slots);
    }
    for (int i = 0; i < pe_awake_count(step->world); ++i) {
        const int slot = pe_awake(step->world)[i];
        soft[slot] = !pe_bodies(step->world)[slot].is_static;
    }
    for (int k = 0; k < islands->count; ++k) {
        for (int i = islands->body_start[k]; !step->soft[k] && i < islands->body_start[k + 1];
             ++i) {
            swept[islands->bodies[i]] = true;
            soft[islands->bodies[i]] = false;
        }
    }
    pe_status status = correct_by_sweeps(step, &SWEPT[PE_PROFILE_FAST], swept);
    const double left_in_swept = step->stats.penetration_left;
    if (status == PE_OK) {
        status = correct_by_sweeps(step, &AFTER_SOFT, soft);
    }
    if (status == PE_OK) {
        status = correct_by_sweeps(step, &STILL_DEEP, soft);
    }
    step->stats.penetration_left = pe_max(step->stats.penetration_left, left_in_swept);
    return status;
}

pe_status pe_correct_islands(pe_step *step)
{
    const pe_profile profile = step->world->def.profile;
    const bool fast = profile == PE_PROFILE_FAST;
    pe_correction_rules direct = pe_correction_rules_default();
    direct.begin = fast ? FAST_DIRECT_DEPTH : DIRECT_DEPTH;
    direct.aim = 0;
    direct.enough = 0.1 * direct.begin;
    direct.among = find_exactly_corrected(step);
    if (direct.among == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory to correct %d bodies",
                       step->world->slot_count);
    }
    direct.solver = pe_solve_combined;
    direct.solver_limits = (pe_solve_limits){direct.enough, CORRECTION_ITERATIONS};
    pe_status status = correct_by(step, &direct);
    if (status != PE_OK) {
        return status;
    }
    return fast ? correct_fast(step) : correct_by_sweeps(step, &SWEPT[profile], step->moves);
}
