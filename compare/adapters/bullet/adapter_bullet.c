/* Bullet 3.24 in double precision, through bullet_c.h.
 *
 * si and nncg are Bullet's iterative solvers, with 10 iterations by default; dantzig and lemke give
 * each group of islands to a dense solver, which falls back to sequential impulse where it fails
 * (reported on standard error at the end of the run). `recommended` is si as Bullet's own
 * documentation and tools set it up for accuracy; why each value, its sources say. It leaves the
 * margins as they are ("It is best not to modify the default collision margin", Bullet 2.83 Physics
 * SDK Manual, Collision Margin), also that of hulls and meshes, which Bullet would have grow by
 * 0.04 m. Everything else has Bullet's defaults: one
 * friction direction a contact point along its sliding velocity, islands gathered into groups of
 * 128 constraints, contact points kept over steps. Sleeping is off. The callbacks for a pair's
 * friction and restitution, asked when a contact point is made, are 1 % of the instructions of a
 * step of si on the wall of 10 x 10.
 *
 * nncg ends every sweep by a step along its search direction that is not bounded again (3.24,
 * btNNCGConstraintSolver.cpp), so that of several contact points one may be left pulling. */
#include "bullet_c.h"
#include "plumb/adapter_helpers.h"
#include "plumb/scenario.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_ITERATIONS,
    OPTION_SPLIT_IMPULSE,
    OPTION_ERP,
    OPTION_ERP2,
    OPTION_RESTITUTION_THRESHOLD,
    OPTION_MARGIN,
    OPTION_SOLID_MARGIN,
    OPTION_PLANE_MULTIPOINT,
    OPTION_CONVEX_MULTIPOINT,
    OPTION_FRICTION_DIRECTIONS,
    OPTION_WARM_START,
    OPTION_RANDOM_ORDER,
    OPTION_SPLIT_THRESHOLD,
    OPTION_SLOP,
    OPTION_CONTACT_BREAKING,
    OPTION_COUNT
};

/* The other profiles have the numbers of their solvers. */
enum { PROFILE_RECOMMENDED = PL_BULLET_LEMKE + 1 };

enum {
    SWEPT_PROFILES = 1 << PL_BULLET_SI | 1 << PROFILE_RECOMMENDED,
    ITERATIVE_PROFILES = SWEPT_PROFILES | 1 << PL_BULLET_NNCG,
    ALL_PROFILES = ITERATIVE_PROFILES | 1 << PL_BULLET_DANTZIG | 1 << PL_BULLET_LEMKE
};

/* How a program steps by {} seconds. */
#define STEP_CODE "world->stepSimulation({}, 0);"

static const double gibibyte = 1024.0 * 1024.0 * 1024.0;
static const double dense_limit = 4 * 1024.0 * 1024.0 * 1024.0; /* bytes */

static const pl_engine_profile profiles[] = {
    [PL_BULLET_SI] = {.name = "si",
                      .help = "btSequentialImpulseConstraintSolver",
                      .in_default_comparison = true,
                      .step_code = STEP_CODE},
    [PL_BULLET_NNCG] = {.name = "nncg",
                        .help = "btNNCGConstraintSolver: nonsmooth nonlinear conjugate gradients",
                        .in_default_comparison = true,
                        .step_code = STEP_CODE},
    [PL_BULLET_DANTZIG] = {.name = "dantzig",
                           .help = "btMLCPSolver with btDantzigSolver",
                           .step_code = STEP_CODE},
    [PL_BULLET_LEMKE] = {.name = "lemke",
                         .help = "btMLCPSolver with btLemkeSolver, which bounds friction by mu N s",
                         .step_code = STEP_CODE},
    [PROFILE_RECOMMENDED] = {.name = "recommended",
                             .help = "si as Bullet's documentation and tools have it for accuracy",
                             .in_default_comparison = true,
                             .step_code = STEP_CODE},
};

/* A line of code that switches a bit of the solver's mode. */
#define MODE_CODE(bit, on) "if (" on ") world->getSolverInfo().m_solverMode |= " bit ";"

