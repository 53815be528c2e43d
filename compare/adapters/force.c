/* A force in the body frame turns with the body: v' = v + 2 q x (q x v + w v), q the vector part.
 */
#include "adapters/force.h"

#include <string.h>

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void rotate(const double q[4], const double v[3], double out[3])
{
    double inner[3], outer[3];
    cross(q + 1, v, inner);
    for (int i = 0; i < 3; i++) {
        inner[i] += q[0] * v[i];
    }
    cross(q + 1, inner, outer);
    for (int i = 0; i < 3; i++) {
        out[i] = v[i] + 2 * outer[i];
    }
}

bool pl_force_at(const pl_force *force, double time, double dt, const double orientation[4],
                 double world_force[3], double world_offset[3])
{
    double slack = 1e-6 * dt;
    if (time + slack < force->from || time + slack >= force->until) {
        return false;
    }
    if (force->frame == PL_FRAME_BODY) {
        rotate(orientation, force->force, world_force);
        rotate(orientation, force->at, world_offset);
    } else {
        memcpy(world_force, force->force, sizeof force->force);
        memcpy(world_offset, force->at, sizeof force->at);
    }
    return true;
}
