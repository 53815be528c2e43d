/* The step: a straight pipeline of phases, each timed. */
#define _POSIX_C_SOURCE 199309L

#include "contact/contact.h"
#include "energy_guard.h"
#include "impact.h"
#include "integrate_positions.h"
#include "position_correction.h"
#include "solver/soft.h"
#include "solver/solve.h"

#include <string.h>
#include <time.h>

/* Depth, in m, from which a contact of an island that was solved directly is pushed out. */
static const double STANDING_DEPTH = 1e-8;
enum { PROJECTION_ITERATIONS = 30 };

/* In units of the slop: what is pushed out by less waits for motion to pay for it (energy_guard.h).
 */
static const double SHALLOW = 30;

/* Pairs that moved relative to each other by less, in units of the smaller body, keep their
 * manifold in the fast profile. */
static const double FAST_REUSE = 2.4e-3;

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Time since *mark, which moves on. */
static double lap(double *mark)
{
    double now = seconds_now(), passed = now - *mark;
    *mark = now;
    return passed;
}

/* One step's own data. */
typedef struct stepping {
    pe_world *world;
    double dt;
    pe_islands islands;
    pe_free_motion *free; /* (slots) */
    pe_pose *poses;       /* (slots): where the bodies began */
    pe_twist *motions;
    bool *soft;   /* (islands): solved by substeps of soft contact */
    bool *stands; /* (slots): in an island that was solved directly */
    bool *thrown; /* (slots): in a small island too fast for soft contacts */
    bool any_thrown;
    bool *moved;                      /* (slots): by the projection */
    const pe_pose *unprojected_poses; /* (slots): before it; NULL: there was none */
    const pe_twist *unprojected_motions;
    pe_contact_rules rules;
    pe_step_stats stats;
    pe_error *error;
} stepping;

/* The contacts at the poses now, with the impulses that they inherit. */
static pe_status find_contacts(stepping *step)
{
    pe_world *world = step->world;
    pe_pair *pairs;
    int count;
    double mark = seconds_now();
    pe_status status = pe_broad_phase(world, step->dt, &pairs, &count, step->error);
    step->stats.time_broad_phase += lap(&mark);
    if (status == PE_OK) {
        status = pe_contacts_find_by(world, &step->rules, pairs, count, step->dt, step->error);
        step->stats.time_narrow_phase += lap(&mark);
    }
    if (status == PE_OK) {
        pe_contacts_match(world, step->dt);
        step->stats.time_contacts += lap(&mark);
    }
    return status;
}

/* Remembers where everything is, so that a step that runs out of memory has moved nothing. */
static pe_status remember(stepping *step)
{
    pe_world *world = step->world;
    size_t slots = (size_t)world->slot_count;
    step->poses = pe_scratch(world, slots, sizeof *step->poses);
    step->motions = pe_scratch(world, slots, sizeof *step->motions);
    step->free = pe_scratch(world, slots, sizeof *step->free);
    step->stands = pe_scratch(world, slots, sizeof *step->stands);
    step->thrown = pe_scratch(world, slots, sizeof *step->thrown);
    step->moved = pe_scratch(world, slots, sizeof *step->moved);
    if (step->poses == NULL || step->motions == NULL || step->free == NULL ||
        step->stands == NULL || step->thrown == NULL || step->moved == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory to step %zu bodies", slots);
    }
    memcpy(step->poses, pe_poses(world), slots * sizeof *step->poses);
    memcpy(step->motions, pe_twists(world), slots * sizeof *step->motions);
    memset(step->stands, 0, slots * sizeof *step->stands);
    memset(step->thrown, 0, slots * sizeof *step->thrown);
    memset(step->moved, 0, slots * sizeof *step->moved);
    return PE_OK;
}

static void put_back(stepping *step)
{
    size_t slots = (size_t)step->world->slot_count;
    memcpy(pe_poses(step->world), step->poses, slots * sizeof *step->poses);
    memcpy(pe_twists(step->world), step->motions, slots * sizeof *step->motions);
    step->world->contacts_stale = true;
}

