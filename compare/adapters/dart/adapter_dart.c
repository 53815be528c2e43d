/* DART 6.12 through dart_c.h.
 *
 * A profile is a solver and a collision detector. `default` is dart::simulation::World as it is
 * constructed: FCL on triangles, Dantzig's method, and PGS for a group where Dantzig fails. `pgs`
 * has PGS alone, with nothing behind it. The others have the default's solver with another
 * detector. Bullet's is left out: libdart-collision-bullet needs Bullet in single precision, whose
 * libraries define 2146 of the symbols of those in double precision, such as
 * btTransform::getIdentity's object, which the dynamic linker makes one for a process.
 *
 * recommended: ODE's detector, with more contacts, as Gazebo sets DART up, whose plugin DART's
 * releases are tested with. What DART's authors advise for contacts is Bullet's detector (issues
 * 860, 1065 and 1183 of dartsim/dart), which Gazebo had before. `sources` has the citations.
 *
 * DART has no sleeping and no damping of its own. Its default step is 1/1000 s (World.cpp); here it
 * is the scene's. */
#include "dart_c.h"
#include "plumb/adapter_helpers.h"
#include "plumb/scenario.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    PROFILE_DEFAULT,
    PROFILE_PGS,
    PROFILE_ODE_COLLISION,
    PROFILE_DART_COLLISION,
    PROFILE_RECOMMENDED,
    PROFILE_COUNT
};

enum { GAZEBO_MAX_CONTACTS = 10000 };

enum {
    OPTION_ITERATIONS,
    OPTION_DELTA_X,
    OPTION_RELATIVE_DELTA_X,
    OPTION_RANDOM_ORDER,
    OPTION_MAX_CONTACTS,
    OPTION_CFM,
    OPTION_ERP,
    OPTION_ERROR_ALLOWANCE,
    OPTION_MAX_ERV,
    OPTION_FCL_PRIMITIVES,
    OPTION_COUNT
};

enum { ALL_PROFILES = (1 << PROFILE_COUNT) - 1, PGS_PROFILES = 1 << PROFILE_PGS };

static const double gibibyte = 1024.0 * 1024.0 * 1024.0;
static const double dense_limit = 4 * 1024.0 * 1024.0 * 1024.0; /* bytes */

#define STEP_CODE "world->setTimeStep({}); world->step();"

static const pl_engine_profile profiles[PROFILE_COUNT] = {
    [PROFILE_DEFAULT] = {.name = "default",
                         .help = "World as constructed: Dantzig's method, FCL on triangles",
                         .in_default_comparison = true,
                         .step_code = STEP_CODE},
    [PROFILE_PGS] = {.name = "pgs",
                     .help = "projected Gauss-Seidel in place of Dantzig's method",
                     .step_code = STEP_CODE},
    [PROFILE_ODE_COLLISION] = {.name = "ode-collision",
                               .help = "the default with ODE's collision detector",
                               .step_code = STEP_CODE},
    [PROFILE_DART_COLLISION] =
        {.name = "dart-collision",
         .help = "the default with DART's own collision detector: spheres and boxes",
         .step_code = STEP_CODE},
    [PROFILE_RECOMMENDED] = {.name = "recommended",
                             .help = "Dantzig's method and ODE's detector, as Gazebo sets DART up",
                             .in_default_comparison = true,
                             .step_code = STEP_CODE},
};

/* A line of code that sets an option of PGS. */
#define PGS_CODE(assignment)                                                                       \
    "auto option = pgs->getOption(); option." assignment "; pgs->setOption(option);"
#define CONTACT_CODE(function) "dart::constraint::ContactConstraint::" function "({});"

