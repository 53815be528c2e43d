/* Solver bodies of soft contact: from the world's bodies, and back to them. */
#include "solver_body.h"

#include "model/integrate.h"

#include <string.h>

pe_status pe_solver_bodies_take(pe_world *world, const pe_chosen_islands *chosen_islands,
                                pe_solver_bodies *bodies, pe_error *error)
{
    const pe_islands *islands = chosen_islands->islands;
    const bool *chosen = chosen_islands->chosen;
    size_t slots = (size_t)world->slot_count, count = 1;
    for (int k = 0; k < islands->count; ++k) {
        count += chosen[k] ? (size_t)(islands->body_start[k + 1] - islands->body_start[k]) : 0;
    }
    *bodies = (pe_solver_bodies){
        .index_of = pe_scratch(world, slots, sizeof *bodies->index_of),
        .slot_of = pe_scratch(world, count, sizeof *bodies->slot_of),
        .velocity = pe_scratch(world, count, sizeof *bodies->velocity),
        .previous = pe_scratch(world, count, sizeof *bodies->previous),
        .displacement = pe_scratch(world, count, sizeof *bodies->displacement),
        .frame = pe_scratch(world, count, sizeof *bodies->frame),
    };
    if (bodies->index_of == NULL || bodies->slot_of == NULL || bodies->velocity == NULL ||
        bodies->previous == NULL || bodies->displacement == NULL || bodies->frame == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the velocities of %zu bodies", count);
    }
    memset(bodies->index_of, 0, slots * sizeof *bodies->index_of);
    bodies->slot_of[bodies->count++] = 0;
    for (int k = 0; k < islands->count; ++k) {
        for (int i = islands->body_start[k]; chosen[k] && i < islands->body_start[k + 1]; ++i) {
            bodies->index_of[islands->bodies[i]] = bodies->count;
            bodies->slot_of[bodies->count++] = islands->bodies[i];
        }
    }
    return PE_OK;
}

/* The angular velocity v with the kinetic energy of w, both in the body's axes. */
static pe_vec3 with_energy_of(pe_vec3 inertia, pe_vec3 w, pe_vec3 v)
{
    double wanted = pe_dot(w, pe_mul(inertia, w)), found = pe_dot(v, pe_mul(inertia, v));
    return found > 0 ? pe_scale(sqrt(wanted / found), v) : v;
}

/* Euler's equation without torque over dt, in the body's axes, by the implicit midpoint rule:
 * I (w' - w) + dt m x I m = 0, m = (w + w')/2, which keeps the energy (Hairer, Lubich, Wanner 2006,
 * IV.2). Two steps of Newton's method; scaling to that energy removes the error they leave. */
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
        next = pe_sub(next, pe_solve3(r0, r1, r2, f));
    }
    return with_energy_of(inertia, w, next);
}

/* Acceleration by gravity and applied force, and the torque in the body's axes. Forces that turn
 * with the body are taken as they are at the step's start. */
static pe_vec3 acceleration_of(const pe_world *world, int slot, pe_vec3 *torque)
{
    const pe_applied_force *applied = pe_applied_force_of(world, slot);
    const pe_mat3 *rotation = &pe_poses(world)[slot].rotation;
    pe_vec3 force = pe_add(applied->force, pe_rotate(rotation, applied->body_force));
    *torque = pe_add(pe_unrotate(rotation, applied->torque), applied->body_torque);
    return pe_madd(world->def.gravity, pe_masses(world)[slot].inverse_mass, force);
}

/* 1/sqrt(I), componentwise: takes scaled angular velocities (solver_body.h) to those in the body's axes. */
static pe_vec3 scale_of(const pe_mass *mass)
{
    const pe_vec3 i = mass->inertia;
    return pe_v3(1 / sqrt(i.x), 1 / sqrt(i.y), 1 / sqrt(i.z));
}

/* Bodies of a piece. */
enum { GRAIN = 128 };

/* What the pieces share. */
typedef struct filling {
    pe_world *world;
    double dt, h;
    const pe_solver_bodies *bodies;
} filling;