/* Its bodies' velocities and poses at the end of the step. */
static pe_status solve_island(stepping *step, int k, pe_solve_tally *tally)
{
    pe_world *world = step->world;
    bool in_parts = world->def.profile != PE_PROFILE_FAST &&
                    pe_impact_is_due(world, &step->islands, k, step->dt);
    pe_path path = PE_PATH_NONE;
    pe_status status = in_parts ? pe_impact_step(world, &step->islands, k, &step->rules, step->dt,
                                                 tally, &path, step->error)
                                : pe_island_step(world, &step->islands, k, step->free, step->dt,
                                                 tally, &path, step->error);
    if (status != PE_OK) {
        return status;
    }
    step->stats.islands_by_path[path] += 1;
    for (int i = step->islands.body_start[k]; i < step->islands.body_start[k + 1]; ++i) {
        step->stands[step->islands.bodies[i]] = path != PE_PATH_SWEEPS;
    }
    return PE_OK;
}

/* Chains and small islands are cheap to solve directly while they hardly move; what is livelier
 * would take many iterations, and gets soft contacts. */
enum { SMALL_ISLAND = 60 };
static const double CHAIN = 1.5;        /* manifolds a body */
static const double QUIET_SPEED = 0.05; /* m/s */

static bool is_quiet_and_cheap(const stepping *step, int k)
{
    const pe_islands *islands = &step->islands;
    int bodies = islands->body_start[k + 1] - islands->body_start[k];
    int manifolds = islands->start[k + 1] - islands->start[k];
    if (bodies > SMALL_ISLAND && manifolds > CHAIN * bodies) {
        return false;
    }
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
        pe_vec3 v = pe_twists(step->world)[islands->bodies[i]].velocity;
        if (pe_dot(v, v) > QUIET_SPEED * QUIET_SPEED) {
            return false;
        }
    }
    return true;
}

/* A substep's one pass of soft contacts does not stop what meets a wall in one step with more than
 * its own size to go: that is solved, where it costs little. */
static const double FAR = 0.5; /* a step's motion in units of the bounding radius */

static bool is_thrown_and_small(const stepping *step, int k)
{
    const pe_islands *islands = &step->islands;
    if (islands->body_start[k + 1] - islands->body_start[k] > SMALL_ISLAND) {
        return false;
    }
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
        int slot = islands->bodies[i];
        double far = FAR * pe_bodies(step->world)[slot].bounding_radius;
        pe_vec3 v = pe_twists(step->world)[slot].velocity;
        if (step->dt * step->dt * pe_dot(v, v) > far * far) {
            return true;
        }
    }
    return false;
}

static void mark_thrown(stepping *step, int k)
{
    const pe_islands *islands = &step->islands;
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
        step->thrown[islands->bodies[i]] = true;
    }
    step->any_thrown = true;
}

static pe_status choose_soft(stepping *step)
{
    int count = step->islands.count;
    step->soft = pe_scratch(step->world, (size_t)count + 1, sizeof *step->soft);
    if (step->soft == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory for %d islands", count);
    }
    for (int k = 0; k < count; ++k) {
        step->soft[k] = step->world->def.profile == PE_PROFILE_FAST && !is_quiet_and_cheap(step, k);
        if (step->soft[k] && is_thrown_and_small(step, k)) {
            step->soft[k] = false;
            mark_thrown(step, k);
        }
        step->stats.islands_by_path[PE_PATH_SOFT] += step->soft[k];
    }
    return PE_OK;
}

