/* The step: a straight pipeline of phases, each timed. */
#define _POSIX_C_SOURCE 199309L

#include "impact.h"
#include "model/ranges.h"
#include "solver/soft.h"

#include <string.h>
#include <time.h>

/* In units of the slop: a correction by less waits until motion can pay for it (step.h). */
static const double SHALLOW = 30;

/* Pairs that moved relative to each other by less, in units of the smaller body, keep their
 * manifold in the fast profile. */
static const double FAST_REUSE = 2.4e-3;

/* In the fast profile islands that hardly move are solved as in the others: soft contacts sag under
 * a load that lasts. */
static const double QUIET_SPEED = 0.05; /* m/s */

/* So are uneven islands, in which a light body may be jammed between a heavy one and the ground:
 * two bodies in contact differ in mass by more than this. A larger island costs too much. */
enum { MOST_UNEVEN = 400 }; /* bodies */

/* A sub-step's one pass of soft contacts does not stop a body that reaches a wall in one step with
 * more than its own size to go: small islands with such a body are solved. */
enum { SMALL_ISLAND = 60 };
static const double FAR = 0.5; /* a step's motion in units of the bounding radius */

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Time since *mark, which becomes now. */
static double lap(double *mark)
{
    double now = seconds_now(), passed = now - *mark;
    *mark = now;
    return passed;
}

/* ---- Start ---- */

static pe_contact_rules rules_of(pe_profile profile)
{
    pe_contact_rules rules = pe_contact_rules_exact();
    if (profile == PE_PROFILE_FAST) {
        rules.reuse_tolerance = FAST_REUSE;
        rules.most_points = 4;
    }
    return rules;
}

/* Takes the step's memory and saves all poses and velocities, so that a step that runs out of
 * memory has moved nothing. */
static pe_status begin_step(pe_step *step)
{
    pe_world *world = step->world;
    size_t slots = (size_t)world->slot_count;
    step->twists = pe_scratch(world, slots, sizeof *step->twists);
    step->free = pe_scratch(world, slots, sizeof *step->free);
    step->solved_directly = pe_scratch_zero(world, slots, sizeof(bool));
    step->corrected = pe_scratch_zero(world, slots, sizeof(bool));
    step->moves = pe_scratch(world, slots, sizeof(bool));
    if (pe_scratch_failed(world)) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory to step %zu bodies", slots);
    }
    pe_status status = pe_array_reserve(&world->start_pose_array, &world->allocator,
                                        sizeof *step->poses, slots, 0, step->error);
    if (status != PE_OK) {
        return status;
    }
    step->poses = world->start_pose_array.items;
    memset(step->moves, true, slots * sizeof *step->moves);
    memcpy(step->poses, pe_poses(world), slots * sizeof *step->poses);
    memcpy(step->twists, pe_twists(world), slots * sizeof *step->twists);
    return PE_OK;
}

/* Puts the bodies back. Where the step was not finite, what may be the cause is forgotten: forces
 * and the impulses of contacts. */
static void undo_step(const pe_step *step, pe_status status)
{
    size_t slots = (size_t)step->world->slot_count;
    if (status == PE_NOT_FINITE) {
        memset(pe_applied_forces(step->world), 0, slots * sizeof *pe_applied_forces(step->world));
        step->world->has_applied_forces = false;
        step->world->contacts.manifold_count = step->world->contacts.point_count = 0;
    }
    memcpy(pe_poses(step->world), step->poses, slots * sizeof *step->poses);
    memcpy(pe_twists(step->world), step->twists, slots * sizeof *step->twists);
    step->world->contacts_stale = true;
}

/* Finds the contacts at the poses now, with the impulses that they inherit. */
static pe_status find_contacts(pe_step *step)
{
    pe_world *world = step->world;
    pe_pair_list pairs;
    double mark = seconds_now();
    pe_status status = pe_broad_phase(world, step->dt, NULL, &pairs, step->error);
    step->stats.time_broad_phase += lap(&mark);
    if (status == PE_OK) {
        status = pe_contacts_find(world, &step->rules, &pairs, NULL, step->dt, step->error);
        step->stats.time_narrow_phase += lap(&mark);
    }
    if (status == PE_OK) {
        pe_contacts_scale_impulses(world, step->dt);
        step->stats.time_contacts += lap(&mark);
    }
    return status;
}

