/* Faults of create: what the inner engine is given is not what the scene says. Where an adapter of
 * that kind would undo its mistake when it reads, the fault does so too. */
#include "frame_faults.h"

#include "plumb/vec.h"

#include <math.h>
#include <string.h>
#include <time.h>

/* ---- Numbers of the scene ---- */

static void scale_masses(variant_instance *v, double mass, double inertia)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        v->scene.bodies[i].mass *= mass;
        for (int k = 0; k < 3; ++k) {
            v->scene.bodies[i].inertia[k] *= inertia;
        }
    }
}

static void half_mass(variant_instance *v)
{
    scale_masses(v, 0.5, 0.5);
}

static void double_mass(variant_instance *v)
{
    scale_masses(v, 2, 2);
}

static void double_inertia(variant_instance *v)
{
    scale_masses(v, 1, 2);
}

static void permute_inertia(variant_instance *v)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        double *inertia = v->scene.bodies[i].inertia;
        const double first = inertia[0];
        inertia[0] = inertia[1];
        inertia[1] = inertia[2];
        inertia[2] = first;
    }
}

/* Multiplies the coefficients of all pairs. */
static void scale_pairs(variant_instance *v, double friction, double restitution)
{
    for (int i = 0; i < v->scene.material_count * v->scene.material_count; ++i) {
        v->pairs[i].friction *= friction;
        v->pairs[i].restitution *= restitution;
    }
    variant_use_pairs(v);
}

static void low_friction(variant_instance *v)
{
    scale_pairs(v, 0.99, 1);
}

static void low_restitution(variant_instance *v)
{
    scale_pairs(v, 1, 0.98);
}

static void no_restitution(variant_instance *v)
{
    scale_pairs(v, 1, 0);
}

static void no_friction(variant_instance *v)
{
    scale_pairs(v, 0, 1);
}

static void friction_by_product(variant_instance *v)
{
    const int count = v->scene.material_count;
    for (int i = 0; i < count * count; ++i) {
        v->pairs[i].friction =
            v->scene.materials[i / count].friction * v->scene.materials[i % count].friction;
    }
    variant_use_pairs(v);
}

static void high_gravity(variant_instance *v)
{
    for (int k = 0; k < 3; ++k) {
        v->scene.gravity[k] *= 1.01;
    }
}

static void vertical_gravity(variant_instance *v)
{
    v->scene.gravity[0] = v->scene.gravity[1] = 0;
}

/* ---- The initial state ---- */

static void mix_quaternion(variant_instance *v)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        const double *from = v->given->scene->bodies[i].orientation;
        memcpy(v->scene.bodies[i].orientation, (double[]){from[3], from[0], from[1], from[2]},
               4 * sizeof *from);
    }
}

static void take_angular_velocity_for_bodys(variant_instance *v)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        pl_body *body = &v->scene.bodies[i];
        const pl_axes axes = pl_axes_of(body->orientation);
        pl_vec_store(pl_to_world(&axes, pl_vec_of(body->angular_velocity)), body->angular_velocity);
    }
}

static const double degree = 0.017453292519943295; /* rad */

static void take_degrees(variant_instance *v)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        for (int k = 0; k < 3; ++k) {
            v->scene.bodies[i].angular_velocity[k] *= degree;
        }
    }
}

static void no_angular_velocity(variant_instance *v)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        memset(v->scene.bodies[i].angular_velocity, 0, sizeof v->scene.bodies[i].angular_velocity);
    }
}

static void no_velocity(variant_instance *v)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        memset(v->scene.bodies[i].velocity, 0, sizeof v->scene.bodies[i].velocity);
    }
}

static void move_statics(variant_instance *v)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        v->scene.bodies[i].position[0] += v->scene.bodies[i].is_static ? 1 : 0;
    }
}

static void put_centre_at_position(variant_instance *v)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        pl_body *body = &v->scene.bodies[i];
        if (body->shape.kind == PL_SHAPE_HULL) {
            const pl_vec arm = frame_arm(&body->shape, body->orientation);
            pl_vec_store(pl_vec_sub(pl_vec_of(body->position), arm), body->position);
        }
    }
}

/* Adds 1e-12 times a number that depends on `seed` to the positions. */
static void disturb(variant_instance *v, long seed)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        v->scene.bodies[i].position[0] += 1e-12 * (double)(1 + seed % 997);
    }
}

static long nanoseconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_nsec;
}

static void random_process(variant_instance *v)
{
    static long seed;
    seed = seed == 0 ? nanoseconds() : seed;
    disturb(v, seed);
}

static void random_instance(variant_instance *v)
{
    static long seed;
    disturb(v, ++seed);
}

/* ---- Shapes ---- */

enum { AWAY = 1000 }; /* m, above everything */

static void lift(variant_instance *v, pl_shape_kind kind)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        v->scene.bodies[i].position[2] += v->scene.bodies[i].shape.kind == kind ? AWAY : 0;
    }
}

static void lower(const variant_instance *v, pl_frame *frame, pl_shape_kind kind)
{
    for (int i = 0; i < frame->body_count; ++i) {
        frame->bodies[i].position[2] -= v->scene.bodies[i].shape.kind == kind ? AWAY : 0;
    }
}