/* Velocities, and the poses that follow from them. */
static pe_status solve_and_move(stepping *step)
{
    pe_world *world = step->world;
    double mark = seconds_now();
    pe_solve_tally tally = {.stats = &step->stats};
    pe_predict_motion(world, step->dt, step->free);
    pe_status status = choose_soft(step);
    for (int k = 0; k < step->islands.count && status == PE_OK; ++k) {
        if (!step->soft[k]) {
            /* Each island's numbers in the memory of the one before: it is in the cache. */
            pe_arena_mark before = pe_arena_fill(&world->arena);
            status = solve_island(step, k, &tally);
            pe_arena_rewind(&world->arena, &world->allocator, before);
        }
    }
    if (status == PE_OK && step->stats.islands_by_path[PE_PATH_SOFT] > 0) {
        status = pe_soft_step(world, &(pe_chosen_islands){&step->islands, step->soft}, step->dt,
                              NULL, NULL, step->error);
    }
    if (status != PE_OK) {
        return status;
    }
    if (tally.points > 0) {
        step->stats.residual_rms = sqrt(tally.squares / tally.points);
    }
    step->stats.time_solve = lap(&mark);
    const pe_body *bodies = pe_bodies(world);
    for (int slot = 1; slot < world->slot_count; ++slot) {
        if (bodies[slot].alive && !bodies[slot].is_static && step->islands.place[slot] < 0) {
            pe_integrate_free(world, slot, step->free, step->dt);
        }
    }
    step->stats.time_integrate = lap(&mark);
    return PE_OK;
}

/* The contacts of the step's end, which are those that the next one solves. */
static pe_status meet(stepping *step)
{
    pe_world *world = step->world;
    world->previous_dt = step->dt;
    pe_status status = find_contacts(step);
    if (status != PE_OK) {
        return status;
    }
    /* The list that was just replaced is that of the solved contacts. */
    pe_contacts solved = world->previous;
    world->previous = world->solved;
    world->solved = solved;
    return PE_OK;
}