static pe_status find_islands(pe_step *step)
{
    pe_world *world = step->world;
    double mark = seconds_now();
    world->contacts_stale = false;
    pe_status status = pe_islands_find(world, &step->islands, step->error);
    step->stats.time_islands = lap(&mark);
    step->stats.islands = step->islands.count;
    step->stats.manifolds = world->contacts.manifold_count;
    step->stats.contacts = world->contacts.point_count;
    return status;
}

/* ---- Velocities and poses ---- */

static void count_island(pe_step *step, int k, pe_path path)
{
    step->stats.islands_by_path[path] += 1;
    for (int i = step->islands.body_start[k]; i < step->islands.body_start[k + 1]; ++i) {
        step->solved_directly[step->islands.bodies[i]] = path != PE_PATH_SWEEPS;
    }
}

/* Steps an island that has impacts, whole or in parts, so that they have their own time. *done:
 * whether they do. */
static pe_status step_impacts(pe_step *step, int k, bool *done)
{
    const pe_islands *islands = &step->islands;
    const pe_world_def *def = &step->world->def;
    pe_status status = PE_OK;
    pe_path path = PE_PATH_NONE;
    *done = false;
    if (def->profile == PE_PROFILE_FAST) {
        return PE_OK;
    }
    if (islands->body_start[k + 1] - islands->body_start[k] > 1 && def->impact_bodies > 0 &&
        pe_may_bounce(step->world, islands, k) && pe_impact_is_due(step, islands, k)) {
        status = pe_parts_step(step, k, done, &path);
        step->stats.islands_by_path[path] += *done;
    }
    if (status == PE_OK && !*done && pe_impact_has_own_time(step, islands, k)) {
        *done = true;
        status = pe_impact_step(step, islands, k, &path);
        if (status == PE_OK) {
            count_island(step, k, path);
        }
    }
    return status;
}

/* Ends an island whose sweeps, if it asked for any, are made. */
static pe_status end_island(pe_step *step, pe_island_item *item)
{
    pe_status status = pe_island_end(step, item);
    if (status == PE_OK) {
        count_island(step, item->interval.k, item->interval.path);
    }
    return status;
}

/* Brings the bodies of an island to their velocities and poses at the end of the step, or leaves an
 * item that asks for sweeps. */
static pe_status begin_island(pe_step *step, int k, pe_island_item *item)
{
    *item = (pe_island_item){
        .interval = {.islands = &step->islands, .k = k, .free = step->free, .dt = step->dt},
    };
    if (pe_island_hold(step, k)) {
        count_island(step, k, PE_PATH_SWEEPS);
        return PE_OK;
    }
    bool done;
    pe_status status = step_impacts(step, k, &done);
    if (status != PE_OK || done) {
        return status;
    }
    status = pe_island_begin(step, item);
    return status == PE_OK && item->solving.sweeps == 0 ? end_island(step, item) : status;
}

static int body_count(const pe_islands *islands, int k)
{
    return islands->body_start[k + 1] - islands->body_start[k];
}

/* Whether an island hardly moves. */
static bool is_quiet(const pe_step *step, int k)
{
    const pe_islands *islands = &step->islands;
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
        pe_vec3 v = pe_twists(step->world)[islands->bodies[i]].velocity;
        if (pe_dot(v, v) > QUIET_SPEED * QUIET_SPEED) {
            return false;
        }
    }
    return true;
}

