/* Faults of reading: the inner engine simulates the scene, and what is read of it is wrong. */
#include "frame_faults.h"

#include "plumb/vec.h"

#include <math.h>
#include <string.h>

static void quaternion_inverse(const variant_instance *v, pl_frame *frame)
{
    (void)v;
    for (int i = 0; i < frame->body_count; ++i) {
        frame->bodies[i].orientation[0] *= -1;
    }
}

static void quaternion_length(const variant_instance *v, pl_frame *frame)
{
    (void)v;
    for (int i = 0; i < frame->body_count; ++i) {
        for (int k = 0; k < 4; ++k) {
            frame->bodies[i].orientation[k] *= 1.001;
        }
    }
}

/* The velocity of the shape's frame, which hulls and meshes have off their centre of mass. */
static void velocity_of_frame(const variant_instance *v, pl_frame *frame)
{
    for (int i = 0; i < frame->body_count; ++i) {
        const pl_polyhedron *solid = v->scene.bodies[i].shape.polyhedron;
        if (solid != NULL) {
            pl_body_state *body = &frame->bodies[i];
            const pl_vec arm = frame_arm(&v->scene.bodies[i].shape, body->orientation);
            const pl_vec turned = pl_vec_cross(pl_vec_of(body->angular_velocity), arm);
            pl_vec_store(pl_vec_sub(pl_vec_of(body->velocity), turned), body->velocity);
        }
    }
}

static void static_drift(const variant_instance *v, pl_frame *frame)
{
    for (int i = 0; i < frame->body_count; ++i) {
        if (v->scene.bodies[i].is_static) {
            frame->bodies[i].position[0] += 1e-3 * (double)v->steps;
        }
    }
}

static void late_frame(const variant_instance *v, pl_frame *frame)
{
    if (v->steps > 0) {
        memcpy(frame->bodies, v->before, (size_t)frame->body_count * sizeof *frame->bodies);
    }
}

static void no_time(const variant_instance *v, pl_frame *frame)
{
    (void)v;
    frame->time = NAN;
}

static void time_in_steps(const variant_instance *v, pl_frame *frame)
{
    frame->time = (double)v->steps;
}

/* ---- Contacts ---- */

static int reverse_normals(const variant_instance *v, pl_contact *contacts, int count)
{
    (void)v;
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            contacts[i].normal[k] *= -1;
        }
    }
    return count;
}

static int lengthen_normals(const variant_instance *v, pl_contact *contacts, int count)
{
    (void)v;
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            contacts[i].normal[k] *= 3;
        }
    }
    return count;
}

static int scale_impulses(pl_contact *contacts, int count, double factor)
{
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 3; ++k) {
            contacts[i].impulse[k] *= factor;
        }
    }
    return count;
}

static int impulses_in_newtons(const variant_instance *v, pl_contact *contacts, int count)
{
    return scale_impulses(contacts, count, 1 / v->given->dt);
}

static int impulses_of_half_step(const variant_instance *v, pl_contact *contacts, int count)
{
    (void)v;
    return scale_impulses(contacts, count, 0.5);
}

static int impulses_on_a(const variant_instance *v, pl_contact *contacts, int count)
{
    (void)v;
    return scale_impulses(contacts, count, -1);
}

static int no_friction_impulses(const variant_instance *v, pl_contact *contacts, int count)
{
    (void)v;
    for (int i = 0; i < count; ++i) {
        const pl_vec normal = pl_vec_of(contacts[i].normal);
        const double along = pl_vec_dot(normal, pl_vec_of(contacts[i].impulse));
        pl_vec_store(pl_vec_scale(normal, along), contacts[i].impulse);
    }
    return count;
}

static int depth_positive(const variant_instance *v, pl_contact *contacts, int count)
{
    (void)v;
    for (int i = 0; i < count; ++i) {
        contacts[i].separation *= -1;
    }
    return count;
}

/* Names another body of the scene as B. */
static int wrong_body(const variant_instance *v, pl_contact *contacts, int count)
{
    for (int i = 0; i < count; ++i) {
        for (int body = 0; body < v->scene.body_count; ++body) {
            if (body != contacts[i].body_a && body != contacts[i].body_b) {
                contacts[i].body_b = body;
                break;
            }
        }
    }
    return count;
}

static int same_body(const variant_instance *v, pl_contact *contacts, int count)
{
    (void)v;
    for (int i = 0; i < count; ++i) {
        contacts[i].body_b = contacts[i].body_a;
    }
    return count;
}

static int no_body(const variant_instance *v, pl_contact *contacts, int count)
{
    for (int i = 0; i < count; ++i) {
        contacts[i].body_b = v->scene.body_count;
    }
    return count;
}

static int negative_count(const variant_instance *v, pl_contact *contacts, int count)
{
    (void)v;
    (void)contacts;
    return -count;
}

