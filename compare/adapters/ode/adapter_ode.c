/* ODE 0.16 in double precision, through its C API.
 *
 * quick:   dWorldQuickStep, successive over-relaxation with a fixed number of sweeps.
 * dantzig: dWorldStep, Dantzig's pivoting on the dense matrix of each island.
 * recommended: dWorldQuickStep, which ODE calls "great for stacks of objects", with the settings
 *   that its documentation and its own demo of box stacks give it. dWorldStep, "the most accurate
 *   method", is the profile dantzig.
 *
 * Everything but the contacts (ode_contacts.c) has ODE's defaults: ERP, CFM, surface layer,
 * unbounded correcting velocity, over-relaxation, implicit gyroscopic torque. Automatic disabling
 * is off. Rolling friction is none.
 *
 * The contact forces are asked for as joint feedback, which ODE works out inside its step: 4 % more
 * instructions of `quick` on the wall of 10 x 10, and not a bit of difference in the motion.
 *
 * The space is dHashSpace, as in ODE's own demos. ODE has no islands, residual or iteration count
 * to report: `quick` runs exactly the sweeps it is set to, and that number is reported; `dantzig`
 * reports none. */
#include "ode_instance.h"

#include "plumb/vec.h"

#include <math.h>
#include <ode_description.h>
#include <stdio.h>
#include <stdlib.h>

/* Stands for ODE's infinite correcting velocity, m/s: options are finite. */
#define UNLIMITED 1e9

/* ODE calls exit(1) when an error handler returns, which would look like a program that ended by
 * itself. A signal is unambiguous. */
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

static pl_status add_body(pl_engine_instance *instance, int index, pl_error *error)
{
    const pl_body *body = &instance->scene->bodies[index];
    const pl_shape *shape = &body->shape;
    const ode_solid *solid = pl_ode_solid_of(instance, shape);
    if (shape->polyhedron != NULL && solid == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "body \"%s\": its solid is not one of the scene's",
                       body->name);
    }
    dGeomID geom = pl_ode_make_geom(instance->space, shape, solid);
    if (geom == NULL) {
        return pl_fail(error, PL_UNSUPPORTED, "body \"%s\": ode has no shape of kind %d",
                       body->name, (int)shape->kind);
    }
    instance->geoms[index] = geom;
    dGeomSetData(geom, (void *)(intptr_t)index);
    if (body->is_static) {
        pl_ode_place_static(geom, body, solid);
        return PL_OK;
    }
    const double *v = body->velocity, *w = body->angular_velocity;
    pl_body_state at;
    pl_initial_state(body, &at);
    pl_to_principal_pose(shape, at.position, at.orientation);
    dBodyID made = dBodyCreate(instance->world);
    instance->bodies[index] = made;
    dMass mass;
    dMassSetParameters(&mass, body->mass, 0, 0, 0, body->inertia[0], body->inertia[1],
                       body->inertia[2], 0, 0, 0);
    dBodySetMass(made, &mass);
    dBodySetPosition(made, at.position[0], at.position[1], at.position[2]);
    dBodySetQuaternion(made, at.orientation);
    dBodySetLinearVel(made, v[0], v[1], v[2]);
    dBodySetAngularVel(made, w[0], w[1], w[2]);
    dBodySetAutoDisableFlag(made, 0);
    dGeomSetBody(geom, made);
    pl_ode_place_in_body(geom, shape, solid);
    return PL_OK;
}

void pl_ode_destroy(pl_engine_instance *instance)
{
    if (instance == NULL) {
        return;
    }
    if (instance->world != NULL) {
        dJointGroupDestroy(instance->joints);
        dSpaceDestroy(instance->space);
        dWorldDestroy(instance->world);
        for (int i = 0; instance->solids != NULL && i < instance->scene->polyhedron_count; ++i) {
            pl_ode_free_solid(&instance->solids[i]);
        }
        dCloseODE();
    }
    free(instance->solids);
    free(instance->bodies);
    free(instance->geoms);
    free(instance->contacts);
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
    if (values[OPTION_MAX_CORRECTING_VEL] < UNLIMITED) {
        dWorldSetContactMaxCorrectingVel(instance->world, values[OPTION_MAX_CORRECTING_VEL]);
    }
    dWorldSetQuickStepW(instance->world, values[OPTION_SOR_W]);
    dWorldSetAutoDisableFlag(instance->world, 0);
    dWorldSetQuickStepNumIterations(instance->world, (int)values[OPTION_ITERATIONS]);
    instance->max_contacts = (int)values[OPTION_MAX_CONTACTS];
    instance->solid_contacts = (int)values[OPTION_SOLID_CONTACTS];
    return pl_ode_check_colliders(instance->scene, error);
}

