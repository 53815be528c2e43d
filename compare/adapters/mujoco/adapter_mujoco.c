/* MuJoCo 2.2, through its C API.
 *
 * default:     as shipped: Newton's method, pyramidal cones, contacts with a time constant of 20 ms.
 * cg, pgs:     the same with its other two solvers.
 * recommended: what its documentation says of contacts that should not slip and not yield. "The best
 *   way to suppress it is to use elliptic cones, large impratio, and the Newton algorithm with very
 *   small tolerance" (Modeling, "Algorithms and settings", which has 1e-10 for it). "Increasing
 *   constraint impedance (first two elements of solimp) as well as the global impratio setting can
 *   be particularly effective" (Overview, "Softness and slip"). Several points of two shapes that
 *   have no collider of their own "can be useful when the contacting geoms have a flat surface"
 *   (XML reference, multiccd). The time constant is the default, since no other is advised, and the
 *   Noslip solver stays off, because with it "the simulation may become less robust".
 *
 * MuJoCo has soft contacts: every constraint is a spring with a damper, which yields under load. It
 * has no coefficient of restitution, so restitution is no capability. A step is mj_step1 and
 * mj_step2, which together are mj_step.
 *
 * A state that is not finite or too large makes MuJoCo start again from its initial state with no
 * more than a warning. Such a warning ends the run. */
#include "mujoco_instance.h"

#include "plumb/adapter_helpers.h"
#include "plumb/base.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PROFILE_DEFAULT, PROFILE_RECOMMENDED, PROFILE_CG, PROFILE_PGS, PROFILE_COUNT };

enum { ALL_PROFILES = (1 << PROFILE_COUNT) - 1 };

static const pl_engine_profile profiles[PROFILE_COUNT] = {
    [PROFILE_DEFAULT] = {.name = "default",
                         .help = "as shipped: Newton's method, pyramidal cones",
                         .in_default_comparison = true,
                         .step_code = "model->opt.timestep = {}; mj_step(model, data);"},
    [PROFILE_RECOMMENDED] = {.name = "recommended",
                             .help = "Newton's method, elliptic cones, hard contacts, as its "
                                     "documentation advises",
                             .in_default_comparison = true,
                             .step_code = "model->opt.timestep = {}; mj_step(model, data);"},
    [PROFILE_CG] = {.name = "cg",
                    .help = "as shipped, with conjugate gradients",
                    .step_code = "model->opt.timestep = {}; mj_step(model, data);"},
    [PROFILE_PGS] = {.name = "pgs",
                     .help = "as shipped, with projected Gauss-Seidel",
                     .step_code = "model->opt.timestep = {}; mj_step(model, data);"},
};

/* The defaults are those of mj_defaultOption and mj_defaultSolRefImp. MuJoCo keeps impedances within
 * 0.0001 .. 0.9999. */
