/* Contact problems as data: memory, and the problem as solvers take it. */
#include "problem.h"

#include <string.h>

/* `count` items, all zero; room for one when there are none. */
static void *allocate_zero(const pe_allocator *allocator, size_t count, size_t stride)
{
    size_t items = count == 0 ? 1 : count;
    void *memory = items > SIZE_MAX / 2 / stride
                       ? NULL
                       : allocator->allocate(allocator->context, items * stride);
    if (memory != NULL) {
        memset(memory, 0, items * stride);
    }
    return memory;
}

pe_status pe_contact_problem_create(int body_count, int manifold_count, int point_count,
                                    const pe_allocator *allocator, pe_contact_problem **problem,
                                    pe_error *error)
{
    if (body_count < 0 || manifold_count < 0 || point_count < 0) {
        return pe_fail(error, PE_BAD_ARGUMENT,
                       "contact problem: expected counts of at least 0, found %d bodies, %d "
                       "manifolds, %d points",
                       body_count, manifold_count, point_count);
    }
    pe_allocator chosen = allocator != NULL ? *allocator : pe_allocator_default();
    pe_contact_problem *made = allocate_zero(&chosen, 1, sizeof *made);
    if (made != NULL) {
        made->body_count = body_count;
        made->manifold_count = manifold_count;
        made->point_count = point_count;
        made->allocator = chosen;
        made->bodies = allocate_zero(&chosen, (size_t)body_count, sizeof *made->bodies);
        made->manifolds = allocate_zero(&chosen, (size_t)manifold_count, sizeof *made->manifolds);
        made->points = allocate_zero(&chosen, (size_t)point_count, sizeof *made->points);
    }
    if (made == NULL || made->bodies == NULL || made->manifolds == NULL || made->points == NULL) {
        pe_contact_problem_destroy(made);
        return pe_fail(error, PE_NO_MEMORY,
                       "no memory for a contact problem of %d bodies and %d points", body_count,
                       point_count);
    }
    *problem = made;
    return PE_OK;
}

void pe_contact_problem_destroy(pe_contact_problem *problem)
{
    if (problem != NULL) {
        pe_allocator allocator = problem->allocator;
        pe_release(&allocator, problem->bodies);
        pe_release(&allocator, problem->manifolds);
        pe_release(&allocator, problem->points);
        pe_release(&allocator, problem);
    }
}

pe_status pe_contact_solution_take(const pe_contact_problem *problem, int mark_capacity,
                                   pe_contact_solution *made, pe_error *error)
{
    const pe_allocator *allocator = &problem->allocator;
    *made = (pe_contact_solution){.allocator = *allocator};
    made->impulses = allocate_zero(allocator, (size_t)problem->point_count, sizeof *made->impulses);
    made->velocities =
        allocate_zero(allocator, (size_t)problem->body_count, sizeof *made->velocities);
    made->history = allocate_zero(allocator, (size_t)mark_capacity, sizeof *made->history);
    if (made->impulses == NULL || made->velocities == NULL || made->history == NULL) {
        pe_contact_solution_free(made);
        return pe_fail(error, PE_NO_MEMORY, "no memory for a solution of %d contact points",
                       problem->point_count);
    }
    return PE_OK;
}

void pe_contact_solution_free(pe_contact_solution *solution)
{
    const pe_allocator allocator = solution->allocator;
    pe_release(&allocator, solution->impulses);
    pe_release(&allocator, solution->velocities);
    pe_release(&allocator, solution->history);
    *solution = (pe_contact_solution){0};
}

/* The inverse of a symmetric matrix by its cofactors. */
static void invert_symmetric(const double m[6], double inverse[6])
{
    double xx = m[0], xy = m[1], xz = m[2], yy = m[3], yz = m[4], zz = m[5];
    double c[6] = {yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy,
                   xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy};
    double determinant = xx * c[0] + xy * c[1] + xz * c[2];
    for (int k = 0; k < 6; ++k) {
        inverse[k] = c[k] / determinant;
    }
}

/* From a body's centre of mass to a point of the manifold. */
static void point_arm(const pe_solver_manifold *manifold, const double arm[3], const double s[3],
                      double r[3])
{
    const double *n = manifold->frame[0], *t1 = manifold->frame[1], *t2 = manifold->frame[2];
    for (int k = 0; k < 3; ++k) {
        r[k] = arm[k] + (n[k] * s[0] + t1[k] * s[1] + t2[k] * s[2]);
    }
}

pe_status pe_problem_of_data(const pe_contact_problem *data, pe_workspace work, pe_problem *problem,
                             pe_error *error)
{
    *problem = (pe_problem){.body_count = data->body_count,
                            .manifold_count = data->manifold_count,
                            .point_count = data->point_count};
    pe_status status = pe_problem_take(problem, work, error);
    if (status != PE_OK) {
        return status;
    }
    for (int i = 0; i < data->body_count; ++i) {
        const pe_problem_body *body = &data->bodies[i];
        pe_inertia *inertia = &problem->inertia[i];
        *inertia = (pe_inertia){.mass = body->mass, .inverse_mass = 1 / body->mass};
        memcpy(inertia->tensor, body->inertia, sizeof inertia->tensor);
        invert_symmetric(body->inertia, inertia->inverse_tensor);
        memcpy(problem->free_velocity[i], body->free_velocity, sizeof body->free_velocity);
    }
    for (int i = 0; i < data->manifold_count; ++i) {
        pe_solver_manifold *m = &problem->manifold[i];
        *m = data->manifolds[i];
        m->a = m->a == PE_STATIC ? data->body_count : m->a;
        m->b = m->b == PE_STATIC ? data->body_count : m->b;
        for (int j = m->first; j < m->first + m->count; ++j) {
            const pe_problem_manifold_point *from = &data->points[j];
            pe_solver_point *point = &problem->point[j];
            double ra[3], rb[3];
            point_arm(m, m->arm_a, from->offset, ra);
            point_arm(m, m->arm_b, from->offset, rb);
            memcpy(point->s, from->offset, sizeof point->s);
            memcpy(point->slip, from->slip, sizeof point->slip);
            point->bias = from->bias;
            point->scale = pe_point_scale(&problem->inertia[m->a], &problem->inertia[m->b], ra, rb);
            memcpy(problem->impulse[j], from->impulse, sizeof from->impulse);
        }
    }
    status = pe_problem_list_sides(problem, work, error);
    if (status == PE_OK) {
        pe_problem_rebuild_velocity(problem);
    }
    return status;
}