pl_status pl_ode_create(const pl_engine_setup *setup, pl_engine_instance **out, pl_error *error)
{
    const pl_scene *scene = setup->scene;
    const double *values = setup->values;
    *out = NULL;
    const bool has_iterations =
        values[OPTION_ITERATIONS] != engine_options[OPTION_ITERATIONS].value;
    const bool has_sor_w = values[OPTION_SOR_W] != engine_options[OPTION_SOR_W].value;
    if (setup->profile == PROFILE_DANTZIG && (has_iterations || has_sor_w)) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "ode:dantzig pivots until it is done: it has no %s to set",
                       has_sor_w ? "sor_w" : "iterations");
    }
    pl_engine_instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for an ode world");
    }
    size_t count = (size_t)scene->body_count + 1;
    instance->setup = setup;
    instance->scene = scene;
    instance->profile = setup->profile;
    instance->bodies = calloc(count, sizeof(dBodyID));
    instance->geoms = calloc(count, sizeof(dGeomID));
    instance->solids = calloc((size_t)scene->polyhedron_count + 1, sizeof *instance->solids);
    instance->island = calloc(count, sizeof *instance->island);
    instance->rows = calloc(count, sizeof *instance->rows);
    if (instance->bodies == NULL || instance->geoms == NULL || instance->solids == NULL ||
        instance->island == NULL || instance->rows == NULL) {
        pl_ode_destroy(instance);
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d ode bodies", scene->body_count);
    }
    pl_status status = make_world(instance, values, error);
    for (int i = 0; status == PL_OK && i < scene->polyhedron_count; ++i) {
        status = pl_ode_make_solid(scene->polyhedra[i], &instance->solids[i], error);
    }
    for (int i = 0; status == PL_OK && i < scene->body_count; ++i) {
        status = add_body(instance, i, error);
    }
    if (status != PL_OK) {
        pl_ode_destroy(instance);
        return status;
    }
    *out = instance;
    return PL_OK;
}

static void add_forces(const pl_engine_instance *instance, double dt)
{
    const pl_scene *scene = instance->scene;
    for (int i = 0; i < scene->force_count; ++i) {
        const pl_force *force = &scene->forces[i];
        dBodyID body = instance->bodies[force->body];
        double p[3], q[4], f[3], r[3];
        if (body == NULL) {
            continue;
        }
        pl_ode_read_pose(instance, force->body, p, q);
        if (pl_force_at(force, instance->time, dt, q, f, r)) {
            dBodyAddForce(body, f[0], f[1], f[2]);
            pl_vec torque = pl_vec_cross(pl_vec_of(r), pl_vec_of(f));
            dBodyAddTorque(body, torque.x, torque.y, torque.z);
        }
    }
}

pl_status pl_ode_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error)
{
    double start = pl_seconds();
    dJointGroupEmpty(instance->joints);
    instance->contact_count = 0;
    dSpaceCollide(instance->space, instance, pl_ode_collide_pair);
    if (instance->out_of_memory) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for more than %d ode contacts",
                       instance->contact_count);
    }
    for (int i = 0; i < instance->contact_count; ++i) {
        dJointSetFeedback(instance->contacts[i].joint, &instance->contacts[i].feedback);
    }
    add_forces(instance, dt);
    if (instance->profile == PROFILE_DANTZIG) {
        pl_status status = pl_ode_check_dense_memory(instance, error);
        if (status != PL_OK) {
            return status;
        }
    }
    double collided = pl_seconds();
    int stepped = instance->profile == PROFILE_DANTZIG ? dWorldStep(instance->world, dt)
                                                       : dWorldQuickStep(instance->world, dt);
    double solved = pl_seconds();
    if (!stepped) {
        return pl_fail(error, PL_NO_MEMORY, "ode found no memory to step %d contacts",
                       instance->contact_count);
    }
    instance->time += dt;
    instance->last_dt = dt;
    if (instance->profile != PROFILE_DANTZIG) {
        stats->iterations = dWorldGetQuickStepNumIterations(instance->world);
    }
    stats->contacts = instance->contact_count;
    stats->time_collide = collided - start;
    stats->time_solve = solved - collided;
    return PL_OK;
}

/* The defaults are ODE's own, also those of a library that was built with others; for `recommended`,
 * those of `sources`. */
void pl_ode_defaults(int profile, double *values)
{
    if (!dInitODE2(0)) {
        return;
    }
    dWorldID world = dWorldCreate();
    values[OPTION_ITERATIONS] = dWorldGetQuickStepNumIterations(world);
    values[OPTION_ERP] = dWorldGetERP(world);
    values[OPTION_CFM] = dWorldGetCFM(world);
    values[OPTION_SURFACE_LAYER] = dWorldGetContactSurfaceLayer(world);
    values[OPTION_MAX_CORRECTING_VEL] = fmin(dWorldGetContactMaxCorrectingVel(world), UNLIMITED);
    values[OPTION_SOR_W] = dWorldGetQuickStepW(world);
    dWorldDestroy(world);
    dCloseODE();
    engine_profile_values(profile, values);
}

PL_ENGINE(pl_engine_ode, ode)
