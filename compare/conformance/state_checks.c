/* The state of bodies as it is written by create and read by read_frame. */
#include "probe.h"

#include <math.h>
#include <string.h>

/* A box that is turned about no axis of symmetry and moves and spins in every direction. */
static pl_body turned_box(void)
{
    pl_body box = pl_body_default();
    box.shape = pl_shape_box(0.3, 0.5, 0.8);
    box.mass = 2;
    memcpy(box.position, (double[]){1, -2, 5}, sizeof box.position);
    memcpy(box.orientation, (double[]){0.2, 0.4, -0.4, 0.8}, sizeof box.orientation);
    memcpy(box.velocity, (double[]){0.3, -0.2, 0.7}, sizeof box.velocity);
    memcpy(box.angular_velocity, (double[]){0.5, -1.1, 0.9}, sizeof box.angular_velocity);
    return box;
}

static void check_initial_orientation(pl_probe *p)
{
    pl_probe_scene(p, 1.0 / 100);
    const int box = pl_probe_add_body(p, turned_box());
    pl_probe_create(p);
    const double *q = p->now[box].orientation;
    const double *asked = p->scene.bodies[box].orientation;
    const double sign = q[0] * asked[0] + q[1] * asked[1] + q[2] * asked[2] + q[3] * asked[3];
    double found[3];
    for (int k = 0; k < 3; ++k) {
        found[k] = sign < 0 ? -q[k + 1] : q[k + 1];
    }
    pl_probe_expect_vector(p, "x, y, z of the quaternion before the first step", found, asked + 1,
                           pl_probe_tolerance(p, 1),
                           "the order of the quaternion's components: the ABI's is w, x, y, z");
}

const pl_check pl_state_checks[] = {
    {"quaternion-order", "orientation reads back as (w, x, y, z)", PL_NEEDS_BOX | PL_NEEDS_ROTATION,
     0, check_initial_orientation},
};
const int pl_state_check_count = sizeof pl_state_checks / sizeof *pl_state_checks;
