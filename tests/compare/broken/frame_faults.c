#include "frame_faults.h"

#include <string.h>

void frame_quaternion_last_w(const variant_instance *v, pl_frame *frame)
{
    (void)v;
    for (int i = 0; i < frame->body_count; ++i) {
        double *q = frame->bodies[i].orientation;
        const double w = q[0];
        memmove(q, q + 1, 3 * sizeof *q);
        q[3] = w;
    }
}

void frame_spin_of_body(const variant_instance *v, pl_frame *frame)
{
    (void)v;
    for (int i = 0; i < frame->body_count; ++i) {
        pl_body_state *body = &frame->bodies[i];
        const pl_axes axes = pl_axes_of(body->orientation);
        pl_vec_store(pl_to_local(&axes, pl_vec_of(body->angular_velocity)), body->angular_velocity);
    }
}

void frame_spin_in_degrees(const variant_instance *v, pl_frame *frame)
{
    (void)v;
    for (int i = 0; i < frame->body_count; ++i) {
        for (int k = 0; k < 3; ++k) {
            frame->bodies[i].angular_velocity[k] *= 57.295779513082321;
        }
    }
}

pl_vec frame_arm(const pl_shape *shape, const double orientation[4])
{
    const pl_axes axes = pl_axes_of(orientation);
    return pl_to_world(&axes, pl_vec_of(shape->polyhedron->centre));
}

void frame_centre_of_hulls(const variant_instance *v, pl_frame *frame)
{
    for (int i = 0; i < frame->body_count; ++i) {
        const pl_shape *shape = &v->scene.bodies[i].shape;
        pl_body_state *body = &frame->bodies[i];
        if (shape->kind == PL_SHAPE_HULL) {
            const pl_vec arm = frame_arm(shape, body->orientation);
            pl_vec_store(pl_vec_add(pl_vec_of(body->position), arm), body->position);
        }
    }
}
