/* The contacts of a step: made by ODE's collider, and read back. */
#ifndef PLUMB_ODE_CONTACTS_H
#define PLUMB_ODE_CONTACTS_H

#include "ode_instance.h"

/* For dSpaceCollide with a pl_engine_instance as its data: makes the contact joints of two geoms
 * and notes them in the instance. Sets out_of_memory there where there is no room for them. */
void pl_ode_collide_pair(void *data, dGeomID a, dGeomID b);

/* UNSUPPORTED where dWorldStep would need more memory than the limit for the contacts made. */
pl_status pl_ode_check_dense_memory(const pl_engine_instance *instance, pl_error *error);

/* As read_contacts of pl_engine. */
int pl_ode_read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity);

#endif