/* A body far above the scene touches nothing. */
static void lift_cylinders(variant_instance *v)
{
    lift(v, PL_SHAPE_CYLINDER);
}

static void lower_cylinders(const variant_instance *v, pl_frame *frame)
{
    lower(v, frame, PL_SHAPE_CYLINDER);
}

static void lift_meshes(variant_instance *v)
{
    lift(v, PL_SHAPE_MESH);
}

static void lower_meshes(const variant_instance *v, pl_frame *frame)
{
    lower(v, frame, PL_SHAPE_MESH);
}

static void small_boxes(variant_instance *v)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        for (int k = 0; k < 3; ++k) {
            v->scene.bodies[i].shape.half_extents[k] *= 0.5;
        }
    }
}

static void short_capsules(variant_instance *v)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        pl_shape *shape = &v->scene.bodies[i].shape;
        if (shape->kind == PL_SHAPE_CAPSULE) {
            shape->half_height = fmax(1e-3, shape->half_height - shape->radius);
        }
    }
}

static void planes_at_origin(variant_instance *v)
{
    for (int i = 0; i < v->scene.body_count; ++i) {
        v->scene.bodies[i].shape.offset = 0;
    }
}

/* ---- Forces ---- */

static void forces_at_centre(variant_instance *v)
{
    for (int i = 0; i < v->scene.force_count; ++i) {
        memset(v->scene.forces[i].at, 0, sizeof v->scene.forces[i].at);
    }
}

static void forces_in_world(variant_instance *v)
{
    for (int i = 0; i < v->scene.force_count; ++i) {
        v->scene.forces[i].frame = PL_FRAME_WORLD;
    }
}

static void forces_for_ever(variant_instance *v)
{
    for (int i = 0; i < v->scene.force_count; ++i) {
        v->scene.forces[i].from = 0;
        v->scene.forces[i].until = INFINITY;
    }
}

static const variant faults[] = {
    {"good", "nothing is wrong", .change_setup = NULL},
    {"mass_half", "half the mass and inertia", .change_setup = half_mass},
    {"mass_double", "twice the mass and inertia", .change_setup = double_mass},
    {"inertia_double", "twice the inertia", .change_setup = double_inertia},
    {"inertia_permuted", "moments of inertia belong to other axes",
     .change_setup = permute_inertia},
    {"friction_low", "friction x 0.99", .change_setup = low_friction},
    {"friction_ignored", "claims friction, and everything slides", .change_setup = no_friction},
    {"friction_product", "friction of a pair is the product of its materials'",
     .change_setup = friction_by_product},
    {"restitution_low", "restitution x 0.98", .change_setup = low_restitution},
    {"restitution_ignored", "claims restitution, and nothing bounces",
     .change_setup = no_restitution},
    {"gravity_high", "gravity x 1.01", .change_setup = high_gravity},
    {"gravity_vertical", "only the z component of gravity", .change_setup = vertical_gravity},
    {"quaternion_mixed", "quaternions are x, y, z, w when written and when read",
     .change_setup = mix_quaternion, .change_frame = frame_quaternion_last_w},
    {"spin_body_write", "the initial angular velocity is taken to be in the body's frame",
     .change_setup = take_angular_velocity_for_bodys},
    {"spin_body_both", "angular velocity is in the body's frame when written and when read",
     .change_setup = take_angular_velocity_for_bodys, .change_frame = frame_spin_of_body},
    {"spin_degrees_both", "angular velocity is in degrees when written and when read",
     .change_setup = take_degrees, .change_frame = frame_spin_in_degrees},
    {"spin_ignored", "the initial angular velocity is ignored",
     .change_setup = no_angular_velocity},
    {"velocity_ignored", "the initial velocity is ignored", .change_setup = no_velocity},
    {"static_moved", "static bodies are created and read 1 m away", .change_setup = move_statics},
    {"hull_centre", "the position of a hull is that of its centre of mass",
     .change_setup = put_centre_at_position, .change_frame = frame_centre_of_hulls},
    {"random_process", "positions differ by 1e-12 m from process to process",
     .change_setup = random_process},
    {"random_instance", "positions differ by 1e-12 m from instance to instance",
     .change_setup = random_instance},
    {"cylinders_absent", "claims cylinders, and nothing touches them",
     .change_setup = lift_cylinders, .change_frame = lower_cylinders},
    {"meshes_absent", "claims meshes, and nothing touches them", .change_setup = lift_meshes,
     .change_frame = lower_meshes},
    {"box_half_size", "half extents are taken for edges", .change_setup = small_boxes},
    {"capsule_short", "the length of a capsule is taken to include its caps",
     .change_setup = short_capsules},
    {"plane_offset", "every plane goes through the origin", .change_setup = planes_at_origin},
    {"force_offset", "forces act at the centre of mass", .change_setup = forces_at_centre},
    {"force_frame", "forces in the body's frame are taken to be in the world's",
     .change_setup = forces_in_world},
    {"force_time", "forces act all the time", .change_setup = forces_for_ever},
};

const pl_engine *plumb_engine(void);

const pl_engine *plumb_engine(void)
{
    static pl_engine engine;
    engine = variant_engine("broken_setup", faults, sizeof faults / sizeof *faults);
    return &engine;
}
