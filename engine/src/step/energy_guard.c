#include "energy_guard.h"

/* Part of the terms that growth is the difference of, below which it is left alone. */
static const double ROUNDING = 1e-10;

/* Part of the kinetic energy that an island which was solved exactly may gain. */
static const double MOVING_ERROR = 1e-6;

/* Height, in m, by which a contact that was solved may lift what lies on it in a step, to take back
 * rounding (problem_build.c). */
static const double TAKEN_BACK = 1e-10;

/* Part of the speed that projection must leave. */
static const double LEFT = 0.5;

/* Speed, in m/s, that is none: contacts at rest take back rounding with less (problem_build.c). */
static const double STANDING = 1e-6;

/* Of one island, J. */
typedef struct energy {
    double kinetic; /* at the end */
    double growth;
    double motion; /* kinetic, before and after */
    double terms;  /* that growth is the difference of, in size */
    double mass;   /* kg */
    double force;  /* N, in size */
} energy;

static pe_vec3 angular_momentum(const pe_mass *mass, const pe_mat3 *rotation, pe_vec3 w)
{
    return pe_rotate(rotation, pe_mul(mass->inertia, pe_unrotate(rotation, w)));
}

static double kinetic_of(const pe_mass *mass, const pe_pose *pose, const pe_twist *motion)
{
    pe_vec3 l = angular_momentum(mass, &pose->rotation, motion->angular_velocity);
    return 0.5 * (mass->mass * pe_dot(motion->velocity, motion->velocity) +
                  pe_dot(l, motion->angular_velocity));
}

static bool has_torque(const pe_applied_force *load)
{
    return pe_dot(load->torque, load->torque) > 0 ||
           pe_dot(load->body_torque, load->body_torque) > 0;
}

/* Work of the torque on a body: its impulse is what the free motion gains of angular momentum. */
static double spinning_work(const pe_world *world, const pe_energy_step *step, int slot)
{
    if (!has_torque(&pe_applied_forces(world)[slot])) {
        return 0;
    }
    const pe_mass *mass = &pe_masses(world)[slot];
    const pe_free_motion *free = &step->free[slot];
    pe_vec3 begin = step->motions[slot].angular_velocity;
    pe_vec3 end = pe_twists(world)[slot].angular_velocity;
    pe_pose turned = step->poses[slot];
    pe_pose_move(&turned, pe_v3(0, 0, 0), pe_scale(step->dt, free->mean.angular_velocity));
    pe_vec3 impulse = pe_sub(angular_momentum(mass, &turned.rotation, free->end.angular_velocity),
                             angular_momentum(mass, &step->poses[slot].rotation, begin));
    return 0.5 * pe_dot(impulse, pe_add(begin, end));
}

static void add_body(const pe_world *world, const pe_energy_step *step, int slot, energy *e)
{
    const pe_mass *mass = &pe_masses(world)[slot];
    const pe_pose *begin = &step->poses[slot], *end = &pe_poses(world)[slot];
    double before = kinetic_of(mass, begin, &step->motions[slot]);
    double after = kinetic_of(mass, end, &pe_twists(world)[slot]);
    pe_vec3 force = pe_scale(mass->mass / step->dt,
                             pe_sub(step->free[slot].end.velocity, step->motions[slot].velocity));
    pe_vec3 way = pe_sub(end->position, begin->position);
    double work = pe_dot(force, way), spinning = spinning_work(world, step, slot);
    e->kinetic += after;
    e->motion += before + after;
    e->mass += mass->mass;
    e->force += pe_length(force);
    e->growth += (after - before) - work - spinning;
    /* Positions and velocities are rounded themselves. */
    double far = pe_length(force) * (pe_length(end->position) + pe_length(way));
    e->terms += before + after + fabs(spinning) + far +
                mass->mass / step->dt * pe_length(step->motions[slot].velocity) * pe_length(way);
}

static energy energy_of(const pe_world *world, const pe_energy_step *step, const int *slots,
                        int count)
{
    energy e = {0};
    for (int i = 0; i < count; ++i) {
        add_body(world, step, slots[i], &e);
    }
    return e;
}

