/* A scene in MuJoCo, as the files of this folder share it.
 *
 * MuJoCo's conventions: quaternions are (w, x, y, z), as those of the engine ABI; a free joint's
 * velocity is that of the origin of its body's frame in the world's axes, its angular velocity in the body's; a contact's normal points from its
 * first geom to its second, its distance is negative in penetration, its force acts on the second. */
#ifndef PLUMB_MUJOCO_INSTANCE_H
#define PLUMB_MUJOCO_INSTANCE_H

#include "adapters/native.h"

#include <mujoco/mujoco.h>
#include <mujoco_description.h>

PL_ENGINE_FUNCTIONS(mujoco)

/* A scene loaded into MuJoCo. */
struct pl_engine_instance {
    const pl_scene *scene;
    mjModel *model;
    mjData *data;
    int contacts; /* for which there is room */
    int *geoms;   /* (body_count): the geom of each body of the scene */
    int *bodies;  /* (body_count): the body of the scene that each geom is */
};

/* The number that a body of the scene has in MuJoCo; 0, the world, for a plane. */
static inline int pl_mujoco_body(const pl_engine_instance *instance, int body)
{
    return instance->model->geom_bodyid[instance->geoms[body]];
}

/* ---- The model (mujoco_model.c) ---- */

/* Loads the scene with the options of the setup into the instance. What it made is freed by
 * pl_mujoco_destroy, also after a failure. */
pl_status pl_mujoco_load(const pl_engine_setup *setup, pl_engine_instance *instance,
                         pl_error *error);

/* Makes room for more contacts and keeps the state. PL_UNSUPPORTED: MuJoCo cannot hold more. */
pl_status pl_mujoco_grow(pl_engine_instance *instance, pl_error *error);

/* ---- Reading back (mujoco_read.c) ---- */

/* The pose of the frame of a moving body's shape. */
void pl_mujoco_read_pose(const pl_engine_instance *instance, int body, double position[3],
                         double orientation[4]);

#endif
