#include "advance.h"

#include <string.h>

/* A gap may shrink below 0 by this, in m, before its bodies move by the new velocity. */
static const double CLOSING_SLACK = 1e-9;

static pe_vec3 vector(const double v[3])
{
    return pe_v3(v[0], v[1], v[2]);
}

static bool closes(const pe_world *world, const pe_island_problem *island, const pe_patch *patch,
                   const double (*velocity)[6], double dt)
{
    const pe_point *points = pe_points(&world->contacts);
    double q[6], u[3];
    pe_patch_twist(patch, velocity, q);
    for (int j = patch->first; j < patch->first + patch->count; ++j) {
        double gap = points[island->point_of[j]].separation;
        pe_point_velocity(&island->problem.point[j], q, u);
        double approach = u[0] - island->problem.point[j].bias;
        if (gap + dt * approach < pe_min(0, gap) - CLOSING_SLACK) {
            return true;
        }
    }
    return false;
}

pe_status pe_advance_island(pe_world *world, const pe_island_problem *island,
                            const pe_free_motion *free, double dt, pe_error *error)
{
    const pe_problem *problem = &island->problem;
    size_t bodies = (size_t)problem->body_count + 1;
    double(*mean)[6] = pe_scratch(world, bodies, sizeof *mean);
    bool *late = pe_scratch(world, bodies, sizeof *late);
    if (mean == NULL || late == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to move %d bodies", problem->body_count);
    }
    memset(mean[problem->body_count], 0, sizeof *mean);
    memset(late, 0, bodies * sizeof *late);
    late[problem->body_count] = true; /* what is static needs no flag */
    for (int i = 0; i < problem->body_count; ++i) {
        const pe_motion *m = &free[island->slot[i]].mean;
        const double *v = problem->velocity[i], *predicted = problem->free_velocity[i];
        const double drift[6] = {m->velocity.x,         m->velocity.y,
                                 m->velocity.z,         m->angular_velocity.x,
                                 m->angular_velocity.y, m->angular_velocity.z};
        for (int k = 0; k < 6; ++k) {
            mean[i][k] = drift[k] + 0.5 * (v[k] - predicted[k]);
        }
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (int i = 0; i < problem->patch_count; ++i) {
            const pe_patch *patch = &problem->patch[i];
            if ((late[patch->a] && late[patch->b]) ||
                !closes(world, island, patch, (const double(*)[6])mean, dt)) {
                continue;
            }
            late[patch->a] = late[patch->b] = changed = true;
            memcpy(mean[patch->a], problem->velocity[patch->a], sizeof *mean);
            memcpy(mean[patch->b], problem->velocity[patch->b], sizeof *mean);
        }
    }
    for (int i = 0; i < problem->body_count; ++i) {
        int slot = island->slot[i];
        pe_motions(world)[slot] =
            (pe_motion){vector(problem->velocity[i]), vector(problem->velocity[i] + 3)};
        pe_pose_move(&pe_poses(world)[slot], pe_scale(dt, vector(mean[i])),
                     pe_scale(dt, vector(mean[i] + 3)));
    }
    return PE_OK;
}

void pe_advance_free(pe_world *world, int slot, const pe_free_motion *free, double dt)
{
    const pe_free_motion *own = &free[slot];
    pe_motions(world)[slot] = own->end;
    pe_pose_move(&pe_poses(world)[slot], pe_scale(dt, own->mean.velocity),
                 pe_scale(dt, own->mean.angular_velocity));
}
