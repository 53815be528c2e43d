/* Which islands are held where they are, which of them come to rest, and what wakes them. */
#include "model/rest.h"
#include "step.h"

#include <string.h>

/* m/s: an island is held if no point of its bodies is faster, or gets faster by more in a step. Impulses
 * and momenta differ by as much then. It is rounding: a step of gravity at 60 Hz is 0.16 m/s. */
static const double STILL = 1e-12;

/* The speed of the body's fastest point, in m/s, at most. */
static double speed_of(const pe_world *world, int slot, pe_vec3 velocity, pe_vec3 angular_velocity)
{
    return pe_length(velocity) +
           pe_bodies(world)[slot].bounding_radius * pe_length(angular_velocity);
}

static bool has_force(const pe_world *world, int slot)
{
    const pe_applied_force *applied = pe_applied_force_of(world, slot);
    return world->has_applied_forces &&
           (applied->rotates || pe_dot(applied->force, applied->force) > 0 ||
            pe_dot(applied->torque, applied->torque) > 0);
}

bool pe_is_slow(const pe_step *step, const pe_islands *islands, int k, double most)
{
    const pe_world *world = step->world;
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
        const int slot = islands->bodies[i];
        const pe_twist *twist = &pe_twists(world)[slot];
        if (!(speed_of(world, slot, twist->velocity, twist->angular_velocity) <= most) ||
            has_force(world, slot)) {
            return false;
        }
    }
    return true;
}

/* Whether the body was still, and its contacts keep it so. */
static bool stays(const pe_step *step, int slot)
{
    const pe_twist *old = &step->twists[slot], *now = &pe_twists(step->world)[slot];
    const pe_vec3 gained = pe_sub(now->velocity, old->velocity);
    const pe_vec3 spun = pe_sub(now->angular_velocity, old->angular_velocity);
    return speed_of(step->world, slot, old->velocity, old->angular_velocity) <= STILL &&
           speed_of(step->world, slot, gained, spun) <= STILL && !has_force(step->world, slot);
}

void pe_hold_island(pe_step *step, int k)
{
    const pe_islands *islands = &step->islands;
    bool still = true;
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
        const int slot = islands->bodies[i];
        if (!stays(step, slot)) {
            return;
        }
        still = still && pe_is_still(&step->twists[slot]);
    }
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
        const int slot = islands->bodies[i];
        pe_poses(step->world)[slot] = step->poses[slot];
        pe_twists(step->world)[slot] = (pe_twist){0};
    }
    step->held[k] = still;
}

/* ---- Coming to rest ---- */

/* Whether a held body is as it was at the step's start, and the next step has nothing to do for it that
 * this one had not. */
static bool is_unchanged(const pe_step *step, int slot)
{
    const pe_world *world = step->world;
    const pe_record *r = &pe_records(world)[slot];
    return !step->corrected[slot] && pe_is_still(&pe_twists(world)[slot]) &&
           memcmp(&pe_poses(world)[slot], &step->poses[slot], sizeof(pe_pose)) == 0 &&
           r->correction.pause == 0 && r->parting.pause == 0 && r->direct.wait == 0 &&
           r->settling.wait == 0 && r->parts.wait == 0;
}

/* Drops held islands of which a body has changed, and lists the others by body; whether there are
 * any. */
static bool list_held(const pe_step *step, int *island_of)
{
    const pe_islands *islands = &step->islands;
    bool any = false;
    for (int k = 0; k < islands->count; ++k) {
        for (int i = islands->body_start[k]; i < islands->body_start[k + 1] && step->held[k]; ++i) {
            step->held[k] = is_unchanged(step, islands->bodies[i]);
        }
        for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
            island_of[islands->bodies[i]] = step->held[k] ? k : -1;
        }
        any = any || step->held[k];
    }
    return any;
}

/* Drops held islands that touch an active body, or have a manifold that was not kept. */
static void drop_touched(const pe_step *step, const int *island_of)
{
    const pe_contacts *contacts = &step->world->contacts;
    const pe_body *bodies = pe_bodies(step->world);
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        const int a = island_of[m->a], b = island_of[m->b];
        const bool within = a == b || bodies[m->a].is_static || bodies[m->b].is_static;
        if (a >= 0 && !(within && m->kept)) {
            step->held[a] = false;
        }
        if (b >= 0 && !(within && m->kept)) {
            step->held[b] = false;
        }
    }
}

pe_status pe_rest_islands(pe_step *step)
{
    pe_world *world = step->world;
    const size_t slots = (size_t)world->slot_count;
    bool any = false;
    for (int k = 0; k < step->islands.count && !any; ++k) {
        any = step->held[k];
    }
    if (!any) {
        return PE_OK;
    }
    int *island_of = pe_scratch(world, slots, sizeof *island_of);
    if (island_of == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory for the islands of %zu bodies", slots);
    }
    for (size_t slot = 0; slot < slots; ++slot) {
        island_of[slot] = -1;
    }
    if (!list_held(step, island_of)) {
        return PE_OK;
    }
    drop_touched(step, island_of);
    return pe_rest_add(world, &step->islands, step->held, step->error);
}

/* ---- Waking ---- */

/* Gives bodies that were woken in the step what it has of all active bodies. */
static void join_step(pe_step *step)
{
    pe_world *world = step->world;
    const int *woken = world->rest->woken_array.items;
    for (int i = 0; i < world->rest->woken_count; ++i) {
        step->twists[woken[i]] = pe_twists(world)[woken[i]];
        step->free[woken[i]] = pe_predict_body(world, woken[i], false, step->dt);
    }
    world->rest->woken_count = 0;
}

pe_status pe_wake_touched(pe_step *step)
{
    pe_status status = pe_rest_wake_touched(step->world, step->error);
    if (status == PE_OK) {
        join_step(step);
    }
    return status;
}

pe_status pe_wake_changed(pe_step *step, bool all)
{
    pe_world *world = step->world;
    pe_status status = pe_rest_begin(world, step->error);
    const int *resting = pe_resting_of(world);
    if (status != PE_OK || resting == NULL) {
        return status;
    }
    if (all) {
        pe_rest_mark_all(world);
    }
    for (int slot = 1; slot < world->slot_count && world->has_applied_forces; ++slot) {
        if (pe_rests(resting, slot) && has_force(world, slot)) {
            pe_rest_mark(world, slot);
        }
    }
    status = pe_rest_wake(world, step->error);
    return status == PE_OK ? pe_rest_begin(world, step->error) : status;
}

pe_status pe_update_contacts(pe_step *step, const bool *moved)
{
    pe_status status = pe_contacts_update(step->world, &step->rules, moved, step->dt, step->error);
    return status == PE_OK ? pe_wake_touched(step) : status;
}
