/* The engine ABI: the table of C functions through which the harness drives an engine, whether it
 * is built in or loaded from a shared object (`--engine ./mine.so:profile`).
 *
 * A shared object exports one symbol, `plumb_engine` (PL_ENGINE_SYMBOL), of type pl_engine_entry.
 * This header needs only plumb/scene_data.h and plumb/status.h, no symbol of plumb, and compiles as
 * C99 to C23 and as C++11 to C++23. `plumb new-engine DIR` writes a working adapter to start from,
 * and `plumb check-engine ./mine.so` tests an adapter against everything that is said here.
 *
 * Conventions, to which an adapter converts those of its engine:
 * - SI units, a right-handed world, gravity as the scene says.
 * - Quaternions are (w, x, y, z), of unit length, body to world.
 * - The pose of a body is that of its shape's own frame, as in the scene. Velocity is that of the
 *   centre of mass. The two points differ for hulls and meshes only (pl_polyhedron.centre).
 *   Velocity and angular velocity are in the world frame.
 * - pl_body.inertia holds the principal moments. The k-th belongs to the k-th axis of the shape's
 *   frame; of a hull or a mesh, to the k-th axis of pl_polyhedron.axes.
 * - A contact's normal has unit length and points from body A to body B. A negative separation is a
 *   penetration. Impulses are in N s and act on body B, summed over the whole step.
 * - Contacts are those that the solver of the last step worked with: the points and separations
 *   of the poses before that step.
 *
 * What the harness expects of the simulation:
 * - Sleeping, deactivation and damping are off. A body changes its velocity by gravity, applied
 *   forces and contacts alone. Torque-free bodies precess (pl_engine.gyroscopic says how).
 * - step(dt) advances by exactly dt; an engine that divides it says so by `substeps`. An engine
 *   that cannot use this dt refuses it in create.
 * - Friction and restitution are those of pl_setup_pair, whatever rule of mixing the engine has.
 *   Rolling and spinning friction are 0. A threshold below which impacts do not bounce is an option
 *   of the engine, restitution_threshold, whose default is no larger than rest needs.
 * - A plane is a half-space. An engine without half-spaces uses a box whose top is the plane and
 *   which covers pl_engine_setup.lower to .upper; its depth should be about its width.
 * - Applied forces act during the steps for which pl_force_acts.
 * - A run repeats: the same scene, profile and values give the same bits.
 *
 * Options: the names are the engine's own, except that `iterations` is the budget of the velocity
 * solver, which `plumb compare --iterations-to-tolerance`, `ensemble`, `sweep` and `tune` vary by
 * that name, and `restitution_threshold` (m/s) is the normal speed below which impacts do not
 * bounce; an engine without that option has no such threshold. `label` is taken:
 * `--engine ./mine.so:fast,label=new` names a configuration.
 *
 * Processes: the harness never runs an engine's code in its own process. A process of its own, with
 * limits on time and memory, loads the shared object, asks for the defaults of its profiles and for
 * extensions, and ends. Every run is another such process, which calls, from one thread and in this
 * order: create; read_settings, read_pair, read_frame; then for each step: step, read_frame,
 * read_contacts; at the end destroy, and the shared object is unloaded. It has descriptors 0 to 2,
 * and others that are not the engine's. What an engine prints is captured; a crash, an exit, a hang
 * is the outcome of that run. Processes that it has started end with it. The floating-point environment is restored after every call. The
 * shared object's own symbols come before those of libraries that the harness links. Only the calls of step count as time per step; create and the reading are timed apart. */
#ifndef PLUMB_ENGINE_ABI_H
#define PLUMB_ENGINE_ABI_H

#include "plumb/scene_data.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An ABI version stands for the layout of everything here and in scene_data.h. Within a version,
 * fields are only added at the end of structs that begin with struct_size; a shared object with
 * a shorter pl_engine is accepted as long as it has everything up to read_frame. */
enum {
    PL_ENGINE_ABI_VERSION = 2,
    PL_ENGINE_MAX_OPTIONS = 24,  /* the most options that an engine may have */
    PL_ENGINE_MAX_PROFILES = 64, /* the most profiles */
    PL_ENGINE_MAX_SOURCES = 256  /* the most sources of profiles' values */
};

