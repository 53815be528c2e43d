/* The step: a straight pipeline of phases, each timed. */
#define _POSIX_C_SOURCE 199309L

#include "model/ranges.h"
#include "model/rest.h"
#include "step.h"

#include <string.h>
#include <time.h>

/* In units of the slop: a correction by less waits until motion can pay for it (step.h). */
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

/* Saves poses and velocities; bodies at rest are where they were at the start of the last step. */
static void save_bodies(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pe_step *step = context;
    for (int i = begin; i < end; ++i) {
        const int slot = pe_awake(step->world)[i];
        step->poses[slot] = pe_pose_save(&pe_poses(step->world)[slot]);
        step->twists[slot] = pe_twists(step->world)[slot];
    }
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
    pe_pool_run(world->pool, pe_awake_count(world), PE_BODY_GRAIN, save_bodies, step);
    return PE_OK;
}

/* Puts the bodies back. Where the step was not finite, what may be the cause is forgotten: forces
 * and the impulses of contacts. */
static void undo_step(const pe_step *step, pe_status status)
{
    size_t slots = (size_t)step->world->slot_count;
    if (status == PE_NOT_FINITE) {
        step->world->applied_force_count = 0;
        step->world->has_applied_forces = false;
        step->world->contacts.manifold_count = step->world->contacts.point_count = 0;
    }
    const int *resting = pe_resting_of(step->world);
    for (size_t slot = 0; slot < slots; ++slot) {
        if (!pe_rests(resting, (int)slot)) {
            pe_poses(step->world)[slot] = pe_pose_restore(&step->poses[slot]);
            pe_twists(step->world)[slot] = step->twists[slot];
        }
    }
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
        status = pe_wake_touched(step);
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
    const pe_rest_totals *rest = &world->rest->totals;
    step->stats.islands = step->islands.count + rest->islands;
    step->stats.manifolds = world->contacts.manifold_count + rest->manifolds;
    step->stats.contacts = world->contacts.point_count + rest->points;
    step->stats.islands_by_path[PE_PATH_WARM] = rest->islands;
    step->stats.penetration = rest->penetration;
    if (rest->islands > 0) {
        step->stats.path = PE_PATH_WARM;
        step->stats.stop = PE_STOP_CONVERGED;
        step->stats.residual = rest->residual;
        step->residual_squares = rest->squares;
        step->residual_points = rest->points;
    }
    return status;
}

/* ---- Velocities and poses ---- */

/* Moves the bodies that touch nothing. */
static void integrate_bodies(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pe_step *step = context;
    const pe_body *bodies = pe_bodies(step->world);
    for (int i = begin; i < end; ++i) {
        const int slot = pe_awake(step->world)[i];
        if (step->islands.place[slot] < 0 && !bodies[slot].is_static) {
            pe_integrate_free(step->world, slot, step->free, step->dt);
        }
    }
}

/* Computes the velocities, and the poses that follow from them. */
static pe_status solve_and_move(pe_step *step)
{
    pe_world *world = step->world;
    double mark = seconds_now();
    pe_predict_motion(world, step->islands.place, step->dt, step->free);
    pe_status status = pe_solve_islands(step);
    if (status != PE_OK) {
        return status;
    }
    step->stats.time_solve = lap(&mark);
    pe_pool_run(world->pool, pe_awake_count(world), PE_BODY_GRAIN, integrate_bodies, step);
    pe_bound_energy(step);
    step->stats.time_integrate = lap(&mark);
    return pe_check_motion(step);
}

/* ---- Contacts of the step's end, and corrections ---- */

/* Finds the contacts that the next step solves. Those solved in this step become world->solved, and take
 * the place of the list that was there. So two lists are enough, unless contacts change again in the
 * step. */
static pe_status find_next_contacts(pe_step *step)
{
    pe_world *world = step->world;
    world->previous_dt = step->dt;
    if (world->previous.manifold_array.capacity < world->solved.manifold_array.capacity) {
        pe_contacts_swap(&world->previous, &world->solved);
        pe_contacts_trim(&world->previous, world->contacts.manifold_count, &world->allocator);
    }
    world->solved.manifold_count = world->solved.point_count = 0;
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
    pe_status status = pe_islands_find_touching(world, step->parted, &groups, step->error);
    if (status != PE_OK) {
        return status;
    }
    pe_energy_guard(step, &groups, put_back, &report);
    step->group_place = groups.place;
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
    return report.put_back > 0 || bounded ? pe_update_contacts(step, put_back) : PE_OK;
}

static void clear_applied_forces(const pe_step *step)
{
    pe_world *world = step->world;
    pe_applied_force *applied = world->applied_force_array.items;
    const int *resting = pe_resting_of(world);
    for (int i = 0; i < world->applied_force_count && world->has_applied_forces; ++i) {
        if (pe_rests(resting, i)) {
            continue;
        }
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
    step->repeats =
        !step->stale && !world->has_applied_forces && world->def.profile != PE_PROFILE_FAST;
    pe_status status = step->stale ? find_contacts(step) : PE_OK;
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
    if (status == PE_OK) {
        status = pe_rest_islands(step);
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
        .stale = world->contacts_stale || dt != world->previous_dt,
        .rules = rules_of(world->def.profile),
        .shallow = SHALLOW * world->def.penetration_slop,
        .error = error,
    };
    status = pe_wake_changed(&step);
    if (status == PE_OK) {
        status = begin_step(&step);
    }
    if (status != PE_OK) {
        return status;
    }
    status = run_phases(&step);
    if (status != PE_OK) {
        undo_step(&step, status);
        return status;
    }
    clear_applied_forces(&step);
    step.stats.sleeping = world->rest->totals.sleeping;
    step.stats.sleep_drift = world->rest->sleep_drift;
    if (stats != NULL) {
        *stats = step.stats;
    }
    return PE_OK;
}
