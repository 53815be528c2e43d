/* The step: a straight pipeline of phases, each timed. */
#define _POSIX_C_SOURCE 199309L

#include "broad_phase.h"
#include "contact.h"
#include "integrate.h"
#include "project.h"
#include "solve.h"

#include <time.h>

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

/* What collapses has another problem at every step, so that sweeps spent on its last digits are
 * lost at the next; what stands keeps the digits. A moving island gets this part of the work. */
static const double MOVING_PART = 0.02;

/* Whether a body of the island is faster than one step of free fall would make it. */
static bool is_moving(const pe_world *world, const pe_problem *island, double dt)
{
    double speed = dt * pe_length(world->def.gravity);
    const pe_motion *motions = pe_motions(world);
    for (int i = 0; i < island->count; ++i) {
        pe_vec3 a = motions[island->rows[i].a].velocity, b = motions[island->rows[i].b].velocity;
        if (pe_dot(a, a) > speed * speed || pe_dot(b, b) > speed * speed) {
            return true;
        }
    }
    return false;
}

static void solve_islands(const pe_world *world, const pe_islands *islands,
                          const pe_problems *problems, double dt, pe_step_stats *stats)
{
    for (int k = 0; k < islands->count; ++k) {
        pe_problem island = pe_problems_island(problems, k);
        double part = is_moving(world, &island, dt) ? MOVING_PART : 1;
        pe_solve_limits limits = {
            .tolerance = world->def.tolerance,
            .max_iterations = world->def.max_iterations,
            .max_updates = part * world->def.max_contact_updates,
        };
        pe_solve_report report;
        pe_solve_gauss_seidel(&island, &limits, &report);
        stats->unconverged_islands += !report.converged;
        stats->iterations =
            report.iterations > stats->iterations ? report.iterations : stats->iterations;
        stats->residual = report.residual > stats->residual ? report.residual : stats->residual;
    }
}

/* v = v* + M^(-1/2) (y - y*): exactly v* for a body that no contact touched. */
static void apply_solution(pe_world *world, const pe_motion *predicted, const pe_problem *problem)
{
    const pe_body *bodies = pe_bodies(world);
    for (int slot = 1; slot < world->slot_count; ++slot) {
        if (!bodies[slot].alive || bodies[slot].is_static) {
            continue;
        }
        const double *y = problem->velocity[slot], *free_y = problem->free_velocity[slot];
        double d[6];
        for (int k = 0; k < 6; ++k) {
            d[k] = y[k] - free_y[k];
        }
        const pe_mass *mass = &pe_masses(world)[slot];
        pe_vec3 turn = pe_mul(mass->inverse_root_inertia, pe_v3(d[3], d[4], d[5]));
        pe_motions(world)[slot] = (pe_motion){
            pe_madd(predicted[slot].velocity, mass->inverse_root_mass, pe_v3(d[0], d[1], d[2])),
            pe_add(predicted[slot].angular_velocity,
                   pe_rotate(&pe_poses(world)[slot].rotation, turn)),
        };
    }
}

static void clear_loads(pe_world *world)
{
    for (int slot = 0; slot < world->slot_count; ++slot) {
        pe_loads(world)[slot] = (pe_load){0};
    }
}

/* All phases that allocate, none of which moves a body. */
static pe_status prepare(pe_world *world, double dt, pe_islands *islands, pe_motion **predicted,
                         pe_problems *problems, pe_step_stats *stats, pe_error *error)
{
    pe_pair *pairs;
    int pair_count;
    double mark = seconds_now();
    pe_arena_reset(&world->arena, &world->allocator);
    pe_status status = pe_broad_phase(world, dt, &pairs, &pair_count, error);
    if (status != PE_OK) {
        return status;
    }
    stats->time_broad_phase = lap(&mark);
    status = pe_contacts_find(world, pairs, pair_count, dt, error);
    if (status != PE_OK) {
        return status;
    }
    stats->time_narrow_phase = lap(&mark);
    pe_contacts_match(world, dt);
    stats->time_contacts = lap(&mark);
    status = pe_islands_find(world, islands, error);
    if (status != PE_OK) {
        return status;
    }
    stats->time_islands = lap(&mark);
    *predicted = pe_scratch(world, (size_t)world->slot_count, sizeof **predicted);
    if (*predicted == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %d velocities", world->slot_count);
    }
    pe_predict_velocities(world, dt, *predicted);
    status = pe_problems_build(world, islands, *predicted, dt, problems, error);
    stats->time_solve = lap(&mark);
    return status;
}

pe_status pe_world_step(pe_world *world, double dt, pe_step_stats *stats, pe_error *error)
{
    pe_step_stats local = {0};
    if (!(dt > 0) || !isfinite(dt)) {
        return pe_fail(error, PE_BAD_ARGUMENT, "dt: expected a finite number above 0, found %g",
                       dt);
    }
    pe_islands islands;
    pe_motion *predicted;
    pe_problems problems;
    pe_status status = prepare(world, dt, &islands, &predicted, &problems, &local, error);
    if (status != PE_OK) {
        return status;
    }
    local.islands = islands.count;
    local.manifolds = world->contacts.manifold_count;
    local.contacts = world->contacts.point_count;

    double mark = seconds_now();
    solve_islands(world, &islands, &problems, dt, &local);
    apply_solution(world, predicted, &problems.all);
    pe_problems_store_impulses(world, &problems);
    local.time_solve += lap(&mark);

    pe_integrate_poses(world, dt);
    clear_loads(world);
    world->previous_dt = dt;
    local.time_integrate = lap(&mark);

    pe_project_report projected;
    pe_project_positions(world, &islands, &problems, &projected);
    local.projection_iterations = projected.iterations;
    local.penetration = projected.penetration;
    local.time_project = lap(&mark);
    if (stats != NULL) {
        *stats = local;
    }
    return PE_OK;
}

int pe_world_get_contacts(const pe_world *world, pe_contact *contacts, int capacity)
{
    const pe_contacts *now = &world->contacts;
    const pe_body *bodies = pe_bodies(world);
    int count = 0;
    for (int i = 0; i < now->manifold_count; ++i) {
        const pe_manifold *m = &pe_manifolds(now)[i];
        for (int j = m->first; j < m->first + m->count; ++j, ++count) {
            const pe_point *point = &pe_points(now)[j];
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