static const pl_engine_option options[OPTION_COUNT] = {
    [OPTION_ITERATIONS] = {"iterations", 30, 1, 1e6, true, "1",
                           "most sweeps of PGS; elsewhere of what Dantzig leaves to it",
                           PGS_CODE("mMaxIteration = {}"), PGS_PROFILES, 1, 300, true},
    [OPTION_DELTA_X] = {"delta_x", 1e-6, 0, 1e6, false, "N s",
                        "PGS ends after a first sweep that changes no impulse by more",
                        PGS_CODE("mDeltaXThreshold = {}"), 0, 0, 0, false},
    [OPTION_RELATIVE_DELTA_X] = {"relative_delta_x", 1e-3, 0, 1, false, "1",
                                 "PGS ends after a sweep that changes no impulse by more of it",
                                 PGS_CODE("mRelativeDeltaXTolerance = {}"), PGS_PROFILES, 1e-9,
                                 1e-2, true},
    [OPTION_RANDOM_ORDER] = {"random_order", 0, 0, 1, true, "1",
                             "every eighth sweep of PGS draws a new order of the rows",
                             PGS_CODE("mRandomizeConstraintOrder = {}"), PGS_PROFILES, 0, 1, false},
    [OPTION_MAX_CONTACTS] = {"max_contacts", 1000, 1, 1e6, true, "1",
                             "contact points of a step; those found later are dropped",
                             "world->getConstraintSolver()->getCollisionOption().maxNumContacts = "
                             "{};",
                             0, 0, 0, false},
    [OPTION_CFM] = {"cfm", 1e-5, 1e-9, 1, false, "1",
                    "constraint force mixing: share added to the diagonal",
                    CONTACT_CODE("setConstraintForceMixing"), ALL_PROFILES, 1e-9, 1e-3, true},
    [OPTION_ERP] = {"erp", 0.01, 0, 1, false, "1",
                    "share of the penetration undone in a step, at most at max_erv",
                    CONTACT_CODE("setErrorReductionParameter"), ALL_PROFILES, 0.001, 1, true},
    [OPTION_ERROR_ALLOWANCE] = {"error_allowance", 0, 0, 1e3, false, "m",
                                "penetration that is not undone, where there is friction",
                                CONTACT_CODE("setErrorAllowance"), ALL_PROFILES, 0, 0.002, false},
    [OPTION_MAX_ERV] = {"max_erv", 1e-3, 0, 1e6, false, "m/s",
                        "the fastest that penetration is undone",
                        CONTACT_CODE("setMaxErrorReductionVelocity"), ALL_PROFILES, 1e-4, 10, true},
    [OPTION_FCL_PRIMITIVES] = {"fcl_primitives", 0, 0, 1, true, "1",
                               "FCL's own spheres, boxes and planes, which DART advises against",
                               "fcl->setPrimitiveShapeType(static_cast<dart::collision::"
                               "FCLCollisionDetector::PrimitiveShape>(1 - {}));",
                               0, 0, 0, false},
};

#define GAZEBO_PLUGIN                                                                              \
    "Gazebo's plugin for DART (https://github.com/gazebosim/gz-physics, "                          \
    "dartsim/src/EntityManagementFeatures.cc)"

static const pl_engine_source sources[] = {
    {PROFILE_RECOMMENDED, NULL,
     "ODE's detector: \"setCollisionDetector(dart::collision::OdeCollisionDetector::create())\" "
     "of " GAZEBO_PLUGIN "; \"we started using Bullet ... and then ODE\" "
     "(https://github.com/gazebosim/gz-sim/pull/684). Bullet's, which DART's authors advise "
     "against inaccurate contact points (https://github.com/dartsim/dart/issues/860), cannot be "
     "loaded next to Bullet in double precision"},
    {PROFILE_RECOMMENDED, NULL,
     "Dantzig's method as shipped: \"Dantzig for exact solves\" of contacts with friction (DART, "
     "docs/background/lcp/07_selection-guide.md). PGS, which \"tends to provide more stable "
     "results\" (https://github.com/dartsim/dart/issues/1068), is the profile pgs: towers fall"},
    {PROFILE_RECOMMENDED, "max_contacts", "\"maxNumContacts = 10000\" of " GAZEBO_PLUGIN},
};

struct pl_engine_instance {
    const pl_scene *scene;
    pl_dart_world *world;
    int profile;
    double time;
    long steps;
};

static void dart_destroy(pl_engine_instance *instance)
{
    if (instance != NULL) {
        pl_dart_world_destroy(instance->world);
        free(instance);
    }
}

static pl_dart_detector detector_of(int profile)
{
    switch (profile) {
    case PROFILE_ODE_COLLISION:
    case PROFILE_RECOMMENDED:
        return PL_DART_ODE;
    case PROFILE_DART_COLLISION:
        return PL_DART_OWN;
    default:
        return PL_DART_FCL;
    }
}

static pl_status dart_create(const pl_engine_setup *setup, pl_engine_instance **out,
                             pl_error *error)
{
    const double *values = setup->values;
    *out = NULL;
    if (values[OPTION_FCL_PRIMITIVES] > 0 && detector_of(setup->profile) != PL_DART_FCL) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "dart:%s has not FCL's shapes: it has no fcl_primitives",
                       profiles[setup->profile].name);
    }
    pl_engine_instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for a dart world");
    }
    instance->scene = setup->scene;
    instance->profile = setup->profile;
    const pl_dart_world_def def = {
        .detector = detector_of(setup->profile),
        .pgs = setup->profile == PROFILE_PGS,
        .settings = {.iterations = (int)values[OPTION_ITERATIONS],
                     .delta_x = values[OPTION_DELTA_X],
                     .relative_delta_x = values[OPTION_RELATIVE_DELTA_X],
                     .random_order = values[OPTION_RANDOM_ORDER] > 0,
                     .max_contacts = (int)values[OPTION_MAX_CONTACTS],
                     .cfm = values[OPTION_CFM],
                     .erp = values[OPTION_ERP],
                     .error_allowance = values[OPTION_ERROR_ALLOWANCE],
                     .max_erv = values[OPTION_MAX_ERV],
                     .fcl_primitives = values[OPTION_FCL_PRIMITIVES] > 0},
        .matrix_limit = dense_limit,
    };
    const pl_status status = pl_dart_world_create(&def, setup, &instance->world, error);
    if (status != PL_OK) {
        dart_destroy(instance);
        return status;
    }
    *out = instance;
    return PL_OK;
}

