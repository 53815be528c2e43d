/* Bounds that hold in every step, however badly a contact problem was solved. */
#include "model/ranges.h"
#include "model/rest.h"
#include "step.h"

#include <stdatomic.h>

/* In units of the least half extent: how far a body may move in a step beyond what its velocities
 * explain. */
static const double UNEXPLAINED = 0.5;

/* A body that pays gets slower, so that it may move less far. */
enum { BOUND_PASSES = 3 };

/* Contacts cannot give an island energy. One whose kinetic energy grows by more than this factor of
 * what it has, before the step or after a step without contacts, was not solved at all. */
static const double MOST_GAIN = 4;

/* What collision can take: products of eight stay finite. m; m/s and rad/s. */
static const double MOST_PLACE = 1e15, MOST_VELOCITY = 1e30;

static double kinetic_energy(const pe_mass *mass, const pe_pose *pose, const pe_twist *twist)
{
    pe_vec3 w = pe_unrotate(&pose->rotation, twist->angular_velocity);
    return 0.5 * (mass->mass * pe_dot(twist->velocity, twist->velocity) +
                  pe_dot(pe_mul(mass->inertia, w), w));
}

/* ---- Energy of islands ---- */

/* The part of the velocities that leaves the island MOST_GAIN times the energy it had; 1: all; 0 where
 * its energy is not finite. */
static double part_of_island(const pe_step *step, int k)
{
    const pe_islands *islands = &step->islands;
    double before = 0, after = 0;
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
        int slot = islands->bodies[i];
        const pe_mass *mass = &pe_masses(step->world)[slot];
        const pe_pose start = pe_pose_restore(&step->poses[slot]);
        before += kinetic_energy(mass, &start, &step->twists[slot]);
        before += kinetic_energy(mass, &start, &step->free[slot].end);
        after += kinetic_energy(mass, &pe_poses(step->world)[slot], &pe_twists(step->world)[slot]);
    }
    if (!isfinite(after)) {
        return 0;
    }
    return after > MOST_GAIN * before ? sqrt(MOST_GAIN * before / after) : 1;
}

/* A part of a vector, which may be infinite or NaN where the part is 0. */
static pe_vec3 part_of(double part, pe_vec3 x)
{
    return part > 0 ? pe_scale(part, x) : pe_v3(0, 0, 0);
}

/* Moves the island's bodies from the step's start by a part of their new velocities, and scales the
 * impulses that these came from. */
static void slow_down(const pe_step *step, int k, double part)
{
    const pe_islands *islands = &step->islands;
    for (int i = islands->body_start[k]; i < islands->body_start[k + 1]; ++i) {
        int slot = islands->bodies[i];
        pe_twist *twist = &pe_twists(step->world)[slot];
        twist->velocity = part_of(part, twist->velocity);
        twist->angular_velocity = part_of(part, twist->angular_velocity);
        pe_poses(step->world)[slot] = pe_pose_restore(&step->poses[slot]);
        pe_pose_move(&pe_poses(step->world)[slot], pe_scale(step->dt, twist->velocity),
                     pe_scale(step->dt, twist->angular_velocity));
    }
    pe_point_walk at = pe_walk_island(&step->world->contacts, islands, k);
    while (pe_next_point(&at)) {
        at.point->impulse = part_of(part, at.point->impulse);
    }
}

static void bound_islands(void *context, int worker, int begin, int end)
{
    (void)worker;
    const pe_step *step = context;
    for (int k = begin; k < end; ++k) {
        double part = part_of_island(step, k);
        if (part < 1) {
            slow_down(step, k, part);
        }
    }
}

void pe_bound_energy(pe_step *step)
{
    pe_pool_run(step->world->pool, step->islands.count, PE_ISLAND_GRAIN, bound_islands, step);
}

/* ---- Finite numbers ---- */

/* What of the body's state collision cannot take; NULL: nothing. */
static const char *fault_of(const pe_pose *pose, const pe_twist *twist, pe_vec3 *found)
{
    *found = pose->position;
    if (!pe_is_within(pose->position, MOST_PLACE)) {
        return "position";
    }
    *found = twist->velocity;
    if (!pe_is_within(twist->velocity, MOST_VELOCITY)) {
        return "velocity";
    }
    *found = twist->angular_velocity;
    if (!pe_is_within(twist->angular_velocity, MOST_VELOCITY)) {
        return "angular velocity";
    }
    const pe_quat q = pose->orientation;
    *found = pe_v3(q.x, q.y, q.z);
    return fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) < 1e-3 ? NULL : "orientation";
}

