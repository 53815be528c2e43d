/* Poses by the velocities: of the bodies of an island, and of those that touch nothing. */
#include "step.h"

#include <string.h>

/* A gap may shrink below 0 by this, in m, before its bodies move by the new velocity; and by the
 * displacement of a transported point. */
static const double CLOSING_SLACK = 1e-9;

/* Speed, in m/s, against which an impulse may act without mattering. */
static const double NEGLIGIBLE_SPEED = 1e-6;

/* Part of the change of a transported point's velocity along the normal in half a step, against
 * which its impulse may act: the error of second order, of which the energy guard takes the gain.
 * With the new velocities its bodies would lose a thousand times as much. */
static const double TURNING_PART = 1;

/* Three steps of a symmetric rule of second order, the second one backwards, make one of fourth
 * (Yoshida 1990, Construction of higher order symplectic integrators, eq. 2.12). */
static const double YOSHIDA[3] = {1.3512071919596576, -1.7024143839193153, 1.3512071919596576};
/* rad: a body that rotates by more in a step takes one step, because three would not converge. */
static const double MAX_ROTATION = 0.5;

/* The k-th of the six numbers. */
static double component(const pe_twist *twist, int k)
{
    return pe_component(k < 3 ? twist->velocity : twist->angular_velocity, k % 3);
}

/* Whether a gap of the manifold closes within dt at these velocities. */
static bool closes(const pe_world *world, const pe_island_problem *island,
                   const pe_solver_manifold *manifold, const double (*velocity)[6], double dt)
{
    const pe_manifold_point *points = pe_manifold_points(&world->contacts);
    double q[6], u[3];
    pe_solver_manifold_twist(manifold, velocity, q);
    for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
        double gap = points[island->point_of[j]].separation;
        pe_point_velocity(&island->problem.point[j], q, u);
        pe_point_take_bias(&island->problem.point[j], u);
        if (gap + dt * u[0] < pe_min(0, gap) - CLOSING_SLACK - dt * island->normal_change[j]) {
            return true;
        }
    }
    return false;
}

/* Whether the manifold pushes, and whether it would add energy at these sums of old and new
 * velocity. */
static bool pushes(const pe_island_problem *island, const pe_solver_manifold *manifold,
                   const double (*sum)[6], bool *adds)
{
    const pe_problem *problem = &island->problem;
    double q[6], moment[3], normal = 0, work = 0;
    double allowed = 0;
    pe_solver_manifold_twist(manifold, sum, q);
    for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
        const double *p = problem->impulse[j];
        pe_cross3(q + 3, problem->point[j].s, moment);
        for (int k = 0; k < 3; ++k) {
            work += p[k] * (q[k] + moment[k]);
        }
        normal += p[0];
        allowed += p[0] * (NEGLIGIBLE_SPEED + TURNING_PART * island->normal_change[j]);
    }
    *adds = work > allowed;
    return normal > 0;
}

/* What is found of each manifold before it is known which bodies move late. */
typedef struct manifold_motion {
    bool pushes, adds; /* as by `pushes` */
    bool closes;       /* at the mean velocities of bodies that do not move late */
} manifold_motion;

/* The motion of an island's bodies. */
typedef struct motion {
    pe_step *step;
    const pe_interval *interval;
    const pe_island_problem *island;
    pe_moved moved;
    double (*sum)[6];           /* as mean: sums of old and new velocities */
    manifold_motion *manifolds; /* (manifolds) */
} motion;

static pe_status take_motion(motion *m)
{
    pe_world *world = m->step->world;
    const pe_problem *problem = &m->island->problem;
    size_t bodies = (size_t)problem->body_count + 1, manifolds = (size_t)problem->manifold_count;
    m->moved.mean = pe_scratch(world, bodies, sizeof *m->moved.mean);
    m->sum = pe_scratch(world, bodies, sizeof *m->sum);
    m->moved.late = pe_scratch_zero(world, bodies, sizeof *m->moved.late);
    m->manifolds = pe_scratch(world, manifolds + 1, sizeof *m->manifolds);
    if (pe_scratch_failed(world)) {
        return pe_fail(m->step->error, PE_NO_MEMORY, "no memory to move %d bodies",
                       problem->body_count);
    }
    memset(m->moved.mean[problem->body_count], 0, sizeof *m->moved.mean);
    memset(m->sum[problem->body_count], 0, sizeof *m->sum);
    m->moved.late[problem->body_count] = true; /* static bodies need no flag */
    return PE_OK;
}

static void begin_bodies(void *context, int worker, int begin, int end)
{
    (void)worker;
    const motion *m = context;
    const pe_island_problem *island = m->island;
    for (int i = begin; i < end; ++i) {
        const pe_twist *drift = &m->interval->free[island->slot[i]].mean;
        const pe_twist *old = &pe_twists(m->step->world)[island->slot[i]];
        const double *v = island->problem.velocity[i];
        const double *predicted = island->problem.free_velocity[i];
        for (int k = 0; k < 6; ++k) {
            m->moved.mean[i][k] = component(drift, k) + 0.5 * (v[k] - predicted[k]);
            m->sum[i][k] = component(old, k) + v[k];
        }
    }
}

static bool closes_now(const motion *m, int i)
{
    return closes(m->step->world, m->island, &m->island->problem.manifold[i],
                  (const double(*)[6])m->moved.mean, m->interval->dt);
}

