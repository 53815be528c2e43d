/* Which islands are held where they are, which of them come to rest, and what wakes them. */
#include "model/rest.h"
#include "step.h"

/* m/s: an island is held if no point of its bodies is faster, or gets faster by more in a step. Impulses
 * and momenta differ by as much then. It is rounding: a step of gravity at 60 Hz is 0.16 m/s. */
static const double STILL = 1e-12;

/* With sleep: an island falls asleep that has been slower than this, in m/s, for so long, in s. */
static const double SLEEP_SPEED = 0.05, SLEEP_TIME = 0.5;

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
        pe_poses(step->world)[slot] = pe_pose_restore(&step->poses[slot]);
        pe_twists(step->world)[slot] = (pe_twist){0};
    }
    step->held[k] = still;
}

/* ---- Coming to rest ---- */

static bool is_same_pose(const pe_pose *a, const pe_saved_pose *b)
{
    const pe_vec3 x = a->position, y = b->position;
    const pe_quat p = a->orientation, q = b->orientation;
    return x.x == y.x && x.y == y.y && x.z == y.z && p.w == q.w && p.x == q.x && p.y == q.y &&
           p.z == q.z;
}

/* Whether a held body is as it was at the step's start, and the next step has nothing to do for it that
 * this one had not. */
static bool is_unchanged(const pe_step *step, int slot)
{
    const pe_world *world = step->world;
    const pe_record *r = &pe_records(world)[slot];
    return !step->corrected[slot] && pe_is_still(&pe_twists(world)[slot]) &&
           is_same_pose(&pe_poses(world)[slot], &step->poses[slot]) && r->correction.pause == 0 &&
           r->parting.pause == 0 && r->direct.wait == 0 && r->settling.wait == 0 &&
           r->parts.wait == 0;
}

static bool is_island_unchanged(const pe_step *step, int k)
{
    const pe_islands *islands = &step->islands;
    bool unchanged = step->held[k];
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1] && unchanged; ++i) {
        unchanged = is_unchanged(step, islands->bodies[i]);
    }
    return unchanged;
}

/* ---- Falling asleep ---- */

/* Counts how long the island has been slow, and returns whether that is long enough for it to sleep.
 * *speed: of its fastest point, in m/s, at most. */
static bool is_tired(const pe_step *step, int k, double *speed)
{
    const pe_islands *islands = &step->islands;
    const bool slow = pe_is_slow(step, islands, k, SLEEP_SPEED);
    double least = HUGE_VAL;
    *speed = 0;
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
        const int slot = islands->bodies[i];
        const pe_twist *twist = &pe_twists(step->world)[slot];
        pe_record *r = &pe_records(step->world)[slot];
        r->slow_time = slow ? r->slow_time + step->dt : 0;
        least = pe_min(least, r->slow_time);
        *speed =
            pe_max(*speed, speed_of(step->world, slot, twist->velocity, twist->angular_velocity));
    }
    return least >= SLEEP_TIME;
}

/* ---- Both ---- */

/* Lists, by body, the islands that rest or sleep; whether there are any. */
static bool list_candidates(const pe_step *step, pe_rest_choice *choices, int *island_of)
{
    const pe_islands *islands = &step->islands;
    bool any = false;
    for (int k = 0; k < islands->count; ++k) {
        pe_rest_choice *c = &choices[k];
        *c = (pe_rest_choice){.rests = is_island_unchanged(step, k)};
        c->sleeps = step->world->def.sleep && is_tired(step, k, &c->speed) && !c->rests;
        c->rests = c->rests || c->sleeps;
        for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
            island_of[islands->bodies[i]] = c->rests ? k : -1;
        }
        any = any || c->rests;
    }
    return any;
}

/* Drops islands that touch an active body, and those that rest with a manifold that was not kept. */
static void drop_touched(const pe_step *step, const int *island_of, pe_rest_choice *choices)
{
    const pe_contacts *contacts = &step->world->contacts;
    const pe_body *bodies = pe_bodies(step->world);
    for (int i = 0; i < contacts->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(contacts)[i];
        const int of[2] = {island_of[m->a], island_of[m->b]};
        const bool within = of[0] == of[1] || bodies[m->a].is_static || bodies[m->b].is_static;
        for (int side = 0; side < 2; ++side) {
            if (of[side] >= 0 && !(within && (m->kept || choices[of[side]].sleeps))) {
                choices[of[side]].rests = false;
            }
        }
    }
}

static void stop_sleepers(const pe_step *step, const pe_rest_choice *choices)
{
    const pe_islands *islands = &step->islands;
    for (int k = 0; k < islands->count; ++k) {
        for (int i = islands->body_start[k];
             choices[k].rests && choices[k].sleeps && i < islands->body_start[k + 1]; ++i) {
            pe_twists(step->world)[islands->bodies[i]] = (pe_twist){0};
        }
    }
}

pe_status pe_rest_islands(pe_step *step)
{
    pe_world *world = step->world;
    const size_t slots = (size_t)world->slot_count, islands = (size_t)step->islands.count;
    bool any = world->def.sleep;
    for (size_t k = 0; k < islands && !any; ++k) {
        any = step->held[k];
    }
    if (!any) {
        return PE_OK;
    }
    int *island_of = pe_scratch(world, slots, sizeof *island_of);
    pe_rest_choice *choices = pe_scratch(world, islands + 1, sizeof *choices);
    if (island_of == NULL || choices == NULL) {
        return pe_fail(step->error, PE_NO_MEMORY, "no memory for the islands of %zu bodies", slots);
    }
    for (size_t slot = 0; slot < slots; ++slot) {
        island_of[slot] = -1;
    }
    if (!list_candidates(step, choices, island_of)) {
        return PE_OK;
    }
    drop_touched(step, island_of, choices);
    pe_status status = pe_rest_add(world, &step->islands, choices, step->error);
    if (status == PE_OK) {
        stop_sleepers(step, choices);
    }
    return status;
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

pe_status pe_wake_changed(pe_step *step)
{
    pe_world *world = step->world;
    world->rest->sleep_drift = 0;
    pe_status status = pe_rest_begin(world, step->dt, step->error);
    const int *resting = pe_resting_of(world);
    if (status != PE_OK || resting == NULL || !(step->stale || world->has_applied_forces)) {
        return status;
    }
    if (step->stale) {
        pe_rest_mark_all(world);
    }
    for (int slot = 1; slot < world->slot_count && world->has_applied_forces; ++slot) {
        if (pe_rests(resting, slot) && has_force(world, slot)) {
            pe_rest_mark(world, slot);
        }
    }
    status = pe_rest_wake(world, step->error);
    return status == PE_OK ? pe_rest_begin(world, 0, step->error) : status;
}

pe_status pe_update_contacts(pe_step *step, const bool *moved)
{
    step->has_end_islands = false;
    pe_status status = pe_contacts_update(step->world, &step->rules, moved, step->dt, step->error);
    return status == PE_OK ? pe_wake_touched(step) : status;
}