static pe_status project_by(stepping *step, const pe_project_rules *rules)
{
    pe_world *world = step->world;
    pe_project_report report;
    pe_status status =
        pe_project_positions(world, rules, &step->rules, step->dt, &report, step->error);
    if (status != PE_OK) {
        return status;
    }
    for (int slot = 0; slot < world->slot_count && report.moved != NULL; ++slot) {
        step->moved[slot] |= report.moved[slot];
    }
    if (step->unprojected_poses == NULL) {
        step->unprojected_poses = report.poses;
        step->unprojected_motions = report.motions;
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

/* Pushes out what the step has left of penetration: all of it from what is solved directly, what is
 * over the slop from all. Soft contacts push by themselves, so that in the fast profile only what
 * was too fast for them is left. */
static pe_status project(stepping *step)
{
    bool fast = step->world->def.profile == PE_PROFILE_FAST;
    double slop = step->world->def.penetration_slop;
    if (fast && !step->any_thrown) {
        return PE_OK;
    }
    pe_project_rules standing = pe_project_rules_default();
    standing.begin = STANDING_DEPTH;
    standing.aim = 0;
    standing.enough = 0.1 * STANDING_DEPTH;
    standing.among = fast ? step->thrown : step->stands;
    standing.solver = pe_solve_combined;
    standing.solver_limits = (pe_solve_limits){standing.enough, PROJECTION_ITERATIONS};
    pe_status status = project_by(step, &standing);
    if (status != PE_OK || fast) {
        return status;
    }
    pe_project_rules rules = pe_project_rules_default();
    rules.begin = 3 * slop;
    rules.aim = slop;
    rules.enough = 0.5 * slop;
    rules.max_rounds = step->world->def.profile == PE_PROFILE_ACCURATE ? rules.max_rounds : 2;
    return project_by(step, &rules);
}

/* The contacts of these bodies (slots) at their poses now; all others stay to the bit. */
static pe_status meet_again(stepping *step, const bool *bodies)
{
    pe_pair *pairs;
    int count;
    pe_status status =
        pe_broad_phase_moved(step->world, step->dt, bodies, &pairs, &count, step->error);
    if (status == PE_OK) {
        status = pe_contacts_refind(step->world, &step->rules, pairs, count, bodies, step->dt,
                                    step->error);
    }
    return status;
}

static pe_status guard_energy(stepping *step)
{
    pe_world *world = step->world;
    size_t slots = (size_t)world->slot_count;
    bool *put_back = pe_scratch(world, slots, sizeof *put_back);
    bool *exact = pe_scratch(world, slots, sizeof *exact);
    if (put_back == NULL || exact == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory to step %zu bodies", slots);
    }
    for (size_t slot = 0; slot < slots; ++slot) {
        put_back[slot] = false;
        /* What had no contact to solve has moved as exactly as what stands. */
        exact[slot] = step->stands[slot] || step->islands.place[slot] < 0;
    }
    pe_energy_report report;
    pe_islands groups;
    pe_status status = pe_islands_find_touching(world, &groups, step->error);
    if (status != PE_OK) {
        return status;
    }
    const pe_energy_step ends = {
        .dt = step->dt,
        .free = step->free,
        .poses = step->poses,
        .motions = step->motions,
        .moved = step->moved,
        .unprojected_poses = step->unprojected_poses,
        .unprojected_motions = step->unprojected_motions,
        .solved = exact,
        .shallow = SHALLOW * world->def.penetration_slop,
    };
    pe_energy_guard(world, &groups, &ends, put_back, &report);
    step->stats.guarded_islands = report.islands;
    return report.put_back > 0 ? meet_again(step, put_back) : PE_OK;
}

static void clear_loads(pe_world *world)
{
    if (!world->loaded) {
        return;
    }
    world->loaded = false;
    for (int slot = 0; slot < world->slot_count; ++slot) {
        pe_applied_forces(world)[slot] = (pe_applied_force){0};
    }
}

static pe_contact_rules rules_of(pe_profile profile)
{
    pe_contact_rules rules = pe_contact_rules_exact();
    if (profile == PE_PROFILE_FAST) {
        rules.reuse_tolerance = FAST_REUSE;
        rules.most_points = 4;
    }
    return rules;
}

static pe_status advance(stepping *step)
{
    pe_world *world = step->world;
    pe_status status = PE_OK;
    if (world->contacts_stale || step->dt != world->previous_dt) {
        status = find_contacts(step);
    }
    double mark = seconds_now();
    if (status == PE_OK) {
        world->contacts_stale = false;
        status = pe_islands_find(world, &step->islands, step->error);
        step->stats.time_islands = lap(&mark);
    }
    if (status == PE_OK) {
        step->stats.islands = step->islands.count;
        step->stats.manifolds = world->contacts.manifold_count;
        step->stats.contacts = world->contacts.point_count;
        status = solve_and_move(step);
    }
    if (status == PE_OK) {
        status = meet(step);
    }
    mark = seconds_now();
    if (status == PE_OK) {
        status = project(step);
    }
    if (status == PE_OK) {
        status = guard_energy(step);
        step->stats.time_project = lap(&mark);
    }
    return status;
}

pe_status pe_world_step(pe_world *world, double dt, pe_step_stats *stats, pe_error *error)
{
    if (!(dt > 0) || !isfinite(dt)) {
        return pe_fail(error, PE_BAD_ARGUMENT, "dt: expected a finite number above 0, found %g",
                       dt);
    }
    pe_arena_reset(&world->arena, &world->allocator);
    stepping step = {
        .world = world, .dt = dt, .rules = rules_of(world->def.profile), .error = error};
    pe_status status = remember(&step);
    if (status != PE_OK) {
        return status;
    }
    status = advance(&step);
    if (status != PE_OK) {
        put_back(&step);
        return status;
    }
    clear_loads(world);
    if (stats != NULL) {
        *stats = step.stats;
    }
    return PE_OK;
}

int pe_world_get_contacts(const pe_world *world, pe_contact *contacts, int capacity)
{
    const pe_contacts *solved = &world->solved;
    const pe_body *bodies = pe_bodies(world);
    int count = 0;
    for (int i = 0; i < solved->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(solved)[i];
        for (int j = m->first; j < m->first + m->count; ++j, ++count) {
            const pe_manifold_point *point = &pe_manifold_points(solved)[j];
            if (count < capacity) {
                contacts[count] = (pe_contact){
                    .body_a = {(uint32_t)m->a, bodies[m->a].generation},
                    .body_b = {(uint32_t)m->b, bodies[m->b].generation},
                    .point = point->position,
                    .normal = m->normal,
                    .separation = point->separation,
                    .impulse = point->impulse,
                };
            }
        }
    }
    return count;
}
