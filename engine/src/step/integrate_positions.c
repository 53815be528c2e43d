#include "integrate_positions.h"

#include <string.h>

/* A gap may shrink below 0 by this, in m, before its bodies move by the new velocity; and by what a
 * carried point swings. */
static const double CLOSING_SLACK = 1e-9;

static pe_vec3 vector(const double v[3])
{
    return pe_v3(v[0], v[1], v[2]);
}

static bool closes(const pe_world *world, const pe_island_problem *island,
                   const pe_solver_manifold *patch, const double (*velocity)[6], double dt)
{
    const pe_manifold_point *points = pe_manifold_points(&world->contacts);
    double q[6], u[3];
    pe_solver_manifold_twist(patch, velocity, q);
    for (int j = patch->first; j < patch->first + patch->count; ++j) {
        double gap = points[island->point_of[j]].separation;
        pe_point_velocity(&island->problem.point[j], q, u);
        pe_point_take_bias(&island->problem.point[j], u);
        if (gap + dt * u[0] < pe_min(0, gap) - CLOSING_SLACK - dt * island->normal_change[j]) {
            return true;
        }
    }
    return false;
}

/* Speed, in m/s, against which an impulse may act without mattering. */
static const double STANDING = 1e-6;

/* Part of the kinetic energy of its bodies that a patch which is carried may add: less than the
 * energy guard lets pass. */
static const double MOVING_ERROR = 2e-6;

/* Kinetic energy of body i, J. */
static double motion_of(const pe_problem *problem, int i)
{
    double momentum[6];
    pe_mass_times(&problem->inertia[i], problem->velocity[i], momentum);
    return 0.5 * (pe_dot3(momentum, problem->velocity[i]) +
                  pe_dot3(momentum + 3, problem->velocity[i] + 3));
}

/* Whether the patch pushes, and whether it would add energy at these sums of old and new velocity.
 */
static bool pushes(const pe_island_problem *island, const pe_solver_manifold *patch,
                   const double (*sum)[6], bool *adds)
{
    const pe_problem *problem = &island->problem;
    double q[6], moment[3], normal = 0, work = 0;
    bool swings = false;
    pe_solver_manifold_twist(patch, sum, q);
    for (int j = patch->first; j < patch->first + patch->count; ++j) {
        const double *p = problem->impulse[j];
        pe_cross3(q + 3, problem->point[j].s, moment);
        for (int k = 0; k < 3; ++k) {
            work += p[k] * (q[k] + moment[k]);
        }
        normal += p[0];
        swings |= island->normal_change[j] > 0;
    }
    double allowed = STANDING * normal;
    if (swings) {
        allowed += MOVING_ERROR * (motion_of(problem, patch->a) + motion_of(problem, patch->b));
    }
    *adds = work > allowed;
    return normal > 0;
}

/* The angular impulse of body i's contacts acts in two halves about its turn, or at an impact
 * before it, so that the turn is about the new angular velocity and takes no part in the energy. */
static void turn_body(const pe_world *world, const pe_island_problem *island,
                      const pe_free_motion *free, int i, bool late, double dt, pe_vec3 *end,
                      pe_vec3 *mean)
{
    const pe_problem *problem = &island->problem;
    double change[3], impulse[3];
    for (int k = 0; k < 3; ++k) {
        change[k] = problem->velocity[i][3 + k] - problem->free_velocity[i][3 + k];
    }
    pe_symmetric_times(problem->inertia[i].tensor, change, impulse);
    pe_vec3 loads = pe_scale(0.5 * dt, free[island->slot[i]].torque), contacts = vector(impulse);
    pe_turn(world, island->slot[i], dt, pe_madd(loads, late ? 1 : 0.5, contacts),
            pe_madd(loads, late ? 0 : 0.5, contacts), end, mean);
}

/* Marks the bodies that move by their new velocities, in `late`, and sets these in `mean`. */
static void find_late(const pe_world *world, const pe_island_problem *island,
                      const double (*sum)[6], double dt, double (*mean)[6], bool *late)
{
    const pe_problem *problem = &island->problem;
    for (bool changed = true; changed;) {
        changed = false;
        for (int i = 0; i < problem->manifold_count; ++i) {
            const pe_solver_manifold *patch = &problem->manifold[i];
            bool adds;
            if (late[patch->a] && late[patch->b]) {
                continue;
            }
            bool dynamic_late = (late[patch->a] && patch->a != problem->body_count) ||
                                (late[patch->b] && patch->b != problem->body_count);
            bool loaded = pushes(island, patch, sum, &adds);
            if ((loaded && (adds || dynamic_late)) ||
                closes(world, island, patch, (const double(*)[6])mean, dt)) {
                late[patch->a] = late[patch->b] = changed = true;
                memcpy(mean[patch->a], problem->velocity[patch->a], sizeof *mean);
                memcpy(mean[patch->b], problem->velocity[patch->b], sizeof *mean);
            }
        }
    }
}

