/* ODE 0.16 in double precision, through its C API.
 *
 * quick:   dWorldQuickStep, successive over-relaxation with a fixed number of sweeps.
 * dantzig: dWorldStep, Dantzig's pivoting on the dense matrix of each island.
 *
 * Contacts are made anew at every step, as ODE's manual has it (section "Collision Detection"): up
 * to max_contacts points a pair, with the friction pyramid whose limits follow the normal force
 * (dContactApprox1) and, where the pair's restitution e > 0, dContactBounce with threshold 0.
 * Everything else stays as ODE ships it: ERP, CFM, surface layer, unbounded correcting velocity,
 * over-relaxation, implicit gyroscopic torque. Automatic disabling is off.
 *
 * The contact forces are asked for as joint feedback, which ODE works out inside its step: 4 % more
 * instructions of `quick` on the wall of 10 x 10, and not a bit of difference in the motion.
 *
 * The space is dHashSpace, as in ODE's own demos. ODE has no islands, residual or iteration count
 * to report: `quick` runs exactly the sweeps it is told, and that number is reported; `dantzig`
 * reports none.
 *
 * ODE's conventions: quaternions (w, x, y, z) and world angular velocity are ours; a contact's
 * normal points into the first geom and its depth is positive; a joint's feedback is the force on
 * each of its bodies, where a joint with one body only has it as its first. */
#include "adapters/adapters.h"
#include "adapters/force.h"
#include "plumb/scenario.h"
#include "plumb/vec.h"

#include <math.h>
#include <ode/ode.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PROFILE_QUICK, PROFILE_DANTZIG, PROFILE_COUNT };
enum {
    OPTION_ITERATIONS,
    OPTION_ERP,
    OPTION_CFM,
    OPTION_MAX_CONTACTS,
    OPTION_SURFACE_LAYER,
    OPTION_COUNT
};

enum { SHIPPED_ITERATIONS = 20, MOST_CONTACTS = 64 };

static const double gibibyte = 1024.0 * 1024.0 * 1024.0;
static const double dense_limit = 4 * 1024.0 * 1024.0 * 1024.0; /* bytes */

static const pl_engine_profile profiles[PROFILE_COUNT] = {
    [PROFILE_QUICK] = {.name = "quick",
                       .help = "dWorldQuickStep: successive over-relaxation",
                       .in_default_comparison = true},
    [PROFILE_DANTZIG] = {.name = "dantzig",
                         .help = "dWorldStep: Dantzig's pivoting on a dense matrix",
                         .in_default_comparison = true},
};

static const pl_engine_option options[OPTION_COUNT] = {
    [OPTION_ITERATIONS] = {.name = "iterations",
                           .value = SHIPPED_ITERATIONS,
                           .min = 1,
                           .max = 1e6,
                           .integer = true,
                           .unit = "1",
                           .help = "sweeps of quick; dantzig has none"},
    [OPTION_ERP] = {.name = "erp",
                    .value = 0.2,
                    .min = 0,
                    .max = 1,
                    .unit = "1",
                    .help = "share of the penetration undone in a step"},
    [OPTION_CFM] = {.name = "cfm",
                    .value = 1e-10,
                    .min = 0,
                    .max = 1,
                    .unit = "s^2/kg",
                    .help = "softness added to the diagonal"},
    [OPTION_MAX_CONTACTS] = {.name = "max_contacts",
                             .value = 8,
                             .min = 1,
                             .max = MOST_CONTACTS,
                             .integer = true,
                             .unit = "1",
                             .help = "contact points a pair; two boxes make at most 8"},
    [OPTION_SURFACE_LAYER] = {.name = "surface_layer",
                              .value = 0,
                              .min = 0,
                              .max = 1e3,
                              .unit = "m",
                              .help =
                                  "penetration that is not pushed out; ODE suggests about 0.001"},
};

/* A contact point of the current step. */
typedef struct ode_contact {
    dContactGeom geom;
    dJointID joint;
} ode_contact;

struct pl_engine_instance {
    const pl_scene *scene;
    int profile, max_contacts;
    dWorldID world;
    dSpaceID space;
    dJointGroupID joints;
    dBodyID *bodies; /* (body_count), NULL for a static body */
    dGeomID *geoms;  /* (body_count) */
    double time, last_dt;