/* The name of the symbol, of type pl_engine_entry, that a shared object exports. */
#define PL_ENGINE_SYMBOL "plumb_engine"

/* The floating-point numbers with which an engine computes. What it reads back is compared with the
 * scene to this precision. */
typedef enum pl_precision {
    PL_PRECISION_DOUBLE, /* 64 bits */
    PL_PRECISION_FLOAT   /* 32 bits */
} pl_precision;

/* How free motion is integrated over a sub-step of length h. */
typedef enum pl_integrator {
    PL_INTEGRATOR_UNKNOWN,
    PL_INTEGRATOR_SEMI_IMPLICIT_EULER, /* v += h a, then x += h v */
    PL_INTEGRATOR_EXPLICIT_EULER,      /* x += h v, then v += h a */
    PL_INTEGRATOR_MIDPOINT /* x += h v + h^2/2 a and v += h a: exact in free fall (also Verlet) */
} pl_integrator;

/* The gyroscopic torque w x I w of a free body. */
typedef enum pl_gyroscopic {
    PL_GYROSCOPIC_UNKNOWN,
    PL_GYROSCOPIC_NONE,     /* left out: the angular velocity of a free body stays as it is */
    PL_GYROSCOPIC_EXPLICIT, /* at the beginning of the sub-step */
    PL_GYROSCOPIC_IMPLICIT  /* at its end or middle, or exact */
} pl_gyroscopic;

/* What the contacts of read_contacts have, as bits. */
enum {
    PL_CONTACTS_POINTS = 1u << 0,   /* bodies, point, normal and separation */
    PL_CONTACTS_IMPULSES = 1u << 1, /* impulse */
    PL_CONTACTS_TORQUES = 1u << 2   /* torque */
};

/* A numeric setting of an engine, given as `name:profile,option=value`. */
typedef struct pl_engine_option {
    const char *name; /* at most PL_NAME_SIZE - 1 bytes, without ',' ':' '=' or blanks */
    double value;     /* default */
    double min;       /* least value allowed */
    double max;       /* largest value allowed */
    bool integer;     /* only whole numbers are allowed */
    const char *unit; /* "1" when dimensionless */
    const char *help; /* one line, for `plumb list engines` */
    /* How a program that uses the engine sets it, with {} in place of the value, such as
     * "world.set_erp({});". NULL: not shown. */
    const char *code;
    uint32_t tune_profiles; /* bits 1 << profile for which `plumb tune` varies it; 0: none */
    double tune_min;        /* least value tried, within the limits */
    double tune_max;        /* largest value tried, within the limits */
    bool tune_logarithmic;  /* values are spaced by ratio */
} pl_engine_option;

/* A solver, or a set of defaults, of an engine. */
typedef struct pl_engine_profile {
    const char *name;           /* at most PL_NAME_SIZE - 1 bytes */
    const char *help;           /* one line, for `plumb list engines` */
    bool in_default_comparison; /* run by `plumb compare` when no --engine is given */
    const char *step_code;      /* how a program steps by {} seconds; NULL: not shown */
} pl_engine_profile;

/* Why a profile has a value: a document of the engine's own authors. A profile for which any source
 * is given has one for every option whose default differs from that of the first profile. */
typedef struct pl_engine_source {
    int profile;        /* index in pl_engine.profiles */
    const char *option; /* name of the option; NULL: the profile, such as the time step it is for */
    const char *text;   /* title, section and what it says, for `plumb list engines` */
} pl_engine_source;

/* Friction and restitution of two materials. */
typedef struct pl_pair_coefficients {
    double friction;    /* Coulomb coefficient */
    double restitution; /* Newton coefficient */
} pl_pair_coefficients;

/* What an engine is asked to simulate. The harness owns it, and it outlives the instance. */
typedef struct pl_engine_setup {
    uint32_t struct_size;              /* sizeof(pl_engine_setup) of the harness */
    const pl_scene *scene;             /* the bodies, materials, forces and gravity */
    double dt;                         /* s, of every step */
    int profile;                       /* index in pl_engine.profiles */
    const double *values;              /* (option_count) of the options, complete and in range */
    const pl_pair_coefficients *pairs; /* (material_count x material_count), for pl_setup_pair */
    /* The scene's bounds hold where its bodies begin, and 100 m around that, or as far as the fastest
     * body goes in 10 s. */
    double lower[3]; /* m */
    double upper[3]; /* m */
} pl_engine_setup;

