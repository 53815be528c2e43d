/* A force in the body frame turns with the body. */
#include "force.h"

#include "plumb/vec.h"

#include <string.h>

bool pl_force_acts(const pl_force *force, double time, double dt)
{
    double slack = 1e-6 * dt;
    return time + slack >= force->from && time + slack < force->until;
}

bool pl_force_at(const pl_force *force, double time, double dt, const double orientation[4],
                 double world_force[3], double world_offset[3])
{
    if (!pl_force_acts(force, time, dt)) {
        return false;
    }
    if (force->frame == PL_FRAME_BODY) {
        const pl_axes axes = pl_axes_of(orientation);
        pl_vec_store(pl_to_world(&axes, pl_vec_of(force->force)), world_force);
        pl_vec_store(pl_to_world(&axes, pl_vec_of(force->at)), world_offset);
    } else {
        memcpy(world_force, force->force, sizeof force->force);
        memcpy(world_offset, force->at, sizeof force->at);
    }
    return true;
}