static void begin_manifolds(void *context, int worker, int begin, int end)
{
    (void)worker;
    const motion *m = context;
    for (int i = begin; i < end; ++i) {
        manifold_motion *now = &m->manifolds[i];
        now->pushes = pushes(m->island, &m->island->problem.manifold[i], (const double(*)[6])m->sum,
                             &now->adds);
        now->closes = closes_now(m, i);
    }
}

/* Flags the bodies that move by their new velocities, which become their mean ones. */
static void find_late(motion *m)
{
    const pe_problem *problem = &m->island->problem;
    bool *late = m->moved.late;
    for (bool changed = true; changed;) {
        changed = false;
        for (int i = 0; i < problem->manifold_count; ++i) {
            const manifold_motion *now = &m->manifolds[i];
            const int a = problem->manifold[i].a, b = problem->manifold[i].b;
            if (late[a] && late[b]) {
                continue;
            }
            const bool dynamic_late =
                (late[a] && a != problem->body_count) || (late[b] && b != problem->body_count);
            if ((now->pushes && (now->adds || dynamic_late)) ||
                (dynamic_late ? closes_now(m, i) : now->closes)) {
                late[a] = late[b] = changed = true;
                memcpy(m->moved.mean[a], problem->velocity[a], sizeof *m->moved.mean);
                memcpy(m->moved.mean[b], problem->velocity[b], sizeof *m->moved.mean);
            }
        }
    }
}

/* The angular impulse of body i's contacts acts half before and half after its rotation, or at an
 * impact all before it. So the rotation is about the new angular velocity and keeps the energy. */
static void split_impulse(const pe_interval *interval, const pe_island_problem *island, int i,
                          bool late, pe_vec3 impulses[2])
{
    const pe_problem *problem = &island->problem;
    double change[3], impulse[3];
    for (int k = 0; k < 3; ++k) {
        change[k] = problem->velocity[i][3 + k] - problem->free_velocity[i][3 + k];
    }
    pe_symmetric_times(problem->inertia[i].tensor, change, impulse);
    pe_vec3 applied = pe_scale(0.5 * interval->dt, interval->free[island->slot[i]].torque);
    impulses[0] = pe_madd(applied, late ? 1 : 0.5, pe_v3_load(impulse));
    impulses[1] = pe_madd(applied, late ? 0 : 0.5, pe_v3_load(impulse));
}

static void move_bodies(void *context, int worker, int begin, int end)
{
    (void)worker;
    const motion *m = context;
    const pe_interval *interval = m->interval;
    pe_world *world = m->step->world;
    for (int i = begin; i < end; ++i) {
        int slot = m->island->slot[i];
        pe_vec3 impulses[2], last, mean;
        split_impulse(interval, m->island, i, m->moved.late[i], impulses);
        pe_rotate_freely(world, slot, interval->dt, impulses, &last, &mean);
        pe_twists(world)[slot] = (pe_twist){pe_v3_load(m->island->problem.velocity[i]), last};
        pe_pose_move(&pe_poses(world)[slot], pe_scale(interval->dt, pe_v3_load(m->moved.mean[i])),
                     pe_scale(interval->dt, mean));
    }
}

pe_status pe_island_move(pe_step *step, const pe_interval *interval,
                         const pe_island_problem *island, pe_moved *moved)
{
    const pe_problem *problem = &island->problem;
    motion m = {.step = step, .interval = interval, .island = island};
    pe_status status = take_motion(&m);
    if (status != PE_OK) {
        return status;
    }
    pe_pool_run(problem->pool, problem->body_count, PE_PROBLEM_BODY_GRAIN, begin_bodies, &m);
    pe_pool_run(problem->pool, problem->manifold_count, PE_MANIFOLD_GRAIN, begin_manifolds, &m);
    find_late(&m);
    pe_pool_run(problem->pool, problem->body_count, PE_PROBLEM_BODY_GRAIN, move_bodies, &m);
    *moved = m.moved;
    return PE_OK;
}

/* ---- Bodies without contacts ---- */

/* Whether no torque acts on the body, and its rotation is not that of a sphere. */
static bool spins_freely(const pe_world *world, int slot, const pe_free_motion *free, double dt)
{
    pe_vec3 torque = free->torque, w = pe_twists(world)[slot].angular_velocity;
    double angle2 = dt * dt * pe_dot(w, w);
    return !pe_masses(world)[slot].spherical && pe_dot(torque, torque) == 0 && angle2 > 0 &&
           angle2 < MAX_ROTATION * MAX_ROTATION;
}

void pe_integrate_free(pe_world *world, int slot, const pe_free_motion *free, double dt)
{
    const pe_vec3 none = {0, 0, 0}, no_impulses[2] = {{0, 0, 0}, {0, 0, 0}};
    pe_pose *pose = &pe_poses(world)[slot];
    pe_twist *twist = &pe_twists(world)[slot];
    pe_vec3 displacement = pe_scale(dt, free[slot].mean.velocity);
    if (!spins_freely(world, slot, &free[slot], dt)) {
        *twist = free[slot].end;
        pe_pose_move(pose, displacement, pe_scale(dt, free[slot].mean.angular_velocity));
        return;
    }
    for (int k = 0; k < 3; ++k) {
        double h = YOSHIDA[k] * dt;
        pe_vec3 mean;
        pe_rotate_freely(world, slot, h, no_impulses, &twist->angular_velocity, &mean);
        pe_pose_move(pose, none, pe_scale(h, mean));
    }
    twist->velocity = free[slot].end.velocity;
    pe_pose_move(pose, displacement, none);
}