static const pl_engine_option options[OPTION_COUNT] = {
    [OPTION_ITERATIONS] = {"iterations", 10, 1, 1e6, true, "1",
                           "sweeps of si and nncg; of the fallback of dantzig and lemke",
                           "world->getSolverInfo().m_numIterations = {};", ITERATIVE_PROFILES, 1,
                           300, true},
    [OPTION_SPLIT_IMPULSE] = {"split_impulse", 1, 0, 1, true, "1",
                              "undo deep penetration apart from the velocity",
                              "world->getSolverInfo().m_splitImpulse = {};", ALL_PROFILES, 0, 1,
                              false},
    [OPTION_ERP] = {"erp", 0.2, 0, 1, false, "1", "share of a joint's error undone in a step",
                    "world->getSolverInfo().m_erp = {};", 0, 0, 0, false},
    [OPTION_ERP2] = {"erp2", 0.2, 0, 1, false, "1",
                     "share of a contact's penetration undone in a step",
                     "world->getSolverInfo().m_erp2 = {};", ALL_PROFILES, 0.05, 1, false},
    [OPTION_RESTITUTION_THRESHOLD] = {"restitution_threshold", 0.2, 0, 1e6, false, "m/s",
                                      "slower impacts do not bounce",
                                      "world->getSolverInfo().m_restitutionVelocityThreshold = {};",
                                      0, 0, 0, false},
    [OPTION_MARGIN] =
        {"margin", 0.04, 0, 1e3, false, "m",
         "of a box or cylinder, inside its half extents; at most a tenth of the least",
         "shape->setMargin({}); /* of boxes and cylinders; at most a tenth of the "
         "least half extent */",
         ALL_PROFILES, 0.001, 0.1, true},
    [OPTION_SOLID_MARGIN] =
        {"solid_margin", 0, 0, 1e3, false, "m",
         "of a hull (Bullet's default: 0.04) or a moving mesh (0.01), which grow by it",
         "shape->setMargin({}); /* of hulls and meshes */", 0, 0, 0, false},
    [OPTION_PLANE_MULTIPOINT] =
        {"plane_multipoint", 0, 0, 16, true, "1",
         "points sought each step against a plane; Bullet suggests 3",
         "const int points = {}; configuration.setPlaneConvexMultipointIterations(points, points);",
         ALL_PROFILES, 0, 4, false},
    [OPTION_CONVEX_MULTIPOINT] =
        {"convex_multipoint", 0, 0, 16, true, "1",
         "the same of hulls and cylinders among convex shapes",
         "const int sought = {}; "
         "configuration.setConvexConvexMultipointIterations(sought, sought);",
         ALL_PROFILES, 0, 4, false},
    [OPTION_FRICTION_DIRECTIONS] = {"friction_directions", 1, 1, 2, true, "1",
                                    "rows of friction a point: 1, along its sliding, or 2",
                                    MODE_CODE("SOLVER_USE_2_FRICTION_DIRECTIONS", "{} == 2"),
                                    ALL_PROFILES, 1, 2, false},
    [OPTION_WARM_START] = {"warm_start", 0.85, 0, 1, false, "1",
                           "share of a point's last normal impulse with which a solve begins",
                           "world->getSolverInfo().m_warmstartingFactor = {};", ITERATIVE_PROFILES,
                           0, 1, false},
    [OPTION_RANDOM_ORDER] = {"random_order", 0, 0, 1, true, "1",
                             "sweeps visit the contacts in a new order each",
                             MODE_CODE("SOLVER_RANDMIZE_ORDER", "{} == 1"), SWEPT_PROFILES, 0, 1,
                             false},
    [OPTION_SPLIT_THRESHOLD] = {"split_threshold", -0.04, -1e3, 0, false, "m",
                                "separation below which split_impulse acts",
                                "world->getSolverInfo().m_splitImpulsePenetrationThreshold = {};",
                                ALL_PROFILES, -0.04, 0, false},
    [OPTION_SLOP] = {"slop", 0, 0, 1e3, false, "m", "penetration that is not undone",
                     "world->getSolverInfo().m_linearSlop = {};", ALL_PROFILES, 0, 0.002, false},
    [OPTION_CONTACT_BREAKING] =
        {"contact_breaking", 0.02, 1e-6, 1, false, "1",
         "share of the smaller shape's reach at which a kept contact point is dropped",
         "gContactBreakingThreshold = {};", ALL_PROFILES, 0.002, 0.05, true},
};