/* Friction and restitution of a contact between two bodies of the scene. */
static inline pl_pair_coefficients pl_setup_pair(const pl_engine_setup *setup, int body_a,
                                                 int body_b)
{
    const pl_scene *scene = setup->scene;
    return setup->pairs[scene->bodies[body_a].material * scene->material_count +
                        scene->bodies[body_b].material];
}

/* Whether `force` acts over the step of length dt (s) that starts at `time` (s). Its start and end
 * count to a millionth of a step, so that rounding of a summed time never adds or drops a step. */
static inline bool pl_force_acts(const pl_force *force, double time, double dt)
{
    const double slack = 1e-6 * dt;
    return time + slack >= force->from && time + slack < force->until;
}

/* Fills the caller's error (NULL allowed) with a status and a message, cut to size, and returns the
 * status: `return pl_engine_error(error, PL_UNSUPPORTED, "no meshes");`. */
static inline pl_status pl_engine_error(pl_error *error, pl_status status, const char *message)
{
    if (error != NULL) {
        size_t length = 0;
        while (message[length] != '\0' && length + 1 < sizeof error->message) {
            error->message[length] = message[length];
            ++length;
        }
        error->message[length] = '\0';
        error->status = status;
    }
    return status;
}

/* Statistics of one step. The harness sets struct_size and fills every number with NAN before the
 * call. The engine overwrites the numbers that it has, and leaves the others NAN: it never writes 0
 * for "unknown". A number that is negative or infinite ends the run. */
typedef struct pl_step_stats {
    uint32_t struct_size; /* sizeof(pl_step_stats) of the harness */
    double iterations;    /* of the velocity solver; the largest over the islands */
    double residual;      /* after the last iteration, in pl_engine.residual_unit; the largest */
    double contacts;      /* contact points given to the solver */
    double islands;       /* groups of bodies that are solved apart from each other */
    double time_collide;  /* s, for collision detection */
    double time_solve;    /* s, for the velocity solver */
    double time_other;    /* s, for the rest of the step */
} pl_step_stats;

/* The state of one body. */
typedef struct pl_body_state {
    double position[3];         /* m, of the shape's own frame, as in the scene */
    double orientation[4];      /* w, x, y, z; of the shape's own frame */
    double velocity[3];         /* m/s, of the centre of mass */
    double angular_velocity[3]; /* rad/s, in the world frame */
} pl_body_state;

/* The state of all bodies of the scene, static ones included, in the scene's order. The caller owns
 * it: it sets body_count to the scene's and provides `bodies`. The engine fills the rest. */
typedef struct pl_frame {
    double time;           /* s since the start */
    int body_count;        /* set by the caller */
    pl_body_state *bodies; /* (body_count) */
} pl_frame;

/* One contact point as the solver of the last step left it. Bodies A and B differ, in any order. A
 * contact of one body, with an index out of range, a number that is not finite or a normal that is no
 * unit vector ends the run. */
typedef struct pl_contact {
    int body_a;        /* index in the scene */
    int body_b;        /* index in the scene */
    double point[3];   /* m, in the world, where the bodies had it at the start of the step */
    double normal[3];  /* unit, from A to B */
    double separation; /* m; negative in penetration */
    double impulse[3]; /* N s, on B over the whole step, in the world frame */
    double torque[3];  /* N m s, on B over the whole step about `point`, in the world frame; 0
                          unless the engine has PL_CONTACTS_TORQUES */
} pl_contact;

/* What the engine really simulates, read from its own objects and not from what the adapter was
 * given. The harness owns the arrays. Before the call it sets struct_size and body_count,
 * sets `substeps` to that of pl_engine, and fills every other number with NAN. A number that stays
 * NAN is not compared with the scene, and reports say so. */
