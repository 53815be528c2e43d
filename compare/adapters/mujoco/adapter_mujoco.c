/* MuJoCo 2.2, through its C API.
 *
 * default:     as shipped: Newton's method, pyramidal cones, contacts with a time constant of 20 ms.
 * cg, pgs:     the same with its other two solvers.
 * recommended: what its documentation says of contacts that should not slip and not yield. "The best
 *   way to suppress it is to use elliptic cones, large impratio, and the Newton algorithm with very
 *   small tolerance" (Modeling, "Algorithms and settings", which has 1e-10 for it). "Increasing
 *   constraint impedance (first two elements of solimp) as well as the global impratio setting can
 *   be particularly effective" (Overview, "Softness and slip"). Several points of two shapes that
 *   have no collider of their own "can be useful when the contacting geoms have a flat surface"
 *   (XML reference, multiccd). The time constant is the default, since no other is advised, and the
 *   Noslip solver stays off, because with it "the simulation may become less robust".
 *
 * MuJoCo has soft contacts: every constraint is a spring with a damper, which yields under load. It
 * has no coefficient of restitution, so restitution is no capability. A step is mj_step1 and
 * mj_step2, which together are mj_step.
 *
 * A state that is not finite or too large makes MuJoCo start again from its initial state with no
 * more than a warning. Such a warning ends the run. */
#include "mujoco_instance.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* MuJoCo waits for a key and exits when it meets an error, which would look like a program that
 * hangs or ended by itself. A signal is unambiguous. */
static void fatal(const char *message)
{
    fprintf(stderr, "MuJoCo error: %s\n", message);
    fflush(stderr);
    abort();
}

/* Without a handler MuJoCo writes warnings into a file of the working directory as well. */
static void warn(const char *message)
{
    fprintf(stderr, "MuJoCo warning: %s\n", message);
}

void pl_mujoco_defaults(int profile, double *values)
{
    engine_profile_values(profile, values);
}

pl_status pl_mujoco_create(const pl_engine_setup *setup, pl_engine_instance **out, pl_error *error)
{
    *out = NULL;
    mju_user_error = fatal;
    mju_user_warning = warn;
    mjcb_time = pl_seconds;
    if (mj_version() != mjVERSION_HEADER) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "the MuJoCo library is %s, but its headers were another version's",
                       mj_versionString());
    }
    pl_engine_instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    instance->scene = setup->scene;
    pl_status status = pl_mujoco_load(setup, instance, error);
    if (status != PL_OK) {
        pl_mujoco_destroy(instance);
        return status;
    }
    *out = instance;
    return PL_OK;
}

/* xfrc_applied has six numbers of each body: a force at the centre of mass and a torque, in the
 * world's axes. */
static void apply_forces(pl_engine_instance *instance, double dt)
{
    const pl_scene *scene = instance->scene;
    mjData *data = instance->data;
    mju_zero(data->xfrc_applied, 6 * instance->model->nbody);
    for (int i = 0; i < scene->force_count; ++i) {
        const pl_force *force = &scene->forces[i];
        double position[3], orientation[4], along[3], at[3];
        if (scene->bodies[force->body].is_static) {
            continue;
        }
        pl_mujoco_read_pose(instance, force->body, position, orientation);
        if (pl_force_at(force, data->time, dt, orientation, along, at)) {
            mjtNum *sum = data->xfrc_applied + 6 * (ptrdiff_t)pl_mujoco_body(instance, force->body);
            mjtNum torque[3];
            mju_cross(torque, at, along);
            mju_addTo3(sum, along);
            mju_addTo3(sum + 3, torque);
        }
    }
}

/* Contacts and constraints at the present poses. The data are made again where they are too small
 * for them. */
static pl_status collide(pl_engine_instance *instance, pl_error *error)
{
    for (;;) {
        mj_step1(instance->model, instance->data);
        const mjWarningStat *warning = instance->data->warning;
        if (warning[mjWARN_CONTACTFULL].number <= 1 && warning[mjWARN_CNSTRFULL].number <= 1) {
            return PL_OK;
        }
        pl_status status = pl_mujoco_grow(instance, error);
        if (status != PL_OK) {
            return status;
        }
    }
}

static pl_status check_warnings(const mjData *data, pl_error *error)
{
    static const int fatal_warnings[] = {mjWARN_INERTIA, mjWARN_BADQPOS, mjWARN_BADQVEL,
                                         mjWARN_BADQACC};
    for (size_t i = 0; i < sizeof fatal_warnings / sizeof *fatal_warnings; ++i) {
        const mjWarningStat *warning = &data->warning[fatal_warnings[i]];
        if (warning->number > 0) {
            return pl_fail(error, PL_FAILED, "MuJoCo gave up its state: %s",
                           mju_warningText(fatal_warnings[i], warning->lastinfo));
        }
    }
    return PL_OK;
}

/* Newton's method and conjugate gradients report the norm of the gradient, scaled to an
 * acceleration; Noslip, which comes after them, and Gauss-Seidel report none, but 0. */
static double last_gradient(const mjModel *model, const mjData *data)
{
    if (model->opt.solver == mjSOL_PGS || data->solver_iter > mjNSOLVER) {
        return NAN;
    }
    for (int i = data->solver_iter - 1; i >= 0; --i) {
        if (data->solver[i].gradient != 0 || model->opt.noslip_iterations == 0) {
            return data->solver[i].gradient;
        }
    }
    return NAN;
}

static double solving_time(const mjData *data)
{
    return data->timer[mjTIMER_POS_MAKE].duration + data->timer[mjTIMER_POS_PROJECT].duration +
           data->timer[mjTIMER_CONSTRAINT].duration;
}

pl_status pl_mujoco_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                         pl_error *error)
{
    double start = pl_seconds();
    instance->model->opt.timestep = dt;
    memset(instance->data->timer, 0, sizeof instance->data->timer);
    pl_status status = collide(instance, error);
    if (status != PL_OK) {
        return status;
    }
    mjData *data = instance->data;
    apply_forces(instance, dt);
    mj_step2(instance->model, data);
    stats->iterations = data->solver_iter;
    stats->residual = last_gradient(instance->model, data);
    stats->contacts = pl_mujoco_read_contacts(instance, NULL, 0);
    stats->time_collide = data->timer[mjTIMER_POS_COLLISION].duration;
    stats->time_solve = solving_time(data);
    stats->time_other = pl_seconds() - start - stats->time_collide - stats->time_solve;
    return check_warnings(data, error);
}

PL_ENGINE(pl_engine_mujoco, mujoco)