static const pl_engine_source sources[] = {
    {PROFILE_RECOMMENDED, NULL,
     "time step: \"Bullet works best with a fixed internal timestep of at least 60 hertz\" (Bullet "
     "2.83 Physics SDK Manual, Use the default internal fixed timestep); its own physics server "
     "has "
     "1/240 s (PhysicsServerCommandProcessor.cpp, 3.24)"},
    {PROFILE_RECOMMENDED, "iterations",
     "its author: \"best left default (50 iterations). Increase ... if you need higher accuracy\", "
     "of "
     "its physics server (https://github.com/bulletphysics/bullet3/issues/3081); \"20 (good "
     "quality)\" in the wiki (BtContactSolverInfo, Solver iterations)"},
    {PROFILE_RECOMMENDED, "random_order",
     "Bullet wiki, BtContactSolverInfo, Solver Mode, SOLVER_RANDMIZE_ORDER: \"stacking stability "
     "can "
     "be improved\" "
     "(http://www.bulletphysics.org/mediawiki-1.5.8/index.php/BtContactSolverInfo)"},
    {PROFILE_RECOMMENDED, "friction_directions",
     "the constructor of btMultiBodyDynamicsWorld, the world of its physics server, sets "
     "SOLVER_USE_2_FRICTION_DIRECTIONS (btMultiBodyDynamicsWorld.cpp, 3.24)"},
    {PROFILE_RECOMMENDED, "plane_multipoint",
     "btDefaultCollisionConfiguration.h, multipoint iterations: \"3 is a good value for both "
     "params\"; off by default \"for best performance\""},
    {PROFILE_RECOMMENDED, "convex_multipoint",
     "btDefaultCollisionConfiguration.h, setConvexConvexMultipointIterations: \"3 is a good value "
     "for both params\"; off by default \"for best performance\""},
};

struct pl_engine_instance {
    const pl_scene *scene;
    pl_bullet_world *world;
    int profile;
    double time;
    long steps;
};

static void scene_pair(const void *context, int body_a, int body_b, double *friction,
                       double *restitution)
{
    const pl_pair_coefficients pair = pl_setup_pair(context, body_a, body_b);
    *friction = pair.friction;
    *restitution = pair.restitution;
}

static void bullet_destroy(pl_engine_instance *instance)
{
    if (instance == NULL) {
        return;
    }
    if (instance->world != NULL) {
        int fallbacks = pl_bullet_fallbacks(instance->world);
        if (fallbacks > 0) {
            fprintf(stderr,
                    "bullet:%s gave up %d times in %ld steps and fell back to sequential impulse\n",
                    profiles[instance->profile].name, fallbacks, instance->steps);
        }
    }
    pl_bullet_world_destroy(instance->world);
    free(instance);
}

static pl_status add_body(pl_bullet_world *world, const pl_body *body)
{
    pl_body placed = *body;
    pl_to_principal_pose(&body->shape, placed.position, placed.orientation);
    return pl_bullet_add_body(world, &placed);
}

/* The state of a body in the frame of its shape. */
static void read_body(const pl_engine_instance *instance, int body, pl_body_state *state)
{
    pl_bullet_read_body(instance->world, body, state);
    pl_to_shape_pose(&instance->scene->bodies[body].shape, state->position, state->orientation);
}

