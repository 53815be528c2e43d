/* An ODE world of a scene, as the files of this folder share it.
 *
 * ODE's conventions: quaternions (w, x, y, z) and world angular velocity are ours; a contact's
 * normal points into the first geom and its depth is positive; a joint's feedback is the force on
 * each of its bodies, where a joint with one body only has it as its first. */
#ifndef PLUMB_ODE_INSTANCE_H
#define PLUMB_ODE_INSTANCE_H

#include "ode_shapes.h"
#include "plumb/engine_abi.h"

#include <stdint.h>

/* A contact point of the current step. */
typedef struct ode_contact {
    dContactGeom geom;
    dJointID joint;
} ode_contact;

struct pl_engine_instance {
    const pl_scene *scene;
    int profile, max_contacts, solid_contacts;
    dWorldID world;
    dSpaceID space;
    dJointGroupID joints;
    dBodyID *bodies;      /* (body_count), NULL for a static body */
    dGeomID *geoms;       /* (body_count) */
    ode_solid *solids;    /* (polyhedron_count) */
    double time, last_dt; /* s */

    ode_contact *contacts; /* (contact_capacity) */
    dJointFeedback *feedback;
    int contact_count, contact_capacity;
    bool out_of_memory;

    int *island;  /* (body_count): union-find parents, used only when memory is in question */
    double *rows; /* (body_count) */
};

/* The index of the scene's body that a geom of the world is. */
static inline int geom_index(dGeomID geom)
{
    return (int)(intptr_t)dGeomGetData(geom);
}

#endif
