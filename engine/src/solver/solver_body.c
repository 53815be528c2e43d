#include "solver_body.h"

#include "model/integrate.h"

#include <string.h>

pe_status pe_solver_bodies_take(pe_world *world, const pe_islands *islands, const bool *chosen,
                                pe_solver_bodies *lines, pe_error *error)
{
    size_t slots = (size_t)world->slot_count, count = 1;
    for (int k = 0; k < islands->count; ++k) {
        count += chosen[k] ? (size_t)(islands->body_start[k + 1] - islands->body_start[k]) : 0;
    }
    *lines = (pe_solver_bodies){
        .index_of = pe_scratch(world, slots, sizeof *lines->index_of),
        .slot_of = pe_scratch(world, count, sizeof *lines->slot_of),
        .velocity = pe_scratch(world, count, sizeof *lines->velocity),
        .previous = pe_scratch(world, count, sizeof *lines->previous),
        .displacement = pe_scratch(world, count, sizeof *lines->displacement),
        .frame = pe_scratch(world, count, sizeof *lines->frame),
    };
    if (lines->index_of == NULL || lines->slot_of == NULL || lines->velocity == NULL ||
        lines->previous == NULL || lines->displacement == NULL || lines->frame == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the velocities of %zu bodies", count);
    }
    memset(lines->index_of, 0, slots * sizeof *lines->index_of);
    lines->slot_of[lines->count++] = 0;
    for (int k = 0; k < islands->count; ++k) {
        for (int i = islands->body_start[k]; chosen[k] && i < islands->body_start[k + 1]; ++i) {
            lines->index_of[islands->bodies[i]] = lines->count;
            lines->slot_of[lines->count++] = islands->bodies[i];
        }
    }
    return PE_OK;
}

static void put(double to[3], pe_vec3 v)
{
    to[0] = v.x, to[1] = v.y, to[2] = v.z;
}

static pe_vec3 get(const double from[3])
{
    return pe_v3(from[0], from[1], from[2]);
}

/* Solves the 3 x 3 system with these rows by Cramer's rule. */
static pe_vec3 solve3(pe_vec3 r0, pe_vec3 r1, pe_vec3 r2, pe_vec3 right)
{
    pe_vec3 c12 = pe_cross(r1, r2), c20 = pe_cross(r2, r0), c01 = pe_cross(r0, r1);
    pe_vec3 sum = pe_madd(pe_madd(pe_scale(right.x, c12), right.y, c20), right.z, c01);
    return pe_scale(1 / pe_dot(r0, c12), sum);
}

/* Euler's equation without torque over dt, in the body's axes, by the implicit midpoint rule:
 * I (w' - w) + dt m x I m = 0, m = (w + w')/2, which keeps the energy (Hairer, Lubich, Wanner 2006,
 * IV.2). Two steps of Newton's method; what they leave is taken off by scaling to that energy. */
static pe_vec3 precess(pe_vec3 inertia, pe_vec3 w, double dt)
{
    pe_vec3 next = w;
    double ix = inertia.x, iy = inertia.y, iz = inertia.z, k = 0.5 * dt;
    for (int i = 0; i < 2; ++i) {
        pe_vec3 m = pe_scale(0.5, pe_add(w, next));
        pe_vec3 f = pe_madd(pe_mul(inertia, pe_sub(next, w)), dt, pe_cross(m, pe_mul(inertia, m)));
        pe_vec3 r0 = pe_v3(ix, k * m.z * (iz - iy), k * m.y * (iz - iy));
        pe_vec3 r1 = pe_v3(k * m.z * (ix - iz), iy, k * m.x * (ix - iz));
        pe_vec3 r2 = pe_v3(k * m.y * (iy - ix), k * m.x * (iy - ix), iz);
        next = pe_sub(next, solve3(r0, r1, r2, f));
    }
    double before = pe_dot(w, pe_mul(inertia, w)), after = pe_dot(next, pe_mul(inertia, next));
    return after > 0 ? pe_scale(sqrt(before / after), next) : next;
}

