#include "step_laws.h"

#include "model/world.h"

const double MOST_UNEXPLAINED = 0.25 * (1 + 1e-9);

bool is_finite_state(const pe_body_state *state)
{
    const pe_quat q = state->orientation;
    return pe_is_finite(state->position) && pe_is_finite(state->velocity) &&
           pe_is_finite(state->angular_velocity) && isfinite(q.w) && isfinite(q.x) &&
           isfinite(q.y) && isfinite(q.z);
}

pe_vec3 centre_of(const pe_world *world, pe_body_id body, const pe_body_state *state)
{
    const pe_geometry *g = pe_bodies(world)[body.index].geometry;
    pe_mat3 r = pe_matrix_of(state->orientation);
    return g != NULL ? pe_add(state->position, pe_rotate(&r, g->frame.centre)) : state->position;
}

double kinetic_energy_of(const pe_world *world, pe_body_id body, const pe_body_state *state)
{
    const pe_mass *m = &pe_masses(world)[body.index];
    const pe_geometry *g = pe_bodies(world)[body.index].geometry;
    pe_quat q =
        g != NULL ? pe_quat_product(state->orientation, g->frame.orientation) : state->orientation;
    pe_mat3 r = pe_matrix_of(q);
    pe_vec3 w = pe_unrotate(&r, state->angular_velocity);
    return 0.5 *
           (m->mass * pe_dot(state->velocity, state->velocity) + pe_dot(pe_mul(m->inertia, w), w));
}

/* The angle from a to b, rad. */
static double angle_between(pe_quat a, pe_quat b)
{
    pe_quat d = pe_quat_product(b, pe_quat_conjugate(a));
    return 2 * atan2(sqrt(d.x * d.x + d.y * d.y + d.z * d.z), fabs(d.w));
}

unexplained_motion unexplained_motion_of(const pe_world *world, pe_body_id body,
                                         const pe_body_state *before, const pe_body_state *after,
                                         double dt, double acceleration)
{
    const pe_body *b = &pe_bodies(world)[body.index];
    const double size = 2 * b->size;
    double speed = pe_max(pe_length(before->velocity), pe_length(after->velocity));
    double spin = pe_max(pe_length(before->angular_velocity), pe_length(after->angular_velocity));
    double path = pe_length(pe_sub(centre_of(world, body, after), centre_of(world, body, before)));
    double angle =
        angle_between(before->orientation, after->orientation) - dt * spin * (1 + dt * spin);
    return (unexplained_motion){(path - dt * (speed + dt * acceleration)) / size,
                                (b->bounding_radius * angle - dt * speed) / size};
}
