
#include "ode_instance.h"

#include "plumb/vec.h"

const ode_solid *pl_ode_solid_of(const pl_engine_instance *instance, const pl_shape *shape)
{
    const int index = pl_polyhedron_index(instance->scene, shape->polyhedron);
    return index < 0 ? NULL : &instance->solids[index];
}

void pl_ode_read_pose(const pl_engine_instance *instance, int body, double position[3],
                      double orientation[4])
{
    dBodyID moving = instance->bodies[body];
    memcpy(position, dBodyGetPosition(moving), 3 * sizeof *position);
    memcpy(orientation, dBodyGetQuaternion(moving), 4 * sizeof *orientation);
    pl_to_shape_pose(&instance->scene->bodies[body].shape, position, orientation);
}

static void read_static(const pl_engine_instance *instance, int body, pl_body_state *state)
{
    dGeomID geom = instance->geoms[body];
    const ode_solid *solid = pl_ode_solid_of(instance, &instance->scene->bodies[body].shape);
    memcpy(state->position, dGeomGetPosition(geom), sizeof state->position);
    dGeomGetQuaternion(geom, state->orientation);
    if (solid != NULL) {
        const pl_axes axes = pl_axes_of(state->orientation);
        pl_vec origin = pl_to_world(&axes, pl_vec_of(solid->origin));
        pl_vec_store(pl_vec_sub(pl_vec_of(state->position), origin), state->position);
    }
}

void pl_ode_read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    const pl_scene *scene = instance->scene;
    frame->time = instance->time;
    for (int i = 0; i < frame->body_count; ++i) {
        pl_body_state *state = &frame->bodies[i];
        dBodyID body = instance->bodies[i];
        memset(state, 0, sizeof *state);
        if (body != NULL) {
            pl_ode_read_pose(instance, i, state->position, state->orientation);
            memcpy(state->velocity, dBodyGetLinearVel(body), sizeof state->velocity);
            memcpy(state->angular_velocity, dBodyGetAngularVel(body),
                   sizeof state->angular_velocity);
        } else if (scene->bodies[i].shape.kind == PL_SHAPE_PLANE) {
            /* ODE's planes have no pose. */
            pl_initial_state(&scene->bodies[i], state);
        } else {
            read_static(instance, i, state);
        }
    }
}

void pl_ode_read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    dVector3 gravity;
    dWorldGetGravity(instance->world, gravity);
    memcpy(settings->gravity, gravity, sizeof settings->gravity);
    settings->linear_damping = dWorldGetLinearDamping(instance->world);
    settings->angular_damping = dWorldGetAngularDamping(instance->world);
    for (int i = 0; i < settings->body_count; ++i) {
        dMass mass;
        memset(&mass, 0, sizeof mass);
        if (instance->bodies[i] != NULL) {
            dBodyGetMass(instance->bodies[i], &mass);
        }
        settings->mass[i] = mass.mass;
        for (int k = 0; k < 3; ++k) {
            settings->inertia[i][k] = mass.I[5 * k]; /* the diagonal of a 3 x 4 matrix */
        }
    }
}

void pl_ode_read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                      pl_pair_coefficients *found)
{
    const dSurfaceParameters surface = pl_ode_surface(instance, body_a, body_b);
    found->friction = surface.mu;
    found->restitution = (surface.mode & dContactBounce) != 0 ? surface.bounce : 0;
}
