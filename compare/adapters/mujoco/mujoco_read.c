#include "mujoco_instance.h"

#include <math.h>

/* The first coordinate of a moving body's free joint, in qpos. */
static const mjtNum *joint_position(const pl_engine_instance *instance, int body)
{
    const mjModel *model = instance->model;
    return instance->data->qpos +
           model->jnt_qposadr[model->body_jntadr[pl_mujoco_body(instance, body)]];
}

/* The first velocity of a moving body's free joint, in qvel. */
static const mjtNum *joint_velocity(const pl_engine_instance *instance, int body)
{
    const mjModel *model = instance->model;
    return instance->data->qvel +
           model->jnt_dofadr[model->body_jntadr[pl_mujoco_body(instance, body)]];
}

void pl_mujoco_read_pose(const pl_engine_instance *instance, int body, double position[3],
                         double orientation[4])
{
    const mjtNum *joint = joint_position(instance, body);
    memcpy(position, joint, 3 * sizeof *position);
    memcpy(orientation, joint + 3, 4 * sizeof *orientation);
    pl_to_shape_pose(&instance->scene->bodies[body].shape, position, orientation);
}

static void read_moving(const pl_engine_instance *instance, int body, pl_body_state *state)
{
    const mjtNum *velocity = joint_velocity(instance, body);
    pl_mujoco_read_pose(instance, body, state->position, state->orientation);
    memcpy(state->velocity, velocity, sizeof state->velocity);
    pl_rotate_to_world(joint_position(instance, body) + 3, velocity + 3, state->angular_velocity);
}

static void read_static(const pl_engine_instance *instance, int body, pl_body_state *state)
{
    const pl_body *asked = &instance->scene->bodies[body];
    if (asked->shape.kind == PL_SHAPE_PLANE) {
        /* In MuJoCo its frame is along the normal. */
        pl_initial_state(asked, state);
        return;
    }
    ptrdiff_t number = pl_mujoco_body(instance, body);
    memcpy(state->position, instance->model->body_pos + 3 * number, sizeof state->position);
    memcpy(state->orientation, instance->model->body_quat + 4 * number, sizeof state->orientation);
    pl_to_shape_pose(&asked->shape, state->position, state->orientation);
}

void pl_mujoco_read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    frame->time = instance->data->time;
    for (int i = 0; i < frame->body_count; ++i) {
        pl_body_state *state = &frame->bodies[i];
        memset(state, 0, sizeof *state);
        if (instance->scene->bodies[i].is_static) {
            read_static(instance, i, state);
        } else {
            read_moving(instance, i, state);
        }
    }
}

void pl_mujoco_read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    const mjModel *model = instance->model;
    memcpy(settings->gravity, model->opt.gravity, sizeof settings->gravity);
    settings->dt = model->opt.timestep;
    settings->linear_damping = 0;
    settings->angular_damping = 0;
    for (int i = 0; i < model->nv; ++i) {
        /* The first three degrees of freedom of each body are its translation. */
        double *damping = i % 6 < 3 ? &settings->linear_damping : &settings->angular_damping;
        *damping = fmax(*damping, model->dof_damping[i]);
    }
    for (int i = 0; i < settings->body_count; ++i) {
        ptrdiff_t number = pl_mujoco_body(instance, i);
        settings->mass[i] = model->body_mass[number];
        memcpy(settings->inertia[i], model->body_inertia + 3 * number, sizeof settings->inertia[i]);
    }
}

/* The friction of the compiled model's element `pair`, or else that which MuJoCo combines. */
void pl_mujoco_read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                         pl_pair_coefficients *found)
{
    const mjModel *model = instance->model;
    int a = instance->geoms[body_a], b = instance->geoms[body_b];
    int condim = model->geom_condim[a] > model->geom_condim[b] ? model->geom_condim[a]
                                                               : model->geom_condim[b];
    double friction = fmax(model->geom_friction[3 * a], model->geom_friction[3 * b]);
    for (int i = 0; i < model->npair; ++i) {
        if ((model->pair_geom1[i] == a && model->pair_geom2[i] == b) ||
            (model->pair_geom1[i] == b && model->pair_geom2[i] == a)) {
            condim = model->pair_dim[i];
            friction = model->pair_friction[5 * i];
        }
    }
    /* A contact of one dimension has no friction, and every other at least mjMINMU. */
    found->friction = condim == 1 ? 0 : fmax(friction, mjMINMU);
    found->restitution = NAN;
}

int pl_mujoco_read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    const mjModel *model = instance->model;
    const mjData *data = instance->data;
    int count = 0;
    for (int i = 0; i < data->ncon; ++i) {
        const mjContact *from = &data->contact[i];
        if (from->efc_address < 0) {
            continue;
        }
        if (count < capacity) {
            pl_contact *to = &contacts[count];
            mjtNum force[6];
            mj_contactForce(model, data, i, force);
            memset(to, 0, sizeof *to);
            to->body_a = instance->bodies[from->geom1];
            to->body_b = instance->bodies[from->geom2];
            to->separation = from->dist;
            memcpy(to->point, from->pos, sizeof to->point);
            memcpy(to->normal, from->frame, sizeof to->normal);
            for (int k = 0; k < 3; ++k) { /* the frame's rows are the normal and two tangents */
                to->impulse[k] = model->opt.timestep *
                                 (force[0] * from->frame[k] + force[1] * from->frame[3 + k] +
                                  force[2] * from->frame[6 + k]);
            }
        }
        ++count;
    }
    return count;
}
