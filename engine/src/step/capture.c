/* The contact problems of the coming step, copied out of the world. */
#include "plumb/contact_problem.h"

#include "model/rest.h"
#include "step.h"

#include <string.h>

static void copy_bodies(const pe_world *world, const pe_island_problem *from,
                        pe_contact_problem *to)
{
    for (int i = 0; i < to->body_count; ++i) {
        const pe_inertia *inertia = &from->problem.inertia[i];
        pe_problem_body *body = &to->bodies[i];
        int slot = from->slot[i];
        body->mass = inertia->mass;
        body->id = (pe_body_id){(uint32_t)slot, pe_bodies(world)[slot].generation};
        memcpy(body->inertia, inertia->tensor, sizeof body->inertia);
        memcpy(body->free_velocity, from->problem.free_velocity[i], sizeof body->free_velocity);
    }
}

static void copy_contacts(const pe_problem *from, pe_contact_problem *to)
{
    for (int i = 0; i < to->manifold_count; ++i) {
        pe_problem_manifold *m = &to->manifolds[i];
        *m = from->manifold[i];
        if (m->a == from->body_count) {
            m->a = PE_STATIC;
            memset(m->arm_a, 0, sizeof m->arm_a);
        }
        if (m->b == from->body_count) {
            m->b = PE_STATIC;
            memset(m->arm_b, 0, sizeof m->arm_b);
        }
    }
    for (int j = 0; j < to->point_count; ++j) {
        const pe_solver_point *point = &from->point[j];
        to->points[j].bias = point->bias;
        memcpy(to->points[j].slip, point->slip, sizeof point->slip);
        memcpy(to->points[j].offset, point->s, sizeof point->s);
        memcpy(to->points[j].impulse, from->impulse[j], sizeof *from->impulse);
    }
}

static pe_status capture_island(pe_world *world, const pe_interval *interval,
                                pe_contact_problem **captured, pe_error *error)
{
    pe_island_problem built;
    pe_status status = pe_problem_build(world, interval, &built, error);
    if (status != PE_OK) {
        return status;
    }
    const pe_problem *problem = &built.problem;
    status = pe_contact_problem_create(problem->body_count, problem->manifold_count,
                                       problem->point_count, &world->allocator, captured, error);
    if (status != PE_OK) {
        return status;
    }
    copy_bodies(world, &built, *captured);
    copy_contacts(problem, *captured);
    pe_problem_fault fault;
    return pe_contact_problem_is_valid(*captured, &fault)
               ? PE_OK
               : pe_fail(error, PE_NOT_FINITE, "%s[%d].%s: %s", fault.list, fault.index,
                         fault.field, fault.text);
}

/* The problems of all islands, with the contacts as they are. */
static pe_status capture_all(pe_world *world, double dt, pe_contact_problem ***problems, int *count,
                             pe_error *error)
{
    pe_islands islands;
    pe_free_motion *free = pe_scratch(world, (size_t)world->slot_count, sizeof *free);
    if (free == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %d velocities", world->slot_count);
    }
    pe_status status = pe_islands_find(world, &islands, error);
    if (status != PE_OK || islands.count == 0) {
        return status;
    }
    pe_contact_problem **made = world->allocator.allocate(
        world->allocator.context, (size_t)islands.count * sizeof(pe_contact_problem *));
    if (made == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for %d contact problems", islands.count);
    }
    memset(made, 0, (size_t)islands.count * sizeof(pe_contact_problem *));
    pe_predict_motion(world, islands.place, dt, free);
    for (int k = 0; k < islands.count && status == PE_OK; ++k) {
        const pe_interval interval = {.islands = &islands, .k = k, .free = free, .dt = dt};
        status = capture_island(world, &interval, &made[k], error);
    }
    if (status != PE_OK) {
        for (int k = 0; k < islands.count; ++k) {
            pe_contact_problem_destroy(made[k]);
        }
        pe_release(&world->allocator, made);
        return status;
    }
    *problems = made;
    *count = islands.count;
    return PE_OK;
}

/* Finds the contacts as the step does when bodies have been changed since the last one. */
static pe_status renew_contacts(pe_world *world, double dt, pe_error *error)
{
    pe_contact_rules rules = pe_contact_rules_exact();
    pe_status status = pe_contacts_update(world, &rules, NULL, dt, error);
    if (status == PE_OK) {
        pe_contacts_scale_impulses(world, dt);
    }
    return status;
}

pe_status pe_world_capture_problems(pe_world *world, double dt, pe_contact_problem ***problems,
                                    int *count, pe_error *error)
{
    *problems = NULL;
    *count = 0;
    pe_status status = pe_check_dt(dt, error);
    if (status != PE_OK) {
        return status;
    }
    pe_arena_reset(&world->arena, &world->allocator);
    pe_rest_mark_all(world);
    if ((status = pe_rest_wake(world, error)) != PE_OK) {
        return status;
    }
    bool renewed = world->contacts_stale || dt != world->previous_dt;
    if (renewed && (status = renew_contacts(world, dt, error)) != PE_OK) {
        return status;
    }
    status = capture_all(world, dt, problems, count, error);
    if (renewed) {
        /* The step will find them again for itself, from the same list as here. */
        pe_contacts_swap(&world->contacts, &world->previous);
    }
    return status;
}

pe_contact_problem *pe_contact_problems_keep(pe_contact_problem **problems, int count, int index)
{
    if (count == 0) {
        return NULL;
    }
    const pe_allocator allocator = problems[0]->allocator;
    pe_contact_problem *kept = index < 0 ? NULL : problems[index];
    for (int i = 0; i < count; ++i) {
        pe_contact_problem_destroy(i == index ? NULL : problems[i]);
    }
    pe_release(&allocator, problems);
    return kept;
}

void pe_contact_problems_destroy(pe_contact_problem **problems, int count)
{
    pe_contact_problems_keep(problems, count, -1);
}