    ode_contact *contacts; /* (contact_capacity) */
    dJointFeedback *feedback;
    int contact_count, contact_capacity;
    bool out_of_memory;

    int *island;  /* (body_count): union-find parents, used only when memory is in question */
    double *rows; /* (body_count) */
};

/* ODE calls exit(1) after an error handler returns. A process that ends so would look like one that
 * chose to end; a signal cannot be mistaken. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 0)))
#endif
static void
fatal(int number, const char *format, va_list arguments)
{
    fprintf(stderr, "ODE error %d: ", number);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    fflush(stderr);
    abort();
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int geom_index(dGeomID geom)
{
    return (int)(intptr_t)dGeomGetData(geom);
}

static bool reserve_contacts(pl_engine_instance *instance, int more)
{
    if (instance->contact_count + more <= instance->contact_capacity) {
        return true;
    }
    int capacity = 2 * instance->contact_capacity + more;
    ode_contact *contacts = realloc(instance->contacts, (size_t)capacity * sizeof *contacts);
    if (contacts != NULL) {
        instance->contacts = contacts;
    }
    dJointFeedback *feedback = realloc(instance->feedback, (size_t)capacity * sizeof *feedback);
    if (feedback != NULL) {
        instance->feedback = feedback;
    }
    if (contacts == NULL || feedback == NULL) {
        return false;
    }
    instance->contact_capacity = capacity;
    return true;
}

static void collide_pair(void *data, dGeomID a, dGeomID b)
{
    pl_engine_instance *instance = data;
    dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
    if (body_a == NULL && body_b == NULL) {
        return;
    }
    if (!reserve_contacts(instance, instance->max_contacts)) {
        instance->out_of_memory = true;
        return;
    }
    ode_contact *found = &instance->contacts[instance->contact_count];
    int count = dCollide(a, b, instance->max_contacts, &found->geom, sizeof *found);
    if (count == 0) {
        return;
    }
    dContact contact;
    memset(&contact, 0, sizeof contact);
    const pl_scene *scene = instance->scene;
    double friction, restitution;
    pl_scene_pair(scene, scene->bodies[geom_index(a)].material,
                  scene->bodies[geom_index(b)].material, &friction, &restitution);
    contact.surface.mode = dContactApprox1;
    contact.surface.mu = friction;
    if (restitution > 0) {
        contact.surface.mode |= dContactBounce;
        contact.surface.bounce = restitution;
    }
    for (int i = 0; i < count; i++) {
        contact.geom = found[i].geom;
        found[i].joint = dJointCreateContact(instance->world, instance->joints, &contact);
        dJointAttach(found[i].joint, body_a, body_b);
    }
    instance->contact_count += count;
}

static pl_status add_body(pl_engine_instance *instance, int index, pl_error *error)
{
    const pl_body *body = &instance->scene->bodies[index];
    const pl_shape *shape = &body->shape;
    dGeomID geom = NULL;
    switch (shape->kind) {
    case PL_SHAPE_PLANE:
        geom = dCreatePlane(instance->space, shape->normal[0], shape->normal[1], shape->normal[2],
                            shape->offset);
        break;
    case PL_SHAPE_SPHERE:
        geom = dCreateSphere(instance->space, shape->radius);
        break;
    case PL_SHAPE_BOX:
        geom = dCreateBox(instance->space, 2 * shape->half_extents[0], 2 * shape->half_extents[1],
                          2 * shape->half_extents[2]);
        break;
    }
    if (geom == NULL) {
        return pl_fail(error, PL_UNSUPPORTED, "body \"%s\": ode has no shape of kind %d",
                       body->name, (int)shape->kind);
    }
    instance->geoms[index] = geom;
    dGeomSetData(geom, (void *)(intptr_t)index);
    const double *p = body->position, *q = body->orientation;
    const double *v = body->velocity, *w = body->angular_velocity;
    if (body->is_static) {
        if (shape->kind != PL_SHAPE_PLANE) {
            dGeomSetPosition(geom, p[0], p[1], p[2]);
            dGeomSetQuaternion(geom, q);
        }
        return PL_OK;
    }
    dBodyID made = dBodyCreate(instance->world);
    instance->bodies[index] = made;
    dMass mass;
    dMassSetParameters(&mass, body->mass, 0, 0, 0, body->inertia[0], body->inertia[1],
                       body->inertia[2], 0, 0, 0);
    dBodySetMass(made, &mass);
    dBodySetPosition(made, p[0], p[1], p[2]);
    dBodySetQuaternion(made, q);
    dBodySetLinearVel(made, v[0], v[1], v[2]);
    dBodySetAngularVel(made, w[0], w[1], w[2]);
    dBodySetAutoDisableFlag(made, 0);
    dGeomSetBody(geom, made);
    return PL_OK;
}

static void ode_destroy(pl_engine_instance *instance)
{
    if (instance == NULL) {
        return;
    }
    if (instance->world != NULL) {
        dJointGroupDestroy(instance->joints);
        dSpaceDestroy(instance->space);
        dWorldDestroy(instance->world);
        dCloseODE();
    }
    free(instance->bodies);
    free(instance->geoms);
    free(instance->contacts);
    free(instance->feedback);
    free(instance->island);
    free(instance->rows);
    free(instance);
}

static pl_status make_world(pl_engine_instance *instance, const double *values, pl_error *error)
{
    if (sizeof(dReal) != sizeof(double) || !dCheckConfiguration("ODE_double_precision")) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "this ODE library is built in single precision; plumb needs double");
    }
    if (!dInitODE2(0)) {
        return pl_fail(error, PL_FAILED, "dInitODE2 failed");
    }
    dSetErrorHandler(fatal);
    dSetDebugHandler(fatal);
    /* quick visits constraints in an order drawn from this generator, which the process shares. */
    dRandSetSeed(0);
    const double *g = instance->scene->gravity;
    instance->world = dWorldCreate();
    instance->space = dHashSpaceCreate(NULL);
    instance->joints = dJointGroupCreate(0);
    dWorldSetGravity(instance->world, g[0], g[1], g[2]);
    dWorldSetERP(instance->world, values[OPTION_ERP]);
    dWorldSetCFM(instance->world, values[OPTION_CFM]);
    dWorldSetContactSurfaceLayer(instance->world, values[OPTION_SURFACE_LAYER]);
    dWorldSetAutoDisableFlag(instance->world, 0);
    dWorldSetQuickStepNumIterations(instance->world, (int)values[OPTION_ITERATIONS]);
    instance->max_contacts = (int)values[OPTION_MAX_CONTACTS];
    return PL_OK;
}