static pl_status bullet_create(const pl_engine_setup *setup, pl_engine_instance **out,
                               pl_error *error)
{
    const pl_scene *scene = setup->scene;
    const double *values = setup->values;
    *out = NULL;
    pl_engine_instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for a bullet world");
    }
    instance->scene = scene;
    instance->profile = setup->profile;
    pl_bullet_world_def def = {
        .solver =
            setup->profile == PROFILE_RECOMMENDED ? PL_BULLET_SI : (pl_bullet_solver)setup->profile,
        .settings = {.iterations = (int)values[OPTION_ITERATIONS],
                     .split_impulse = values[OPTION_SPLIT_IMPULSE] > 0,
                     .erp = values[OPTION_ERP],
                     .erp2 = values[OPTION_ERP2],
                     .restitution_threshold = values[OPTION_RESTITUTION_THRESHOLD],
                     .margin = values[OPTION_MARGIN],
                     .solid_margin = values[OPTION_SOLID_MARGIN],
                     .plane_multipoint = (int)values[OPTION_PLANE_MULTIPOINT],
                     .convex_multipoint = (int)values[OPTION_CONVEX_MULTIPOINT],
                     .friction_directions = (int)values[OPTION_FRICTION_DIRECTIONS],
                     .warm_start = values[OPTION_WARM_START],
                     .random_order = values[OPTION_RANDOM_ORDER] > 0,
                     .split_threshold = values[OPTION_SPLIT_THRESHOLD],
                     .slop = values[OPTION_SLOP],
                     .contact_breaking = values[OPTION_CONTACT_BREAKING]},
        .gravity = {scene->gravity[0], scene->gravity[1], scene->gravity[2]},
        .matrix_limit = dense_limit,
        .pair = scene_pair,
        .context = setup,
    };
    pl_status status = PL_OK;
    instance->world = pl_bullet_world_create(&def);
    if (instance->world == NULL) {
        status = pl_fail(error, PL_NO_MEMORY, "bullet could not make a world");
        goto cleanup;
    }
    for (int i = 0; i < scene->body_count; ++i) {
        status = add_body(instance->world, &scene->bodies[i]);
        if (status != PL_OK) {
            pl_fail(error, status, "body \"%s\": bullet could not make its shape (kind %d)",
                    scene->bodies[i].name, (int)scene->bodies[i].shape.kind);
            goto cleanup;
        }
    }
    *out = instance;
    instance = NULL;
cleanup:
    bullet_destroy(instance);
    return status;
}

static void add_forces(const pl_engine_instance *instance, double dt)
{
    const pl_scene *scene = instance->scene;
    for (int i = 0; i < scene->force_count; ++i) {
        const pl_force *force = &scene->forces[i];
        pl_body_state state;
        double world_force[3], offset[3];
        read_body(instance, force->body, &state);
        if (!scene->bodies[force->body].is_static &&
            pl_force_at(force, instance->time, dt, state.orientation, world_force, offset)) {
            pl_bullet_add_force(instance->world, force->body, world_force, offset);
        }
    }
}

static pl_status bullet_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                             pl_error *error)
{
    double rows = 0, bytes = 0;
    add_forces(instance, dt);
    pl_status status = pl_bullet_step(instance->world, dt, stats, &rows, &bytes);
    if (status == PL_UNSUPPORTED) {
        return pl_fail(error, status,
                       "bullet:%s needs %.1f GiB for the dense matrices of %.0f contact rows; the "
                       "limit is %.0f GiB",
                       profiles[instance->profile].name, bytes / gibibyte, rows,
                       dense_limit / gibibyte);
    }
    if (status != PL_OK) {
        return pl_fail(error, status, "bullet threw an exception in step %ld", instance->steps + 1);
    }
    instance->time += dt;
    ++instance->steps;
    return PL_OK;
}

static void bullet_read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    const pl_scene *scene = instance->scene;
    frame->time = instance->time;
    for (int i = 0; i < frame->body_count; ++i) {
        pl_body_state *state = &frame->bodies[i];
        read_body(instance, i, state);
        if (scene->bodies[i].shape.kind == PL_SHAPE_PLANE) {
            /* The shape of a plane has its position, and its body stays at the origin. */
            memcpy(state->position, scene->bodies[i].position, sizeof state->position);
            memcpy(state->orientation, scene->bodies[i].orientation, sizeof state->orientation);
        }
    }
}