/* Of the velocities that leave no growth; 0: there are none. */
static double factor_of(const energy *e, bool exact)
{
    double allowed = ROUNDING * e->terms + STANDING * STANDING * e->mass;
    if (!(e->growth > allowed + (exact ? MOVING_ERROR * e->motion : 0))) {
        return 1;
    }
    return e->growth < e->kinetic ? sqrt(1 - e->growth / e->kinetic) : 0;
}

static void slow(pe_twist *motion, double factor)
{
    motion->velocity = pe_scale(factor, motion->velocity);
    motion->angular_velocity = pe_scale(factor, motion->angular_velocity);
}

static bool has_moved(const pe_energy_step *step, int slot)
{
    return step->moved != NULL && step->moved[slot];
}

static bool any_moved(const pe_energy_step *step, const int *slots, int count)
{
    for (int i = 0; i < count; ++i) {
        if (has_moved(step, slots[i])) {
            return true;
        }
    }
    return false;
}

static bool all_solved(const pe_energy_step *step, const int *slots, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!step->solved[slots[i]]) {
            return false;
        }
    }
    return true;
}

/* No body is farther than `shallow` from `poses`, flagged ones alone. */
static bool is_shallow(const pe_world *world, const pe_energy_step *step, const pe_pose *poses,
                       const bool *flags, const int *slots, int count)
{
    for (int i = 0; i < count; ++i) {
        int slot = slots[i];
        if (flags == NULL || flags[slot]) {
            pe_vec3 way = pe_sub(pe_poses(world)[slot].position, poses[slot].position);
            if (pe_dot(way, way) > step->shallow * step->shallow) {
                return false;
            }
        }
    }
    return true;
}

/* Takes back the projection. Returns the factor of the velocities. */
static double unproject(pe_world *world, const pe_energy_step *step, const int *slots, int count,
                        bool *put_back)
{
    for (int i = 0; i < count; ++i) {
        int slot = slots[i];
        if (has_moved(step, slot)) {
            pe_poses(world)[slot] = step->unprojected_poses[slot];
            pe_twists(world)[slot] = step->unprojected_motions[slot];
            put_back[slot] = true;
        }
    }
    energy e = energy_of(world, step, slots, count);
    return e.growth < TAKEN_BACK * count * e.force ? 1 : factor_of(&e, true);
}

static void guard_bodies(pe_world *world, const pe_energy_step *step, const int *slots, int count,
                         bool *put_back, pe_energy_report *report)
{
    bool projected = any_moved(step, slots, count), solved = all_solved(step, slots, count);
    energy e = energy_of(world, step, slots, count);
    double factor = factor_of(&e, solved && !projected);
    if (factor == 1) {
        return;
    }
    report->islands += 1;
    report->removed += e.growth;
    bool waits = projected && solved && factor < LEFT &&
                 is_shallow(world, step, step->unprojected_poses, step->moved, slots, count);
    if (waits) {
        factor = unproject(world, step, slots, count, put_back);
    }
    for (int i = 0; i < count; ++i) {
        slow(&pe_twists(world)[slots[i]], factor);
    }
    bool returns = factor == 0 && is_shallow(world, step, step->poses, NULL, slots, count);
    for (int i = 0; i < count && returns; ++i) {
        pe_poses(world)[slots[i]] = step->poses[slots[i]];
        put_back[slots[i]] = true;
    }
    report->put_back += waits || returns;
}

void pe_energy_guard(pe_world *world, const pe_islands *islands, const pe_energy_step *step,
                     bool *put_back, pe_energy_report *report)
{
    *report = (pe_energy_report){0};
    for (int k = 0; k < islands->count; ++k) {
        const int *slots = islands->bodies + islands->body_start[k];
        int count = islands->body_start[k + 1] - islands->body_start[k];
        guard_bodies(world, step, slots, count, put_back, report);
    }
    for (int slot = 1; slot < world->slot_count; ++slot) {
        if (has_moved(step, slot) && islands->place[slot] < 0) {
            guard_bodies(world, step, &slot, 1, put_back, report);
        }
    }
}