static bool is_fast_and_small(const pe_step *step, int k)
{
    const pe_islands *islands = &step->islands;
    if (body_count(islands, k) > SMALL_ISLAND) {
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

static bool suits_soft_contact(const pe_step *step, int k)
{
    const bool small = body_count(&step->islands, k) <= MOST_UNEVEN;
    return step->world->def.profile == PE_PROFILE_FAST && !is_quiet(step, k) &&
           !is_fast_and_small(step, k) &&
           !(small && pe_island_mass_ratio(step->world, &step->islands, k) > PE_UNEVEN);
}

/* Chooses the islands that get soft contacts. */
static pe_status choose_soft(pe_step *step)
{
    const pe_islands *islands = &step->islands;
    step->soft = pe_scratch(step->world, (size_t)islands->count + 1, sizeof *step->soft);
    if (step->soft == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory for %d islands", islands->count);
    }
    for (int k = 0; k < islands->count; ++k) {
        step->soft[k] = suits_soft_contact(step, k);
        step->stats.islands_by_path[PE_PATH_SOFT] += step->soft[k];
    }
    return PE_OK;
}

/* Islands of so few points are swept together, up to so many of them. */
enum { FEW_POINTS = 128, MANY_POINTS = 1024 };

/* Whether an item joins those that are swept together, which begin with `first` and have so many
 * points. */
static bool joins(const pe_solving *first, int points, const pe_solving *s)
{
    int more = s->problem->point_count;
    return first->problem->point_count <= FEW_POINTS && more <= FEW_POINTS &&
           points + more <= MANY_POINTS && s->enough == first->enough && s->sweeps == first->sweeps;
}

/* Sweeps a group of items and ends them. */
static pe_status sweep_group(pe_step *step, pe_island_item **group, pe_solving **solving, int count)
{
    pe_world *world = step->world;
    for (int i = 0; i < count; ++i) {
        solving[i] = &group[i]->solving;
    }
    pe_arena_mark before = pe_arena_fill(&world->arena);
    pe_status status = pe_solving_sweep(solving, count, pe_step_memory(world), step->error);
    for (int i = 0; i < count && status == PE_OK; ++i) {
        pe_arena_rewind(&world->arena, &world->allocator, before);
        status = end_island(step, group[i]);
    }
    pe_arena_rewind(&world->arena, &world->allocator, before);
    return status;
}

/* Sweeps and ends the items that ask for sweeps. Those that can be swept together are. */
static pe_status sweep_islands(pe_step *step, pe_island_item **items, int count)
{
    pe_island_item **group = pe_scratch(step->world, (size_t)count + 1, sizeof(void *));
    pe_solving **solving = pe_scratch(step->world, (size_t)count + 1, sizeof(void *));
    if (group == NULL || solving == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory to sweep %d islands", count);
    }
    pe_status status = PE_OK;
    for (int left = 0; status == PE_OK && count > 0; count = left) {
        const pe_solving *first = &items[0]->solving;
        int joined = 0, points = 0;
        left = 0;
        for (int i = 0; i < count; ++i) {
            if (i == 0 || joins(first, points, &items[i]->solving)) {
                points += items[i]->solving.problem->point_count;
                group[joined++] = items[i];
            } else {
                items[left++] = items[i];
            }
        }
        status = sweep_group(step, group, solving, joined);
    }
    return status;
}

static pe_status solve_islands(pe_step *step)
{
    pe_world *world = step->world;
    pe_status status = choose_soft(step);
    size_t count = (size_t)step->islands.count;
    pe_island_item *items = pe_scratch(world, count + 1, sizeof *items);
    pe_island_item **asking = pe_scratch(world, count + 1, sizeof(void *));
    int begun = 0;
    if (status == PE_OK && pe_scratch_failed(world)) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory for %zu islands", count);
    }
    for (int k = 0; k < step->islands.count && status == PE_OK; ++k) {
        if (!step->soft[k]) {
            /* Each island's numbers in the memory of the one before: it is in the cache. */
            pe_arena_mark before = pe_arena_fill(&world->arena);
            status = begin_island(step, k, &items[begun]);
            if (status == PE_OK && items[begun].solving.sweeps > 0) {
                asking[begun] = &items[begun];
                ++begun;
            } else {
                pe_arena_rewind(&world->arena, &world->allocator, before);
            }
        }
    }
    if (status == PE_OK) {
        status = sweep_islands(step, asking, begun);
    }
    if (status == PE_OK && step->stats.islands_by_path[PE_PATH_SOFT] > 0) {
        status = pe_soft_step(world, &(pe_chosen_islands){&step->islands, step->soft}, step->dt,
                              NULL, NULL, step->error);
    }
    if (step->residual_points > 0) {
        step->stats.residual_rms = sqrt(step->residual_squares / step->residual_points);
    }
    return status;
}

/* Computes the velocities, and the poses that follow from them. */
static pe_status solve_and_move(pe_step *step)
{
    pe_world *world = step->world;
    double mark = seconds_now();
    pe_predict_motion(world, step->islands.place, step->dt, step->free);
    pe_status status = solve_islands(step);
    if (status != PE_OK) {
        return status;
    }
    step->stats.time_solve = lap(&mark);
    const pe_body *bodies = pe_bodies(world);
    for (int slot = 1; slot < world->slot_count; ++slot) {
        if (bodies[slot].alive && !bodies[slot].is_static && step->islands.place[slot] < 0) {
            pe_integrate_free(world, slot, step->free, step->dt);
        }
    }
    pe_bound_energy(step);
    step->stats.time_integrate = lap(&mark);
    return pe_check_motion(step);
}

/* ---- Contacts of the step's end, and corrections ---- */

/* Finds the contacts that the next step solves. Those solved in this step become world->solved. */
static pe_status find_next_contacts(pe_step *step)
{
    pe_world *world = step->world;
    world->previous_dt = step->dt;
    pe_status status = find_contacts(step);
    if (status == PE_OK) {
        pe_contacts_swap(&world->previous, &world->solved);
    }
    return status;
}

static pe_status guard_energy(pe_step *step)
{
    pe_world *world = step->world;
    size_t slots = (size_t)world->slot_count;
    pe_energy_report report;
    pe_islands groups;
    bool *put_back = pe_scratch_zero(world, slots, sizeof *put_back);
    if (put_back == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory to step %zu bodies", slots);
    }
    pe_status status = pe_islands_find_touching(world, &groups, step->error);
    if (status != PE_OK) {
        return status;
    }
    pe_energy_guard(step, &groups, put_back, &report);
    if (pe_scratch_failed(world)) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory to step %zu bodies", slots);
    }
    step->stats.guarded_islands = report.islands;
    const bool bounded = pe_bound_motion(step, put_back);
    if (bounded) { /* the energy of a fall that was taken back may be in other bodies of the group */
        pe_energy_report again;
        pe_energy_guard(step, &groups, put_back, &again);
        pe_bound_motion(step, put_back);
    }
    return report.put_back > 0 || bounded
               ? pe_contacts_update(world, &step->rules, put_back, step->dt, step->error)
               : PE_OK;
}