/* The first of the awake bodies `begin` to `end` with such a state; -1: none. */
static int find_fault(const pe_step *step, int begin, int end, const char **what, pe_vec3 *found)
{
    for (int i = begin; i < end; ++i) {
        const int slot = pe_awake(step->world)[i];
        const bool was_checked = step->group_place != NULL && step->group_place[slot] < 0 &&
                                 step->islands.place[slot] < 0 && !step->corrected[slot];
        if (!was_checked) {
            *what = fault_of(&pe_poses(step->world)[slot], &pe_twists(step->world)[slot], found);
            if (*what != NULL) {
                return slot;
            }
        }
    }
    return -1;
}

/* The check of all bodies. */
typedef struct check {
    const pe_step *step;
    atomic_bool failed;
} check;

static void check_bodies(void *context, int worker, int begin, int end)
{
    (void)worker;
    check *c = context;
    const char *what;
    pe_vec3 found;
    if (find_fault(c->step, begin, end, &what, &found) >= 0) {
        atomic_store_explicit(&c->failed, true, memory_order_relaxed);
    }
}

static pe_status refuse_motion(const pe_step *step, int slot, const char *what, pe_vec3 found)
{
    return pe_fail(step->error, PE_NOT_FINITE,
                   "body (%d, %u): expected a finite %s within 1e15 m, 1e30 m/s or "
                   "1e30 rad/s after a step of %g s, found (%g, %g, %g)",
                   slot, pe_bodies(step->world)[slot].generation, what, step->dt, found.x, found.y,
                   found.z);
}

pe_status pe_check_motion(const pe_step *step)
{
    const pe_world *world = step->world;
    check c = {.step = step};
    pe_pool_run(world->pool, pe_awake_count(world), PE_BODY_GRAIN, check_bodies, &c);
    const char *what;
    pe_vec3 found;
    const int slot = c.failed ? find_fault(step, 0, pe_awake_count(world), &what, &found) : -1;
    return slot < 0 ? PE_OK : refuse_motion(step, slot, what, found);
}

pe_status pe_check_bodies(const pe_step *step, const int *slots, int count)
{
    for (int i = 0; i < count; ++i) {
        pe_vec3 found;
        const char *what =
            fault_of(&pe_poses(step->world)[slots[i]], &pe_twists(step->world)[slots[i]], &found);
        if (what != NULL) {
            return refuse_motion(step, slots[i], what, found);
        }
    }
    return PE_OK;
}

/* ---- Motion of bodies ---- */

/* The rotation vector from a to b, of at most pi. */
static pe_vec3 rotation_between(pe_quat a, pe_quat b)
{
    pe_quat d = pe_quat_product(b, pe_quat_conjugate(a));
    pe_vec3 v = pe_v3(d.x, d.y, d.z);
    double sine = pe_length(v), angle = 2 * atan2(sine, fabs(d.w));
    return sine > 0 ? pe_scale((d.w < 0 ? -angle : angle) / sine, v) : pe_v3(0, 0, 0);
}

/* How far the body may have moved by its velocities, in m, and what it may have moved beyond that. */
static double longest_path(const pe_step *step, int slot, double speed)
{
    pe_vec3 change = pe_sub(step->free[slot].end.velocity, step->twists[slot].velocity);
    return step->dt * (speed + pe_length(change)) + UNEXPLAINED * pe_bodies(step->world)[slot].size;
}

/* Takes back what the body has moved too far and, if it pays, the work of the forces on it along
 * that. Returns whether it has. */
static bool bound_path(const pe_step *step, int slot, bool pays)
{
    const pe_twist *old = &step->twists[slot];
    const pe_mass *mass = &pe_masses(step->world)[slot];
    pe_twist *now = &pe_twists(step->world)[slot];
    pe_pose *pose = &pe_poses(step->world)[slot];
    pe_vec3 path = pe_sub(pose->position, step->poses[slot].position);
    double speed = pe_max(pe_length(old->velocity), pe_length(now->velocity));
    double most = longest_path(step, slot, speed), length = pe_length(path);
    if (length <= most) {
        return false;
    }
    pose->position = pe_madd(step->poses[slot].position, most / length, path);
    pe_vec3 force =
        pe_scale(mass->mass / step->dt, pe_sub(step->free[slot].end.velocity, old->velocity));
    double work = (1 - most / length) * pe_dot(force, path);
    double kinetic = kinetic_energy(mass, pose, now);
    if (pays && work > 0) {
        double part = work < kinetic ? sqrt(1 - work / kinetic) : 0;
        now->velocity = pe_scale(part, now->velocity);
        now->angular_velocity = pe_scale(part, now->angular_velocity);
    }
    return true;
}

