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
#include "ode_shapes.h"
#include "plumb/adapter_helpers.h"
#include "plumb/scenario.h"
#include "plumb/vec.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PROFILE_QUICK, PROFILE_DANTZIG, PROFILE_RECOMMENDED, PROFILE_COUNT };
enum {
    OPTION_ITERATIONS,
    OPTION_ERP,
    OPTION_CFM,
    OPTION_MAX_CONTACTS,
    OPTION_SOLID_CONTACTS,
    OPTION_SURFACE_LAYER,
    OPTION_MAX_CORRECTING_VEL,
    OPTION_SOR_W,
    OPTION_COUNT
};

enum { QUICK_PROFILES = 1 << PROFILE_QUICK | 1 << PROFILE_RECOMMENDED };
enum { ALL_PROFILES = QUICK_PROFILES | 1 << PROFILE_DANTZIG };
/* Stands for ODE's infinite correcting velocity, m/s: options are finite. */
#define UNLIMITED 1e9

/* ODE's, as a constant. */
#define DEFAULT_SOR_W 1.3

enum { DEFAULT_ITERATIONS = 20, MOST_CONTACTS = 64, MOST_SOLID_CONTACTS = 4096 };

static const pl_engine_profile profiles[PROFILE_COUNT] = {
    [PROFILE_QUICK] = {.name = "quick",
                       .help = "dWorldQuickStep: successive over-relaxation",
                       .in_default_comparison = true,
                       .step_code = "dWorldQuickStep(world, {});"},
    [PROFILE_DANTZIG] = {.name = "dantzig",
                         .help = "dWorldStep: Dantzig's pivoting on a dense matrix",
                         .in_default_comparison = true,
                         .step_code = "dWorldStep(world, {});"},
    [PROFILE_RECOMMENDED] =
        {.name = "recommended",
         .help = "dWorldQuickStep as ODE's documentation and demo of stacks have it",
         .in_default_comparison = true,
         .step_code = "dWorldQuickStep(world, {});"},
};

static const pl_engine_option options[OPTION_COUNT] = {
    [OPTION_ITERATIONS] = {"iterations", DEFAULT_ITERATIONS, 1, 1e6, true, "1",
                           "sweeps of quick; dantzig has none",
                           "dWorldSetQuickStepNumIterations(world, {});", QUICK_PROFILES, 1, 300,
                           true},
    [OPTION_ERP] = {"erp", 0.2, 0, 1, false, "1", "share of the penetration undone in a step",
                    "dWorldSetERP(world, {});", ALL_PROFILES, 0.05, 1, false},
    [OPTION_CFM] = {"cfm", 1e-10, 0, 1, false, "s^2/kg", "softness added to the diagonal",
                    "dWorldSetCFM(world, {});", ALL_PROFILES, 1e-10, 1e-3, true},
    [OPTION_MAX_CONTACTS] =
        {"max_contacts", 8, 1, MOST_CONTACTS, true, "1",
         "contact points a pair; two boxes make at most 8",
         "dCollide(a, b, {}, contacts, sizeof *contacts); /* of other shapes than hulls and "
         "meshes */",
         ALL_PROFILES, 3, 8, false},
    [OPTION_SOLID_CONTACTS] =
        {"solid_contacts", 64, 1, MOST_SOLID_CONTACTS, true, "1",
         "the same of a pair with a hull or a mesh; ODE takes the first, not the deepest",
         "dCollide(a, b, {}, contacts, sizeof *contacts); /* of hulls and meshes */", 0, 0, 0,
         false},
    [OPTION_SURFACE_LAYER] = {"surface_layer", 0, 0, 1e3, false, "m",
                              "penetration that is not pushed out; ODE suggests about 0.001",
                              "dWorldSetContactSurfaceLayer(world, {});", ALL_PROFILES, 0, 0.002,
                              false},
    [OPTION_MAX_CORRECTING_VEL] = {"max_correcting_vel", UNLIMITED, 0, UNLIMITED, false, "m/s",
                                   "fastest that penetration is undone; 1e9: no limit",
                                   "dWorldSetContactMaxCorrectingVel(world, {});", ALL_PROFILES,
                                   0.01, 100, true},
    [OPTION_SOR_W] = {"sor_w", DEFAULT_SOR_W, 0.1, 1.9, false, "1",
                      "over-relaxation of quick's sweeps; dantzig has none",
                      "dWorldSetQuickStepW(world, {});", QUICK_PROFILES, 0.7, 1.5, false},
};

#define BOX_STACK_DEMO "ODE's demo of box stacks, ode/demo/demo_boxstack.cpp"