static const pl_engine_option options[MUJOCO_OPTION_COUNT] = {
    [MUJOCO_SOLVER] = {.name = "solver",
                       .value = mjSOL_NEWTON,
                       .max = mjSOL_NEWTON,
                       .integer = true,
                       .unit = "1",
                       .help = "0: projected Gauss-Seidel, 1: conjugate gradients, 2: Newton",
                       .code = "model->opt.solver = {};"},
    [MUJOCO_CONE] = {.name = "cone",
                     .value = mjCONE_PYRAMIDAL,
                     .max = mjCONE_ELLIPTIC,
                     .integer = true,
                     .unit = "1",
                     .help = "friction cone, 0: pyramidal, 1: elliptic",
                     .code = "model->opt.cone = {};",
                     .tune_profiles = ALL_PROFILES,
                     .tune_max = 1},
    [MUJOCO_ITERATIONS] = {.name = "iterations",
                           .value = 100,
                           .min = 1,
                           .max = 1e6,
                           .integer = true,
                           .unit = "1",
                           .help = "most iterations of the solver",
                           .code = "model->opt.iterations = {};",
                           .tune_profiles = ALL_PROFILES,
                           .tune_min = 1,
                           .tune_max = 1000,
                           .tune_logarithmic = true},
    [MUJOCO_TOLERANCE] = {.name = "tolerance",
                          .value = 1e-8,
                          .max = 1,
                          .unit = "1",
                          .help = "improvement or gradient below which the solver ends",
                          .code = "model->opt.tolerance = {};",
                          .tune_profiles = ALL_PROFILES,
                          .tune_min = 1e-14,
                          .tune_max = 1e-4,
                          .tune_logarithmic = true},
    [MUJOCO_NOSLIP_ITERATIONS] = {.name = "noslip_iterations",
                                  .max = 1e6,
                                  .integer = true,
                                  .unit = "1",
                                  .help = "most iterations of the Noslip solver, which makes "
                                          "friction hard after the solver; 0: off",
                                  .code = "model->opt.noslip_iterations = {};",
                                  .tune_profiles = ALL_PROFILES,
                                  .tune_max = 100},
    [MUJOCO_NOSLIP_TOLERANCE] = {.name = "noslip_tolerance",
                                 .value = 1e-6,
                                 .max = 1,
                                 .unit = "1",
                                 .help = "improvement below which the Noslip solver ends",
                                 .code = "model->opt.noslip_tolerance = {};"},
    [MUJOCO_IMPRATIO] = {.name = "impratio",
                         .value = 1,
                         .min = 1e-3,
                         .max = 1e9,
                         .unit = "1",
                         .help = "hardness of friction by that of the normal direction",
                         .code = "model->opt.impratio = {};",
                         .tune_profiles = ALL_PROFILES,
                         .tune_min = 1,
                         .tune_max = 1e5,
                         .tune_logarithmic = true},
    [MUJOCO_SOLREF_TIMECONST] = {.name = "solref_timeconst",
                                 .value = 0.02,
                                 .min = 1e-6,
                                 .max = 100,
                                 .unit = "s",
                                 .help = "time constant of contacts; MuJoCo raises it to two "
                                         "time steps",
                                 .code = "model->geom_solref[mjNREF * geom] = {};",
                                 .tune_profiles = ALL_PROFILES,
                                 .tune_min = 1e-3,
                                 .tune_max = 0.1,
                                 .tune_logarithmic = true},
    [MUJOCO_SOLREF_DAMPRATIO] = {.name = "solref_dampratio",
                                 .value = 1,
                                 .min = 1e-3,
                                 .max = 1000,
                                 .unit = "1",
                                 .help = "damping ratio of contacts; 1: critical",
                                 .code = "model->geom_solref[mjNREF * geom + 1] = {};",
                                 .tune_profiles = ALL_PROFILES,
                                 .tune_min = 0.3,
                                 .tune_max = 3,
                                 .tune_logarithmic = true},
    [MUJOCO_SOLIMP_DMIN] = {.name = "solimp_dmin",
                            .value = 0.9,
                            .min = mjMINIMP,
                            .max = mjMAXIMP,
                            .unit = "1",
                            .help = "impedance of contacts at depth 0",
                            .code = "model->geom_solimp[mjNIMP * geom] = {};",
                            .tune_profiles = ALL_PROFILES,
                            .tune_min = 0.5,
                            .tune_max = mjMAXIMP},
    [MUJOCO_SOLIMP_DMAX] = {.name = "solimp_dmax",
                            .value = 0.95,
                            .min = mjMINIMP,
                            .max = mjMAXIMP,
                            .unit = "1",
                            .help = "impedance of contacts at depth solimp_width",
                            .code = "model->geom_solimp[mjNIMP * geom + 1] = {};",
                            .tune_profiles = ALL_PROFILES,
                            .tune_min = 0.5,
                            .tune_max = mjMAXIMP},
    [MUJOCO_SOLIMP_WIDTH] = {.name = "solimp_width",
                             .value = 1e-3,
                             .max = 1e3,
                             .unit = "m",
                             .help = "depth over which the impedance changes",
                             .code = "model->geom_solimp[mjNIMP * geom + 2] = {};",
                             .tune_profiles = ALL_PROFILES,
                             .tune_min = 1e-5,
                             .tune_max = 0.1,
                             .tune_logarithmic = true},
    [MUJOCO_MULTICCD] = {.name = "multiccd",
                         .max = 1,
                         .integer = true,
                         .unit = "1",
                         .help = "1: up to five points of a pair that has no collider of its own; "
                                 "experimental in MuJoCo 2.2",
                         .code = "model->opt.enableflags |= {} ? mjENBL_MULTICCD : 0;",
                         .tune_profiles = ALL_PROFILES,
                         .tune_max = 1},
};

#define MODELING "MuJoCo documentation, Modeling, Algorithms and settings: "
#define SLIP "MuJoCo documentation, Overview, Softness and slip: "