static void bullet_read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    pl_bullet_read_gravity(instance->world, settings->gravity);
    for (int i = 0; i < settings->body_count; ++i) {
        pl_bullet_read_mass(instance->world, i, &settings->mass[i], settings->inertia[i]);
    }
}

static void bullet_read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                             pl_pair_coefficients *found)
{
    pl_bullet_read_pair(instance->world, body_a, body_b, &found->friction, &found->restitution);
}

static int bullet_read_contacts(const pl_engine_instance *instance, pl_contact *contacts,
                                int capacity)
{
    return pl_bullet_read_contacts(instance->world, contacts, capacity);
}

/* The defaults are Bullet's own, also those of a library that was built with others; for
 * `recommended`, those of `sources`. */
static void bullet_profile_defaults(int profile, double *values)
{
    pl_bullet_settings defaults = pl_bullet_defaults();
    values[OPTION_ITERATIONS] = defaults.iterations;
    values[OPTION_SPLIT_IMPULSE] = defaults.split_impulse;
    values[OPTION_ERP] = defaults.erp;
    values[OPTION_ERP2] = defaults.erp2;
    values[OPTION_RESTITUTION_THRESHOLD] = defaults.restitution_threshold;
    values[OPTION_MARGIN] = defaults.margin;
    values[OPTION_SOLID_MARGIN] = defaults.solid_margin;
    values[OPTION_PLANE_MULTIPOINT] = defaults.plane_multipoint;
    values[OPTION_CONVEX_MULTIPOINT] = defaults.convex_multipoint;
    values[OPTION_FRICTION_DIRECTIONS] = defaults.friction_directions;
    values[OPTION_WARM_START] = defaults.warm_start;
    values[OPTION_RANDOM_ORDER] = defaults.random_order;
    values[OPTION_SPLIT_THRESHOLD] = defaults.split_threshold;
    values[OPTION_SLOP] = defaults.slop;
    values[OPTION_CONTACT_BREAKING] = defaults.contact_breaking;
    if (profile == PROFILE_RECOMMENDED) {
        values[OPTION_ITERATIONS] = 50;
        values[OPTION_RANDOM_ORDER] = 1;
        values[OPTION_FRICTION_DIRECTIONS] = 2;
        values[OPTION_PLANE_MULTIPOINT] = 3;
        values[OPTION_CONVEX_MULTIPOINT] = 3;
    }
}

static const pl_engine engine = {
    .struct_size = sizeof(pl_engine),
    .abi_version = PL_ENGINE_ABI_VERSION,
    .name = "bullet",
    .version = PLUMB_BULLET_VERSION,
    .description = "Bullet Physics, double precision",
    .residual_unit = "m^2/s^2",
    .capabilities = PL_NEEDS_FRICTION | PL_NEEDS_RESTITUTION | PL_NEEDS_ROTATION | PL_NEEDS_FORCES |
                    PL_NEEDS_PLANE | PL_NEEDS_SPHERE | PL_NEEDS_BOX | PL_NEEDS_CAPSULE |
                    PL_NEEDS_CYLINDER | PL_NEEDS_HULL | PL_NEEDS_MESH,
    .contacts = PL_CONTACTS_POINTS | PL_CONTACTS_IMPULSES,
    .integrator = PL_INTEGRATOR_SEMI_IMPLICIT_EULER,
    .gyroscopic = PL_GYROSCOPIC_IMPLICIT,
    .substeps = 1,
    .profiles = profiles,
    .profile_count = sizeof profiles / sizeof *profiles,
    .options = options,
    .option_count = OPTION_COUNT,
    .profile_defaults = bullet_profile_defaults,
    .create = bullet_create,
    .destroy = bullet_destroy,
    .step = bullet_step,
    .read_frame = bullet_read_frame,
    .read_settings = bullet_read_settings,
    .read_pair = bullet_read_pair,
    .read_contacts = bullet_read_contacts,
    .sources = sources,
    .source_count = sizeof sources / sizeof *sources,
};

/* The table of built-in engines calls it. */
const pl_engine *pl_engine_bullet(void);

const pl_engine *pl_engine_bullet(void)
{
    return &engine;
}