/* Force over mass and torque, the latter in the body's axes. What turns with the body is taken as
 * it stands at the step's start, like all of the rotation here. */
static pe_vec3 acceleration_of(const pe_world *world, int slot, pe_vec3 *torque)
{
    const pe_applied_force *load = &pe_applied_forces(world)[slot];
    const pe_mat3 *rotation = &pe_poses(world)[slot].rotation;
    pe_vec3 force = pe_add(load->force, pe_rotate(rotation, load->body_force));
    *torque = pe_add(pe_unrotate(rotation, load->torque), load->body_torque);
    return pe_madd(world->def.gravity, pe_masses(world)[slot].inverse_mass, force);
}

void pe_solver_bodies_fill(const pe_world *world, double dt, double h,
                           const pe_solver_bodies *lines)
{
    lines->velocity[0] = lines->previous[0] = (pe_solver_body){0};
    lines->frame[0] = (pe_solver_body_frame){0};
    memset(lines->displacement, 0, (size_t)lines->count * sizeof *lines->displacement);
    for (int i = 1; i < lines->count; ++i) {
        int slot = lines->slot_of[i];
        const pe_pose *pose = &pe_poses(world)[slot];
        const pe_twist *motion = &pe_twists(world)[slot];
        const pe_mass *mass = &pe_masses(world)[slot];
        pe_vec3 shrink = mass->inverse_root_inertia, torque;
        pe_vec3 acceleration = acceleration_of(world, slot, &torque);
        pe_vec3 w = pe_unrotate(&pose->rotation, motion->angular_velocity);
        if (!mass->spherical) {
            w = precess(mass->inertia, w, dt);
        }
        pe_vec3 spin = pe_mul(pe_mul(mass->inertia, shrink), w);

        pe_solver_body *line = &lines->velocity[i], *previous = &lines->previous[i];
        line->inverse_mass = previous->inverse_mass = mass->inverse_mass;
        line->unused = previous->unused = 0;
        put(line->linear, motion->velocity);
        put(line->angular, spin);
        put(previous->linear, pe_madd(motion->velocity, -h, acceleration));
        put(previous->angular, pe_madd(spin, -h, pe_mul(shrink, torque)));

        pe_solver_body_frame *frame = &lines->frame[i];
        *frame = (pe_solver_body_frame){0};
        put(frame->position, pose->position);
        for (int k = 0; k < 3; ++k) {
            put(&frame->turn[3 * k],
                pe_scale(pe_component(shrink, k), pe_axis(&pose->rotation, k)));
        }
    }
}

/* The angular velocity v with the kinetic energy of w, both in the body's axes. */
static pe_vec3 with_energy_of(pe_vec3 inertia, pe_vec3 w, pe_vec3 v)
{
    double wanted = pe_dot(w, pe_mul(inertia, w)), found = pe_dot(v, pe_mul(inertia, v));
    return found > 0 ? pe_scale(sqrt(wanted / found), v) : v;
}

void pe_solver_bodies_apply(pe_world *world, const pe_solver_bodies *lines)
{
    for (int i = 1; i < lines->count; ++i) {
        int slot = lines->slot_of[i];
        const pe_mass *mass = &pe_masses(world)[slot];
        pe_pose *pose = &pe_poses(world)[slot];
        const pe_mat3 before = pose->rotation;
        pe_vec3 shrink = mass->inverse_root_inertia;
        pe_vec3 w = pe_mul(shrink, get(lines->velocity[i].angular));
        pe_vec3 turn = pe_mul(shrink, get(lines->displacement[i].angular));
        pe_vec3 spin = pe_rotate(&before, w);
        pe_pose_move(pose, get(lines->displacement[i].linear), pe_rotate(&before, turn));
        if (!mass->spherical) {
            /* About its own axis a turn changes nothing; about another, the inertia along it. */
            pe_vec3 turned = pe_unrotate(&pose->rotation, spin);
            spin = pe_rotate(&pose->rotation, with_energy_of(mass->inertia, w, turned));
        }
        pe_twists(world)[slot] = (pe_twist){get(lines->velocity[i].linear), spin};
    }
}