/* The state of a body in the frame of its shape. */
static void read_body(const pl_engine_instance *instance, int body, pl_body_state *state)
{
    pl_dart_read_body(instance->world, body, state);
    pl_to_shape_pose(&instance->scene->bodies[body].shape, state->position, state->orientation);
}

static void add_forces(const pl_engine_instance *instance, double dt)
{
    const pl_scene *scene = instance->scene;
    for (int i = 0; i < scene->force_count; ++i) {
        const pl_force *force = &scene->forces[i];
        pl_body_state state;
        double world_force[3], offset[3];
        if (scene->bodies[force->body].is_static) {
            continue;
        }
        read_body(instance, force->body, &state);
        if (pl_force_at(force, instance->time, dt, state.orientation, world_force, offset)) {
            pl_dart_add_force(instance->world, force->body, world_force, offset);
        }
    }
}

static pl_status dart_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                           pl_error *error)
{
    double rows = 0, bytes = 0;
    add_forces(instance, dt);
    const pl_status status = pl_dart_step(instance->world, stats, &rows, &bytes);
    if (status == PL_UNSUPPORTED) {
        return pl_fail(error, status,
                       "dart:%s needs %.1f GiB for the dense matrices of %.0f contact rows; the "
                       "limit is %.0f GiB",
                       profiles[instance->profile].name, bytes / gibibyte, rows,
                       dense_limit / gibibyte);
    }
    if (status != PL_OK) {
        return pl_fail(error, status, "DART threw an exception in step %ld", instance->steps + 1);
    }
    instance->time += dt;
    ++instance->steps;
    return PL_OK;
}

static void dart_read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    const pl_scene *scene = instance->scene;
    frame->time = instance->time;
    for (int i = 0; i < frame->body_count; ++i) {
        if (scene->bodies[i].shape.kind == PL_SHAPE_PLANE) {
            /* Its shape has its place, or a box stands for it. */
            pl_initial_state(&scene->bodies[i], &frame->bodies[i]);
        } else {
            read_body(instance, i, &frame->bodies[i]);
        }
    }
}

static void dart_read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    pl_dart_read_settings(instance->world, settings);
}

static void dart_read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                           pl_pair_coefficients *found)
{
    pl_dart_read_pair(instance->world, body_a, body_b, found);
}

static int dart_read_contacts(const pl_engine_instance *instance, pl_contact *contacts,
                              int capacity)
{
    return pl_dart_read_contacts(instance->world, contacts, capacity);
}

/* DART's own, also those of a library that was built with others; for `recommended`, that of
 * `sources`. */
static void dart_profile_defaults(int profile, double *values)
{
    const pl_dart_settings defaults = pl_dart_defaults();
    values[OPTION_ITERATIONS] = defaults.iterations;
    values[OPTION_DELTA_X] = defaults.delta_x;
    values[OPTION_RELATIVE_DELTA_X] = defaults.relative_delta_x;
    values[OPTION_RANDOM_ORDER] = defaults.random_order;
    values[OPTION_MAX_CONTACTS] =
        profile == PROFILE_RECOMMENDED ? GAZEBO_MAX_CONTACTS : defaults.max_contacts;
    values[OPTION_CFM] = defaults.cfm;
    values[OPTION_ERP] = defaults.erp;
    values[OPTION_ERROR_ALLOWANCE] = defaults.error_allowance;
    values[OPTION_MAX_ERV] = defaults.max_erv;
    values[OPTION_FCL_PRIMITIVES] = defaults.fcl_primitives;
}

static const pl_engine engine = {
    .struct_size = sizeof(pl_engine),
    .abi_version = PL_ENGINE_ABI_VERSION,
    .name = "dart",
    .version = PLUMB_DART_VERSION,
    .description = "DART, the Dynamic Animation and Robotics Toolkit",
    .capabilities = PL_NEEDS_FRICTION | PL_NEEDS_RESTITUTION | PL_NEEDS_ROTATION | PL_NEEDS_FORCES |
                    PL_NEEDS_PLANE | PL_NEEDS_SPHERE | PL_NEEDS_BOX | PL_NEEDS_CAPSULE |
                    PL_NEEDS_CYLINDER | PL_NEEDS_HULL | PL_NEEDS_MESH,
    .contacts = PL_CONTACTS_POINTS | PL_CONTACTS_IMPULSES,
    .integrator = PL_INTEGRATOR_SEMI_IMPLICIT_EULER,
    .gyroscopic = PL_GYROSCOPIC_EXPLICIT,
    .substeps = 1,
    .profiles = profiles,
    .profile_count = PROFILE_COUNT,
    .sources = sources,
    .source_count = sizeof sources / sizeof sources[0],
    .options = options,
    .option_count = OPTION_COUNT,
    .profile_defaults = dart_profile_defaults,
    .create = dart_create,
    .destroy = dart_destroy,
    .step = dart_step,
    .read_frame = dart_read_frame,
    .read_settings = dart_read_settings,
    .read_pair = dart_read_pair,
    .read_contacts = dart_read_contacts,
};

/* The symbol that the harness looks up. */
const pl_engine *plumb_engine(void);

const pl_engine *plumb_engine(void)
{
    return &engine;
}
