/* Contacts are made again at every step, as ODE's manual has it (section "Collision Detection"): up
 * to max_contacts points a pair, with the friction pyramid whose limits follow the normal force
 * (dContactApprox1) and, where the pair's restitution e > 0, dContactBounce with threshold 0. */

#include "ode_instance.h"

#include "base/array.h"

#include <math.h>
#include <string.h>

static bool is_solid(dGeomID geom)
{
    int class = dGeomGetClass(geom);
    return class == dConvexClass || class == dTriMeshClass;
}

dSurfaceParameters pl_ode_surface(const pl_engine_instance *instance, int body_a, int body_b)
{
    const pl_pair_coefficients pair = pl_setup_pair(instance->setup, body_a, body_b);
    dSurfaceParameters surface;
    memset(&surface, 0, sizeof surface);
    surface.mode = dContactApprox1;
    surface.mu = pair.friction;
    if (pair.restitution > 0) {
        surface.mode |= dContactBounce;
        surface.bounce = pair.restitution;
    }
    return surface;
}

void pl_ode_collide_pair(void *data, dGeomID a, dGeomID b)
{
    pl_engine_instance *instance = data;
    dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
    if (body_a == NULL && body_b == NULL) {
        return;
    }
    int most = is_solid(a) || is_solid(b) ? instance->solid_contacts : instance->max_contacts;
    if (pl_array_reserve(&instance->contacts, &instance->contact_capacity,
                         instance->contact_count + most, sizeof *instance->contacts,
                         NULL) != PL_OK) {
        instance->out_of_memory = true;
        return;
    }
    ode_contact *found = &instance->contacts[instance->contact_count];
    int count = dCollide(a, b, most, &found->geom, sizeof *found);
    if (count == 0) {
        return;
    }
    dContact contact;
    memset(&contact, 0, sizeof contact);
    contact.surface = pl_ode_surface(instance, geom_index(a), geom_index(b));
    for (int i = 0; i < count; ++i) {
        contact.geom = found[i].geom;
        found[i].joint = dJointCreateContact(instance->world, instance->joints, &contact);
        dJointAttach(found[i].joint, body_a, body_b);
    }
    instance->contact_count += count;
}

static int island_root(int *parent, int body)
{
    while (parent[body] != body) {
        parent[body] = parent[parent[body]];
        body = parent[body];
    }
    return body;
}

/* Constraint rows of the largest island: dWorldStep solves the islands one after another. Static
 * bodies join no islands, so a contact counts for the island of its moving body. */
static double largest_island_rows(const pl_engine_instance *instance)
{
    int count = instance->scene->body_count;
    int *parent = instance->island;
    for (int i = 0; i < count; ++i) {
        parent[i] = i;
        instance->rows[i] = 0;
    }
    for (int i = 0; i < instance->contact_count; ++i) {
        int a = geom_index(instance->contacts[i].geom.g1);
        int b = geom_index(instance->contacts[i].geom.g2);
        if (instance->bodies[a] != NULL && instance->bodies[b] != NULL) {
            parent[island_root(parent, a)] = island_root(parent, b);
        }
    }
    double largest = 0;
    for (int i = 0; i < instance->contact_count; ++i) {
        int a = geom_index(instance->contacts[i].geom.g1);
        int b = geom_index(instance->contacts[i].geom.g2);
        int root = island_root(parent, instance->bodies[a] != NULL ? a : b);
        instance->rows[root] += 3;
        largest = fmax(largest, instance->rows[root]);
    }
    return largest;
}

/* dWorldStep holds the island's matrix and its factor, both dense (ODE, lcp.cpp and step.cpp: A and
 * L). */
static double dense_bytes(double rows)
{
    return 2 * rows * rows * (double)sizeof(dReal);
}

pl_status pl_ode_check_dense_memory(const pl_engine_instance *instance, pl_error *error)
{
    if (dense_bytes(3.0 * instance->contact_count) <= pl_dense_limit) {
        return PL_OK;
    }
    double rows = largest_island_rows(instance);
    if (dense_bytes(rows) <= pl_dense_limit) {
        return PL_OK;
    }
    return pl_refuse_dense(error, "ode", "dantzig", rows, dense_bytes(rows));
}

int pl_ode_read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    int count = instance->contact_count < capacity ? instance->contact_count : capacity;
    for (int i = 0; i < count; ++i) {
        const dContactGeom *geom = &instance->contacts[i].geom;
        const int first = geom_index(geom->g1), second = geom_index(geom->g2);
        /* f1 is the force on the first geom's body, or on the only moving one. */
        const double sign = instance->bodies[first] != NULL ? 1 : -1;
        double impulse[3];
        for (int k = 0; k < 3; ++k) {
            impulse[k] = sign * instance->contacts[i].feedback.f1[k] * instance->last_dt;
        }
        pl_set_contact(&contacts[i], first, second, geom->pos, geom->normal, -geom->depth, impulse);
    }
    return instance->contact_count;
}