static pl_status ode_create(const pl_scene *scene, int profile, const double *values,
                            pl_engine_instance **out, pl_error *error)
{
    *out = NULL;
    if (profile == PROFILE_DANTZIG && (int)values[OPTION_ITERATIONS] != SHIPPED_ITERATIONS) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "ode:dantzig pivots until it is done: it has no iterations to set");
    }
    pl_engine_instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for an ode world");
    }
    pl_status status = PL_OK;
    size_t count = (size_t)scene->body_count + 1;
    instance->scene = scene;
    instance->profile = profile;
    instance->bodies = calloc(count, sizeof *instance->bodies);
    instance->geoms = calloc(count, sizeof *instance->geoms);
    instance->island = calloc(count, sizeof *instance->island);
    instance->rows = calloc(count, sizeof *instance->rows);
    if (instance->bodies == NULL || instance->geoms == NULL || instance->island == NULL ||
        instance->rows == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for %d ode bodies", scene->body_count);
        goto cleanup;
    }
    status = make_world(instance, values, error);
    for (int i = 0; status == PL_OK && i < scene->body_count; i++) {
        status = add_body(instance, i, error);
    }
    if (status == PL_OK) {
        *out = instance;
        instance = NULL;
    }
cleanup:
    ode_destroy(instance);
    return status;
}

