/* An ODE world of a scene, as the files of this folder share it.
 *
 * ODE's conventions: quaternions are (w, x, y, z) and angular velocities are the world's, as those of
 * the engine ABI; a contact's normal points into the first geom and its depth is positive; a joint's feedback is the force on
 * each of its bodies, where a joint with one body only has it as its first. */
#ifndef PLUMB_ODE_INSTANCE_H
#define PLUMB_ODE_INSTANCE_H

#include "adapters/native.h"
#include "ode_shapes.h"

#include <stdint.h>

PL_ENGINE_FUNCTIONS(ode)

/* A contact point of the current step. */
typedef struct ode_contact {
    dContactGeom geom;
    dJointID joint;
    dJointFeedback feedback;
} ode_contact;

/* A scene loaded into ODE: its bodies and shapes, and the contact points of the last step. */
struct pl_engine_instance {
    const pl_engine_setup *setup;
    const pl_scene *scene; /* the setup's */
    int profile, max_contacts, solid_contacts;
    dWorldID world;
    dSpaceID space;
    dJointGroupID joints;
    dBodyID *bodies;      /* (body_count), NULL for a static body */
    dGeomID *geoms;       /* (body_count) */
    ode_solid *solids;    /* (polyhedron_count) */
    double time, last_dt; /* s */

    ode_contact *contacts; /* (contact_capacity) */
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

/* ---- Contacts (ode_contacts.c) ---- */

/* What ODE is given for a contact of two bodies: friction and restitution, without a threshold. */
dSurfaceParameters pl_ode_surface(const pl_engine_instance *instance, int body_a, int body_b);

/* For dSpaceCollide with a pl_engine_instance as its data: makes the contact joints of two geoms
 * and notes them in the instance. Sets out_of_memory there where there is no room for them. */
void pl_ode_collide_pair(void *data, dGeomID a, dGeomID b);

/* UNSUPPORTED where dWorldStep would need more memory than the limit for the contacts made. */
pl_status pl_ode_check_dense_memory(const pl_engine_instance *instance, pl_error *error);

/* ---- Reading back (ode_read.c) ---- */

/* The pose of the frame of a moving body's shape. */
void pl_ode_read_pose(const pl_engine_instance *instance, int body, double position[3],
                      double orientation[4]);

/* What the geoms of the shape's polyhedron share; NULL where it has none. */
const ode_solid *pl_ode_solid_of(const pl_engine_instance *instance, const pl_shape *shape);

#endif