static void clear_applied_forces(const pe_step *step)
{
    pe_world *world = step->world;
    pe_applied_force *applied = pe_applied_forces(world);
    for (int i = 0; i < world->slot_count && world->has_applied_forces; ++i) {
        pe_vec3 gained =
            pe_sub(pe_twists(world)[i].angular_velocity, step->twists[i].angular_velocity);
        bool rotated = applied[i].rotates;
        applied[i] = (pe_applied_force){0};
        applied[i].acceleration = pe_scale(rotated ? 1 / step->dt : 0, gained);
    }
    world->has_applied_forces = false;
}

static pe_status run_phases(pe_step *step)
{
    pe_world *world = step->world;
    bool stale = world->contacts_stale || step->dt != world->previous_dt;
    step->repeats = !stale && !world->has_applied_forces && world->def.profile != PE_PROFILE_FAST;
    pe_status status = stale ? find_contacts(step) : PE_OK;
    if (status != PE_OK || (status = find_islands(step)) != PE_OK ||
        (status = solve_and_move(step)) != PE_OK || (status = find_next_contacts(step)) != PE_OK) {
        return status;
    }
    double mark = seconds_now();
    if ((status = pe_overlap_begin(step)) == PE_OK &&
        (status = pe_correct_islands(step)) == PE_OK && (status = guard_energy(step)) == PE_OK) {
        status = pe_overlap_end(step);
    }
    if (status == PE_OK) {
        status = pe_check_motion(step);
    }
    step->stats.time_project = lap(&mark);
    return status;
}

pe_status pe_check_dt(double dt, pe_error *error)
{
    return pe_check_range("dt", dt, PE_LEAST_TIME, PE_MOST_TIME, error);
}

pe_status pe_world_step(pe_world *world, double dt, pe_step_stats *stats, pe_error *error)
{
    pe_status status = pe_check_dt(dt, error);
    if (status != PE_OK) {
        return status;
    }
    pe_arena_reset(&world->arena, &world->allocator);
    world->apart_count = 0;
    pe_step step = {
        .world = world,
        .dt = dt,
        .rules = rules_of(world->def.profile),
        .shallow = SHALLOW * world->def.penetration_slop,
        .error = error,
    };
    status = begin_step(&step);
    if (status != PE_OK) {
        return status;
    }
    status = run_phases(&step);
    if (status != PE_OK) {
        undo_step(&step, status);
        return status;
    }
    clear_applied_forces(&step);
    if (stats != NULL) {
        *stats = step.stats;
    }
    return PE_OK;
}