static void add_forces(const pl_engine_instance *instance, double dt)
{
    const pl_scene *scene = instance->scene;
    for (int i = 0; i < scene->force_count; i++) {
        dBodyID body = instance->bodies[scene->forces[i].body];
        double f[3], r[3];
        if (body != NULL &&
            pl_force_at(&scene->forces[i], instance->time, dt, dBodyGetQuaternion(body), f, r)) {
            dBodyAddForce(body, f[0], f[1], f[2]);
            pl_vec torque = pl_vec_cross(pl_vec_of(r), pl_vec_of(f));
            dBodyAddTorque(body, torque.x, torque.y, torque.z);
        }
    }
}

static int island_root(int *parent, int body)
{
    while (parent[body] != body) {
        parent[body] = parent[parent[body]];
        body = parent[body];
    }
    return body;
}

/* Constraint rows of the largest island: dWorldStep solves the islands one after another. A static
 * body joins none, so a contact counts at its moving body. */
static double largest_island_rows(const pl_engine_instance *instance)
{
    int count = instance->scene->body_count;
    int *parent = instance->island;
    for (int i = 0; i < count; i++) {
        parent[i] = i;
        instance->rows[i] = 0;
    }
    for (int i = 0; i < instance->contact_count; i++) {
        int a = geom_index(instance->contacts[i].geom.g1);
        int b = geom_index(instance->contacts[i].geom.g2);
        if (instance->bodies[a] != NULL && instance->bodies[b] != NULL) {
            parent[island_root(parent, a)] = island_root(parent, b);
        }
    }
    double largest = 0;
    for (int i = 0; i < instance->contact_count; i++) {
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

static pl_status check_dense_memory(const pl_engine_instance *instance, pl_error *error)
{
    if (dense_bytes(3.0 * instance->contact_count) <= dense_limit) {
        return PL_OK;
    }
    double rows = largest_island_rows(instance);
    if (dense_bytes(rows) <= dense_limit) {
        return PL_OK;
    }
    return pl_fail(
        error, PL_UNSUPPORTED,
        "ode:dantzig needs %.1f GiB for the dense matrices of %.0f contact rows; the limit "
        "is %.0f GiB",
        dense_bytes(rows) / gibibyte, rows, dense_limit / gibibyte);
}

static pl_status ode_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                          pl_error *error)
{
    double start = now();
    dJointGroupEmpty(instance->joints);
    instance->contact_count = 0;
    dSpaceCollide(instance->space, instance, collide_pair);
    if (instance->out_of_memory) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for more than %d ode contacts",
                       instance->contact_count);
    }
    for (int i = 0; i < instance->contact_count; i++) {
        dJointSetFeedback(instance->contacts[i].joint, &instance->feedback[i]);
    }
    add_forces(instance, dt);
    if (instance->profile == PROFILE_DANTZIG) {
        pl_status status = check_dense_memory(instance, error);
        if (status != PL_OK) {
            return status;
        }
    }
    double collided = now();
    int stepped = instance->profile == PROFILE_QUICK ? dWorldQuickStep(instance->world, dt)
                                                     : dWorldStep(instance->world, dt);
    double solved = now();
    if (!stepped) {
        return pl_fail(error, PL_NO_MEMORY, "ode found no memory to step %d contacts",
                       instance->contact_count);
    }
    instance->time += dt;
    instance->last_dt = dt;
    if (instance->profile == PROFILE_QUICK) {
        stats->iterations = dWorldGetQuickStepNumIterations(instance->world);
    }
    stats->contacts = instance->contact_count;
    stats->time_collide = collided - start;
    stats->time_solve = solved - collided;
    return PL_OK;
}

static void ode_read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    const pl_scene *scene = instance->scene;
    frame->time = instance->time;
    for (int i = 0; i < frame->body_count; i++) {
        pl_body_state *state = &frame->bodies[i];
        dBodyID body = instance->bodies[i];
        memset(state, 0, sizeof *state);
        if (body != NULL) {
            memcpy(state->position, dBodyGetPosition(body), sizeof state->position);
            memcpy(state->orientation, dBodyGetQuaternion(body), sizeof state->orientation);
            memcpy(state->velocity, dBodyGetLinearVel(body), sizeof state->velocity);
            memcpy(state->angular_velocity, dBodyGetAngularVel(body),
                   sizeof state->angular_velocity);
        } else if (scene->bodies[i].shape.kind == PL_SHAPE_PLANE) {
            /* ODE's planes have no pose. */
            memcpy(state->position, scene->bodies[i].position, sizeof state->position);
            memcpy(state->orientation, scene->bodies[i].orientation, sizeof state->orientation);
        } else {
            memcpy(state->position, dGeomGetPosition(instance->geoms[i]), sizeof state->position);
            dGeomGetQuaternion(instance->geoms[i], state->orientation);
        }
    }
}