static int lost_contact(const variant_instance *v, pl_contact *contacts, int count)
{
    (void)v;
    (void)contacts;
    return count > 1 ? count - 1 : count;
}

/* In the frame of body B. */
static int local_points(const variant_instance *v, pl_contact *contacts, int count)
{
    for (int i = 0; i < count; ++i) {
        const pl_body_state *body = &v->before[contacts[i].body_b];
        const pl_axes axes = pl_axes_of(body->orientation);
        const pl_vec arm = pl_vec_sub(pl_vec_of(contacts[i].point), pl_vec_of(body->position));
        pl_vec_store(pl_to_local(&axes, arm), contacts[i].point);
    }
    return count;
}

static pl_vec velocity_at(const pl_body_state *body, pl_vec point)
{
    const pl_vec arm = pl_vec_sub(point, pl_vec_of(body->position));
    return pl_vec_add(pl_vec_of(body->velocity),
                      pl_vec_cross(pl_vec_of(body->angular_velocity), arm));
}

/* Points and separations of the pose after the step. */
static int contacts_after_step(const variant_instance *v, pl_contact *contacts, int count)
{
    const double dt = v->given->dt;
    for (int i = 0; i < count; ++i) {
        const pl_vec point = pl_vec_of(contacts[i].point);
        const pl_vec of_a = velocity_at(&v->states[contacts[i].body_a], point);
        const pl_vec of_b = velocity_at(&v->states[contacts[i].body_b], point);
        contacts[i].separation +=
            dt * pl_vec_dot(pl_vec_sub(of_b, of_a), pl_vec_of(contacts[i].normal));
        pl_vec_store(pl_vec_mad(point, 0.5 * dt, pl_vec_add(of_a, of_b)), contacts[i].point);
    }
    return count;
}

/* ---- Settings ---- */

static void other_mass(const variant_instance *v, pl_engine_settings *settings)
{
    (void)v;
    for (int i = 0; i < settings->body_count; ++i) {
        settings->mass[i] *= 0.5;
    }
}

static void other_friction(const variant_instance *v, pl_pair_coefficients *pair)
{
    (void)v;
    pair->friction *= 0.99;
}

static const variant faults[] = {
    {"quaternion_order", "quaternions are read as x, y, z, w",
     .change_frame = frame_quaternion_last_w},
    {"quaternion_inverse", "quaternions are read as world to body",
     .change_frame = quaternion_inverse},
    {"quaternion_length", "quaternions have the length 1.001", .change_frame = quaternion_length},
    {"spin_body_read", "angular velocity is read in the body's frame",
     .change_frame = frame_spin_of_body},
    {"spin_degrees", "angular velocity is read in degrees", .change_frame = frame_spin_in_degrees},
    {"hull_centre_read", "the position of a hull is read as that of its centre of mass",
     .change_frame = frame_centre_of_hulls},
    {"hull_velocity_read", "the velocity of a hull is read at its frame's origin",
     .change_frame = velocity_of_frame},
    {"static_drifts", "static bodies move by 1 mm a step", .change_frame = static_drift},
    {"frame_late", "frames are those before the last step", .change_frame = late_frame},
    {"time_unfilled", "the time of a frame is not filled", .change_frame = no_time},
    {"time_steps", "the time of a frame is the number of steps", .change_frame = time_in_steps},
    {"normal_reversed", "normals point from B to A", .change_contacts = reverse_normals},
    {"normal_length", "normals have the length 3", .change_contacts = lengthen_normals},
    {"impulse_newtons", "impulses are forces, in N", .change_contacts = impulses_in_newtons},
    {"impulse_half", "impulses are those of half the step",
     .change_contacts = impulses_of_half_step},
    {"impulse_on_a", "impulses act on A", .change_contacts = impulses_on_a},
    {"impulse_normal", "impulses lack the part of friction",
     .change_contacts = no_friction_impulses},
    {"separation_sign", "a positive separation is a penetration",
     .change_contacts = depth_positive},
    {"contact_wrong_body", "contacts name a body that does not touch",
     .change_contacts = wrong_body},
    {"contact_self", "contacts are of a body with itself", .change_contacts = same_body},
    {"contact_index", "contacts name a body that the scene does not have",
     .change_contacts = no_body},
    {"contact_count_negative", "the number of contacts is negative",
     .change_contacts = negative_count},
    {"contact_lost", "the last contact is missing", .change_contacts = lost_contact},
    {"contact_points_local", "contact points are in the frame of body B",
     .change_contacts = local_points},
    {"contacts_after", "contacts are those of the pose after the step",
     .change_contacts = contacts_after_step},
    {"settings_mass", "reads back half the mass", .change_settings = other_mass},
    {"settings_friction", "reads back friction x 0.99", .change_pair = other_friction},
};

const pl_engine *plumb_engine(void);

const pl_engine *plumb_engine(void)
{
    static pl_engine engine;
    engine = variant_engine("broken_read", faults, sizeof faults / sizeof *faults);
    return &engine;
}