static const pl_engine_source sources[] = {
    {PROFILE_RECOMMENDED, NULL,
     "ode/objects.h, dWorldQuickStep: \"QuickStep is great for stacks of objects\"; dWorldStep is "
     "\"currently the most accurate method\""},
    {PROFILE_RECOMMENDED, NULL,
     "time step: \"smaller step = more accurate, more stable\" (ODE wiki, HOWTO make the "
     "simulation "
     "better, Behavior may depend on step size, "
     "https://ode.org/wiki/index.php/HOWTO_make_the_simulation_better); the demo of box stacks has "
     "1/50 s"},
    {PROFILE_RECOMMENDED, "iterations",
     "ode/objects.h, dWorldSetQuickStepNumIterations: \"More iterations will give a more accurate "
     "solution\"; the number is the default of SDF, the scene format of Gazebo "
     "(sdf/1.6/physics.sdf, ode, solver, iters)"},
    {PROFILE_RECOMMENDED, NULL,
     "left as it is: CFM, which helps \"near-singular systems\" (ode/objects.h, dWorldQuickStep); "
     "the "
     "1e-5 of the demo of box stacks takes 0.7 % off restitution and does not make towers better"},
    {PROFILE_RECOMMENDED, "surface_layer",
     "ode/objects.h, dWorldSetContactSurfaceLayer: \"some small value (e.g. 0.001) can help "
     "prevent "
     "jittering problems\"; so has " BOX_STACK_DEMO},
    {PROFILE_RECOMMENDED, "max_correcting_vel",
     "ode/objects.h, dWorldSetContactMaxCorrectingVel: \"Reducing this value can help prevent "
     "'popping' of deeply embedded objects\"; the value is that of " BOX_STACK_DEMO},
};

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

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
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
    double p[3], q[4];
    memcpy(p, body->position, sizeof p);
    memcpy(q, body->orientation, sizeof q);
    pl_to_principal_pose(shape, p, q);
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
    pl_ode_place_in_body(geom, shape, solid);
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
        for (int i = 0; instance->solids != NULL && i < instance->scene->polyhedron_count; ++i) {
            pl_ode_free_solid(&instance->solids[i]);
        }
        dCloseODE();
    }
    free(instance->solids);
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

static pl_status ode_create(const pl_engine_setup *setup, pl_engine_instance **out, pl_error *error)
{
    const pl_scene *scene = setup->scene;
    const double *values = setup->values;
    *out = NULL;
    if (setup->profile == PROFILE_DANTZIG &&
        ((int)values[OPTION_ITERATIONS] != DEFAULT_ITERATIONS ||
         values[OPTION_SOR_W] != DEFAULT_SOR_W)) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "ode:dantzig pivots until it is done: it has no %s to set",
                       values[OPTION_SOR_W] != DEFAULT_SOR_W ? "sor_w" : "iterations");
    }
    pl_engine_instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for an ode world");
    }
    pl_status status = PL_OK;
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
        status = pl_fail(error, PL_NO_MEMORY, "out of memory for %d ode bodies", scene->body_count);
        goto cleanup;
    }
    status = make_world(instance, values, error);
    for (int i = 0; status == PL_OK && i < scene->polyhedron_count; ++i) {
        status = pl_ode_make_solid(scene->polyhedra[i], &instance->solids[i], error);
    }
    for (int i = 0; status == PL_OK && i < scene->body_count; ++i) {
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

static pl_status ode_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                          pl_error *error)
{
    double start = now();
    dJointGroupEmpty(instance->joints);
    instance->contact_count = 0;
    dSpaceCollide(instance->space, instance, pl_ode_collide_pair);
    if (instance->out_of_memory) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for more than %d ode contacts",
                       instance->contact_count);
    }
    for (int i = 0; i < instance->contact_count; ++i) {
        dJointSetFeedback(instance->contacts[i].joint, &instance->feedback[i]);
    }
    add_forces(instance, dt);
    if (instance->profile == PROFILE_DANTZIG) {
        pl_status status = pl_ode_check_dense_memory(instance, error);
        if (status != PL_OK) {
            return status;
        }
    }
    double collided = now();
    int stepped = instance->profile == PROFILE_DANTZIG ? dWorldStep(instance->world, dt)
                                                       : dWorldQuickStep(instance->world, dt);
    double solved = now();
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
static void ode_profile_defaults(int profile, double *values)
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
    if (profile == PROFILE_RECOMMENDED) {
        values[OPTION_ITERATIONS] = 50;
        values[OPTION_SURFACE_LAYER] = 0.001;
        values[OPTION_MAX_CORRECTING_VEL] = 0.1;
    }
}

static const pl_engine engine = {
    .struct_size = sizeof(pl_engine),
    .abi_version = PL_ENGINE_ABI_VERSION,
    .name = "ode",
    .version = PLUMB_ODE_VERSION,
    .description = "Open Dynamics Engine, double precision",
    .residual_unit = NULL,
    .capabilities = PL_NEEDS_FRICTION | PL_NEEDS_RESTITUTION | PL_NEEDS_ROTATION | PL_NEEDS_FORCES |
                    PL_NEEDS_PLANE | PL_NEEDS_SPHERE | PL_NEEDS_BOX | PL_NEEDS_CAPSULE |
                    PL_NEEDS_CYLINDER | PL_NEEDS_HULL | PL_NEEDS_MESH,
    .contacts = PL_CONTACTS_POINTS | PL_CONTACTS_IMPULSES,
    .integrator = PL_INTEGRATOR_SEMI_IMPLICIT_EULER,
    .gyroscopic = PL_GYROSCOPIC_IMPLICIT,
    .substeps = 1,
    .profiles = profiles,
    .profile_count = PROFILE_COUNT,
    .options = options,
    .option_count = OPTION_COUNT,
    .profile_defaults = ode_profile_defaults,
    .create = ode_create,
    .destroy = ode_destroy,
    .step = ode_step,
    .read_frame = pl_ode_read_frame,
    .read_settings = pl_ode_read_settings,
    .read_pair = pl_ode_read_pair,
    .read_contacts = pl_ode_read_contacts,
    .sources = sources,
    .source_count = sizeof sources / sizeof *sources,
};

/* The table of built-in engines calls it. */
const pl_engine *pl_engine_ode(void);

const pl_engine *pl_engine_ode(void)
{
    return &engine;
}