static void ode_read_settings(const pl_engine_instance *instance, double dt,
                              pl_engine_settings *settings)
{
    dVector3 gravity;
    dWorldGetGravity(instance->world, gravity);
    memcpy(settings->gravity, gravity, sizeof settings->gravity);
    settings->dt = dt;
    for (int i = 0; i < settings->body_count; i++) {
        dMass mass;
        memset(&mass, 0, sizeof mass);
        if (instance->bodies[i] != NULL) {
            dBodyGetMass(instance->bodies[i], &mass);
        }
        settings->mass[i] = mass.mass;
        for (int k = 0; k < 3; k++) {
            settings->inertia[i][k] = mass.I[5 * k]; /* the diagonal of a 3 x 4 matrix */
        }
    }
}

static void ode_read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                          double *friction, double *restitution)
{
    const pl_scene *scene = instance->scene;
    pl_scene_pair(scene, scene->bodies[body_a].material, scene->bodies[body_b].material, friction,
                  restitution);
}

static int ode_read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    int count = instance->contact_count < capacity ? instance->contact_count : capacity;
    for (int i = 0; i < count; i++) {
        const dContactGeom *geom = &instance->contacts[i].geom;
        int first = geom_index(geom->g1), second = geom_index(geom->g2);
        bool in_order = first < second;
        pl_contact *contact = &contacts[i];
        contact->body_a = in_order ? first : second;
        contact->body_b = in_order ? second : first;
        contact->separation = -geom->depth;
        /* f1 is the force on the first geom's body, or on the only moving one. */
        bool on_b = instance->bodies[first] != NULL ? !in_order : in_order;
        for (int k = 0; k < 3; k++) {
            contact->point[k] = geom->pos[k];
            contact->normal[k] = in_order ? -geom->normal[k] : geom->normal[k];
            contact->impulse[k] = (on_b ? 1 : -1) * instance->feedback[i].f1[k] * instance->last_dt;
        }
    }
    return instance->contact_count;
}

/* Asks ODE itself, so that a library built with other defaults is compared as it ships. */
static void ode_profile_defaults(int profile, double *values)
{
    (void)profile;
    if (!dInitODE2(0)) {
        return;
    }
    dWorldID world = dWorldCreate();
    values[OPTION_ITERATIONS] = dWorldGetQuickStepNumIterations(world);
    values[OPTION_ERP] = dWorldGetERP(world);
    values[OPTION_CFM] = dWorldGetCFM(world);
    values[OPTION_SURFACE_LAYER] = dWorldGetContactSurfaceLayer(world);
    dWorldDestroy(world);
    dCloseODE();
}

static const pl_engine engine = {
    .struct_size = sizeof(pl_engine),
    .abi_version = PL_ENGINE_ABI_VERSION,
    .name = "ode",
    .version = PLUMB_ODE_VERSION,
    .description = "Open Dynamics Engine, double precision",
    .residual_unit = NULL,
    .capabilities = PL_NEEDS_FRICTION | PL_NEEDS_RESTITUTION | PL_NEEDS_ROTATION | PL_NEEDS_FORCES |
                    PL_NEEDS_PLANE | PL_NEEDS_SPHERE | PL_NEEDS_BOX,
    .profiles = profiles,
    .profile_count = PROFILE_COUNT,
    .options = options,
    .option_count = OPTION_COUNT,
    .profile_defaults = ode_profile_defaults,
    .create = ode_create,
    .destroy = ode_destroy,
    .step = ode_step,
    .read_frame = ode_read_frame,
    .read_settings = ode_read_settings,
    .read_pair = ode_read_pair,
    .read_contacts = ode_read_contacts,
};

const pl_engine *pl_engine_ode(void)
{
    return &engine;
}
