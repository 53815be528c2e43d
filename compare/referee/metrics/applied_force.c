#include "mechanics.h"

const double pl_node_times[PL_NODES] = {0, 0.5, 1};
const double pl_node_weights[PL_NODES] = {1.0 / 6, 4.0 / 6, 1.0 / 6};

bool pl_applied_force_acts(const pl_force *force, long step, double dt)
{
    /* A tolerance of a millionth of a step allows for rounding of the force's times. */
    double time = (double)(step - 1) * dt + 1e-6 * dt;
    return time >= force->from && time < force->until;
}

/* The body's axes at a node of a step of dt seconds. The orientation at the midpoint is the mean of
 * both ends, turned ahead by h (w - w')/8, as in Hermite's cubic. */
static pl_axes axes_at(const pl_body_state *before, const pl_body_state *after, double dt, int node)
{
    const double *p = before->orientation, *q = after->orientation;
    if (node != 1) {
        return pl_axes_of(node == 0 ? p : q);
    }
    double same = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3] < 0 ? -1 : 1;
    double w = p[0] + same * q[0], x = p[1] + same * q[1], y = p[2] + same * q[2],
           z = p[3] + same * q[3];
    pl_vec d = pl_vec_scale(
        pl_vec_sub(pl_vec_of(before->angular_velocity), pl_vec_of(after->angular_velocity)),
        dt / 16);
    double mixed[4] = {w - d.x * x - d.y * y - d.z * z, x + d.x * w + d.y * z - d.z * y,
                       y + d.y * w + d.z * x - d.x * z, z + d.z * w + d.x * y - d.y * x};
    double length =
        sqrt(mixed[0] * mixed[0] + mixed[1] * mixed[1] + mixed[2] * mixed[2] + mixed[3] * mixed[3]);
    for (int k = 0; k < 4; ++k) {
        mixed[k] /= length;
    }
    return pl_axes_of(mixed);
}

pl_applied_force pl_applied_force_at(const pl_force *force, const pl_body_state *before,
                                     const pl_body_state *after, double dt, int node)
{
    pl_applied_force a = {pl_vec_scale(pl_vec_of(force->force), dt), pl_vec_of(force->at)};
    if (force->frame == PL_FRAME_BODY) {
        const pl_axes axes = axes_at(before, after, dt, node);
        a.impulse = pl_to_world(&axes, a.impulse);
        a.arm = pl_to_world(&axes, a.arm);
    }
    return a;
}

pl_vec pl_applied_force_impulse(const pl_force *force, pl_position_rule integrator,
                                const pl_body_state *before, const pl_body_state *after, double dt)
{
    if (force->frame != PL_FRAME_BODY || integrator == PL_SEMI_IMPLICIT) {
        return pl_applied_force_at(force, before, after, dt, 0).impulse;
    }
    pl_vec sum = {0, 0, 0};
    for (int i = 0; i < PL_NODES; ++i) {
        sum = pl_vec_mad(sum, pl_node_weights[i],
                         pl_applied_force_at(force, before, after, dt, i).impulse);
    }
    return sum;
}