pe_status pe_integrate_island(pe_world *world, const pe_island_problem *island,
                              const pe_free_motion *free, double dt, pe_error *error)
{
    const pe_problem *problem = &island->problem;
    size_t bodies = (size_t)problem->body_count + 1;
    double(*mean)[6] = pe_scratch(world, bodies, sizeof *mean);
    double(*sum)[6] = pe_scratch(world, bodies, sizeof *sum);
    bool *late = pe_scratch(world, bodies, sizeof *late);
    if (mean == NULL || sum == NULL || late == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to move %d bodies", problem->body_count);
    }
    memset(mean[problem->body_count], 0, sizeof *mean);
    memset(sum[problem->body_count], 0, sizeof *sum);
    memset(late, 0, bodies * sizeof *late);
    late[problem->body_count] = true; /* what is static needs no flag */
    for (int i = 0; i < problem->body_count; ++i) {
        const pe_twist *m = &free[island->slot[i]].mean;
        const pe_twist *old = &pe_twists(world)[island->slot[i]];
        const double *v = problem->velocity[i], *predicted = problem->free_velocity[i];
        const double drift[6] = {m->velocity.x,         m->velocity.y,
                                 m->velocity.z,         m->angular_velocity.x,
                                 m->angular_velocity.y, m->angular_velocity.z};
        const double began[6] = {old->velocity.x,         old->velocity.y,
                                 old->velocity.z,         old->angular_velocity.x,
                                 old->angular_velocity.y, old->angular_velocity.z};
        for (int k = 0; k < 6; ++k) {
            mean[i][k] = drift[k] + 0.5 * (v[k] - predicted[k]);
            sum[i][k] = began[k] + v[k];
        }
    }
    find_late(world, island, (const double(*)[6])sum, dt, mean, late);
    for (int i = 0; i < problem->body_count; ++i) {
        int slot = island->slot[i];
        pe_vec3 end, turn;
        turn_body(world, island, free, i, late[i], dt, &end, &turn);
        pe_twists(world)[slot] = (pe_twist){vector(problem->velocity[i]), end};
        pe_pose_move(&pe_poses(world)[slot], pe_scale(dt, vector(mean[i])), pe_scale(dt, turn));
    }
    return PE_OK;
}

/* Three steps of a symmetric rule of second order, the middle one backwards, make one of fourth
 * (Yoshida 1990, Construction of higher order symplectic integrators, eq. 2.12). */
static const double OUTER = 1.3512071919596576, INNER = -1.7024143839193153;
/* rad: what turns by more in a step takes one step, for three would not converge. */
static const double MOST_TURN = 0.5;

/* Whether nothing but its own inertia turns the body, and how it turns matters. */
static bool spins_freely(const pe_world *world, int slot, const pe_free_motion *free, double dt)
{
    pe_vec3 torque = free->torque, w = pe_twists(world)[slot].angular_velocity;
    double turn2 = dt * dt * pe_dot(w, w);
    return world->def.profile != PE_PROFILE_FAST && !pe_masses(world)[slot].spherical &&
           pe_dot(torque, torque) == 0 && turn2 > 0 && turn2 < MOST_TURN * MOST_TURN;
}

static void spin(pe_world *world, int slot, double dt)
{
    const double part[3] = {OUTER, INNER, OUTER};
    const pe_vec3 none = {0, 0, 0};
    for (int k = 0; k < 3; ++k) {
        pe_vec3 end, mean;
        pe_turn(world, slot, part[k] * dt, none, none, &end, &mean);
        pe_pose_move(&pe_poses(world)[slot], none, pe_scale(part[k] * dt, mean));
        pe_twists(world)[slot].angular_velocity = end;
    }
}

void pe_integrate_free(pe_world *world, int slot, const pe_free_motion *free, double dt)
{
    if (spins_freely(world, slot, &free[slot], dt)) {
        spin(world, slot, dt);
        pe_twists(world)[slot].velocity = free[slot].end.velocity;
        pe_pose_move(&pe_poses(world)[slot], pe_scale(dt, free[slot].mean.velocity),
                     pe_v3(0, 0, 0));
        return;
    }
    pe_twists(world)[slot] = free[slot].end;
    pe_pose_move(&pe_poses(world)[slot], pe_scale(dt, free[slot].mean.velocity),
                 pe_scale(dt, free[slot].mean.angular_velocity));
}
