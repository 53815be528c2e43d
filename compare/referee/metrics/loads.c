#include "loads.h"

const double pl_load_weights[PL_LOAD_NODES] = {1.0 / 6, 4.0 / 6, 1.0 / 6};

bool pl_load_acts(const pl_force *force, long step, double dt)
{
    /* Times of start and end are met to a millionth of a step, whatever way they were rounded. */
    double time = (double)(step - 1) * dt + 1e-6 * dt;
    return time >= force->from && time < force->until;
}

/* The middle is halfway between, and ahead of that by h (w - w')/8, as Hermite's cubic has it. */
pl_axes pl_load_axes(const pl_body_state *before, const pl_body_state *after, double dt, int node)
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

pl_vec pl_load_impulse(const pl_force *force, pl_integrator integrator, const pl_body_state *before,
                       const pl_body_state *after, double dt)
{
    pl_vec impulse = pl_vec_scale(pl_vec_of(force->force), dt);
    if (force->frame != PL_FRAME_BODY) {
        return impulse;
    }
    if (integrator == PL_SEMI_IMPLICIT) {
        pl_axes axes = pl_load_axes(before, after, dt, 0);
        return pl_to_world(&axes, impulse);
    }
    pl_vec sum = {0, 0, 0};
    for (int i = 0; i < PL_LOAD_NODES; ++i) {
        pl_axes axes = pl_load_axes(before, after, dt, i);
        sum = pl_vec_mad(sum, pl_load_weights[i], pl_to_world(&axes, impulse));
    }
    return sum;
}
