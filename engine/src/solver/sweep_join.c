/* Several problems joined into one to be swept together, and parted again. */
#include "sweep.h"

#include <string.h>

/* Copies a problem to its place in the joint one, which begins with body `body` and so on. */
static void copy_in(const pe_problem *from, const pe_sweep_part *to, int point,
                    const pe_problem *joint)
{
    const size_t bodies = (size_t)from->body_count, points = (size_t)from->point_count;
    memcpy(joint->inertia + to->body, from->inertia, bodies * sizeof *from->inertia);
    memcpy(joint->velocity + to->body, from->velocity, bodies * sizeof *from->velocity);
    memcpy(joint->point + point, from->point, points * sizeof *from->point);
    memcpy(joint->impulse + point, from->impulse, points * sizeof *from->impulse);
    for (int i = 0; i < from->manifold_count; ++i) {
        pe_solver_manifold *m = &joint->manifold[to->manifold + i];
        *m = from->manifold[i];
        m->a = m->a == from->body_count ? joint->body_count : m->a + to->body;
        m->b = m->b == from->body_count ? joint->body_count : m->b + to->body;
        m->first += point;
    }
}

pe_status pe_sweep_join(const pe_problem *const *problems, int count, pe_workspace work,
                        pe_problem *joint, pe_sweep_part *parts, pe_error *error)
{
    *joint = (pe_problem){0};
    for (int k = 0; k < count; ++k) {
        const pe_problem *from = problems[k];
        parts[k] = (pe_sweep_part){joint->body_count, from->body_count, joint->manifold_count,
                                   from->manifold_count};
        joint->body_count += from->body_count;
        joint->manifold_count += from->manifold_count;
        joint->point_count += from->point_count;
    }
    if (count == 1) {
        *joint = *problems[0];
        return PE_OK;
    }
    pe_status status = pe_problem_take(joint, work, error);
    if (status != PE_OK) {
        return status;
    }
    memset(joint->velocity[joint->body_count], 0, sizeof *joint->velocity);
    for (int k = 0, point = 0; k < count; point += problems[k]->point_count, ++k) {
        copy_in(problems[k], &parts[k], point, joint);
    }
    return PE_OK;
}

void pe_sweep_part_from(const pe_problem *joint, const pe_problem *const *problems, int count)
{
    for (int k = 0, point = 0; k < count && count > 1; point += problems[k]->point_count, ++k) {
        memcpy(problems[k]->impulse, joint->impulse + point,
               (size_t)problems[k]->point_count * sizeof *joint->impulse);
    }
}
