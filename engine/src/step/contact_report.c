/* The contacts of the last step as the caller reads them. */
#include "model/rest.h"
#include "step.h"

#include <string.h>

/* Writes a point that acted over the whole step, where its bodies were at the step's start. Each
 * field is assigned, because copies of the whole structure took most of the time. */
static void write_contact_of_step(const pe_world *world, const pe_point_walk *at, pe_contact *c)
{
    const pe_body *bodies = pe_bodies(world);
    const pe_saved_pose *start = world->start_pose_array.items;
    const int a = at->manifold->a, b = at->manifold->b;
    c->body_a = (pe_body_id){(uint32_t)a, bodies[a].generation};
    c->body_b = (pe_body_id){(uint32_t)b, bodies[b].generation};
    c->point = at->point->position;
    c->normal = at->manifold->normal;
    c->separation = at->point->separation;
    c->impulse = at->point->impulse;
    c->begin = 0;
    c->end = world->previous_dt;
    c->order = 0;
    c->acts.arm_a = pe_sub(at->point->position, start[a].position);
    c->acts.arm_b = pe_sub(at->point->position, start[b].position);
    c->acts.normal = at->manifold->normal;
    c->holds = c->acts;
}

/* ---- Contacts apart ---- */

/* Where a point of the island's contact problem acts. */
static pe_contact_place acting_place(const pe_solver_manifold *manifold, const double s[3])
{
    pe_vec3 offset = {0, 0, 0};
    for (int k = 0; k < 3; ++k) {
        offset = pe_madd(offset, s[k], pe_v3_load(manifold->frame[k]));
    }
    return (pe_contact_place){
        .arm_a = pe_add(pe_v3_load(manifold->arm_a), offset),
        .arm_b = pe_add(pe_v3_load(manifold->arm_b), offset),
        .normal = pe_v3_load(manifold->frame[0]),
    };
}

/* Where the centre of mass of solver body i was when its impulses acted: in the mean over a
 * sub-step, and else at its start. */
static pe_vec3 acting_centre(const pe_world *world, const pe_interval *interval, int slot, int i,
                             const pe_moved *moved)
{
    pe_vec3 now = pe_poses(world)[slot].position;
    if (moved == NULL) {
        return now;
    }
    double back = interval->substep && !moved->late[i] ? 0.5 : 1;
    return pe_madd(now, -back * interval->dt, pe_v3_load(moved->mean[i]));
}

pe_status pe_list_apart(pe_step *step, const pe_interval *interval, double end,
                        const pe_island_problem *island, const pe_moved *moved)
{
    pe_world *world = step->world;
    const pe_problem *problem = &island->problem;
    const pe_body *bodies = pe_bodies(world);
    const size_t count = (size_t)world->apart_count;
    pe_status status = pe_array_reserve(&world->apart_array, &world->allocator, sizeof(pe_contact),
                                        count + (size_t)problem->point_count, count, step->error);
    if (status != PE_OK) {
        return status;
    }
    pe_contact *listed = (pe_contact *)world->apart_array.items + count;
    for (int i = 0; i < problem->manifold_count; ++i) {
        const pe_solver_manifold *manifold = &problem->manifold[i];
        pe_manifold *m = &pe_manifolds(&world->contacts)[island->source[i]];
        m->apart = true;
        const bool on_b = manifold->b != problem->body_count;
        const int moving = on_b ? manifold->b : manifold->a;
        const pe_vec3 centre = acting_centre(world, interval, on_b ? m->b : m->a, moving, moved);
        for (int j = manifold->first; j < manifold->first + manifold->count; ++j) {
            const pe_manifold_point *point =
                &pe_manifold_points(&world->contacts)[island->point_of[j]];
            const pe_contact_place acts = acting_place(manifold, problem->point[j].s);
            const bool transported =
                island->end != NULL && pe_dot(island->end[j].normal, island->end[j].normal) > 0;
            *listed = (pe_contact){
                .body_a = {(uint32_t)m->a, bodies[m->a].generation},
                .body_b = {(uint32_t)m->b, bodies[m->b].generation},
                .point = pe_add(centre, on_b ? acts.arm_b : acts.arm_a),
                .normal = acts.normal,
                .separation = point->separation,
                .impulse = point->impulse,
                .begin = interval->begin,
                .end = end,
                .order = interval->order,
                .acts = acts,
                .holds = transported ? island->end[j] : acts,
            };
            if (!pe_is_finite(listed->point) || !pe_is_finite(listed->impulse)) {
                return pe_fail(step->error, PE_NOT_FINITE,
                               "bodies (%d, %u) and (%d, %u): expected finite contacts within a "
                               "step of %g s, found an impulse of (%g, %g, %g)",
                               m->a, bodies[m->a].generation, m->b, bodies[m->b].generation,
                               step->dt, point->impulse.x, point->impulse.y, point->impulse.z);
            }
            listed += 1;
            world->apart_count += 1;
        }
    }
    return PE_OK;
}

/* ---- All contacts ---- */

/* Adds the contacts of islands that were at rest during the step. Returns how many contacts there are
 * then. */
static int report_resting(const pe_world *world, pe_contact *contacts, int capacity, int count)
{
    const pe_rest *rest = world->rest;
    for (int k = 0; k < rest->island_count; ++k) {
        const pe_resting_island *island = &((const pe_resting_island *)rest->island_array.items)[k];
        pe_point_walk at = pe_walk_points(&rest->contacts);
        at.next_manifold = island->first_manifold;
        at.count = island->first_manifold + island->manifold_count;
        while (!island->is_new && pe_next_point(&at)) {
            if (count < capacity) {
                write_contact_of_step(world, &at, &contacts[count]);
            }
            count += 1;
        }
    }
    return count;
}

int pe_world_get_contacts(const pe_world *world, pe_contact *contacts, int capacity)
{
    int count = 0;
    for (pe_point_walk at = pe_walk_points(&world->solved); pe_next_point(&at);) {
        if (!at.manifold->apart) {
            if (count < capacity) {
                write_contact_of_step(world, &at, &contacts[count]);
            }
            count += 1;
        }
    }
    count = report_resting(world, contacts, capacity, count);
    const int fitting =
        capacity - count < world->apart_count ? capacity - count : world->apart_count;
    if (fitting > 0) {
        memcpy(contacts + count, world->apart_array.items, (size_t)fitting * sizeof *contacts);
    }
    return count + world->apart_count;
}
