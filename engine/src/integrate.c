#include "integrate.h"

#include "rotation.h"

/* Solves the 3 x 3 system with these rows by Cramer's rule. */
static pe_vec3 solve3(pe_vec3 r0, pe_vec3 r1, pe_vec3 r2, pe_vec3 right)
{
    pe_vec3 c12 = pe_cross(r1, r2), c20 = pe_cross(r2, r0), c01 = pe_cross(r0, r1);
    pe_vec3 sum = pe_madd(pe_madd(pe_scale(right.x, c12), right.y, c20), right.z, c01);
    return pe_scale(1 / pe_dot(r0, c12), sum);
}

/* The body-frame angular velocity after dt without torque: I (w' - w) + h m x I m = 0 with m = (w +
 * w')/2, by Newton's method from w. */
static pe_vec3 spin_freely(pe_vec3 inertia, pe_vec3 w, double dt)
{
    pe_vec3 next = w;
    for (int i = 0; i < 4; ++i) {
        pe_vec3 m = pe_scale(0.5, pe_add(w, next));
        pe_vec3 f = pe_madd(pe_mul(inertia, pe_sub(next, w)), dt, pe_cross(m, pe_mul(inertia, m)));
        /* df/dw' = I + (h/2) d(m x I m)/dm */
        double k = 0.5 * dt, ix = inertia.x, iy = inertia.y, iz = inertia.z;
        pe_vec3 r0 = pe_v3(ix, k * m.z * (iz - iy), k * m.y * (iz - iy));
        pe_vec3 r1 = pe_v3(k * m.z * (ix - iz), iy, k * m.x * (ix - iz));
        pe_vec3 r2 = pe_v3(k * m.y * (iy - ix), k * m.x * (iy - ix), iz);
        next = pe_sub(next, solve3(r0, r1, r2, f));
    }
    return next;
}

void pe_predict_velocities(const pe_world *world, double dt, pe_motion *predicted)
{
    for (int slot = 0; slot < world->slot_count; ++slot) {
        const pe_motion *motion = &pe_motions(world)[slot];
        const pe_mass *mass = &pe_masses(world)[slot];
        const pe_load *load = &pe_loads(world)[slot];
        predicted[slot] = *motion;
        if (mass->inverse_mass == 0) {
            continue;
        }
        pe_vec3 acceleration = pe_madd(world->def.gravity, mass->inverse_mass, load->force);
        predicted[slot].velocity = pe_madd(motion->velocity, dt, acceleration);

        const pe_mat3 *rotation = &pe_poses(world)[slot].rotation;
        pe_vec3 torque = load->torque;
        bool pushed = torque.x != 0 || torque.y != 0 || torque.z != 0;
        if (mass->spherical && !pushed) {
            continue;
        }
        pe_vec3 w = pe_unrotate(rotation, motion->angular_velocity);
        if (!mass->spherical) {
            w = spin_freely(mass->inertia, w, dt);
        }
        pe_vec3 local = pe_unrotate(rotation, torque);
        w = pe_madd(
            w, dt,
            pe_v3(local.x / mass->inertia.x, local.y / mass->inertia.y, local.z / mass->inertia.z));
        predicted[slot].angular_velocity = pe_rotate(rotation, w);
    }
}

void pe_pose_move(pe_pose *pose, pe_vec3 displacement, pe_vec3 rotation)
{
    pose->position = pe_add(pose->position, displacement);
    if (rotation.x != 0 || rotation.y != 0 || rotation.z != 0) {
        pose->orientation = pe_quat_turned(pose->orientation, rotation);
        pose->rotation = pe_matrix_of(pose->orientation);
    }
}

void pe_integrate_poses(pe_world *world, double dt)
{
    const pe_body *bodies = pe_bodies(world);
    for (int slot = 1; slot < world->slot_count; ++slot) {
        if (bodies[slot].alive && !bodies[slot].is_static) {
            const pe_motion *motion = &pe_motions(world)[slot];
            pe_pose_move(&pe_poses(world)[slot], pe_scale(dt, motion->velocity),
                         pe_scale(dt, motion->angular_velocity));
        }
    }
}