static const pl_engine_source sources[] = {
    {PROFILE_RECOMMENDED, NULL,
     MODELING "\"The Newton algorithm is the best choice for most models\" "
              "(https://mujoco.readthedocs.io/en/stable/modeling.html)"},
    {PROFILE_RECOMMENDED, "cone",
     MODELING "\"the best way to suppress it is to use elliptic cones, large impratio, and the "
              "Newton algorithm with very small tolerance\""},
    {PROFILE_RECOMMENDED, "tolerance",
     MODELING "Newton \"should be used with aggressive tolerance values, say 1e-10\""},
    {PROFILE_RECOMMENDED, "impratio",
     MODELING "\"large impratio\" against slip; how large it does not say: 10"},
    {PROFILE_RECOMMENDED, "solimp_dmin",
     SLIP "\"Increasing constraint impedance (first two elements of solimp)\"; how far it does not "
          "say: 0.99"},
    {PROFILE_RECOMMENDED, "solimp_dmax",
     SLIP "\"Increasing constraint impedance (first two elements of solimp)\"; how far it does not "
          "say: 0.999"},
    {PROFILE_RECOMMENDED, "multiccd",
     "MuJoCo documentation, XML Reference, multiccd: several points \"can be useful when the "
     "contacting geoms have a flat surface\""},
};

static void mujoco_profile_defaults(int profile, double *values)
{
    switch (profile) {
    case PROFILE_RECOMMENDED:
        values[MUJOCO_CONE] = mjCONE_ELLIPTIC;
        values[MUJOCO_TOLERANCE] = 1e-10;
        values[MUJOCO_IMPRATIO] = 10;
        values[MUJOCO_SOLIMP_DMIN] = 0.99;
        values[MUJOCO_SOLIMP_DMAX] = 0.999;
        values[MUJOCO_MULTICCD] = 1;
        return;
    case PROFILE_CG:
        values[MUJOCO_SOLVER] = mjSOL_CG;
        return;
    case PROFILE_PGS:
        values[MUJOCO_SOLVER] = mjSOL_PGS;
        return;
    default:
        return;
    }
}

/* MuJoCo waits for a key and exits when it meets an error, which would look like a program that
 * hangs or ended by itself. A signal is unambiguous. */
static void fatal(const char *message)
{
    fprintf(stderr, "MuJoCo error: %s\n", message);
    fflush(stderr);
    abort();
}

/* Without a handler MuJoCo writes warnings into a file of the working directory as well. */
static void warn(const char *message)
{
    fprintf(stderr, "MuJoCo warning: %s\n", message);
}

/* Seconds, for MuJoCo's own timers. */
static mjtNum now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (mjtNum)t.tv_sec + 1e-9 * (mjtNum)t.tv_nsec;
}

static void mujoco_destroy(pl_engine_instance *instance)
{
    if (instance != NULL) {
        pl_mujoco_unload(instance);
        free(instance);
    }
}

static pl_status mujoco_create(const pl_engine_setup *setup, pl_engine_instance **out,
                               pl_error *error)
{
    *out = NULL;
    mju_user_error = fatal;
    mju_user_warning = warn;
    mjcb_time = now;
    if (mj_version() != mjVERSION_HEADER) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "the MuJoCo library is %s, but its headers were another version's",
                       mj_versionString());
    }
    pl_engine_instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    instance->scene = setup->scene;
    pl_status status = pl_mujoco_load(setup, instance, error);
    if (status != PL_OK) {
        mujoco_destroy(instance);
        return status;
    }
    *out = instance;
    return PL_OK;
}

/* xfrc_applied has six numbers of each body: a force at the centre of mass and a torque, in the
 * world's axes. */
static void apply_forces(pl_engine_instance *instance, double dt)
{
    const pl_scene *scene = instance->scene;
    mjData *data = instance->data;
    mju_zero(data->xfrc_applied, 6 * instance->model->nbody);
    for (int i = 0; i < scene->force_count; ++i) {
        const pl_force *force = &scene->forces[i];
        double position[3], orientation[4], along[3], at[3];
        if (scene->bodies[force->body].is_static) {
            continue;
        }
        pl_mujoco_read_pose(instance, force->body, position, orientation);
        if (pl_force_at(force, data->time, dt, orientation, along, at)) {
            mjtNum *sum = data->xfrc_applied + 6 * (ptrdiff_t)pl_mujoco_body(instance, force->body);
            mjtNum torque[3];
            mju_cross(torque, at, along);
            mju_addTo3(sum, along);
            mju_addTo3(sum + 3, torque);
        }
    }
}

/* Contacts and constraints at the present poses. The data are made again where they are too small
 * for them. */