static void fill_bodies(void *context, int worker, int begin, int end)
{
    (void)worker;
    const filling *f = context;
    const pe_world *world = f->world;
    const pe_solver_bodies *bodies = f->bodies;
    const double dt = f->dt, h = f->h;
    for (int i = begin; i < end; ++i) {
        bodies->displacement[i] = (pe_solver_body){0};
        if (i == 0) {
            bodies->velocity[0] = bodies->previous[0] = (pe_solver_body){0};
            bodies->frame[0] = (pe_solver_body_frame){0};
            continue;
        }
        int slot = bodies->slot_of[i];
        const pe_pose *pose = &pe_poses(world)[slot];
        const pe_twist *twist = &pe_twists(world)[slot];
        const pe_mass *mass = &pe_masses(world)[slot];
        pe_vec3 scale = scale_of(mass), torque;
        pe_vec3 acceleration = acceleration_of(world, slot, &torque);
        pe_vec3 w = pe_unrotate(&pose->rotation, twist->angular_velocity);
        if (!mass->spherical) {
            w = precess(mass->inertia, w, dt);
        }
        pe_vec3 spin = pe_mul(pe_mul(mass->inertia, scale), w);

        pe_solver_body *body = &bodies->velocity[i], *previous = &bodies->previous[i];
        body->inverse_mass = previous->inverse_mass = mass->inverse_mass;
        body->unused = previous->unused = 0;
        pe_v3_store(body->linear, twist->velocity);
        pe_v3_store(body->angular, spin);
        pe_v3_store(previous->linear, pe_madd(twist->velocity, -h, acceleration));
        pe_v3_store(previous->angular, pe_madd(spin, -h, pe_mul(scale, torque)));

        pe_solver_body_frame *frame = &bodies->frame[i];
        *frame = (pe_solver_body_frame){0};
        pe_v3_store(frame->position, pose->position);
        for (int k = 0; k < 3; ++k) {
            pe_v3_store(&frame->to_scaled[3 * k],
                        pe_scale(pe_component(scale, k), pe_axis(&pose->rotation, k)));
        }
    }
}

void pe_solver_bodies_fill(pe_world *world, double dt, double h, const pe_solver_bodies *bodies)
{
    filling f = {world, dt, h, bodies};
    pe_pool_run(world->pool, bodies->count, GRAIN, fill_bodies, &f);
}

static void apply_to_bodies(void *context, int worker, int begin, int end)
{
    (void)worker;
    const filling *f = context;
    pe_world *world = f->world;
    const pe_solver_bodies *bodies = f->bodies;
    for (int i = begin > 1 ? begin : 1; i < end; ++i) {
        int slot = bodies->slot_of[i];
        const pe_mass *mass = &pe_masses(world)[slot];
        pe_pose *pose = &pe_poses(world)[slot];
        const pe_mat3 before = pose->rotation;
        pe_vec3 scale = scale_of(mass);
        pe_vec3 w = pe_mul(scale, pe_v3_load(bodies->velocity[i].angular));
        pe_vec3 turn = pe_mul(scale, pe_v3_load(bodies->displacement[i].angular));
        pe_vec3 spin = pe_rotate(&before, w);
        pe_pose_move(pose, pe_v3_load(bodies->displacement[i].linear), pe_rotate(&before, turn));
        if (!mass->spherical) {
            /* A rotation about another axis than that of w changes the inertia along w. */
            pe_vec3 turned = pe_unrotate(&pose->rotation, spin);
            spin = pe_rotate(&pose->rotation, with_energy_of(mass->inertia, w, turned));
        }
        pe_twists(world)[slot] = (pe_twist){pe_v3_load(bodies->velocity[i].linear), spin};
    }
}

void pe_solver_bodies_apply(pe_world *world, const pe_solver_bodies *bodies)
{
    filling f = {.world = world, .bodies = bodies};
    pe_pool_run(world->pool, bodies->count, GRAIN, apply_to_bodies, &f);
}