typedef struct pl_engine_settings {
    uint32_t struct_size;   /* sizeof(pl_engine_settings) of the harness */
    int body_count;         /* set by the caller */
    double gravity[3];      /* m/s^2 */
    double dt;              /* s, the time by which step(dt) will really advance */
    double *mass;           /* (body_count) kg; 0 for a static body */
    double (*inertia)[3];   /* (body_count) kg m^2, principal, in any order; 0 for a static body */
    int substeps;           /* sub-steps of step(dt) with this profile and these options */
    double linear_damping;  /* 1/s; 0: none */
    double angular_damping; /* 1/s; 0: none */
} pl_engine_settings;

/* A scene in an engine. Each engine defines it for itself. */
typedef struct pl_engine_instance pl_engine_instance;

/* An engine: a constant description and its functions. A function that fails writes a message into
 * the caller's pl_error (pl_engine_error) and returns a status other than PL_OK. */
typedef struct pl_engine {
    uint32_t struct_size;      /* sizeof(pl_engine) as compiled */
    uint32_t abi_version;      /* PL_ENGINE_ABI_VERSION as compiled */
    const char *name;          /* such as "ode"; letters, digits, '_', '-' and '.' */
    const char *version;       /* such as "0.16.2" */
    const char *description;   /* one line, for `plumb list engines` */
    const char *residual_unit; /* of pl_step_stats.residual; NULL: it never has one */
    uint32_t capabilities;     /* PL_NEEDS_* bits that it supports */
    uint32_t contacts;         /* PL_CONTACTS_* bits that read_contacts fills; 0: none */
    pl_precision precision;    /* of its arithmetic */
    pl_integrator integrator;  /* of free motion */
    pl_gyroscopic gyroscopic;  /* of free rotation */
    int substeps;              /* sub-steps of a step, >= 1 (see pl_engine_settings.substeps) */
    const pl_engine_profile *profiles; /* (profile_count); the first is the default */
    int profile_count;                 /* 1 to PL_ENGINE_MAX_PROFILES */
    const pl_engine_option *options;   /* (option_count); NULL: none */
    int option_count;                  /* at most PL_ENGINE_MAX_OPTIONS */

    /* Overwrites values[option_count], which holds the defaults of `options`, with those of a
     * profile. NULL when no profile differs. */
    void (*profile_defaults)(int profile, double *values);

    /* Builds a scene. PL_UNSUPPORTED with a reason when the engine cannot simulate it. On failure
     * *instance is left NULL. */
    pl_status (*create)(const pl_engine_setup *setup, pl_engine_instance **instance,
                        pl_error *error);

    /* Frees an instance; NULL is allowed. */
    void (*destroy)(pl_engine_instance *instance);

    /* Advances by dt seconds, that of the setup. PL_UNSUPPORTED or PL_FAILED end the run. */
    pl_status (*step)(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                      pl_error *error);

    /* Reads the state after the last step, or the initial state. */
    void (*read_frame)(const pl_engine_instance *instance, pl_frame *frame);

    /* From here on NULL is allowed, and a shorter pl_engine lacks the rest. */

    /* Reads back what the engine simulates. NULL: nothing is read back. */
    void (*read_settings)(const pl_engine_instance *instance, pl_engine_settings *settings);

    /* Reads the coefficients that a contact between two bodies has in the engine. NAN stands for
     * one that the engine does not store. NULL: it stores neither. */
    void (*read_pair)(const pl_engine_instance *instance, int body_a, int body_b,
                      pl_pair_coefficients *found);

    /* Reads the contacts of the last step that carry or may carry force: fills up to `capacity`,
     * and returns how many there are. NULL when `contacts` is 0. */
    int (*read_contacts)(const pl_engine_instance *instance, pl_contact *contacts, int capacity);

    /* A table of more functions by its name and version, such as "vendor.feature/1"; NULL for a
     * name that the engine does not know. The table is constant, and its type is declared where the
     * name is. NULL when the engine has no extensions. */
    const void *(*extension)(const char *name);

    const pl_engine_source *sources; /* (source_count); NULL: none */
    int source_count;                /* at most PL_ENGINE_MAX_SOURCES */
    const char *runtime; /* what runs the engine's code, such as "webassembly". NULL: it is native.
                            The times of others are not ranked with those of native engines */
} pl_engine;

/* The type of the symbol that a shared object exports: returns its engine, valid for as long as the
 * object is loaded. */
typedef const pl_engine *(*pl_engine_entry)(void);

#ifdef __cplusplus
}
#endif
#endif