/* The same of what it has rotated too far; its angular velocity rotates with it and keeps its
 * energy. */
static bool bound_rotation(const pe_step *step, int slot)
{
    const pe_body *body = &pe_bodies(step->world)[slot];
    const pe_twist *old = &step->twists[slot], *free = &step->free[slot].end;
    pe_twist *now = &pe_twists(step->world)[slot];
    pe_pose *pose = &pe_poses(step->world)[slot];
    const double h = step->dt;
    pe_vec3 turn = rotation_between(step->poses[slot].orientation, pose->orientation);
    double speed = pe_max(pe_length(old->velocity), pe_length(now->velocity));
    double spin = pe_max(pe_length(old->angular_velocity), pe_length(now->angular_velocity));
    pe_vec3 change = pe_sub(free->angular_velocity, old->angular_velocity);
    bool twisted = pe_has_torque(pe_applied_force_of(step->world, slot));
    /* Rotation without a torque may be faster in between: by h w^2 at most. */
    double most = h * (spin + (twisted ? pe_length(change) : 0) + h * spin * spin) +
                  (h * speed + UNEXPLAINED * body->size) / body->bounding_radius;
    double angle = pe_length(turn);
    if (angle <= most) {
        return false;
    }
    pe_vec3 w = pe_unrotate(&pose->rotation, now->angular_velocity);
    pose->orientation = step->poses[slot].orientation;
    pose->rotation = pe_matrix_of(pose->orientation);
    pe_pose_move(pose, pe_v3(0, 0, 0), pe_scale(most / angle, turn));
    now->angular_velocity = pe_rotate(&pose->rotation, w);
    return true;
}

/* Whether the body has moved by less than what needs no explanation. */
static bool moved_little(const pe_step *step, int slot)
{
    const pe_body *body = &pe_bodies(step->world)[slot];
    const pe_saved_pose *from = &step->poses[slot];
    const pe_pose *to = &pe_poses(step->world)[slot];
    pe_vec3 path = pe_sub(to->position, from->position);
    pe_quat turn = pe_quat_product(to->orientation, pe_quat_conjugate(from->orientation));
    double most = UNEXPLAINED * body->size, most_turn = most / body->bounding_radius;
    double sine2 = turn.x * turn.x + turn.y * turn.y + turn.z * turn.z; /* of half the angle */
    /* An angle up to pi is at most pi times the sine of its half, and pi^2 < 10. */
    return pe_dot(path, path) <= most * most && 10 * sine2 <= most_turn * most_turn;
}

static bool bound_body(const pe_step *step, int slot)
{
    if (moved_little(step, slot)) {
        return false;
    }
    bool bounded = false;
    for (int i = 0; i < BOUND_PASSES && bound_path(step, slot, i + 1 < BOUND_PASSES); ++i) {
        bounded = true;
    }
    return bound_rotation(step, slot) || bounded;
}

/* The bound on all bodies. */
typedef struct bounding {
    const pe_step *step;
    bool *put_back;
    atomic_bool any;
} bounding;

static void bound_bodies(void *context, int worker, int begin, int end)
{
    (void)worker;
    bounding *b = context;
    const pe_step *step = b->step;
    for (int i = begin; i < end; ++i) {
        const int slot = pe_awake(step->world)[i];
        if (step->islands.place[slot] < 0 && !step->corrected[slot]) {
            continue;
        }
        if (!pe_bodies(step->world)[slot].is_static && bound_body(step, slot)) {
            b->put_back[slot] = true;
            atomic_store_explicit(&b->any, true, memory_order_relaxed);
        }
    }
}

bool pe_bound_motion(const pe_step *step, bool *put_back)
{
    bounding b = {.step = step};
    b.put_back = put_back;
    pe_pool_run(step->world->pool, pe_awake_count(step->world), PE_BODY_GRAIN, bound_bodies, &b);
    return b.any;
}
