#include "energy_guard.h"

/* Part of the terms that growth is the difference of, below which it is left alone. */
static const double ROUNDING = 1e-10;

/* Part of the kinetic energy that an island which was solved exactly may gain. */
static const double MOVING_ERROR = 1e-6;

/* Speed, in m/s, that is none: contacts at rest take back rounding with less (problem_build.c). */
static const double STANDING = 1e-6;

typedef struct step_view {
    const pe_free_motion *free;
    const pe_pose *poses;
    const pe_motion *motions;
    double shallow, dt;
} step_view;

/* Of one island, J. */
typedef struct energy {
    double kinetic; /* at the end */
    double growth;
    double motion; /* kinetic, before and after */
    double terms;  /* that growth is the difference of, in size */
    double mass;   /* kg */
} energy;

static pe_vec3 angular_momentum(const pe_mass *mass, const pe_mat3 *rotation, pe_vec3 w)
{
    return pe_rotate(rotation, pe_mul(mass->inertia, pe_unrotate(rotation, w)));
}

static double kinetic_of(const pe_mass *mass, const pe_pose *pose, const pe_motion *motion)
{
    pe_vec3 l = angular_momentum(mass, &pose->rotation, motion->angular_velocity);
    return 0.5 * (mass->mass * pe_dot(motion->velocity, motion->velocity) +
                  pe_dot(l, motion->angular_velocity));
}

static bool has_torque(const pe_load *load)
{
    return pe_dot(load->torque, load->torque) > 0 ||
           pe_dot(load->body_torque, load->body_torque) > 0;
}

/* Work of the torque on a body: its impulse is what the free motion gains of angular momentum. */
static double spinning_work(const pe_world *world, const step_view *step, int slot)
{
    if (!has_torque(&pe_loads(world)[slot])) {
        return 0;
    }
    const pe_mass *mass = &pe_masses(world)[slot];
    const pe_free_motion *free = &step->free[slot];
    pe_vec3 begin = step->motions[slot].angular_velocity;
    pe_vec3 end = pe_motions(world)[slot].angular_velocity;
    pe_pose turned = step->poses[slot];
    pe_pose_move(&turned, pe_v3(0, 0, 0), pe_scale(step->dt, free->mean.angular_velocity));
    pe_vec3 impulse = pe_sub(angular_momentum(mass, &turned.rotation, free->end.angular_velocity),
                             angular_momentum(mass, &step->poses[slot].rotation, begin));
    return 0.5 * pe_dot(impulse, pe_add(begin, end));
}

static void add_body(const pe_world *world, const step_view *step, int slot, energy *e)
{
    const pe_mass *mass = &pe_masses(world)[slot];
    const pe_pose *begin = &step->poses[slot], *end = &pe_poses(world)[slot];
    double before = kinetic_of(mass, begin, &step->motions[slot]);
    double after = kinetic_of(mass, end, &pe_motions(world)[slot]);
    pe_vec3 force = pe_scale(mass->mass / step->dt,
                             pe_sub(step->free[slot].end.velocity, step->motions[slot].velocity));
    pe_vec3 way = pe_sub(end->position, begin->position);
    double work = pe_dot(force, way), spinning = spinning_work(world, step, slot);
    e->kinetic += after;
    e->motion += before + after;
    e->mass += mass->mass;
    e->growth += (after - before) - work - spinning;
    /* Positions and velocities are rounded themselves. */
    double far = pe_length(force) * (pe_length(end->position) + pe_length(way));
    e->terms += before + after + fabs(spinning) + far +
                mass->mass / step->dt * pe_length(step->motions[slot].velocity) * pe_length(way);
}

static double factor_of(const energy *e, bool exact, pe_energy_report *report)
{
    double allowed = ROUNDING * e->terms + STANDING * STANDING * e->mass;
    if (!(e->growth > allowed + (exact ? MOVING_ERROR * e->motion : 0))) {
        return 1;
    }
    report->islands += 1;
    report->removed += e->growth;
    return e->growth < e->kinetic ? sqrt(1 - e->growth / e->kinetic) : 0;
}

static void slow(pe_motion *motion, double factor)
{
    motion->velocity = pe_scale(factor, motion->velocity);
    motion->angular_velocity = pe_scale(factor, motion->angular_velocity);
}

static bool is_shallow(const pe_world *world, const step_view *step, const int *slots, int count)
{
    for (int i = 0; i < count; ++i) {
        pe_vec3 way = pe_sub(pe_poses(world)[slots[i]].position, step->poses[slots[i]].position);
        if (pe_dot(way, way) > step->shallow * step->shallow) {
            return false;
        }
    }
    return true;
}

static bool any_moved(const int *slots, int count, const bool *moved)
{
    for (int i = 0; i < count && moved != NULL; ++i) {
        if (moved[slots[i]]) {
            return true;
        }
    }
    return false;
}

static void guard_bodies(pe_world *world, const step_view *step, const int *slots, int count,
                         bool exact, pe_energy_report *report)
{
    energy e = {0};
    for (int i = 0; i < count; ++i) {
        add_body(world, step, slots[i], &e);
    }
    double factor = factor_of(&e, exact, report);
    for (int i = 0; i < count && factor < 1; ++i) {
        slow(&pe_motions(world)[slots[i]], factor);
    }
    if (factor == 0 && is_shallow(world, step, slots, count)) {
        report->put_back += 1;
        for (int i = 0; i < count; ++i) {
            pe_poses(world)[slots[i]] = step->poses[slots[i]];
        }
    }
}

void pe_energy_guard(pe_world *world, const pe_islands *islands, const pe_free_motion *free,
                     const pe_pose *poses, const pe_motion *motions, const bool *moved,
                     const bool *solved, double shallow, double dt, pe_energy_report *report)
{
    *report = (pe_energy_report){0};
    const step_view step = {
        .free = free, .poses = poses, .motions = motions, .shallow = shallow, .dt = dt};
    for (int k = 0; k < islands->count; ++k) {
        const int *slots = islands->bodies + islands->body_start[k];
        int count = islands->body_start[k + 1] - islands->body_start[k];
        bool exact = solved[slots[0]] && !any_moved(slots, count, moved);
        guard_bodies(world, &step, slots, count, exact, report);
    }
    for (int slot = 1; slot < world->slot_count && moved != NULL; ++slot) {
        if (moved[slot] && islands->place[slot] < 0) {
            guard_bodies(world, &step, &slot, 1, false, report);
        }
    }
}