static pl_status collide(pl_engine_instance *instance, pl_error *error)
{
    for (;;) {
        mj_step1(instance->model, instance->data);
        const mjWarningStat *warning = instance->data->warning;
        if (warning[mjWARN_CONTACTFULL].number <= 1 && warning[mjWARN_CNSTRFULL].number <= 1) {
            return PL_OK;
        }
        pl_status status = pl_mujoco_grow(instance, error);
        if (status != PL_OK) {
            return status;
        }
    }
}

static pl_status check_warnings(const mjData *data, pl_error *error)
{
    static const int fatal_warnings[] = {mjWARN_INERTIA, mjWARN_BADQPOS, mjWARN_BADQVEL,
                                         mjWARN_BADQACC};
    for (size_t i = 0; i < sizeof fatal_warnings / sizeof *fatal_warnings; ++i) {
        const mjWarningStat *warning = &data->warning[fatal_warnings[i]];
        if (warning->number > 0) {
            return pl_fail(error, PL_FAILED, "MuJoCo gave up its state: %s",
                           mju_warningText(fatal_warnings[i], warning->lastinfo));
        }
    }
    return PL_OK;
}

/* Newton's method and conjugate gradients report the norm of the gradient, scaled to an
 * acceleration; Noslip, which comes after them, and Gauss-Seidel report none, but 0. */
static double last_gradient(const mjModel *model, const mjData *data)
{
    if (model->opt.solver == mjSOL_PGS || data->solver_iter > mjNSOLVER) {
        return NAN;
    }
    for (int i = data->solver_iter - 1; i >= 0; --i) {
        if (data->solver[i].gradient != 0 || model->opt.noslip_iterations == 0) {
            return data->solver[i].gradient;
        }
    }
    return NAN;
}

static double solving_time(const mjData *data)
{
    return data->timer[mjTIMER_POS_MAKE].duration + data->timer[mjTIMER_POS_PROJECT].duration +
           data->timer[mjTIMER_CONSTRAINT].duration;
}

static pl_status mujoco_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                             pl_error *error)
{
    double start = now();
    instance->model->opt.timestep = dt;
    memset(instance->data->timer, 0, sizeof instance->data->timer);
    pl_status status = collide(instance, error);
    if (status != PL_OK) {
        return status;
    }
    mjData *data = instance->data;
    apply_forces(instance, dt);
    mj_step2(instance->model, data);
    stats->iterations = data->solver_iter;
    stats->residual = last_gradient(instance->model, data);
    stats->contacts = pl_mujoco_read_contacts(instance, NULL, 0);
    stats->time_collide = data->timer[mjTIMER_POS_COLLISION].duration;
    stats->time_solve = solving_time(data);
    stats->time_other = now() - start - stats->time_collide - stats->time_solve;
    return check_warnings(data, error);
}

static pl_engine engine = {
    .struct_size = sizeof(pl_engine),
    .abi_version = PL_ENGINE_ABI_VERSION,
    .name = "mujoco",
    .description = "MuJoCo: soft contacts, by convex optimisation",
    .residual_unit = "m/s^2",
    .capabilities = PL_NEEDS_FRICTION | PL_NEEDS_ROTATION | PL_NEEDS_FORCES | PL_NEEDS_PLANE |
                    PL_NEEDS_SPHERE | PL_NEEDS_BOX | PL_NEEDS_CAPSULE | PL_NEEDS_CYLINDER |
                    PL_NEEDS_HULL,
    .contacts = PL_CONTACTS_POINTS | PL_CONTACTS_IMPULSES,
    .precision = PL_PRECISION_DOUBLE,
    .integrator = PL_INTEGRATOR_SEMI_IMPLICIT_EULER,
    .gyroscopic = PL_GYROSCOPIC_EXPLICIT,
    .substeps = 1,
    .profiles = profiles,
    .profile_count = PROFILE_COUNT,
    .options = options,
    .option_count = MUJOCO_OPTION_COUNT,
    .profile_defaults = mujoco_profile_defaults,
    .create = mujoco_create,
    .destroy = mujoco_destroy,
    .step = mujoco_step,
    .read_frame = pl_mujoco_read_frame,
    .read_settings = pl_mujoco_read_settings,
    .read_pair = pl_mujoco_read_pair,
    .read_contacts = pl_mujoco_read_contacts,
    .sources = sources,
    .source_count = sizeof sources / sizeof *sources,
};

/* The table of built-in engines calls it. */
const pl_engine *pl_engine_mujoco(void);

const pl_engine *pl_engine_mujoco(void)
{
    engine.version = mj_versionString();
    return &engine;
}
